"""Problem 1's recursion over any scalar: how each body moves, from the base to the tips.

    omega_k = R^jk omega_j + omega^j_k,             turn by turn  w <- C_a(x) w + x' e_a
    V_Ok    = R^jk (V_Oj + omega_j x r^j_Ok + V^j_Ok),     V^j_Ok = d r^j_Ok / dt
    V_Ck    = V_Ok + omega_k x r^k_Ck

all in the axes of body k.  (Banshchikov & Vetrov print omega_k in the second line; r^j_Ok is fixed in body j, and their
own mass matrix needs omega_j.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic

from mbsym.algebra.base import Algebra, Lowering, S
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.vectors import Tensor, Vector, axis_vector, tensor_of, zero_vector
from mbsym.expressions.tree import ZERO, Expression
from mbsym.mechanics.frames import Turn, back, forward, given_rotation
from mbsym.mechanics.variables import ring_environment, time_derivative
from mbsym.model.system import INERTIAL, Body, Load, System


@dataclass(frozen=True, slots=True)
class BodyMotion(Generic[S]):
    """One body's motion in its own axes; ``offset`` is r^j_Ok in the axes of the body it is attached to.

    ``gyrostatic_moment`` is None where the body has none.
    """

    body: Body
    turns: tuple[Turn[S], ...]
    offset: Vector[S]
    relative_angular_velocity: Vector[S]
    angular_velocity: Vector[S]
    velocity_origin: Vector[S]
    velocity_mass_centre: Vector[S]
    mass: S
    mass_centre: Vector[S]
    inertia: Tensor[S] | None
    gyrostatic_moment: Vector[S] | None


@dataclass(frozen=True, slots=True)
class Given(Generic[S]):
    """A body whose angular velocity and acceleration are variables of their own, in its axes (``mechanics.speeds``).

    ``cosines`` are its direction cosines where these are variables, too; None where it is turned by angles.
    """

    angular_velocity: Vector[S]
    angular_acceleration: Vector[S]
    cosines: Tensor[S] | None = None


class Scene(Generic[S]):
    """A system seen through one algebra: lowered expressions and the motion of every body.

    ``ring`` is the system's exact ring; formulas that simplify only there (the distance of an orbit point) are made in
    it and carried over.  With ``frozen`` the prescribed quantities and t stand still;
    without ``bodies`` only expressions are lowered.  What is ``given`` of bodies is taken as it is; where ``in_speeds``
    speeds and unit vectors have values, and loads are taken as they were written.
    Seen from frames that are ``falling`` their origins are at rest,
    and gravity is what it is beyond that at the origin (``mbsym.mechanics.falling``).
    """

    def __init__(
        self,
        system: System,
        algebra: Algebra[S],
        environment: Mapping[str, S],
        ring: Ring,
        frozen: bool = False,
        bodies: bool = True,
        falling: frozenset[str] = frozenset(),
        given: Mapping[str, Given[S]] | None = None,
        in_speeds: bool = False,
    ) -> None:
        self.system = system
        self.in_speeds = in_speeds
        self.given = given or {}
        self.algebra = algebra
        self.ring = ring
        self.frozen = frozen
        self.falling = falling
        self.lower = Lowering(algebra, environment)
        self.environment = environment
        self._carrier = Carrier(ring, algebra, environment)
        self.motions: dict[str, BodyMotion[S]] = {}
        for body in system.bodies if bodies else ():
            self.motions[body.name] = self._motion(body)

    @property
    def loads(self) -> tuple[Load, ...]:
        """The loads in formulas that have values here."""
        return tuple(x.written for x in self.system.loads) if self.in_speeds else self.system.loads

    def _motion(self, body: Body) -> BodyMotion[S]:
        algebra, lower, name, before = self.algebra, self.lower, body.name, body.attached_to
        given = self.given.get(name)
        if given is not None and given.cosines is not None:
            turns: tuple[Turn[S], ...] = (given_rotation(given.cosines),)
        else:
            turns = tuple(self._turns(body))
        parent_spin = parent_velocity = self.zero(before)
        if before != INERTIAL:
            parent_spin, parent_velocity = self.motions[before].angular_velocity, self.motions[before].velocity_origin
        relative, spin = self.zero(before), parent_spin
        for turn in turns if given is None else ():
            rate = axis_vector(algebra, turn.axis, turn.rate, turn.frame)
            relative = turn.out(relative) + rate
            spin = turn.out(spin) + rate
        if given is not None:
            spin = given.angular_velocity
            relative = spin - forward(turns, parent_spin, name)
        elif not turns:
            relative, spin = relative.in_parallel(name), spin.in_parallel(name)
        offset = self.vector(body.connection_point, before)
        relative_velocity = self.vector([self.rate(x) for x in body.connection_point], before)
        carried = parent_velocity + parent_spin.cross(offset)
        velocity = forward(turns, carried + relative_velocity, name)
        if name in self.falling:
            velocity = self.zero(name)
        centre = self.vector(body.mass_centre, name)
        inertia = self._inertia(body)
        return BodyMotion(
            body=body,
            turns=turns,
            offset=offset,
            relative_angular_velocity=relative,
            angular_velocity=spin,
            velocity_origin=velocity,
            velocity_mass_centre=velocity + spin.cross(centre),
            mass=lower(body.mass),
            mass_centre=centre,
            inertia=inertia,
            gyrostatic_moment=self._gyrostatic_moment(body),
        )

    def _inertia(self, body: Body) -> Tensor[S] | None:
        if body.inertia is None:
            return None
        return tensor_of(self.algebra, [self.lower.vector(row) for row in body.inertia.tensor], body.name)

    def _gyrostatic_moment(self, body: Body) -> Vector[S] | None:
        return None if body.gyrostatic_moment is None else self.vector(body.gyrostatic_moment, body.name)

    def _turns(self, body: Body) -> list[Turn[S]]:
        """The turns that there are; the axes between two of them have a name of their own."""
        rotations = [(axis, angle) for axis, angle in body.rotation.turns() if angle != ZERO]
        frames = [body.attached_to, *(f"{body.name} after turn {k}" for k in range(1, len(rotations))), body.name]
        turns = []
        for (axis, angle), source, frame in zip(rotations, frames, frames[1:], strict=False):
            first = self.rate(angle)
            second = self.rate(first)
            sine, cosine = self.lower.angle(angle)
            turns.append(Turn(axis, angle, sine, cosine, self.lower(first), self.lower(second), source, frame))
        return turns

    def rate(self, expression: Expression) -> Expression:
        """The time derivative of an expression, in this scene."""
        return time_derivative(expression, self.system, self.frozen)

    # --- vectors and their frames -----------------------------------------------------------------------------------

    def vector(self, components: Sequence[Expression], frame: str) -> Vector[S]:
        """The vector that has these components in the axes of a body."""
        return Vector(self.algebra, self.lower.vector(components), frame)

    def zero(self, frame: str) -> Vector[S]:
        return zero_vector(self.algebra, frame)

    def out(self, body: str, v: Vector[S]) -> Vector[S]:
        """From the axes of the body that it is attached to, to its own."""
        return forward(self.motions[body].turns, v, body)

    def back(self, body: str, v: Vector[S]) -> Vector[S]:
        """From a body's own axes to those of the body that it is attached to."""
        motion = self.motions[body]
        return back(motion.turns, v, motion.body.attached_to)

    def to_axes(self, v: Vector[S], target: str) -> Vector[S]:
        """A vector in the axes of another body."""
        up, down = self.system.path(v.frame), self.system.path(target)
        common = sum(a == b for a, b in zip(up, down, strict=False))
        for name in reversed(up[common:]):
            v = self.back(name, v)
        for name in down[common:]:
            v = self.out(name, v)
        return v

    def position(self, point: Vector[S], frame: str) -> Vector[S]:
        """The radius vector from the origin of ``frame`` to a point, in the axes of ``frame``.

        ``point`` is its radius vector from the origin of the body in whose axes it is; ``frame`` is an ancestor.
        """
        while point.frame != frame:
            point = self.motions[point.frame].offset + self.back(point.frame, point)
        return point

    def common_ancestor(self, first: str, second: str) -> str:
        shared = [a for a, b in zip(self.system.path(first), self.system.path(second), strict=False) if a == b]
        return shared[-1]

    def carry(self, x: Polynomial) -> Any:
        """A polynomial of the ring, in this algebra."""
        return x if self.algebra is self.ring else self._carrier(x)

    def carried(self, v: Vector[S]) -> Vector[S]:
        """A vector over the ring, in this algebra."""
        a, b, c = v
        return Vector(self.algebra, (self.carry(a), self.carry(b), self.carry(c)), v.frame)


def over_ring(system: System, ring: Ring, bodies: bool = True, frozen: bool = False) -> Scene:
    """The system over its ring, in coordinates."""
    return Scene(system, ring, ring_environment(system, ring), ring, bodies=bodies, frozen=frozen)
