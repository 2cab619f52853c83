"""Forces and torques on bodies; with components in the body's own axes they follow it."""

from __future__ import annotations

from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Wrench, force_at
from mbsym.model.system import INERTIAL, PointForce, Torque


def _force_action(load: PointForce, scene: Scene) -> Action:
    force = scene.to_axes(scene.vector(load.components, load.axes), load.point.body)
    point = scene.vector(load.point.position, load.point.body)
    return Action((force_at(point, force),))


FORCE = Kind(_force_action)


def _torque_action(load: Torque, scene: Scene) -> Action:
    given = scene.vector(load.components, load.axes)
    wrenches = []
    for body, torque in ((load.body, given), (load.reaction_on, -given)):
        if body is not None and body != INERTIAL:
            wrenches.append(Wrench(body, scene.zero(body), scene.to_axes(torque, body)))
    return Action(tuple(wrenches))


TORQUE = Kind(_torque_action)
