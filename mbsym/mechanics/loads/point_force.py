"""A force on a point of a body; with components in the body's own axes it follows the body."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, force_at
from mbsym.model.loads import PointForce


def _force_action(load: PointForce, scene: Scene[S]) -> Action[S]:
    force = scene.to_axes(scene.vector(load.components, load.axes), load.point.body)
    point = scene.vector(load.point.position, load.point.body)
    return Action((force_at(point, force),))


KIND = Kind(_force_action)
