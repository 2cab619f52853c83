"""The table of load kinds, and sums over a system's loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads import forces, gravity, springs
from mbsym.mechanics.loads.interface import Action, Kind
from mbsym.model import loads as model
from mbsym.model.system import INERTIAL

KINDS: dict[type, Kind[Any]] = {
    model.NewtonianGravity: gravity.NEWTONIAN_GRAVITY,
    model.UniformGravity: gravity.UNIFORM_GRAVITY,
    model.CoordinateSpring: springs.COORDINATE_SPRING,
    model.PointSpring: springs.POINT_SPRING,
    model.CoordinateDamper: springs.COORDINATE_DAMPER,
    model.PointDamper: springs.POINT_DAMPER,
    model.IsotropicDamper: springs.ISOTROPIC_DAMPER,
    model.ForceFunction: forces.FORCE_FUNCTION,
    model.Rayleigh: springs.RAYLEIGH,
    model.GeneralizedForce: forces.GENERALIZED_FORCE,
    model.PointForce: forces.POINT_FORCE,
    model.Torque: forces.TORQUE,
}


def force_function(scene: Scene[S]) -> S:
    """U = sum of the force functions of all loads that have one."""
    total = scene.algebra.zero
    for load in scene.loads:
        own = KINDS[type(load)].force_function
        if own is not None:
            total = total + own(load, scene)
    return scene.algebra.reduce(total)


def actions(scene: Scene[S], potential: bool = True) -> list[Action[S]]:
    """What the loads do to the bodies; with ``potential`` false, only those that have no force function."""
    loads = [load for load in scene.loads if potential or not load.conservative]
    return [KINDS[type(load)].action(load, scene) for load in loads]


def base_acceleration(scene: Scene[S]) -> Vector[S]:
    """-sum of g: the acceleration of a base that stands for all uniform fields, in inertial axes."""
    base = scene.zero(INERTIAL)
    for load in scene.loads:
        field = KINDS[type(load)].field
        if field is not None:
            base = base - field(load, scene)
    return base


def actions_beyond_fields(scene: Scene[S], falling: Scene[S]) -> Iterator[Action[S]]:
    """What the loads do to the bodies, less what ``base_acceleration`` stands for.

    ``falling`` is the scene seen from its falling frames, or the same scene where none falls.
    """
    for load in scene.loads:
        kind = KINDS[type(load)]
        if kind.field is None:
            yield kind.action(load, falling if kind.falls else scene)
