"""The equations as one straight-line program: what numbers are computed from.

    column j of M = Newton-Euler residuals at q' = 0, q'' = e_j, without loads
    forcing       = - Newton-Euler residuals at q'' = 0
    energy        = T - U

All over one hash-consed program, so what the columns share is computed once, and zeros (branches that do not feel a
joint) never become instructions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat, fmpq_mat

from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.oracle import State
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System, acceleration_name, velocity_name


@dataclass(frozen=True)
class Programs:
    """M (n x n nodes), forcing (n nodes) and energy over ``program``, whose inputs bear the declared names."""

    program: Program
    environment: Mapping[str, Node]
    mass_matrix: tuple[tuple[Node, ...], ...]
    forcing: tuple[Node, ...]
    energy: Node


def programs(system: System, ring: Ring) -> Programs:
    """Mass matrix, forcing and energy as straight-line code."""
    program = Program()
    inputs = program_environment(system, program)
    names = system.coordinates
    at_rest = dict(inputs) | {velocity_name(name): program.zero for name in names}
    columns = []
    for moving in names:
        unit = {acceleration_name(name): program.one if name == moving else program.zero for name in names}
        column = residuals(Scene(system, program, at_rest | unit, ring, frozen=True), loads=False)
        columns.append([column[name] for name in names])
    coasting = dict(inputs) | {acceleration_name(name): program.zero for name in names}
    scene = Scene(system, program, coasting, ring)
    forcing = residuals(scene)
    return Programs(
        program=program,
        environment=inputs,
        mass_matrix=tuple(tuple(columns[j][i] for j in range(len(names))) for i in range(len(names))),
        forcing=tuple(-forcing[name] for name in names),
        energy=kinetic_energy(scene) - force_function(scene),
    )


def accelerated(system: System, state: State, found: Programs) -> State:
    """The state with the accelerations M^-1 f that the equations of motion give there.

    Raises SingularPoint or ZeroDivisionError where M is singular, NotRational where a value is irrational.
    """
    n = len(system.coordinates)
    nodes = [node for row in found.mass_matrix for node in row] + [*found.forcing]
    values = found.program.evaluate(nodes, state.values, state.numbers)
    matrix: Any = arb_mat if any(isinstance(value, arb) for value in values) else fmpq_mat
    solved = matrix(n, n, values[: n * n]).solve(matrix(n, 1, values[n * n :]))
    accelerations = {acceleration_name(name): solved[i, 0] for i, name in enumerate(system.coordinates)}
    return State(state.numbers, {**state.values, **accelerations})
