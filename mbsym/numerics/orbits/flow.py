"""The flow of a system and its derivative: x(t), Phi(t) with Phi' = J Phi, from any state, over and over.

Compiled once; every passage starts the same machine code at another state.

With constraints the accelerations keep J q' + j, and f with it, whatever they are: the flow of the open tree's states
takes states on the constraints to such, and changes that keep them to such.  Roundings and errors of steps are taken
out at the end of every passage: the state is led back, and columns lose what is across to ``tangent``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.led import lead
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.variational import Direction, Variational, units

#: The error of a step of x and of Phi, relative and absolute.
TOLERANCE = 1e-12


class Flow:
    """Passages of ``dynamics`` with as many columns of change as are wanted (2n of them by default).

    Integrated by dop853, or by another method of ``METHODS`` that chooses its steps.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        tolerance: float = TOLERANCE,
        columns: int | None = None,
        method: str = "dop853",
        scalar: str = FLOAT64,
        step_limit: int = 10_000_000,
    ) -> None:
        self.dynamics = dynamics
        self.size = 2 * dynamics.size
        directions: tuple[Direction, ...] = units(dynamics)[: self.size if columns is None else columns]
        self.columns = len(directions)
        self.constraints = dynamics.constraints
        self._lead = lead(dynamics) if self.constraints is not None and directions else None
        augmented = Variational(dynamics, directions) if directions else dynamics
        self.run = METHODS[method].start(augmented, Setting(tolerance, step_limit=step_limit), scalar)

    def led(self, state: Any) -> Any:
        """The state on the constraints at t = 0."""
        return state if self._lead is None else self._lead(0.0, state)

    def tangent(self, state: Any) -> Any | None:
        """``Constraints.tangent`` at t = 0; None where there are no constraints."""
        return None if self.constraints is None else self.constraints.tangent(0.0, np.asarray(state, dtype=float))

    def passage(self, state: Any, start: float, end: float, tangents: Any | None = None) -> tuple[Any, Any]:
        """(x(end), y(end)) from x(start) = ``state`` and y(start) = ``tangents``, the first unit vectors by default.

        Shapes (2n,) and (2n, columns).  Raises Breakdown.
        """
        if tangents is None:
            tangents = np.eye(self.size, self.columns)
        self.run.restart(start, np.concatenate([np.asarray(state), np.asarray(tangents).T.reshape(-1)]))
        found = np.array(self.run.advance(end)) if end > start else np.array(self.run.state)
        state, columns = found[: self.size], found[self.size :].reshape(self.columns, self.size).T
        if self._lead is not None and self.constraints is not None:
            state = self._lead(end, state)
            basis = self.constraints.tangent(end, state)
            columns = basis @ (basis.T @ columns)
        return state, columns

    def along(self, state: Any, start: float, times: Any) -> Any:
        """x at increasing times, shape (2n, m), from x(start) = ``state``; for a flow without columns."""
        self.run.restart(start, np.asarray(state))
        return self.run.fill(times)
