"""Problem 9 in LaTeX: its integrals as (words, formula), its sentences filled."""

from __future__ import annotations

from mbsym.formulas.formula import Formula
from mbsym.problems.polynomial_integrals import Polynomials
from mbsym.problems.symmetries import Symmetry
from mbsym.report.language import Language
from mbsym.report.latex.formulas import formula
from mbsym.report.latex.words import escaped
from mbsym.report.words import symmetry_words
from mbsym.report.words.integrals_words import LEVEL, LISTED, sentences, title


def of_integrals(result: Polynomials, tongue: Language) -> list[tuple[str, Formula]]:
    """Every integral, those of levels last: what it is, and its formula."""
    told = []
    for one, x in zip(result.found.generators, result.formulas, strict=True):
        words = {"name": escaped(tongue.say(title(one))), "weight": one.weight}
        told.append((tongue.sentence(LISTED, **words), x))
    for level, formulas in zip(result.levels, result.on_levels, strict=True):
        for (weight, _), x in zip(level.integrals, formulas, strict=True):
            words = {"name": escaped(tongue.say(title(level.level))), "own": level.level.weight, "weight": weight}
            told.append((tongue.sentence(LEVEL, **words), x))
    return told


def weights_of(result: Polynomials) -> str:
    """``p, q, r: 1; gamma_1, gamma_2, gamma_3: 2``."""
    groups: dict[int, list[str]] = {}
    for x, weight in zip(result.variables, result.found.grading.weights, strict=True):
        groups.setdefault(weight, []).append(f"${formula(x)}$")
    return "; ".join(f"{', '.join(listed)}: {weight}" for weight, listed in groups.items())


def of_list(result: Polynomials, tongue: Language) -> list[str]:
    """What is known of the list as a whole."""

    def told(value: object) -> object:
        return escaped(tongue.say(value)) if isinstance(value, str) else value

    return [
        tongue.sentence(text, **{name: told(value) for name, value in values.items()})
        for text, values in sentences(result.found)
    ]


def of_symmetries(result: Polynomials, tongue: Language) -> list[tuple[str, Formula | None]]:
    """What every symmetry gives, with the integral where problem 7 does not list it; what is known of the list."""
    found = result.symmetries
    if found is None:
        return []
    told: list[tuple[str, Formula | None]] = [(tongue.sentence(symmetry_words.OPENING), None)]
    for one in found.symmetries:
        words = {"field": _field(one), "name": escaped(tongue.say(one.name))}
        told.append((tongue.sentence(symmetry_words.gives(one), **words), None if one.name else one.integral))
    return told + [(tongue.sentence(text, **values), None) for text, values in symmetry_words.sentences(found)]


def _field(one: Symmetry) -> str:
    """``$\\xi_{x} = -y$, $\\tau = 1$, $\\Gamma = b y$``."""
    ring = one.integral.ring
    parts = []
    for name, xi in one.directions:
        known = ring.has("coordinate", name)
        moved = formula(Formula(ring, ring.generator("coordinate", name))) if known else f"\\mathrm{{{escaped(name)}}}"
        parts.append(f"$\\xi_{{{moved}}} = {formula(xi)}$")
    parts += [] if one.time.is_zero else [f"$\\tau = {formula(one.time)}$"]
    parts += [] if one.gauge.is_zero else [f"$\\Gamma = {formula(one.gauge)}$"]
    return ", ".join(parts)
