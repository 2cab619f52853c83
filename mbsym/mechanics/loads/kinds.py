"""The table of load kinds, and sums over a system's loads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from typing import Any, Generic

from mbsym.algebra.base import S
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.expressions.tree import Expression, Name, differentiate, names, sticks, without_tables
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.interface import Action, Kind, Note, Wrench, force_at
from mbsym.mechanics.loads.newtonian_orders import order_action, order_force_function
from mbsym.mechanics.loads.orbit import Orbit, central_inertia, completed, radius_vectors
from mbsym.model import loads as model
from mbsym.model.loads import (
    EXACT,
    CoordinateDamper,
    CoordinateSpring,
    ForceFunction,
    GeneralizedForce,
    IsotropicDamper,
    Load,
    NewtonianGravity,
    PointDamper,
    PointForce,
    PointSpring,
    Rayleigh,
    Torque,
    UniformGravity,
)
from mbsym.model.speeds import UnitVector
from mbsym.model.system import INERTIAL, Point, velocity_name

# Gravity: uniform, and the Newtonian field of a centre to second order (above that ``newtonian_orders``).


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
    """U = sum m g.r_C."""
    return lifting(scene, INERTIAL, scene.vector(load.acceleration, INERTIAL))


def lifting(scene: Scene[S], about: str, w: Vector[S]) -> S:
    """sum m w.c over the bodies that a frame carries, c from its origin.

    Nothing is turned inwards: w turns outwards with the bodies, and its products add up joint by joint.
    """
    algebra = scene.algebra
    field: dict[str, Vector[S]] = {about: w}
    height: dict[str, S] = {about: algebra.zero}
    total = algebra.zero
    for name, motion in scene.motions.items():
        parent = motion.body.attached_to
        if name != about:
            if parent not in field:
                continue
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


class Pair(Generic[S]):
    """Two points seen from their nearest common ancestor, where what lies below it drops out."""

    def __init__(self, first: Point, second: Point, scene: Scene[S]) -> None:
        self.scene = scene
        self.ends = (first, second)
        self.frame = scene.common_ancestor(first.body, second.body)
        self.points = [scene.vector(end.position, end.body) for end in self.ends]
        reach = [scene.position(point, self.frame) for point in self.points]
        self.span = reach[1] - reach[0]

    def action(self, pull: Vector[S]) -> Action[S]:
        """``pull`` (in the frame's axes) on the first point and its opposite on the second."""
        wrenches = []
        for point, force in zip(self.points, (pull, -pull), strict=True):
            if point.frame != INERTIAL:
                wrenches.append(force_at(point, self.scene.to_axes(force, point.frame)))
        return Action(tuple(wrenches))


def point_velocity(scene: Scene[S], point: Vector[S]) -> Vector[S]:
    """V_O + omega x r of a point r of the body in whose axes it is; zero for a point of the inertial frame."""
    if point.frame == INERTIAL:
        return scene.zero(INERTIAL)
    motion = scene.motions[point.frame]
    return motion.velocity_origin + motion.angular_velocity.cross(point)


def closing(pair: Pair[S], scene: Scene[S]) -> Vector[S]:
    """V_second - V_first, in the axes of the pair's frame."""
    speeds = [scene.to_axes(point_velocity(scene, point), pair.frame) for point in pair.points]
    return speeds[1] - speeds[0]


def noted(load: PointSpring | PointDamper | IsotropicDamper, scene: Scene[S]) -> Iterator[Note]:
    """r_second - r_first, in the axes of the nearest common ancestor of their bodies."""
    yield Note(Quantity.SPAN, "", Pair(load.first, load.second, scene).span)


# A spring on a coordinate: U = -stiffness (q - rest)^2 / 2.


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


COORDINATE_SPRING = Kind(_spring_action, _spring_force_function)


# A spring between two points: U = -stiffness (distance - length)^2 / 2.


def _point_spring_force_function(load: PointSpring, scene: Scene[S]) -> S:
    """U = -stiffness (d^2 - 2 d length + length^2) / 2; without a natural length no root is taken."""
    algebra = scene.algebra
    span = Pair(load.first, load.second, scene).span
    square = span.dot(span)
    length = scene.lower(load.length)
    energy = square
    if not algebra.vanishes(length):
        twice = algebra.times(algebra.number(2), algebra.times(algebra.square_root(square), length))
        energy = square - twice + algebra.times(length, length)
    half = algebra.number(Fraction(-1, 2))
    return algebra.reduce(algebra.times(half, algebra.times(scene.lower(load.stiffness), energy)))


def _point_spring_action(load: PointSpring, scene: Scene[S]) -> Action[S]:
    """stiffness (1 - length/d) (r_second - r_first) on the first point."""
    algebra = scene.algebra
    pair = Pair(load.first, load.second, scene)
    length = scene.lower(load.length)
    factor = scene.lower(load.stiffness)
    if not algebra.vanishes(length):
        distance = algebra.square_root(pair.span.dot(pair.span))
        strain = algebra.one - algebra.times(length, algebra.reciprocal(distance))
        factor = algebra.times(factor, strain)
    return pair.action(pair.span * algebra.reduce(factor))


POINT_SPRING = Kind(_point_spring_action, _point_spring_force_function, notes=noted)


# A damper on a coordinate: Q = -coefficient q'.


def _damper_action(load: CoordinateDamper, scene: Scene[S]) -> Action[S]:
    """Q = -coefficient q'."""
    rate = scene.environment[velocity_name(load.coordinate)]
    return Action(generalized={load.coordinate: -scene.algebra.times(scene.lower(load.coefficient), rate)})


COORDINATE_DAMPER = Kind(_damper_action)


# A dashpot along the line between two points.


def _point_damper_action(load: PointDamper, scene: Scene[S]) -> Action[S]:
    """coefficient (u . (V_second - V_first)) u on the first point, with u along the line between the points.

    On a line that never turns u is its axis; elsewhere u u^T = r r^T / r.r with r = r_second - r_first, which is
    singular where the points meet: there the line has no direction.

    Raises SingularPoint where they meet.
    """
    algebra = scene.algebra
    pair = Pair(load.first, load.second, scene)
    towards = closing(pair, scene)
    coefficient = scene.lower(load.coefficient)
    along = [axis for axis in range(3) if not algebra.vanishes(pair.span[axis])]
    if len(along) == 1:
        pull = algebra.times(coefficient, towards[along[0]])
        return pair.action(axis_vector(algebra, along[0] + 1, pull, pair.frame))
    try:
        inverse_square = algebra.reciprocal(pair.span.dot(pair.span))
    except SingularPoint:
        raise SingularPoint("the points of a damper coincide: the line between them has no direction") from None
    rate = algebra.reduce(algebra.times(pair.span.dot(towards), inverse_square))
    return pair.action(pair.span * algebra.reduce(algebra.times(coefficient, rate)))


POINT_DAMPER = Kind(_point_damper_action, notes=noted)


# A damper against all relative motion of two points.


def _isotropic_damper_action(load: IsotropicDamper, scene: Scene[S]) -> Action[S]:
    """coefficient (V_second - V_first) on the first point."""
    pair = Pair(load.first, load.second, scene)
    coefficient = scene.lower(load.coefficient)
    return pair.action(closing(pair, scene) * coefficient)


ISOTROPIC_DAMPER = Kind(_isotropic_damper_action, notes=noted)


# A dissipation function R(q, q') given by a formula.


def _rayleigh_action(load: Rayleigh, scene: Scene[S]) -> Action[S]:
    """Q = -dR/dq', or -dR/du.  A kink in a velocity is dry friction, which holds there: its table becomes moduli."""
    present = names(load.expression)
    potential = without_tables(load.expression, sticks)
    rates = {name: velocity_name(name) for name in scene.system.coordinates}
    rates |= {speed.name: speed.name for speed in scene.system.speeds if scene.in_speeds}
    forces = {name: -scene.lower(differentiate(potential, rate)) for name, rate in rates.items() if rate in present}
    return Action(generalized=forces)


RAYLEIGH = Kind(_rayleigh_action)


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
    held, torques = names(formula), []
    for body in scene.system.bodies:
        vectors = [
            unit_vector
            for unit_vector in body.orientation
            if isinstance(unit_vector, UnitVector) and held & {*unit_vector.components}
        ]
        if not vectors:
            continue
        torque = scene.zero(body.name)
        for vector in vectors:
            slope = scene.vector([differentiate(formula, name) for name in vector.components], body.name)
            torque = torque + slope.cross(scene.vector([Name(name) for name in vector.components], body.name))
        torque = torque * sign
        torques.append(Wrench(body.name, scene.zero(body.name), torque))
        if body.attached_to != INERTIAL:
            torques.append(Wrench(body.attached_to, scene.zero(body.attached_to), scene.back(body.name, -torque)))
    return torques


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
    vector = scene.vector(load.components, load.axes)
    wrenches = []
    for body, torque in ((load.body, vector), (load.reaction_on, -vector)):
        if body is not None and body != INERTIAL:
            wrenches.append(Wrench(body, scene.zero(body), scene.to_axes(torque, body)))
    return Action(tuple(wrenches))


TORQUE = Kind(_torque_action)


KINDS: dict[type, Kind[Any]] = {
    model.NewtonianGravity: NEWTONIAN_GRAVITY,
    model.UniformGravity: UNIFORM_GRAVITY,
    model.CoordinateSpring: COORDINATE_SPRING,
    model.PointSpring: POINT_SPRING,
    model.CoordinateDamper: COORDINATE_DAMPER,
    model.PointDamper: POINT_DAMPER,
    model.IsotropicDamper: ISOTROPIC_DAMPER,
    model.ForceFunction: FORCE_FUNCTION,
    model.Rayleigh: RAYLEIGH,
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


# Generalised forces of wrenches through partial velocities, in the ring.
#
# Q_i = sum over bodies of  F . dV_O/dq'_i + M . domega/dq'_i


def generalized_forces(scene: Scene, loads: Sequence[Load] | None = None) -> dict[str, Polynomial]:
    """Q_i, for every coordinate, of some loads; else of those that have no force function.

    The scene's algebra is the ring.
    """
    ring = scene.algebra
    assert isinstance(ring, Ring)
    totals = dict.fromkeys(scene.system.coordinates, ring.zero)
    acting = actions(scene, potential=False) if loads is None else [KINDS[type(x)].action(x, scene) for x in loads]
    for action in acting:
        for name, force in action.generalized.items():
            totals[name] = totals[name] + force
        for wrench in action.wrenches:
            motion = scene.motions[wrench.body]
            for name in totals:
                along = partial(ring.velocity_derivative, name=name)
                velocity, spin = motion.velocity_origin.map(along), motion.angular_velocity.map(along)
                power = wrench.force.dot(velocity) + wrench.moment.dot(spin)
                totals[name] = totals[name] + power
    return {name: ring.reduce(value) for name, value in totals.items()}
