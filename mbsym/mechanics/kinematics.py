"""Problem 1's recursion over any scalar: how each body moves, from the base to the tips.

    omega_k = R^jk omega_j + omega^j_k,             turn by turn  w <- C_a(x) w + x' e_a
    V_Ok    = R^jk (V_Oj + omega_j x r^j_Ok + V^j_Ok),     V^j_Ok = d r^j_Ok / dt
    V_Ck    = V_Ok + omega_k x r^k_Ck

all in the axes of body k.  (Banshchikov & Vetrov print omega_k in the second line; r^j_Ok is fixed in body j, and their
own mass matrix needs omega_j.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.base import Algebra, Lowering, Scalar, Vector
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import ZERO, Expression
from mbsym.mechanics.frames import Turn, axis_vector, back, forward, turn_forward
from mbsym.mechanics.variables import time_derivative
from mbsym.model.system import INERTIAL, Body, System


@dataclass(frozen=True, slots=True)
class BodyMotion:
    """One body's motion in its own axes; ``offset`` is r^j_Ok in the axes of the body it is attached to.

    ``gyrostatic_moment`` is None where the body has none.
    """

    body: Body
    turns: tuple[Turn, ...]
    offset: Vector
    relative_angular_velocity: Vector
    angular_velocity: Vector
    velocity_origin: Vector
    velocity_mass_centre: Vector
    mass: Scalar
    mass_centre: Vector
    inertia: tuple[Vector, Vector, Vector] | None
    gyrostatic_moment: Vector | None


class Scene:
    """A system seen through one algebra: lowered expressions and the motion of every body.

    ``ring`` is the system's exact ring; formulas that simplify only there (the distance of an orbit point) are made in
    it and carried over.  With ``frozen`` the prescribed quantities and t stand still;
    without ``bodies`` only expressions are lowered.  Seen from frames that are ``falling`` their origins are at rest,
    and gravity is what it is beyond that at the origin (``mbsym.mechanics.falling``).
    """

    def __init__(
        self,
        system: System,
        algebra: Algebra,
        environment: Mapping[str, Scalar],
        ring: Ring,
        frozen: bool = False,
        bodies: bool = True,
        falling: frozenset[str] = frozenset(),
    ) -> None:
        self.system = system
        self.algebra = algebra
        self.ring = ring
        self.frozen = frozen
        self.falling = falling
        self.lower = Lowering(algebra, environment)
        self.environment = environment
        self._carrier = Carrier(ring, algebra, environment)
        self.motions: dict[str, BodyMotion] = {}
        for body in system.bodies if bodies else ():
            self.motions[body.name] = self._motion(body)

    def _motion(self, body: Body) -> BodyMotion:
        algebra, lower = self.algebra, self.lower
        turns = tuple(self._turns(body))
        relative = algebra.zero_vector
        parent_spin, parent_velocity = algebra.zero_vector, algebra.zero_vector
        if body.attached_to != INERTIAL:
            parent = self.motions[body.attached_to]
            parent_spin, parent_velocity = parent.angular_velocity, parent.velocity_origin
        spin = parent_spin
        for turn in turns:
            rate = axis_vector(algebra, turn.axis, turn.rate)
            relative = algebra.add(turn_forward(algebra, turn, relative), rate)
            spin = algebra.add(turn_forward(algebra, turn, spin), rate)
        offset = lower.vector(body.connection_point)
        relative_velocity = lower.vector([self.rate(x) for x in body.connection_point])
        carried = algebra.add(parent_velocity, algebra.cross(parent_spin, offset))
        velocity = forward(algebra, turns, algebra.add(carried, relative_velocity))
        if body.name in self.falling:
            velocity = algebra.zero_vector
        centre = lower.vector(body.mass_centre)
        tensor = None
        if body.inertia is not None:
            rows = body.inertia.tensor
            tensor = (lower.vector(rows[0]), lower.vector(rows[1]), lower.vector(rows[2]))
        return BodyMotion(
            body=body,
            turns=turns,
            offset=offset,
            relative_angular_velocity=relative,
            angular_velocity=spin,
            velocity_origin=velocity,
            velocity_mass_centre=algebra.add(velocity, algebra.cross(spin, centre)),
            mass=lower(body.mass),
            mass_centre=centre,
            inertia=tensor,
            gyrostatic_moment=None if body.gyrostatic_moment is None else lower.vector(body.gyrostatic_moment),
        )

    def _turns(self, body: Body) -> list[Turn]:
        turns = []
        for axis, angle in body.rotation.turns():
            if angle == ZERO:
                continue
            first = self.rate(angle)
            second = self.rate(first)
            turns.append(Turn(axis, angle, *self.lower.angle(angle), self.lower(first), self.lower(second)))
        return turns

    def rate(self, expression: Expression) -> Expression:
        """The time derivative of an expression, in this scene."""
        return time_derivative(expression, self.system, self.frozen)

    # --- vectors between frames ------------------------------------------------------------------------------------

    def to_axes(self, v: Vector, source: str, target: str) -> Vector:
        """The components of a vector, given in the axes of one body, in those of another."""
        up, down = self.system.path(source), self.system.path(target)
        common = sum(a == b for a, b in zip(up, down, strict=False))
        for name in reversed(up[common:]):
            v = back(self.algebra, self.motions[name].turns, v)
        for name in down[common:]:
            v = forward(self.algebra, self.motions[name].turns, v)
        return v

    def position(self, body: str, point: Vector, frame: str) -> Vector:
        """The radius vector from the origin of ``frame`` (an ancestor of body) to a point of body, in frame's axes."""
        while body != frame:
            motion = self.motions[body]
            point = self.algebra.add(motion.offset, back(self.algebra, motion.turns, point))
            body = motion.body.attached_to
        return point

    def common_ancestor(self, first: str, second: str) -> str:
        shared = [a for a, b in zip(self.system.path(first), self.system.path(second), strict=False) if a == b]
        return shared[-1]

    def carry(self, x: Polynomial) -> Any:
        """A polynomial of the ring, in this algebra."""
        return x if self.algebra is self.ring else self._carrier(x)
