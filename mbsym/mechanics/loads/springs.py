"""Springs and dampers: on a coordinate, and between two points of bodies, with equal and opposite forces."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Generic

from mbsym.algebra.base import S
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.expressions.tree import differentiate, names, sticks, without_tables
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Note, force_at
from mbsym.model.loads import CoordinateDamper, CoordinateSpring, IsotropicDamper, PointDamper, PointSpring, Rayleigh
from mbsym.model.system import INERTIAL, Point, velocity_name


class Pair(Generic[S]):
    """Two points seen from their nearest common ancestor, where what lies below it drops out."""

    def __init__(self, first: Point, second: Point, scene: Scene[S]) -> None:
        self.scene = scene
        self.ends = (first, second)
        self.frame = scene.common_ancestor(first.body, second.body)
        self.points = [scene.vector(end.position, end.body) for end in self.ends]
        reach = [scene.position(point, self.frame) for point in self.points]
        self.span = reach[1] - reach[0]

    def action(self, pull: Vector[S]) -> Action[S]:
        """``pull`` (in the frame's axes) on the first point and its opposite on the second."""
        wrenches = []
        for point, force in zip(self.points, (pull, -pull), strict=True):
            if point.frame != INERTIAL:
                wrenches.append(force_at(point, self.scene.to_axes(force, point.frame)))
        return Action(tuple(wrenches))


def point_velocity(scene: Scene[S], point: Vector[S]) -> Vector[S]:
    """V_O + omega x r of a point r of the body in whose axes it is; zero for a point of the inertial frame."""
    if point.frame == INERTIAL:
        return scene.zero(INERTIAL)
    motion = scene.motions[point.frame]
    return motion.velocity_origin + motion.angular_velocity.cross(point)


def closing(pair: Pair[S], scene: Scene[S]) -> Vector[S]:
    """V_second - V_first, in the axes of the pair's frame."""
    speeds = [scene.to_axes(point_velocity(scene, point), pair.frame) for point in pair.points]
    return speeds[1] - speeds[0]


def noted(load: PointSpring | PointDamper | IsotropicDamper, scene: Scene[S]) -> Iterator[Note]:
    """r_second - r_first, in the axes of the nearest common ancestor of their bodies."""
    yield Note(Quantity.SPAN, "", Pair(load.first, load.second, scene).span)


# A spring on a coordinate: U = -stiffness (q - rest)^2 / 2.


def _stretch(load: CoordinateSpring, scene: Scene[S]) -> S:
    return scene.environment[load.coordinate] - scene.lower(load.rest)


def _spring_force_function(load: CoordinateSpring, scene: Scene[S]) -> S:
    """U = -stiffness (q - rest)^2 / 2."""
    stretch = _stretch(load, scene)
    square = scene.algebra.times(stretch, stretch)
    half = scene.algebra.number(Fraction(-1, 2))
    return scene.algebra.times(half, scene.algebra.times(scene.lower(load.stiffness), square))


def _spring_action(load: CoordinateSpring, scene: Scene[S]) -> Action[S]:
    """Q = -stiffness (q - rest)."""
    pull = scene.algebra.times(scene.lower(load.stiffness), _stretch(load, scene))
    return Action(generalized={load.coordinate: -pull})


COORDINATE_SPRING = Kind(_spring_action, _spring_force_function)


# A spring between two points: U = -stiffness (distance - length)^2 / 2.


def _point_spring_force_function(load: PointSpring, scene: Scene[S]) -> S:
    """U = -stiffness (d^2 - 2 d length + length^2) / 2; without a natural length no root is taken."""
    algebra = scene.algebra
    span = Pair(load.first, load.second, scene).span
    square = span.dot(span)
    length = scene.lower(load.length)
    energy = square
    if not algebra.vanishes(length):
        twice = algebra.times(algebra.number(2), algebra.times(algebra.square_root(square), length))
        energy = square - twice + algebra.times(length, length)
    half = algebra.number(Fraction(-1, 2))
    return algebra.reduce(algebra.times(half, algebra.times(scene.lower(load.stiffness), energy)))


def _point_spring_action(load: PointSpring, scene: Scene[S]) -> Action[S]:
    """stiffness (1 - length/d) (r_second - r_first) on the first point."""
    algebra = scene.algebra
    pair = Pair(load.first, load.second, scene)
    length = scene.lower(load.length)
    factor = scene.lower(load.stiffness)
    if not algebra.vanishes(length):
        distance = algebra.square_root(pair.span.dot(pair.span))
        strain = algebra.one - algebra.times(length, algebra.reciprocal(distance))
        factor = algebra.times(factor, strain)
    return pair.action(pair.span * algebra.reduce(factor))


POINT_SPRING = Kind(_point_spring_action, _point_spring_force_function, notes=noted)


# A damper on a coordinate: Q = -coefficient q'.


def _damper_action(load: CoordinateDamper, scene: Scene[S]) -> Action[S]:
    """Q = -coefficient q'."""
    rate = scene.environment[velocity_name(load.coordinate)]
    return Action(generalized={load.coordinate: -scene.algebra.times(scene.lower(load.coefficient), rate)})


COORDINATE_DAMPER = Kind(_damper_action)


# A dashpot along the line between two points.


def _point_damper_action(load: PointDamper, scene: Scene[S]) -> Action[S]:
    """coefficient (u . (V_second - V_first)) u on the first point, with u along the line between the points.

    On a line that never turns u is its axis; elsewhere u u^T = r r^T / r.r with r = r_second - r_first, which is
    singular where the points meet: there the line has no direction.

    Raises SingularPoint where they meet.
    """
    algebra = scene.algebra
    pair = Pair(load.first, load.second, scene)
    towards = closing(pair, scene)
    coefficient = scene.lower(load.coefficient)
    along = [axis for axis in range(3) if not algebra.vanishes(pair.span[axis])]
    if len(along) == 1:
        pull = algebra.times(coefficient, towards[along[0]])
        return pair.action(axis_vector(algebra, along[0] + 1, pull, pair.frame))
    try:
        inverse_square = algebra.reciprocal(pair.span.dot(pair.span))
    except SingularPoint:
        raise SingularPoint("the points of a damper coincide: the line between them has no direction") from None
    rate = algebra.reduce(algebra.times(pair.span.dot(towards), inverse_square))
    return pair.action(pair.span * algebra.reduce(algebra.times(coefficient, rate)))


POINT_DAMPER = Kind(_point_damper_action, notes=noted)


# A damper against all relative motion of two points.


def _isotropic_damper_action(load: IsotropicDamper, scene: Scene[S]) -> Action[S]:
    """coefficient (V_second - V_first) on the first point."""
    pair = Pair(load.first, load.second, scene)
    coefficient = scene.lower(load.coefficient)
    return pair.action(closing(pair, scene) * coefficient)


ISOTROPIC_DAMPER = Kind(_isotropic_damper_action, notes=noted)


# A dissipation function R(q, q') given by a formula.


def _rayleigh_action(load: Rayleigh, scene: Scene[S]) -> Action[S]:
    """Q = -dR/dq', or -dR/du.  A kink in a velocity is dry friction, which holds there: its table becomes moduli."""
    present = names(load.expression)
    potential = without_tables(load.expression, sticks)
    rates = {name: velocity_name(name) for name in scene.system.coordinates}
    rates |= {one.name: one.name for one in scene.system.speeds if scene.in_speeds}
    forces = {name: -scene.lower(differentiate(potential, rate)) for name, rate in rates.items() if rate in present}
    return Action(generalized=forces)


RAYLEIGH = Kind(_rayleigh_action)
