"""What ``simulate`` and the ledger tell in Russian and Spanish: whatever is Latin in Russian is a name or is typed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from conftest import SHIPPED

import mbsym
from mbsym.report.language import Language
from mbsym_cli.main import main

#: What is typed, names of methods and of people, arithmetic, files.
TYPED = {"mbsym", "simulate", "yaml", "csv", "json", "heyoka", "SciPy", "float64", "float32", "trajectory", "enclosure"}
TYPED |= {
    "dop853",
    "rodas5",  # rodas5p: a letter behind the number is no part of a word here
    "rk45",
    "rk4",
    "taylor",
    "radau",
    "rodas5p",
    "lsoda",
    "bdf",
    "midpoint",
    "midpoint4",
    "midpoint6",
    "events",
}
TYPED |= {"section", "simulation", "ledger", "results", "det", "omega", "rising", "hold", "outside", "tanh", "error"}

PENDULUM = "double-pendulum"
#: Name of a system, options: a plan, a proof, constraints, inputs, what ends.
SCENES = {
    "usual": (PENDULUM, "--time 5 -v"),
    "unjudged": (PENDULUM, "--time 2 --no-estimate -v --method rk4 --step 0.03 --every 0.1"),
    "plan": ("satellite", "--time 5 --accuracy 1e-6 --plan"),
    "planned": (PENDULUM, "--time 2 --accuracy 1e-5 -v"),
    "proved": (PENDULUM, "--time 1 --certify --method rk4 --step 0.01"),
    "watched": (PENDULUM, '--time 5 --event "theta1 = 0" --stop "theta2 > 1"'),
    "constraints": ("four-bar", "--time 2 -v"),
    "inputs": ("cart-pole", "--time 2 -v"),
    "too long": (PENDULUM, "--time 50 --step-limit 20"),
}  # fmt: skip


def told(name: str, options: str, language: str, folder: Path, command: str = "simulate") -> list[str]:
    """Lines on both streams, without the names of files and commands to be pasted."""
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    text = re.sub(r"^name:", f"language: {language}\nname:", text, count=1, flags=re.M)
    file = folder / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    words = [x.strip('"') for x in re.findall(r'"[^"]*"|\S+', options)]
    done = CliRunner().invoke(main, [command, str(file), *words, "--format", "csv" if command == "simulate" else "json",
                                     "--out", str(folder / "out")])  # fmt: skip
    assert done.exit_code in (0, 3), done.output
    lines = [*done.stdout.splitlines(), *done.stderr.splitlines()]
    return [x.replace(str(folder), "") for x in lines if not x.startswith("mbsym simulate ")]


def strange(name: str, lines: list[str]) -> set[str]:
    """Latin words that nobody declared or typed."""
    system = mbsym.load(SHIPPED / f"{name}.yaml").system
    known = [system.name, *(body.name for body in system.bodies), *system.parameter_names, *system.coordinates]
    names = {word.lower() for text in known for word in re.findall(r"[A-Za-z0-9]+", text)} | {x.lower() for x in TYPED}
    found = {
        word
        for line in lines
        for word in re.findall(r"[A-Za-z]{3,}\d*", re.sub(r"error\[[a-z-]+\]|-[a-z-]+", "", line))
    }
    return {x for x in found if x.lower().removesuffix("_dot") not in names and x not in ("dot", "scene", "out")}


@pytest.mark.parametrize("scene", SCENES)
def test_no_english_is_said_of_a_run_in_russian(scene: str, tmp_path: Path) -> None:
    name, options = SCENES[scene]
    lines = told(name, options, "ru", tmp_path)
    assert len(lines) > 4
    assert not strange(name, lines)


def test_a_run_in_spanish_says_no_english_sentence(tmp_path: Path) -> None:
    lines = " ".join(told(PENDULUM, "--time 5 -v", "es", tmp_path))
    for part in ("energía", "se conserva (demostrado)", "deriva máxima", "compilado", "explícito", "pasos: "):
        assert part in lines
    assert not re.search(r"\b(the|of|with|and|steps|proved)\b", lines)


def test_the_ledger_is_told_in_russian(tmp_path: Path) -> None:
    lines = told("satellite", "--ledger --problems 1-3", "ru", tmp_path, "run")
    place = next(k for k, x in enumerate(lines) if "ведомость" in x)
    assert not strange("satellite", lines[place:])


def test_a_sentence_without_translation_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: one message about the energy stays English."""
    sentence = Language.sentence
    english = "[[standing]]; largest drift [[measured]]"
    monkeypatch.setattr(Language, "sentence", lambda self, x, *a: x if x == english else sentence(self, x, *a))
    with pytest.raises(AssertionError, match="largest"):
        test_no_english_is_said_of_a_run_in_russian("usual", tmp_path)


def test_what_was_integrated_stands_before_how(tmp_path: Path) -> None:
    """Its error and what it keeps; with -v the method, its setting and work behind them."""
    short, long = (told(PENDULUM, f"--time 5 {more}", "en", tmp_path) for more in ("", "-v"))
    titles = [[line.split()[0] for line in lines] for lines in (short, long)]
    assert titles[0] == ["Double", "time", "error", "energy", "files"]
    assert titles[1] == ["Double", "time", "error", "energy", "method", "setting", "work", "files"]
