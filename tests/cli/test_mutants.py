"""Mutated descriptions, the same ones each time: nothing crashes, and every generated file is taken by its language."""

from __future__ import annotations

import json
import shutil
import subprocess
import time
from pathlib import Path
from random import Random
from typing import Any

import pytest
from mutants import mutant, variant
from terminal import told
from test_reports import uncommented

from mbsym.analysis import Analysis
from mbsym.model.system import System
from mbsym.report.targets import TARGETS
from mbsym.report.whole_run import rendered
from mbsym.source import read, render
from tests.report.readers import unreadable

ROOT = Path(__file__).parents[2]
SYSTEMS = ROOT / "systems"
EVERY = sorted(path for path in SYSTEMS.iterdir() if path.suffix in {".yaml", ".txt"})

#: Small systems of every kind: rotations, lengths, springs, dampers, orbits, spins, followers.
SMALL = [
    SYSTEMS / f"{name}.yaml"
    for name in ("simple-pendulum", "spring-pendulum", "dumbbell", "ziegler-damped", "heavy-top", "spherical-pendulum")
]

GCC = shutil.which("gcc")


#: Fragments of what a description, or a run, need not have: claims, and problem 8.
NOT_ALWAYS = {
    "fragments/claims.tex",
    "fragments/stabilisation.tex",
    "fragments/polynomial_integrals.tex",
    "fragments/invariant_sets.tex",
    "fragments/normal_forms.tex",
    "fragments/small_parameters.tex",
}


def valid(number: int) -> tuple[str, System]:
    """The first variant of a small system, from a number on, that is a description."""
    chance = Random(f"variant {number}")
    for _ in range(50):
        text = variant(chance.choice(SMALL).read_text(encoding="utf-8"), chance)
        system, _ = read(text)
        if system is not None:
            return text, system
    raise AssertionError("most variants are descriptions")


@pytest.mark.parametrize("block", range(6))
def test_reading_never_crashes(block: int) -> None:
    """Every complaint can be shown, and shows nothing that a terminal would obey."""
    refused = 0
    for number in range(40):
        chance = Random(f"mutant {block} {number}")
        text = mutant(chance.choice(EVERY).read_text(encoding="utf-8"), chance)
        started = time.process_time()
        system, complaints = read(text, "mutant.yaml")
        assert time.process_time() - started < 20
        assert (system is None) == bool(complaints.errors)
        refused += system is None
        shown = "\n".join(render(item, text, "mutant.yaml") for item in complaints.items)
        assert all(character.isprintable() or character == "\n" for character in shown)
    assert refused > 5


def check_files(number: int, folder: Path) -> dict[str, str]:
    """All files of a variant's run, each read by its own language; their texts."""
    text, system = valid(number)
    analysis = Analysis(system)
    for problem in analysis.problems:
        analysis.stage(problem)
    _ = analysis.checks, analysis.claims
    files = [file for target in TARGETS.values() for file in rendered(target, analysis, analysis.problems)]
    assert not analysis.defects, text
    assert not [file for file in files if file.failure is not None or file.withheld], text
    assert {file.filename for file in files if file.text is None} <= NOT_ALWAYS
    assert all(told(analysis, problem) for problem in analysis.problems)
    texts = {file.filename: str(file.text) for file in files if file.text is not None}
    for name, content in texts.items():
        assert not unreadable(name, content), (name, text)
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content, encoding="utf-8")
    module: dict[str, Any] = {}
    exec(compile(texts["model.py"], "model.py", "exec"), module)
    assert set(module["DEFAULTS"]) == set(system.parameter_names)
    assert json.loads(texts["results.json"])["coordinates"] == list(system.coordinates)
    if GCC is not None:
        command = [GCC, "-fsyntax-only", "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "model.c"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr + text
    return texts


@pytest.mark.parametrize("number", range(8))
def test_every_file_is_taken_by_its_language(number: int, tmp_path: Path) -> None:
    check_files(number, tmp_path)


@pytest.mark.parametrize("block", range(1, 15))
def test_every_file_of_some_hundred_is_taken_by_its_language(block: int, tmp_path: Path) -> None:
    for number in range(10 * block, 10 * block + 10):
        check_files(number, tmp_path)


def test_wolfram_reads_mutated_reports(tmp_path: Path) -> None:
    """Mathics, where it is installed, takes them as they are."""
    pytest.importorskip("mathics")
    from mathics.core.load_builtin import import_and_load_builtins

    import_and_load_builtins()
    from mathics.session import MathicsSession

    session = MathicsSession(add_builtin=True, character_encoding="UTF-8")
    for number in range(0, 40, 8):
        report = check_files(number, tmp_path)["report.wl"]
        session.reset()
        session.evaluate(f"({uncommented(report)}; reached = True)")
        assert str(session.evaluate("reached")) == "System`True", report
        assert str(session.evaluate("Head[kineticEnergy]")) != "System`Symbol", report
