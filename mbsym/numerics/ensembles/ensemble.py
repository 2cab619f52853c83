"""Ensembles: many members of one system, and how their motions are spread at every time.

    mean, standard deviation, least, greatest, quantiles of every coordinate and velocity over the members

Members that end early (a blow-up, steps too small, too many) are counted and named, and from then on the statistics are
those of the rest: ``alive`` says at every time of how many.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mbsym.numerics.ensembles.one_by_one import OneByOne, WithParameters
from mbsym.numerics.ensembles.side_by_side import TABLEAUX, Fate, SideBySide, compiled
from mbsym.numerics.ensembles.variation import Members
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.passed import Narrow
from mbsym.numerics.planning.sizes import scaled, sizes_of_scene
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
    found: Members,
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
    begin = beginning(found, method, threads)
    run = begin(setting, slice(None))
    started = time.perf_counter()
    parts = [statistics(found.starts[None])]
    rows = max(1, BLOCK // max(1, found.starts.size))
    reached, final, interrupted = 1, np.array(found.starts, float), False
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
        compared = _compared(found, begin, setting, times, run)
    accepted, rejected = run.steps
    fates = tuple(run.fates[member] for member in sorted(run.fates))
    steps = int(np.sum(accepted) + np.sum(rejected))
    spread = joined(parts)
    return Ensemble(
        found,
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


def beginning(found: Members, method: str, threads: int | None) -> Beginning:
    """Side by side; one by one where steps have to end at switches, be short beside what is narrow, or be led back."""
    if not found.dynamics.features.none or found.dynamics.correction is not None:
        whole = WithParameters(found.dynamics)
        return lambda setting, some: OneByOne(whole, method, setting, found.starts[:, some], found.parameters[:, some])
    made = compiled(found.dynamics.right_hand_side, TABLEAUX[method], len(found.starts))
    return lambda setting, some: SideBySide(made, setting, found.starts[:, some], found.parameters[:, some], threads)


def _compared(found: Members, begin: Beginning, setting: Setting, times: Any, run: SideBySide | OneByOne) -> Compared:
    """Some members, those with the most steps among them, once more: a hundredth of the tolerance, half the step."""
    whole = [member for member in range(run.members) if member not in run.fates]
    clamped = setting.tolerance is not None and setting.tolerance < FINEST
    if not whole or clamped:  # what cannot be done more finely would be compared with itself
        return Compared((), np.zeros(len(found.starts)), np.zeros(len(found.starts)))
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
    ends = times[1:] if len(times) * len(places) * len(found.starts) <= BLOCK else times[-1:]
    states = [begin(one, places).block(ends) for one in (setting, finer)]
    differences = np.max(np.abs(states[0] - states[1]), axis=(0, 2))
    own = np.max(np.abs(states[1]), axis=(0, 2))
    usual = sizes_of_scene(dynamics_of(found.dynamics.scenario), ends, states[1][:, :, 0].T)
    return Compared(chosen, differences, scaled(own, usual, differences))
