"""The end of the command's process: at once, but not before everything is done that has to be."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import mbsym_cli

SCRIPT = """
import atexit, sys, threading, time
from mbsym_cli.process import command

class Built:
    def __del__(self):
        print("taken down", file=sys.__stderr__, flush=True)

built = Built()
atexit.register(lambda: print("registered", file=sys.__stderr__, flush=True))
{before}
sys.argv = ["mbsym", *{arguments!r}]
try:
    command()
finally:
    print("came back", file=sys.__stderr__, flush=True)
"""
LOOKING_ON = "sys.setprofile(lambda *_: None)"
AT_WORK = "threading.Thread(target=lambda: (time.sleep(1), print('worked', file=sys.__stderr__, flush=True))).start()"


def ended(*arguments: str, before: str = "") -> subprocess.CompletedProcess[str]:
    script = SCRIPT.format(before=before, arguments=list(arguments))
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)


def test_it_ends_at_once_with_everything_said() -> None:
    done = ended("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("mbsym")
    assert "registered" in done.stderr, "what registered for the end is called"
    assert "taken down" not in done.stderr
    assert "came back" not in done.stderr


@pytest.mark.parametrize(("arguments", "code"), [(("check", "there-is-no-such.yaml"), 2), (("nonsense",), 2)])
def test_the_exit_code_is_the_commands(arguments: tuple[str, ...], code: int) -> None:
    done = ended(*arguments)
    assert done.returncode == code
    assert "no" in done.stderr
    assert "taken down" not in done.stderr
    assert "came back" not in done.stderr


def test_who_looks_on_sees_the_end() -> None:
    """A profiler writes what it has seen when the command has come back to it."""
    assert "came back" in ended("--version", before=LOOKING_ON).stderr


def test_a_thread_that_is_at_work_is_waited_for() -> None:
    done = ended("--version", before=AT_WORK)
    assert done.returncode == 0
    assert "worked" in done.stderr
    assert "taken down" in done.stderr


def test_output_that_nobody_takes_is_told() -> None:
    with open("/dev/full", "w") if sys.platform == "linux" else pytest.skip("/dev/full") as full:
        done = subprocess.run(
            [sys.executable, "-m", "mbsym_cli", "--help"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    assert "standard output cannot be written" in done.stderr


WHILE_IT_LOADS = """
class Interrupts:
    def find_spec(self, name, path=None, target=None):
        if name == "mbsym_cli.main":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupts())
"""


def test_interrupted_while_modules_load() -> None:
    done = ended("--version", before=WHILE_IT_LOADS)
    assert done.returncode == 130
    assert "interrupted" in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_the_code_of_an_interruption_is_that_of_the_command() -> None:
    from mbsym.studies.study import Exit
    from mbsym_cli import process

    assert process.INTERRUPTED == Exit.INTERRUPTED


def test_nothing_is_asked_that_click_keeps_to_itself() -> None:
    """Private names change from version to version: with click 8.1, which was allowed, no command ran."""
    (folder,) = mbsym_cli.__path__
    trees = (ast.walk(ast.parse(path.read_text(encoding="utf-8"))) for path in Path(folder).rglob("*.py"))
    asked = [x for tree in trees for x in tree if isinstance(x, ast.Attribute) and isinstance(x.value, ast.Name)]
    assert [x for x in asked if x.attr == "meta" and x.value.id == "context"], "contexts are found by their name"
    assert not [x.attr for x in asked if x.value.id in ("context", "ctx", "click") and x.attr.startswith("_")]
