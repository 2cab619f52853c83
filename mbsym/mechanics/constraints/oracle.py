"""Constraint rows by another route: bodies placed in inertial axes, as series in time and along each coordinate.

Nothing is taken from the recursion of the rows: a position is differentiated by being a series s -> r(q(s)), an angular
velocity is read off the rate of the axes.  Rows are given in the axes of the frame in which ``rows`` has them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from mbsym.algebra.base import Scalar
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import Expression, subtract
from mbsym.mechanics.constraints.rows import normals
from mbsym.mechanics.oracle import Oracle, Placement, Series, State, cross, dot
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.system import INERTIAL, Point, System


@dataclass(frozen=True, slots=True)
class OracleRow:
    """f (None of a velocity constraint), g, dg/dt at the accelerations of the state, and dg/dq'."""

    position: Scalar | None
    velocity: Scalar
    acceleration: Scalar
    partials: tuple[Scalar, ...]


def oracle_rows(system: System, state: State) -> list[list[OracleRow]]:
    """The rows of every constraint at one state, trivial ones included."""
    rows = _Rows(Oracle(system, state))
    return [rows.of(constraint) for constraint in system.constraints]


class _Rows:
    def __init__(self, oracle: Oracle) -> None:
        self.oracle = oracle
        self.system = oracle.system
        self.numbers = oracle.numbers

    def of(self, constraint: Constraint) -> list[OracleRow]:
        if isinstance(constraint, Rolling):
            return self._rolling(constraint)
        if isinstance(constraint, Velocity):
            return [self._velocity(subtract(constraint.left, constraint.right))]
        two, slopes = self.numbers.number(2), [[x.b for x in self._series(constraint, place)] for place in self._along]
        rows = self._series(constraint, self.oracle.moving)
        return [OracleRow(x.a, x.b, two * x.c, tuple(slope[k] for slope in slopes)) for k, x in enumerate(rows)]

    @cached_property
    def _along(self) -> list[Placement]:
        """By coordinate the system that moves with the rate 1 of this one alone."""
        state, zero = self.oracle.state, self.numbers.zero
        rest = {key: Series(value, zero, zero) for key, value in state.values.items()}
        return [
            Placement(self.system, state, rest | {name: Series(state.values[name], self.numbers.one, zero)})
            for name in self.system.coordinates
        ]

    # --- what is given by places ---

    def _series(self, constraint: Constraint, place: Placement) -> list[Series]:
        if isinstance(constraint, Relation):
            return [place.lower(subtract(constraint.left, constraint.right))]
        if isinstance(constraint, Parallel):
            e = place.direction(constraint.second.body, place.lower.vector(constraint.second.direction))
            products = []
            for normal in normals(constraint.first.direction):
                n = place.direction(constraint.first.body, place.lower.vector(normal))
                products.append(dot(n, e))
            return products
        assert isinstance(constraint, Coincide | Distance)
        apart = [
            a - b
            for a, b in zip(self._point(place, constraint.first), self._point(place, constraint.second), strict=True)
        ]
        if isinstance(constraint, Distance):
            length, half = place.lower(constraint.length), place.algebra.number(Fraction(1, 2))
            return [half * (dot(apart, apart) - length * length)]
        axes = place.axes[self._frame(constraint.first.body, constraint.second.body)]
        return [dot([axes[i][k] for i in range(3)], apart) for k in range(3)]

    def _point(self, place: Placement, point: Point) -> Any:
        return place.point(point.body, place.lower.vector(point.position))

    def _frame(self, *bodies: str) -> str:
        """The last frame that carries them all."""
        paths = [self.system.path(body) for body in bodies]
        shared = INERTIAL
        for names in zip(*paths, strict=False):
            if len(set(names)) > 1:
                break
            shared = names[0]
        return shared

    # --- what is given by velocities ---

    def _velocity(self, g: Expression) -> OracleRow:
        """g as a series in time, and its increments by unit velocities (it is linear in them)."""
        moving = self.oracle.moving.lower(g)
        values, zero = dict(self.oracle.state.values), self.numbers.zero
        for name in self.system.coordinates:
            values[velocity_name(name)] = zero
        slopes = []
        for name in ("", *self.system.coordinates):
            there = {**values, velocity_name(name): self.numbers.one} if name else values
            place = {key: Series(value, zero, zero) for key, value in there.items()}
            slopes.append(type(self.oracle.moving.lower)(self.oracle.moving.algebra, self._angles(place))(g).a)
        return OracleRow(None, moving.a, moving.b, tuple(x - slopes[0] for x in slopes[1:]))

    def _angles(self, place: dict[str, Series]) -> dict[str, Series]:
        """Sines are looked up at the state: nothing but velocities differs there."""
        return place

    def _rolling(self, rolling: Rolling) -> list[OracleRow]:
        """V + omega x (c - r) of both bodies, each from rates of places: in time, and along each coordinate."""
        moving = self._slip(rolling, self.oracle.moving, 0), self._slip(rolling, self.oracle.moving, 1)
        slopes = [self._slip(rolling, place, 0) for place in self._along]
        return [OracleRow(None, moving[0][k], moving[1][k], tuple(slope[k] for slope in slopes)) for k in range(3)]

    def _slip(self, rolling: Rolling, place: Placement, order: int) -> list[Scalar]:
        """The slip at the contact (order 0), or its rate, in the axes of the frame that carries all."""
        arm = place.direction(rolling.axes, place.lower.vector(rolling.contact))
        contact = [a + b for a, b in zip(place.origin[rolling.body], arm, strict=True)]
        slip = [
            [x - y for x, y in zip(u, v, strict=True)]
            for u, v in zip(
                self._material(place, rolling.body, contact), self._material(place, rolling.on, contact), strict=True
            )
        ]
        axes = place.axes[self._frame(rolling.body, rolling.on, rolling.axes)]
        scalars = []
        for k in range(3):
            column = [axes[i][k] for i in range(3)]
            total = self.numbers.zero
            for i in range(3):
                total = total + column[i].a * slip[order][i]
                if order:
                    total = total + column[i].b * slip[0][i]
            scalars.append(total)
        return scalars

    def _material(self, place: Placement, body: str, contact: Any) -> list[list[Scalar]]:
        """The velocity of the material point at a contact that moves, and its rate, in inertial axes."""
        omega, rate = place.spin(body) if body != INERTIAL else ([self.numbers.zero] * 3, [self.numbers.zero] * 3)
        origin, two = place.origin[body], self.numbers.number(2)
        arm = [c - o for c, o in zip(contact, origin, strict=True)]
        turned = cross(omega, [x.a for x in arm])
        swung = [a + b for a, b in zip(cross(rate, [x.a for x in arm]), cross(omega, [x.b for x in arm]), strict=True)]
        return [
            [x.b + y for x, y in zip(origin, turned, strict=True)],
            [two * x.c + y for x, y in zip(origin, swung, strict=True)],
        ]
