"""Problem 9, polynomial integrals: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.polynomial_integrals import Polynomials
from mbsym.problems.symmetries import Symmetry
from mbsym.report.content import Block, Display, Heading, Notation, Relation, Said, Words, ragged, say
from mbsym.report.documents import integrals
from mbsym.report.documents.results import polynomial_integrals as doc
from mbsym.report.plain import LONGEST, Write
from mbsym.report.plain_writer import TERMINAL
from mbsym.report.symmetries_json import symmetries_data
from mbsym.report.words import symmetry_words
from mbsym.report.words.integrals_words import (
    LEVEL,
    LISTED,
    OPENING,
    level_title,
    sentences,
    title,
    weighted,
    weights_text,
)

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.formulas.formula import Formula
    from mbsym.problems.symmetries import Symmetries
    from mbsym.report.results import Results


def data(result: Polynomials, system: System, write: Write) -> doc.PolynomialIntegrals:
    """The section of results.json."""
    found = result.found
    return doc.PolynomialIntegrals(
        degree=found.degree,
        weights=dict(zip(found.field.variables, found.grading.weights, strict=True)),
        quasi_homogeneous=found.grading.homogeneous,
        complete=found.complete,
        independent=found.independent,
        not_contained=list(found.aside),
        integrals=[
            integrals.Integral(
                weight=one.weight,
                name=one.name,
                new=one.is_new,
                formula=str(formula),
                independent=one.independent,
                independence=one.certainty.value,
            )
            for one, formula in zip(found.generators, result.formulas, strict=True)
        ],
        on_levels=[
            integrals.ZeroLevel(
                zero=one.level.name,
                integrals=[
                    integrals.WeightedIntegral(weight=weight, formula=str(formula))
                    for (weight, _), formula in zip(one.integrals, formulas, strict=True)
                ],
                complete=one.complete,
            )
            for one, formulas in zip(result.levels, result.on_levels, strict=True)
        ],
        symmetries=None if result.symmetries is None else symmetries_data(result.symmetries),
    )


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("polynomial-integrals", Said("Problem 9. Polynomial integrals"))
    yield from results.missing(9)
    if 9 not in results.found:
        return
    result: Polynomials = results.found[9]
    found = result.found
    weights = weighted(result.variables, found.grading.weights)
    yield ragged(say(OPENING, degree=str(found.degree), weights=weights))
    for one, formula in zip(found.generators, result.formulas, strict=True):
        yield ragged(say(LISTED, weight=str(one.weight), name=Words(title(one))))
        yield _constant(formula)
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        zero, name = level.level, Words(title(level.level))
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            yield ragged(say(LEVEL, weight=str(weight), own=str(zero.weight), name=name))
            yield _constant(formula)
    yield from map(ragged, sentences(found))
    if result.symmetries is not None:
        yield from _symmetries(result.symmetries)


def _symmetries(found: Symmetries) -> Iterator[Block]:
    """What each gives, with the integral where problem 7 does not list it; what is known of the list."""
    yield ragged(Said(symmetry_words.OPENING))
    for one in found.symmetries:
        yield ragged(symmetry_words.gives(one, symmetry_words.field(one)))
        if not one.name:
            yield _constant(one.integral)
    yield from map(ragged, symmetry_words.sentences(found))


def _constant(formula: Formula) -> Display:
    return Display(Relation(formula, "=", Notation("\\mathrm{const}")))


def lines(result: Polynomials, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    found, write = result.found, TERMINAL.inline
    weights = weights_text(found.field.variables, found.grading.weights)
    yield f"up to weighted degree {found.degree}; weights {weights}"
    for one, formula in zip(found.generators, result.formulas, strict=True):
        if one.is_new:
            yield f"{title(one)} of weight {one.weight}: {write(formula)}"
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            yield f"{level_title(weight, level)}: {write(formula)}"
    yield from map(TERMINAL.said, sentences(found))
    if result.symmetries is not None:
        yield TERMINAL.said(Said(symmetry_words.OPENING))
        for symmetry in result.symmetries.symmetries:
            said = TERMINAL.said(symmetry_words.gives(symmetry, _field(symmetry)))
            yield said if symmetry.name else f"{said} {write(symmetry.integral)}"
        yield from map(TERMINAL.said, symmetry_words.sentences(result.symmetries))


def _field(one: Symmetry) -> str:
    text = symmetry_words.field_text(one)
    return text if len(text) <= LONGEST else "(see the reports)"


def formulas(found: Polynomials, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    for k, (one, formula) in enumerate(zip(found.found.generators, found.formulas, strict=True), start=1):
        yield f"{k}. {title(one)}, weight {one.weight}", formula
    k = len(found.formulas)
    for level, formulas in zip(found.levels, found.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            k += 1
            yield f"{k}. {level_title(weight, level)}", formula
    for symmetry in () if found.symmetries is None else found.symmetries.symmetries:
        if not symmetry.name:
            k += 1
            yield f"{k}. integral of the symmetry {symmetry_words.field_text(symmetry)}", symmetry.integral
