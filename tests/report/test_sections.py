"""Every numbered problem is shown everywhere: a new one needs its own files and nothing else."""

from __future__ import annotations

import re
from importlib.resources import files

import pytest
from conftest import SHIPPED
from terminal import told

import mbsym
from mbsym.analysis import PROBLEMS, USUAL_PROBLEMS, Problem
from mbsym.formulas.latex import write_as
from mbsym.formulas.tree import angles_as
from mbsym.model.system import LANGUAGES
from mbsym.report.latex.report import render
from mbsym.report.sections import section_of
from mbsym.report.targets import TARGETS
from mbsym.report.whole_run import rendered


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=lambda problem: problem.attribute)
def test_every_problem_has_its_section_and_what_wolfram_has_of_it(problem: Problem) -> None:  # type: ignore[type-arg]
    """Of problems that are derived where they are named the words follow from the section, of others nothing does."""
    section = section_of(problem)
    assert callable(section.data)
    assert callable(section.content)
    template = files("mbsym_templates") / "wolfram" / f"{problem.attribute}.j2"
    assert template.is_file() or problem.number not in USUAL_PROBLEMS
    assert not template.is_file() or f"{problem.number} in found" in template.read_text(encoding="utf-8")


HAT = """
mbsym: 1
name: a ring of rests
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: (x**2 + y**2 - 1)**2/4
motion: {x: 1, y: 0}
"""


def test_a_subsystem_is_judged_while_the_others_keep_to_the_motion() -> None:
    """At (1, 0) x'' = -2 x + ... alone is stable; but y drifts round the ring, and takes x along to -1."""
    analysis = mbsym.loads(HAT)
    lines = told(analysis, 6)
    assert any(one.startswith("Verdict: stable (Lagrange-Dirichlet)") for one in lines)
    (whole,) = [one for one in lines if "For the whole system" in one]
    assert whole.startswith("Each of these verdicts is about coordinates of one subsystem while the others keep to")
    assert "while the others keep to the unperturbed motion" in render(analysis, (6,))


def test_what_was_printed_for_one_file_is_not_taken_where_something_else_was_asked_for() -> None:
    """Formulas are printed once for all LaTeX files: those of one way of writing angles are none of another's."""
    analysis = mbsym.load(SHIPPED / "double-pendulum.yaml")
    fresh = {}
    for angles in ("products", "sums"):
        with angles_as(angles):  # type: ignore[arg-type]
            fresh[angles] = render(mbsym.load(SHIPPED / "double-pendulum.yaml"), (3,))
    assert fresh["products"] != fresh["sums"]
    for angles in ("sums", "products", "sums"):
        with angles_as(angles):  # type: ignore[arg-type]
            assert render(analysis, (3,)) == fresh[angles]


def test_a_formula_is_printed_anew_when_its_names_are_written_otherwise() -> None:
    analysis = mbsym.load(SHIPPED / "double-pendulum.yaml")
    entry = analysis.equations.mass_matrix[0, 0]
    name = analysis.system.parameters[0].name
    assert r"\mathcal{X}" not in entry.latex()
    write_as(analysis.ring, {name: r"\mathcal{X}"})
    assert r"\mathcal{X}" in analysis.equations.mass_matrix[0, 0].latex()


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_sentence_ends_twice(language: str) -> None:
    """Numbers of states ended in "сост.", and a source may end with a point of its own."""
    analysis = mbsym.load(SHIPPED / "bead-on-hoop.yaml", (1, 2))
    assert analysis.system.source.endswith(".")
    analysis.language = language
    appendix = next(x for x in rendered(TARGETS["latex"], analysis, (1, 2)) if x.filename == "appendix.tex")
    for text in (str(appendix.text), str(TARGETS["html"].render(analysis, (1, 2)))):
        assert not re.search(r"\w\.\.(?!\.)", text)
