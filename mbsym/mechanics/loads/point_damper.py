"""A dashpot along the line between two points."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.vectors import axis_vector
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.between import Pair, closing, noted
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import PointDamper


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


KIND = Kind(_point_damper_action, notes=noted)
