"""Speeds u instead of generalised velocities, unit vectors or a quaternion instead of angles: a system's variables.

    u = S(q, t) q' + s0(q, t),      q' = Y (u - s0),      Y = S^-1 = adj(S)/det(S)

over the exact ring.  Where fewer speeds are declared than there are velocities, those that are left are speeds
themselves.  A body whose place is told by unit vectors e of the frame j that it hangs on (in its own axes, the columns
of its direction cosines) has its angular velocity among the speeds, and Poisson's equations

    e' = e x (omega_k - R omega_j)

take the place of  q' = Y (u - s0)  for its angles; of one that is told by a quaternion
e' = 1/2 e o (omega_k - R omega_j)  does.  The state is (s, u): s the coordinates and components that there
are.  Its derivatives are generators of the ring: u' and s' bear the names ``p_dot``, ``gamma1_dot``.

Where no speeds are declared u is q' and s is q: Y = 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from operator import itemgetter

from mbsym.algebra.base import Algebra, Lowering, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, SingularPoint
from mbsym.algebra.matrices import determinant, solved
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.vectors import Tensor, Vector, tensor_of
from mbsym.expressions.tree import divide, number, reached
from mbsym.mechanics import frames as quaternions
from mbsym.mechanics.frames import direction_cosines
from mbsym.mechanics.kinematics import Given, Scene
from mbsym.mechanics.motion import places, vanishing
from mbsym.mechanics.variables import program_environment, rate_of, ring_environment
from mbsym.model.speeds import OMEGA, Quaternion, Speed, UnitVector
from mbsym.model.system import Body, System, acceleration_name, velocity_name

#: So much work is done to find velocities that speeds may replace where the motion begins.
SEARCH_WORK = 5_000_000


@dataclass(frozen=True, slots=True)
class Variable:
    """A speed or a position: its name, that of its derivative, and their generators."""

    name: str
    rate_name: str
    index: int
    rate_index: int


class SpeedForm:
    """What the state of a system is made of, over its ring.

    ``speeds`` u in the order of the bodies, ``positions`` s; ``velocities`` are q' of the coordinates among them,
    ``rates`` s', as polynomials in (s, u, t).
    """

    def __init__(self, system: System, ring: Ring) -> None:
        self.system, self.ring = system, ring
        self._plain = ring_environment(system, ring)
        #: The bodies whose place is told by unit vectors or a quaternion.
        self.oriented = tuple(body for body in system.bodies if body.orientation)
        self.by_quaternion = tuple(body for body in self.oriented if isinstance(body.orientation[0], Quaternion))
        self.by_vectors = tuple(body for body in self.oriented if body not in self.by_quaternion)
        #: The angles that these replace.
        self.replaced = frozenset(name for body in self.oriented for name in body.own_angles)
        self.coordinates = tuple(name for name in system.coordinates if name not in self.replaced)
        self._solve()

    # --- q' = Y (u - s0) ---------------------------------------------------------------------------------------------

    def _solve(self) -> None:
        ring, system = self.ring, self.system
        known = {speed.name for body in self.oriented for speed in system.speeds if _is_own(speed, body)}
        named = [speed for speed in system.speeds if speed.name not in known]
        forms = self._forms(named, self._given(ring, self._plain, only_vectors=True))
        rows = [[ring.velocity_derivative(x, name) for name in self.coordinates] for x in forms]
        drifts = [ring.at_rest(x) for x in forms]
        chosen = self._chosen(rows)
        #: Where it vanishes the speeds do not determine the velocities that they replace.
        self.determinant = determinant(ring, [[row[k] for k in chosen] for row in rows])
        left = [k for k in range(len(self.coordinates)) if k not in chosen]
        velocity = [ring.generator("velocity", name) for name in self.coordinates]
        targets = []
        for speed, row, drift in zip(named, rows, drifts, strict=True):
            rest = ring.generator("coordinate", speed.name) - drift
            targets.append(ring.reduce(rest - sum((ring.times(row[k], velocity[k]) for k in left), ring.zero)))
        velocities = [x for (x,) in solved(ring, [[row[k] for k in chosen] for row in rows], [[x] for x in targets])]
        self.velocities: dict[str, Polynomial] = {self.coordinates[k]: velocity[k] for k in left}
        self.velocities |= {self.coordinates[k]: x for k, x in zip(chosen, velocities, strict=True)}
        retained = {self.coordinates[k] for k in left}
        self.speeds = tuple(self._speeds(retained))
        self.positions = tuple(self._variable(name) for name in self._position_names())

    # --- u = S q' + s0 ------------------------------------------------------------------------------------------------

    @cached_property
    def slopes(self) -> dict[str, list[Polynomial]]:
        """du_r/dq'_i for every speed, by coordinate, relative angular velocities of bodies told by vectors kept."""
        return {
            name: [x.derivative(self.ring.index("velocity", name)) for x in self._in_velocities]
            for name in self.coordinates
        }

    @cached_property
    def drifts(self) -> list[Polynomial]:
        """s0: the speeds of a system whose coordinates and relative orientations stand still."""
        return [self.ring.at_rest(x) for x in self._in_velocities]

    @cached_property
    def _in_velocities(self) -> list[Polynomial]:
        """Every speed in q', for bodies that are told by vectors and do not turn on what they hang on."""
        ring, rotations = self.ring, self._given(self.ring, self._plain, only_vectors=True)
        for body in self.oriented:
            scene = Scene(self.system, ring, self._plain, ring, given=rotations)
            motion = scene.motions[body.name]
            carried = motion.angular_velocity - motion.relative_angular_velocity
            rotations[body.name] = Given(
                carried, rotations[body.name].angular_acceleration, rotations[body.name].cosines
            )
        return self._told(rotations)

    @cached_property
    def in_coordinates(self) -> list[Polynomial]:
        """Every speed in (q, q', t), the angles that unit vectors replace among q."""
        return self._told({})

    def _told(self, rotations: Mapping[str, Given]) -> list[Polynomial]:
        """Every speed, where the bodies of ``rotations`` turn as that says."""
        declared = self.system.speeds
        forms = dict(zip((x.name for x in declared), self._forms(declared, rotations), strict=True))
        return [forms.get(u.name, self.ring.context.gen(u.index)) for u in self.speeds]

    @cached_property
    def plainly(self) -> dict[str, Polynomial]:
        """Every speed and every position but the components of quaternions, by name, in (q, q', t)."""
        polynomials = {x.name: self.in_angles(self.ring.context.gen(x.index)) for x in self.positions}
        return polynomials | dict(zip((u.name for u in self.speeds), self.in_coordinates, strict=True))

    def variables_in_coordinates(self, program: Program) -> dict[str, Node]:
        """Every declared speed and every component of a unit vector or quaternion, by name, in (q, q', t).

        As nodes of a program whose inputs bear the declared names.
        """
        known = self._nodes(program)
        return {name: known[name] for name in self.system.variables}

    def state_in_coordinates(self, program: Program) -> list[Node]:
        """(s, u) in (q, q', t), in the same way."""
        known = self._nodes(program)
        return [known[x.name] for x in (*self.positions, *self.speeds)]

    def _nodes(self, program: Program) -> dict[str, Node]:
        inputs = program_environment(self.system, program)
        carry = Carrier(self.ring, program, inputs)
        halves = {
            name: node
            for body in self.by_quaternion
            for name, node in self.quaternion_of_angles(body, program, inputs).items()
        }
        return {name: halves[name] if name in halves else carry(x) for name, x in self.plainly.items()}

    def quaternion_of_angles(self, body: Body, algebra: Algebra, values: Mapping[str, Scalar]) -> dict[str, Scalar]:
        """The components of a body's quaternion by name: one of the two, smooth in its angles."""
        lower = Lowering(algebra, values)
        (quaternion,) = body.orientation
        turns = [(axis, *lower.angle(divide(angle, number(2)))) for axis, angle in body.rotation.turns()]
        return dict(zip(quaternion.components, quaternions.of_turns(algebra, turns), strict=True))

    def _forms(self, speeds: Sequence[Speed], rotations: Mapping[str, Given]) -> list[Polynomial]:
        scene = Scene(self.system, self.ring, self._plain, self.ring, bodies=bool(speeds), given=rotations)
        spins = [dict(zip(OMEGA, scene.motions[speed.body].angular_velocity, strict=True)) for speed in speeds]
        return [Lowering(self.ring, {**self._plain, **spin})(x.form) for x, spin in zip(speeds, spins, strict=True)]

    def _chosen(self, rows: Sequence[Sequence[Polynomial]]) -> tuple[int, ...]:
        """The coordinates whose velocities the declared speeds replace: those of the bodies that declare them first.

        Of several such sets one that is regular on the unperturbed motion, and in the initial position, where one is
        found.
        """
        own = {name for body in self.system.bodies if body.speeds for name in body.coordinates}
        order = sorted(range(len(self.coordinates)), key=lambda k: self.coordinates[k] not in own)
        touched = [k for k in order if any(not self.ring.vanishes(row[k]) for row in rows)]
        known = places(Scene(self.system, self.ring, self._plain, self.ring, bodies=False), initial=True)

        def regular() -> Iterator[tuple[list[bool], tuple[int, ...]]]:
            for chosen in combinations(touched, len(rows)):
                size = determinant(self.ring, [[row[k] for k in chosen] for row in rows])
                if not self.ring.vanishes(size):
                    yield vanishing(self.ring, size, known), chosen

        sets = regular()
        best = next(sets, None)
        if best is None:
            raise SingularPoint("the speeds do not determine the generalised velocities")
        with suppress(Failure), self.ring.budget(SEARCH_WORK):
            while any(best[0]) and (other := next(sets, None)) is not None:
                best = min(best, other, key=itemgetter(0))
        return best[1]

    def _speeds(self, retained: set[str]) -> list[Variable]:
        speeds = []
        for body in self.system.bodies:
            speeds += [self._variable(speed.name) for speed in body.speeds]
            speeds += [self._velocity(name) for name in body.coordinates if name in retained]
        return speeds

    def _position_names(self) -> list[str]:
        position_names: list[str] = []
        for body in self.system.bodies:
            position_names += [name for name in body.coordinates if name not in self.replaced]
            position_names += [name for vector in body.orientation for name in vector.components]
        return position_names

    def _variable(self, name: str) -> Variable:
        ring = self.ring
        return Variable(name, velocity_name(name), ring.index("coordinate", name), ring.index("velocity", name))

    def _velocity(self, name: str) -> Variable:
        """A generalised velocity that is a speed itself."""
        own, rate = self.ring.index("velocity", name), self.ring.index("acceleration", name)
        return Variable(velocity_name(name), acceleration_name(name), own, rate)

    def velocity(self, name: str) -> Polynomial:
        """What a generalised force on a coordinate or speed of that name works on, in (s, u, t)."""
        polynomial = self.velocities.get(name)
        return self.ring.generator("coordinate", name) if polynomial is None else polynomial

    # --- scenes ------------------------------------------------------------------------------------------------------

    def _given(self, algebra: Algebra, values: Mapping[str, Scalar], only_vectors: bool) -> dict[str, Given]:
        """What is a variable of its own: all of an angular velocity, and direction cosines."""
        rotations = {}
        for body in self.system.bodies:
            own = {speed.component: speed.name for speed in self.system.speeds if speed.body == body.name}
            if not {1, 2, 3} <= own.keys() or (only_vectors and not body.orientation):
                continue
            spin = Vector(algebra, (values[own[1]], values[own[2]], values[own[3]]), body.name)
            a, b, c = (values[velocity_name(own[k])] for k in (1, 2, 3))
            cosines = direction_cosines_of(algebra, body, values) if body.orientation else None
            rotations[body.name] = Given(spin, Vector(algebra, (a, b, c), body.name), cosines)
        return rotations

    def scene(self, bodies: bool = True) -> Scene:
        """The system over the ring with everything in (s, u, u'); without ``bodies`` formulas can be lowered only."""
        return self.scene_over(self.ring, self._plain, bodies)

    def scene_over(self, algebra: Algebra, values: Mapping[str, Scalar], bodies: bool = True) -> Scene:
        """The same over any algebra: ``values`` for parameters, s, u and their derivatives, t and what is prescribed.

        Names that unit vectors replace have no value there.
        """
        carry = Carrier(self.ring, algebra, values) if algebra is not self.ring else None
        environment = {name: x for name, x in values.items() if name not in self._gone}
        for name in self.coordinates:
            own = (self.velocities[name], self.accelerations[name])
            first, second = own if carry is None else (carry(own[0]), carry(own[1]))
            environment |= {velocity_name(name): first, acceleration_name(name): second}
        rotations = self._given(algebra, values, only_vectors=False)
        return Scene(self.system, algebra, environment, self.ring, bodies=bodies, given=rotations, in_speeds=True)

    @cached_property
    def _gone(self) -> frozenset[str]:
        made = (velocity_name, acceleration_name)
        return self.replaced | {make(name) for name in self.replaced for make in made}

    # --- derivatives -------------------------------------------------------------------------------------------------

    @cached_property
    def rates(self) -> dict[str, Polynomial]:
        """s' by name."""
        ring, polynomials = self.ring, dict(self.velocities)
        rotations = self._given(ring, self._plain, only_vectors=False)
        scene = Scene(self.system, ring, self._in_speeds, ring, bodies=bool(self.oriented), given=rotations)
        for body in self.oriented:
            spin = scene.motions[body.name].relative_angular_velocity
            for vector in body.orientation:
                values = [self._plain[name] for name in vector.components]
                if isinstance(vector, Quaternion):
                    rates = [ring.reduce(x) for x in quaternions.rates(ring, values, list(spin))]
                else:
                    rates = list(Vector(ring, (values[0], values[1], values[2]), body.name).cross(spin))
                polynomials |= dict(zip(vector.components, rates, strict=True))
        return polynomials

    @cached_property
    def _in_speeds(self) -> dict[str, Polynomial]:
        """The names with q' in terms of u; q'' is not used."""
        return self._plain | {velocity_name(name): x for name, x in self.velocities.items()}

    @cached_property
    def accelerations(self) -> dict[str, Polynomial]:
        """q'' = d(Y (u - s0))/dt, in (s, u, u', t)."""
        return {name: self.rate(x) for name, x in self.velocities.items()}

    def rate(self, x: Polynomial) -> Polynomial:
        """dx/dt of a function of (s, u, t), with u' as generators."""
        ring = self.ring
        total = self.drift(x)
        for u in self.speeds:
            total = total + ring.times(ring.derivative(x, u.name), ring.context.gen(u.rate_index))
        return ring.reduce(total)

    def drift(self, x: Polynomial) -> Polynomial:
        """dx/dt at u' = 0."""
        ring = self.ring
        moving = ring.dependencies(x, [position.name for position in self.positions])
        running = ((name, self.rates[name]) for name in moving)
        return rate_of(ring, Lowering(ring, self._plain), self.system, x, running)

    # --- relations ---------------------------------------------------------------------------------------------------

    def vanishes(self, x: Polynomial) -> bool | None:
        """Whether x is zero wherever unit vectors are orthonormal, quaternions of norm 1; None where it is not known.

        Direction cosines made of angles reach all orientations, so that x is zero on them if and only if it is zero
        with these in its place.  A polynomial vanishes where |e| = 1 if and only if |e|^2 - 1 divides it; behind roots
        and reciprocals that hold e a zero may hide.
        """
        verdict = self.ring.is_zero(self.in_angles(x))
        return None if verdict is False and self._hides(x) else verdict

    def in_angles(self, x: Polynomial) -> Polynomial:
        """x with the unit vectors in terms of the angles that they replace, and modulo |e|^2 - 1 of quaternions."""
        return self.of_unit_quaternions(self.ring.substitute(x, self._cosines) if self._cosines else x)

    def of_unit_quaternions(self, x: Polynomial) -> Polynomial:
        """x modulo |e|^2 - 1 of quaternions."""
        for relation in self._norms:
            if len(x) and any(x.degrees()[k] for k, d in enumerate(relation.degrees()) if d):
                x = self.ring.reduce(divmod(x, relation)[1])
        return x

    @cached_property
    def _norms(self) -> list[Polynomial]:
        """|e|^2 - 1 of every quaternion."""
        norms = []
        for body in self.by_quaternion:
            total = -self.ring.one
            for name in body.orientation[0].components:
                e = self.ring.generator("coordinate", name)
                total = total + e * e
            norms.append(total)
        return norms

    def shortened(self, x: Polynomial) -> Polynomial:
        """x modulo |e|^2 - 1 of quaternions, as far as that makes it shorter: m |e|^4 is m."""
        ring, again = self.ring, True
        while again and len(x) > 1:
            again = False
            for relation in self._norms:
                places = [k for k, d in enumerate(relation.degrees()) if d]
                degrees = x.degrees()
                if all(degrees[k] for k in places):
                    rest = ring.reduce(divmod(x, relation)[1])
                    if len(rest) < len(x):
                        x, again = rest, True
        return x

    def _hides(self, x: Polynomial) -> bool:
        """Whether a root, reciprocal or function that holds a quaternion is in it."""
        ring, degrees = self.ring, x.degrees()
        names = [name for body in self.by_quaternion for name in body.orientation[0].components]
        held = [g.argument for k, g in enumerate(ring.generators[: ring.spare]) if names and degrees[k]]
        return any(argument is not None and ring.dependencies(argument, names) for argument in held)

    @cached_property
    def _cosines(self) -> dict[int, Polynomial]:
        ring = self.ring
        scene = Scene(self.system, ring, self._plain, ring) if self.by_vectors else None
        cosines = {}
        for body in self.by_vectors:
            assert scene is not None
            rows = direction_cosines(ring, scene.motions[body.name].turns, body.attached_to, body.name)
            for vector in body.orientation:
                assert isinstance(vector, UnitVector)
                for row, name in enumerate(vector.components):
                    cosines[ring.index("coordinate", name)] = rows[row][vector.axis - 1]
        return cosines

    def occurring(self, formulas: Sequence[Polynomial]) -> tuple[Variable, ...]:
        """The positions on which formulas depend, and those on which their derivatives depend."""
        ring, names = self.ring, [position.name for position in self.positions]
        needs = {name: ring.dependencies(self.rates[name], names) for name in names}
        dependencies = reached(needs, (name for x in formulas for name in ring.dependencies(x, names)))
        return tuple(position for position in self.positions if position.name in dependencies)


def _is_own(speed: Speed, body: Body) -> bool:
    return speed.body == body.name and speed.component is not None


def direction_cosines_of(algebra: Algebra, body: Body, values: Mapping[str, Scalar]) -> Tensor:
    """R^jk, whose columns are the axes of the frame j in the axes of the body, from unit vectors or a quaternion."""
    first = body.orientation[0]
    if isinstance(first, Quaternion):
        rows = quaternions.cosines(algebra, [values[name] for name in first.components])
        return tensor_of(algebra, rows, body.name, body.attached_to)
    columns = [[values[name] for name in vector.components] for vector in body.orientation]
    return tensor_of(algebra, [[column[i] for column in columns] for i in range(3)], body.name, body.attached_to)
