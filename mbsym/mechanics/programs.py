"""The equations as one straight-line program: what numbers are computed from.

    M         by composite bodies (``mbsym.mechanics.factorisation``)
    forcing   by the lean Newton-Euler recursion at q'' = 0 (``mbsym.mechanics.articulated``)
    energy    = T - U, without the gyrostatic term h.omega, which no energy contains

All over one hash-consed program, so what they share is computed once, and zeros (branches that do not feel a joint)
never become instructions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import arb, arb_mat, fmpq_mat

from mbsym.algebra.derivative import gradient
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.expressions.tree import names
from mbsym.mechanics import articulated, factorisation
from mbsym.mechanics.articulated import bias_forces, forcing
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.energy import gyrostatic_term, kinetic_energy
from mbsym.mechanics.factorisation import mass_matrix
from mbsym.mechanics.given_matrices import refuse_matrices
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.oracle import State
from mbsym.mechanics.variables import expressions, program_environment
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.model.welded import still_names


@dataclass(frozen=True)
class Programs:
    """M (n x n nodes), forcing (n nodes) and energy over ``program``, whose inputs bear the declared names.

    The Lagrangian is kinetic_energy + force_function; the kinetic energy holds the gyrostatic term.
    """

    program: Program
    environment: Mapping[str, Node]
    mass_matrix: tuple[tuple[Node, ...], ...]
    forcing: tuple[Node, ...]
    energy: Node
    kinetic_energy: Node
    force_function: Node


def scene_without_accelerations(
    system: System, ring: Ring, program: Program, inputs: Mapping[str, Node] | None = None
) -> Scene:
    """The system over a program, at q'' = 0."""
    still = {acceleration_name(name): program.zero for name in system.coordinates}
    return Scene(system, program, {**(inputs or program_environment(system, program)), **still}, ring)


def constants(system: System) -> frozenset[str]:
    """The inputs of a program that do not change with the state."""
    return still_names(system) | {"pi"}


def programs(system: System, ring: Ring, apart: bool = False, open_tree: bool = False) -> Programs:
    """Mass matrix, forcing and energy as straight-line code; with ``apart``, welded bodies are not lumped.

    Raises Constrained for a system with constraints, which are not in M and f, unless the ``open_tree`` is wanted.
    """
    refuse_matrices(system, Message("mass matrix and forcing"))
    if not open_tree:
        refuse_constraints(system, Message("mass matrix and forcing"))
    program = Program()
    inputs = program_environment(system, program)
    scene = scene_without_accelerations(system, ring, program, inputs)
    frames = articulation(scene, apart)
    kinetic, force = kinetic_energy(scene), force_function(scene)
    return Programs(
        program=program,
        environment=inputs,
        mass_matrix=mass_matrix(frames),
        forcing=forcing(frames, bias_forces(frames)),
        energy=kinetic - force - gyrostatic_term(scene),
        kinetic_energy=kinetic,
        force_function=force,
    )


def momenta(found: Programs, system: System) -> tuple[Node, ...]:
    """p_i = dL/dq'_i with L = T + U, as nodes of the same program."""
    return _lagrangian_gradient(found, [velocity_name(name) for name in system.coordinates])


def generalized_energy(found: Programs, system: System) -> Node:
    """h = q'.dL/dq' - L = T2 - T0 - U, Jacobi's; ``found.energy`` itself where nothing moves as prescribed."""
    timely = {item.name for item in system.prescribed} | {"t"}
    if not any(timely & names(expression) for expression in expressions(system)):
        return found.energy
    velocities = (found.environment[velocity_name(name)] for name in system.coordinates)
    products = (rate * momentum for rate, momentum in zip(velocities, momenta(found, system), strict=True))
    return sum(products, start=found.program.zero) - found.kinetic_energy - found.force_function


def momentum_rates(found: Programs, system: System) -> tuple[Node, ...]:
    """dL/dq_i: what the momenta's rates are where no force lacks a force function."""
    return _lagrangian_gradient(found, system.coordinates)


def _lagrangian_gradient(found: Programs, variables: Sequence[str]) -> tuple[Node, ...]:
    lagrangian = found.kinetic_energy + found.force_function
    return gradient(found.program, lagrangian, [found.environment[name] for name in variables])


def accelerated(
    system: System, state: State, found: Programs, rows: Sequence[Sequence[Node]] = (), needed: Sequence[Node] = ()
) -> State:
    """The state with the accelerations of  M q'' = f + J^T lambda,  J q'' = -gamma:  M^-1 f without rows.

    ``rows`` are J, ``needed`` gamma, nodes of the program.  Raises SingularPoint where the matrix [M, -J^T; J, 0] is
    singular, or cannot be told from it; NotRational where a value is irrational.
    """
    n, zero = len(system.coordinates), found.program.zero
    nodes = [x for i in range(n) for x in (*found.mass_matrix[i], *(-row[i] for row in rows))]
    nodes += [x for row in rows for x in (*row, *(zero for _ in rows))]
    nodes += [*found.forcing, *(-x for x in needed)]
    values = found.program.evaluate(nodes, state.values, state.numbers)
    size = n + len(rows)
    matrix: Any = arb_mat if any(isinstance(value, arb) for value in values) else fmpq_mat
    try:
        solved = matrix(size, size, values[: size * size]).solve(matrix(size, 1, values[size * size :]))
    except ZeroDivisionError:
        if rows:
            raise SingularPoint("the constraints and the masses leave the accelerations open there") from None
        raise SingularPoint("the mass matrix is singular there") from None
    accelerations = {acceleration_name(name): solved[i, 0] for i, name in enumerate(system.coordinates)}
    return State(state.numbers, {**state.values, **accelerations})


# Accelerations as straight-line code: q'' = M^-1 f by the route that costs fewer operations.
#
# ``articulated bodies``
#     O(n), where every coordinate belongs to one body's joint (``mbsym.mechanics.articulated``).
# ``factorised mass matrix``
#     M by composite bodies and M = L^T D L with the sparsity of the tree; O(n^2) to O(n^3) along a chain, with a small
#     constant (``mbsym.mechanics.factorisation``, ``mbsym.mechanics.factorisation``).
#
# Both are exact; no inverse is formed.  Operations are counted for one more state: what depends on the parameters alone
# is computed once.


ARTICULATED, FACTORISED = "articulated bodies", "factorised mass matrix"
METHODS = (ARTICULATED, FACTORISED)


@dataclass(frozen=True)
class ForwardDynamics:
    """q'' and the pivots of M (n nodes each, in the order of the coordinates) over ``program``.

    The product of the pivots is det M, all are positive where M is positive definite, and one of them is zero where M
    is singular.  ``operations`` holds, for each method that applies, what one state costs; of those in ``estimated``
    only the factorisation was counted, which alone costs more than the method chosen.
    """

    program: Program
    environment: Mapping[str, Node]
    accelerations: tuple[Node, ...]
    pivots: tuple[Node, ...]
    method: str
    operations: Mapping[str, int]
    estimated: frozenset[str] = frozenset()


def forward_dynamics(
    system: System, ring: Ring, method: str | None = None, apart: bool = False, pushed: Mapping[str, str] | None = None
) -> ForwardDynamics:
    """The accelerations by ``method``, or by whichever costs less; with ``apart``, welded bodies are not lumped.

    ``pushed``: names of inputs of the program that are forces on these coordinates besides those of the loads.
    Raises SingularPoint if M is singular everywhere, NoClosedForm as the loads do, Constrained, ValueError for a
    method that does not apply.
    """
    refuse_constraints(system, Message("accelerations"))
    program = Program()
    inputs = program_environment(system, program)
    frames = articulation(scene_without_accelerations(system, ring, program, inputs), apart)
    needed = bias_forces(frames)
    if pushed:
        besides = {name: program.input(force) for name, force in pushed.items()}
        total = {name: value + besides.get(name, program.zero) for name, value in needed.generalized.items()}
        needed = replace(needed, generalized=total)
    constant_names = constants(system)
    solutions: dict[str, tuple[tuple[Node, ...], tuple[Node, ...]]] = {}
    operations: dict[str, int] = {}
    estimated: set[str] = set()
    possible = articulated.applies(frames)
    if method not in (None, *METHODS) or (method == ARTICULATED and not possible):
        raise ValueError(f"this method of forward dynamics does not apply: {method}")
    if possible and method != FACTORISED:
        solutions[ARTICULATED] = articulated.solve(frames, needed)
        operations[ARTICULATED] = program.operations(
            [x for part in solutions[ARTICULATED] for x in part], constant_names
        )
    if method != ARTICULATED:
        least = factorisation.counted(_pattern(frames)) if solutions else 0
        if solutions and least > operations[ARTICULATED]:
            operations[FACTORISED] = least
            estimated.add(FACTORISED)
        else:
            solutions[FACTORISED] = factorisation.solve(program, mass_matrix(frames), forcing(frames, needed))
            operations[FACTORISED] = program.operations(
                [x for part in solutions[FACTORISED] for x in part], constant_names
            )
    chosen = min(solutions, key=lambda name: operations[name])
    accelerations, pivots = solutions[chosen]
    return ForwardDynamics(program, inputs, accelerations, pivots, chosen, operations, frozenset(estimated))


def _pattern(system: Articulation) -> list[set[int]]:
    """Which entries of M the tree lets differ from zero: coordinates on one path from the base to a tip."""
    number = {name: place for place, name in enumerate(system.coordinates)}
    pattern = [{place} for place in number.values()]
    below: list[set[int]] = []
    for frame in system.frames:
        own = {number[name] for name in (*frame.angle_derivatives, *frame.offset_derivatives)}
        path = own | (below[frame.parent] if frame.parent >= 0 else set())
        below.append(path)
        for i in own:
            pattern[i] |= path
            for j in path:
                pattern[j].add(i)
    return pattern
