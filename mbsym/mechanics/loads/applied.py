"""Forces and torques on bodies; with components in the body's own axes they follow it."""

from __future__ import annotations

from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Wrench, force_at
from mbsym.model.system import INERTIAL, PointForce, Torque


def _force_action(load: PointForce, scene: Scene) -> Action:
    force = scene.to_axes(scene.lower.vector(load.components), load.axes, load.point.body)
    point = scene.lower.vector(load.point.position)
    return Action((force_at(scene, load.point.body, point, force),))


FORCE = Kind(_force_action)


def _torque_action(load: Torque, scene: Scene) -> Action:
    algebra = scene.algebra
    given = scene.lower.vector(load.components)
    opposite = algebra.scale(algebra.number(-1), given)
    wrenches = []
    for body, torque in ((load.body, given), (load.reaction_on, opposite)):
        if body is not None and body != INERTIAL:
            local = scene.to_axes(torque, load.axes, body)
            wrenches.append(Wrench(body, algebra.zero_vector, local))
    return Action(tuple(wrenches))


TORQUE = Kind(_torque_action)
