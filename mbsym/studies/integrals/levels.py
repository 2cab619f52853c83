"""``mbsym integrals --relations``: what is printed of integrals where another one has a value that is not zero."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.report.words.integrals_words import title

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import OtherLevel, OtherLevels


def other_lines(there: Setting, found: OtherLevels | None) -> Iterator[str]:
    """What holds on single levels, and what is known of all others."""
    if found is None:
        yield "not looked for: several unit vectors or angles are related, or roots occur, which is not looked at here"
        return
    for level in found.levels:
        yield from _of(there, found, level)
    if not found.levels:
        yield "There is no integral in the list whose values could be looked at."


def _of(there: Setting, found: OtherLevels, other_level: OtherLevel) -> Iterator[str]:
    that = f"that of weight {other_level.level.weight} ({title(other_level.level)})"
    value = that if other_level.power == 1 else f"the power {other_level.power} of {that}"
    vectors = bool(there.field.relations) and (not found.fixed or found.weights is not None)
    length = "; unit vectors of any length" if vectors else ""
    almost = ", for almost all values of the parameters" if there.field.parameters else ""
    if not other_level.looked:
        yield f"where {that} has another value than zero there may be others: not found within the budget."
        return
    for at in other_level.values:
        for weight, f in at.integrals:
            yield f"where {value} is {at.value}, one of weight {weight}: {there.formula(f)}"
        if not at.complete:
            yield f"  where it is {at.value} there may be others: not found within the budget"
    for number in other_level.undecided:
        yield f"whether there are others where {value} is {number} is undecided"
    for p in other_level.irrational:
        yield f"undecided where {value} is a zero c of {str(p).replace('x', 'c')}"
    if not other_level.complete:
        yield (
            f"where {that} has another value than zero there may be others at almost all of its values: those are "
            "integrals that hold everywhere, of higher weight or not found, with this value put in."
        )
        return
    none = f"there is none beyond those that hold everywhere of weight up to {found.degree}{almost}"
    if other_level.drops:
        yield f"where {that} has single values, other than zero, there may be others: put in numbers with --set."
    elif not other_level.by_rank:
        yield f"where {that} has any value but zero {none} (proved{length})."
    elif there.field.parameters:
        yield f"where {that} has any value but zero {none} (verified at random parameters modulo a prime{length})."
    elif other_level.whole:
        yield (
            f"where {that} has any value but zero {none} (proved, but for algebraic numbers whose polynomials over the "
            f"integers need coefficients beyond 10^9{length})."
        )
    else:
        yield (
            f"where {value} has any other rational value than zero, with numerator and denominator up to 10^9, {none} "
            f"(proved{length}); other irrational ones are undecided."
        )
