"""SciPy's integrators on compiled kernels: DOP853, RK45, and for stiff systems LSODA, Radau and BDF.

The stiff ones get the exact Jacobian, by differentiating the program.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import (
    BLOW_UP,
    LARGEST,
    STEP_LIMIT,
    STUCK,
    Breakdown,
    Setting,
    Traits,
    Unusable,
    Work,
)
from mbsym.numerics.methods.kept import compiled_kernel

#: SciPy warns below this relative tolerance and takes it instead.
LEAST_TOLERANCE = 2.3e-14

#: The first step of LSODA from a state of rest, as SciPy's other methods take it there.
FIRST_STEP = 1e-6


class LibraryRun:
    """Steps of an ``OdeSolver``; times between steps come from its dense output."""

    def __init__(self, method: Library, dynamics: Dynamics, setting: Setting) -> None:
        self._rhs_kernel = compiled_kernel(dynamics, "right_hand_side")
        self._limit = setting.step_limit
        self._n = 2 * dynamics.size
        self.work = Work()
        self.time = 0.0
        self.state = np.array([float(x) for x in dynamics.scenario.state])
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        self._options: dict[str, Any] = {"rtol": max(tolerance, LEAST_TOLERANCE), "atol": tolerance}
        if setting.longest is not None:
            self._options["max_step"] = setting.longest
        if method.traits.implicit:
            self._jacobian_kernel = compiled_kernel(dynamics, "jacobian")
            self._options["jac"] = self._jacobian
        if method.traits.name == "lsoda" and not np.any(self._rhs_kernel(np.concatenate(([0.0], self.state)))):
            # Where everything rests at first, ODEPACK takes the whole time, here without end, for its first step.
            self._options["first_step"] = FIRST_STEP
        self._make = method.solver
        self._solver: Any = None
        self._dense: Any = None

    def _rhs(self, t: float, x: Any) -> Any:
        self.work.evaluations += 1
        return self._rhs_kernel(np.concatenate(([t], x)))

    def _jacobian(self, t: float, x: Any) -> Any:
        self.work.jacobians += 1
        return self._jacobian_kernel(np.concatenate(([t], x))).reshape(self._n, self._n)

    def advance(self, until: float) -> Any:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if self._solver is None:
                self._solver = self._guarded(lambda: self._make(self._rhs, 0.0, self.state, np.inf, **self._options))
            solver = self._solver
            while solver.t < until:
                self._step(solver)
            if self._dense is None and self.work.steps:
                self._dense = solver.dense_output()
        self.time = until
        self.state = np.array(solver.y) if until == solver.t or self._dense is None else self._dense(until)
        return self.state

    def _step(self, solver: Any) -> None:
        if self.work.steps >= self._limit:
            raise self._fail(STEP_LIMIT, f"{self.work.steps} steps")
        time, state = solver.t, np.array(solver.y)
        message = self._guarded(solver.step)
        self.work.steps += 1
        failed = solver.status == "failed"
        if not np.all(np.isfinite(solver.y)) or (failed and not np.all(np.abs(state) < LARGEST)):
            raise Breakdown(BLOW_UP, "a value is no longer finite", time, state)
        if failed or not solver.t > time:
            raise Breakdown(STUCK, str(message or "the time no longer advances"), time, state)
        self._dense = None

    def _guarded(self, action: Any) -> Any:
        """SciPy raises ValueError or LinAlgError where a matrix holds values that are not finite."""
        try:
            return action()
        except (ValueError, np.linalg.LinAlgError, FloatingPointError) as trouble:
            raise self._fail(BLOW_UP, str(trouble)) from None

    def _fail(self, kind: str, message: str) -> Breakdown:
        if self._solver is None:
            return Breakdown(kind, message, self.time, self.state)
        return Breakdown(kind, message, float(self._solver.t), np.array(self._solver.y, dtype=float))


class Library:
    """A method of ``scipy.integrate``, by the name of its class there."""

    def __init__(self, name: str, solver: str, order: int | None, implicit: bool = False) -> None:
        self._solver = solver
        title = f"SciPy's {solver}" + (", for stiff systems" if implicit else "")
        self.traits = Traits(name, title, order, fixed=False, implicit=implicit)

    @property
    def solver(self) -> Any:
        """The class; importing SciPy takes half a second, which only those who use it shall pay."""
        from scipy import integrate

        return getattr(integrate, self._solver)

    def start(self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64) -> LibraryRun:
        """A run in float64.  Raises Unusable for another arithmetic."""
        if scalar != FLOAT64:
            raise Unusable(f"{self.traits.name} runs in float64 only")
        return LibraryRun(self, dynamics, setting)


METHODS = (
    Library("scipy-rk45", "RK45", 5),
    Library("scipy-dop853", "DOP853", 8),
    Library("lsoda", "LSODA", None, implicit=True),
    Library("radau", "Radau", 5, implicit=True),
    Library("bdf", "BDF", None, implicit=True),
)
