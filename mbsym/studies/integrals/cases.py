"""``mbsym integrals --vary`` and ``--cases``: what is printed of special parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.report.words.integrals_words import case_title, conditions_text, level_title, weights_text

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import Along, Cases, PolynomialIntegrals, Special


def along_lines(there: Setting, usual: PolynomialIntegrals, found: Along) -> Iterator[str]:
    """The values, what there is at each, and what is known of the others."""
    if found.weights not in (None, usual.grading.weights):
        yield f"weights are {weights_text(there.field.variables, found.weights or ())} here"
    degree = usual.degree
    length = "" if found.weights is None or not there.vectors else "; unit vectors of any length"
    for one in found.values:
        yield f"{found.name} = {one.value}"
        yield from _special(there, one)
    if not found.values:
        yield f"at no rational value of {found.name} from {found.low} to {found.high} was a further one found"
    for value in found.undecided:
        yield f"whether there are more at {found.name} = {value} is undecided"
    for p in found.irrational:
        yield f"undecided at the zeros of {str(p).replace('x', found.name)}"
    without = f" that does not contain {', '.join(usual.aside)}" if usual.aside else ""
    others = "At all other values" if found.values or found.undecided else "At all values"
    interval = f"of {found.name} from {found.low} to {found.high}"
    if not found.usual:
        yield f"What there is for almost all {found.name} is not known to be all: of other values nothing is proved."
    elif found.whole:
        yield (
            f"{others} {interval}, rational or not, there is none of weight up to {degree}{without} "
            "(proved, but for algebraic numbers whose polynomials over the integers need coefficients beyond 10^9"
            f"{length})."
        )
    else:
        yield (
            f"{others} {interval} with numerator and denominator up to 10^9 there is none of weight up to {degree}"
            f"{without} (proved{length}); irrational values are undecided."
        )


def cases_lines(there: Setting, found: Cases) -> Iterator[str]:
    """The cases, and what the list is not."""
    for case in found.cases:
        yield conditions_text(case, lambda p: str(there.formula(p)))
        yield from _special(there, case.special)
    if not found.cases:
        yield "no case was found"
    yield (
        f"{found.families} families of parameters were looked at (some zero, some equal that play the same part), and "
        "conditions of degree up to 3 in each. Integrals are proved; that there are no other cases is not."
    )
    if found.left:
        yield (
            f"{found.left} further families were not looked at within the budget (--budget): nothing is known of them."
        )
    if found.unread:
        yield f"In {found.unread} families the rank drops elsewhere, too, under conditions that were not found."


def _special(there: Setting, one: Special) -> Iterator[str]:
    for weight, f in one.integrals:
        yield f"  {case_title(weight)}: {there.formula(f)}"
    for level in one.levels:
        for weight, f in level.integrals:
            yield f"  {level_title(weight, level)}: {there.formula(f)}"
