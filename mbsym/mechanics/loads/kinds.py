"""The table of load kinds, and sums over a system's loads."""

from __future__ import annotations

from typing import Any

from mbsym.algebra.base import Scalar
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads import applied, free, gravity, springs
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model import system as model

KINDS: dict[type, Kind[Any]] = {
    model.NewtonianGravity: gravity.NEWTONIAN,
    model.UniformGravity: gravity.UNIFORM,
    model.CoordinateSpring: springs.SPRING,
    model.PointSpring: springs.POINT_SPRING,
    model.CoordinateDamper: springs.DAMPER,
    model.PointDamper: springs.POINT_DAMPER,
    model.IsotropicDamper: springs.ISOTROPIC_DAMPER,
    model.ForceFunction: free.FORCE_FUNCTION,
    model.Rayleigh: free.RAYLEIGH,
    model.GeneralizedForce: free.GENERALIZED,
    model.PointForce: applied.FORCE,
    model.Torque: applied.TORQUE,
}


def force_function(scene: Scene) -> Scalar:
    """U = sum of the force functions of all loads that have one."""
    total = scene.algebra.zero
    for load in scene.system.loads:
        own = KINDS[type(load)].force_function
        if own is not None:
            total = total + own(load, scene)
    return scene.algebra.reduce(total)


def actions(scene: Scene, potential: bool = True) -> list[Action]:
    """What the loads do to the bodies; with ``potential`` false, only those that have no force function."""
    chosen = [KINDS[type(load)] for load in scene.system.loads]
    return [
        kind.action(load, scene)
        for load, kind in zip(scene.system.loads, chosen, strict=True)
        if potential or kind.force_function is None
    ]
