"""Settings tried out on the scene itself: how wrong each is over the whole time, and what it costs.

    rho = max over quantities and times of |x_i - reference_i| / (scale_i target_i)

A setting is good enough where rho <= ``goal``.  The reference is a run of the same equations of which a coarser one
tells the error; settings of a method are found by the slope of log rho over log tolerance (or step).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isfinite, log
from typing import Any

import numpy as np

from mbsym.algebra.failures import Defect, Failure
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Method, Setting, Unusable, Work
from mbsym.numerics.methods.kept import compiled_kernel
from mbsym.numerics.planning.prices import cost, cost_of_rows
from mbsym.numerics.rows import rows

#: Where a setting is aimed at, and the least that is still called fit, as parts of the goal.
AIM, WASTEFUL = 0.4, 0.15

#: d log rho / d log tolerance, until it is measured.
USUAL_SLOPE = 0.9

#: Tries for each method.
TRIES = 5

#: Costs of runs that differ by less than this factor are alike: prices say no more.
ALIKE = 1.1

#: The finest tolerances that the compiled methods take: some roundings; and that SciPy's do.
FINEST = {FLOAT32: 5e-7, FLOAT64: 1e-15, EXTENDED: 5e-19}
FINEST_OF_SCIPY = 2.5e-14


def finest(method: Method, scalar: str) -> float:
    """The least tolerance that is not silently taken for a larger one."""
    own = method.traits.name in ("dop853", "rk45", "taylor")
    return FINEST[scalar] if own else max(FINEST[scalar], FINEST_OF_SCIPY)


@dataclass(frozen=True)
class Trial:
    """One setting and what came of it: ``errors`` (k,) relative to the scales.

    ``cost`` is that of its counted work (``planning.prices``), by which settings are chosen; ``seconds`` of the
    processor are told, and decide nothing.
    """

    method: Method
    scalar: str
    setting: Setting
    ratio: float
    errors: Any
    seconds: float
    work: Work
    cost: float
    states: Any = None

    @property
    def label(self) -> str:
        """``dop853 1e-09``, ``rk4 h=0.001, float32``."""
        arithmetic = "" if self.scalar == FLOAT64 else f", {self.scalar}"
        return f"{self.method.traits.name} {self.fineness:.3g}{arithmetic}"

    @property
    def fineness(self) -> float:
        """The tolerance, or the step."""
        found = self.setting.tolerance if self.setting.step is None else self.setting.step
        assert found is not None
        return found


@dataclass
class Bench:
    """Runs of one model judged by one reference.

    ``times`` are those at which runs are compared, ``shown`` the rows that are asked for and timed (all of them among
    ``times`` unless they are very many); ``targets`` the tolerable errors of coordinates, velocities and energy, shape
    (2n + 1,), inf where any is.  ``complete`` makes of a method one that shows whole states.
    ``reference`` holds the quantities of a run whose own error is ``known`` (rho); no step is to be longer than
    ``longest``.
    """

    dynamics: Dynamics
    times: Any
    shown: Any
    targets: Any
    complete: Callable[[Method], Method]
    scale: Any = None
    reference: Any = None
    known: float = 0.0
    longest: float | None = None
    trials: list[Trial] = field(default_factory=list)

    @property
    def spacing(self) -> float:
        """The longest time between two rows."""
        return float(np.max(np.diff(self.shown)))

    @property
    def finest_target(self) -> float:
        """The smallest tolerable error."""
        return float(np.min(self.targets))

    def run(self, method: Method, scalar: str, setting: Setting, often: bool = False) -> Trial:
        """A run, judged where there is a reference.  Raises Breakdown, Unusable."""
        complete = self.complete(method)
        if self.longest is not None:
            setting = replace(setting, longest=min(setting.longest or self.longest, self.longest))
        # Steps of one length end at every row: between rows there is nothing to compare.
        times = self._rows if method.traits.fixed else self.times
        found = rows(complete, self.dynamics, setting, times, scalar)
        priced = found
        if often:  # the rows that are asked for, and no others
            priced = rows(complete, self.dynamics, setting, self.shown, scalar)
        name, (numbers, count) = method.traits.name, priced.states.shape
        whole = cost(self.dynamics, name, scalar, priced.work) + cost_of_rows(name, priced.work, count, numbers)
        quantities = self.quantities(found.states, times)
        ratio, errors = self.compared(quantities, self.reference) if self.reference is not None else (inf, None)
        # What the reference itself is wrong by is added: a run that happens to be the reference has no smaller error.
        ratio += self.known
        trial = Trial(method, scalar, setting, ratio, errors, priced.seconds, found.work, whole, quantities)
        if self.reference is not None:
            self.trials.append(replace(trial, states=None))
        return trial

    @cached_property
    def _rows(self) -> Any:
        return np.intersect1d(self.times, self.shown)

    def quantities(self, states: Any, times: Any) -> Any:
        """Coordinates, velocities and energy at the times, shape (2n + 1, m)."""
        kind = EXTENDED if states.dtype == np.longdouble else FLOAT64
        energy = np.zeros((1, states.shape[1]), dtype=states.dtype)
        if isfinite(self.targets[-1]):
            energy = compiled_kernel(self.dynamics, "relative_energy", kind)(np.vstack([times, states]))[:1]
        return np.vstack([states, energy])

    def compared(self, one: Any, other: Any) -> tuple[float, Any]:
        """(rho, errors relative to the scales) of the difference of two runs; at the rows, where one has no more."""
        if one.shape[1] != other.shape[1]:
            at = np.searchsorted(self.times, self._rows)
            one, other = (x if x.shape[1] == len(at) else x[:, at] for x in (one, other))
        with np.errstate(all="ignore"):
            errors = np.max(np.abs(one - other), axis=1).astype(float) / self.scale
        errors = np.where(np.isfinite(errors), errors, inf)
        asked = np.isfinite(self.targets)
        return float(np.max(errors[asked] / self.targets[asked])), errors


def searched(bench: Bench, method: Method, scalar: str, start: Setting, goal: float, limit: float) -> Trial | None:
    """The coarsest setting of a method, about, that is good enough; None where none is, or it costs over ``limit``.

    ``limit`` is a cost; a method that is dearer before it is good enough is given up.
    """
    setting, found, last = start, None, None
    slope = float(method.traits.order or 1) if start.step is not None else USUAL_SLOPE
    for _ in range(TRIES):
        trial = _tried(bench, method, scalar, setting)
        if trial is None:
            return found
        if trial.ratio <= goal and (found is None or _preferred(trial, found)):
            found = trial
        if trial.ratio <= goal and trial.ratio >= WASTEFUL * goal:
            return found
        if trial.ratio > goal and trial.cost > limit:
            return found
        slope = _slope(last, trial, slope)
        last = trial
        following = _next(trial, goal, slope, bench.spacing)
        if following is None or following == setting:
            return found
        setting = following
    return found


def _preferred(one: Trial, other: Trial) -> bool:
    """The clearly cheaper; of two that cost about the same the coarser."""
    if one.cost > ALIKE * other.cost or other.cost > ALIKE * one.cost:
        return one.cost < other.cost
    return one.fineness > other.fineness


def _tried(bench: Bench, method: Method, scalar: str, setting: Setting) -> Trial | None:
    try:
        return bench.run(method, scalar, setting, often=True)
    except (Breakdown, Unusable, Failure):
        return None
    except Exception as error:  # told of; what else there is to try is tried
        Defect.of(error)
        return None


def _slope(last: Trial | None, now: Trial, slope: float) -> float:
    """d log rho / d log tolerance by the last two, where they tell."""
    if last is None or not (isfinite(last.ratio) and isfinite(now.ratio) and last.ratio > 0 and now.ratio > 0):
        return slope
    apart = log(now.fineness / last.fineness)
    measured = log(now.ratio / last.ratio) / apart if apart else slope
    return measured if 0.3 * slope <= measured <= 3 * slope else slope


def _next(trial: Trial, goal: float, slope: float, spacing: float) -> Setting | None:
    """The setting at which rho should be ``AIM`` of the goal; None where the arithmetic has no finer one.

    Steps of one length are no longer than the ``spacing`` of the rows, at each of which one ends.
    """
    ratio = min(max(trial.ratio, 1e-12 * goal), 1e12 * goal)
    factor = min(max((AIM * goal / ratio) ** (1 / slope), 1e-4), 1e4)
    if trial.setting.step is not None:
        return replace(trial.setting, step=min(_round(trial.setting.step * factor), spacing))
    wanted = _round(min(trial.fineness * factor, 1e-2))
    least = finest(trial.method, trial.scalar)
    if wanted < least:
        return None if trial.fineness <= least else replace(trial.setting, tolerance=least)
    return replace(trial.setting, tolerance=wanted)


def _round(x: float) -> float:
    """Two digits: what is printed is what was taken."""
    return float(f"{x:.1e}")


def best(trials: Sequence[Trial]) -> Trial | None:
    """The cheapest."""
    return min(trials, key=lambda one: one.cost, default=None)
