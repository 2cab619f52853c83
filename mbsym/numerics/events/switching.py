"""A run that changes between an explicit and an implicit method as the motion becomes stiff and ceases to be.

Explicit steps are bounded by accuracy, or by stability: about ``STABLE`` / |Re lambda| for what dies out fastest
(Hairer & Wanner, Solving Ordinary Differential Equations II, IV.2).  After every ``WINDOW`` of explicit steps h the
greatest decay -Re lambda is looked at.  Where

    h max(-Re lambda) > LIMITED    and    max(-Re lambda) > STIFF max |Im lambda|

stability bounds the steps.  Then a few implicit steps are tried from there; where these are longer by more than they
are dearer, the run goes on with them.  After as many implicit steps h the question is whether explicit ones of
min(h, STABLE / -Re lambda) would lead further at equal cost, with a margin; if so the run goes back.  Once stability
would not shorten explicit ones, some of these are tried, too: implicit steps are hardly dearer.

How much dearer a step is, is a fixed estimate, not a measured time: equal runs change at equal times.  Where nothing is
ever stiff, steps, rows and results are those of the explicit method to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import inf
from typing import Any

import numpy as np

from mbsym.algebra.lookup import numbers_of
from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics, Frozen
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import (
    Breakdown,
    Change,
    Method,
    Run,
    Setting,
    Traits,
    Work,
    compiled_kernel,
    once,
)
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.runge_kutta import CompiledRun
from mbsym.numerics.methods.stepping import Stepping
from mbsym.numerics.methods.tableaux import RODAS5P

#: Explicit methods of high order are stable for steps up to about this over |Re lambda|.
STABLE = 5.0

#: Explicit steps beyond this over |Re lambda| are near that bound.
LIMITED = 1.5

#: Only a decay so much faster than the oscillations makes a motion stiff.
STIFF = 3.0

#: So many steps from one look at the eigenvalues to the next.
WINDOW = 256

#: Implicit steps of a trial; after one that did not pay, so many times as many explicit steps pass before the next.
TRIAL, PATIENCE = 40, 4

#: Explicit steps must promise to be so much quicker before the run goes back to them.
MARGIN = 3.0

#: About what a step takes: seconds an operation of compiled code, and a compiled step besides.
OPERATION, STEP = 4e-10, 2e-7


def rates(dynamics: Dynamics, state: Any = None, t: float = 0.0) -> tuple[float, float]:
    """(max -Re lambda, max |Im lambda|) of the Jacobian's eigenvalues at a state, the initial one by default.

    The Jacobian is formed by central differences, which is close enough here and needs no further code to be compiled.
    Zeros where it is not finite.  Where the rates jump they are those on one side: differences across a jump are none.
    """
    x = np.array([float(x) for x in (dynamics.scenario.state if state is None else state)])
    dynamics = _on_one_side(dynamics, t, x)
    n, rhs = len(x), compiled_kernel(dynamics, "right_hand_side")
    step = 1e-6 * np.maximum(about(dynamics, t, x).sizes[:, 0], np.abs(x))
    moved = np.hstack([np.diag(step), -np.diag(step)]) + x[:, None]
    with np.errstate(all="ignore"):
        slopes = rhs(np.vstack([np.full(2 * n, t), moved]))
        matrix = (slopes[:, :n] - slopes[:, n:]) / (2 * step)
    if not np.all(np.isfinite(matrix)):
        return 0.0, 0.0
    eigenvalues = np.linalg.eigvals(matrix)
    return max(0.0, float(np.max(-eigenvalues.real))), float(np.max(np.abs(eigenvalues.imag)))


def _on_one_side(dynamics: Dynamics, t: float, x: Any) -> Dynamics:
    """The dynamics with its switches held as they stand at a state; those that are at 0 on their positive side."""
    if isinstance(dynamics, Frozen) or not dynamics.switches.outputs:
        return dynamics
    code = dynamics.switches
    values = once(dynamics, ("features", "switches"), lambda: kernel(code))(np.concatenate(([t], x)))
    sides = []
    for value, curve in zip(values, dynamics.features.curves, strict=True):
        on_piece = curve is not None and 1 + int(np.searchsorted(numbers_of(curve, np.float64)[0], value, "right"))
        sides.append(on_piece or (-1 if value < 0 else 1))
    return dynamics.on_sides(tuple(sides))


class Switching:
    """``explicit`` and ``implicit`` in turns, beginning with the latter where ``stiff``."""

    def __init__(self, explicit: Method, implicit: Method, stiff: bool = False) -> None:
        self.explicit, self.implicit, self.stiff = explicit, implicit, stiff

    @property
    def traits(self) -> Traits:
        """Those of the method that it begins with."""
        return self.implicit.traits if self.stiff else self.explicit.traits

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> Run:
        """A run; in other arithmetic than float64, which the implicit methods do not know, it never changes."""
        if scalar != "float64" and not self.stiff:
            return self.explicit.start(dynamics, setting, scalar, initial, at)
        return SwitchingRun(self, dynamics, setting, initial, at)


class SwitchingRun(Stepping):
    """Steps of one method or the other."""

    def __init__(self, method: Switching, dynamics: Dynamics, setting: Setting, initial: Any, at: float) -> None:
        self._method, self._dynamics, self._setting = method, dynamics, setting
        state = np.array([float(x) for x in dynamics.scenario.state]) if initial is None else np.asarray(initial)
        self._runs: dict[bool, Any] = {}
        self._since = 0, float(at)  # steps and time at the last look at the eigenvalues
        self._stiff = method.stiff
        self.work = Work()
        operations, size, stages = dynamics.right_hand_side.operations, dynamics.dimension, len(RODAS5P.stages)
        # A Jacobian is about as many right-hand sides as the state has numbers.
        implicit = OPERATION * ((stages + size) * operations + size**3 / 3 + stages * size**2) + STEP
        self._dearer = implicit / (12 * operations * OPERATION + STEP)
        self._patience = 1
        self._turned(self._stiff, at, state)
        self.time, self.state = float(at), np.array(self.end)

    # --- what Stepping asks for ---

    @property
    def reached(self) -> float:
        """The end of the last step."""
        end: float = self._active.reached
        return end

    @property
    def end(self) -> Any:
        """The state there."""
        return self._active.end

    def curve(self) -> Callable[[Any], Any]:
        """The dense output of the last step."""
        found: Callable[[Any], Any] = self._active.curve()
        return found

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state, by the method that is at work."""
        self._turned(self._stiff, time, state)
        self.time, self.state = float(time), np.array(self.end)

    @property
    def sizes(self) -> Any:
        """By which errors of steps are measured."""
        return self._active.sizes

    def lengthen(self, length: float) -> None:
        """The next step is tried with this length, where that of a beginning is shorter."""
        self._active.lengthen(length)

    def one(self, until: float | None = None) -> None:
        """One step, by whichever method is the better one here."""
        self._considered()
        self._counted(partial(self._active.one, until))

    def far(self, until: float) -> None:
        """Steps until ``until`` is reached or passed."""
        while self.reached < until:
            self._considered()
            if isinstance(self._active, CompiledRun):
                self._counted(partial(self._active.some, until, WINDOW))
            else:
                self._counted(self._active.one)

    def advance(self, until: float) -> Any:
        """The state at ``until``: a row."""
        return self.fill(np.array([until]))[:, 0]

    def fill(self, times: Any) -> Any:
        """Rows in machine code while the explicit method is at work."""
        at = np.ascontiguousarray(times, dtype=float)
        states, done = np.empty((len(self.state), len(at))), 0
        try:
            while done < len(at):
                if at[done] > self.reached:
                    self._considered()
                run = self._active
                if isinstance(run, CompiledRun):
                    done = self._counted(partial(run.stretch, at, states, done, WINDOW))
                    run.settle(done == len(at))
                    continue
                if at[done] > self.reached:
                    self._counted(run.one)
                last = done + int(np.searchsorted(at[done:], self.reached, side="right"))
                if last > done:
                    states[:, done:last] = self.states(at[done:last])
                done = last
        except Breakdown as trouble:
            trouble.filled = states[:, :done]
            raise
        if done:
            self.time, self.state = float(at[-1]), states[:, -1].copy()
        return states

    # --- which method ---

    def _considered(self) -> None:
        """Looks, every so many steps, whether the other method is the better one, and turns to it if it is."""
        if self.work.steps + self.work.rejected >= self._setting.step_limit:
            raise self.work.too_many(self.reached, self.end)
        made = self.work.steps - self._since[0]
        if made < WINDOW * self._patience:
            return
        step = (self.reached - self._since[1]) / made
        decay, frequency = rates(self._dynamics, self.end, self.reached)
        if self._stiff:
            bound = STABLE / decay if decay > 0 else inf
            surely = self._dearer * min(step, bound) > MARGIN * step
            if surely or (bound > step and self._pays(False, step / self._dearer)):
                text = "stiff no longer: motions die out at rates up to [[rate]]"
                self._change(False, Message(text, rate=f"{decay:.3g}"))
                return
        elif step * decay > LIMITED and decay > STIFF * frequency:
            if self._pays(True, self._dearer * step):
                text = "stiff: motions die out at rates up to [[rate]], explicit steps were [[step]]"
                self._change(True, Message(text, rate=f"{decay:.3g}", step=f"{step:.2g}"))
                return
        else:
            self._patience = 1
        self._since = self.work.steps, self.reached

    def _pays(self, stiff: bool, step: float) -> bool:
        """Whether steps of the other method are longer than so much; if not, it is asked again the later."""
        longer = self._tried(stiff) > step
        self._patience = 1 if longer else self._patience * PATIENCE
        return longer

    def _tried(self, stiff: bool) -> float:
        """The length of the last of some steps of a method from here; 0 where they fail."""
        run = self._run(stiff, self.reached, self.end, self._active.sizes)
        before = run.reached
        try:
            for _ in range(TRIAL):
                before = run.reached
                self._counted(run.one, run)
        except Breakdown:
            return 0.0
        return float(run.reached - before)

    def _change(self, stiff: bool, why: str) -> None:
        traits = (self._method.implicit if stiff else self._method.explicit).traits
        self.work.changes.append(Change(float(self.reached), traits.name, why))
        self._turned(stiff, self.reached, np.array(self.end, dtype=float), self._active.sizes)

    def _turned(self, stiff: bool, time: float, state: Any, sizes: Any = 0.0) -> None:
        self._active = self._run(stiff, time, state, sizes)
        self._stiff, self._since = stiff, (self.work.steps, float(time))

    def _run(self, stiff: bool, time: float, state: Any, sizes: Any) -> Any:
        """The run of one of the methods, from a state; it measures errors by ``sizes`` at least, those of its past."""
        run: Any
        if stiff in self._runs:
            run = self._runs[stiff]
            self._counted(partial(run.restart, time, state), run)
        else:
            method: Method = self._method.implicit if stiff else self._method.explicit
            run = method.start(self._dynamics, self._setting, "float64", state, float(time))
            self._runs[stiff] = run
            self.work.add(run.work, Work())
        run.sizes[:] = np.maximum(run.sizes, sizes)
        return run

    def _counted(self, action: Callable[[], Any], run: Any = None) -> Any:
        """What an action of a run costs is added to the work."""
        own = (self._active if run is None else run).work
        before = replace(own)
        try:
            return action()
        finally:
            self.work.add(own, before)
