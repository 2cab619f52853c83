"""Reference solutions, against which errors are measured: extrapolation in arithmetic of any precision.

Gragg's modified midpoint rule with n = 2, 4, 6, ... substeps, extrapolated to n -> infinity (Hairer, Norsett & Wanner,
Solving Ordinary Differential Equations I, II.9), over ``arb`` numbers of ``bits`` bits.  It shares neither its formulas
nor its arithmetic with the methods that are judged by it.  Its own error is estimated by a second solution of lower
order with other steps, and is printed with every table.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.precise import precise
from mbsym.numerics.methods.interface import BLOW_UP, STEP_LIMIT, Breakdown
from mbsym.numerics.planning.prices import precise_cost

#: Bits of the arithmetic, and how many columns the extrapolation has (order 2 * COLUMNS).
BITS = 160
COLUMNS = 12

#: Columns where many times are asked for: steps are short then.
FEW_COLUMNS = 8

#: Ways to a reference.
EXTRAPOLATION, EXPLICIT, IMPLICIT = "extrapolation", "explicit", "implicit"


@dataclass(frozen=True)
class Reference:
    """``states`` at ``times``, shape (2n, m), rounded to float64; ``error`` is the estimated error of the solution:

    the largest difference from a second solution, each component relative to ``scale``, shape (2n,).  ``method`` says
    what the two are, ``way`` of which kind, ``cost`` what finding it has cost (``mbsym.numerics.planning.prices``).
    """

    times: Any
    states: Any
    error: float
    seconds: float
    method: str
    scale: Any
    way: str = EXTRAPOLATION
    cost: float = 0.0


class Extrapolation:
    """A solution under way: ``state`` at ``time``, which is a double, so that others can start there."""

    def __init__(self, dynamics: Dynamics, tolerance: float, columns: int, limit: float) -> None:
        self.f = precise(dynamics.right_hand_side, BITS)
        self.time = 0.0
        self.state = [rationals.ball(x) for x in dynamics.scenario.state]
        self.tolerance = tolerance
        self.columns = columns
        self.dynamics, self.limit, self.evaluations = dynamics, limit, 0
        self.step_size = 1e-3
        self.scale = [max(abs(float(x)), 1e-3) for x in dynamics.scenario.state]

    def advance(self, until: float) -> None:
        """Steps up to ``until``; the last one ends there exactly.  Raises Breakdown."""
        while self.time < until:
            self.step(until)

    def step(self, until: float) -> None:
        """One step, which ends at ``until`` at the latest.  Raises Breakdown."""
        while True:
            now = min(self.time + self.step_size, until)
            last, length = now == until, now - self.time
            new, error = self._extrapolated(arb(now) - arb(self.time))
            growth = 0.9 * (self.tolerance / max(error, 1e-300)) ** (1 / (2 * self.columns - 1))
            accepted = error <= self.tolerance
            if not accepted:
                self.step_size = length * min(0.7, max(0.1, growth))
            elif not last or growth < 1:
                self.step_size = length * min(4.0, growth)
            if accepted:
                self.time, self.state = now, new
                self.scale = [max(s, abs(float(x))) for s, x in zip(self.scale, new, strict=True)]
            if not self.step_size > 1e-12 * max(1.0, self.time):
                raise Breakdown(BLOW_UP, "the reference solution cannot go on", self.time, self.floats())
            if self.spent > self.limit:
                raise Breakdown(STEP_LIMIT, "it costs more than it may", self.time, self.floats())
            if accepted:
                return

    @property
    def spent(self) -> float:
        """What it has cost so far (``mbsym.numerics.planning.prices``)."""
        return precise_cost(self.dynamics, self.evaluations)

    def floats(self) -> Any:
        return np.array([float(x) for x in self.state])

    def _extrapolated(self, size: arb) -> tuple[list[arb], float]:
        """Aitken-Neville: T_jk = T_j,k-1 + (T_j,k-1 - T_j-1,k-1) / ((n_j/n_j-k)^2 - 1); and the relative error."""
        slope = self._slope(arb(self.time), self.state)
        rows: list[list[list[arb]]] = []
        for j in range(self.columns):
            n = 2 * (j + 1)
            row = [self._midpoints(size, n, slope)]
            for k in range(1, j + 1):
                ratio = arb(fmpq(n * n, (2 * (j + 1 - k)) ** 2)) - 1
                row.append([(a + (a - b) / ratio).mid() for a, b in zip(row[k - 1], rows[j - 1][k - 1], strict=True)])
            rows.append(row)
        best, second = rows[-1][-1], rows[-1][-2]
        errors = [abs(float(a - b)) / s for a, b, s in zip(best, second, self.scale, strict=True)]
        worst = max(errors) if all(np.isfinite(errors)) else float("inf")
        return best, worst

    def _slope(self, t: arb, x: Sequence[arb]) -> list[arb]:
        self.evaluations += 1
        return self.f([t, *x])

    def _midpoints(self, size: arb, n: int, slope: Sequence[arb]) -> list[arb]:
        """n substeps of the midpoint rule from an Euler start."""
        h = size / n
        before, now = self.state, [(x + h * s).mid() for x, s in zip(self.state, slope, strict=True)]
        double = 2 * h
        for i in range(1, n):
            rate = self._slope(self.time + i * h, now)
            before, now = now, [(x + double * s).mid() for x, s in zip(before, rate, strict=True)]
        return now


def solved_at(dynamics: Dynamics, times: Any, tolerance: float, limit: float) -> Any:
    """The states (2n, m) at increasing times from 0, in the most digits that NumPy has.

    Raises Breakdown where there is no solution, or where it costs more than ``limit`` (kind STEP_LIMIT).
    """
    with ctx.workprec(BITS):
        run = Extrapolation(dynamics, tolerance, FEW_COLUMNS, limit)
        states = [in_doubles(run.state)]
        for t in times[1:]:
            run.advance(float(t))
            states.append(in_doubles(run.state))
    return np.array(states).T


def in_doubles(state: Sequence[arb]) -> Any:
    """The sum of two doubles for each component, as far as NumPy's longest numbers hold it."""
    heads = [float(x) for x in state]
    tails = [float(x - arb(head)) for x, head in zip(state, heads, strict=True)]
    return np.array(heads, np.longdouble) + np.array(tails, np.longdouble)


def reference(
    dynamics: Dynamics,
    times: Sequence[float],
    tolerance: float = 1e-24,
    budget: float = 120.0,
    watch: Callable[[float], None] = lambda t: None,
    scale: Any | None = None,
) -> Reference:
    """The solution at ``times`` (the first is 0) with a local error of ``tolerance`` per step, and its own error.

    ``scale`` says what each component is measured by; by default its largest absolute value at the times.
    Raises Breakdown where the solution does not exist up to the end, or where one of its two runs costs more than
    ``budget`` (``mbsym.numerics.planning.prices``).
    """
    started = time.perf_counter()
    runs = []
    with ctx.workprec(BITS):
        for columns, local in ((COLUMNS, tolerance), (COLUMNS - 3, tolerance * 1e3)):
            run = Extrapolation(dynamics, local, columns, budget)
            states = [list(run.state)]
            for t in times[1:]:
                run.advance(float(t))
                states.append(list(run.state))
                watch(float(t))
            runs.append(states)
        first, second = runs
        states_ = np.array([[float(x) for x in state] for state in first]).T
        if scale is None:
            size = np.max(np.abs(states_), axis=1)
            scale = np.where(size > 0, size, 1.0)
        error = 0.0
        for i, size in enumerate(map(float, scale)):
            error = max(error, *(abs(float(a[i] - b[i])) / size for a, b in zip(first, second, strict=True)))
    seconds = time.perf_counter() - started
    return Reference(np.asarray(times, dtype=float), states_, error, seconds, f"extrapolation, {BITS} bits", scale)
