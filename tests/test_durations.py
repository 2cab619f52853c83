"""``make test`` leaves out what is slow and nothing else, ``make test-all`` leaves out nothing.

CI runs all of it on a machine that is quick enough, and a sixth of what is slow at least, in turns, on any.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import conftest
import durations
import hypothesis
import pytest
from durations import RECORDED, SLOW, processor_time, updated
from properties import settings

TESTS = Path(__file__).parent
ROOT = TESTS.parent
SOURCES = {path: path.read_text(encoding="utf-8") for path in TESTS.rglob("*.py")}


def recipe(target: str) -> str:
    """What make runs for it, and for what it needs."""
    lines = (ROOT / "Makefile").read_text(encoding="utf-8").splitlines()
    (start,) = (number for number, line in enumerate(lines) if line.startswith(f"{target}: "))
    own = lines[start + 1 : lines.index("", start)]
    needed = [recipe(name) for name in lines[start].split()[1:] if name.startswith("test")]
    return "\n".join([*needed, *own])


def test_together_the_two_runs_are_all() -> None:
    """``not slow`` and ``slow or ...`` leave out no case, whatever its marks."""
    assert '$(TESTS) -m "not slow"' in recipe("test")
    assert '$(TESTS) -m "slow or hypothesis" --hypothesis-profile thorough' in recipe("test-slow")
    assert recipe("test-all") == recipe("test") + "\n" + recipe("test-slow")


def test_ci_runs_the_command_of_the_readme_and_what_it_leaves_out() -> None:
    run = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert re.findall(r"^ *make (test\S*)", run, re.MULTILINE) == ["test", "test-slow"]
    (turns,) = re.findall(r"^first=.*^done$", run, re.MULTILINE | re.DOTALL)
    for seconds, count in ((0, 6), (5400, 1)):
        shell = f"make() {{ echo $2; }}; git() {{ echo c0ffee; }}; SECONDS={seconds}; {turns}"
        told = subprocess.run(["bash", "-euc", shell], capture_output=True, text=True, check=True).stdout.splitlines()
        parts = [line for line in told if line.startswith("PART")]
        assert len({*parts}) == len(parts) == count
        assert {*parts} <= {f"PART={k}/6" for k in range(1, 7)}
    assert re.search(r"^make test ", (ROOT / "README.md").read_text(encoding="utf-8"), re.MULTILINE)


def test_what_is_recorded_exists() -> None:
    functions = {tuple(name.partition("[")[0].split("::")) for name in RECORDED}
    gone = [name for name in functions if f"\ndef {name[-1]}(" not in SOURCES.get(ROOT / name[0], "")]
    assert not gone


def test_all_that_is_recorded_is_slow_and_nothing_is_called_so_by_hand() -> None:
    assert min(RECORDED.values()) >= SLOW
    by_hand = "mark" + ".slow"
    assert not [str(path) for path, text in SOURCES.items() if by_hand in text]


def test_processes_count_while_they_run_and_when_they_have_ended() -> None:
    burn = "import time\nwhile time.process_time() < 0.3: pass\nprint(flush=True)\ninput()"
    before = processor_time()
    with subprocess.Popen([sys.executable, "-c", burn], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        running = processor_time() - before
        child.communicate(b"\n")
    assert 0.25 < running <= processor_time() - before + 0.02


def test_a_function_is_recorded_anew_with_all_its_cases() -> None:
    """Of f one case has become quick and one is gone; g was not run."""
    old = {"a.py::f[1]": 3.0, "a.py::f[2]": 4.0, "a.py::f[gone]": 5.0, "a.py::g": 6.0}
    measured = {"a.py::f[1]": 0.1, "a.py::f[2]": SLOW + 1.04, "a.py::h": 0.1}
    assert updated(old, measured) == {"a.py::f[2]": round(SLOW + 1.04, 1), "a.py::g": 6.0}


SUITE = """
import time, pytest

@pytest.mark.parametrize("seconds", [0, 0.4])
def test_burns(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
"""


def test_what_is_slow_is_named_recorded_and_then_left_out(tmp_path: Path) -> None:
    """A suite of two cases, where 0.1 s are slow: told of the slow one, it is recorded, and not run any more."""
    text = (TESTS / "durations.py").read_text(encoding="utf-8")
    assert f"SLOW = {SLOW}\n" in text
    (tmp_path / "durations.py").write_text(text.replace(f"SLOW = {SLOW}\n", "SLOW = 0.1\n"), encoding="utf-8")
    (tmp_path / "durations.json").write_text("{}")
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = slow: it is\n")
    hooks = [name for name in vars(durations) if name.startswith("pytest_")]
    assert all(getattr(conftest, name) is getattr(durations, name) for name in hooks)
    (tmp_path / "conftest.py").write_text(f"from durations import {', '.join(hooks)}\n")
    (tmp_path / "test_it.py").write_text(SUITE)

    def run(*words: str) -> str:
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "xdist", *words]
        environment = {**os.environ, "PYTHONPATH": str(tmp_path), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True).stdout

    assert re.search(r"^0\.[4-9] s of processor  test_it\.py::test_burns\[0\.4\]$", run(), re.MULTILINE)
    assert "of processor" not in run("--record-durations", "--numprocesses", "2")  # spread over processes
    recorded = json.loads((tmp_path / "durations.json").read_text(encoding="utf-8"))
    assert recorded == {"test_it.py::test_burns[0.4]": pytest.approx(0.5, abs=0.15)}
    assert "1 passed" in (left := run("-m", "not slow"))
    assert "of processor" not in left
    parts = [re.findall(r"(\d) passed", run("--part", f"{k}/2", "-p", "no:cacheprovider")) for k in (1, 2)]
    assert sum(int(count) for found in parts for count in found) == 2


def test_properties_are_tried_on_a_quarter_or_on_all() -> None:
    before = hypothesis.settings.get_current_profile_name()
    try:
        hypothesis.settings.load_profile("quick")
        assert (settings(max_examples=150).max_examples, settings().max_examples) == (38, 25)
        hypothesis.settings.load_profile("thorough")
        assert (settings(max_examples=150).max_examples, settings().max_examples) == (150, 100)
    finally:
        hypothesis.settings.load_profile(before)


def test_no_property_has_a_number_of_its_own() -> None:
    """All settings are those of ``properties``."""
    importing = re.compile(r"^from hypothesis import .*\bsettings\b|^ *@hypothesis\.settings\(", re.MULTILINE)
    assert not [str(path) for path, text in SOURCES.items() if importing.search(text)]
