"""Gravity: uniform, and the Newtonian field of a centre to second order (above that ``newtonian_orders``)."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from mbsym.algebra.base import S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Note, Wrench, force_at
from mbsym.mechanics.loads.newtonian_orders import order_action, order_force_function
from mbsym.mechanics.loads.orbit import Orbit, central_inertia, completed, radius_vectors
from mbsym.model.loads import EXACT, NewtonianGravity, UniformGravity
from mbsym.model.system import INERTIAL


def _newtonian_force_function(load: NewtonianGravity, scene: Scene[S]) -> S:
    """U = nu m/R - nu m/R^2 e.c + nu/R^3 [ m/2 (3 (e.c)^2 - c.c) + tr Theta_C / 2 - 3/2 e.Theta_C e ], summed."""
    algebra = scene.algebra
    orbit = Orbit(load, scene)
    half, three_halves = algebra.number(Fraction(1, 2)), algebra.number(Fraction(3, 2))
    total = algebra.zero
    for motion, e, c in orbit.bodies():
        along = e.dot(c)
        tide = algebra.times(three_halves, algebra.times(along, along)) - algebra.times(half, c.dot(c))
        second = algebra.times(motion.mass, tide)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            trace = tensor[0][0] + tensor[1][1] + tensor[2][2]
            second = second + algebra.times(half, trace)
            second = second - algebra.times(three_halves, e.dot(tensor @ e))
        monopole = algebra.times(motion.mass, orbit.potential - algebra.times(orbit.weight, along))
        total = total + monopole + algebra.times(orbit.cube, algebra.reduce(second))
    return algebra.reduce(total)


def _newtonian_action(load: NewtonianGravity, scene: Scene[S]) -> Action[S]:
    """F = -nu m/R^2 e + nu m/R^3 (3 (e.c) e - c) at the mass centre, and the torque 3 nu/R^3 e x Theta_C e."""
    algebra = scene.algebra
    orbit = Orbit(load, scene)
    three = algebra.number(3)
    wrenches = []
    for motion, e, c in orbit.bodies():
        along = algebra.times(three, algebra.times(orbit.cube, e.dot(c)))
        per_mass = e * algebra.reduce(along - orbit.weight) - c * orbit.cube
        force = per_mass * motion.mass
        moment = motion.mass_centre.cross(force)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            twist = e.cross(tensor @ e)
            moment = moment + twist * algebra.times(three, orbit.cube)
        wrenches.append(Wrench(motion.body.name, force, moment))
    return completed(load, scene, wrenches, lambda: _on_the_expansion_point(orbit))


def _on_the_expansion_point(orbit: Orbit[S]) -> Wrench[S]:
    """What is left of dU when O1 itself moves and the bodies stay: a force on O1, of the third order in c/R,

    nu/R^4 sum m/2 (6 (e.c) c - 15 (e.c)^2 e + 3 c.c e) - 3/2 tr Theta_C e - 3 Theta_C e + 15/2 (e.Theta_C e) e.

    It is as small as what the expansion drops, but without it the field would not be conservative.
    """
    scene, algebra = orbit.scene, orbit.scene.algebra
    total = scene.zero(orbit.about)
    three_halves, three, fifteen_halves = (algebra.number(Fraction(n, 2)) for n in (3, 6, 15))
    for motion, e, c in orbit.bodies():
        along, square = e.dot(c), c.dot(c)
        per_e = algebra.times(three_halves, square) - algebra.times(fifteen_halves, algebra.times(along, along))
        force = (e * per_e + c * algebra.times(three, along)) * motion.mass
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            turned = tensor @ e
            trace = tensor[0][0] + tensor[1][1] + tensor[2][2]
            per_e = algebra.times(fifteen_halves, e.dot(turned)) - algebra.times(three_halves, trace)
            force = force + (e * per_e - turned * three)
        total = total + scene.to_axes(force, orbit.about)
    fourth = algebra.times(orbit.cube, orbit.inverse)
    return Wrench(orbit.about, total * fourth, scene.zero(orbit.about))


def _force_function_of_order(load: NewtonianGravity, scene: Scene[S]) -> S:
    return _newtonian_force_function(load, scene) if load.order == 2 else order_force_function(load, scene)


def _action_of_order(load: NewtonianGravity, scene: Scene[S]) -> Action[S]:
    return _newtonian_action(load, scene) if load.order == 2 else order_action(load, scene)


def _notes(load: NewtonianGravity, scene: Scene[S]) -> Iterator[Note]:
    """Where the bodies are: r in the exact field; e, c and e.c where it is expanded."""
    if load.order == EXACT:
        for motion, r in radius_vectors(load, scene):
            yield Note(Quantity.RADIUS, motion.body.name, r)
        return
    for motion, e, c in Orbit(load, scene).bodies():
        yield Note(Quantity.OUTWARD, motion.body.name, e)
        yield Note(Quantity.PLACE, motion.body.name, c)
        yield Note(Quantity.ALONG, motion.body.name, e.dot(c))


def _upward(load: NewtonianGravity, scene: Scene[S], frame: str) -> Vector[S] | None:
    """Away from a centre at rest; None where it is another frame that is expanded about."""
    if load.about != frame or load.centre != INERTIAL or frame == INERTIAL:
        return None
    return scene.to_axes(scene.position(scene.zero(frame), INERTIAL), frame)


NEWTONIAN_GRAVITY = Kind(_action_of_order, _force_function_of_order, notes=_notes, upward=_upward, falls=True)


# Uniform gravity: U = sum m g.r_C.


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


def _uniform_upward(load: UniformGravity, scene: Scene[S], frame: str) -> Vector[S]:
    return scene.to_axes(-_field(load, scene), frame)


UNIFORM_GRAVITY = Kind(_uniform_action, _uniform_force_function, field=_field, upward=_uniform_upward)
