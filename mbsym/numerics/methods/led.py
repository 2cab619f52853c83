"""Constraints and integration methods: every step ends on the constraints, and so do the states between.

    x <- x + correction(t, x),  twice:       dq  = -M^-1 J^T (J M^-1 J^T)^-1 f,   dq' likewise of  J q' + j

The correction is the shortest, measured by the kinetic energy (``mbsym.mechanics.constraints.dynamics``).  What a step
strays is of the order of its local error, so a method keeps its order (Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.2).  Compiled methods do it in machine code (``marching``), others through ``lead``; what lies between
the ends of steps is led back here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Piece, Run, Unusable
from mbsym.numerics.methods.kept import compiled_kernel
from mbsym.numerics.methods.passed import Passed, met_by

#: Newton's steps for a state between the ends of steps.
TIMES = 2

#: A correction beyond this part of the state is none: the constraints are nearly singular there.
LARGEST_PART = 1e-2

Lead = Callable[[Any, Any], Any]


def lead(dynamics: Dynamics, scalar: str = "float64") -> Lead | None:
    """(t, states) -> the states on the constraints: (2n,) at one time or (2n, m) at m; None where there are none.

    A state whose correction is no number, or large, stays as it is.
    """
    if dynamics.correction is None:
        return None
    correct = compiled_kernel(dynamics, "correction", scalar)

    def led(times: Any, states: Any) -> Any:
        found = np.array(states)
        with np.errstate(all="ignore"):
            for _ in range(TIMES):
                change = correct(np.concatenate([np.atleast_1d(times)[None] if found.ndim > 1 else [times], found]))
                size = np.max(np.abs(change), axis=0)
                near = size <= LARGEST_PART * (1 + np.max(np.abs(found), axis=0))
                found = found + np.where(near, change, 0.0)
        return found

    return led


def refuse(dynamics: Dynamics, method: str) -> None:
    """Raises Unusable for a method that does not know constraints."""
    if dynamics.constraints is not None:
        kept = f"{method} does not keep to constraints ({dynamics.constraints.told()})"
        raise Unusable(f"{kept}; these methods do: rk4, rk45, dop853, taylor, scipy-rk45, scipy-dop853, radau, bdf")


class LedRun:
    """A run whose states are on the constraints between the ends of its steps as well."""

    def __init__(self, inner: Run, led: Lead) -> None:
        self._inner, self._led = inner, led
        self.time, self.work = inner.time, inner.work
        self.state = led(inner.time, inner.state)

    @property
    def passed(self) -> Passed | None:
        """What it has met."""
        return met_by(self._inner)

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``; raises Breakdown."""
        self._inner.advance(until)
        return self._arrived()

    def step(self, until: float | None = None) -> Piece:
        """The solution to the end of a step, or to ``until``; raises Breakdown."""
        piece, led = self._inner.step(until), self._led
        self._arrived()
        return Piece(piece.start, piece.end, lambda times: led(times, piece.curve(times)))

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times; raises Breakdown with those that there are."""
        at = np.asarray(times)
        try:
            found = self._inner.fill(times)
        except Breakdown as trouble:
            if trouble.filled is not None and trouble.filled.shape[1]:
                trouble.filled = self._led(at[: trouble.filled.shape[1]], trouble.filled)
            raise
        self._arrived()
        return self._led(at, found) if len(at) else found

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state."""
        self._inner.restart(time, state)
        self._arrived()

    def _arrived(self) -> Any:
        self.time = self._inner.time
        self.state = self._led(self.time, self._inner.state)
        return self.state
