"""Integration of one scenario: a trajectory at given times, with its energy and what went wrong.

A run that breaks down, or is interrupted, keeps what it has: the trajectory ends there and says why.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.methods.interface import (
    BLOW_UP,
    LARGEST,
    SINGULAR,
    STEP_LIMIT,
    STOPPED,
    STUCK,
    UNDEFINED,
    Breakdown,
    Method,
    Run,
    Setting,
    Work,
)
from mbsym.numerics.methods.kept import compiled_kernel
from mbsym.numerics.methods.passed import Passed, met_by, up_to

#: No initial state is beyond this: the world measures 1e27 metres.
LARGEST_START = 1e30

#: Rows are filled in chunks of so many seconds, so that progress is seen and Ctrl-C keeps what there is; and not more
#: of them at once.
CHUNK, MOST_AT_ONCE = 0.2, 1 << 16

#: A pivot of M that has become so much smaller than it was means that M is singular for practical purposes.
SINGULAR_PIVOT = 1e-11

#: The same for an initial state beside its neighbours: sin(x)**2 where x is zero but for rounding.
SINGULAR_AT_ONCE = 1e-24

#: How far ahead, as parts of the state's size, rates that are no numbers explain why a run could not go on.
AHEAD = (1e-12, 1e-9, 1e-6, 1e-3, 3e-2)


@dataclass(frozen=True)
class Trajectory:
    """States at ``times`` (m of them): ``states`` has shape (2n, m), rows in the order (q, q').

    ``energy`` is T - U, ``generalized_energy`` h = T2 - T0 - U (one and the same where nothing is prescribed),
    ``change`` h(t) - h(0) in all its digits, and ``kinetic`` the kinetic energy that it is measured by, each of shape
    (m,).  ``breakdown`` says why the trajectory ends before the last time asked for; ``interrupted`` that the user
    stopped it.  ``between`` is the largest kinetic energy between samples that are few: a motion sampled at whole
    periods seems to rest.  ``passed`` is what is not smooth, or narrow, on the way; None where there is no such thing.
    ``least_pivot`` is how far a pivot of M fell, and when (see there); None where nobody has looked.
    """

    system: System
    method: str
    setting: Setting
    times: Any
    states: Any
    energy: Any
    generalized_energy: Any
    change: Any
    kinetic: Any
    work: Work
    seconds: float
    breakdown: Breakdown | None = None
    interrupted: bool = False
    between: float = 0.0
    passed: Passed | None = None
    least_pivot: tuple[float, float] | None = None

    @property
    def largest_kinetic(self) -> float:
        """The largest kinetic energy at the samples, or between them where they are few."""
        known = np.asarray(self.kinetic, dtype=float)
        return max(self.between, float(np.max(np.abs(known[np.isfinite(known)]), initial=0.0)))

    @property
    def energy_scale(self) -> float:
        """What changes of energy are measured by: the largest kinetic energy; |h(0)| where nothing moves, else 1."""
        return self.largest_kinetic or abs(float(self.generalized_energy[0])) or 1.0

    @property
    def drift(self) -> Any:
        """(h - h(0)) / ``energy_scale``."""
        return self.change / self.energy_scale

    @property
    def whole(self) -> bool:
        """Whether it reaches the last time asked for."""
        return self.breakdown is None and not self.interrupted


@dataclass(frozen=True)
class Integrated:
    """States (2n, m) at ``times``, what they cost, and why they end early, if they do."""

    times: Any
    states: Any
    work: Work
    seconds: float
    breakdown: Breakdown | None
    interrupted: bool
    passed: Passed | None = None

    @property
    def whole(self) -> bool:
        """Whether they reach the last time asked for."""
        return self.breakdown is None and not self.interrupted


def simulate(
    dynamics: Dynamics,
    method: Method,
    setting: Setting,
    times: Sequence[float],
    scalar: str = "float64",
    watch: Callable[[float], None] = lambda t: None,
    before: Any = None,
) -> Trajectory:
    """x(t) for t in ``times`` (increasing, the first is 0) by a method, with its energies.

    ``watch`` is told the time reached; ``before`` are states (2n, k) at the first k times that are known already, of
    which the last is where the run begins.  Never raises Breakdown or KeyboardInterrupt: both end the trajectory early.
    Raises Unusable where the method does not apply to the system.
    """
    run = integrated(dynamics, method, setting, times, scalar, watch, before)
    energies = _energies(dynamics, np.vstack([run.times, run.states]), scalar)
    defined = np.all([np.isfinite(row.astype(float)) for row in energies], axis=0)
    if not np.all(defined):
        run, first = _cut(run, int(np.argmin(defined))), max(1, int(np.argmin(defined)))
        energies = tuple(row[:first] for row in energies)
    energy, generalized, change, kinetic = energies
    return Trajectory(
        system=dynamics.system,
        method=method.traits.name,
        setting=setting,
        times=run.times,
        states=run.states,
        energy=energy,
        generalized_energy=generalized,
        change=change,
        kinetic=kinetic,
        work=run.work,
        seconds=run.seconds,
        breakdown=run.breakdown,
        interrupted=run.interrupted,
        passed=run.passed,
    )


def integrated(
    dynamics: Dynamics,
    method: Method,
    setting: Setting,
    times: Sequence[float],
    scalar: str = "float64",
    watch: Callable[[float], None] = lambda t: None,
    before: Any = None,
) -> Integrated:
    """The states alone; see ``simulate``."""
    work, breakdown, interrupted = Work(), None, False
    run: Run | None = None
    initial = np.array([float(x) for x in dynamics.scenario.state])
    known = initial[:, None] if before is None else before
    # Room for all states is taken at once, and only touched as they come; one more for the state of a breakdown.
    states = np.empty((len(initial), len(times) + 1), dtype=np.longdouble if scalar == EXTENDED else float)
    reached = known.shape[1]
    states[:, :reached] = known
    begin = float(times[reached - 1])
    started = time.perf_counter()
    try:
        found = _at_once(dynamics, known[:, -1].astype(float), begin)
        if found is not None:
            raise found
        run = method.start(dynamics, setting, scalar, None if before is None else known[:, -1], begin)
        work = run.work
        started = time.perf_counter()
        states[:, reached - 1] = run.state
        for rows in chunks(run, np.asarray(times, dtype=float)[reached:], _bound(initial)):
            states[:, reached : reached + rows.shape[1]] = rows
            reached += rows.shape[1]
            watch(float(times[reached - 1]))
    except Breakdown as trouble:
        if trouble.filled is not None:
            more = trouble.filled.shape[1]
            states[:, reached : reached + more] = trouble.filled
            reached += more
        past = np.vstack([np.asarray(times[:reached], dtype=float), states[:, :reached].astype(float)])
        breakdown = diagnosed(dynamics, trouble, past)
    except KeyboardInterrupt:
        interrupted = True
    seconds = max(0.0, time.perf_counter() - started - work.compiling)
    kept = np.array(times[:reached], dtype=float)
    if breakdown is not None and breakdown.kind in (STEP_LIMIT, STUCK, STOPPED) and breakdown.time > kept[-1]:
        # The state in which it stopped is as good as any other: with rows far apart it may be all there is.
        states[:, reached], kept = breakdown.state, np.append(kept, breakdown.time)
        reached += 1
    matrix = np.ascontiguousarray(states[:, :reached])
    return Integrated(kept, matrix, replace(work), seconds, breakdown, interrupted, up_to(met_by(run), float(kept[-1])))


def chunks(run: Run, times: Any, bound: float) -> Iterator[Any]:
    """The states (2n, m) at ``times``, as many of them at once as take about ``CHUNK`` seconds.

    Raises Breakdown, with the rows since the last chunk, where the run cannot go on or a row is beyond ``bound``.
    """
    done, count = 0, 1
    while done < len(times):
        at = times[done : done + count]
        started = time.perf_counter()
        try:
            rows = run.fill(at)
        except Breakdown as found:
            _checked(found.filled, at, bound)
            raise
        _checked(rows, at, bound)
        yield rows
        done += len(at)
        spent = time.perf_counter() - started
        count = min(MOST_AT_ONCE, 4 * count) if spent < CHUNK / 4 else max(1, count // 2) if spent > CHUNK else count


def _checked(rows: Any, times: Any, bound: float) -> None:
    """Raises Breakdown at the first row that is beyond the bound, or no number."""
    with np.errstate(all="ignore"):
        fine = np.all(np.abs(rows) < bound, axis=0)
    if np.all(fine):
        return
    first = int(np.argmin(fine))
    state = rows[:, first]
    bad = "is not a number" if np.any(np.isnan(state)) else f"is beyond {bound:.0e}"
    message = f"a coordinate or velocity {bad}"
    raise Breakdown(BLOW_UP, message, float(times[first]), np.array(state, dtype=float), rows[:, :first])


def _cut(run: Integrated, first: int) -> Integrated:
    """What is left of a run whose energy has no value from a sample on: it went where the model says nothing."""
    message = "the energy is no real number from here on: a root or a logarithm has left its domain"
    ended = Breakdown(UNDEFINED, message, float(run.times[first]), run.states[:, first].astype(float))
    kept = max(1, first)
    return replace(run, times=run.times[:kept], states=run.states[:, :kept], breakdown=ended)


def _energies(dynamics: Dynamics, points: Any, scalar: str) -> tuple[Any, Any, Any, Any]:
    """(T - U, h, h - h(0), T) at points (t, q, q') in columns."""
    kind = EXTENDED if scalar == EXTENDED else FLOAT64
    with np.errstate(all="ignore"):
        relative, kinetic = compiled_kernel(dynamics, "relative_energy", kind)(points)
        change = relative - relative[0]
        if dynamics.natural:
            return relative, relative, change, kinetic
        energy, generalized = compiled_kernel(dynamics, "energies", kind)(points)
        plain = generalized - generalized[0]
        # Relative to a frame that falls h may differ by a function of time; where it does, the plain difference counts.
        rounding = 1e3 * np.finfo(float).eps * np.max(np.abs(np.vstack([energy, generalized, kinetic])), initial=0.0)
        alike = np.abs(plain - change) <= 1e-6 * np.max(np.abs(kinetic), initial=0.0) + rounding
    return energy, generalized, change if np.all(alike) else plain, kinetic


def _bound(initial: Any) -> float:
    """Where a run is ended: sizes of 1e12, and as many times those of the initial state (orbits in metres)."""
    return LARGEST * max(1.0, float(np.max(np.abs(initial), initial=0.0)))


def _at_once(dynamics: Dynamics, initial: Any, begin: float = 0.0) -> Breakdown | None:
    """What is wrong with the initial state itself: there the right-hand side must exist."""
    if not np.all(np.abs(initial) < LARGEST_START):
        return Breakdown(BLOW_UP, f"the initial state itself is beyond {LARGEST_START:g}", begin, initial)
    point = np.concatenate(([begin], initial))
    with np.errstate(all="ignore"):
        rates = compiled_kernel(dynamics, "right_hand_side")(point)
    singular = _vanishing(dynamics, begin, initial, _neighbours(initial, begin), SINGULAR_AT_ONCE)
    if singular:
        return Breakdown(SINGULAR, singular, begin, initial)
    if np.all(np.isfinite(rates)):
        return None
    if np.any(np.isnan(rates)):
        return Breakdown(UNDEFINED, "the accelerations at the initial state are no numbers", begin, initial)
    return Breakdown(BLOW_UP, "the accelerations at the initial state are not finite", begin, initial)


def _neighbours(state: Any, time: float) -> Any:
    """(t, q, q') in columns: some states not far from a state, the same ones every time."""
    n = len(state)
    moved = np.sin(np.outer(np.arange(1, n + 1), np.arange(1, 5)))  # any numbers between -1 and 1
    return np.vstack([np.full(4, time), state[:, None] + 0.1 * moved * (1 + np.abs(state[:, None]))])


def diagnosed(dynamics: Dynamics, found: Breakdown, past: Any) -> Breakdown:
    """A vanishing step at a blow-up, and either of them where the mass matrix is singular, are called what they are.

    ``past`` holds earlier (t, q, q') in columns: a pivot is small compared with what it was, whatever its units.
    """
    if found.kind not in (BLOW_UP, STUCK):
        return found
    state = np.asarray(found.state, dtype=float)
    message = _vanishing(dynamics, found.time, state, past, SINGULAR_PIVOT)
    if message:
        return Breakdown(SINGULAR, message, found.time, found.state)
    if _undefined(dynamics, found.time, state):
        message = "the equations have no real value beyond this state: a root or a logarithm leaves its domain"
        return Breakdown(UNDEFINED, message, found.time, found.state)
    bound = _bound(past[1:, 0])
    if not np.all(np.abs(state) < bound):
        return Breakdown(BLOW_UP, f"a coordinate or velocity is beyond {bound:.0e}", found.time, found.state)
    return found


def _undefined(dynamics: Dynamics, t: float, state: Any) -> bool:
    """Whether the rates are no numbers (infinite ones are) in a state, or a little ahead of it."""
    if not np.all(np.isfinite(state)):
        return False
    rhs = compiled_kernel(dynamics, "right_hand_side")
    with np.errstate(all="ignore"):
        rates = rhs(np.concatenate(([t], state)))
        if np.any(np.isnan(rates)):
            return True
        speed = float(np.max(np.abs(rates), initial=0.0))
        if not 0 < speed < LARGEST:
            return False
        steps = np.array(AHEAD) * (1 + float(np.max(np.abs(state)))) / speed
        return bool(np.any(np.isnan(rhs(np.vstack([t + steps, state[:, None] + np.outer(rates, steps)])))))


def _vanishing(dynamics: Dynamics, t: float, state: Any, others: Any, least: float) -> str:
    """Which pivot of M vanishes at a state, beside its values at other states, as a sentence; empty where none does."""
    if not np.all(np.isfinite(state)):
        return ""
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(np.concatenate(([t], state))))
        if not np.all(np.isfinite(pivots)):
            return "M cannot be factorised"
        elsewhere = np.abs(compiled_kernel(dynamics, "pivots")(others))
        usual = np.median(np.where(np.isfinite(elsewhere), elsewhere, 0.0), axis=1)
        ratios = np.where(usual > 0, pivots / usual, np.where(pivots > 0, np.inf, 0.0))
    ratio = float(np.min(ratios))
    return f"a pivot of M is {ratio:.1e} of its usual size" if ratio < least else ""


def least_pivot(dynamics: Dynamics, found: Trajectory) -> tuple[float, float]:
    """(ratio, t): how far a pivot of M fell below what it was at the start, and when.

    M loses about -log10(ratio) digits there; 1e-8 and less means that the motion passes by a singularity of the chosen
    coordinates (or of the model).
    """
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(np.vstack([found.times, found.states.astype(float)])))
        ratios = pivots / pivots[:, :1]
    lowest = np.min(np.where(np.isfinite(ratios), ratios, 0.0), axis=0)
    place = int(np.argmin(lowest))
    return float(lowest[place]), float(found.times[place])
