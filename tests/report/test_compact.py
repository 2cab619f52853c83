"""Long formulas as people get them: short, every symbol defined, on a page or two, and whole with --detail full."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import SHIPPED, WITH_BODIES, compiled_latex, derived, invoked, needs_pdflatex

import mbsym
from mbsym.analysis import Analysis
from mbsym.formulas.tree import angles_as
from mbsym.report import compact as choice
from mbsym.report.compact import compact, told_formulas
from mbsym.report.latex import report as latex_report
from mbsym.report.latex import writer as latex_writer
from mbsym.report.targets import TARGETS
from mbsym.report.words.passages import passages

#: The systems of which some problem is told, by problem; all others keep closed formulas.  The tether's equations are
#: long in products of sines and cosines only: in sums of angles, as its paper prints them, they take less than a page.
GYROSCOPES = {"satellite-with-gyroscope": {3}, "satellite-with-two-gyroscopes": {2, 3}}
TOLD = {"satellite": {1, 2, 3}, "satellite-controlled": {1, 2, 3}, "spatial-arm": {3}, **GYROSCOPES}
TOLD_IN_PRODUCTS = TOLD | {"tethered-satellites": {3}, "satellite-with-gyroscope": {2, 3}}


@pytest.mark.parametrize("path", WITH_BODIES, ids=lambda path: path.stem)
def test_only_long_formulas_are_told(path: Path) -> None:
    analysis = mbsym.load(path)
    found = compact(analysis, {n: analysis.stage(n).value for n in (1, 2, 3)})
    assert set(found) == TOLD.get(path.stem, set())
    with angles_as("products"):
        found = compact(analysis, {n: analysis.stage(n).value for n in (1, 2, 3)})
    assert set(found) == TOLD_IN_PRODUCTS.get(path.stem, set())
    analysis.detail = "full"
    assert compact(analysis, {3: analysis.equations}) == {}


@pytest.mark.parametrize("name", sorted(TOLD_IN_PRODUCTS))
def test_passages_define_what_is_used_before_it_is_used(name: str) -> None:
    analysis = derived(SHIPPED / f"{name}.yaml")
    told = analysis.told
    for number in (1, 2, 3):
        formulas = told_formulas(told, number)
        listed = passages(told.told, analysis.system, formulas)
        order = [item.name for passage in listed for item in passage.definitions]
        assert sorted(order) == sorted(item.name for item in told.told.wanted(formulas))
        seen: set[str] = set()
        for passage in listed:
            assert passage.words
            for item in passage.definitions:
                used = {x.name for x in told.told.wanted([item.formula])}
                assert used <= seen, f"{item.name} uses {used - seen} before they are told"
                seen.add(item.name)
        # One phrase is one quantity of one body, said once.
        said = [
            (passage.words, passage.coordinate) for passage in listed if not passage.words.startswith("Abbreviations")
        ]
        assert len(set(said)) == len(said)


def equations_alone(text: str) -> str:
    """The section of the equations with the preamble of report.tex: a document of its own."""
    head, body = text.split(r"\maketitle")
    start = body.index("Problem 3. ", body.index("The system}"))
    start = body.rindex("\n", 0, start)
    return head + body[start : body.index(r"\section*{", start + 30)] + "\n\\end{document}\n"


@needs_pdflatex
def test_the_equations_of_the_satellite_take_two_pages_at_most(tmp_path: Path) -> None:
    """All five equations with every symbol defined; written out they are five pages."""
    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    said = {}
    for wanted in ("compact", "full"):
        analysis.detail = wanted
        text = latex_report.render(analysis, (1, 2, 3))
        said[wanted] = compiled_latex(equations_alone(text), tmp_path)
    pages = {k: int(re.search(r"Output written on .*?\((\d+) page", x, re.S)[1]) for k, x in said.items()}  # type: ignore[index]
    assert pages["compact"] <= 2 < 4 <= pages["full"]
    assert "Overfull" not in said["compact"]


@needs_pdflatex
@pytest.mark.parametrize("name", sorted(TOLD_IN_PRODUCTS))
def test_nothing_overflows(name: str, tmp_path: Path) -> None:
    system = mbsym.load(SHIPPED / f"{name}.yaml").system
    text = TARGETS["latex"].render(Analysis(replace(system, claims=())), (1, 2, 3))
    assert "Overfull" not in compiled_latex(text, tmp_path)


def test_passages_stand_in_anyones_document() -> None:
    """They use no macro of report.tex."""
    analysis = derived(SHIPPED / "satellite.yaml")
    listed = compact(analysis, {3: analysis.equations})[3]
    text = latex_writer.paragraphs(listed.system.told, listed.passages, latex_writer.escaped)
    assert "longformula" not in text
    assert text.count(r"\par") == len(listed.passages)


def test_a_chain_that_nobody_follows_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    monkeypatch.setattr(choice, "MOST_DEFINITIONS", 10)
    assert compact(analysis, {3: analysis.equations}) == {}


def test_the_energy_integral_is_told_through_problems_2_and_3() -> None:
    """And what is said of it is so: T_2 - T_0 - U, from the closed energies, is the integral."""
    analysis = derived(SHIPPED / "satellite.yaml")
    (integral,) = analysis.integrals
    energy, ring = analysis.energy, analysis.ring
    rates = [ring.generator("velocity", name) for name in analysis.system.coordinates]
    matrix = analysis.equations.mass_matrix.polynomials
    doubled = sum((a * matrix[i][j] * b for i, a in enumerate(rates) for j, b in enumerate(rates)), ring.zero)
    at_rest = {ring.index("velocity", name): ring.zero for name in analysis.system.coordinates}
    resting = ring.substitute(energy.kinetic_energy.polynomial, at_rest)
    difference = 2 * (integral.formula.polynomial + resting + energy.force_function.polynomial) - doubled
    assert ring.is_zero(difference) is True
    said = "T_2 - T_0 - U = \\mathrm{const}"
    text = TARGETS["latex"].render(analysis, (2, 3, 7))
    assert said in text
    assert f"Written out there are {integral.formula.terms} terms." in text
    # Without the problems that it refers to, it is written out.
    assert said not in TARGETS["latex"].render(analysis, (7,))
    assert said not in TARGETS["latex"].render(derived(SHIPPED / "double-pendulum.yaml"), (2, 3, 7))


def test_what_is_told_is_counted_as_the_terminal_counts_it() -> None:
    """T as a whole, and no velocity twice."""
    analysis = derived(SHIPPED / "satellite.yaml")
    energy = analysis.energy
    text = TARGETS["latex"].render(analysis, (2,))
    assert f"Written out there are {energy.kinetic_energy.terms + energy.force_function.terms} terms." in text
    bodies = analysis.kinematics.bodies
    written = {
        (k, name): getattr(x, name) for k, x in enumerate(bodies) for name in ("angular_velocity", "velocity_origin")
    }
    written |= {
        (k, "centre"): x.velocity_mass_centre
        for k, x in enumerate(bodies)
        if [str(y) for y in x.velocity_mass_centre] != [str(y) for y in x.velocity_origin]
    }
    count = sum(x.terms for v in written.values() for x in v)
    assert f"Written out there are {count} terms." in TARGETS["latex"].render(analysis, (1,))


def test_detail_is_an_option_of_run(tmp_path: Path) -> None:
    texts = {}
    for word in ("compact", "full"):
        arguments = ["run", str(SHIPPED / "satellite.yaml"), "--format", "latex", "--problems", "3", "--quiet"]
        done = invoked(*arguments, "--detail", word, "--out", tmp_path / word, code=0)
        texts[word] = (tmp_path / word / "report.tex").read_text(encoding="utf-8")
    assert "Angular acceleration of body 2" in texts["compact"]
    assert "Angular acceleration" not in texts["full"]
    done = invoked("run", SHIPPED / "satellite.yaml", "--detail", "ful", "--out", tmp_path, code=2)
    assert "--detail: error[unknown-detail]" in done.output
    assert "did you mean 'full'?" in done.output
