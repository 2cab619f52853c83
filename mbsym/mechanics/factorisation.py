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


class Elimination:
    """M = L^T D L, and what the elimination makes of right-hand sides on its way: L^-T b.

    ``forward`` holds these, ``backward`` goes on from one of them (or from a combination) to M^-1 b.  For two of them,
    a and b:  a^T M^-1 b = sum_k forward_a[k] forward_b[k] / pivots[k].  Raises SingularPoint for a pivot that is zero,
    with the sentence ``singular``.
    """

    def __init__(
        self,
        algebra: Algebra,
        matrix: Sequence[Sequence[Scalar]],
        rights: Sequence[Sequence[Scalar]],
        singular: str = "the mass matrix is singular everywhere: a coordinate moves no mass",
    ) -> None:
        n = len(matrix)
        rows = [{j: matrix[i][j] for j in range(n) if not algebra.vanishes(matrix[i][j])} for i in range(n)]
        self._zero, self._order = algebra.zero, elimination_order([set(row) for row in rows])
        self.forward = [list(right) for right in rights]
        pivots, self.inverses = [algebra.zero] * n, [algebra.zero] * n
        self._factors: list[dict[int, Scalar]] = [{} for _ in range(n)]
        for k in self._order:
            row = rows[k]
            if k not in row or algebra.vanishes(row[k]):
                raise SingularPoint(singular)
            pivots[k] = row.pop(k)
            self.inverses[k] = algebra.reciprocal(pivots[k])
            neighbours = sorted(row)
            factors = self._factors[k] = {i: row[i] * self.inverses[k] for i in neighbours}
            for place, i in enumerate(neighbours):
                del rows[i][k]
                for j in neighbours[: place + 1]:
                    product = factors[i] * row[j]
                    rows[i][j] = rows[i][j] - product if j in rows[i] else -product
                    rows[j][i] = rows[i][j]
                for values in self.forward:
                    values[i] = values[i] - factors[i] * values[k]
        self.pivots = tuple(pivots)

    def backward(self, forward: Sequence[Scalar]) -> tuple[Scalar, ...]:
        """M^-1 b from L^-T b."""
        found = [self._zero] * len(forward)
        for k in reversed(self._order):
            value = forward[k] * self.inverses[k]
            for i, factor in self._factors[k].items():
                value = value - factor * found[i]
            found[k] = value
        return tuple(found)


def solve(
    algebra: Algebra, matrix: Sequence[Sequence[Scalar]], right: Sequence[Scalar]
) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
    """(x, pivots) with M x = right; D_k belongs to coordinate k.  Raises SingularPoint for a pivot that is zero."""
    eliminated = Elimination(algebra, matrix, [right])
    return eliminated.backward(eliminated.forward[0]), eliminated.pivots


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
