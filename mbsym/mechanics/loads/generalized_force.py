"""Generalised forces given by formulas."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import GeneralizedForce


def _generalized_action(load: GeneralizedForce, scene: Scene[S]) -> Action[S]:
    return Action(generalized={name: scene.lower(value) for name, value in load.components})


KIND = Kind(_generalized_action)
