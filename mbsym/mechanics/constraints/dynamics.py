"""Accelerations of a constrained system as straight-line code, and the way back to the constraints.

    M q'' = f + J^T lambda,      J q'' = -c,      c = J' q' + j'

by M = L^T D L of the tree and the rows W = L^-T J^T that its elimination makes of J on the way:

    S = J M^-1 J^T = W^T D^-1 W,      S lambda = -(c + J M^-1 f),      q'' = M^-1 (f + J^T lambda)

S has the sparsity of the constraints (a chain of rods: three diagonals), so a chain costs O(n).  The same factors give
the shortest way back to the constraints, measured by the kinetic energy (by M):

    dq  = -M^-1 J_h^T (J_h M^-1 J_h^T)^-1 f_h          of the holonomic rows f_h(q, t) = 0
    dq' = -M^-1 J^T   (J   M^-1 J^T  )^-1 (J q' + j)

Where M is singular everywhere (a coordinate moves no mass by itself) and positive on what the constraints allow, the
same accelerations and multipliers follow from a matrix that is positive, with any w > 0 (here the mass of all bodies):

    (M + J^T w J) q'' = f - J^T w c + J^T lambda

So it is done, too, where M is singular at single positions of the open tree in which the rows hold what moves no mass
(two massless links in line with each other): the elimination of M alone would fail there, at a regular position.

Rows that follow from others make S singular: which of them are used is chosen locally (``dependence``), so that the
pivots of S vanish only where all rows lose their rank, as those of a four-bar do whose links are in line.

In speeds u with q' = Y(q) u + y0 it is the same with u' for q'', and a way back dq = Y du of positions; coordinates
are the case Y = 1.  Components of quaternions and unit vectors are led back to their lengths along with it.

Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 8; Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.1 (index 1), VII.2 (projection).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from random import Random
from types import MappingProxyType

from flint import fmpq, fmpq_mat

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Failure, SingularPoint
from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.mechanics.articulated import bias_forces, forcing
from mbsym.mechanics.articulation import articulation
from mbsym.mechanics.constraints.dependence import Compliance, Dependent, measures
from mbsym.mechanics.constraints.rows import Row, RowName, constraint_rows, kept_rows
from mbsym.mechanics.constraints.speed_rows import speed_rows, state_rows
from mbsym.mechanics.factorisation import Elimination, mass_matrix
from mbsym.mechanics.kinematics import Scene, over_ring
from mbsym.mechanics.programs import forward_dynamics, scene_without_accelerations
from mbsym.mechanics.speed_programs import restoring, speed_program
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import SEED, drawn
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import Body, System

DEPENDENT = "the constraints are dependent everywhere"

#: How ``constraint_rows`` knows a row: the number of its constraint, and its component.
Kept = tuple[int, int]


@dataclass(frozen=True)
class ConstrainedDynamics:
    """Nodes of ``program`` for n velocities and m rows, the holonomic ones first.

    ``accelerations`` (n), ``multipliers`` (m; generalised forces are J^T lambda, and only these are unique where rows
    follow from others), ``pivots`` of M (n) and of S (as many as its rank, ``owners`` says of which rows each may be),
    ``position_correction`` of every position and ``velocity_correction`` (n).
    """

    program: Program
    environment: Mapping[str, Node]
    rows: tuple[Row, ...]
    accelerations: tuple[Node, ...]
    multipliers: tuple[Node, ...]
    pivots: tuple[Node, ...]
    owners: tuple[tuple[int, ...], ...]
    position_correction: tuple[Node, ...]
    velocity_correction: tuple[Node, ...]


@dataclass(frozen=True)
class Conditions:
    """All rows that say something, as nodes of ``program``: those that are dependent among them are still there.

    Holonomic ones come first.  In declared variables ``turned`` is Y of s' = Y u + y0, row by row, and ``at_rest`` s0:
    the speeds at which nothing moves but what is prescribed.
    """

    program: Program
    rows: tuple[Row, ...]
    turned: tuple[Node, ...] = ()
    at_rest: tuple[Node, ...] = ()

    @property
    def names(self) -> tuple[RowName, ...]:
        return tuple(row.name for row in self.rows)


def conditions(system: System, ring: Ring) -> Conditions:
    """The rows of all constraints over a program, without those that are zero at sight."""
    program = Program()
    scene = scene_without_accelerations(system, ring, program)
    rows = [row for row in constraint_rows(scene) if not row.is_trivial(program)]
    return Conditions(program, holonomic_first(rows))


def conditions_in_states(form: SpeedForm) -> Conditions:
    """The same in the declared positions and speeds."""
    lowered = speed_program(form)
    program, carry = lowered.program, Carrier(form.ring, lowered.program, lowered.environment)
    rows = [row for row in state_rows(form, lowered) if not row.is_trivial(program)]
    turned = jacobian(program, lowered.rates, [program.input(u.name) for u in form.speeds])
    at_rest = tuple(carry(x) for x in form.drifts)
    return Conditions(program, holonomic_first(rows), tuple(x for row in turned for x in row), at_rest)


def empty_rows(system: System, ring: Ring, rows: Sequence[Row], form: SpeedForm | None = None) -> frozenset[RowName]:
    """Which of these rows say 0 = 0 whatever the motion, as the ring decides; none where it cannot."""
    if not rows:
        return frozenset()
    try:
        if form is not None:
            exact = speed_rows(form, form.scene(), [row.name for row in rows])
            parts = {
                row.name: [row.position or ring.zero, row.velocity, row.acceleration, *row.partials] for row in exact
            }
            return frozenset(name for name, own in parts.items() if all(form.vanishes(x) is True for x in own))
        scene = over_ring(system, ring)
        return frozenset(row.name for row in constraint_rows(scene, kept_rows(rows)) if row.is_trivial(ring))
    except Failure:
        return frozenset()


def holonomic_first(rows: Sequence[Row]) -> tuple[Row, ...]:
    """The rows with a position before those that have velocities only; else in their order."""
    return tuple(sorted(rows, key=lambda row: row.position is None))


@dataclass(frozen=True)
class Chosen:
    """The ``rows`` of which equations are made, the holonomic ones first, and those among them that are dependent.

    ``dependent`` counts all rows, ``in_positions`` the holonomic ones alone.  ``usual``: S_ii as it usually is, of
    constraints with a single row.
    """

    rows: tuple[Kept, ...]
    dependent: tuple[Dependent, ...] = ()
    in_positions: tuple[Dependent, ...] = ()
    usual: Mapping[Kept, Fraction] = field(default_factory=dict)


def constrained_dynamics(
    system: System,
    ring: Ring,
    chosen: Chosen,
    apart: bool = False,
    massless: bool = False,
    pushed: Mapping[str, str] = MappingProxyType({}),
) -> ConstrainedDynamics:
    """See the module.

    ``pushed``: names of inputs of the program that are forces on these coordinates besides those of the loads.
    ``massless``: M is known to be singular everywhere; where that is seen from a pivot, it need not be said.  Raises
    SingularPoint where M is singular on what the constraints allow or the rows are dependent at sight, NoClosedForm as
    loads do.  Without rows it is ``forward_dynamics``, which may know a cheaper way.
    """
    if not chosen.rows:
        free = forward_dynamics(system, ring, apart=apart, pushed=pushed)
        nothing = (free.program.zero,) * len(system.coordinates)
        return ConstrainedDynamics(
            free.program, free.environment, (), free.accelerations, (), free.pivots, (), nothing, nothing
        )
    if not massless:
        with suppress(SingularPoint):  # a pivot of M is zero
            return _constrained_dynamics(system, ring, chosen, apart, False, pushed)
    return _constrained_dynamics(system, ring, chosen, apart, True, pushed)


def _constrained_dynamics(
    system: System, ring: Ring, chosen: Chosen, apart: bool, massless: bool, pushed: Mapping[str, str]
) -> ConstrainedDynamics:
    program = Program()
    inputs = program_environment(system, program)
    scene = scene_without_accelerations(system, ring, program, inputs)
    frames = articulation(scene, apart)
    rows = holonomic_first(constraint_rows(scene, chosen.rows))
    masses: Sequence[Sequence[Node]] = mass_matrix(frames)
    forces: Sequence[Node] = forcing(frames, bias_forces(frames))
    if pushed:
        besides = {name: program.input(force) for name, force in pushed.items()}
        forces = [
            f + besides[name] if name in besides else f for name, f in zip(system.coordinates, forces, strict=True)
        ]
    if massless or _held_by_rows(scene, program, masses, [row.partials for row in rows]):
        masses, forces = _added(scene, rows, masses, forces)
    return _solved(program, inputs, rows, masses, forces, chosen)


def state_dynamics(form: SpeedForm, chosen: Chosen, massless: bool = False) -> ConstrainedDynamics:
    """The same in the declared positions and speeds: accelerations are u'."""
    if not massless:
        with suppress(SingularPoint):
            return _state_dynamics(form, chosen, False)
    return _state_dynamics(form, chosen, True)


def _state_dynamics(form: SpeedForm, chosen: Chosen, massless: bool) -> ConstrainedDynamics:
    tree = speed_program(form)
    program, names = tree.program, [x.name for x in form.positions]
    rows = holonomic_first(state_rows(form, tree, chosen.rows))
    masses: Sequence[Sequence[Node]] = tree.mass_matrix
    forces: Sequence[Node] = tree.forcing
    if massless:
        masses, forces = _added(tree.scene, rows, masses, forces)
    dynamics = _solved(program, tree.environment, rows, masses, forces, chosen)
    moved = restoring(program, form.system)
    placed = [
        program.dot(row, dynamics.position_correction) + moved.get(name, program.zero)
        for name, row in zip(
            names, jacobian(program, tree.rates, [program.input(u.name) for u in form.speeds]), strict=True
        )
    ]
    return replace(dynamics, position_correction=tuple(placed))


def _solved(
    program: Program,
    inputs: Mapping[str, Node],
    rows: tuple[Row, ...],
    masses: Sequence[Sequence[Node]],
    forces: Sequence[Node],
    chosen: Chosen,
) -> ConstrainedDynamics:
    """The equations of M, f and the rows, over the velocities of M."""
    partials = [row.partials for row in rows]
    holonomic = sum(row.position is not None for row in rows)
    tree = Elimination(program, masses, [forces, *partials])
    free, *weighted = tree.forward

    def paired(x: Sequence[Node], y: Sequence[Node]) -> Node:
        """x^T D^-1 y."""
        total = program.zero
        for a, b, inverse in zip(x, y, tree.inverses, strict=True):
            if not (program.vanishes(a) or program.vanishes(b)):
                total = total + a * inverse * b
        return total

    shared = {(i, j): paired(weighted[i], weighted[j]) for i in range(len(rows)) for j in range(i + 1)}
    compliance = [[shared[max(i, j), min(i, j)] for j in range(len(rows))] for i in range(len(rows))]

    sizes = measures(program, [row.name for row in rows], [row[i] for i, row in enumerate(compliance)], chosen.usual)

    def answered(right: Sequence[Node], dependent: Sequence[Dependent]) -> Compliance:
        """S x = -right over as many rows, the first ones."""
        count = len(right)
        block = [row[:count] for row in compliance[:count]]
        return Compliance(program, block, [-x for x in right], dependent, sizes[:count], DEPENDENT)

    def carried(start: Sequence[Node], weights: Sequence[Node]) -> tuple[Node, ...]:
        """M^-1 (b + J^T weights) from L^-T b."""
        total = list(start)
        for weight, column in zip(weights, weighted, strict=False):
            total = [x if program.vanishes(y) else x + weight * y for x, y in zip(total, column, strict=True)]
        return tree.backward(total)

    still = [program.zero] * len(free)
    needed = [row.acceleration + paired(column, free) for row, column in zip(rows, weighted, strict=True)]
    forces_needed = answered(needed, chosen.dependent)
    shift = answered([row.position for row in rows[:holonomic] if row.position is not None], chosen.in_positions)
    change = answered([row.velocity for row in rows], chosen.dependent)
    return ConstrainedDynamics(
        program=program,
        environment=inputs,
        rows=rows,
        accelerations=carried(free, forces_needed.solution()),
        multipliers=forces_needed.solution(least=True),
        pivots=(*tree.pivots, *forces_needed.pivots),
        owners=forces_needed.owners,
        position_correction=carried(still, shift.solution()),
        velocity_correction=carried(still, change.solution()),
    )


def _held_by_rows(
    scene: Scene[Node], program: Program, masses: Sequence[Sequence[Node]], partials: Sequence[Sequence[Node]]
) -> bool:
    """Whether M is singular where all coordinates are zero, and M and J together have the full rank there.

    Exactly, at some values of the parameters; False where there are irrational numbers among the entries.
    """
    system, ring = scene.system, scene.ring
    if not any(body.coordinates and not _moves_mass(scene, body) for body in system.bodies):
        return False
    values = drawn(system, ring, Random(SEED)) | dict.fromkeys(system.coordinates, fmpq(0)) | {"pi": fmpq(355, 113)}
    numbers = Rationals(dict.fromkeys(ring.angles, fmpq(0)), ring.angles)
    nodes = [x for row in (*masses, *partials) for x in row]
    try:
        entries = program.evaluate(nodes, values, numbers)
    except NOT_THERE:
        return False
    n = len(masses)
    return bool(fmpq_mat(n, n, entries[: n * n]).det() == 0 and fmpq_mat(len(nodes) // n, n, entries).rank() == n)


def _moves_mass(scene: Scene[Node], body: Body) -> bool:
    """Whether a body has mass of its own."""
    return not scene.algebra.vanishes(scene.lower(body.mass))


def _added(
    scene: Scene[Node], rows: Sequence[Row], masses: Sequence[Sequence[Node]], forces: Sequence[Node]
) -> tuple[list[list[Node]], list[Node]]:
    """M + J^T w J and f - J^T w c."""
    program = scene.algebra
    weight = program.zero
    for body in scene.system.bodies:
        weight = weight + scene.lower(body.mass)
    if program.vanishes(weight):
        weight = program.one
    matrix, right = [list(row) for row in masses], list(forces)
    for row in rows:
        for i, slope in enumerate(row.partials):
            if program.vanishes(slope):
                continue
            scaled = weight * slope
            right[i] = right[i] - scaled * row.acceleration
            for j, other in enumerate(row.partials):
                if not program.vanishes(other):
                    matrix[i][j] = matrix[i][j] + scaled * other
    return matrix, right
