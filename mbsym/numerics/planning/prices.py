"""What a run costs, by its counted work alone: the same on every machine and under every load.

    cost = evaluations (call + operations * operation) + steps * step + Jacobians * jacobian

The prices are fixed.  They are about the seconds that each takes on a usual machine that does nothing else, so a cost
reads as seconds; yet no clock is looked at.  Whatever decides by cost decides the same everywhere: budgets of error
estimates and references, which method is the cheapest.  ``operations`` are those of one right-hand side.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.methods.interface import Work
from mbsym.numerics.methods.table import METHODS

#: A call of a compiled right-hand side, and one of its operations.
CALL, OPERATION = 15e-9, 6e-10

#: Arithmetic beside float64.
DEARER = {FLOAT64: 1.0, FLOAT32: 0.8, EXTENDED: 10.0}

#: What a method costs before its first step, an operation of the right-hand side: once, but for those that are compiled
#: for each setting.
STARTED, STARTED_EACH = 1e-3, ("taylor",)

#: A coefficient of a Taylor series beside an operation of the right-hand side.
COEFFICIENT = 6.0

#: A Jacobian of an implicit method of SciPy's, with all that is done between two of them, in a run that began with
#: another.
JACOBIAN = 1e-2

#: Solutions with one matrix by a compiled implicit method.
SOLVED = 8

#: A step that is made from outside of machine code, and looked at, as so many at most are (``trade.comparison``); one
#: where switches or narrow loads are looked for.
LOOKED_AT, FOLLOWED, SEARCHED = 6e-5, 4_000, 6e-4

#: A number of the state in one row; and a step with rows in it, where a method's rows are made outside of its machine
#: code: many times the step itself, but where rows lie closer than two steps, which are taken together.
NUMBER = 2e-9
FILLED, TOGETHER = {"taylor": 5e-5}, {"taylor": 8e-7}

#: An operation in numbers of 160 bits, and a call.
PRECISE, PRECISE_CALL = 1.4e-7, 5e-6


class Working(Protocol):
    """A run that counts its work."""

    work: Work


def cost(dynamics: Dynamics, method: str, scalar: str, work: Work, looked_at: bool = False) -> float:
    """What ``work`` of the ``method`` costs; ``looked_at`` where steps were, from the first on."""
    steps = work.steps + work.rejected
    besides = LOOKED_AT * min(steps, FOLLOWED) if looked_at else 0.0
    if not dynamics.features.none:
        besides = max(besides, SEARCHED * steps)
    traits = METHODS[method].traits if method in METHODS else None  # parts have methods of their own
    if traits is not None and traits.interpreted:
        return work.evaluations * (traits.interpreted + _operations(dynamics) * OPERATION) + besides
    operations = _operations(dynamics) * (COEFFICIENT if method == "taylor" else 1.0)
    whole = work.evaluations * (CALL + operations * OPERATION) * DEARER[scalar]
    if traits is not None and traits.implicit:  # a Jacobian is about as many right-hand sides as the state
        size = len(dynamics.scenario.state)
        linear = OPERATION * (size**3 / 3 + SOLVED * size**2)
        return whole * (1 + size * work.jacobians / max(1, work.evaluations)) + work.jacobians * linear + besides
    return whole + work.jacobians * JACOBIAN + besides


def cost_of_rows(method: str, work: Work, count: int, numbers: int) -> float:
    """What ``count`` rows of so many numbers cost beside the steps of a run."""
    step = (TOGETHER if 2 * count > work.steps else FILLED).get(method, 0.0)
    return NUMBER * count * numbers + step * min(work.steps, count)


def precise_cost(dynamics: Dynamics, evaluations: int) -> float:
    """What evaluations in balls of 160 bits cost."""
    return evaluations * (PRECISE_CALL + _operations(dynamics) * PRECISE)


class Meter:
    """What runs have cost since it began: ``spent``."""

    def __init__(self, dynamics: Dynamics, looked_at: bool = False) -> None:
        self._dynamics, self._looked_at = dynamics, looked_at
        self._runs: list[tuple[Working, str, str]] = []
        self._before = 0.0

    def start(self, runs: Sequence[tuple[Working, str, str]]) -> None:
        """Counts (run, method, arithmetic) from here on."""
        self._runs = list(runs)
        self._before = 0.0
        self._before = self.spent

    @property
    def spent(self) -> float:
        """The cost so far."""
        whole = sum(cost(self._dynamics, name, scalar, run.work, self._looked_at) for run, name, scalar in self._runs)
        return whole - self._before


def _operations(dynamics: Dynamics) -> int:
    return max(1, dynamics.right_hand_side.operations)
