"""What is given by formulas: force functions, generalised forces, forces on points, torques.

A force function U(q, e, t), or a potential: e are unit vectors of bodies.

In angles e is a function of them, and Q = dU/dq.  Where e are variables of their own (``mechanics.speeds``), each is at
rest in the frame j that its body k hangs on, so that e' = e x omega with omega relative to it, and from

    dU/dt = sum dU/de . (e x omega) = L . omega,      L = sum dU/de x e

the body is under the torque L, and the frame that it hangs on under the opposite one.
"""

from __future__ import annotations

from mbsym.algebra.base import S
from mbsym.expressions.tree import Expression, Name, differentiate, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Wrench, force_at
from mbsym.model.loads import ForceFunction, GeneralizedForce, PointForce, Torque
from mbsym.model.speeds import UnitVector
from mbsym.model.system import INERTIAL


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
