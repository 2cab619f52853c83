"""Ensembles: many members of one system, and how their motions are spread at every time.

    mean, standard deviation, least, greatest, quantiles of every coordinate and velocity over the members

Members that end early (a blow-up, steps too small, too many) are counted and named, and from then on the statistics are
those of the rest: ``alive`` says at every time of how many.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from mbsym.algebra.program import Node
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.ensembles.side_by_side import TABLEAUX, Fate, SideBySide, compiled
from mbsym.numerics.ensembles.variation import Members
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Breakdown, Cause, Narrow, Run, Setting, met_by, within_bound
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.variational import extended
from mbsym.numerics.planning.sizes import scaled, sizes_of_scene
from mbsym.numerics.scenario import Specialised
from mbsym.numerics.states import dynamics_of

#: Quantiles of the statistics: the median, and the bands of 50 % and 90 % about it.
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)

#: States are taken in blocks of about so many numbers.
BLOCK = 4_000_000

#: Below this tolerance a hundredth of it is not finer: rounding decides.
FINEST = 1e-13

#: So many members are integrated again, more finely, to see how good the others are.
CHECKED = 8


@dataclass(frozen=True)
class Statistics:
    """Rows of times: arrays (T, 2n), ``quantiles`` (len(QUANTILES), T, 2n), ``alive`` (T,); nan where nobody lives."""

    mean: Any
    deviation: Any
    least: Any
    greatest: Any
    quantiles: Any
    alive: Any


@dataclass(frozen=True)
class Compared:
    """``members`` were integrated more finely: the largest difference of each quantity, beside its largest size (2n,).

    Members that ended early are not among them.
    """

    members: tuple[int, ...]
    differences: Any
    sizes: Any

    @property
    def largest(self) -> float:
        """Relative to the quantity's size over these members and all times; nan where there was nothing to compare."""
        if not self.members:
            return float("nan")
        with np.errstate(invalid="ignore", divide="ignore"):
            ratios = np.where(self.sizes > 0, self.differences / self.sizes, 0.0)
        return float(np.max(ratios, initial=0.0))


@dataclass(frozen=True)
class Ensemble:
    """What ``ensemble`` found; ``final`` (2n, m) is each member's last state, nan where it ended early.

    ``missed`` has for each member the first narrow load that its steps were too long for, if there was any.
    """

    members: Members
    method: str
    setting: Setting
    times: Any
    statistics: Statistics
    final: Any
    fates: tuple[Fate, ...]
    compared: Compared
    steps: int
    threads: int
    lanes: int
    seconds: float
    interrupted: bool = False
    missed: Mapping[int, Narrow] = field(default_factory=dict)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the columns: coordinates and velocities."""
        system = self.members.dynamics.system
        return (*system.coordinates, *system.velocities)

    @property
    def count(self) -> int:
        """How many members it has, those that ended early included."""
        return int(self.final.shape[1])


def statistics(states: Any) -> Statistics:
    """Of states (T, 2n, m) with nan where a member has ended; the standard deviation is that of a sample (m - 1)."""
    ordered = np.sort(states, axis=2)  # nan come last
    alive = np.sum(np.isfinite(states[:, 0, :]), axis=1) if states.shape[1] else np.zeros(len(states), int)
    some = np.maximum(alive, 1)
    with np.errstate(invalid="ignore"):
        mean = np.nansum(states, axis=2) / some[:, None]
        squares = np.nansum((states - mean[:, :, None]) ** 2, axis=2)
    deviation = np.sqrt(squares / np.maximum(alive - 1, 1)[:, None])
    deviation[alive < 2] = np.nan
    mean[alive < 1] = np.nan
    rows = np.arange(len(states))
    quantiles = np.empty((len(QUANTILES), *states.shape[:2]))
    for place, chance in enumerate(QUANTILES):
        at = chance * (some - 1)
        below = np.floor(at).astype(int)
        above = np.minimum(below + 1, some - 1)
        share = (at - below)[:, None]
        low, high = ordered[rows, :, below], ordered[rows, :, above]
        quantiles[place] = low + share * (high - low)
    return Statistics(mean, deviation, ordered[:, :, 0], ordered[rows, :, some - 1], quantiles, alive)


def joined(parts: Sequence[Statistics]) -> Statistics:
    """Blocks of times one after the other."""
    return Statistics(
        np.concatenate([part.mean for part in parts]),
        np.concatenate([part.deviation for part in parts]),
        np.concatenate([part.least for part in parts]),
        np.concatenate([part.greatest for part in parts]),
        np.concatenate([part.quantiles for part in parts], axis=1),
        np.concatenate([part.alive for part in parts]),
    )


def ensemble(
    members: Members,
    method: str,
    setting: Setting,
    times: Any,
    threads: int | None = None,
    watch: Callable[[float], None] = lambda t: None,
) -> Ensemble:
    """The spread of the members' motions at ``times`` (increasing, the first is 0), by dop853, rk45 or rk4.

    Ctrl-C ends it: what has been computed is kept.  Memory is needed for the members' states and a block of times.
    """
    times = np.asarray(times, float)
    begin = beginning(members, method, threads)
    run = begin(setting, slice(None))
    started = time.perf_counter()
    parts = [statistics(members.starts[None])]
    rows = max(1, BLOCK // max(1, members.starts.size))
    reached, final, interrupted = 1, np.array(members.starts, float), False
    try:
        while reached < len(times):
            block = run.block(times[reached : reached + rows])
            parts.append(statistics(block))
            reached += len(block)
            final = block[-1].copy()
            watch(float(times[reached - 1]))
    except KeyboardInterrupt:
        interrupted = True
    seconds = time.perf_counter() - started
    compared = Compared((), np.zeros(len(final)), np.zeros(len(final)))
    if not interrupted:
        compared = _compared(members, begin, setting, times, run)
    accepted, rejected = run.steps
    fates = tuple(run.fates[member] for member in sorted(run.fates))
    steps = int(np.sum(accepted) + np.sum(rejected))
    spread = joined(parts)
    return Ensemble(
        members,
        method,
        setting,
        times[:reached],
        spread,
        final,
        fates,
        compared,
        steps,
        run.threads,
        run.lanes,
        seconds,
        interrupted,
        run.missed,
    )


#: Runs of some members at a setting, from the start.
Beginning = Callable[[Setting, Any], "SideBySide | OneByOne"]


def beginning(members: Members, method: str, threads: int | None) -> Beginning:
    """Side by side; one by one where steps have to end at switches, be short beside what is narrow, or be led back."""
    if not members.dynamics.features.none or members.dynamics.correction is not None:
        whole = WithParameters(members.dynamics)
        return lambda setting, some: OneByOne(
            whole, method, setting, members.starts[:, some], members.parameters[:, some]
        )
    made = compiled(members.dynamics, TABLEAUX[method])
    return lambda setting, some: SideBySide(
        made, setting, members.starts[:, some], members.parameters[:, some], threads
    )


def _compared(members: Members, begin: Beginning, setting: Setting, times: Any, run: SideBySide | OneByOne) -> Compared:
    """Some members, those with the most steps among them, once more: a hundredth of the tolerance, half the step."""
    whole = [member for member in range(run.members) if member not in run.fates]
    clamped = setting.tolerance is not None and setting.tolerance < FINEST
    if not whole or clamped:  # what cannot be done more finely would be compared with itself
        return Compared((), np.zeros(len(members.starts)), np.zeros(len(members.starts)))
    work = run.steps[0][whole]
    spread = [whole[int(place)] for place in np.linspace(0, len(whole) - 1, CHECKED - 2)]
    hardest = [whole[int(place)] for place in np.argsort(work)[-2:]]
    chosen = tuple(dict.fromkeys([*spread, *hardest]))
    finer = Setting(
        None if setting.tolerance is None else max(setting.tolerance / 100, 1e-15),
        None if setting.step is None else setting.step / 2,
        setting.step_limit * 4,
        setting.longest,
    )
    places = list(chosen)
    ends = times[1:] if len(times) * len(places) * len(members.starts) <= BLOCK else times[-1:]
    states = [begin(accuracy, places).block(ends) for accuracy in (setting, finer)]
    differences = np.max(np.abs(states[0] - states[1]), axis=(0, 2))
    own = np.max(np.abs(states[1]), axis=(0, 2))
    usual = sizes_of_scene(dynamics_of(members.dynamics.scenario), ends, states[1][:, :, 0].T)
    return Compared(chosen, differences, scaled(own, usual, differences))


# Members of an ensemble one after the other, where steps have to end at switches and be short beside narrow loads.
#
# Side by side all members take the steps of their error estimates alone, which may pass over a push without a sign of
# it, and lead nothing back to constraints or to quaternions of length 1. Here each is a run of its own
# (``mbsym.numerics.methods.landing``, ``led``), with the parameters behind its state,
#
#     x = (q, q', p),    x' = (rhs(t, q, q', p), 0),
#
# so that one compiled code does for all of them.


class WithParameters(Dynamics):
    """A scenario whose free parameters are constant components of the state."""

    def __init__(self, base: Parametrised) -> None:
        values = [Fraction(base.scenario.parameters[name]) for name in base.free]
        super().__init__(extended(base.scenario, values), base.ring)
        self.base = base
        self.inputs = base.inputs
        self.__dict__["constraints"] = base.constraints

    @cached_property
    def _specialised(self) -> Specialised:
        return self.base._specialised

    @cached_property
    def right_hand_side(self) -> Code:
        """(t, q, q', p) -> (q', q'', 0)."""
        rates = self.base.right_hand_side
        return Code(rates.program, self.inputs, (*rates.outputs, *self._still))

    @property
    def _still(self) -> list[Node]:
        return [self._specialised.zero] * len(self.base.free)

    @cached_property
    def correction(self) -> Code | None:
        """Of the state; parameters stay."""
        code = self.base.correction
        if code is None:
            return None
        *moved, nearness = code.outputs
        return Code(code.program, self.inputs, (*moved, *self._still, nearness))

    @cached_property
    def pivots(self) -> Code:
        """(t, q, q', p) -> those of the matrices."""
        return self.base.pivots

    @cached_property
    def mass_matrix(self) -> Code:
        """(t, q, q', p) -> M row by row."""
        return self.base.mass_matrix


class OneByOne:
    """Members under way, as ``SideBySide`` has them: ``starts`` (2n, m), ``parameters`` (p, m)."""

    threads, lanes = 1, 1

    def __init__(self, whole: WithParameters, method: str, setting: Setting, starts: Any, parameters: Any) -> None:
        self._dynamics, self._method, self._setting = whole, method, setting
        self._size, self.members = starts.shape
        self._states = np.vstack([starts, parameters]).astype(float)
        self._runs: list[Run | None] = [None] * self.members
        self.fates: dict[int, Fate] = {}

    @property
    def steps(self) -> Any:
        """(accepted, rejected) of every member, so far."""
        work = [None if run is None else run.work for run in self._runs]
        accepted = [0 if run_work is None else run_work.steps for run_work in work]
        return np.array(accepted, float), np.array(
            [0 if run_work is None else run_work.rejected for run_work in work], float
        )

    @property
    def missed(self) -> dict[int, Narrow]:
        """By member the first narrow feature that a step of it passed."""
        found = {}
        for member, run in enumerate(self._runs):
            passed = met_by(run)
            narrow = [] if passed is None else [feature for feature in passed.narrow if not feature.followed]
            if narrow:
                found[member] = narrow[0]
        return found

    def block(self, times: Any) -> Any:
        """States at increasing times beyond those before, shape (len(times), 2n, m); nan from where a member ended."""
        times = np.ascontiguousarray(times, float)
        out = np.full((len(times), self._size, self.members), np.nan)
        for member in range(self.members):
            if member not in self.fates:
                rows = self._rows(member, times)
                out[: rows.shape[1], :, member] = rows[: self._size].T
        return out

    def _rows(self, member: int, times: Any) -> Any:
        """The states of one member, up to where it ends."""
        try:
            run = self._runs[member]
            if run is None:
                run = METHODS[self._method].start(self._dynamics, self._setting, initial=self._states[:, member])
                self._runs[member] = run
            with np.errstate(all="ignore"):
                rows = run.fill(times)
        except Breakdown as ended:
            self.fates[member] = Fate(member, ended.kind, float(ended.time))
            rows = np.empty((len(self._states), 0)) if ended.filled is None else ended.filled
        fine = within_bound(rows[: self._size])
        if np.all(fine):
            return rows
        first = int(np.argmin(fine))
        self.fates[member] = Fate(member, Cause.BLOW_UP, float(times[first]))
        return rows[:, :first]
