"""Formulas that nobody would read are counted; reports stay short and say what they left out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import SHIPPED, compiled_latex, derived, needs_pdflatex

import mbsym
from mbsym.analysis import Analysis
from mbsym.report import wolfram_report
from mbsym.report.latex import report as latex_report
from mbsym.report.latex import writer as latex_writer
from mbsym.report.lengths import FILE, PAPER, Limit, formulas, withheld
from mbsym.report.targets import TARGETS
from tests.report.readers import unreadable

REPORTS = ("latex", "wolfram", "json")


def chain(joints: int) -> Analysis:
    """A spatial chain of tensors and places in letters, whose formulas double with every joint."""
    bodies = [
        f"  - {{name: link {k}, attached to: {'0' if k == 1 else f'link {k - 1}'},"
        f" rotation: {{axes: [{k % 3 + 1}], angles: [q{k}]}}, connection point: [a, b, 1], mass centre: [b, 0, a],"
        f" mass: m, inertia about: mass centre, inertia: [J, J, {k}*J]}}"
        for k in range(1, joints + 1)
    ]
    return mbsym.loads("\n".join(["mbsym: 1", "name: chain", "parameters: [a, b, m, J]", "bodies:", *bodies]))


@pytest.fixture(scope="module")
def long() -> Analysis:
    """Kinetic energy of 9,000 terms, right-hand sides of 36,000."""
    analysis = chain(7)
    assert analysis.energy.kinetic_energy.terms > FILE.longest
    return analysis


def test_every_shipped_formula_is_printed() -> None:
    for path in sorted(SHIPPED.glob("*.yaml")):
        analysis = derived(path)
        # Nobody prints T of the bicycle (2604 terms) or its right-hand sides; what is printed of it is problem 5.
        shown = (5,) if path.stem == "bicycle" else (1, 2, 3, 7)
        results = [analysis.stage(number).value for number in shown]
        assert not withheld(results, PAPER), path.name


def test_the_shortest_come_first_and_every_problem_has_its_room() -> None:
    analysis = chain(2)
    found = list(formulas(analysis.energy))
    short, longest = min(found, key=lambda x: x.terms), max(found, key=lambda x: x.terms)
    hidden = withheld([analysis.energy], Limit(longest.terms, longest.terms + 1))
    assert id(longest) in hidden
    assert id(short) not in hidden
    kinematics = withheld([analysis.kinematics, analysis.energy], Limit(longest.terms - 1, 10_000))
    assert kinematics == {id(x) for x in found if x.terms == longest.terms}


def test_reports_of_a_long_chain_are_short_and_whole(long: Analysis) -> None:
    for name in REPORTS:
        text = TARGETS[name].render(long, long.problems)
        assert len(text) < 4_000_000
        assert not unreadable(TARGETS[name].filename, text)
    tex = TARGETS["latex"].render(long, long.problems)
    assert len(tex) < 2_000_000
    length = long.energy.kinetic_energy.terms
    wolfram = TARGETS["wolfram"].render(long, long.problems)
    assert f'kineticEnergy = "{length} terms, not printed";' in wolfram
    assert "dynamics[t_" in wolfram  # equations that are not whole are none: the program takes their place
    assert "equations = Thread" not in wolfram
    found = json.loads(TARGETS["json"].render(long, long.problems))
    assert found["energy"]["kinetic_energy"]["terms"] == length
    for i, row in enumerate(long.equations.mass_matrix):
        for j, entry in enumerate(row):
            written = found["equations"]["mass_matrix"][i][j]
            assert written == str(entry) or written["terms"] == entry.terms
            assert (entry.terms <= FILE.longest) or written != str(entry)


@needs_pdflatex
def test_a_report_with_counted_formulas_compiles(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    analysis = chain(2)
    monkeypatch.setattr(latex_report, "PAPER", Limit(3, 20))
    text = latex_report.render(analysis, (1, 2, 3))
    assert "terms, not printed" in text
    compiled_latex(text, tmp_path)


def test_long_programs_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = chain(3)
    analysis.terms = 2  # no closed form
    assert analysis.stage(3).failure is not None
    whole = latex_report.render(analysis, (3,)), wolfram_report.render(analysis, (3,))
    assert "s_{1} =" in whole[0]
    assert "dynamics[t_" in whole[1]
    monkeypatch.setattr(latex_writer, "PAPER_PROGRAM", 5)
    monkeypatch.setattr(wolfram_report, "FILE_PROGRAM", 5)
    for text in (latex_report.render(analysis, (3,)), wolfram_report.render(analysis, (3,))):
        assert "operations, not printed; model.py and model.c have them" in text
        assert "dynamics[t_" not in text
        assert "s_{1} =" not in text
