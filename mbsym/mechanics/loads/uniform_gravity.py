"""Uniform gravity: U = sum m g.r_C."""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, force_at
from mbsym.model.loads import UniformGravity
from mbsym.model.system import INERTIAL


def _uniform_force_function(load: UniformGravity, scene: Scene[S]) -> S:
    """U = sum m g.r_C, without turning r_C into inertial axes: g turns outwards, and g.r_O adds up joint by joint."""
    algebra = scene.algebra
    field = {INERTIAL: scene.vector(load.acceleration, INERTIAL)}
    height = {INERTIAL: algebra.zero}
    total = algebra.zero
    for name, motion in scene.motions.items():
        parent = motion.body.attached_to
        field[name] = scene.to_axes(field[parent], name)
        height[name] = algebra.reduce(height[parent] + field[parent].dot(motion.offset))
        if not algebra.vanishes(motion.mass):
            rise = height[name] + field[name].dot(motion.mass_centre)
            total = total + algebra.times(motion.mass, rise)
    return algebra.reduce(total)


def _uniform_action(load: UniformGravity, scene: Scene[S]) -> Action[S]:
    """m g at each mass centre."""
    field = {INERTIAL: scene.vector(load.acceleration, INERTIAL)}
    wrenches = []
    for name, motion in scene.motions.items():
        field[name] = scene.to_axes(field[motion.body.attached_to], name)
        if not scene.algebra.vanishes(motion.mass):
            wrenches.append(force_at(motion.mass_centre, field[name] * motion.mass))
    return Action(tuple(wrenches))


def _field(load: UniformGravity, scene: Scene[S]) -> Vector[S]:
    """g, in inertial axes."""
    return scene.vector(load.acceleration, INERTIAL)


def _upward(load: UniformGravity, scene: Scene[S], frame: str) -> Vector[S]:
    return scene.to_axes(-_field(load, scene), frame)


KIND = Kind(_uniform_action, _uniform_force_function, field=_field, upward=_upward)
