"""A damper on a coordinate: Q = -coefficient q'."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import CoordinateDamper
from mbsym.model.system import velocity_name


def _damper_action(load: CoordinateDamper, scene: Scene[S]) -> Action[S]:
    """Q = -coefficient q'."""
    rate = scene.environment[velocity_name(load.coordinate)]
    return Action(generalized={load.coordinate: -scene.algebra.times(scene.lower(load.coefficient), rate)})


KIND = Kind(_damper_action)
