"""Descriptions that once ended in a crash, a hang or a broken output: results or a reason, and files that are taken.

``tests/cases/hostile`` holds them.  Others are made by small changes of shipped descriptions, the same ones each time;
``MBSYM_GRAFTS=1000`` tries so many.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest
from conftest import OWN, SHIPPED, TESTS, invoked, system_of
from jsonschema import Draft202012Validator
from mutants import grafted, mutant, variant
from terminal import told

from mbsym.analysis import Analysis
from mbsym.analysis.soundness import complain
from mbsym.model.system import System
from mbsym.report.schemas import schema
from mbsym.report.targets import TARGETS
from mbsym.report.whole_run import rendered
from mbsym.source import load, read, to_text, to_yaml

CASES = TESTS / "cases"
HOSTILE = sorted((CASES / "hostile").glob("*.yaml"))
RESULTS = Draft202012Validator(schema("results"))

#: What a terminal would obey.
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")

GRAFTS = int(os.environ.get("MBSYM_GRAFTS", "30"))


def compilers() -> list[str]:
    return [name for name in ("gcc", "clang") if shutil.which(name)]


def check_c(folder: Path) -> None:
    """Whatever the system, the code has no warning of any compiler."""
    for compiler in compilers():
        command = [compiler, "-fsyntax-only", "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "model.c"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def check_json(text: str) -> None:
    def refused(constant: str) -> None:
        raise AssertionError(f"{constant} is no JSON")

    found = json.loads(text, parse_constant=refused)
    assert [f"{list(x.absolute_path)}: {x.message}" for x in RESULTS.iter_errors(found)] == []


@pytest.mark.parametrize("path", HOSTILE, ids=lambda path: path.stem)
def test_a_run_ends_in_results_or_in_a_reason(path: Path, tmp_path: Path) -> None:
    done = invoked("run", path, "--problems", "1-8", "--out", tmp_path)
    assert done.exit_code in (0, 2), done.output
    assert "internal error" not in done.output
    assert not CONTROL.search(done.output)
    said = [line for line in done.stderr.splitlines() if not re.match(r" *\d+ \| ", line)]  # no quoted lines
    assert not [line for line in said if line.rstrip().endswith(":")]
    assert not [line for line in done.stdout.splitlines() if re.search(r"\S  \(|from \(", line.strip())]
    if done.exit_code == 0:
        check_json((tmp_path / "results.json").read_text(encoding="utf-8"))
        check_c(tmp_path)


@pytest.mark.parametrize("command", ["check", "convert", "groups", "equilibria", "symmetries"])
def test_other_commands_end_so_too(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in HOSTILE:
        done = invoked(command, path)
        assert done.exit_code in (0, 1, 2), (path, done.output)
        assert "internal error" not in done.output, path
        assert not CONTROL.search(done.output), path
        assert done.exit_code == 0 or done.stderr.strip(), path


# --- what is converted ------------------------------------------------------------------------------------------------


def check_converted(system: System) -> None:
    """What ``convert`` writes is taken, and means the same system."""
    for write, name in ((to_yaml, "converted.yaml"), (to_text, "converted.txt")):
        text = write(system)
        again = system_of(text, name)
        assert again == system, text


DESCRIPTIONS = sorted({*SHIPPED.glob("*.*"), *OWN.glob("*.yaml"), *CASES.rglob("*.yaml")})


def test_every_description_is_converted_to_itself() -> None:
    tried = 0
    for path in DESCRIPTIONS:
        if path.suffix in (".yaml", ".txt"):
            system, _, _ = load(path)
            if system is not None:
                check_converted(system)
                tried += 1
    assert tried > 100


def test_dependent_beside_no_constraints_means_nothing() -> None:
    text = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    for written in ("dependent: [theta]\n", "constraints: []\ndependent: [theta]\n"):
        system, complaints = read(text + "\n" + written)
        assert system is None
        assert [item.code for item in complaints.errors] == ["idle-constraint"]


@pytest.mark.parametrize("block", range(4))
def test_changed_descriptions_are_converted_to_themselves(block: int) -> None:
    tried = 0
    for number in range(block, max(80, 4 * GRAFTS), 4):
        chance = Random(f"converted {number}")
        path = chance.choice([path for path in DESCRIPTIONS if path.parent in (SHIPPED, OWN)])
        change = chance.choice((mutant, variant, grafted))
        system, _ = read(change(path.read_text(encoding="utf-8"), chance), "changed.yaml")
        if system is not None:
            check_converted(system)
            tried += 1
    assert tried


# --- changed trees ----------------------------------------------------------------------------------------------------

SMALL = [path for path in [*sorted(SHIPPED.glob("*.yaml")), *sorted(OWN.glob("*.yaml"))] if path.stat().st_size < 3000]


@pytest.mark.parametrize("block", range(3))
def test_a_changed_tree_costs_no_result(block: int, tmp_path: Path) -> None:
    """Checked, derived within a small budget, written in all formats: no internal error, and every file is taken."""
    for number in range(block, GRAFTS, 3):
        chance = Random(f"graft {number}")
        text = grafted(chance.choice(SMALL).read_text(encoding="utf-8"), chance)
        system, complaints = read(text, "grafted.yaml")
        if system is not None:
            complain(system, complaints)
        if system is None or complaints.errors:
            continue
        analysis = Analysis(system, tuple(range(1, 9)), terms=2000)
        for problem in analysis.problems:
            analysis.stage(problem)
        files = [file for target in TARGETS.values() for file in rendered(target, analysis, analysis.problems)]
        assert not analysis.defects, text
        assert not [file for file in files if file.failure is not None or file.withheld], text
        assert all(check.detail for check in analysis.checks if check.failed), text
        assert "internal error" not in str([told(analysis, problem) for problem in analysis.problems]), text
        for file in files:
            if file.filename in ("model.c", "model.h") and file.text is not None:
                (tmp_path / file.filename).write_text(str(file.text), encoding="utf-8")
            elif file.filename == "results.json":
                check_json(str(file.text))
        check_c(tmp_path)
