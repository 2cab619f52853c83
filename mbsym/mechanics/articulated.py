"""Forward dynamics in O(n) by articulated bodies, over any scalar.

A tree in which every coordinate belongs to one body's joint is solved joint by joint from the tips to the base
(Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7).  Deviations from the motion at q'' = 0 obey

    f = A a + B alpha + p_f,      n = B^T a + C alpha + p_n,

with the articulated inertia (A, B, C) of all that lies beyond O_k, and p the wrench that it needs at q'' = 0.  A joint
along s = (w, v) takes up  x'' = (Q - s.p - U.(a, alpha)) / D,  U = I s,  D = s.U, and leaves

    I - U U^T / D,      p + U (Q - s.p) / D

to be moved to its parent.  Since the wrenches at q'' = 0 carry all that is quadratic in the velocities, no velocity
enters the elimination.

Turns and displacements are eliminated one by one, each coordinate by itself: taken together that is the L^T D L
factorisation of a joint's small matrix.  Where one coordinate drives several of a body's elementary joints (a screw),
the body's joint is eliminated as a whole in its own axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from operator import mul
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.vectors import Tensor, Vector, axis_vector, symmetric_tensor, tensor_of, zero_tensor
from mbsym.mechanics.articulation import Articulation, Frame, MassProperties, turned_symmetric
from mbsym.mechanics.falling import falling_scene, overrides
from mbsym.mechanics.frames import Turn
from mbsym.mechanics.loads.kinds import actions_beyond_fields, base_acceleration
from mbsym.model.system import INERTIAL

# What the bodies need at q'' = 0, leaner than the general Newton-Euler recursion; any scalar.
#
# With  W = [alpha] + [omega][omega]  of each frame ([v] w = v x w), from the base outwards
#
#     a_k = C (a_j + W_j r + 2 omega_j x r' + r''),      a of the base = -g  for uniform gravity g
#     F_k = m a_k + W_k h,      N_k = h x a_k + J alpha + omega x (J omega + gyrostatic moment),
#
# where the components of omega x J omega are written in the products omega_i omega_j that W holds anyway.  A base
# accelerated by -g is exactly equivalent to weights m g at all mass centres: both give every body the force m a - m g.
# The loads other than uniform gravity are subtracted from F and N body by body; a frame that falls in a Newtonian field
# is accelerated by what is left of its acceleration and the gravity there (``mbsym.mechanics.falling``).


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
    components = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        weights = (tensor[i][i], tensor[k][k] - tensor[j][j], tensor[i][j], tensor[i][k], tensor[j][k])
        factors = (motion.angular[i], p[j][k], -w[k][i], w[j][i], p[j][j] - p[k][k])
        components.append(algebra.dot(weights, factors))
    return Vector(algebra, (components[0], components[1], components[2]), tensor.frame)


@dataclass(frozen=True, slots=True)
class _Inertia(Generic[S]):
    """Rows of A (symmetric), B and C (symmetric)."""

    force: Tensor[S]
    mixed: Tensor[S]
    moment: Tensor[S]


@dataclass(frozen=True, slots=True)
class _Joint(Generic[S]):
    """One eliminated coordinate: q'' = (share - U_f.a - U_n.alpha) inverse slope."""

    name: str
    spin: Vector[S]
    velocity: Vector[S]
    force: Vector[S]
    moment: Vector[S]
    share: S
    inverse: S
    slope: S


def applies(system: Articulation[S]) -> bool:
    """Whether every coordinate belongs to one body's joint."""
    drivers: dict[str, set[str]] = {}
    for frame in system.frames:
        for name in (*frame.angle_derivatives, *frame.offset_derivatives):
            drivers.setdefault(name, set()).add(frame.body)
    return all(len(bodies) == 1 for bodies in drivers.values())


def solve(system: Articulation[S], needed: BiasForces[S]) -> tuple[tuple[S, ...], tuple[S, ...]]:
    """(accelerations, pivots) in the order of the coordinates.

    The product of the pivots is the determinant of M.  Raises SingularPoint for a pivot that is zero everywhere.
    """
    return _Articulated(system, needed).solved()


class _Articulated(Generic[S]):
    def __init__(self, system: Articulation[S], needed: BiasForces[S]) -> None:
        self.system = system
        self.algebra = system.algebra
        self.generalized = needed.generalized
        self.inertias = [_rigid(self.algebra, x) for x in system.masses]
        self.forces, self.moments = list(needed.forces), list(needed.moments)
        self.turns: list[list[_Joint[S]]] = [[] for _ in system.frames]
        self.displacements: list[list[_Joint[S]]] = [[] for _ in system.frames]
        self.pivots: dict[str, S] = {}
        self.whole = self._whole_joints()

    def solved(self) -> tuple[tuple[S, ...], tuple[S, ...]]:
        """(accelerations, pivots), both in the order of the coordinates.

        Raises SingularPoint where a coordinate moves no body.
        """
        for number in reversed(range(len(self.system.frames))):
            self._inwards(number)
        lacking = [name for name in self.system.coordinates if name not in self.pivots]
        if lacking:
            raise SingularPoint(
                "the mass matrix is singular everywhere: [[names]] moves no body", names=", ".join(lacking)
            )
        accelerations = self._outwards()
        names = self.system.coordinates
        return tuple(accelerations[name] for name in names), tuple(self.pivots[name] for name in names)

    # --- joints ---

    def _whole_joints(self) -> dict[int, list[tuple[str, Vector[S], Vector[S]]]]:
        """(coordinate, w, v) in the axes of the body's own frame, for bodies whose elementary joints share one."""
        algebra, scene = self.algebra, self.system.scene
        partial: dict[str, dict[str, tuple[Vector[S], Vector[S]]]] = {}
        for frame in self.system.frames:
            if not frame.together:
                continue
            own = partial.setdefault(frame.body, {})
            zero = scene.zero(frame.offset.frame)
            for name in (*frame.offset_derivatives, *frame.angle_derivatives):
                own.setdefault(name, (zero, zero))
            for name, (spin, velocity) in own.items():
                velocity = velocity + frame.offset_derivatives.get(name, zero)
                spin, velocity = frame.out(spin), frame.out(velocity)
                if frame.turn is not None and name in frame.angle_derivatives:
                    spin = spin + axis_vector(algebra, frame.turn.axis, frame.angle_derivatives[name], frame.name)
                own[name] = spin, velocity
        return {
            self.system.frame_of[body]: [(name, *twist) for name, twist in own.items()] for body, own in partial.items()
        }

    def _eliminate(
        self, number: int, inertia: _Inertia[S], name: str, spin: Vector[S], velocity: Vector[S]
    ) -> tuple[_Inertia[S], _Joint[S]]:
        """A joint along (spin, velocity) taken out of the inertia and the wrench of a frame."""
        algebra, force, moment = self.algebra, self.forces[number], self.moments[number]
        u_force = inertia.force @ velocity + inertia.mixed @ spin
        u_moment = inertia.mixed.T @ velocity + inertia.moment @ spin
        pivot = algebra.reduce(velocity.dot(u_force) + spin.dot(u_moment))
        share = self.generalized[name] - velocity.dot(force) - spin.dot(moment)
        return self._taken_out(
            number, inertia, _Joint(name, spin, velocity, u_force, u_moment, share, pivot, algebra.one)
        )

    def _taken_out(self, number: int, inertia: _Inertia[S], joint: _Joint[S]) -> tuple[_Inertia[S], _Joint[S]]:
        """The inertia that is left, and the joint with its pivot inverted; the frame's wrench is updated."""
        algebra, pivot = self.algebra, joint.inverse
        if algebra.vanishes(pivot):
            raise SingularPoint("the mass matrix is singular everywhere: [[joint]] moves no mass", joint=joint.name)
        self.pivots[joint.name] = algebra.times(pivot, algebra.times(joint.slope, joint.slope))
        inverse = algebra.reciprocal(pivot)
        ratio_force = _scaled(joint.force, inverse)
        ratio_moment = _scaled(joint.moment, inverse)
        self.forces[number] = self.forces[number] + ratio_force * joint.share
        self.moments[number] = self.moments[number] + ratio_moment * joint.share
        left = _Inertia(
            _less_symmetric(inertia.force, joint.force, ratio_force),
            _less(inertia.mixed, ratio_force, joint.moment),
            _less_symmetric(inertia.moment, joint.moment, ratio_moment),
        )
        share, slope = joint.share, joint.slope
        done = _Joint(joint.name, joint.spin, joint.velocity, joint.force, joint.moment, share, inverse, slope)
        return left, done

    def _turn_eliminated(self, number: int, inertia: _Inertia[S], turn: Turn[S], name: str, slope: S) -> _Inertia[S]:
        """A turn about an axis of the frame; its row and column vanish from C, its column from B."""
        algebra, a, own = self.algebra, turn.axis - 1, turn.frame
        zero = algebra.zero
        axis = axis_vector(algebra, turn.axis, algebra.one, own)
        u_force, u_moment = inertia.mixed.column(a), inertia.moment.row(a)
        torque = self.generalized[name]
        if not algebra.vanishes(torque):
            torque = algebra.times(torque, algebra.reciprocal(slope))
        share = torque - self.moments[number][a]
        joint = _Joint(name, axis, self.system.scene.zero(own), u_force, u_moment, share, u_moment[a], slope)
        left, done = self._taken_out(number, inertia, joint)
        self.turns[number].append(done)
        moment, mixed = [list(row) for row in left.moment], [list(row) for row in left.mixed]
        for i in range(3):
            moment[a][i] = moment[i][a] = mixed[i][a] = zero
        # The joint transmits no moment of its own beyond what acts on its coordinate.
        rest = list(self.moments[number])
        rest[a] = torque
        self.moments[number] = Vector(algebra, (rest[0], rest[1], rest[2]), own)
        return _Inertia(left.force, tensor_of(algebra, mixed, own), symmetric_tensor(algebra, moment, own))

    # --- inwards ---

    def _inwards(self, number: int) -> None:
        frame, inertia = self.system.frames[number], self.inertias[number]
        if number in self.whole:
            for name, spin, velocity in self.whole[number]:
                inertia, joint = self._eliminate(number, inertia, name, spin, velocity)
                self.turns[number].append(joint)
        if not frame.together and frame.turn is not None:
            for name, slope in frame.angle_derivatives.items():
                inertia = self._turn_eliminated(number, inertia, frame.turn, name, slope)
        self.forces[number] = frame.back(self.forces[number])
        self.moments[number] = frame.back(self.moments[number])
        inertia = _turned(self.algebra, inertia, frame)
        if not frame.together:
            for name, v in frame.offset_derivatives.items():
                inertia, joint = self._eliminate(number, inertia, name, self.system.scene.zero(v.frame), v)
                self.displacements[number].append(joint)
        if frame.parent >= 0:
            parent, force = frame.parent, self.forces[number]
            moment = self.moments[number] + frame.offset.cross(force)
            self.forces[parent] = self.forces[parent] + force
            self.moments[parent] = self.moments[parent] + moment
            self.inertias[parent] = _sum(self.inertias[parent], _shifted(self.algebra, inertia, frame.offset))

    # --- outwards ---

    def _outwards(self) -> dict[str, S]:
        zero = self.system.scene.zero(INERTIAL)
        outwards: dict[str, S] = {}
        motions: list[tuple[Vector[S], Vector[S]]] = []
        for number, frame in enumerate(self.system.frames):
            angular, linear = motions[frame.parent] if frame.parent >= 0 else (zero, zero)
            linear = linear + angular.cross(frame.offset)
            motion = self._accelerated(self.displacements[number], angular, linear, outwards)
            angular, linear = frame.out(motion[0]), frame.out(motion[1])
            motions.append(self._accelerated(self.turns[number], angular, linear, outwards))
        return outwards

    def _accelerated(
        self, joints: list[_Joint[S]], angular: Vector[S], linear: Vector[S], accelerations: dict[str, S]
    ) -> tuple[Vector[S], Vector[S]]:
        algebra = self.algebra
        for joint in reversed(joints):
            pull = joint.force.dot(linear) + joint.moment.dot(angular)
            rate = algebra.reduce(mul(joint.share - pull, joint.inverse))
            accelerations[joint.name] = rate
            if joint.slope != algebra.one:
                accelerations[joint.name] = algebra.times(rate, algebra.reciprocal(joint.slope))
            angular = angular + joint.spin * rate
            linear = linear + joint.velocity * rate
        return angular, linear


# --- blocks of six by six matrices ---


def _rigid(algebra: Algebra[S], x: MassProperties[S]) -> _Inertia[S]:
    """A = m 1, B = -[h], C = J."""
    zero, m, frame = algebra.zero, x.mass, x.first_moment.frame
    a, b, c = x.first_moment
    mixed = Tensor(algebra, ((zero, c, -b), (-c, zero, a), (b, -a, zero)), frame)
    return _Inertia(Tensor(algebra, ((m, zero, zero), (zero, m, zero), (zero, zero, m)), frame), mixed, x.tensor)


def _scaled(v: Vector[S], factor: S) -> Vector[S]:
    """factor v by products: ``v * factor`` would turn each product with a reciprocal into a division."""
    a, b, c = v
    return Vector(v.algebra, (mul(a, factor), mul(b, factor), mul(c, factor)), v.frame)


def _less_symmetric(m: Tensor[S], u: Vector[S], v: Vector[S]) -> Tensor[S]:
    """M - u v^T, where u and v are parallel."""
    rows = [list(row) for row in m]
    for i in range(3):
        for j in range(i, 3):
            rows[i][j] = rows[i][j] - mul(u[i], v[j])
    return symmetric_tensor(m.algebra, rows, m.frame)


def _less(m: Tensor[S], u: Vector[S], v: Vector[S]) -> Tensor[S]:
    """M - u v^T."""
    return tensor_of(m.algebra, [[m[i][j] - mul(u[i], v[j]) for j in range(3)] for i in range(3)], m.frame)


def _sum(x: _Inertia[S], y: _Inertia[S]) -> _Inertia[S]:
    return _Inertia(x.force + y.force, x.mixed + y.mixed, x.moment + y.moment)


def _turned(algebra: Algebra[S], x: _Inertia[S], frame: Frame[S]) -> _Inertia[S]:
    """The inertia of what lies beyond a frame, in the axes before its turn."""
    turn = frame.turn
    if turn is None:
        before = frame.offset.frame
        return _Inertia(x.force.in_parallel(before), x.mixed.in_parallel(before), x.moment.in_parallel(before))
    return _Inertia(
        turned_symmetric(algebra, turn, x.force),
        _turned_general(algebra, turn, x.mixed),
        turned_symmetric(algebra, turn, x.moment),
    )


def _turned_general(algebra: Algebra[S], turn: Turn[S], matrix: Tensor[S]) -> Tensor[S]:
    """C^T B C for a general B in at most 23 operations.

    In the plane of the turn, with entries p, q; r, s and  u = sin (p - s) + cos (q + r):
    p - u sin, cos u - r;  cos u - q, s + u sin.
    """
    a = turn.axis - 1
    i, j = (a + 1) % 3, (a + 2) % 3
    times = algebra.times
    p, q, r, s = matrix[i][i], matrix[i][j], matrix[j][i], matrix[j][j]
    u = algebra.dot((turn.sine, turn.cosine), (p - s, q + r))
    across, mixed = times(turn.sine, u), times(turn.cosine, u)
    rows = [list(row) for row in matrix]
    rows[i][i], rows[i][j], rows[j][i], rows[j][j] = p - across, mixed - r, mixed - q, s + across
    column, row = [algebra.zero] * 3, [algebra.zero] * 3
    for k in (i, j):
        column[k], row[k] = matrix[k][a], matrix[a][k]
    swung = turn.back(Vector(algebra, (column[0], column[1], column[2]), turn.frame))
    swept = turn.back(Vector(algebra, (row[0], row[1], row[2]), turn.frame))
    for k in (i, j):
        rows[k][a], rows[a][k] = swung[k], swept[k]
    return tensor_of(algebra, rows, turn.source)


def _shifted(algebra: Algebra[S], x: _Inertia[S], r: Vector[S]) -> _Inertia[S]:
    """The inertia about a point from which the old one is seen at r:

    B' = B - A [r],      C' = C + [r] B' + ([r] B)^T.
    """
    if r.vanishes():
        return x
    old = x.mixed
    # Row i of A [r] is (row i of A) x r.
    new = tensor_of(algebra, [tuple(old.row(i) - x.force.row(i).cross(r)) for i in range(3)], r.frame)
    rows = [list(row) for row in x.moment]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # ([r] X)_ii = r_j X_ki - r_k X_ji
        twice = (old[k][i] + new[k][i], -(old[j][i] + new[j][i]))
        rows[i][i] = rows[i][i] + algebra.dot((r[j], r[k]), twice)
        mixed = algebra.dot((r[k], r[j], r[i]), (old[i][i] - new[j][j], new[k][j], -old[k][i]))
        rows[i][j] = rows[j][i] = rows[i][j] + mixed
    return _Inertia(x.force, new, symmetric_tensor(algebra, rows, r.frame))
