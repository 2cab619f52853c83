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

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.expressions.tree import Expression, differentiate, names
from mbsym.mechanics.frames import Turn
from mbsym.mechanics.kinematics import Scene
from mbsym.model.system import INERTIAL
from mbsym.model.system import Vector as Expressions


@dataclass(frozen=True, slots=True)
class Moving:
    """A vector u with its first and second rate, seen from one frame and in its axes."""

    value: Vector
    first: Vector
    second: Vector

    @property
    def frame(self) -> str:
        return self.value.frame

    def __add__(self, other: Moving) -> Moving:
        return Moving(self.value + other.value, self.first + other.first, self.second + other.second)

    def __sub__(self, other: Moving) -> Moving:
        return Moving(self.value - other.value, self.first - other.first, self.second - other.second)

    def in_parallel(self, frame: str) -> Moving:
        return Moving(self.value.in_parallel(frame), self.first.in_parallel(frame), self.second.in_parallel(frame))


@dataclass(frozen=True, slots=True)
class Rates:
    """How expressions change: ``first`` and ``second`` rate of an expression, as scalars.

    Where ``bent`` is false nobody asks for second rates: they are left at zero, and mean nothing.
    """

    first: Callable[[Expression], Scalar]
    second: Callable[[Expression], Scalar]
    bent: bool = True


def along_motion(scene: Scene) -> Rates:
    """d/dt and its square, with the accelerations of the scene (zero in one without accelerations)."""
    return Rates(
        lambda x: scene.lower(scene.rate(x)),
        lambda x: scene.lower(scene.rate(scene.rate(x))),
    )


def along_coordinate(scene: Scene, name: str) -> Rates:
    """The derivative by one coordinate, in place of the first rate."""
    zero = scene.algebra.zero

    def slope(x: Expression) -> Scalar:
        return scene.lower(differentiate(x, name)) if name in names(x) else zero

    return Rates(slope, lambda _: zero, bent=False)


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

    def moving(self, components: Expressions, frame: str) -> Moving:
        """A vector given by expressions in the axes of a frame, with the rates of its components."""
        rates = self.rates
        return Moving(
            self.scene.vector(components, frame),
            _vector(self.algebra, [rates.first(x) for x in components], frame),
            _vector(self.algebra, [rates.second(x) for x in components], frame),
        )

    def fixed(self, v: Vector) -> Moving:
        """A vector whose components do not change."""
        zero = self.scene.zero(v.frame)
        return Moving(v, zero, zero)

    def vector(self, u: Moving) -> Moving:
        """A vector in the axes of a body, seen from the frame."""
        while u.frame != self.frame:
            u = self._back(u)
        return u

    def point(self, u: Moving) -> Moving:
        """A point, given by its radius vector from the origin of a body in the axes of that body."""
        while u.frame != self.frame:
            body = self.scene.motions[u.frame].body
            u = self.moving(body.connection_point, body.attached_to) + self._back(u)
        return u

    def spin(self, body: str) -> Moving:
        """The angular velocity of a body relative to the frame and its rate; ``second`` is not used."""
        total = self.fixed(self.scene.zero(body))
        while body != self.frame:
            before = self.scene.motions[body].body.attached_to
            for turn, rate, second in reversed(self.turns(body)):
                lengths = (rate, second, self.algebra.zero)
                axis = Moving(*(axis_vector(self.algebra, turn.axis, x, turn.frame) for x in lengths))
                total = self._turned_back(turn, rate, second, total + axis)
            body, total = before, total.in_parallel(before)
        return total

    def turns(self, body: str) -> tuple[tuple[Turn, Scalar, Scalar], ...]:
        """The elementary turns of a body's joint with their first and second rates."""
        if body not in self._turns:
            turns = self.scene.motions[body].turns
            self._turns[body] = tuple((x, self.rates.first(x.angle), self.rates.second(x.angle)) for x in turns)
        return self._turns[body]

    def _back(self, u: Moving) -> Moving:
        """From the axes of a body to those of the one it is attached to, as seen from there."""
        before = self.scene.motions[u.frame].body.attached_to
        for turn, rate, second in reversed(self.turns(u.frame)):
            u = self._turned_back(turn, rate, second, u)
        return u.in_parallel(before)

    def _turned_back(self, turn: Turn, rate: Scalar, second: Scalar, u: Moving) -> Moving:
        spin = axis_vector(self.algebra, turn.axis, rate, turn.frame)
        swung = spin.cross(u.value)
        value, first = turn.back(u.value), turn.back(u.first + swung)
        if not self.rates.bent:
            return Moving(value, first, self.scene.zero(turn.source))
        twice = spin.cross(u.first + u.first + swung)
        lag = axis_vector(self.algebra, turn.axis, second, turn.frame).cross(u.value)
        return Moving(value, first, turn.back(u.second + twice + lag))


def common_frame(scene: Scene, bodies: Sequence[str]) -> str:
    """The last frame that carries all these bodies."""
    frame = bodies[0]
    for body in bodies[1:]:
        frame = INERTIAL if INERTIAL in (frame, body) else scene.common_ancestor(frame, body)
    return frame


def _vector(algebra: Algebra, items: Sequence[Scalar], frame: str) -> Vector:
    a, b, c = items
    return Vector(algebra, (a, b, c), frame)
