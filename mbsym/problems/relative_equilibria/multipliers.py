"""Rest under constraints: which equations between coordinates  f + J^T lambda = 0  leaves, whatever the rank of J.

The multipliers are eliminated without fractions.  A pivot that may vanish makes two cases, in one of which it is not
zero and in the other it is, so that every position that the constraints allow belongs to exactly one case, and the
number of pivots is the rank of J there:

    [J^T | f]  ->  rows without a pivot:  [0 | combination of f],  which has to vanish
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.mechanics.rest import Rest

#: More cases are not told apart.
MOST_CASES = 200

Polynomials = tuple[Polynomial, ...]


@dataclass(frozen=True)
class Case:
    """``left`` have to vanish at rest where ``zero`` vanish and ``nonzero`` do not: there J has this ``rank``."""

    left: Polynomials
    zero: Polynomials = ()
    nonzero: Polynomials = ()
    rank: int = 0


def cases(found: Rest, possible: Callable[[Polynomials, Polynomials], bool]) -> Iterator[Case]:
    """The cases of a constrained system; one where there are no constraints.

    ``possible``: False of (zero, nonzero) that no position has.  Raises NoClosedForm where there are too many.
    """
    ring = found.ring
    table = [[*(row.partials[i] for row in found.rows), f] for i, f in enumerate(found.at_rest)]
    pending: list[tuple[list[list[Polynomial]], Case]] = [(table, Case(()))]
    looked_at = 0
    while pending:
        rows, case = pending.pop()
        looked_at += 1
        if looked_at > MOST_CASES:
            raise NoClosedForm(Message("more than [[count]] cases of the rank of constraints", count=MOST_CASES))
        if case.zero and not possible(case.zero, case.nonzero):
            continue
        place = _pivot(rows)
        if place is None:
            yield Case(tuple(row[-1] for row in rows), case.zero, case.nonzero, case.rank)
            continue
        i, k = place
        pivot = rows[i][k]
        numerator, _ = ring.fraction(pivot)
        if numerator.is_constant():
            pending.append((_eliminated(ring, rows, i, k), Case((), case.zero, case.nonzero, case.rank + 1)))
            continue
        without = [[ring.zero if x == pivot or x == -pivot else x for x in row] for row in rows]
        pending.append((without, Case((), (*case.zero, numerator), case.nonzero, case.rank)))
        regular = Case((), case.zero, (*case.nonzero, numerator), case.rank + 1)
        pending.append((_eliminated(ring, rows, i, k), regular))


def _pivot(rows: Sequence[Sequence[Polynomial]]) -> tuple[int, int] | None:
    """The place of a multiplier's shortest factor, a number before all others."""
    held = [(not x.is_constant(), len(x), i, k) for i, row in enumerate(rows) for k, x in enumerate(row[:-1]) if x != 0]
    return min(held)[2:] if held else None


def _eliminated(ring: Ring, rows: list[list[Polynomial]], i: int, k: int) -> list[list[Polynomial]]:
    """The rows without the one of the pivot, each times the pivot less its own entry times that row."""
    top, pivot = rows[i], rows[i][k]
    left = []
    for j, row in enumerate(rows):
        if j == i:
            continue
        if row[k].is_zero():
            left.append(row)
            continue
        left.append([ring.reduce(ring.times(pivot, x) - ring.times(row[k], y)) for x, y in zip(row, top, strict=True)])
    return left
