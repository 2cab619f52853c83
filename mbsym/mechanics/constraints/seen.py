"""How points and axes of one body move, seen from a frame that carries it; any scalar.

A vector with its first and second rate (u, v, a), as seen from frame k, is seen from frame j on which k turns at the
angle x about the axis e

    u <- C^T u,    v <- C^T (v + x' e x u),    a <- C^T (a + 2 x' e x v + x'' e x u + x' e x (x' e x u)),

and a point has the radius vector of the origin of k, its rate and second rate added.  Rates are those of ``Rates``:
time derivatives along the motion, or the derivatives along one coordinate, with which v becomes a partial velocity.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mbsym.algebra.base import Algebra, Scalar, Vector
from mbsym.expressions.tree import Expression, differentiate, names
from mbsym.mechanics.frames import Turn, axis_vector, turn_back
from mbsym.mechanics.kinematics import Scene
from mbsym.model.system import INERTIAL
from mbsym.model.system import Vector as Expressions


@dataclass(frozen=True, slots=True)
class Moving:
    """A vector u with its first and second rate, seen from one frame and in its axes."""

    value: Vector
    first: Vector
    second: Vector


@dataclass(frozen=True, slots=True)
class Rates:
    """How expressions change: ``first`` and ``second`` rate of an expression, as scalars."""

    first: Callable[[Expression], Scalar]
    second: Callable[[Expression], Scalar]


def along_motion(scene: Scene) -> Rates:
    """d/dt and its square, with the accelerations of the scene (zero in one without accelerations)."""
    return Rates(
        lambda x: scene.lower(scene.rate(x)),
        lambda x: scene.lower(scene.rate(scene.rate(x))),
    )


def along_coordinate(scene: Scene, name: str) -> Rates:
    """The derivative by one coordinate, in place of the first rate; second rates are zero, and mean nothing."""
    zero = scene.algebra.zero

    def slope(x: Expression) -> Scalar:
        return scene.lower(differentiate(x, name)) if name in names(x) else zero

    return Rates(slope, lambda _: zero)


class View:
    """Bodies of a scene as seen from one frame that carries them, with certain rates.

    What is seen of a body is remembered, so that several points of it cost little.
    """

    def __init__(self, scene: Scene, frame: str, rates: Rates) -> None:
        self.scene = scene
        self.frame = frame
        self.rates = rates
        self._turns: dict[str, tuple[tuple[Turn, Scalar, Scalar], ...]] = {}

    @property
    def algebra(self) -> Algebra:
        return self.scene.algebra

    def moving(self, components: Expressions) -> Moving:
        """A vector given by expressions, with the rates of its components."""
        return Moving(
            self.scene.lower.vector(components),
            _triple([self.rates.first(x) for x in components]),
            _triple([self.rates.second(x) for x in components]),
        )

    def fixed(self, v: Vector) -> Moving:
        """A vector whose components do not change."""
        return Moving(v, self.algebra.zero_vector, self.algebra.zero_vector)

    def vector(self, body: str, u: Moving) -> Moving:
        """A vector in the axes of a body, seen from the frame."""
        while body != self.frame:
            u = self._back(body, u)
            body = self.scene.motions[body].body.attached_to
        return u

    def point(self, body: str, u: Moving) -> Moving:
        """A point, given by its radius vector from the origin of a body in the axes of that body."""
        while body != self.frame:
            motion = self.scene.motions[body]
            u = self.sum(self.moving(motion.body.connection_point), self._back(body, u))
            body = motion.body.attached_to
        return u

    def spin(self, body: str) -> Moving:
        """The angular velocity of a body relative to the frame and its rate; ``second`` is not used."""
        zero = self.algebra.zero_vector
        total = Moving(zero, zero, zero)
        while body != self.frame:
            for turn, rate, second in reversed(self.turns(body)):
                axis = Moving(
                    axis_vector(self.algebra, turn.axis, rate), axis_vector(self.algebra, turn.axis, second), zero
                )
                total = self._turned_back(turn, rate, second, self.sum(total, axis))
            body = self.scene.motions[body].body.attached_to
        return total

    def sum(self, u: Moving, v: Moving) -> Moving:
        add = self.algebra.add
        return Moving(add(u.value, v.value), add(u.first, v.first), add(u.second, v.second))

    def difference(self, u: Moving, v: Moving) -> Moving:
        subtract = self.algebra.subtract
        return Moving(subtract(u.value, v.value), subtract(u.first, v.first), subtract(u.second, v.second))

    def turns(self, body: str) -> tuple[tuple[Turn, Scalar, Scalar], ...]:
        """The elementary turns of a body's joint with their first and second rates."""
        if body not in self._turns:
            turns = self.scene.motions[body].turns
            self._turns[body] = tuple((x, self.rates.first(x.angle), self.rates.second(x.angle)) for x in turns)
        return self._turns[body]

    def _back(self, body: str, u: Moving) -> Moving:
        for turn, rate, second in reversed(self.turns(body)):
            u = self._turned_back(turn, rate, second, u)
        return u

    def _turned_back(self, turn: Turn, rate: Scalar, second: Scalar, u: Moving) -> Moving:
        algebra = self.algebra
        spin = axis_vector(algebra, turn.axis, rate)
        swung = algebra.cross(spin, u.value)
        first = algebra.add(u.first, swung)
        twice = algebra.cross(spin, algebra.add(algebra.add(u.first, u.first), swung))
        lag = algebra.cross(axis_vector(algebra, turn.axis, second), u.value)
        acceleration = algebra.add(algebra.add(u.second, twice), lag)
        return Moving(
            turn_back(algebra, turn, u.value),
            turn_back(algebra, turn, first),
            turn_back(algebra, turn, acceleration),
        )


def common_frame(scene: Scene, bodies: Sequence[str]) -> str:
    """The last frame that carries all these bodies."""
    frame = bodies[0]
    for body in bodies[1:]:
        frame = INERTIAL if INERTIAL in (frame, body) else scene.common_ancestor(frame, body)
    return frame


def _triple(items: Sequence[Scalar]) -> Vector:
    return (items[0], items[1], items[2])
