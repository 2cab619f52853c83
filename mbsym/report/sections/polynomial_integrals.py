"""Problem 9, polynomial integrals: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals.result import Polynomials
from mbsym.report.content import Block, Display, Heading, Inline, Notation, Relation, Said, ragged, say
from mbsym.report.documents import integrals
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import polynomial_integrals as doc
from mbsym.report.words import symmetry_words
from mbsym.report.words.integrals_words import (
    LEVEL,
    LISTED,
    NOT_UNIFORM,
    OPENING,
    UNIFORM,
    level_title,
    sentences,
    title,
    weighted,
)

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula
    from mbsym.problems.polynomial_integrals.result import PolynomialIntegrals
    from mbsym.problems.symmetries.search import Symmetries
    from mbsym.report.results import Results


def data(result: Polynomials, system: System, write: Write) -> doc.PolynomialIntegrals:
    """The section of results.json."""
    polynomial_integrals = result.integrals
    return doc.PolynomialIntegrals.from_result(
        polynomial_integrals,
        weights=zip(polynomial_integrals.field.variables, polynomial_integrals.grading.weights, strict=True),
        integrals=[
            integrals.Integral.from_result(generator, formula=formula)
            for generator, formula in zip(polynomial_integrals.generators, result.formulas, strict=True)
        ],
        on_levels=[
            integrals.ZeroLevel.from_result(
                level, integrals=[(weight, f) for (weight, _), f in zip(level.integrals, formulas, strict=True)]
            )
            for level, formulas in zip(result.levels, result.on_levels, strict=True)
        ],
        symmetries=result.symmetries,
    )


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("polynomial-integrals", Said("Problem 9. Polynomial integrals"))
    yield from results.missing(9)
    if 9 not in results.by_problem:
        return
    result: Polynomials = results.by_problem[9]
    polynomial_integrals = result.integrals
    yield opening(polynomial_integrals, result.variables)
    yield from listed(polynomial_integrals, result.formulas)
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        zero, name = level.level, worded(title(level.level))
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            yield ragged(say(LEVEL, weight=str(weight), own=str(zero.weight), name=name))
            yield _constant(formula)
    yield from map(ragged, sentences(polynomial_integrals))
    if result.symmetries is not None:
        yield from of_symmetries(result.symmetries)


def opening(polynomial_integrals: PolynomialIntegrals, variables: Sequence[Inline]) -> Block:
    """What is looked for."""
    return ragged(
        say(
            OPENING,
            degree=str(polynomial_integrals.degree),
            weights=weighted(variables, polynomial_integrals.grading.weights),
        ),
        Said(UNIFORM if polynomial_integrals.grading.homogeneous else NOT_UNIFORM),
    )


def listed(polynomial_integrals: PolynomialIntegrals, formulas: Sequence[Formula]) -> Iterator[Block]:
    """Each integral."""
    for generator, formula in zip(polynomial_integrals.generators, formulas, strict=True):
        yield ragged(say(LISTED, weight=str(generator.weight), name=worded(title(generator))))
        yield _constant(formula)


def of_symmetries(symmetries: Symmetries) -> Iterator[Block]:
    """What each gives, with the integral where problem 7 does not list it; what is known of the list."""
    for symmetry in symmetries.symmetries:
        yield ragged(symmetry_words.gives(symmetry, symmetry_words.field(symmetry)))
        if not symmetry.name:
            yield _constant(symmetry.integral)
    yield from map(ragged, symmetry_words.sentences(symmetries))
    yield ragged(Said(symmetry_words.LOOKED_FOR))


def _constant(formula: Formula) -> Display:
    return Display(Relation(formula, "=", Notation("\\mathrm{const}")))


def formulas(polynomials: Polynomials, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    for k, (generator, formula) in enumerate(
        zip(polynomials.integrals.generators, polynomials.formulas, strict=True), start=1
    ):
        yield f"{k}. {title(generator)}, weight {generator.weight}", formula
    k = len(polynomials.formulas)
    for level, formulas in zip(polynomials.levels, polynomials.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            k += 1
            yield f"{k}. {level_title(weight, level)}", formula
    for symmetry in () if polynomials.symmetries is None else polynomials.symmetries.symmetries:
        if not symmetry.name:
            k += 1
            yield f"{k}. integral of the symmetry {symmetry_words.field_text(symmetry)}", symmetry.integral
