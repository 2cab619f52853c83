"""Gravity: uniform, and the approximate Newtonian field of a distant centre."""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.base import Scalar, Vector
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.mechanics.loads.interface import Action, Kind, Wrench, force_at
from mbsym.mechanics.variables import expressions, ring_environment
from mbsym.model.system import INERTIAL, NewtonianGravity, UniformGravity

# --- uniform ---


def _uniform_force_function(load: UniformGravity, scene: Scene) -> Scalar:
    """U = sum m g.r_C, without turning r_C into inertial axes: g turns outwards, and g.r_O adds up joint by joint."""
    algebra = scene.algebra
    field = {INERTIAL: scene.lower.vector(load.acceleration)}
    height = {INERTIAL: algebra.zero}
    total = algebra.zero
    for name, motion in scene.motions.items():
        parent = motion.body.attached_to
        field[name] = scene.to_axes(field[parent], parent, name)
        height[name] = algebra.reduce(height[parent] + algebra.dot(field[parent], motion.offset))
        if not algebra.vanishes(motion.mass):
            rise = height[name] + algebra.dot(field[name], motion.mass_centre)
            total = total + algebra.times(motion.mass, rise)
    return algebra.reduce(total)


def _uniform_action(load: UniformGravity, scene: Scene) -> Action:
    """m g at each mass centre."""
    field = {INERTIAL: scene.lower.vector(load.acceleration)}
    wrenches = []
    for name, motion in scene.motions.items():
        field[name] = scene.to_axes(field[motion.body.attached_to], motion.body.attached_to, name)
        if not scene.algebra.vanishes(motion.mass):
            weight = scene.algebra.scale(motion.mass, field[name])
            wrenches.append(force_at(scene, name, motion.mass_centre, weight))
    return Action(tuple(wrenches))


UNIFORM = Kind(_uniform_action, _uniform_force_function)

# --- approximate Newtonian ---


class _Orbit:
    """Distance R of the expansion point O1 from the centre, unit vector e, and each body's mass centre c from O1."""

    def __init__(self, load: NewtonianGravity, scene: Scene) -> None:
        algebra, ring = scene.algebra, scene.ring
        closed = scene if scene.algebra is ring else _closed_scene(scene)
        # The distance is simplified in the ring, where sin^2 + cos^2 = 1, and then carried into the algebra at hand.
        outward = closed.to_axes(closed.position(load.about, ring.zero_vector, load.centre), load.centre, load.about)
        distance = ring.square_root(ring.dot(outward, outward))
        self.inverse = scene.carry(ring.reciprocal(distance))
        inverse = ring.reciprocal(distance)
        unit = [ring.dot((inverse,), (x,)) for x in outward]
        self.scene = scene
        self.about = load.about
        self.unit: Vector = (scene.carry(unit[0]), scene.carry(unit[1]), scene.carry(unit[2]))
        self.constant = scene.lower(load.constant)
        self.cube = algebra.times(self.constant, algebra.power(self.inverse, 3))
        self.square = algebra.times(self.constant, algebra.power(self.inverse, 2))
        self.first = algebra.times(self.constant, self.inverse)

    def bodies(self) -> list[tuple[BodyMotion, Vector, Vector]]:
        """(motion, e, c) of every body carried by the frame O1, in the body's axes."""
        scene, algebra = self.scene, self.scene.algebra
        unit: dict[str, Vector] = {self.about: self.unit}
        origin: dict[str, Vector] = {self.about: algebra.zero_vector}
        found = []
        for name, motion in scene.motions.items():
            parent = motion.body.attached_to
            if name != self.about:
                if parent not in unit:
                    continue
                unit[name] = scene.to_axes(unit[parent], parent, name)
                moved = algebra.add(origin[parent], motion.offset)
                origin[name] = scene.to_axes(moved, parent, name)
            massless = algebra.vanishes(motion.mass) and motion.inertia is None
            if not massless:
                found.append((motion, unit[name], algebra.add(origin[name], motion.mass_centre)))
        return found


def _closed_scene(scene: Scene) -> Scene:
    return Scene(scene.system, scene.ring, ring_environment(scene.system, scene.ring), scene.ring)


def central_inertia(scene: Scene, motion: BodyMotion) -> tuple[Vector, Vector, Vector] | None:
    """Theta_C = Theta_O - m (c.c 1 - c c^T) for a tensor given about the joint."""
    if motion.inertia is None or motion.body.inertia is None:
        return None
    if motion.body.inertia.about == "mass centre":
        return motion.inertia
    algebra = scene.algebra
    c = motion.mass_centre
    square = algebra.dot(c, c)
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            steiner = (square if i == j else algebra.zero) - algebra.times(c[i], c[j])
            row.append(algebra.reduce(motion.inertia[i][j] - algebra.times(motion.mass, steiner)))
        rows.append((row[0], row[1], row[2]))
    return (rows[0], rows[1], rows[2])


def _newtonian_force_function(load: NewtonianGravity, scene: Scene) -> Scalar:
    """U = nu m/R - nu m/R^2 e.c + nu/R^3 [ m/2 (3 (e.c)^2 - c.c) + tr Theta_C / 2 - 3/2 e.Theta_C e ], summed."""
    algebra = scene.algebra
    orbit = _Orbit(load, scene)
    half, three_halves = algebra.number(Fraction(1, 2)), algebra.number(Fraction(3, 2))
    total = algebra.zero
    for motion, e, c in orbit.bodies():
        along = algebra.dot(e, c)
        tide = algebra.times(three_halves, algebra.times(along, along)) - algebra.times(half, algebra.dot(c, c))
        second = algebra.times(motion.mass, tide)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            trace = tensor[0][0] + tensor[1][1] + tensor[2][2]
            second = second + algebra.times(half, trace)
            second = second - algebra.times(three_halves, algebra.dot(e, algebra.apply(tensor, e)))
        monopole = algebra.times(motion.mass, orbit.first - algebra.times(orbit.square, along))
        total = total + monopole + algebra.times(orbit.cube, algebra.reduce(second))
    return algebra.reduce(total)


def _newtonian_action(load: NewtonianGravity, scene: Scene) -> Action:
    """F = -nu m/R^2 e + nu m/R^3 (3 (e.c) e - c) at the mass centre, and the torque 3 nu/R^3 e x Theta_C e."""
    algebra = scene.algebra
    orbit = _Orbit(load, scene)
    three = algebra.number(3)
    wrenches = []
    for motion, e, c in orbit.bodies():
        along = algebra.times(three, algebra.times(orbit.cube, algebra.dot(e, c)))
        pull = algebra.scale(algebra.reduce(along - orbit.square), e)
        per_mass = algebra.subtract(pull, algebra.scale(orbit.cube, c))
        force = algebra.scale(motion.mass, per_mass)
        moment = algebra.cross(motion.mass_centre, force)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            twist = algebra.cross(e, algebra.apply(tensor, e))
            moment = algebra.add(moment, algebra.scale(algebra.times(three, orbit.cube), twist))
        wrenches.append(Wrench(motion.body.name, force, moment))
    if _expansion_point_moves(load, scene):
        wrenches.append(_on_the_expansion_point(orbit))
    return Action(tuple(wrenches))


def _expansion_point_moves(load: NewtonianGravity, scene: Scene) -> bool:
    """Whether the frame of expansion depends on coordinates; a prescribed one feels no generalised force."""
    coordinates = set(scene.system.coordinates)
    path = [scene.system.body(name) for name in scene.system.path(load.about) if name != INERTIAL]
    return any(coordinates & names(x) for body in path for x in expressions((body.rotation, body.connection_point)))


def _on_the_expansion_point(orbit: _Orbit) -> Wrench:
    """What is left of dU when O1 itself moves and the bodies stay: a force on O1, of the third order in c/R,

    nu/R^4 sum m/2 (6 (e.c) c - 15 (e.c)^2 e + 3 c.c e) - 3/2 tr Theta_C e - 3 Theta_C e + 15/2 (e.Theta_C e) e.

    It is as small as what the expansion drops, but without it the field would not be conservative.
    """
    scene, algebra = orbit.scene, orbit.scene.algebra
    total = algebra.zero_vector
    three_halves, three, fifteen_halves = (algebra.number(Fraction(n, 2)) for n in (3, 6, 15))
    for motion, e, c in orbit.bodies():
        along, square = algebra.dot(e, c), algebra.dot(c, c)
        per_e = algebra.times(three_halves, square) - algebra.times(fifteen_halves, algebra.times(along, along))
        force = algebra.add(algebra.scale(per_e, e), algebra.scale(algebra.times(three, along), c))
        force = algebra.scale(motion.mass, force)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            turned = algebra.apply(tensor, e)
            trace = tensor[0][0] + tensor[1][1] + tensor[2][2]
            per_e = algebra.times(fifteen_halves, algebra.dot(e, turned)) - algebra.times(three_halves, trace)
            spread = algebra.subtract(algebra.scale(per_e, e), algebra.scale(three, turned))
            force = algebra.add(force, spread)
        total = algebra.add(total, scene.to_axes(force, motion.body.name, orbit.about))
    fourth = algebra.times(orbit.cube, orbit.inverse)
    return Wrench(orbit.about, algebra.scale(fourth, total), algebra.zero_vector)


NEWTONIAN = Kind(_newtonian_action, _newtonian_force_function)
