"""How wrong a run is: its difference from a better one over the whole interval, quantity by quantity.

    error_i = max over 0 <= t <= end of |x_i(t) - better_i(t)|,      relative to  scale_i = max over t of |better_i(t)|

on dense output of both, following the steps of both, and at the rows that were shown (``trade.comparison``).

The better run differs in more than name: in an arithmetic of more digits, by another method, or by a tolerance ten
times smaller at least; two runs that come down to the same settings are never compared.  It takes no step longer than a
two thousandth of the whole, so that short events are not stepped over twice.  Where the run is as fine as any method,
a short one is compared with an extrapolation in 160 bits at places that lie unevenly.

What is wrong with a method itself is no difference between two runs of it: where the better run is of the run's own
method, a third one of another method, a witness, is held against the run at some places.  One that differs by clearly
more than the better run does is believed, for at least one of the three is wrong by as much.

The better run may be given so much counted work (``planning.prices``): one that shows on the way that it would
cost more is given up.  No clock is looked at: whether there is an estimate, and which, is the same on every machine.

Where the two part, both may be wrong from there on: the estimate is a lower bound then, and says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import inf
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.kernels.llvm import SCALARS, available
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Setting, Unusable
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.prices import Meter, Working
from mbsym.numerics.planning.sizes import AFFORDABLE, sizes_of_scene
from mbsym.numerics.simulate import Trajectory
from mbsym.numerics.trade.comparison import Comparison, Difference, Ended, compared, compared_at, uneven
from mbsym.numerics.trade.reference_search import BITS, solved_at
from mbsym.numerics.trade.trial import trial_of

#: The better run's tolerance beside the run's own, and how much smaller it has to be where nothing else differs.
TIGHTER, LEAST_RATIO = 1e-2, 0.1

#: The tolerance held against steps of fixed length.
AGAINST_FIXED = 1e-15

#: No step of the better run is longer than this part of the whole time.
PARTS = 2_000

#: Where the run's own steps are bounded, those of the better one are bounded by so much less.
SHORTER = 0.5

#: Nothing new is compiled for a right-hand side with more operations.
LONG = 20_000

#: Places at which a run is held against an extrapolation, its tolerance, and what that may cost.
PLACES, PRECISELY, PRECISE_COST = 150, 1e-22, 2.0

#: Who witnesses for a method that is judged by itself: the first that can be had.
WITNESSES = {
    "dop853": ("rk45",),
    "rodas5p": ("dop853", "radau"),
    "radau": ("rodas5p", "bdf"),
    "bdf": ("rodas5p", "radau"),
    "lsoda": ("rodas5p", "radau"),
}

#: The better method of stiff motions.
STIFF = "rodas5p"

#: A difference so many times the estimate contradicts it; what a witness may cost beside the two runs, or in any case;
#: and where an estimate was asked for.
CLEARLY, BESIDE, LITTLE, ASKED = 3.0, 2.0, 0.05, 2.0

#: A run with a limit is not given up before this part of it; then, if it would cost so many times as much.
EARLY, FAR_TOO_LONG = 0.2, 1.5


class Lacking(StrEnum):
    """Why there is no estimate."""

    NOT_ASKED = "none was asked for"
    NOT_WHOLE = "the run ended early"
    NOTHING = "nothing was integrated"
    FINEST = "no better run can be had: this one is as fine as the arithmetic, and no finer arithmetic is there"
    TOO_LONG = "a better run takes too long"
    CUT = (
        "a better run was given up as too long for an estimate that nobody asked for; asked for (--estimate, or "
        "estimate=True), it gets the time that it needs"
    )
    BREAKS_DOWN = "a better run breaks down on the way; this one may have stepped over a singularity"
    INTERRUPTED = "interrupted"
    CONTRADICTED = "the energy, which is conserved, drifts by far more than the difference from a better run"


@dataclass(frozen=True)
class Against:
    """The better run: its method, arithmetic and setting."""

    method: str
    scalar: str
    setting: Setting


@dataclass(frozen=True)
class ErrorEstimate:
    """Differences from a better run over the whole interval; ``rounding`` is that of one number of the run."""

    against: Against
    compared: Comparison
    rounding: float

    @property
    def quantities(self) -> tuple[Difference, ...]:
        """The differences, coordinate by coordinate, then velocity by velocity."""
        return self.compared.quantities

    @property
    def final(self) -> float:
        """The largest relative error at the end; no run is better than the rounding of one number."""
        return max(self.rounding, self.compared.final)

    @property
    def largest(self) -> float:
        """The largest relative error of the whole interval."""
        return max(self.rounding, self.compared.largest)

    @property
    def parted(self) -> float | None:
        """By when the two runs have parted; from there on nothing is known of either: the estimate is no bound then.

        One of the two is wrong by half of their difference at least, but nobody knows which.
        """
        return self.compared.parted


@dataclass(frozen=True)
class NoEstimate:
    """There is no estimate, and why."""

    why: Lacking


def estimated(
    dynamics: Dynamics,
    trajectory: Trajectory,
    method: Method,
    scalar: str,
    completed: Callable[[Method], Method] = lambda method: method,
    limit: float = inf,
) -> ErrorEstimate | NoEstimate:
    """The error of a run of ``method``, whose setting and times ``trajectory`` holds, by a better one.

    ``completed`` makes of another method one that integrates the same coordinates and shows whole states.  All better
    runs together, and the run beside them, may cost about as much as ``limit`` (``mbsym.numerics.planning.prices``).
    """
    if not trajectory.whole or trajectory.times[-1] == trajectory.times[0]:
        return NoEstimate(Lacking.NOT_WHOLE)
    if len(trajectory.times) < 2:
        return NoEstimate(Lacking.NOTHING)
    why, left = Lacking.FINEST, limit
    try:
        for better, kind, setting in _candidates(dynamics, trajectory, method, scalar, completed):
            budget = _Budget(dynamics, left, float(trajectory.times[-1]), better.traits.name == "dop853")
            try:
                comparison = _compared(dynamics, trajectory, (method, scalar), (better, kind, setting), budget)
            except Unusable:
                continue
            except _TooDear:
                why, left = Lacking.CUT, left - budget.spent
                continue
            except Ended as ended:
                if ended.breakdown.kind == Cause.NOT_SMOOTH:
                    left -= budget.spent
                    continue
                if ended.breakdown.kind != Cause.STEP_LIMIT:
                    return NoEstimate(Lacking.BREAKS_DOWN)
                why, left = Lacking.TOO_LONG if why is Lacking.FINEST else why, left - budget.spent
                continue
            estimate = ErrorEstimate(Against(better.traits.name, kind, setting), comparison, _rounding(scalar))
            return _witnessed(dynamics, trajectory, (method, scalar), estimate, completed, (left, budget.spent))
        if why is Lacking.FINEST:
            return _precisely(dynamics, trajectory, method, scalar)
    except KeyboardInterrupt:
        return NoEstimate(Lacking.INTERRUPTED)
    return NoEstimate(why)


class _TooDear(Exception):
    """A better run costs more than it may."""


class _Budget:
    """``reached`` raises _TooDear when the ``limit`` is spent; of a run with ``even`` steps, which stability rules
    where a run is stiff, when it will be long before the ``end``."""

    def __init__(self, dynamics: Dynamics, limit: float, end: float, even: bool) -> None:
        self.limit, self.end, self.even = limit, end, even
        self.meter = Meter(dynamics, looked_at=True)

    @property
    def spent(self) -> float:
        return self.meter.spent

    def start(self, runs: Sequence[tuple[Working, str, str]]) -> None:
        self.meter.start(runs)

    def reached(self, t: float) -> None:
        if self.limit == inf:
            return
        spent = self.spent
        slow = spent * self.end > FAR_TOO_LONG * self.limit * t
        hopeless = self.even and slow and spent > EARLY * self.limit
        if t < self.end and (spent > self.limit or hopeless):
            raise _TooDear


def _compared(
    dynamics: Dynamics,
    trajectory: Trajectory,
    own: tuple[Method, str],
    better: tuple[Method, str, Setting],
    budget: _Budget,
) -> Comparison:
    """The run once more, step by step beside the better one."""
    method, scalar = own
    other, kind, setting = better
    with np.errstate(all="ignore"):
        runs = method.start(dynamics, trajectory.setting, scalar), other.start(dynamics, setting, kind)
        budget.start(((runs[0], method.traits.name, scalar), (runs[1], other.traits.name, kind)))
        return compared(
            *runs,
            float(trajectory.times[-1]),
            (*dynamics.system.coordinates, *dynamics.system.velocities),
            lambda times, states: sizes_of_scene(dynamics, times, states),
            (trajectory.times, trajectory.states),
            watch=budget.reached,
        )


def _witnessed(
    dynamics: Dynamics,
    trajectory: Trajectory,
    own: tuple[Method, str],
    estimate: ErrorEstimate,
    completed: Callable[[Method], Method],
    costs: tuple[float, float],
) -> ErrorEstimate:
    """The estimate, or that of a witness that contradicts it; ``costs``: what is allowed, and what the runs have cost.

    A witness that is itself coarse comes closer to the run when it is made finer; one that stays where it is, as far
    away, is believed.  One that cannot be had for what is allowed, or that does not come to the end, says nothing.
    """
    name = own[0].traits.name
    took_part = {name, *(change.method for change in trajectory.work.changes)}
    alone = name in METHODS and estimate.against.method not in took_part  # of parts each has its own method
    if alone or estimate.parted is not None:
        return estimate
    for name in WITNESSES.get(estimate.against.method, ()):
        heard = _testimony(dynamics, trajectory, own, estimate, completed(METHODS[name]), costs)
        if heard is not None:
            return heard
    return estimate


def _testimony(
    dynamics: Dynamics,
    trajectory: Trajectory,
    own: tuple[Method, str],
    estimate: ErrorEstimate,
    witness: Method,
    costs: tuple[float, float],
) -> ErrorEstimate | None:
    """The estimate where a witness agrees, that of the witness where it does not; None where it says nothing."""
    (method, scalar), better, (limit, spent), end = own, estimate.against, costs, float(trajectory.times[-1])
    places = np.concatenate([[0.0], uneven(0.0, end, PLACES), [end]])
    scales = np.array([q.scale for q in estimate.quantities])
    most = min(limit - spent, max(LITTLE if limit < inf else ASKED, BESIDE * spent))
    setting, before = better.setting, inf
    earlier: Any = None
    try:
        states = trial_of(method, dynamics, trajectory.setting, places, scalar).whole().states
        while True:
            truth = trial_of(witness, dynamics, setting, places, better.scalar, most).whole().states
            apart = float(np.max(np.max(np.abs(states - truth), axis=1) / scales))
            if apart <= CLEARLY * estimate.largest:
                return estimate
            if earlier is not None and apart > before / CLEARLY:
                if CLEARLY * float(np.max(np.max(np.abs(truth - earlier), axis=1) / scales)) > apart:
                    return None  # what it says hangs on its steps
                break
            setting, before, earlier = _finer(setting), apart, truth
    except (Breakdown, Unusable):
        return None
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    scene = compared_at(places, states, truth, names, lambda times, x: sizes_of_scene(dynamics, times, x))
    against = Against(witness.traits.name, better.scalar, setting)
    return ErrorEstimate(against, scene, _rounding(scalar))


def _finer(setting: Setting) -> Setting:
    """A tolerance and steps so much smaller that errors are, too."""
    assert setting.tolerance is not None
    longest = setting.longest and SHORTER * setting.longest
    return replace(setting, tolerance=setting.tolerance * TIGHTER, longest=longest)


def _precisely(dynamics: Dynamics, trajectory: Trajectory, method: Method, scalar: str) -> ErrorEstimate | NoEstimate:
    """The error of a run that no other method can judge, by an extrapolation in 160 bits at some places."""
    if not dynamics.features.none:  # an extrapolation would pass what is narrow, and knows nothing of switches
        return NoEstimate(Lacking.FINEST)
    end = float(trajectory.times[-1])
    rows = np.unique(np.linspace(0, len(trajectory.times) - 1, min(len(trajectory.times), PLACES)).astype(int))
    places = np.union1d(uneven(0.0, end, PLACES), trajectory.times[rows])
    try:
        states = trial_of(method, dynamics, trajectory.setting, places, scalar).whole().states
        states[:, np.searchsorted(places, trajectory.times[rows])] = trajectory.states[:, rows]
        truth = solved_at(dynamics, places, PRECISELY, PRECISE_COST)
    except Breakdown as ended:
        return NoEstimate(Lacking.FINEST if ended.kind == Cause.STEP_LIMIT else Lacking.BREAKS_DOWN)
    names = (*dynamics.system.coordinates, *dynamics.system.velocities)
    scene = compared_at(places, states, truth, names, lambda times, x: sizes_of_scene(dynamics, times, x))
    against = Against("extrapolation", f"{BITS} bits", Setting(PRECISELY))
    return ErrorEstimate(against, scene, _rounding(scalar))


def _candidates(
    dynamics: Dynamics,
    trajectory: Trajectory,
    method: Method,
    scalar: str,
    completed: Callable[[Method], Method],
) -> Iterator[tuple[Method, str, Setting]]:
    """Runs that are better, the best of them first."""
    setting, end = trajectory.setting, float(trajectory.times[-1])
    operations = max(1, dynamics.right_hand_side.operations)
    limit, longest = max(20_000, AFFORDABLE // (14 * operations)), end / PARTS
    if setting.longest is not None:  # where that rules the steps of both, they would be the same run
        longest = min(longest, SHORTER * setting.longest)
    explicit = completed(METHODS["dop853"])
    tolerance = AGAINST_FIXED if setting.tolerance is None else setting.tolerance * TIGHTER
    own = max(setting.tolerance or 0.0, method.traits.finest(scalar))

    def finer(better: Method) -> bool:
        return max(tolerance, better.traits.finest(scalar)) <= LEAST_RATIO * own

    turned = any(METHODS[change.method].traits.implicit for change in trajectory.work.changes)
    stiff = (method.traits.implicit or turned) and not method.traits.fixed and scalar == FLOAT64
    if stiff and finer(METHODS[STIFF]):  # explicit steps would be too many
        yield completed(METHODS[STIFF]), scalar, Setting(tolerance, None, setting.step_limit, longest)
    more = [kind for kind in (EXTENDED, FLOAT64) if available(kind) and _rounding(kind) < _rounding(scalar)]
    if more and operations <= LONG:
        # Explicit steps in more digits; where stability asks for too many of them, the limit ends it.
        yield explicit, more[0], Setting(max(tolerance, 40 * _rounding(more[0])), None, limit, longest)
    if setting.step is not None:
        yield (
            method,
            scalar,
            replace(setting, step=min(setting.step / 4, longest), step_limit=max(4 * limit, 8 * trajectory.work.steps)),
        )
        return
    if finer(method):
        yield method, scalar, Setting(tolerance, None, setting.step_limit, longest)
    elif finer(explicit):
        yield explicit, scalar, Setting(tolerance, None, limit, longest)


def _rounding(scalar: str) -> float:
    return float(np.finfo(SCALARS[scalar].dtype).eps) / 2


def contradicted(estimate: ErrorEstimate | NoEstimate, drift: float) -> bool:
    """Whether a conserved energy drifts by more than a run of this error could let it."""
    return isinstance(estimate, ErrorEstimate) and drift > 1e-2 and drift > 1e3 * estimate.largest
