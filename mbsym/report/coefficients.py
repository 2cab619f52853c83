"""Long conditions in the coefficients of the characteristic polynomial: v4^2 v2^2 - 4 v2^3 v6 - ..., as papers print.

A discriminant of hundreds of terms is five in its coefficients.  The form is what the stability kernel computes, done
again over letters; the letters put back give its polynomial exactly, or no such form is shown.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.characteristic import Polynomial, lienard_chipart, subdiscriminants
from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Formula
from mbsym.problems.stability.requirements import Requirement

#: Shorter conditions are written out.
WRITTEN_OUT = 40
#: A form with more terms than this helps nobody.
MOST_TERMS = 60


@dataclass(frozen=True)
class InCoefficients:
    """``formula`` over letters of its own (v6, v4, ... or a3, a2, ...); ``letters``: each with what it stands for."""

    formula: Formula
    letters: tuple[tuple[str, Formula], ...]


def in_coefficients(ring: Ring, requirement: Requirement) -> InCoefficients | None:
    """The form of a requirement that is too long to be read; None where there is none.

    The requirement is an inequality that nothing was split off from, so that form and polynomial have one sign.
    """
    condition, coefficients = requirement.condition, requirement.coefficients
    if condition.kind != "inequality" or condition.nonzero or len(condition.polynomial) <= WRITTEN_OUT:
        return None
    even = "discriminant" in requirement.label
    names = [f"v{2 * i}" if even else f"a{i}" for i in range(len(coefficients))]
    present = [(name, x) for name, x in zip(names, coefficients, strict=True) if x != 0]
    letters = Ring((), (), [name for name, _ in reversed(present)], {})
    given = [letters.generator("parameter", n) if letters.has("parameter", n) else letters.zero for n in names]
    label = requirement.label.partition(" of factor ")[0]
    value = _made(label, given)
    if value is None or not 2 * len(value) < len(condition.polynomial) or len(value) > MOST_TERMS:
        return None
    standing = dict(present)
    images = [standing.get(g.name, ring.zero) for g in letters.generators]
    if value.compose(*images, ctx=ring.context) != requirement.polynomial:
        return None
    return InCoefficients(Formula(letters, value), tuple((name, Formula(ring, x)) for name, x in reversed(present)))


def _made(label: str, coefficients: list[Polynomial]) -> Polynomial | None:
    """What a label stands for, of a polynomial with these coefficients."""
    word, _, number = label.rpartition(" ")
    if label == "discriminant":
        return subdiscriminants(coefficients)[-1]
    if word == "subdiscriminant":
        return subdiscriminants(coefficients)[int(number) - 1]
    return dict(lienard_chipart(coefficients)).get(label) if word == "Hurwitz minor" else None
