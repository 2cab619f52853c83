"""Accelerations as straight-line code: q'' = M^-1 f by the route that costs fewer operations.

``articulated bodies``
    O(n), where every coordinate belongs to one body's joint (``mbsym.mechanics.articulated``).
``factorised mass matrix``
    M by composite bodies and M = L^T D L with the sparsity of the tree; O(n^2) to O(n^3) along a chain, with a small
    constant (``mbsym.mechanics.composite``, ``mbsym.mechanics.factorisation``).

Both are exact; no inverse is formed.  Operations are counted for one more state: what depends on the parameters alone
is computed once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.mechanics import articulated, factorisation
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.bias_forces import bias_forces, forcing
from mbsym.mechanics.composite import mass_matrix
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.programs import constants, scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System

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
    given = constants(system)
    found: dict[str, tuple[tuple[Node, ...], tuple[Node, ...]]] = {}
    operations: dict[str, int] = {}
    estimated: set[str] = set()
    possible = articulated.applies(frames)
    if method not in (None, *METHODS) or (method == ARTICULATED and not possible):
        raise ValueError(f"this method of forward dynamics does not apply: {method}")
    if possible and method != FACTORISED:
        found[ARTICULATED] = articulated.solve(frames, needed)
        operations[ARTICULATED] = program.operations([x for part in found[ARTICULATED] for x in part], given)
    if method != ARTICULATED:
        least = factorisation.counted(_pattern(frames)) if found else 0
        if found and least > operations[ARTICULATED]:
            operations[FACTORISED] = least
            estimated.add(FACTORISED)
        else:
            found[FACTORISED] = factorisation.solve(program, mass_matrix(frames), forcing(frames, needed))
            operations[FACTORISED] = program.operations([x for part in found[FACTORISED] for x in part], given)
    chosen = min(found, key=lambda name: operations[name])
    accelerations, pivots = found[chosen]
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
