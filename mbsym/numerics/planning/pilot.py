"""Settings tried out on the scene itself: how wrong each is over the whole time, and what it costs.

    rho = max over quantities and times of |x_i - reference_i| / (scale_i target_i)

A setting is good enough where rho <= ``goal``.  The reference is a run of the same equations of which a coarser one
tells the error; settings of a method are found by the slope of log rho over log tolerance (or step).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isfinite, log
from typing import Any

import numpy as np

from mbsym.algebra.failures import Defect, Failure
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, Unusable, compiled_kernel
from mbsym.numerics.planning.prices import cost, cost_of_rows
from mbsym.numerics.trade.trial import Trial, trial_of

#: Where within a step, its end included, and how many places in all.
SHARES = np.array([0.17, 0.38, 0.61, 0.83, 1.0])
MOST = 20_000


def places(method: Method, dynamics: Dynamics, setting: Setting, end: float) -> Any:
    """Times from 0 to ``end`` that follow the steps of a run, ``SHARES`` of each inside it; at most about ``MOST``.

    Raises Breakdown where the run does not come to the end.
    """
    run = method.start(dynamics, setting)
    step_times = [np.zeros(1)]
    with np.errstate(all="ignore"):
        while run.time < end:
            piece = run.step(end)
            step_times.append(piece.start + SHARES * (piece.end - piece.start))
    times = np.unique(np.append(np.concatenate(step_times), end))
    times = times[times <= end]
    every = -(-len(times) // MOST)
    return times if every == 1 else np.union1d(times[::every], [end])


#: Where a setting is aimed at, and the least that is still called fit, as parts of the goal.
AIM, WASTEFUL = 0.4, 0.15

#: d log rho / d log tolerance, until it is measured.
USUAL_SLOPE = 0.9

#: Tries for each method.
TRIES = 5

#: Costs of runs that differ by less than this factor are alike: prices say no more.
ALIKE = 1.1


@dataclass
class Bench:
    """Runs of one model judged by one reference.

    ``times`` are those at which runs are compared, ``shown`` the rows that are asked for and timed (all of them among
    ``times`` unless they are very many); ``targets`` the tolerable errors of coordinates, velocities and energy, shape
    (2n + 1,), inf where any is.  ``complete`` makes of a method one that shows whole states.
    ``stick`` is the run that judges them; no step is to be longer than ``longest``.
    """

    dynamics: Dynamics
    times: Any
    shown: Any
    targets: Any
    complete: Callable[[Method], Method]
    scale: Any = None
    stick: Yardstick | None = None
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
        trajectory = trial_of(complete, self.dynamics, setting, times, scalar).whole()
        # Priced are the rows that are asked for, and no others.
        priced = trial_of(complete, self.dynamics, setting, self.shown, scalar).whole() if often else trajectory
        name, (numbers, count) = method.traits.name, priced.states.shape
        whole = cost(self.dynamics, name, scalar, priced.work) + cost_of_rows(name, priced.work, count, numbers)
        quantities = self.quantities(trajectory.states, times)
        trial = replace(trajectory, method=method, cost=whole, seconds=priced.seconds, states=quantities)
        if self.stick is None:
            return trial
        error, errors = self.compared(quantities, self.stick.trial.states)
        # What the reference itself is wrong by is added: a run that happens to be the reference has no smaller error.
        trial = replace(trial, error=error + self.stick.known, errors=errors)
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

    def compared(self, quantities: Any, other: Any) -> tuple[float, Any]:
        """(rho, errors relative to the scales) of the difference of two runs; at the rows, where one has no more."""
        if quantities.shape[1] != other.shape[1]:
            at = np.searchsorted(self.times, self._rows)
            quantities, other = (x if x.shape[1] == len(at) else x[:, at] for x in (quantities, other))
        with np.errstate(all="ignore"):
            errors = np.max(np.abs(quantities - other), axis=1).astype(float) / self.scale
        errors = np.where(np.isfinite(errors), errors, inf)
        targeted = np.isfinite(self.targets)
        return float(np.max(errors[targeted] / self.targets[targeted])), errors

    def parted(self, quantities: Any, other: Any) -> float:
        """The first time at which two runs differ by more than ``COARSE`` of a size that counts; inf where none is."""
        counts = np.isfinite(self.targets)
        with np.errstate(all="ignore"):
            apart = np.abs(quantities - other)[counts] > COARSE * np.asarray(self.scale)[counts, None]
        at = np.flatnonzero(np.any(apart, axis=0))
        return float(self.times[at[0]]) if len(at) else inf


def searched(bench: Bench, method: Method, scalar: str, start: Setting, goal: float, limit: float) -> Trial | None:
    """The coarsest setting of a method, about, that is good enough; None where none is, or it costs over ``limit``.

    ``limit`` is a cost; a method that is dearer before it is good enough is given up.
    """
    setting, preferred, last = start, None, None
    slope = usual_slope(method, start)
    for _ in range(TRIES):
        trial, broken = _tried(bench, method, scalar, setting)
        if broken and last is None and setting.tolerance is not None:  # what ends a coarse run need not end a finer one
            setting = replace(setting, tolerance=max(setting.tolerance * APART, method.traits.finest(scalar)))
            continue
        if trial is None:
            return preferred
        if trial.error <= goal and (preferred is None or _preferred(trial, preferred)):
            preferred = trial
        if trial.error <= goal and trial.error >= WASTEFUL * goal:
            return preferred
        if trial.error > goal and trial.cost > limit:
            return preferred
        slope = _slope(last, trial, slope)
        last = trial
        after = following(trial, goal, slope, bench.spacing)
        if after is None or after == setting:
            return preferred
        setting = after
    return preferred


def usual_slope(method: Method, setting: Setting) -> float:
    """d log rho / d log tolerance, or step, before it is measured."""
    return float(method.traits.order or 1) if setting.step is not None else USUAL_SLOPE


def _preferred(trial: Trial, other: Trial) -> bool:
    """The clearly cheaper; of two that cost about the same the coarser."""
    if trial.cost > ALIKE * other.cost or other.cost > ALIKE * trial.cost:
        return trial.cost < other.cost
    return trial.fineness > other.fineness


def _tried(bench: Bench, method: Method, scalar: str, setting: Setting) -> tuple[Trial | None, bool]:
    """The trial, None where there is none; whether it broke down, in no too many steps."""
    try:
        return bench.run(method, scalar, setting, often=True), False
    except Breakdown as ended:
        return None, ended.kind != Cause.STEP_LIMIT
    except (Unusable, Failure):
        return None, False
    except Exception as error:  # told of; what else there is to try is tried
        Defect.of(error)
        return None, False


def _slope(last: Trial | None, now: Trial, slope: float) -> float:
    """d log rho / d log tolerance by the last two, where they tell."""
    if last is None or not (isfinite(last.error) and isfinite(now.error) and last.error > 0 and now.error > 0):
        return slope
    apart = log(now.fineness / last.fineness)
    measured = log(now.error / last.error) / apart if apart else slope
    return measured if 0.3 * slope <= measured <= 3 * slope else slope


def following(trial: Trial, goal: float, slope: float, spacing: float) -> Setting | None:
    """The setting at which rho should be ``AIM`` of the goal; None where the arithmetic has no finer one.

    Steps of one length are no longer than the ``spacing`` of the rows, at each of which one ends.
    """
    ratio = min(max(trial.error, 1e-12 * goal), 1e12 * goal)
    factor = min(max((AIM * goal / ratio) ** (1 / slope), 1e-4), 1e4)
    if trial.setting.step is not None:
        return replace(trial.setting, step=min(_rounded(trial.setting.step * factor), spacing))
    wanted = _rounded(min(trial.fineness * factor, 1e-2))
    least = trial.method.traits.finest(trial.scalar)
    if wanted < least:
        return None if trial.fineness <= least else replace(trial.setting, tolerance=least)
    return replace(trial.setting, tolerance=wanted)


def _rounded(x: float) -> float:
    """Two digits: what is printed is what was taken."""
    return float(f"{x:.1e}")


# The run that others are judged by: the same equations so finely that its own error counts for little.
#
# Tolerances fall by ``APART`` until two runs in a row differ by so little that the finer one, whose error is that
# difference times what the last such step brought, is good enough.  Where float64 no longer brings anything, the
# arithmetic of more digits goes on.  No step is longer than a part of the whole, lest short events be stepped over
# twice.


#: The ratio of tolerances, what it brings until that is measured, and the least that counts as progress.
APART, USUAL_GAIN, LEAST_GAIN = 1e-2, 0.05, 0.5

#: The error of the reference beside what it judges.
KNOWN = 0.03

#: No step of the reference is longer than this part of the time.
PARTS = 2_000

#: The longest step falls, too: two runs whose steps it rules would else be one and the same.
SHORTER = 0.7

#: A finer run makes at most so many times the steps of the one before, of which so many are few.
MORE_STEPS, FEW = 20, 1_000

#: A run with fewer steps than so many times the least number is ruled by the longest step.
MOSTLY = 1.2

#: Rounding in extended arithmetic beside that in float64.
MORE_DIGITS = 2.0**-11

#: A difference of up to so many times the rounding may be rounding, of which finer tolerances leave all.
ROUNDED = 4.0

#: Runs further apart than this part of the motion tell nothing of how rounding counts, nor of what finer ones bring.
COARSE = 0.03

#: Where runs cost more than this, and would part before the end even if the time until then grew by so many times what
#: it has been growing by, no finer ones are made.
DEAR, GROWS = 1.0, 1.5

#: Beyond so many operations nothing is compiled in extended arithmetic.
LONG = 20_000


@dataclass(frozen=True)
class Yardstick:
    """The finest run, its states all quantities (2n + 1, m); ``known``: its own error as a part of the targets (rho).

    ``start`` is the tolerance at which rho is about what is aimed at, by the runs on the way; ``parted`` the time from
    which on it differs by more than ``COARSE`` from the one before, and nothing is known: inf where it nowhere does.
    """

    trial: Trial
    known: float
    start: float
    parted: float = inf


def yardstick(bench: Bench, method: Method, tolerance: float, goal: float, most: int = 10_000_000) -> Yardstick:
    """A reference for settings that are to reach rho <= ``goal``; the finest that there is where none is good enough.

    Raises Breakdown where no run comes to the end in ``most`` steps.
    """
    longest = float(bench.times[-1]) / PARTS
    if bench.longest is not None:  # a longer one would be cut to it in every run, and two of them be one run
        longest = min(longest, bench.longest)
    scalar, last, gain, rounding, parted = FLOAT64, inf, USUAL_GAIN, 0.0, 0.0
    # An error is known by a finer run: the first one leaves room for that.
    tolerance = max(tolerance, method.traits.finest(scalar) / APART**2)
    finest = method.traits.finest(scalar)
    while True:
        try:
            before = bench.run(method, scalar, Setting(tolerance, None, most, longest))
            break
        except Breakdown as ended:  # what ends a coarse run, as a switch that it passes, need not end the motion
            if ended.kind == Cause.STEP_LIMIT or tolerance * APART < finest / APART:
                raise
            tolerance *= APART
    best = Yardstick(before, inf, _rounded(tolerance))
    while True:
        least = method.traits.finest(scalar)
        stalled = last < inf and gain > LEAST_GAIN and last * bench.finest_target < COARSE
        if stalled or tolerance <= 2 * least:
            if scalar == EXTENDED or not _extended(bench, method):
                return best
            # Whatever of the last difference is rounding, grown along the motion, is smaller by the ratio of roundings.
            scalar, last, rounding = EXTENDED, inf, last * MORE_DIGITS if last < inf else inf
            least = method.traits.finest(scalar)
        coarser, tolerance = tolerance, max(tolerance * APART, least)
        longest *= SHORTER
        limit = min(most, MORE_STEPS * max(before.work.steps, FEW))
        try:
            now = bench.run(method, scalar, Setting(tolerance, None, limit, longest))
        except Breakdown as ended:  # its steps fall below what rounding lets them be
            if ended.kind != Cause.STEP_LIMIT:
                raise
            if best.known < inf or limit == most or scalar == EXTENDED or not _extended(bench, method):
                return best
            scalar, tolerance = EXTENDED, coarser  # in which there is room for them
            continue
        apart, _ = bench.compared(before.states, now.states)
        earlier, parted = parted, bench.parted(before.states, now.states)
        if before.scalar != scalar:  # the initial state was rounded alike in all runs before: it shows here first
            rounding = max(rounding, apart * MORE_DIGITS)
        gain = apart / last if 0 < last < inf else USUAL_GAIN
        less = max(min(gain, USUAL_GAIN), _ruled(now, longest, bench)) if gain <= LEAST_GAIN else 1.0
        known = max(apart * less, rounding + min(apart, ROUNDED * rounding))
        known = max(known, _roundings(scalar) / bench.finest_target) if parted == inf else inf
        if known <= best.known:
            factor = (AIM * goal / apart) ** (1 / USUAL_SLOPE) if apart > 0 else 1.0
            best = Yardstick(now, known, _rounded(max(coarser * min(factor, 1e3), least)), parted)
        if known <= KNOWN * goal or (earlier > 0 and _hopeless(bench, method, now, earlier, parted)):
            return best
        before, last = now, apart


def _hopeless(bench: Bench, method: Method, now: Trial, earlier: float, parted: float) -> bool:
    """Whether runs part before the end even at the finest tolerance, as times grew by the last ``APART``.

    Neighbouring motions that part as exp(lambda t) do so later by log(1/APART)/lambda: by as much each time.
    """
    finest = min(method.traits.finest(x) for x in (FLOAT64, EXTENDED) if x == FLOAT64 or _extended(bench, method))
    more = max(0.0, log(now.fineness / finest) / -log(APART))
    return now.cost > DEAR and parted + GROWS * max(0.0, parted - earlier) * more < float(bench.times[-1])


def _ruled(trial: Trial, longest: float, bench: Bench) -> float:
    """What is left of the last difference where the longest step rules a run, not its tolerance; else 0.

    With steps h and s h, s = ``SHORTER``, and errors C h^p: the finer one has s^p/(1 - s^p) of the difference.
    """
    order = trial.method.traits.order or 1
    if trial.work.steps * longest < MOSTLY * float(bench.times[-1]):
        return float(SHORTER**order / (1 - SHORTER**order))
    return 0.0


def _roundings(scalar: str) -> float:
    """The rounding of one number: no run is better."""
    return float(np.finfo(np.longdouble if scalar == EXTENDED else float).eps) / 2


def _extended(bench: Bench, method: Method) -> bool:
    able = EXTENDED in method.traits.scalars and available(EXTENDED)
    return able and bench.dynamics.right_hand_side.operations <= LONG
