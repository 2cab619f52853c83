"""What ``check``, ``batch`` and ``new`` say to people in the language of a description, and to programs in English."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from conftest import SHIPPED, invoked

from mbsym.model.system import LANGUAGES
from mbsym_cli.console import speaking


def description(language: str) -> str:
    text = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    return re.sub(r"^name:", f"language: {language}\nname:", text, count=1, flags=re.M)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sound description, a wrong one, results and a run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "good.yaml").write_text(description("ru"), encoding="utf-8")
    (tmp_path / "in" / "bad.yaml").write_text(description("ru").replace("mass: m", "mas: m"), encoding="utf-8")
    (tmp_path / "moved.yaml").write_text(description("ru").replace("[0, -l, 0]", "[0, -2*l, 0]"), encoding="utf-8")
    forced = description("ru").replace("positive", "nonnegative")
    (tmp_path / "forced.yaml").write_text(forced, encoding="utf-8")
    (tmp_path / "more").mkdir()
    for name in ("crane", "good"):
        (tmp_path / "more" / f"{name}.yaml").write_text(description("ru"), encoding="utf-8")
    return tmp_path


def said(*words: str) -> str:
    done = invoked(*words)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.output


@pytest.mark.parametrize("form", ["sarif", "github", "json"])
def test_programs_read_the_same_complaints_from_check_and_batch(form: str, folder: Path) -> None:
    """Batches wrote them in the language of the description, checks in English; people read theirs all the same."""
    wrong = ("in/bad.yaml", "--output-format", form)
    check, batch = (invoked(*x, *wrong).stdout for x in (("check",), ("batch", "--out", "out")))
    assert check == batch
    (row,) = json.loads(Path("out/summary.json").read_text(encoding="utf-8"))["systems"]
    assert row["complaints"][0]["message"].startswith("unknown key")
    assert "неизвестный ключ" in said("batch", "in/bad.yaml", "--out", "out")


def test_programs_read_complaints_in_english(folder: Path) -> None:
    (row,) = (json.loads(line) for line in said("check", "in/bad.yaml", "--output-format", "json").splitlines())
    assert row["code"] == "unknown-key"
    assert row["message"].startswith("unknown key")
    assert row["hint"].startswith("did you mean")


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_new_description_is_in_its_language(language: str, folder: Path) -> None:
    said("new", "crane", "--like", "pendulum", "--language", language)
    text = (folder / "crane.yaml").read_text(encoding="utf-8")
    assert f"\nlanguage: {language}\n" in text
    assert invoked("check", "crane.yaml").exit_code == 0


def test_which_language_several_files_speak(folder: Path) -> None:
    """That of all; English where they differ, and of what is no file."""
    (folder / "es.yaml").write_text(description("es"), encoding="utf-8")
    russian, spanish, sentence = folder / "in" / "good.yaml", folder / "es.yaml", "nothing to do"
    assert speaking(russian, russian)(sentence) == "делать нечего"
    assert speaking(spanish)(sentence) == "nada que hacer"
    assert speaking(russian, spanish)(sentence) == speaking()(sentence) == speaking(folder / "nowhere")(sentence)
    assert speaking(folder)(sentence) == speaking("a\0b")(sentence) == sentence


def test_a_robot_without_joints_is_told_what_helps(folder: Path) -> None:
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    text = f'<robot name="quad"><link name="base"><inertial><mass value="1"/>{inertia}</inertial></link></robot>'
    Path("quad.urdf").write_text(text, encoding="utf-8")
    assert "hint: --floating" in said("convert", "quad.urdf")
    assert invoked("convert", "quad.urdf", "--floating").exit_code == 0


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (("simulate", "in/good.yaml", "--time", "1", "--format", "csv"), "simulation.json"),
        (("simulate", "in/good.yaml", "--time", "1", "--vary", "theta=0:1:3", "--format", "csv"), "ensemble.json"),
        (("lyapunov", "in/good.yaml", "--time", "20"), "lyapunov.json"),
        (("regressor", "in/good.yaml"), "regressor.json"),
        (("map", "in/good.yaml", "--x", "b=0:1", "--format", "json"), "map.json"),
        (("tradeoff", "in/good.yaml", "--time", "1", "--budget", "0.1"), "tradeoff.json"),
    ],
)
def test_json_prints_what_the_file_says(words: tuple[str, ...], file: str, folder: Path) -> None:
    """In English, though the description is in Russian."""
    done = invoked(*words, "--json", "--out", "out", code=0)
    assert done.stdout == (folder / "out" / file).read_text(encoding="utf-8")
    assert json.loads(done.stdout)
    assert not re.search("[а-яё]", done.stdout)
