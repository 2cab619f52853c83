"""The mass matrix by composite bodies, over any scalar.

Everything beyond a joint moves as one rigid body when only that joint moves (Walker & Orin 1982; Featherstone, Rigid
Body Dynamics Algorithms, 2008, section 6.2).  Elementary joints are the turn of a frame about one of its axes and the
displacement of its origin; with the composite (m, h, J) of all frames beyond it about O_k, a unit acceleration takes

    turn about a:         f = e_a x h,    n = J e_a
    displacement along v:    f = m v,        n = h x v

and f, n are carried to the base, where they meet the joints in between.  A coordinate may occur in several joints:

    M_ij = sum over pairs of joints (e, e') of  (dx_e/dq_i) (dx_e'/dq_j) m_ee' .

Joints of different branches do not meet, so their entries stay zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Generic

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.mechanics.articulation import Articulation, MassProperties, shifted, total, turned_back


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
        found = {key: reduce(value) for key, value in self.entries.items()}
        return tuple(tuple(found.get(self._key(i, j), zero) for j in names) for i in names)

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
