"""SciPy's integrators on compiled kernels: DOP853, RK45, and for stiff systems LSODA, Radau and BDF.

The stiff ones get the exact Jacobian, by differentiating the program.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Cause, Setting, Traits, Unusable, Work, compiled_kernel
from mbsym.numerics.methods.led import lead, nearly_singular, refuse
from mbsym.numerics.methods.magnitudes import counted, first_steps, magnitudes, variables
from mbsym.numerics.methods.stepping import Stepping

#: SciPy warns below this relative tolerance and takes it instead.
LEAST_TOLERANCE = 2.3e-14

#: Methods of many orders begin with a low one.
LEAST_ORDER = 2


class LibraryRun(Stepping):
    """Steps of an ``OdeSolver``; times between steps come from its dense output."""

    def __init__(self, method: Library, dynamics: Dynamics, setting: Setting, initial: Any, at: float) -> None:
        self._rhs_kernel = compiled_kernel(dynamics, "right_hand_side")
        self._limit = setting.step_limit
        self._n = dynamics.dimension
        self.work = Work()
        tolerance = setting.tolerance if setting.tolerance is not None else 1e-9
        self._tolerance = tolerance
        self._options: dict[str, Any] = {"rtol": max(tolerance, LEAST_TOLERANCE)}
        self._rates = counted(self._rhs_kernel, self.work)
        self._kinds = variables(dynamics)
        self._led = lead(dynamics)
        if not method.traits.led:
            refuse(dynamics, method.traits.name)
        if setting.longest is not None:
            self._options["max_step"] = setting.longest
        if method.traits.implicit:
            self._jacobian_kernel = compiled_kernel(dynamics, "jacobian")
            self._options["jac"] = self._jacobian
        self._method = method
        self.restart(at, initial)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state; the solver is made anew when it is first needed."""
        self.time, self.state = float(time), np.array(state, dtype=float)
        self._first = self.time, self.state
        begin, states = np.array([self.time]), self.state[:, None]
        self._magnitudes = magnitudes(self._rates, self._kinds, begin, states)
        floor = self._magnitudes.floor(self._tolerance, float(np.finfo(float).eps))[:, 0]
        self.sizes = np.maximum(np.abs(self.state), floor)
        self._solver: Any = None
        self._dense: Any = None

    @property
    def reached(self) -> float:
        """Where the solver is."""
        return self._first[0] if self._solver is None else float(self._solver.t)

    @property
    def end(self) -> Any:
        """Its state."""
        return self._first[1] if self._solver is None else self._solver.y

    def _made(self) -> Any:
        """The solver, which looks at the right-hand side as soon as it is made."""
        time, state = self._first
        options = dict(self._options)
        options["atol"] = self._tolerance * self.sizes
        begin, order = np.array([time]), self._method.traits.order or LEAST_ORDER
        steps, rates = first_steps(
            self._rates, order, self._magnitudes, begin, state[:, None], self._tolerance, options["rtol"]
        )
        # SciPy's own choice depends on the unit of time; ODEPACK's does not, but where everything rests at first it
        # takes the whole time, here without end.
        if self._method.traits.name != "lsoda" or not np.any(rates):
            options["first_step"] = min(float(steps[0]), options.get("max_step", np.inf))
        return self._guarded(lambda: self._method.solver(self._rhs, time, state, np.inf, **options))

    def _rhs(self, t: float, x: Any) -> Any:
        self.work.evaluations += 1
        return self._rhs_kernel(np.concatenate(([t], x)))

    def _jacobian(self, t: float, x: Any) -> Any:
        self.work.jacobians += 1
        return self._jacobian_kernel(np.concatenate(([t], x))).reshape(self._n, self._n)

    def curve(self) -> Callable[[Any], Any]:
        """The solver's dense output of its last step; the state alone where there was none."""
        if self._solver is None or self._solver.t_old is None:
            state = self._first[1]
            return lambda times: np.repeat(state[:, None], len(times), axis=1)
        if self._dense is None:
            with np.errstate(all="ignore"):
                self._dense = self._solver.dense_output()
        found: Callable[[Any], Any] = self._dense
        return found

    def one(self, until: float | None = None) -> None:
        """One step of the solver."""
        if self.work.steps >= self._limit:
            raise self.work.too_many(self.reached, self.end)
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if self._solver is None:
                self._solver = self._made()
            self._bounded(np.inf if until is None else float(until))
            self._step(self._solver)

    def _bounded(self, until: float) -> None:
        """The solver's steps end at ``until`` at the latest."""
        solver = self._solver
        solver.t_bound, solver.status = until, "running"
        if self._method.traits.name == "lsoda":
            solver._lsoda_solver._integrator.rwork[0] = until  # ODEPACK's tcrit

    def _step(self, solver: Any) -> None:
        time, state = solver.t, np.array(solver.y)
        if self._led is not None and self._led.near(time, state):
            raise nearly_singular(time, state)
        message = self._guarded(solver.step)
        self.work.steps += 1
        failed = solver.status == "failed"
        if not np.all(np.isfinite(solver.y)) or (failed and self._magnitudes.outgrown(state, 0.0)):
            raise Breakdown(Cause.BLOW_UP, "a value is no longer finite", time, state)
        if failed or not solver.t > time:
            raise Breakdown(Cause.STUCK, str(message or "the time no longer advances"), time, state)
        self._dense = None
        if self._led is not None:
            self._kept_on(solver)
        self._measured(solver)

    def _measured(self, solver: Any) -> None:
        """The next step's errors are measured by the largest values so far (``magnitudes``)."""
        if np.any(np.abs(solver.y) > self.sizes):
            self.sizes = np.maximum(self.sizes, np.abs(solver.y))
            if self._method.traits.name == "lsoda":
                solver._lsoda_solver._integrator.call_args[1] = self._tolerance * self.sizes
            else:
                solver.atol = self._tolerance * self.sizes

    def _kept_on(self, solver: Any) -> None:
        """The end of the step is led to the constraints, before the solver goes on from there."""
        assert self._led is not None
        with np.errstate(all="ignore"):
            self._dense = solver.dense_output()  # between the old ends
            solver.y = self._led(solver.t, solver.y)
        if self._method.traits.name == "bdf":
            solver.D[0] = solver.y  # the first of its differences is the state itself
        else:
            solver.f = self._rhs(solver.t, solver.y)

    def _guarded(self, action: Any) -> Any:
        """SciPy raises ValueError or LinAlgError where a matrix holds values that are not finite."""
        try:
            return action()
        except (ValueError, np.linalg.LinAlgError, FloatingPointError) as trouble:
            raise Breakdown(Cause.BLOW_UP, str(trouble), self.reached, self.end) from None


class Library:
    """A method of ``scipy.integrate``, by the name of its class there; an evaluation costs about ``seconds``."""

    def __init__(self, name: str, solver: str, order: int | None, seconds: float, implicit: bool = False) -> None:
        self._solver = solver
        title = Message("SciPy's [[solver]], for stiff systems" if implicit else "SciPy's [[solver]]", solver=solver)
        led = name != "lsoda"  # ODEPACK keeps its history to itself
        self.traits = Traits(
            name, title, order, fixed=False, implicit=implicit, led=led, interpreted=seconds, least=LEAST_TOLERANCE
        )

    @property
    def solver(self) -> Any:
        """The class; importing SciPy takes half a second, which only those who use it shall pay."""
        from scipy import integrate

        return getattr(integrate, self._solver)

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = FLOAT64, initial: Any = None, at: float = 0.0
    ) -> LibraryRun:
        """A run in float64.  Raises Unusable for another arithmetic."""
        if scalar != FLOAT64:
            raise Unusable(Message("[[name]] runs in float64 only", name=self.traits.name))
        state = [float(x) for x in dynamics.scenario.state] if initial is None else initial
        return LibraryRun(self, dynamics, setting, state, at)


METHODS = (
    Library("scipy-rk45", "RK45", 5, 2e-5),
    Library("scipy-dop853", "DOP853", 8, 2e-5),
    Library("lsoda", "LSODA", None, 13e-6, implicit=True),
    Library("radau", "Radau", 5, 5e-5, implicit=True),
    Library("bdf", "BDF", None, 7e-5, implicit=True),
)
