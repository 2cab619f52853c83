"""The equations of motion body by body, as a person would write them: what their intermediates are called is noted.

Outwards, in each body's own axes, with the turns' axes u_t and rates x_t' (v_t = u_t x_t'):

    omega_k   = R omega_j + sum v_t
    epsilon_k = R epsilon_j + omega_k x sum v_t + sum over s < t of v_s x v_t + sum u_t x_t''        (q'' = 0)
    w_k       = R (w_j + epsilon_j x r + omega_j x (omega_j x r) + 2 omega_j x r' + r'')

where w of the base is minus the uniform gravity, and a falling frame's own (``mbsym.mechanics.falling``) takes the
place of what the recursion gives.  Inwards, of a body with everything that it carries, referred to O_k:

    composite bodies    m, S, J  (mass, first moment, tensor)
    needed at q'' = 0   F = m w + epsilon x S + omega x (omega x S) - loads + what the bodies on it need,
                        H = S x w + J epsilon + omega x (J omega + h) - loads + what the bodies on it need

A unit acceleration of a coordinate that turns body k about b and displaces O_k along v (b = d omega_k/dq',
v = R dr/dq) takes  u = m v + b x S,  n = J b + S x v;  carried inwards these meet the joints on their way:

    M_ij = b_i.n_j + v_i.u_j,        f_i = Q_i - (b_i.H + v_i.F).

Not the leanest recursion (``composite`` and ``bias_forces`` are) but one of few quantities that all have a meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mbsym.algebra.base import Algebra
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.algebra.vectors import Tensor, Vector, symmetric_tensor
from mbsym.expressions.tree import differentiate, names
from mbsym.mechanics.articulation import MassProperties, mass_properties, shifted, total
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.falling import falling_frames, overrides
from mbsym.mechanics.intermediates import Meaning, NamedScene, Notes, Quantity
from mbsym.mechanics.loads.kinds import KINDS, actions_beyond_fields, base_acceleration, force_function
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import INERTIAL, System, acceleration_name


@dataclass(frozen=True)
class BodyEquations:
    """M (n x n) and f (n) of M q'' = f, T and U, as nodes of ``program``; ``meanings`` by the numbers of nodes.

    ``motions``: of each body omega_k, V_Ok and V_Ck.
    """

    program: Program
    meanings: Mapping[int, Meaning]
    motions: Mapping[str, tuple[Vector[Node], Vector[Node], Vector[Node]]]
    mass_matrix: tuple[tuple[Node, ...], ...]
    forcing: tuple[Node, ...]
    kinetic_energy: Node
    force_function: Node


def body_equations(system: System, ring: Ring, program: Program | None = None) -> BodyEquations:
    """The equations and energies of a system over a program of their own, or a given one; ``ring`` is the system's.

    Raises what the loads and the program raise: SingularPoint, NoClosedForm.
    """
    program, notes = program or Program(), Notes()
    inputs: dict[str, Node] = dict(program_environment(system, program))
    still = {acceleration_name(name): program.zero for name in system.coordinates}
    scene = NamedScene(system, program, inputs | still, ring, notes)
    _note_loads(scene)
    mass = _Composite(scene)
    return BodyEquations(
        program=program,
        meanings=notes.meanings,
        motions={
            name: (x.angular_velocity, x.velocity_origin, x.velocity_mass_centre) for name, x in scene.motions.items()
        },
        mass_matrix=mass.rows(),
        forcing=_forcing(scene, mass.joints),
        kinetic_energy=kinetic_energy(scene),
        force_function=force_function(scene),
    )


def _falling(scene: NamedScene) -> NamedScene:
    """The scene seen from its falling frames.  Its notes are dropped: a velocity there is no velocity of the body."""
    frames = frozenset(falling_frames(scene.system))
    return NamedScene(scene.system, scene.program, scene.environment, scene.ring, Notes(), falling=frames)


def _note_loads(scene: NamedScene) -> None:
    """The vectors on which loads depend."""
    notes = scene.notes
    for number, load in enumerate(scene.system.loads, 1):
        kind = KINDS[type(load)]
        for quantity, body, value in kind.notes(load, scene) if kind.notes is not None else ():
            if isinstance(value, Vector):
                notes.vector(value, quantity, body, load=number)
            else:
                notes.scalar(value, Meaning(quantity, body, load=number))


@dataclass(frozen=True, slots=True)
class _Joint:
    """What one coordinate does to a body: it turns it about ``turn`` and displaces O_k along ``shift``, in its axes."""

    coordinate: str
    turn: Vector[Node]
    shift: Vector[Node]


def _joints(scene: NamedScene, name: str) -> list[_Joint]:
    lower, motion, point = scene.lower, scene.motions[name], scene.motions[name].body.connection_point
    joints = []
    for coordinate in scene.system.coordinates:
        turn = shift = scene.zero(name)
        for each, axis in zip(motion.turns, scene.axes[name], strict=True):
            if coordinate in names(each.angle):
                slope = lower(differentiate(each.angle, coordinate))
                turn = turn + axis * slope
        if any(coordinate in names(x) for x in point):
            shift = scene.out(name, scene.vector([differentiate(x, coordinate) for x in point], motion.offset.frame))
        if not (turn.vanishes() and shift.vanishes()):
            joints.append(_Joint(coordinate, turn, shift))
    return joints


def _turned_back(algebra: Algebra[Node], rotation: Tensor[Node], tensor: Tensor[Node]) -> Tensor[Node]:
    """R^T J R of a symmetric tensor."""
    columns = [rotation.column(k) for k in range(3)]
    half = [tensor @ column for column in columns]
    rows = [[algebra.zero] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(i, 3):
            rows[i][j] = columns[i].dot(half[j])
    return symmetric_tensor(algebra, rows, rotation.source)


class _Composite:
    """The mass matrix from composite bodies; a coordinate may occur in the joints of several bodies."""

    def __init__(self, scene: NamedScene) -> None:
        self.scene = scene
        self.algebra = scene.algebra
        self.joints = {name: _joints(scene, name) for name in scene.motions}
        self.entries: dict[tuple[str, str], Node] = {}
        self.order = {name: place for place, name in enumerate(scene.system.coordinates)}
        #: The bodies that have a joint, or carry on to one nearer to the base.
        self.moving = {name for name in scene.motions if any(self.joints.get(x) for x in scene.system.path(name))}
        algebra, notes = self.algebra, scene.notes
        composite = {name: mass_properties(scene, name) for name in scene.motions}
        for name in reversed(scene.motions):
            own, motion = composite[name], scene.motions[name]
            notes.scalar(own.mass, Meaning(Quantity.MASS, name))
            notes.vector(own.first_moment, Quantity.FIRST_MOMENT, name)
            notes.symmetric(own.tensor, Quantity.INERTIA, name)
            for place, joint in enumerate(self.joints[name]):
                self._climb(name, place, joint, own)
            parent = motion.body.attached_to
            if parent != INERTIAL:
                rotation = scene.rotations[name]
                moment = scene.back(name, own.first_moment)
                turned = MassProperties(own.mass, moment, _turned_back(algebra, rotation, own.tensor))
                composite[parent] = total(composite[parent], shifted(algebra, turned, motion.offset))

    def rows(self) -> tuple[tuple[Node, ...], ...]:
        coordinates = self.scene.system.coordinates
        zero: Node = self.scene.program.zero
        return tuple(tuple(self.entries.get(self._key(i, j), zero) for j in coordinates) for i in coordinates)

    def _key(self, i: str, j: str) -> tuple[str, str]:
        return (i, j) if self.order[i] <= self.order[j] else (j, i)

    def _climb(self, name: str, place: int, joint: _Joint, own: MassProperties[Node]) -> None:
        """What a unit acceleration of one joint takes, on its way to the base."""
        scene, notes, h = self.scene, self.scene.notes, own.first_moment
        force = joint.shift * own.mass + joint.turn.cross(h)
        moment = own.tensor @ joint.turn + h.cross(joint.shift)
        body, others = name, self.joints[name][place:]
        while True:
            notes.vector(force, Quantity.UNIT_FORCE, body, joint.coordinate)
            notes.vector(moment, Quantity.UNIT_MOMENT, body, joint.coordinate)
            for other in others:
                share = other.turn.dot(moment) + other.shift.dot(force)
                self._add(joint, other, share)
            motion = scene.motions[body]
            if motion.body.attached_to not in self.moving:
                return
            force, moment = scene.back(body, force), scene.back(body, moment)
            moment = moment + motion.offset.cross(force)
            body = motion.body.attached_to
            others = self.joints[body]

    def _add(self, joint: _Joint, other: _Joint, share: Node) -> None:
        if self.algebra.vanishes(share):
            return
        if joint is not other and joint.coordinate == other.coordinate:
            share = share + share
        key = self._key(joint.coordinate, other.coordinate)
        known = self.entries.get(key)
        self.entries[key] = share if known is None else known + share


def _forcing(scene: NamedScene, joints: Mapping[str, list[_Joint]]) -> tuple[Node, ...]:
    algebra, notes, system = scene.algebra, scene.notes, scene.system
    force, moment = _needed(scene)
    totals: dict[str, Node] = dict.fromkeys(system.coordinates, algebra.zero)
    falling = _falling(scene) if falling_frames(system) else scene
    for action in actions_beyond_fields(scene, falling):
        for name, value in action.generalized.items():
            totals[name] = totals[name] + value
        for wrench in action.wrenches:
            force[wrench.body] = force[wrench.body] - wrench.force
            moment[wrench.body] = moment[wrench.body] - wrench.moment
    for name in reversed(scene.motions):
        motion = scene.motions[name]
        notes.vector(force[name], Quantity.FORCE, name)
        notes.vector(moment[name], Quantity.MOMENT, name)
        for joint in joints[name]:
            share = joint.turn.dot(moment[name]) + joint.shift.dot(force[name])
            totals[joint.coordinate] = totals[joint.coordinate] - share
        parent = motion.body.attached_to
        if parent != INERTIAL:
            carried = scene.back(name, force[name])
            twist = scene.back(name, moment[name]) + motion.offset.cross(carried)
            force[parent] = force[parent] + carried
            moment[parent] = moment[parent] + twist
    return tuple(totals[name] for name in system.coordinates)


def _needed(scene: NamedScene) -> tuple[dict[str, Vector[Node]], dict[str, Vector[Node]]]:
    """F and H of each body's own mass at q'' = 0, the loads other than gravity left out."""
    algebra, notes = scene.algebra, scene.notes
    zero, base = scene.zero(INERTIAL), base_acceleration(scene)
    felt = overrides(scene, base)
    angular, origin = {INERTIAL: zero}, {INERTIAL: base}
    force: dict[str, Vector[Node]] = {}
    moment: dict[str, Vector[Node]] = {}
    for name, motion in scene.motions.items():
        parent = motion.body.attached_to
        spin = scene.motions[parent].angular_velocity if parent != INERTIAL else zero
        angular[name] = scene.out(name, angular[parent]) + _joint_acceleration(scene, name)
        notes.vector(angular[name], Quantity.ANGULAR_ACCELERATION, name)
        carried = origin[parent] + _swung(angular[parent], spin, motion.offset)
        first = [scene.rate(x) for x in motion.body.connection_point]
        relative = scene.vector(first, parent)
        two = algebra.number(2)
        carried = carried + spin.cross(relative) * two
        carried = carried + scene.vector([scene.rate(x) for x in first], parent)
        if name in felt:
            origin[name] = felt[name]
        else:
            if parent != INERTIAL:
                notes.vector(carried, Quantity.CARRIED_ACCELERATION, name)
            origin[name] = scene.out(name, carried)
        notes.vector(origin[name], Quantity.ACCELERATION, name)
        own = mass_properties(scene, name)
        w, epsilon, omega = origin[name], angular[name], motion.angular_velocity
        S, J = own.first_moment, own.tensor
        force[name] = w * own.mass + _swung(epsilon, omega, S)
        spun = J @ omega
        if motion.gyrostatic_moment is not None:
            spun = spun + motion.gyrostatic_moment
        turned = J @ epsilon + omega.cross(spun)
        moment[name] = S.cross(w) + turned
    return force, moment


def _swung(angular: Vector[Node], spin: Vector[Node], r: Vector[Node]) -> Vector[Node]:
    """epsilon x r + omega x (omega x r)."""
    return angular.cross(r) + spin.cross(spin.cross(r))


def _joint_acceleration(scene: NamedScene, name: str) -> Vector[Node]:
    """omega_k x sum v_t + sum over s < t of v_s x v_t + sum u_t x_t''."""
    motion = scene.motions[name]
    rates = [axis * turn.rate for turn, axis in zip(motion.turns, scene.axes[name], strict=True)]
    vector = motion.angular_velocity.cross(motion.relative_angular_velocity)
    for place, v in enumerate(rates):
        for w in rates[place + 1 :]:
            vector = vector + v.cross(w)
    for turn, axis in zip(motion.turns, scene.axes[name], strict=True):
        vector = vector + axis * turn.second_rate
    return vector
