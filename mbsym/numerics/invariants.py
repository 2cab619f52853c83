"""What should stay constant along a trajectory, and whether it should.

    dh/dt = dh/dt(explicit) + dh/dq . q' + dh/dq' . q''

The generalised energy h = q'.dL/dq' - L is conserved if this vanishes identically; that is tested at random states in
balls of many bits, so the answer is "verified numerically", or "not conserved" with the power at one state as evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra.derivative import gradient
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.balls import enclosures
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.problems.integrals import Integral

#: Bits of the balls, random states tried, and what counts as zero beside the terms that cancel.
BITS, STATES = 256, 4
NOTHING = arb(2) ** -120

CONSERVED, CHANGING, UNDECIDED = "conserved (verified numerically)", "not conserved", "undecided"


def energy_status(dynamics: Dynamics) -> str:
    """Whether h is conserved: CONSERVED, CHANGING or UNDECIDED."""
    return conservation(dynamics, dynamics.energy, 0)


def conservation(dynamics: Dynamics, code: Code, output: int) -> str:
    """Whether one output of a code over (t, q, q') is constant along every motion."""
    program, rhs = dynamics.right_hand_side.program, dynamics.right_hand_side
    slopes = gradient(program, code.outputs[output], [program.input(name) for name in dynamics.inputs])
    moving = zip(slopes[1:], rhs.outputs, strict=True)
    terms = [slopes[0], *(program.product(slope, rate) for slope, rate in moving)]
    whole = Code(program, dynamics.inputs, tuple(terms))
    random = Random(1)
    initial = [float(x) for x in dynamics.scenario.state]
    decided = 0
    for _ in range(4 * STATES):
        # Dyadic numbers near the initial state, so that lengths stay lengths and roots stay real.
        state = [x + random.randint(-64, 64) / 256 * (1 + abs(x)) for x in initial]
        with ctx.workprec(BITS):
            found = enclosures(whole, [random.randint(0, 1024) / 256, *state], BITS)
            if not all(term.is_finite() for term in found):
                continue
            total, size = sum(found, arb(0)), sum((abs(term) for term in found), arb(0))
            if not total.contains(0):
                # A power so small that the rounding of the constants explains it is no power.
                if abs(total) > NOTHING * size:
                    return CHANGING
                decided += 1
            elif total.rad() <= NOTHING * size or size.is_zero():
                decided += 1
        if decided == STATES:
            return CONSERVED
    return UNDECIDED


@dataclass(frozen=True)
class Invariant:
    """A first integral of problem 7 as a code over (t, q, q'): the integral I, then dI/dq' . q' part by part.

    The parts say how large a change counts as one: an integral that is zero is the difference of large terms.
    """

    name: str
    column: str
    status: str
    code: Code


def invariants(dynamics: Dynamics, integrals: Sequence[Integral], known: Sequence[str] = ()) -> tuple[Invariant, ...]:
    """First integrals with the scenario's numbers put in; those without numbers there are left out.

    ``known`` are column names that are taken.
    """
    program = dynamics.right_hand_side.program
    system, ring = dynamics.system, dynamics.ring
    declared = [*system.parameter_names, *(item.name for item in system.prescribed), *dynamics.inputs, "pi"]
    environment = {name: program.input(name) for name in declared}
    found: list[Invariant] = []
    taken = set(known)
    for integral in integrals:
        try:
            node = Carrier(ring, program, environment)(integral.formula.polynomial)
        except NOT_THERE:
            continue
        column = _column(integral, taken)
        taken.add(column)
        velocities = [program.input(name) for name in system.velocities]
        slopes = gradient(program, node, velocities)
        parts = (program.product(slope, velocity) for slope, velocity in zip(slopes, velocities, strict=True))
        code = Code(program, dynamics.inputs, (node, *parts))
        found.append(Invariant(integral.name, column, integral.status, code))
    return tuple(found)


def values(known: Sequence[Invariant], times: Any, states: Any) -> list[tuple[Any, float]]:
    """(I along a trajectory, what its changes are measured by): the largest sum of the sizes of its parts."""
    compiled = kernels({f"f{i}": item.code for i, item in enumerate(known)})
    points = np.vstack([times, np.asarray(states, dtype=float)])
    found = []
    for i in range(len(known)):
        rows = compiled[f"f{i}"](points)
        size = float(np.max(np.sum(np.abs(rows[1:]), axis=0))) or float(np.max(np.abs(rows[0]))) or 1.0
        found.append((rows[0], size))
    return found


def _column(integral: Integral, taken: set[str]) -> str:
    """``momentum_psi``, ``angular_momentum_3``: letters, digits and underscores, none twice."""
    short = integral.kind.removeprefix("cyclic ")
    stem = "_".join(part for part in (short, integral.of) if part).replace(" ", "_")
    column, count = stem, 2
    while column in taken:
        column, count = f"{stem}_{count}", count + 1
    return column
