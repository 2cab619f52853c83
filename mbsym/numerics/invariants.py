"""First integrals of problem 7 along a trajectory: their values, and by what their changes are measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.derivative import gradient
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.model.quantities import integral_unit
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels

if TYPE_CHECKING:
    from mbsym.problems.integrals import Integral


@dataclass(frozen=True)
class Invariant:
    """A first integral of problem 7 as a code over (t, q, q'): the integral I, then dI/dq' . q' part by part.

    The parts say how large a change counts as one: an integral that is zero is the difference of large terms.
    ``unit`` is None where it is not known.
    """

    name: str
    column: str
    proved: bool
    code: Code
    unit: str | None = None


def invariants(dynamics: Dynamics, integrals: Sequence[Integral], known: Sequence[str] = ()) -> tuple[Invariant, ...]:
    """First integrals with the scenario's numbers put in; those without numbers there are left out.

    ``known`` are column names that are taken.
    """
    if not integrals:
        return ()
    from mbsym.problems.integrals import identifiers

    program = dynamics.right_hand_side.program
    system, ring = dynamics.system, dynamics.ring
    declared = [*system.parameter_names, *(item.name for item in system.prescribed), *dynamics.inputs, "pi"]
    environment = {name: program.input(name) for name in declared}
    found: list[Invariant] = []
    taken = set(known)
    for integral in integrals:
        try:
            node = Carrier(ring, program, environment)(integral.formula.polynomial)
        except Failure:
            continue
        (column,) = identifiers([integral], taken)
        taken.add(column)
        velocities = [program.input(name) for name in system.velocities]
        slopes = gradient(program, node, velocities)
        parts = (program.product(slope, velocity) for slope, velocity in zip(slopes, velocities, strict=True))
        code = Code(program, dynamics.inputs, (node, *parts))
        unit = integral_unit(system, integral.kind, integral.of)
        found.append(Invariant(integral.name, column, integral.status is Certainty.PROVED, code, unit))
    return tuple(found)


def along(known: Sequence[Invariant]) -> Callable[[Any], dict[str, Any]]:
    """Of (t, q, q') in columns the values of first integrals, by the names of their columns."""
    compiled = kernels({item.column: item.code for item in known})
    return lambda points: {name: kernel(np.asarray(points, dtype=float))[0] for name, kernel in compiled.items()}


def values(known: Sequence[Invariant], times: Any, states: Any) -> list[tuple[Any, float]]:
    """(I along a trajectory, what its changes are measured by): the largest sum of the sizes of its parts."""
    if not known:
        return []
    compiled = kernels({f"f{i}": item.code for i, item in enumerate(known)})
    points = np.vstack([times, np.asarray(states, dtype=float)])
    found = []
    for i in range(len(known)):
        rows = compiled[f"f{i}"](points)
        size = float(np.max(np.sum(np.abs(rows[1:]), axis=0))) or float(np.max(np.abs(rows[0]))) or 1.0
        found.append((rows[0], size))
    return found
