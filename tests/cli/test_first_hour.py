"""From nothing to a derivation: new descriptions run as they are, examples are copied, saving derives again."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import Result
from conftest import SHIPPED, filed, invoked, system_of

from mbsym.analysis import Analysis
from mbsym.source import read
from mbsym.source.examples import example_like, example_names, example_text
from mbsym.source.starter import JOINTS, NewBody, starter
from mbsym_cli import new
from mbsym_cli.main import COMMANDS, GROUPS


def command(*words: str, code: int | None = None, answers: str | None = None) -> Result:
    return invoked(*words, input=answers, code=code)


# --- the list of commands ---------------------------------------------------------------------------------------------


def test_no_line_of_help_is_cut() -> None:
    lines = command("--help").stdout.splitlines()
    assert not [line for line in lines if line.rstrip().endswith("...") and "COMMAND" not in line]
    listed = [line.split()[0] for line in lines if re.match(r"  [a-z]+ +[A-Z]", line)]
    assert sorted(listed) == sorted(COMMANDS)
    assert listed == [name for names in GROUPS.values() for name in names]


# --- starters ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", JOINTS)
def test_a_body_on_any_joint_runs(joint: str) -> None:
    """The coordinates are those of the joint: rotations and translations; the equations check themselves."""
    rotations = {"hinge": 1, "cardan": 2, "ball": 3, "slider": 0, "free": 3, "fixed": 0}[joint]
    translations = {"slider": 1, "free": 3}.get(joint, 0)
    bodies = [NewBody("base"), NewBody("arm 2", "base", joint), NewBody("tip", "arm 2")]
    system, complaints = read(starter("A: b # c", bodies), "new.yaml")
    assert system is not None, [one.message for one in complaints]
    assert not complaints.items
    assert system.name == "A: b # c"
    assert len(system.coordinates) == 2 + rotations + translations
    analysis = Analysis(system)
    assert analysis.checks
    assert not [check for check in analysis.checks if check.failed]


def test_what_never_turns_has_a_mass_alone() -> None:
    """No moment of a cart is in (m1 + m2) x'' + ..., and none is asked for; of a slider on its pole there is."""
    text = starter("Cart", [NewBody("cart", None, "slider"), NewBody("pole", "cart"), NewBody("tip", "pole", "slider")])
    system = system_of(text, "cart.yaml")
    given = {one.name for one in system.parameters}
    assert {"l1", "J11", "d1"}.isdisjoint(given)
    assert {"m1", "m2", "d2", "l2", "J23", "m3", "l3", "J33"} <= given
    assert not [check for check in Analysis(system).checks if check.failed]


def test_a_starter_refuses_what_is_no_tree() -> None:
    with pytest.raises(ValueError, match="joint"):
        starter("x", [NewBody("a", None, "weld")])
    with pytest.raises(ValueError, match="before"):
        starter("x", [NewBody("a", "b"), NewBody("b")])


# --- new --------------------------------------------------------------------------------------------------------------


def test_new_where_nobody_answers_takes_the_pendulum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert command("new", "my-crane").exit_code == 0
    text = Path("my-crane.yaml").read_text(encoding="utf-8")
    system, complaints = read(text, "my-crane.yaml")
    assert system is not None
    assert not complaints.items
    assert system.name == "My crane"
    assert "# " in text
    again = command("new", "my-crane", code=2)
    assert "there already" in again.stderr
    assert Path("my-crane.yaml").read_text(encoding="utf-8") == text


def test_new_begins_with_the_example_of_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, example in (
        ("spring-pendulum", "spring-pendulum"),
        ("my_cart_pole", "cart-pole"),
        ("crane", "simple-pendulum"),
    ):
        assert f"begun with the example {example}\n" in command("new", name, code=0).stdout


def test_words_of_other_programs_lead_on() -> None:
    assert "did you mean connection point?" in command("explain", "translation", code=2).stderr
    assert "did you mean '--x k=0:1'?" in command("map", "ball.yaml", "k", "c", code=2).stderr


def test_what_new_says_to_run_can_be_pasted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    told = command("new", "a b.yaml", "--like", "pendulum").stdout
    assert "mbsym run 'a b.yaml' " in told
    assert "mbsym watch 'a b.yaml' " in told


def test_new_asks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(new, "_answers", lambda: True)  # click's own input stands for a terminal
    done = command("new", "crane", answers="\n3\ncart\nslider\ncart\nhook\ncart\ncardan\nload\n0\nfree\ny\n", code=0)
    assert "another body is called so" in done.stderr
    system = system_of(Path("crane.yaml").read_text(encoding="utf-8"), "crane.yaml")
    assert [(body.name, body.attached_to) for body in system.bodies] == [("cart", "0"), ("hook", "cart"), ("load", "0")]
    assert len(system.coordinates) == 1 + 2 + 6


@pytest.mark.parametrize(
    ("word", "name"), [("pendulum", "simple-pendulum"), ("top", "heavy-top"), ("arm", "spatial-arm")]
)
def test_like_knows_what_is_meant(word: str, name: str) -> None:
    assert example_like(word) == name


def test_like_guesses_at_slips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = command("new", "x", "--like", "satelite", code=2)
    assert "did you mean 'satellite'?" in done.stderr
    assert not list(tmp_path.iterdir())


# --- examples ---------------------------------------------------------------------------------------------------------


def test_examples_are_the_shipped_systems(tmp_path: Path) -> None:
    assert set(example_names()) == {path.stem for path in SHIPPED.glob("*.yaml")}
    listed = command("examples").stdout
    assert all(name in listed for name in example_names())
    assert command("examples", "--all", "--out", str(tmp_path / "mine")).exit_code == 0
    for name in example_names():
        text = (tmp_path / "mine" / f"{name}.yaml").read_text(encoding="utf-8")
        assert text == example_text(name) == (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    assert command("examples", "ziegler", "--out", str(tmp_path / "mine")).exit_code == 2  # nothing is replaced
    assert command("examples", "zigler").exit_code == 2


# --- watch ------------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_watch_derives_again_on_save(tmp_path: Path) -> None:
    """First run, a save with a mistake, a save that mends it, a save by exchange of the file; Ctrl-C ends it."""
    file, log = tmp_path / "p.yaml", tmp_path / "log"
    good = example_text("simple-pendulum")
    file.write_text(good, encoding="utf-8")
    words = [
        sys.executable,
        "-m",
        "mbsym_cli",
        "watch",
        str(file),
        "--brief",
        "-f",
        "json",
        "-o",
        str(tmp_path / "out"),
    ]
    with log.open("w") as stream, subprocess.Popen(words, stdout=stream, stderr=stream, cwd=tmp_path) as child:
        try:
            _wait(log, "waiting for changes", 1)
            assert (tmp_path / "out" / "results.json").exists()
            file.write_text(good.replace("[theta]", "[thetta]"), encoding="utf-8")
            _wait(log, "waiting for changes", 2)
            assert "unknown name" in log.read_text()
            other = filed(tmp_path / "other", good.replace("Simple pendulum", "Renamed pendulum"))
            other.replace(file)
            _wait(log, "waiting for changes", 3)
            assert "Renamed pendulum" in (tmp_path / "out" / "results.json").read_text()
            child.send_signal(signal.SIGINT)
            assert child.wait(30) == 130
        finally:
            child.kill()


def _wait(log: Path, text: str, count: int) -> None:
    end = time.monotonic() + 120
    while " ".join(log.read_text().split()).count(text) < count:  # lines are wrapped where paths are long
        assert time.monotonic() < end, log.read_text()
        time.sleep(0.05)
