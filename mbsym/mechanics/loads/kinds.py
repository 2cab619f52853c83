"""The table of load kinds, and sums over a system's loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.expressions.tree import Expression, Name, differentiate, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads import gravity, springs
from mbsym.mechanics.loads.interface import Action, Kind, Wrench, force_at
from mbsym.model import loads as model
from mbsym.model.loads import ForceFunction, GeneralizedForce, PointForce, Torque
from mbsym.model.speeds import UnitVector
from mbsym.model.system import INERTIAL

# What is given by formulas: force functions, generalised forces, forces on points, torques.
#
# A force function U(q, e, t), or a potential: e are unit vectors of bodies.
#
# In angles e is a function of them, and Q = dU/dq.  Where e are variables of their own (``mechanics.speeds``), each is
# at rest in the frame j that its body k hangs on, so that e' = e x omega with omega relative to it, and from
#
#     dU/dt = sum dU/de . (e x omega) = L . omega,      L = sum dU/de x e
#
# the body is under the torque L, and the frame that it hangs on under the opposite one.


def _force_function(load: ForceFunction, scene: Scene[S]) -> S:
    value = scene.lower(load.expression)
    return -value if load.spelled == "potential" else value


def _force_function_action(load: ForceFunction, scene: Scene[S]) -> Action[S]:
    """Q = dU/dq and L = sum dU/de x e, differentiated as written."""
    formula = load.expression
    held = names(formula)
    sign = scene.algebra.number(-1 if load.spelled == "potential" else 1)
    forces = {
        name: scene.algebra.times(sign, scene.lower(differentiate(formula, name)))
        for name in scene.system.coordinates
        if name in held
    }
    return Action(tuple(_torques(formula, sign, scene)), forces)


def _torques(formula: Expression, sign: S, scene: Scene[S]) -> list[Wrench[S]]:
    held, found = names(formula), []
    for body in scene.system.bodies:
        vectors = [one for one in body.orientation if isinstance(one, UnitVector) and held & {*one.components}]
        if not vectors:
            continue
        torque = scene.zero(body.name)
        for one in vectors:
            slope = scene.vector([differentiate(formula, name) for name in one.components], body.name)
            torque = torque + slope.cross(scene.vector([Name(name) for name in one.components], body.name))
        torque = torque * sign
        found.append(Wrench(body.name, scene.zero(body.name), torque))
        if body.attached_to != INERTIAL:
            found.append(Wrench(body.attached_to, scene.zero(body.attached_to), scene.back(body.name, -torque)))
    return found


FORCE_FUNCTION = Kind(_force_function_action, _force_function)


# Generalised forces given by formulas.


def _generalized_action(load: GeneralizedForce, scene: Scene[S]) -> Action[S]:
    return Action(generalized={name: scene.lower(value) for name, value in load.components})


GENERALIZED_FORCE = Kind(_generalized_action)


# A force on a point of a body; with components in the body's own axes it follows the body.


def _force_action(load: PointForce, scene: Scene[S]) -> Action[S]:
    force = scene.to_axes(scene.vector(load.components, load.axes), load.point.body)
    point = scene.vector(load.point.position, load.point.body)
    return Action((force_at(point, force),))


POINT_FORCE = Kind(_force_action)


# A torque on a body, and the opposite one on another.


def _torque_action(load: Torque, scene: Scene[S]) -> Action[S]:
    given = scene.vector(load.components, load.axes)
    wrenches = []
    for body, torque in ((load.body, given), (load.reaction_on, -given)):
        if body is not None and body != INERTIAL:
            wrenches.append(Wrench(body, scene.zero(body), scene.to_axes(torque, body)))
    return Action(tuple(wrenches))


TORQUE = Kind(_torque_action)


KINDS: dict[type, Kind[Any]] = {
    model.NewtonianGravity: gravity.NEWTONIAN_GRAVITY,
    model.UniformGravity: gravity.UNIFORM_GRAVITY,
    model.CoordinateSpring: springs.COORDINATE_SPRING,
    model.PointSpring: springs.POINT_SPRING,
    model.CoordinateDamper: springs.COORDINATE_DAMPER,
    model.PointDamper: springs.POINT_DAMPER,
    model.IsotropicDamper: springs.ISOTROPIC_DAMPER,
    model.ForceFunction: FORCE_FUNCTION,
    model.Rayleigh: springs.RAYLEIGH,
    model.GeneralizedForce: GENERALIZED_FORCE,
    model.PointForce: POINT_FORCE,
    model.Torque: TORQUE,
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
