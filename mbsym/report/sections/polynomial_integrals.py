"""Problem 9, polynomial integrals: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals import Polynomials
from mbsym.problems.symmetries import Symmetry
from mbsym.report.documents import integrals
from mbsym.report.documents.results import polynomial_integrals as doc
from mbsym.report.plain import LONGEST, Write
from mbsym.report.symmetries_json import symmetries_data
from mbsym.report.words import symmetry_words
from mbsym.report.words.integrals_words import level_title, sentences, title, weights
from mbsym.report.words.said import filled

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


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


def lines(result: Polynomials, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    found = result.found
    yield f"up to weighted degree {found.degree}; weights {weights(found)}"
    for one, formula in zip(found.generators, result.formulas, strict=True):
        if one.is_new:
            yield f"{title(one)} of weight {one.weight}: {_short(formula)}"
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            yield f"{level_title(weight, level)}: {_short(formula)}"
    yield from map(filled, sentences(found))
    if result.symmetries is not None:
        yield symmetry_words.OPENING
        for symmetry in result.symmetries.symmetries:
            said = filled((symmetry_words.gives(symmetry), {"field": _field(symmetry), "name": symmetry.name}))
            yield said if symmetry.name else f"{said} {_short(symmetry.integral)}"
        yield from map(filled, symmetry_words.sentences(result.symmetries))


def _field(one: Symmetry) -> str:
    text = symmetry_words.field_text(one)
    return text if len(text) <= LONGEST else "(see the reports)"


def _short(formula: Formula) -> str:
    text = str(formula)
    return text if len(text) <= LONGEST else f"({formula.terms} terms; see the reports)"
