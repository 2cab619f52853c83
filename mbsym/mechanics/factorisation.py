"""M x = f by M = L^T D L from the tips to the base, never by an inverse; any scalar.

Row k of M is eliminated after everything beyond it, so the branches of a tree stay apart and no zero fills in
(Featherstone, Int. J. Robotics Research 24 (2005) 487-500).  Where coordinates are shared between joints the pattern
may be another; then the order with the least fill-in is sought greedily.  M is positive semidefinite, so a pivot D_k
vanishes in some order exactly where M is singular.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Generic

from mbsym.algebra.base import Algebra, S, Scalar
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.mechanics.articulation import Articulation, MassProperties, shifted, total, turned_back


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
        scalars = [self._zero] * len(forward)
        for k in reversed(self._order):
            value = forward[k] * self.inverses[k]
            for i, factor in self._factors[k].items():
                value = value - factor * scalars[i]
            scalars[k] = value
        return tuple(scalars)


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


# The mass matrix by composite bodies, over any scalar.
#
# Everything beyond a joint moves as one rigid body when only that joint moves (Walker & Orin 1982; Featherstone, Rigid
# Body Dynamics Algorithms, 2008, section 6.2).  Elementary joints are the turn of a frame about one of its axes and the
# displacement of its origin; with the composite (m, h, J) of all frames beyond it about O_k, a unit acceleration takes
#
#     turn about a:         f = e_a x h,    n = J e_a
#     displacement along v:    f = m v,        n = h x v
#
# and f, n are carried to the base, where they meet the joints in between.  A coordinate may occur in several joints:
#
#     M_ij = sum over pairs of joints (e, e') of  (dx_e/dq_i) (dx_e'/dq_j) m_ee' .
#
# Joints of different branches do not meet, so their entries stay zero.


def mass_matrix(system: Articulation[S]) -> tuple[tuple[S, ...], ...]:
    """M, n x n and symmetric, in the order of the coordinates."""
    return _Composite(system).rows()


class _Composite(Generic[S]):
    def __init__(self, system: Articulation[S]) -> None:
        self.system = system
        self.algebra = system.algebra
        self.entries: dict[tuple[str, str], S] = {}
        self.order = {name: number for number, name in enumerate(system.coordinates)}
        # Whether there is any joint at the frame or below it that a wrench can still meet.
        self.moving: list[bool] = []
        for frame in system.frames:
            below = frame.parent >= 0 and self.moving[frame.parent]
            self.moving.append(below or bool(frame.angle_derivatives or frame.offset_derivatives))
        masses = list(system.masses)
        for number in reversed(range(len(masses))):
            self._frame(number, masses)

    def rows(self) -> tuple[tuple[S, ...], ...]:
        names, zero = self.system.coordinates, self.algebra.zero
        reduce = self.algebra.reduce
        entries = {key: reduce(value) for key, value in self.entries.items()}
        return tuple(tuple(entries.get(self._key(i, j), zero) for j in names) for i in names)

    def _key(self, i: str, j: str) -> tuple[str, str]:
        return (i, j) if self.order[i] <= self.order[j] else (j, i)

    def _frame(self, number: int, masses: list[MassProperties[S]]) -> None:
        """Entries of the joints of one frame with each other and with those nearer to the base."""
        algebra, frame = self.algebra, self.system.frames[number]
        if not self.moving[number]:
            return
        composite = masses[number]
        if frame.angle_derivatives and frame.turn is not None:
            axis = axis_vector(algebra, frame.turn.axis, algebra.one, frame.name)
            moment = composite.tensor.row(frame.turn.axis - 1)
            self._within(frame.angle_derivatives, moment[frame.turn.axis - 1])
            force = axis.cross(composite.first_moment)
            self._climb(number, frame.angle_derivatives, frame.back(force), frame.back(moment), None)
        turned = turned_back(algebra, composite, frame)
        for place, (name, v) in enumerate(frame.offset_derivatives.items()):
            force, moment = v * turned.mass, turned.first_moment.cross(v)
            self._climb(number, {name: algebra.one}, force, moment, place)
        if frame.parent >= 0 and self.moving[frame.parent]:
            carried = shifted(algebra, turned, frame.offset)
            masses[frame.parent] = total(masses[frame.parent], carried)

    def _climb(
        self, number: int, derivatives: Mapping[str, S], force: Vector[S], moment: Vector[S], place: int | None
    ) -> None:
        """A joint's wrench, in the parent's axes at the frame's origin, meets all joints nearer to the base.

        ``place`` is the joint's own place among the displacements of the frame; None is its turn.
        """
        one, frame = self.algebra.one, self.system.frames[number]
        while True:
            for other, (name, v) in enumerate(frame.offset_derivatives.items()):
                share = force.dot(v)
                if place is None or place < other:
                    self._between(derivatives, {name: one}, share)
                elif place == other:
                    self._within(derivatives, share)
            place = None
            if frame.parent < 0 or not self.moving[frame.parent]:
                return
            moment = moment + frame.offset.cross(force)
            frame = self.system.frames[frame.parent]
            if frame.turn is not None and frame.angle_derivatives:
                self._between(derivatives, frame.angle_derivatives, moment[frame.turn.axis - 1])
            force, moment = frame.back(force), frame.back(moment)

    def _within(self, derivatives: Mapping[str, S], share: S) -> None:
        """A joint with itself: one half of what it would be between two."""
        names = list(derivatives)
        for place, i in enumerate(names):
            for j in names[place:]:
                self._add(i, j, self.algebra.times(self.algebra.times(derivatives[i], derivatives[j]), share))

    def _between(self, first: Mapping[str, S], second: Mapping[str, S], share: S) -> None:
        algebra = self.algebra
        if algebra.vanishes(share):
            return
        for i, a in first.items():
            for j, b in second.items():
                value = algebra.times(algebra.times(a, b), share)
                self._add(i, j, value + value if i == j else value)

    def _add(self, i: str, j: str, value: S) -> None:
        if not self.algebra.vanishes(value):
            key = self._key(i, j)
            known = self.entries.get(key)
            self.entries[key] = value if known is None else known + value
