"""Exact linear equations over a tower."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.tower import Element, Tower


def solved(tower: Tower, rows: Sequence[Sequence[Element]], right: Sequence[Element]) -> list[Element] | None:
    """x with rows x = right, free unknowns zero; None where there is none."""
    work = [[*row, value] for row, value in zip(rows, right, strict=True)]
    count = len(rows[0]) if rows else 0
    pivots: list[int] = []
    for column in range(count):
        place = len(pivots)
        pivot = min(
            (r for r in range(place, len(work)) if not work[r][column].is_zero()),
            key=lambda r: len(work[r][column].top) + len(work[r][column].bottom),
            default=None,
        )
        if pivot is None:
            continue
        work[place], work[pivot] = work[pivot], work[place]
        back = tower.reciprocal(work[place][column])
        work[place] = [x if x.is_zero() else x * back for x in work[place]]
        for r, row in enumerate(work):
            factor = row[column]
            if r != place and not factor.is_zero():
                work[r] = [a if b.is_zero() else a - factor * b for a, b in zip(row, work[place], strict=True)]
        pivots.append(column)
    if any(not row[-1].is_zero() for row in work[len(pivots) :]):
        return None
    found = [tower.zero] * count
    for place, column in enumerate(pivots):
        found[column] = work[place][-1]
    return found
