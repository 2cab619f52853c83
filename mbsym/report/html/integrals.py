"""Problem 9 in HTML: integrals and symmetries as (words, formula in MathML)."""

from __future__ import annotations

from markupsafe import Markup

from mbsym.problems.polynomial_integrals import Polynomials
from mbsym.report.html import formulas as shown
from mbsym.report.words import symmetry_words
from mbsym.report.words.integrals_words import level_title, title
from mbsym.report.words.said import filled


def of_polynomials(result: Polynomials) -> list[tuple[str, Markup]]:
    """The integrals of problem 9: what each is, and its formula in MathML."""
    told = []
    for one, formula in zip(result.found.generators, result.formulas, strict=True):
        told.append((f"{title(one)} (weight {one.weight}):", shown.math(shown.inline(formula))))
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        for (weight, _), formula in zip(level.integrals, formulas, strict=True):
            told.append((f"{level_title(weight, level)}:", shown.math(shown.inline(formula))))
    return told


def of_symmetries(result: Polynomials) -> list[tuple[str, Markup | None]]:
    """The symmetries of problem 9: what each gives, and its integral in MathML where problem 7 does not list it."""
    found = result.symmetries
    if found is None:
        return []
    told: list[tuple[str, Markup | None]] = [(symmetry_words.OPENING, None)]
    for one in found.symmetries:
        text = filled((symmetry_words.gives(one), {"field": symmetry_words.field_text(one), "name": one.name}))
        told.append((text, None if one.name else shown.math(shown.inline(one.integral))))
    return told + [(filled(said), None) for said in symmetry_words.sentences(found)]
