"""What the bodies need at q'' = 0, leaner than the general Newton-Euler recursion; any scalar.

With  W = [alpha] + [omega][omega]  of each frame ([v] w = v x w), from the base outwards

    a_k = C (a_j + W_j r + 2 omega_j x r' + r''),      a of the base = -g  for uniform gravity g
    F_k = m a_k + W_k h,      N_k = h x a_k + J alpha + omega x (J omega + gyrostatic moment),

where the components of omega x J omega are written in the products omega_i omega_j that W holds anyway.  A base
accelerated by -g is exactly equivalent to weights m g at all mass centres: both give every body the force m a - m g.
The loads other than uniform gravity are subtracted from F and N body by body; a frame that falls in a Newtonian field
is accelerated by what is left of its acceleration and the gravity there (``mbsym.mechanics.falling``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.vectors import Tensor, Vector, axis_vector, symmetric_tensor, zero_tensor
from mbsym.mechanics.articulation import Articulation, Frame
from mbsym.mechanics.falling import falling_scene, overrides
from mbsym.mechanics.loads.kinds import actions_beyond_fields, base_acceleration
from mbsym.model.system import INERTIAL


@dataclass(frozen=True, slots=True)
class BiasForces(Generic[S]):
    """Force and moment about its origin that each frame's own mass needs at q'' = 0 beyond what the loads supply.

    ``generalized`` are the generalised forces Q that loads exert directly on coordinates.
    """

    forces: tuple[Vector[S], ...]
    moments: tuple[Vector[S], ...]
    generalized: Mapping[str, S]


@dataclass(frozen=True, slots=True)
class _Motion(Generic[S]):
    spin: Vector[S]
    angular: Vector[S]
    origin: Vector[S]
    w_tensor: Tensor[S]
    products: Tensor[S]


def bias_forces(system: Articulation[S]) -> BiasForces[S]:
    """The wrenches of inertia and loads at q'' = 0."""
    algebra = system.algebra
    zero, still = system.scene.zero(INERTIAL), zero_tensor(algebra, INERTIAL)
    motions: list[_Motion[S]] = []
    base = _Motion(zero, zero, base_acceleration(system.scene), still, still)
    felt = {system.frame_of[name]: w for name, w in overrides(system.scene, base.origin).items()}
    forces: list[Vector[S]] = []
    moments: list[Vector[S]] = []
    for number, frame in enumerate(system.frames):
        motion = _moved(algebra, frame, motions[frame.parent] if frame.parent >= 0 else base)
        if number in felt:
            motion = replace(motion, origin=felt[number])
        motions.append(motion)
        force, moment = _needed(system, number, motion)
        forces.append(force)
        moments.append(moment)
    for name, body in system.scene.motions.items():
        if body.gyrostatic_moment is not None:
            k, moment = _carrying(system, name, body.gyrostatic_moment)
            moments[k] = moments[k] + motions[k].spin.cross(moment)
    generalized = dict.fromkeys(system.coordinates, algebra.zero)
    falling = falling_scene(system.scene) if felt else system.scene
    for action in actions_beyond_fields(system.scene, falling):
        for name, value in action.generalized.items():
            generalized[name] = generalized[name] + value
        for wrench in action.wrenches:
            k = system.frame_of[wrench.body]
            forces[k] = forces[k] - wrench.force
            moments[k] = moments[k] - wrench.moment
    return BiasForces(tuple(forces), tuple(moments), generalized)


def _carrying(system: Articulation[S], body: str, moment: Vector[S]) -> tuple[int, Vector[S]]:
    """The frame that turns a body's gyrostatic moment, and that in its axes: where the turn of a frame is fixed, the
    frame below it."""
    k = system.frame_of[body]
    while system.frames[k].fixed_turn and system.frames[k].parent >= 0:
        moment = system.frames[k].back(moment)
        k = system.frames[k].parent
    return k, moment


def forcing(system: Articulation[S], needed: BiasForces[S]) -> tuple[S, ...]:
    """f of M q'' = f: the loads' part less the inertia's, carried from the tips to the base and projected."""
    algebra = system.algebra
    forces, moments = list(needed.forces), list(needed.moments)
    totals = dict(needed.generalized)
    for number in reversed(range(len(system.frames))):
        frame = system.frames[number]
        force, moment = forces[number], moments[number]
        for name, slope in frame.angle_derivatives.items():
            assert frame.turn is not None
            totals[name] = totals[name] - algebra.times(moment[frame.turn.axis - 1], slope)
        force, moment = frame.back(force), frame.back(moment)
        for name, v in frame.offset_derivatives.items():
            totals[name] = totals[name] - force.dot(v)
        if frame.parent >= 0:
            moment = moment + frame.offset.cross(force)
            forces[frame.parent] = forces[frame.parent] + force
            moments[frame.parent] = moments[frame.parent] + moment
    return tuple(algebra.reduce(totals[name]) for name in system.coordinates)


def _moved(algebra: Algebra[S], frame: Frame[S], parent: _Motion[S]) -> _Motion[S]:
    origin = parent.origin + parent.w_tensor @ frame.offset
    two = algebra.number(2)
    origin = origin + parent.spin.cross(frame.offset_rate) * two + frame.offset_acceleration
    turn, spin, angular = frame.turn, frame.out(parent.spin), frame.out(parent.angular)
    if turn is None:
        w_tensor, products = parent.w_tensor.in_parallel(frame.name), parent.products.in_parallel(frame.name)
        return _Motion(spin, angular, frame.out(origin), w_tensor, products)
    rate = axis_vector(algebra, turn.axis, turn.rate, turn.frame)
    angular = angular + spin.cross(rate)
    angular = angular + axis_vector(algebra, turn.axis, turn.second_rate, turn.frame)
    spin = spin + rate
    products = _products(algebra, spin)
    return _Motion(spin, angular, frame.out(origin), _w_tensor(algebra, angular, products), products)


def _products(algebra: Algebra[S], w: Vector[S]) -> Tensor[S]:
    """omega omega^T."""
    rows = [[algebra.zero] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i, 3):
            rows[i][j] = algebra.reduce(algebra.times(w[i], w[j]))
    return symmetric_tensor(algebra, rows, w.frame)


def _w_tensor(algebra: Algebra[S], angular: Vector[S], p: Tensor[S]) -> Tensor[S]:
    """[alpha] + [omega][omega]."""
    a, b, c = angular
    rows = (
        (-(p[1][1] + p[2][2]), p[0][1] - c, p[0][2] + b),
        (p[0][1] + c, -(p[0][0] + p[2][2]), p[1][2] - a),
        (p[0][2] - b, p[1][2] + a, -(p[0][0] + p[1][1])),
    )
    return Tensor(algebra, rows, angular.frame)


def _needed(system: Articulation[S], number: int, motion: _Motion[S]) -> tuple[Vector[S], Vector[S]]:
    """(F, N) of a frame's own mass."""
    own, a = system.masses[number], motion.origin
    force = a * own.mass + motion.w_tensor @ own.first_moment
    return force, own.first_moment.cross(a) + _rotational(system.algebra, own.tensor, motion)


def _rotational(algebra: Algebra[S], tensor: Tensor[S], motion: _Motion[S]) -> Vector[S]:
    """J alpha + omega x J omega; first component  J11 alpha1 + (J33 - J22) omega2 omega3
    + J12 (alpha2 - omega1 omega3) + J13 (alpha3 + omega1 omega2) + J23 (omega2^2 - omega3^2),  others cyclically."""
    p, w = motion.products, motion.w_tensor
    found = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        weights = (tensor[i][i], tensor[k][k] - tensor[j][j], tensor[i][j], tensor[i][k], tensor[j][k])
        factors = (motion.angular[i], p[j][k], -w[k][i], w[j][i], p[j][j] - p[k][k])
        found.append(algebra.dot(weights, factors))
    return Vector(algebra, (found[0], found[1], found[2]), tensor.frame)
