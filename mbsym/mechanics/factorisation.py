"""M x = f by M = L^T D L from the tips to the base, never by an inverse; any scalar.

Row k of M is eliminated after everything beyond it, so the branches of a tree stay apart and no zero fills in
(Featherstone, Int. J. Robotics Research 24 (2005) 487-500).  Where coordinates are shared between joints the pattern
may be another; then the order with the least fill-in is sought greedily.  M is positive semidefinite, so a pivot D_k
vanishes in some order exactly where M is singular.
"""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.failures import SingularPoint


def solve(
    algebra: Algebra, matrix: Sequence[Sequence[Scalar]], right: Sequence[Scalar]
) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
    """(x, pivots) with M x = right; D_k belongs to coordinate k.  Raises SingularPoint for a pivot that is zero."""
    n = len(right)
    rows = [{j: matrix[i][j] for j in range(n) if not algebra.vanishes(matrix[i][j])} for i in range(n)]
    order = elimination_order([set(row) for row in rows])
    values, pivots, inverses = list(right), [algebra.zero] * n, [algebra.zero] * n
    factors: list[dict[int, Scalar]] = [{} for _ in range(n)]
    for k in order:
        row = rows[k]
        if k not in row or algebra.vanishes(row[k]):
            raise SingularPoint("the mass matrix is singular everywhere: a coordinate moves no mass")
        pivots[k] = row.pop(k)
        inverses[k] = algebra.reciprocal(pivots[k])
        neighbours = sorted(row)
        factors[k] = {i: row[i] * inverses[k] for i in neighbours}
        for place, i in enumerate(neighbours):
            del rows[i][k]
            for j in neighbours[: place + 1]:
                product = factors[k][i] * row[j]
                rows[i][j] = rows[i][j] - product if j in rows[i] else -product
                rows[j][i] = rows[i][j]
            values[i] = values[i] - factors[k][i] * values[k]
    found = [algebra.zero] * n
    for k in reversed(order):
        value = values[k] * inverses[k]
        for i, factor in factors[k].items():
            value = value - factor * found[i]
        found[k] = value
    return tuple(found), tuple(pivots)


def elimination_order(pattern: Sequence[set[int]]) -> tuple[int, ...]:
    """From the last row to the first if that fills in nothing, else greedily by least fill-in.

    ``pattern`` holds the columns of each row's nonzero entries, and is symmetric.
    """
    backwards = tuple(reversed(range(len(pattern))))
    if _fill(pattern, backwards) == 0:
        return backwards
    left = {k: set(row) - {k} for k, row in enumerate(pattern)}
    order = []
    while left:
        best = min(left, key=lambda k: (_missing(left, k), -k))
        _eliminate(left, best)
        order.append(best)
    return tuple(order)


def _fill(pattern: Sequence[set[int]], order: Sequence[int]) -> int:
    left = {k: set(row) - {k} for k, row in enumerate(pattern)}
    filled = 0
    for k in order:
        filled += _missing(left, k)
        if filled:
            break
        _eliminate(left, k)
    return filled


def _missing(left: dict[int, set[int]], k: int) -> int:
    """How many pairs of neighbours of k are no neighbours yet."""
    return sum(len(left[k] - left[i]) - 1 for i in left[k])


def _eliminate(left: dict[int, set[int]], k: int) -> None:
    neighbours = left.pop(k)
    for i in neighbours:
        left[i] |= neighbours
        left[i] -= {i, k}


def counted(pattern: Sequence[set[int]]) -> int:
    """How many operations ``solve`` takes for a pattern of nonzero entries, nothing being zero by chance."""
    left = {k: set(row) - {k} for k, row in enumerate(pattern)}
    operations = 0
    for k in elimination_order(pattern):
        beyond = len(left[k])
        operations += 2 + beyond * (beyond + 1) + beyond * 5
        _eliminate(left, k)
    return operations
