"""Two points of bodies and what acts between them: equal and opposite forces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Note, force_at
from mbsym.model.loads import IsotropicDamper, PointDamper, PointSpring
from mbsym.model.system import INERTIAL, Point


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
