"""Two solutions of one scenario compared over the whole interval, on dense output of both.

    e_i(t) = |x_i(t) - y_i(t)|,    0 <= t <= end,      relative to  scale_i = max over the whole interval of |y_i|

The places looked at follow the steps of both solutions: where a step of the one overlaps a step of the other, the end
of the overlap and ``SHARES`` of it inside, so that neither an oscillation between steps nor one between rows is missed;
and every row that was shown.  After ``MOST`` overlaps the rest of the interval is looked at in as many places that lie
unevenly, and ``followed`` is false.

A quantity smaller than ``floor`` on which the two do not agree rests but for rounding, and is measured by what the
scene would move it by (``planning.sizes``).  From the moment ``parted`` on the two have little in common: a difference
then says how far two solutions can be apart, not how wrong either of them is.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from mbsym.numerics.methods.interface import Breakdown, Run
from mbsym.numerics.methods.nested import states_on
from mbsym.numerics.planning.prices import FOLLOWED
from mbsym.numerics.planning.sizes import RESTS, scaled

#: Places inside an overlap of two steps, as parts of it; its end is looked at, too.
SHARES = (0.17, 0.38, 0.61, 0.83)

#: Overlaps that are followed one by one, and places in the rest of the interval.
MOST = FOLLOWED

#: So many of them are looked at together.
AT_ONCE = 16

#: Blocks in which the rest is looked at, and parts of each after which whoever watches is told.
BLOCKS, OFTEN = 32, 64

#: Differences beyond this part of a quantity's scale: the two solutions have parted.
PARTED = 0.1

#: Stretches of the interval whose largest differences are remembered, and how many places make one at first.
STRETCHES, TOGETHER = 1_024, 8

#: 1/golden ratio: multiples of it lie evenly in the unit interval however many they are, and on no period.
UNEVEN = 0.6180339887498949


class Piecewise(Protocol):
    """One step of a solution: states (2n, m) at times (m,) between ``start`` and ``end``."""

    @property
    def start(self) -> float: ...

    @property
    def end(self) -> float: ...

    def __call__(self, times: Any) -> Any: ...


class Solution(Protocol):
    """What a run offers to be compared (``mbsym.numerics.methods.interface.Run``)."""

    time: float
    state: Any

    def step(self, until: float | None = None) -> Piecewise:
        """One step of its own choosing."""

    def fill(self, times: Sequence[float]) -> Any:
        """States (2n, m) at increasing times, not before the present one."""


class Ended(Exception):
    """One of the two solutions ends on the way; ``second`` says which."""

    def __init__(self, second: bool, breakdown: Breakdown) -> None:
        super().__init__(str(breakdown))
        self.second, self.breakdown = second, breakdown


@dataclass(frozen=True)
class Difference:
    """|x_i - y_i| of one coordinate or velocity: at the ``end``, at worst, ``when`` that is.

    ``size`` is max |y_i|; ``scale`` is what differences are relative to: the size, or what the scene would move the
    quantity by where its size is below ``floor`` and the two solutions do not agree on it.
    """

    name: str
    final: float
    largest: float
    when: float
    size: float
    scale: float
    floor: float

    @property
    def rests(self) -> bool:
        """Its own size is nothing to measure by."""
        return self.size < self.scale

    @property
    def relative(self) -> float:
        """The largest difference over the scale."""
        return self.largest / self.scale


@dataclass(frozen=True)
class Comparison:
    """Differences from 0 to ``end`` in ``points`` places; by the time ``parted`` the two have parted, if it is given.

    ``followed``: every step of both was looked at.  ``times`` and ``states`` are those of the second solution at some
    places along the whole interval.
    """

    quantities: tuple[Difference, ...]
    end: float
    points: int
    followed: bool
    parted: float | None
    times: Any
    states: Any

    @property
    def largest(self) -> float:
        """The largest relative difference."""
        return max(q.relative for q in self.quantities)

    @property
    def final(self) -> float:
        """The largest relative difference at the end."""
        return max(q.final / q.scale for q in self.quantities)


def compared(
    first: Solution,
    second: Solution,
    end: float,
    names: Sequence[str],
    usual: Callable[[Any, Any], Any] = lambda times, states: np.zeros(len(states)),
    shown: tuple[Any, Any] | None = None,
    most: int = MOST,
    watch: Callable[[float], None] = lambda t: None,
) -> Comparison:
    """The differences of two solutions that stand at t = 0, from there to ``end``, scaled by the second one.

    ``usual(times, states)`` is what the scene would move each quantity by, shape (2n,); ``shown`` are rows (times,
    states) of the first solution that count as they are.  ``watch`` is told the time reached, and may raise.  Raises
    Ended where a solution does not come to the end.
    """
    seen = _Seen(first.state, second.state)
    rows = _Rows.of(shown)
    followed = True
    places = _places(first, second, end, rows, most)
    for block in _blocks(places):
        times, first_states, second_states = _evaluated(block)
        seen.add(times, rows.instead(times, first_states), second_states)
        followed = followed and block[-1][3]
        watch(float(times[-1]))
    return seen.comparison(names, usual, followed)


def filled(solution: Run, times: Any, looks: int = 1, reached: Callable[[float], None] = lambda t: None) -> Any:
    """The states (2n, m) at increasing times, the first of which is where the solution is; ``reached`` in ``looks``.

    Raises Breakdown where they do not come to the last one, and what ``reached`` raises.
    """
    states = [np.array(solution.state)[:, None]]
    with np.errstate(all="ignore"):
        for some in np.array_split(np.asarray(times[1:], dtype=float), looks):
            states.append(solution.fill(some))
            reached(float(some[-1]))
    return np.hstack(states)


def compared_at(
    times: Any,
    first_states: Any,
    other: Any,
    names: Sequence[str],
    usual: Callable[[Any, Any], Any] = lambda times, states: np.zeros(len(states)),
) -> Comparison:
    """The differences of states (2n, m) at increasing times that begin with 0, scaled by ``other``."""
    seen = _Seen(first_states[:, 0], other[:, 0])
    seen.add(times[1:], first_states[:, 1:], other[:, 1:])
    return seen.comparison(names, usual, followed=False)


def uneven(start: float, end: float, count: int) -> Any:
    """``count`` times between ``start`` and ``end``, one in each equal part of it, on no period."""
    return start + (end - start) * (np.arange(count) + np.arange(1, count + 1) * UNEVEN % 1) / count


@dataclass(frozen=True)
class _Rows:
    """Rows of the first solution, as many of them as places are looked at."""

    times: Any
    states: Any

    @classmethod
    def of(cls, shown: tuple[Any, Any] | None) -> _Rows:
        if shown is None:
            return cls(np.empty(0), np.empty((0, 0)))
        times, states = np.asarray(shown[0], dtype=float), np.asarray(shown[1])
        chosen = np.unique(np.linspace(0, len(times) - 1, min(len(times), MOST)).astype(int))
        return cls(times[chosen], states[:, chosen])

    @cached_property
    def _listed(self) -> list[float]:
        listed: list[float] = self.times.tolist()
        return listed

    def among(self, after: float, until: float) -> list[float]:
        """Times of rows in (after, until]."""
        return self._listed[bisect_right(self._listed, after) : bisect_right(self._listed, until)]

    def instead(self, times: Any, states: Any) -> Any:
        """The states of rows in place of others at the same times."""
        if not len(self.times):
            return states
        places = np.minimum(np.searchsorted(self.times, times), len(self.times) - 1)
        return np.where(self.times[places] == times, self.states[:, places], states)


def _places(first: Solution, second: Solution, end: float, rows: _Rows, most: int) -> Iterator[_Place]:
    """In order from 0 to the end."""
    now = 0.0
    piecewise, other = _step(first, second=False), _step(second, second=True)
    for _ in range(most):
        until = min(float(piecewise.end), float(other.end), end)
        times = [*(now + share * (until - now) for share in SHARES), until]
        some = rows.among(now, until)
        yield sorted({*times, *some}) if some else times, piecewise, other, True
        if until >= end:
            return
        now = until
        piecewise = piecewise if float(piecewise.end) > now else _step(first, second=False)
        other = other if float(other.end) > now else _step(second, second=True)
    # One of them, or both, may be ahead of what was looked at.
    ahead = sorted({now, min(float(piecewise.end), end), min(float(other.end), end), end})
    ahead = sorted({*ahead, *np.linspace(ahead[-2], end, BLOCKS + 1).tolist()})
    for after, until in pairwise(ahead):
        count = max(16, int(most * len(SHARES) * (until - after) / (end - now)))
        inside = uneven(after, until, count)
        every = np.union1d(np.append(inside[(inside > after) & (inside < until)], until), rows.among(after, until))
        for part in np.array_split(every, min(OFTEN, len(every))):  # whoever watches may have seen enough
            yield part, _at(first, piecewise, part, second=False), _at(second, other, part, second=True), False


#: (times, the first, the second, whether steps are followed): then the two are the steps there, else their states.
_Place = tuple[Any, Any, Any, bool]


def _evaluated(block: Sequence[_Place]) -> tuple[Any, Any, Any]:
    """(times, states of the first, of the second) of all places of a block, those on steps in one go."""
    steps, groups = [place for place in block if place[3]], [place[:3] for place in block if not place[3]]
    if steps:
        own, first, second, _ = zip(*steps, strict=True)
        groups.insert(0, (np.concatenate(own), states_on(first, own), states_on(second, own)))
    times, first_states, second_states = (np.concatenate(parts, axis=-1) for parts in zip(*groups, strict=True))
    return times, first_states, second_states


def _blocks(places: Iterator[_Place]) -> Iterator[list[_Place]]:
    """Overlaps together, as long as they are followed one by one; what comes then is much by itself."""
    block: list[_Place] = []
    for place in places:
        block.append(place)
        if len(block) == AT_ONCE or not place[3]:
            yield block
            block = []
    if block:
        yield block


def _step(solution: Solution, second: bool) -> Piecewise:
    try:
        return solution.step()
    except Breakdown as breakdown:
        raise Ended(second, breakdown) from None


def _at(solution: Solution, piece: Piecewise, times: Any, second: bool) -> Any:
    """States on the step that is under way, or beyond it."""
    if times[-1] <= float(piece.end):
        return piece(times)
    try:
        return solution.fill(times)
    except Breakdown as breakdown:
        raise Ended(second, breakdown) from None


class _Seen:
    """What has been seen so far of two solutions that go on."""

    def __init__(self, first: Any, second: Any) -> None:
        start = np.asarray(second, dtype=float)
        self.size = np.abs(start)
        self.largest, self.when = _distance(np.asarray(first), np.asarray(second)), np.zeros(len(start))
        self.final = self.largest.copy()
        self.points = 1
        self._ends: list[float] = [0.0]
        self._worst: list[Any] = [self.largest.copy()]
        self._states: list[Any] = [start]

    def add(self, times: Any, first_states: Any, second_states: Any) -> None:
        differences = _distance(first_states, second_states)
        places = np.argmax(differences, axis=1)
        worst = differences[np.arange(len(places)), places]
        more = worst > self.largest
        self.largest = np.where(more, worst, self.largest)
        self.when = np.where(more, times[places], self.when)
        self.final = differences[:, -1]
        self.size = np.maximum(self.size, np.max(np.abs(np.asarray(second_states, dtype=float)), axis=1))
        self.points += len(times)
        for start in range(0, len(times), TOGETHER):
            chosen = slice(start, start + TOGETHER)
            self._ends.append(float(times[chosen][-1]))
            self._worst.append(np.max(differences[:, chosen], axis=1))
            self._states.append(np.asarray(second_states[:, chosen][:, -1], dtype=float))
        while len(self._ends) > 2 * STRETCHES:
            self._thin()

    def _thin(self) -> None:
        """Two neighbouring stretches become one, which ends where the later one does; the start stays."""
        pairs = list(zip(self._worst[1::2], self._worst[2::2], strict=False))
        odd = slice(1 + 2 * len(pairs), None)
        self._worst = [self._worst[0], *(np.maximum(*pair) for pair in pairs), *self._worst[odd]]
        self._ends = [self._ends[0], *self._ends[2::2], *self._ends[odd]]
        self._states = [self._states[0], *self._states[2::2], *self._states[odd]]

    def comparison(self, names: Sequence[str], usual: Callable[[Any, Any], Any], followed: bool) -> Comparison:
        """What it comes to."""
        samples = self.kept()
        usually = np.asarray(usual(*samples), dtype=float)
        scales = scaled(self.size, usually, self.largest)
        quantities = tuple(
            Difference(name, *map(float, values))
            for name, *values in zip(
                names, self.final, self.largest, self.when, self.size, scales, RESTS * usually, strict=True
            )
        )
        return Comparison(quantities, self._ends[-1], self.points, followed, self.parted(PARTED * scales), *samples)

    def kept(self) -> tuple[Any, Any]:
        """(times, states) of the second solution, some of them along the whole interval."""
        return np.array(self._ends), np.array(self._states).T

    def parted(self, bounds: Any) -> float | None:
        """The end of the first stretch in which a difference passes its bound; None where none does."""
        for end, worst in zip(self._ends, self._worst, strict=True):
            if np.any(worst > bounds):
                return end
        return None


def _distance(first_states: Any, other: Any) -> Any:
    """|x - y|; infinite where one of them is no number."""
    with np.errstate(all="ignore"):
        differences = np.abs(np.asarray(first_states) - np.asarray(other)).astype(float)
    return np.where(np.isfinite(differences), differences, np.inf)
