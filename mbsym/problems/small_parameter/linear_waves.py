"""Exact linear equations over a tower."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.matrices import echelon
from mbsym.algebra.tower import Element, Tower


def solved(tower: Tower, rows: Sequence[Sequence[Element]], right: Sequence[Element]) -> list[Element] | None:
    """x with rows x = right, free unknowns zero; None where there is none."""
    work = [[*row, value] for row, value in zip(rows, right, strict=True)]
    count = len(rows[0]) if rows else 0
    work, pivots = echelon(tower, work, count, lambda x: None if x.is_zero() else len(x.top) + len(x.bottom))
    if any(not row[-1].is_zero() for row in work[len(pivots) :]):
        return None
    found = [tower.zero] * count
    for place, column in enumerate(pivots):
        found[column] = work[place][-1]
    return found
