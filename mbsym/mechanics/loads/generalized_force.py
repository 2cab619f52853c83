"""Generalised forces given by formulas."""

from __future__ import annotations

from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import GeneralizedForce


def _generalized_action(load: GeneralizedForce, scene: Scene) -> Action:
    return Action(generalized={name: scene.lower(value) for name, value in load.components})


KIND = Kind(_generalized_action)
