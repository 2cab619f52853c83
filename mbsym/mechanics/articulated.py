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

from dataclasses import dataclass

from mbsym.algebra.base import Algebra, Scalar, Vector
from mbsym.algebra.failures import SingularPoint
from mbsym.mechanics.articulation import Articulation, MassProperties, Matrix, symmetric, turned_symmetric
from mbsym.mechanics.bias_forces import BiasForces
from mbsym.mechanics.frames import Turn, axis_vector, turn_back


@dataclass(frozen=True, slots=True)
class _Inertia:
    """Rows of A (symmetric), B and C (symmetric)."""

    force: Matrix
    mixed: Matrix
    moment: Matrix


@dataclass(frozen=True, slots=True)
class _Joint:
    """One eliminated coordinate: q'' = (share - U_f.a - U_n.alpha) inverse slope."""

    name: str
    spin: Vector
    velocity: Vector
    force: Vector
    moment: Vector
    share: Scalar
    inverse: Scalar
    slope: Scalar


def applies(system: Articulation) -> bool:
    """Whether every coordinate belongs to one body's joint."""
    drivers: dict[str, set[str]] = {}
    for frame in system.frames:
        for name in (*frame.angle_derivatives, *frame.offset_derivatives):
            drivers.setdefault(name, set()).add(frame.body)
    return all(len(bodies) == 1 for bodies in drivers.values())


def solve(system: Articulation, needed: BiasForces) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
    """(accelerations, pivots) in the order of the coordinates.

    The product of the pivots is the determinant of M.  Raises SingularPoint for a pivot that is zero everywhere.
    """
    return _Articulated(system, needed).solved()


class _Articulated:
    def __init__(self, system: Articulation, needed: BiasForces) -> None:
        self.system = system
        self.algebra = system.algebra
        self.generalized = needed.generalized
        self.inertias = [self._rigid(x) for x in system.masses]
        self.forces, self.moments = list(needed.forces), list(needed.moments)
        self.turns: list[list[_Joint]] = [[] for _ in system.frames]
        self.displacements: list[list[_Joint]] = [[] for _ in system.frames]
        self.pivots: dict[str, Scalar] = {}
        self.whole = self._whole_joints()

    def solved(self) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
        """(accelerations, pivots), both in the order of the coordinates.

        Raises SingularPoint where a coordinate moves no body.
        """
        for number in reversed(range(len(self.system.frames))):
            self._inwards(number)
        lacking = [name for name in self.system.coordinates if name not in self.pivots]
        if lacking:
            raise SingularPoint(f"the mass matrix is singular everywhere: {', '.join(lacking)} moves no body")
        accelerations = self._outwards()
        names = self.system.coordinates
        return tuple(accelerations[name] for name in names), tuple(self.pivots[name] for name in names)

    # --- joints ---

    def _whole_joints(self) -> dict[int, list[tuple[str, Vector, Vector]]]:
        """(coordinate, w, v) in the axes of the body's own frame, for bodies whose elementary joints share one."""
        algebra, zero = self.algebra, self.algebra.zero_vector
        partial: dict[str, dict[str, tuple[Vector, Vector]]] = {}
        for frame in self.system.frames:
            if not frame.together:
                continue
            own = partial.setdefault(frame.body, {})
            for name in (*frame.offset_derivatives, *frame.angle_derivatives):
                own.setdefault(name, (zero, zero))
            for name, (spin, velocity) in own.items():
                velocity = algebra.add(velocity, frame.offset_derivatives.get(name, zero))
                spin, velocity = frame.out(algebra, spin), frame.out(algebra, velocity)
                if frame.turn is not None and name in frame.angle_derivatives:
                    spin = algebra.add(spin, axis_vector(algebra, frame.turn.axis, frame.angle_derivatives[name]))
                own[name] = spin, velocity
        return {
            self.system.frame_of[body]: [(name, *twist) for name, twist in own.items()] for body, own in partial.items()
        }

    def _eliminate(
        self, number: int, inertia: _Inertia, name: str, spin: Vector, velocity: Vector
    ) -> tuple[_Inertia, _Joint]:
        """A joint along (spin, velocity) taken out of the inertia and the wrench of a frame."""
        algebra, force, moment = self.algebra, self.forces[number], self.moments[number]
        u_force = algebra.add(algebra.apply(inertia.force, velocity), algebra.apply(inertia.mixed, spin))
        u_moment = algebra.add(algebra.apply(_transpose(inertia.mixed), velocity), algebra.apply(inertia.moment, spin))
        pivot = algebra.reduce(algebra.dot(velocity, u_force) + algebra.dot(spin, u_moment))
        share = self.generalized[name] - algebra.dot(velocity, force) - algebra.dot(spin, moment)
        return self._taken_out(
            number, inertia, _Joint(name, spin, velocity, u_force, u_moment, share, pivot, algebra.one)
        )

    def _taken_out(self, number: int, inertia: _Inertia, joint: _Joint) -> tuple[_Inertia, _Joint]:
        """The inertia that is left, and the joint with its pivot inverted; the frame's wrench is updated."""
        algebra, pivot = self.algebra, joint.inverse
        if algebra.vanishes(pivot):
            raise SingularPoint(f"the mass matrix is singular everywhere: {joint.name} moves no mass")
        self.pivots[joint.name] = algebra.times(pivot, algebra.times(joint.slope, joint.slope))
        inverse = algebra.reciprocal(pivot)
        ratio_force = _scaled(joint.force, inverse)
        ratio_moment = _scaled(joint.moment, inverse)
        self.forces[number] = algebra.add(self.forces[number], algebra.scale(joint.share, ratio_force))
        self.moments[number] = algebra.add(self.moments[number], algebra.scale(joint.share, ratio_moment))
        left = _Inertia(
            _less_symmetric(inertia.force, joint.force, ratio_force),
            _less(inertia.mixed, ratio_force, joint.moment),
            _less_symmetric(inertia.moment, joint.moment, ratio_moment),
        )
        share, slope = joint.share, joint.slope
        done = _Joint(joint.name, joint.spin, joint.velocity, joint.force, joint.moment, share, inverse, slope)
        return left, done

    def _turn_eliminated(self, number: int, inertia: _Inertia, turn: Turn, name: str, slope: Scalar) -> _Inertia:
        """A turn about an axis of the frame; its row and column vanish from C, its column from B."""
        algebra, a = self.algebra, turn.axis - 1
        zero = algebra.zero
        axis = axis_vector(algebra, turn.axis, algebra.one)
        u_force = (inertia.mixed[0][a], inertia.mixed[1][a], inertia.mixed[2][a])
        u_moment = inertia.moment[a]
        torque = self.generalized[name]
        if not algebra.vanishes(torque):
            torque = algebra.times(torque, algebra.reciprocal(slope))
        share = torque - self.moments[number][a]
        joint = _Joint(name, axis, algebra.zero_vector, u_force, u_moment, share, u_moment[a], slope)
        left, done = self._taken_out(number, inertia, joint)
        self.turns[number].append(done)
        moment, mixed = [list(row) for row in left.moment], [list(row) for row in left.mixed]
        for i in range(3):
            moment[a][i] = moment[i][a] = mixed[i][a] = zero
        # The joint transmits no moment of its own beyond what acts on its coordinate.
        rest = list(self.moments[number])
        rest[a] = torque
        self.moments[number] = (rest[0], rest[1], rest[2])
        return _Inertia(left.force, _matrix(mixed), symmetric(moment))

    # --- inwards ---

    def _rigid(self, x: MassProperties) -> _Inertia:
        """A = m 1, B = -[h], C = J."""
        zero, m = self.algebra.zero, x.mass
        a, b, c = x.first_moment
        mixed = ((zero, c, -b), (-c, zero, a), (b, -a, zero))
        return _Inertia(((m, zero, zero), (zero, m, zero), (zero, zero, m)), mixed, x.tensor)

    def _inwards(self, number: int) -> None:
        algebra, frame, inertia = self.algebra, self.system.frames[number], self.inertias[number]
        if number in self.whole:
            for name, spin, velocity in self.whole[number]:
                inertia, joint = self._eliminate(number, inertia, name, spin, velocity)
                self.turns[number].append(joint)
        if not frame.together and frame.turn is not None:
            for name, slope in frame.angle_derivatives.items():
                inertia = self._turn_eliminated(number, inertia, frame.turn, name, slope)
        self.forces[number] = frame.back(algebra, self.forces[number])
        self.moments[number] = frame.back(algebra, self.moments[number])
        inertia = _turned(algebra, inertia, frame.turn)
        if not frame.together:
            for name, v in frame.offset_derivatives.items():
                inertia, joint = self._eliminate(number, inertia, name, algebra.zero_vector, v)
                self.displacements[number].append(joint)
        if frame.parent >= 0:
            parent, force = frame.parent, self.forces[number]
            moment = algebra.add(self.moments[number], algebra.cross(frame.offset, force))
            self.forces[parent] = algebra.add(self.forces[parent], force)
            self.moments[parent] = algebra.add(self.moments[parent], moment)
            self.inertias[parent] = _sum(algebra, self.inertias[parent], _shifted(algebra, inertia, frame.offset))

    # --- outwards ---

    def _outwards(self) -> dict[str, Scalar]:
        algebra, zero = self.algebra, self.algebra.zero_vector
        found: dict[str, Scalar] = {}
        motions: list[tuple[Vector, Vector]] = []
        for number, frame in enumerate(self.system.frames):
            angular, linear = motions[frame.parent] if frame.parent >= 0 else (zero, zero)
            linear = algebra.add(linear, algebra.cross(angular, frame.offset))
            motion = self._accelerated(self.displacements[number], angular, linear, found)
            angular, linear = frame.out(algebra, motion[0]), frame.out(algebra, motion[1])
            motions.append(self._accelerated(self.turns[number], angular, linear, found))
        return found

    def _accelerated(
        self, joints: list[_Joint], angular: Vector, linear: Vector, found: dict[str, Scalar]
    ) -> tuple[Vector, Vector]:
        algebra = self.algebra
        for joint in reversed(joints):
            pull = algebra.dot(joint.force, linear) + algebra.dot(joint.moment, angular)
            rate = algebra.reduce((joint.share - pull) * joint.inverse)
            found[joint.name] = rate
            if joint.slope != algebra.one:
                found[joint.name] = algebra.times(rate, algebra.reciprocal(joint.slope))
            angular = algebra.add(angular, algebra.scale(rate, joint.spin))
            linear = algebra.add(linear, algebra.scale(rate, joint.velocity))
        return angular, linear


# --- blocks of six by six matrices ---


def _matrix(rows: list[list[Scalar]]) -> Matrix:
    a, b, c = rows
    return ((a[0], a[1], a[2]), (b[0], b[1], b[2]), (c[0], c[1], c[2]))


def _transpose(m: Matrix) -> Matrix:
    return ((m[0][0], m[1][0], m[2][0]), (m[0][1], m[1][1], m[2][1]), (m[0][2], m[1][2], m[2][2]))


def _scaled(v: Vector, factor: Scalar) -> Vector:
    """factor v by products: ``Algebra.scale`` would turn each product with a reciprocal into a division."""
    return (v[0] * factor, v[1] * factor, v[2] * factor)


def _less_symmetric(m: Matrix, u: Vector, v: Vector) -> Matrix:
    """M - u v^T, where u and v are parallel."""
    rows = [list(row) for row in m]
    for i in range(3):
        for j in range(i, 3):
            rows[i][j] = rows[i][j] - u[i] * v[j]
    return symmetric(rows)


def _less(m: Matrix, u: Vector, v: Vector) -> Matrix:
    """M - u v^T."""
    return _matrix([[m[i][j] - u[i] * v[j] for j in range(3)] for i in range(3)])


def _sum(algebra: Algebra, x: _Inertia, y: _Inertia) -> _Inertia:
    def plus(a: Matrix, b: Matrix) -> Matrix:
        return (algebra.add(a[0], b[0]), algebra.add(a[1], b[1]), algebra.add(a[2], b[2]))

    return _Inertia(plus(x.force, y.force), plus(x.mixed, y.mixed), plus(x.moment, y.moment))


def _turned(algebra: Algebra, x: _Inertia, turn: Turn | None) -> _Inertia:
    if turn is None:
        return x
    return _Inertia(
        turned_symmetric(algebra, turn, x.force),
        _turned_general(algebra, turn, x.mixed),
        turned_symmetric(algebra, turn, x.moment),
    )


def _turned_general(algebra: Algebra, turn: Turn, matrix: Matrix) -> Matrix:
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
    swung = turn_back(algebra, turn, (column[0], column[1], column[2]))
    swept = turn_back(algebra, turn, (row[0], row[1], row[2]))
    for k in (i, j):
        rows[k][a], rows[a][k] = swung[k], swept[k]
    return _matrix(rows)


def _shifted(algebra: Algebra, x: _Inertia, r: Vector) -> _Inertia:
    """The inertia about a point from which the old one is seen at r:

    B' = B - A [r],      C' = C + [r] B' + ([r] B)^T.
    """
    if all(algebra.vanishes(component) for component in r):
        return x
    old = x.mixed
    # Row i of A [r] is (row i of A) x r.
    new = tuple(algebra.subtract(old[i], algebra.cross(x.force[i], r)) for i in range(3))
    rows = [list(row) for row in x.moment]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # ([r] X)_ii = r_j X_ki - r_k X_ji
        twice = (old[k][i] + new[k][i], -(old[j][i] + new[j][i]))
        rows[i][i] = rows[i][i] + algebra.dot((r[j], r[k]), twice)
        mixed = algebra.dot((r[k], r[j], r[i]), (old[i][i] - new[j][j], new[k][j], -old[k][i]))
        rows[i][j] = rows[j][i] = rows[i][j] + mixed
    return _Inertia(x.force, (new[0], new[1], new[2]), symmetric(rows))
