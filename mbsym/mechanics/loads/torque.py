"""A torque on a body, and the opposite one on another."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Wrench
from mbsym.model.loads import Torque
from mbsym.model.system import INERTIAL


def _torque_action(load: Torque, scene: Scene[S]) -> Action[S]:
    given = scene.vector(load.components, load.axes)
    wrenches = []
    for body, torque in ((load.body, given), (load.reaction_on, -given)):
        if body is not None and body != INERTIAL:
            wrenches.append(Wrench(body, scene.zero(body), scene.to_axes(torque, body)))
    return Action(tuple(wrenches))


KIND = Kind(_torque_action)
