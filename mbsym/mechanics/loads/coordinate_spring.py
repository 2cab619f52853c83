"""A spring on a coordinate: U = -stiffness (q - rest)^2 / 2."""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.base import S
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model.loads import CoordinateSpring


def _stretch(load: CoordinateSpring, scene: Scene[S]) -> S:
    return scene.environment[load.coordinate] - scene.lower(load.rest)


def _spring_force_function(load: CoordinateSpring, scene: Scene[S]) -> S:
    """U = -stiffness (q - rest)^2 / 2."""
    stretch = _stretch(load, scene)
    square = scene.algebra.times(stretch, stretch)
    half = scene.algebra.number(Fraction(-1, 2))
    return scene.algebra.times(half, scene.algebra.times(scene.lower(load.stiffness), square))


def _spring_action(load: CoordinateSpring, scene: Scene[S]) -> Action[S]:
    """Q = -stiffness (q - rest)."""
    pull = scene.algebra.times(scene.lower(load.stiffness), _stretch(load, scene))
    return Action(generalized={load.coordinate: -pull})


KIND = Kind(_spring_action, _spring_force_function)
