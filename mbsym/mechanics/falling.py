"""Frames that fall freely, or nearly so: a frame's acceleration and the gravity at its origin as one vector.

A frame O1 whose motion is prescribed (an orbit) carries bodies in a Newtonian field.  Every mass m it carries feels the
inertia force -m a_O1 and the leading term of gravity, m g with g = -nu/R^2 e; both are of the order m nu/R^2 and
cancel on a circular orbit, while what remains, the tide, is smaller by (size of the bodies)/R.  Evaluated term by term
in floating point the remainder keeps that many digits less: with 2 m of structure on an orbit of 7000 km six and a
half are gone.  So the two are joined where they can be joined exactly,

    w = a_O1 - g    (in the axes of O1, simplified in the ring, where sin^2 + cos^2 = 1),

and take the place of the frame's acceleration; gravity keeps only what varies from mass to mass.  With numbers for the
parameters w is a constant, computed exactly, and zero where nu = omega0^2 R^3.

For the energy the same: with T_rel the kinetic energy of the motion relative to axes that move with O1 and do not turn,
and S the first moment of the masses about O1,

    T = T_rel + V_O1.S' + m V_O1^2/2,      V_O1.S' = d/dt(V_O1.S) - a_O1.S,

so L = T_rel - w.S + U_rest up to a total derivative and a function of time alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.expressions.tree import names
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function, lifting
from mbsym.mechanics.loads.orbit import outward
from mbsym.mechanics.newton_euler import origin_acceleration
from mbsym.mechanics.variables import expressions, ring_environment
from mbsym.model.loads import NewtonianGravity
from mbsym.model.system import INERTIAL, System, acceleration_name, velocity_name


def falling_frames(system: System) -> dict[str, tuple[NewtonianGravity, ...]]:
    """The frames O1 whose motion, and that of the centres, no coordinate changes, with the fields about them."""
    fields: dict[str, tuple[NewtonianGravity, ...]] = {}
    for load in system.newtonian_fields:
        if load.about != load.centre:
            fields[load.about] = (*fields.get(load.about, ()), load)
    return {
        about: loads
        for about, loads in fields.items()
        if about != INERTIAL
        and not any(other in system.path(about)[:-1] for other in fields)
        and _prescribed(system, about)
        and all(about not in system.path(load.centre) and _prescribed(system, load.centre) for load in loads)
    }


def _prescribed(system: System, frame: str) -> bool:
    moving = {*system.coordinates, *system.velocities}
    path = [system.body(name) for name in system.path(frame) if name != INERTIAL]
    return not any(moving & names(x) for body in path for x in expressions((body.rotation, body.connection_point)))


def felt_acceleration(scene: Scene[S], about: str, loads: tuple[NewtonianGravity, ...]) -> Vector[S]:
    """w = a_O1 - g of one falling frame, in its axes; uniform gravity is not counted."""
    system, ring = scene.system, scene.ring
    path = tuple(system.body(name) for name in system.path(about) if name != INERTIAL)
    environment = ring_environment(system, ring)
    for name in system.coordinates:
        environment[velocity_name(name)] = environment[acceleration_name(name)] = ring.zero
    carriers = {name for load in loads for name in system.path(load.centre) if name != INERTIAL}
    others = tuple(body for body in system.bodies if body.name in carriers and body not in path)
    small = Scene(replace(system, bodies=(*path, *others), loads=()), ring, environment, ring)
    felt = origin_acceleration(small, about)
    for load in loads:
        p = outward(load, small)
        distance = ring.square_root(p.dot(p))
        pull = ring.reduce(small.lower(load.constant) * ring.reciprocal(distance) ** 3)
        felt = felt + p * pull
    return scene.carried(felt.reduced())


def felt_accelerations(scene: Scene[S]) -> dict[str, Vector[S]]:
    """w of every falling frame."""
    return {about: felt_acceleration(scene, about, loads) for about, loads in falling_frames(scene.system).items()}


def falling_scene(scene: Scene[S]) -> Scene[S]:
    """The same system seen from its falling frames: their origins are at rest and their weight is gone."""
    frames = frozenset(falling_frames(scene.system))
    return Scene(
        scene.system,
        scene.algebra,
        scene.environment,
        scene.ring,
        scene.frozen,
        falling=frames,
        given=scene.given,
        in_speeds=scene.in_speeds,
    )


def relative_lagrangian(scene: Scene[S]) -> tuple[S, S]:
    """(T_rel, U_rest - w.S): a Lagrangian of the same equations of motion, split into its two parts.

    T_rel + U is T + U where nothing falls.
    """
    felt = felt_accelerations(scene)
    if not felt:
        return kinetic_energy(scene), force_function(scene)
    relative, algebra = falling_scene(scene), scene.algebra
    force = force_function(relative)
    for about, w in felt.items():
        force = force - lifting(relative, about, w)
    return kinetic_energy(relative), algebra.reduce(force)


def overrides(scene: Scene[S], base: Vector[S]) -> Mapping[str, Vector[S]]:
    """Accelerations of falling frames' origins, less the gravity there; ``base`` is that of the inertial frame."""
    felt = felt_accelerations(scene)
    return {name: w + scene.to_axes(base, name) for name, w in felt.items()}
