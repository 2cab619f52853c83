"""Integration of one scenario: a trajectory at given times, with its energy and what went wrong.

A run that breaks down, or is interrupted, keeps what it has: the trajectory ends there and says why.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.precise import enclosures
from mbsym.numerics.methods.interface import (
    BEYOND,
    Breakdown,
    Cause,
    Method,
    Passed,
    Run,
    Setting,
    Work,
    compiled_kernel,
    met_by,
    up_to,
    within_bound,
)
from mbsym.numerics.methods.magnitudes import OUTGROWN, about
from mbsym.numerics.planning.prices import Meter
from mbsym.numerics.scenario import PRECISION
from mbsym.numerics.states import StateDynamics

if TYPE_CHECKING:
    from mbsym.numerics.streamed import Table

#: Rates below this part of those that the scene knows are roundings of an initial state of ``PRECISION`` bits.
NO_RATE = 2.0**-160

#: Larger rates are none, whatever the units: sizes of the scene are not looked for.
LARGEST_RESIDUE = 1e-30

#: Rows are filled in chunks that cost about so much (``planning.prices``), so that progress is seen and Ctrl-C
#: keeps what there is; and not more of them at once.
CHUNK, MOST_AT_ONCE = 0.2, 1 << 16


@dataclass(frozen=True, kw_only=True)
class Ending:
    """What a run cost, and why it ended before the last time asked for, if it did.

    ``interrupted``: the user stopped it.  ``passed`` is what is not smooth, or narrow, on the way; None where there is
    no such thing.
    """

    work: Work
    seconds: float
    breakdown: Breakdown | None = None
    interrupted: bool = False
    passed: Passed | None = None

    @property
    def whole(self) -> bool:
        """Whether the last time asked for is reached."""
        return self.breakdown is None and not self.interrupted


@dataclass(frozen=True, kw_only=True)
class Integrated(Ending):
    """``states`` (2n, m) at ``times`` (m of them), rows in the order (q, q')."""

    times: Any
    states: Any


@dataclass(frozen=True, kw_only=True)
class Trajectory(Integrated):
    """The states of a run with their energies.

    ``energy`` is T - U, ``generalized_energy`` h = T2 - T0 - U (one and the same where nothing is prescribed),
    ``change`` h(t) - h(0) in all its digits, and ``kinetic`` the kinetic energy that it is measured by, each of shape
    (m,).  ``between`` is the largest kinetic energy between samples that are few: a motion sampled at whole periods
    seems to rest.  ``least_pivot`` is how far a pivot of M fell, and when (see there); None where nobody has looked.
    ``rounding``: a kinetic energy that is nothing else (``kinetic_rounding``).
    ``table`` has all rows, where these are some of very many; ``between`` is the largest kinetic energy of all then.
    """

    system: System
    method: str
    setting: Setting
    energy: Any
    generalized_energy: Any
    change: Any
    kinetic: Any
    between: float = 0.0
    least_pivot: tuple[float, float] | None = None
    rounding: float = 0.0
    table: Table | None = None

    @property
    def samples(self) -> int:
        """How many rows there are, those in the table included."""
        return len(self.times) if self.table is None else self.table.count

    @property
    def largest_kinetic(self) -> float:
        """The largest kinetic energy at the samples, or between them where they are few; 0 where it is rounding."""
        known = np.asarray(self.kinetic, dtype=float)
        largest = max(self.between, float(np.max(np.abs(known[np.isfinite(known)]), initial=0.0)))
        return largest if largest > self.rounding else 0.0

    @property
    def energy_scale(self) -> float:
        """What changes of energy are measured by: the largest kinetic energy; |h(0)| where nothing moves, else 1."""
        return self.largest_kinetic or abs(float(self.generalized_energy[0])) or 1.0

    @property
    def drift(self) -> Any:
        """(h - h(0)) / ``energy_scale``."""
        return self.change / self.energy_scale


#: What helps whoever begins in an equilibrium.
BEGIN_BESIDE = Message("begin beside it ('initial', --set) to see the system move")


class Rests(Failure):
    """What was asked for is about a motion, and the initial state is an equilibrium."""

    code = "rests"

    def __init__(self) -> None:
        super().__init__("the initial state is an equilibrium, in which the exact motion rests", remedy=BEGIN_BESIDE)


def begins_in_equilibrium(dynamics: Dynamics) -> bool:
    """Whether q' = 0 and q'' = 0 at the initial state, at every time: an exact motion never leaves it.

    Seen in ``PRECISION`` bits, of equations without the time and without switches, whose slopes are finite there: on
    Norton's dome, x'' = sqrt(x), a motion may leave what rests.
    """
    state = dynamics.scenario.state
    if any(state[dynamics.dimension - len(dynamics.system.velocities) :]) or dynamics.switches.outputs:
        return False
    try:
        code = dynamics.right_hand_side
        if any(code.program.instructions[n].payload == "t" for n in code.program.live(code.outputs)):
            return False
        place = Fraction(0), *state
        rates = [float(abs(x).upper()) for x in enclosures(code, place, PRECISION + 64)]
        if max(rates) > LARGEST_RESIDUE:
            return False
        if not all(x.is_finite() for x in enclosures(dynamics.jacobian, place, PRECISION + 64)):
            return False
        usual = about(dynamics, 0.0, [float(x) for x in state])
    except Failure:
        return False
    sizes = usual.sizes[:, 0] / float(usual.times[0])
    return all(rate <= NO_RATE * size for rate, size in zip(rates, sizes, strict=True))


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
    energies = told_energies(dynamics, raw_energies(dynamics, np.vstack([run.times, run.states]), scalar))
    defined = np.all([np.isfinite(row.astype(float)) for row in energies], axis=0)
    if not np.all(defined):
        run, first = _cut(run, int(np.argmin(defined))), max(1, int(np.argmin(defined)))
        energies = tuple(row[:first] for row in energies)
    energy, generalized, change, kinetic = energies
    return Trajectory(
        system=dynamics.system,
        method=method.traits.name,
        setting=setting,
        energy=energy,
        generalized_energy=generalized,
        change=change,
        kinetic=kinetic,
        **vars(run),
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
    moments = np.asarray(times, dtype=float)
    rows = _InMemory(len(dynamics.scenario.state), len(moments), scalar)
    ending = followed(dynamics, method, setting, moments, rows, scalar, watch, before)
    states = np.ascontiguousarray(rows.states[:, : rows.count])
    recorded = rows.times[: rows.count].copy()
    passed = up_to(ending.passed, float(recorded[-1]))
    return Integrated(times=recorded, states=states, **(vars(ending) | {"passed": passed}))


class Recorder(Protocol):
    """Where the rows of a run go."""

    @property
    def count(self) -> int:
        """How many there are."""

    def keep(self, times: Any, rows: Any) -> None:
        """The next rows, of shape (2n, k).  Raises Breakdown at one that the model says nothing about."""

    def past(self) -> Any:
        """(t, q, q') in columns, of rows kept so far; the first of them is the first."""


class _InMemory:
    """Arrays: room for all rows is taken at once, and only touched as they come; one more for that of a breakdown."""

    def __init__(self, size: int, most: int, scalar: str) -> None:
        self.states = np.empty((size, most + 1), dtype=np.longdouble if scalar == EXTENDED else float)
        self.times = np.empty(most + 1)
        self.count = 0

    def keep(self, times: Any, rows: Any) -> None:
        end = self.count + rows.shape[1]
        self.times[self.count : end], self.states[:, self.count : end] = times, rows
        self.count = end

    def past(self) -> Any:
        return np.vstack([self.times[: self.count], self.states[:, : self.count].astype(float)])


def followed(
    dynamics: Dynamics,
    method: Method,
    setting: Setting,
    times: Any,
    rows: Recorder,
    scalar: str,
    watch: Callable[[float], None],
    before: Any = None,
    most: int = MOST_AT_ONCE,
) -> Ending:
    """Hands the states at ``times`` (an array, or what is indexed like one) to ``rows``, ``most`` of them at once.

    See ``simulate`` for the rest.
    """
    work, breakdown, interrupted = Work(), None, False
    run: Run | None = None
    initial = np.array([float(x) for x in dynamics.scenario.state])
    known = initial[:, None] if before is None else before
    done = known.shape[1]
    begin, start = float(times[done - 1]), np.append(float(times[0]), known[:, 0].astype(float))
    started = time.perf_counter()
    try:
        first = known[:, -1]
        rows.keep(times[: done - 1], known[:, :-1])
        try:
            initial_breakdown = wrong_at_once(dynamics, known[:, -1].astype(float), begin)
            if initial_breakdown is not None:
                raise initial_breakdown
            run = method.start(dynamics, setting, scalar, None if before is None else known[:, -1], begin)
            work, first = run.work, run.state
        finally:
            rows.keep(np.array([begin]), np.asarray(first)[:, None])
        started = time.perf_counter()
        meter = Meter(dynamics)
        meter.start(((run, method.traits.name, scalar),))
        for more in chunks(run, times, meter, done, most):
            escaped = _escaped(dynamics, start, times[rows.count : rows.count + more.shape[1]], more)
            if escaped is not None:
                raise escaped
            rows.keep(times[rows.count : rows.count + more.shape[1]], more)
            watch(float(times[rows.count - 1]))
    except Breakdown as trouble:
        breakdown = _last_rows(dynamics, trouble, rows, times)
    except KeyboardInterrupt:
        interrupted = True
    seconds = max(0.0, time.perf_counter() - started - work.compiling)
    return Ending(work=replace(work), seconds=seconds, breakdown=breakdown, interrupted=interrupted, passed=met_by(run))


def _last_rows(dynamics: Dynamics, trouble: Breakdown, rows: Recorder, times: Any) -> Breakdown:
    """Keeps the rows before a breakdown, and says what it is."""
    try:
        if trouble.filled is not None and trouble.filled.shape[1]:
            at = times[rows.count : rows.count + trouble.filled.shape[1]]
            trouble = _escaped(dynamics, rows.past()[:, 0], at, trouble.filled) or trouble
        if trouble.filled is not None:
            rows.keep(times[rows.count : rows.count + trouble.filled.shape[1]], trouble.filled)
        past = rows.past()
        last_rows = diagnosed(dynamics, trouble, past)
        if (
            last_rows.kind
            in (Cause.STEP_LIMIT, Cause.STUCK, Cause.STOPPED, Cause.SINGULAR_CONSTRAINTS, Cause.OUT_OF_REACH)
            and last_rows.time > past[0, -1]
        ):
            # The state in which it stopped is as good as any other: with rows far apart it may be all there is.
            rows.keep(np.array([last_rows.time]), np.asarray(last_rows.state)[:, None])
    except Breakdown as undefined:
        return undefined
    return last_rows


def chunks(run: Run, times: Any, meter: Meter, done: int = 0, most: int = MOST_AT_ONCE) -> Iterator[Any]:
    """The states (2n, m) at ``times`` from number ``done``, as many at once as cost about ``CHUNK``.

    Raises Breakdown, with the rows since the last chunk, where the run cannot go on or a row is beyond the bound.
    """
    count = 1
    while done < len(times):
        at = times[done : done + count]
        before = meter.spent
        try:
            rows = run.fill(at)
        except Breakdown as breakdown:
            _checked(breakdown.filled, at)
            raise
        _checked(rows, at)
        yield rows
        done += len(at)
        spent = meter.spent - before
        count = min(most, 4 * count) if spent < CHUNK / 4 else max(1, count // 2) if spent > CHUNK else count


def _checked(rows: Any, times: Any) -> None:
    """Raises Breakdown at the first row that is beyond the bound, or no number."""
    fine = within_bound(rows)
    if np.all(fine):
        return
    first = int(np.argmin(fine))
    state = rows[:, first]
    message = BEYOND if np.all(np.isfinite(state)) else Message("a value is no longer finite")
    if np.any(np.isnan(state)):
        message = Message("a coordinate or velocity is not a number")
    raise Breakdown(Cause.BLOW_UP, message, times[first], state, rows[:, :first])


def _escaped(dynamics: Dynamics, first: Any, times: Any, rows: Any) -> Breakdown | None:
    """What is wrong where the last row y has passed an escape: 10^12 of the sizes, and as much again in no time.

    Like 1/(t0 - t), y, y' and y'' of a component point one way there, and each is small beside the next one.  What
    swings never does so, and what an exponential makes of a size has a rate of some hundred of the whole time at most.
    """
    now, last, begin = float(times[-1]), rows[:, -1].astype(float), float(first[0])
    sudden = ESCAPING * (now - begin)
    rate = compiled_kernel(dynamics, "right_hand_side")
    with np.errstate(all="ignore"):
        rates = rate(np.concatenate(([now], last)))
        step = 1e-3 * sudden
        curved = (rate(np.concatenate(([now + step], last + step * rates))) - rates) / step
        one_way = (last * rates > 0) & (rates * curved > 0)
        away = one_way & (np.abs(last) < sudden * np.abs(rates)) & (np.abs(rates) < sudden * np.abs(curved))
    if not np.any(away) or not about(dynamics, begin, first[1:].astype(float)).outgrown(last, 0.0):
        return None
    return Breakdown(Cause.BLOW_UP, OUTGROWN, times[-1], last, rows[:, :-1])


def _cut(run: Integrated, first: int) -> Integrated:
    """What is left of a run whose energy has no value from a sample on: it went where the model says nothing."""
    message = "the energy is no real number from here on: a root or a logarithm has left its domain"
    ended = Breakdown(Cause.UNDEFINED, message, run.times[first], run.states[:, first])
    count = max(1, first)
    return replace(run, times=run.times[:count], states=run.states[:, :count], breakdown=ended)


def raw_energies(dynamics: Dynamics, points: Any, scalar: str) -> Any:
    """T - U relative to a frame that falls, T, and, where it is not ``natural``, T - U, h.

    At points (t, q, q') in columns.
    """
    kind = EXTENDED if scalar == EXTENDED else FLOAT64
    with np.errstate(all="ignore"):
        relative = compiled_kernel(dynamics, "relative_energy", kind)(points)
        if dynamics.natural:
            return relative
        return np.vstack([relative, compiled_kernel(dynamics, "energies", kind)(points)])


def told_energies(dynamics: Dynamics, raw: Any) -> tuple[Any, Any, Any, Any]:
    """(T - U, h, h - h(0), T) of ``raw_energies`` along a run."""
    with np.errstate(all="ignore"):
        relative, kinetic = raw[:2]
        change = relative - relative[0]
        if dynamics.natural:
            return relative, relative, change, kinetic
        energy, generalized = raw[2:]
        plain = generalized - generalized[0]
        largest = np.max(np.abs(np.vstack([energy, generalized, kinetic])), initial=0.0)
        apart = np.max(np.abs(plain - change), initial=0.0)
        alike = apart <= allowed_apart(np.max(np.abs(kinetic), initial=0.0), largest)
    return energy, generalized, change if alike else plain, kinetic


def allowed_apart(kinetic: float, largest: float) -> float:
    """By how much h - h(0) may differ in two frames: one that falls may add a function of time; where it does, the
    plain difference counts.  From the largest kinetic energy and the largest energy of all."""
    return float(1e-6 * kinetic + 1e3 * np.finfo(float).eps * largest)


# Where a run cannot begin, and what its end is called: bounds, singular mass matrices, rates that do not exist.


#: Where a value grows as much again in less than this part of the time, it escapes in finite time.
ESCAPING = 1e-6

#: No initial state is beyond this: the world measures 1e36 nanometres.
LARGEST_START = 1e40

#: A pivot of M that has become so much smaller than it was means that M is singular for practical purposes.
SINGULAR_PIVOT = 1e-11

#: The determinant of speeds beside what it was, where a step has failed: formulas of the velocities divide by it.
SINGULAR_SPEEDS = 1e-4

#: The same for an initial state beside its neighbours: sin(x)**2 where x is zero but for rounding.
SINGULAR_AT_ONCE = 1e-24

#: How far ahead, as parts of the state's size, rates that are no numbers explain why a run could not go on.
AHEAD = (1e-12, 1e-9, 1e-6, 1e-3, 3e-2)


#: How much later, as parts of the time so far, positions that keep moving constraints are looked for.
LATER = (1e-4, 1e-3, 1e-2)


def wrong_at_once(dynamics: Dynamics, initial: Any, begin: float = 0.0) -> Breakdown | None:
    """What is wrong with the initial state itself: there the right-hand side must exist."""
    if not np.all(np.abs(initial) < LARGEST_START):
        beyond = Message("the initial state itself is beyond [[bound]]", bound=f"{LARGEST_START:g}")
        return Breakdown(Cause.BLOW_UP, beyond, begin, initial)
    lost = _lost_rank(dynamics, initial) if begin == 0 else ""
    if lost:
        return Breakdown(Cause.SINGULAR_CONSTRAINTS, lost, begin, initial)
    point = np.concatenate(([begin], initial))
    with np.errstate(all="ignore"):
        rates = compiled_kernel(dynamics, "right_hand_side")(point)
    singular = _vanishing(dynamics, begin, initial, _neighbours(dynamics, initial, begin), SINGULAR_AT_ONCE)
    if singular:
        return Breakdown(Cause.SINGULAR, singular, begin, initial)
    if np.all(np.isfinite(rates)):
        return None
    if np.any(np.isnan(rates)):
        return Breakdown(Cause.UNDEFINED, "the accelerations at the initial state are no numbers", begin, initial)
    return Breakdown(Cause.BLOW_UP, "the accelerations at the initial state are not finite", begin, initial)


def _lost_rank(dynamics: Dynamics, initial: Any) -> str:
    """What is said of an initial position in which constraints depend on each other that do not beside it.

    Or where nothing is beside it that all of them allow (links at full stretch between two points).
    """
    known = dynamics.constraints
    if known is None:
        return ""
    rank, usual = len(known.independent(0.0, initial)), len(known.kept)
    if rank == usual:
        text = (
            "what the constraint rows allow at this position to first order (their rank is [[rank]]) they stop at "
            "second order"
        )
        return Message(text, rank=rank) if known.obstructed(initial) else ""
    text = "of [[usual]] constraint rows that are independent beside this position, only [[rank]] are independent in it"
    return Message(text, usual=usual, rank=rank)


def _neighbours(dynamics: Dynamics, state: Any, time: float) -> Any:
    """(t, q, q') in columns: some states not far from a state, the same ones every time."""
    n = len(state)
    moved = np.sin(np.outer(np.arange(1, n + 1), np.arange(1, 5)))  # any numbers between -1 and 1
    sizes = about(dynamics, time, state).sizes + np.abs(state[:, None])
    return np.vstack([np.full(4, time), state[:, None] + 0.1 * moved * sizes])


def diagnosed(dynamics: Dynamics, breakdown: Breakdown, past: Any) -> Breakdown:
    """A vanishing step at a blow-up, either of them where M is singular, what moves out of reach: called what they are.

    ``past`` holds earlier (t, q, q') in columns: a pivot is small compared with what it was, whatever its units.
    """
    state = np.asarray(breakdown.state, dtype=float)
    if breakdown.kind in (Cause.SINGULAR_CONSTRAINTS, Cause.BLOW_UP):
        at, last = (float(past[0, -1]), past[1:, -1]) if breakdown.kind == Cause.BLOW_UP else (breakdown.time, state)
        if not _goes_on(dynamics, at, last, float(past[0, 0])):
            message = "no position was found that keeps the constraints behind this one: velocities grow without bound"
            return Breakdown(Cause.OUT_OF_REACH, message, at, last)
    if breakdown.kind not in (Cause.BLOW_UP, Cause.STUCK):
        return breakdown
    if _dependent_speeds(dynamics, breakdown.time, state, past):
        message = "the speeds do not determine the velocities of coordinates in this state"
        return Breakdown(Cause.SINGULAR_SPEEDS, message, breakdown.time, breakdown.state)
    message = _vanishing(dynamics, breakdown.time, state, past, SINGULAR_PIVOT)
    if message:
        return Breakdown(Cause.SINGULAR, message, breakdown.time, breakdown.state)
    if _undefined(dynamics, breakdown.time, state, past):
        message = "the equations have no real value beyond this state: a root or a logarithm leaves its domain"
        return Breakdown(Cause.UNDEFINED, message, breakdown.time, breakdown.state)
    if breakdown.kind == Cause.STUCK and about(dynamics, past[0, 0], past[1:, 0]).outgrown(state, 0.0):
        return Breakdown(Cause.BLOW_UP, OUTGROWN, breakdown.time, breakdown.state)
    return breakdown


def _goes_on(dynamics: Dynamics, t: float, state: Any, begin: float) -> bool:
    """Whether positions near a state keep the constraints a little later; those that stand still always have some."""
    constraints = dynamics.constraints
    if constraints is None or constraints.steady:
        return True
    return any(constraints.led(t + part * (t - begin), state) is not None for part in LATER)


def _undefined(dynamics: Dynamics, t: float, state: Any, past: Any) -> bool:
    """Whether the rates are no numbers (infinite ones are) in a state, or a little ahead of it.

    Little is a part of what the motion has passed (``past``: t, q, q' in columns), or of the scene's sizes.
    """
    if not np.all(np.isfinite(state)):
        return False
    rhs = compiled_kernel(dynamics, "right_hand_side")
    with np.errstate(all="ignore"):
        rates = rhs(np.concatenate(([t], state)))
        if np.any(np.isnan(rates)):
            return True
        moving = np.abs(rates) > 0
        if not np.any(moving) or about(dynamics, past[0, 0], past[1:, 0]).outgrown(0.0 * state, rates):
            return False
        sizes = np.maximum(about(dynamics, t, state).sizes[:, 0], np.max(np.abs(past[1:]), axis=1))
        steps = np.array(AHEAD) * float(np.min(sizes[moving] / np.abs(rates[moving])))
        return bool(np.any(np.isnan(rhs(np.vstack([t + steps, state[:, None] + np.outer(rates, steps)])))))


def _dependent_speeds(dynamics: Dynamics, t: float, state: Any, past: Any) -> bool:
    """Whether the determinant of the declared speeds is next to nothing beside what it was."""
    if not isinstance(dynamics, StateDynamics) or not np.all(np.isfinite(state)):
        return False
    size = compiled_kernel(dynamics, "determinant")
    here, usual = abs(size(np.concatenate(([t], state)))[0]), np.max(np.abs(size(past)))
    return bool(here < SINGULAR_SPEEDS * usual)


def _vanishing(dynamics: Dynamics, t: float, state: Any, others: Any, least: float) -> str:
    """Which pivot of M vanishes at a state, beside its values at other states, as a sentence; empty where none does."""
    if not np.all(np.isfinite(state)):
        return ""
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(np.concatenate(([t], state))))
        if not np.all(np.isfinite(pivots)):
            return "M cannot be factorised"
        elsewhere = np.abs(compiled_kernel(dynamics, "pivots")(others))
        ordered = np.sort(np.where(np.isfinite(elsewhere), elsewhere, 0.0), axis=1)
        usual = ordered[:, ordered.shape[1] // 2]  # as a median does, which would load numpy.ma
        ratios = np.where(usual > 0, pivots / usual, np.where(pivots > 0, np.inf, 0.0))
    ratio = float(np.min(ratios))
    if not ratio < least:
        return ""
    if dynamics.constraints is not None:
        text = "a pivot of M or of J M^-1 J^T (constraints) is [[ratio]] of its usual size"
        return Message(text, ratio=f"{ratio:.1e}")
    return Message("a pivot of M is [[ratio]] of its usual size", ratio=f"{ratio:.1e}")


def least_pivot(dynamics: Dynamics, trajectory: Trajectory) -> tuple[float, float]:
    """(ratio, t): how far a pivot of M fell below what it was at the start, and when.

    M loses about -log10(ratio) digits there; 1e-8 and less means that the motion passes by a singularity of the chosen
    coordinates (or of the model).
    """
    lowest = fallen(dynamics, np.vstack([trajectory.times, trajectory.states.astype(float)]))
    place = int(np.argmin(lowest))
    return float(lowest[place]), float(trajectory.times[place])


def fallen(dynamics: Dynamics, points: Any, first: Any = None) -> Any:
    """What of a pivot of M is left at (t, q, q') in columns, of the pivot that fell most, shape (m,).

    Parts of what they were at the point ``first``, shape (1 + 2n,); without it, at the first of the columns.
    """
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(points))
        start = pivots[:, 0] if first is None else np.abs(compiled_kernel(dynamics, "pivots")(first))
        ratios = pivots / start[:, None]
    return np.min(np.where(np.isfinite(ratios), ratios, 0.0), axis=0)
