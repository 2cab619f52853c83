"""A spring between two points: U = -stiffness (distance - length)^2 / 2."""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.between import Pair, noted
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import PointSpring


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


KIND = Kind(_point_spring_action, _point_spring_force_function, notes=noted)
