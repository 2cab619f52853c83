"""Gauss-Jordan elimination of numbers, exact or enclosed: which rows are independent, and what the rest is.

Rational numbers tell zero from not zero.  A ball tells only that a number is not zero: pivots are certain, what is left
over is zero as far as its enclosure can tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb


@dataclass(frozen=True)
class Eliminated:
    """``pivots``: (row, column), in the order in which they were taken; ``rows``: 1 at each pivot, 0 above and below.

    ``exact``: what was left of the other rows is zero, proved; else enclosures that hold zero.
    """

    pivots: tuple[tuple[int, int], ...]
    rows: tuple[tuple[Any, ...], ...]
    exact: bool

    @property
    def rank(self) -> int:
        return len(self.pivots)

    @property
    def columns(self) -> tuple[int, ...]:
        return tuple(column for _, column in self.pivots)


def eliminated(rows: Sequence[Sequence[Any]], order: Sequence[int], tiny: arb | None = None) -> Eliminated:
    """The rows one after another, each with its pivot in the first column of ``order`` that is certainly not zero.

    Columns that ``order`` does not name are carried along and get no pivot.  Of balls the best pivot is taken, and what
    is not above ``tiny`` gets none.
    """
    left = [list(row) for row in rows]
    pivots: list[tuple[int, int]] = []
    free, exact = list(order), True
    for i in range(len(left)):
        nonzero = [
            column
            for column in free
            if is_certain(left[i][column]) and (tiny is None or bool(abs(arb(left[i][column])) > tiny))
        ]
        if not nonzero:
            exact = exact and all(_is_exact_zero(left[i][column]) for column in free)
            continue
        column = nonzero[0]
        if isinstance(left[i][column], arb):
            column = max(nonzero, key=lambda k: float(abs(arb(left[i][k]).mid())))
        factor = left[i][column]
        left[i] = [x / factor for x in left[i]]
        left[i][column] = factor / factor if not isinstance(factor, arb) else arb(1)
        own = [(place, y) for place, y in enumerate(left[i]) if not _is_exact_zero(y)]  # mechanisms have few in a row
        for k, row in enumerate(left):
            scale = row[column]
            if k != i and not _is_exact_zero(scale):
                for place, y in own:
                    row[place] -= scale * y
                row[column] = scale - scale if not isinstance(scale, arb) else arb(0)
        pivots.append((i, column))
        free.remove(column)
    return Eliminated(tuple(pivots), tuple(map(tuple, left)), exact)


def is_certain(x: Any) -> bool:
    """Whether x is certainly not zero."""
    return not x.contains(0) and bool(x.is_finite()) if isinstance(x, arb) else bool(x != 0)


def _is_exact_zero(x: Any) -> bool:
    return bool(x.is_zero()) if isinstance(x, arb) else bool(x == 0)
