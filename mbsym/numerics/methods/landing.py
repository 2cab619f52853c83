"""Runs that end a step where the rates are not smooth, and go on from there on the other side.

    sides s_i = sign g_i, held through a step:      x' = rhs(t, x; s),   smooth
    the step ends at the first t at which some g_i(t, x(t)) leaves its side

So every method keeps its order, and no stage of a step sees what lies beyond a switch.  Where both sides lead back to
g = 0 the motion stays there (dry friction that sticks): the sign is then what holds it (``sign_that_holds``) until that
leaves [-1, 1].  Where that is no answer, or switches follow one another without end, the run ends and says so.

A narrow smooth feature, a peak exp(u) or a turn tanh(u), that a step would pass at once is met by steps of its width;
steps of fixed length pass it, and that is told.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from time import perf_counter
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics, Frozen
from mbsym.numerics.events.crossings import NODES, free_of_zeros, nodes, series
from mbsym.numerics.events.features import SLIDING
from mbsym.numerics.methods.interface import (
    MOST_INSIDE,
    MOST_KEPT,
    Breakdown,
    Method,
    Narrow,
    Passed,
    Piece,
    Run,
    Setting,
    Traits,
    Work,
)
from mbsym.numerics.methods.led import LedRun, lead
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.runge_kutta import CompiledRun
from mbsym.numerics.methods.sides import BESIDE, Leaving, Sides, along, endless, feature_kernel, harmless, met

# Stretches of many steps in machine code, on which it is shown afterwards that nothing was passed.
#
#     a block of about K steps of the length h of the last one, with K intervals of the length h
#     at Chebyshev's points of each: states by the method's own dense output, and from these every g and u
#     accepted where each g keeps its sign (|c_0| > sum |c_k|) and no u does anything narrow; else as if never tried
#
# Steps are those that would be made one by one, and so are their ends; what is looked at is spread over the intervals
# as it would be over the steps, for there are about as many of them.  A block that meets something is undone, and
# smaller ones are tried behind it, or none for a while.


#: A block has so many steps at least and at most.
LEAST, MOST = 8, 256

#: A block keeps so many steps away from a time that steps have to end at: they are shortened before it.
AWAY = 4

#: Steps that are shorter than this part of the time are made one by one.
SHORT = 1e-10

#: There may be so many steps to an interval.
STEPS_TO_AN_INTERVAL = 1.5


@dataclass(frozen=True)
class Block:
    """The states (2n, m) at the rows that lie in it, where it ends, and how long its steps were."""

    rows: Any
    end: float
    length: float


class Blocks:
    """Blocks of a run: ``positive`` maps points (1 + 2n, m) to what keeps its sign, ``narrow`` to each u."""

    def __init__(
        self,
        positive: Callable[[Any], Any],
        looked_for: tuple[int, ...],
        narrow: Callable[[Any], Any],
        kinds: tuple[str, ...],
    ) -> None:
        self._positive, self._looked_for, self._narrow, self._kinds = positive, list(looked_for), narrow, kinds
        self._size, self._rest, self._waits = LEAST, 0, 0

    def begin(self) -> None:
        """Something was met: the next block is a small one."""
        self._size = LEAST

    def ahead(self, run: CompiledRun, length: float, bound: float, rows: Any) -> Block | None:
        """A block that ends well before ``bound``, or None: the run is then where it was.

        ``length`` is that of the last step; ``rows`` are times, of which those within are filled.
        """
        if self._rest > 0:
            self._rest -= 1
            return None
        start = float(run.time)
        if not length > SHORT * abs(start):
            return None
        count = int(min(self._size, (bound - start) / length - AWAY))
        if count < LEAST:
            return None
        edges = start + length * np.arange(count + 1)
        probes = np.concatenate([nodes(a, b)[:-1] for a, b in pairwise(edges)] + [edges[-1:]])
        within = rows[: int(np.searchsorted(rows, edges[-1], side="right"))]
        times = np.union1d(probes[1:], within)
        rest: Piece | None = None
        saved, steps = run.saved(), run.work.steps
        known = np.array(run.state)[:, None]
        try:
            states = run.fill(times)
            if run.reached > run.time:
                rest = run.step()  # what is left of the last step
        except Breakdown:
            self._undone(run, saved)
            return None
        far_enough = bound - float(run.reached) > AWAY * length
        few = run.work.steps - steps <= STEPS_TO_AN_INTERVAL * count + 2
        at_probes = np.concatenate([known, states[:, np.searchsorted(times, probes[1:])]], axis=1)
        if not (far_enough and few and self._free(probes, at_probes) and self._free_on(rest)):
            self._undone(run, saved)
            return None
        self._size, self._waits = min(2 * self._size, MOST), 0
        length *= count / max(1, run.work.steps - steps)
        filled = states[:, np.searchsorted(times, within)]
        if rest is not None:
            later = rows[len(within) : int(np.searchsorted(rows, rest.end, side="right"))]
            filled = np.concatenate([filled, rest(later)], axis=1) if len(later) else filled
        return Block(filled, float(run.time), length)

    def _undone(self, run: CompiledRun, saved: Any) -> None:
        run.undo(saved)
        if self._size == LEAST:  # what is near now is near for a while
            self._waits = min(2 * self._waits + LEAST, MOST)
            self._rest = self._waits
        self._size = max(self._size // 4, LEAST)

    def _free_on(self, piece: Piece | None) -> bool:
        if piece is None:
            return True
        times = nodes(float(piece.start), float(piece.end))
        return self._free(times, piece(times))

    def _free(self, probes: Any, states: Any) -> bool:
        """Whether nothing is met at the probes, NODES to an interval."""
        points = np.vstack([probes, np.asarray(states, dtype=float)])
        if self._looked_for:
            values = self._by_interval(self._positive(points)[self._looked_for])
            if not np.all(np.isfinite(values)) or not np.all(values[..., 0] > 0):
                return False
            if not np.all(free_of_zeros(series(values))):
                return False
        if self._kinds:
            values = self._by_interval(self._narrow(points))
            if not np.all(np.isfinite(values)):
                return False
            expansions = series(values)
            return all(np.all(harmless(kind, own)) for kind, own in zip(self._kinds, expansions, strict=True))
        return True

    @staticmethod
    def _by_interval(values: Any) -> Any:
        """(functions, intervals, NODES): the last point of an interval is the first one of the next."""
        count = (values.shape[1] - 1) // (NODES - 1)
        places = np.arange(count)[:, None] * (NODES - 1) + np.arange(NODES)
        return values[:, places]


#: What a method of fixed step is taken to leave of a g that is 0 where a step ended.
OF_FIXED_STEP = 1e-12

#: So many switches where nothing moves between them end the run.
MOST_TOGETHER = 24

#: No step is longer, relative to the time: where nothing moves until it is pushed, steps would grow without end.
FAR = 100.0

#: A step is shortened so often for what it would pass.
MOST_WINDOWS = 40


class Landing:
    """A method whose runs land at switches; runs of smooth systems are those of the method itself."""

    def __init__(self, inner: Method) -> None:
        self.inner = inner

    @property
    def traits(self) -> Traits:
        """Those of the method."""
        return self.inner.traits

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> Run:
        """A run; raises what the method raises."""
        run, led = self._started(dynamics, setting, scalar, initial, at), lead(dynamics, scalar)
        if led is None:
            return run
        return LedRun(run, led, lambda time, state: self._started(dynamics, setting, scalar, state, time))

    def _started(self, dynamics: Dynamics, setting: Setting, scalar: str, initial: Any, at: float) -> Run:
        smooth = dynamics.features.none or isinstance(dynamics, Frozen)
        if smooth and _longest(self.inner, setting) is None:
            return self.inner.start(dynamics, setting, scalar, initial, at)
        return LandingRun(self.inner, dynamics, setting, scalar, initial, at)


@dataclass
class _Window:
    """Until ``end`` steps are at most ``longest``, and one ends at ``start``."""

    start: float
    end: float
    longest: float
    place: int


class LandingRun:
    """Steps of a method's runs: one for all sides of the switches, and one for each at which the motion stays."""

    def __init__(
        self, method: Method, dynamics: Dynamics, setting: Setting, scalar: str, initial: Any, at: float
    ) -> None:
        self._method, self._dynamics, self._setting, self._scalar = method, dynamics, setting, scalar
        self._switches = Sides(dynamics)
        self._narrow_values = feature_kernel(dynamics, "narrow")
        self._count = self._switches.count
        self._kinds = dynamics.features.kinds
        self._longest = _longest(method, setting)
        self._runs: dict[int | None, Run] = {}
        self.work, self.passed = Work(), Passed()
        self._been: set[tuple[int, ...]] = set()
        self._leaving = Leaving(self._positive, self._switches, setting.tolerance or OF_FIXED_STEP, self.passed)
        first = method.start(dynamics, setting, scalar, initial, at) if not self._count else None
        start = np.array([float(x) for x in dynamics.scenario.state]) if initial is None else np.asarray(initial)
        if first is not None:
            self._runs[None] = first
            start = first.state
        self._blocks = Blocks(self._positive, self._switches.looked_for, self._narrow_values, self._kinds)
        self.restart(at, start)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state; its sides are looked for anew."""
        self.time, self.state = time, np.array(state)
        self._switches.measure(time, state)
        self._sides: tuple[int, ...] | None = None
        self._ahead: Run | None = None
        self._latest: Run | None = None  # the run of the last step
        self._windows: list[_Window] = []
        self._together = 0
        self._length = 0.0  # of the last step
        self._beyond: tuple[Piece, Any] | None = None  # a step that ends after ``time``, and the state there

    # --- what a run offers ---

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``; raises Breakdown."""
        if until > self.time:
            self.fill(np.array([until], dtype=float))
        return self.state

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at increasing times; raises Breakdown with those that there are."""
        at = np.asarray(times)
        states = np.empty((len(self.state), len(at)), np.asarray(self.state).dtype)
        done = int(np.searchsorted(at, self.time, side="right"))
        states[:, :done] = np.asarray(self.state)[:, None]
        try:
            while done < len(at):
                block = self._block(at[done:])
                if block is not None:
                    last = done + block.rows.shape[1]
                    states[:, done:last] = block.rows
                    done = last
                    continue
                # Steps of one length end at the last row: there is more in a step than in what lies between.
                piece = self.step(at[-1]) if self._method.traits.fixed else self._onwards(float(at[-1]))
                last = int(np.searchsorted(at, piece.end, side="right"))
                if last > done:
                    states[:, done:last] = piece(at[done:last])
                done = last
        except Breakdown as trouble:
            trouble.filled = states[:, :done]
            raise
        if done and self.time > at[-1]:
            # Steps do not depend on where rows are asked for: the last one goes on where the next question begins.
            self._beyond = piece, self.state
            self.time, self.state = float(at[-1]), states[:, -1].copy()
        return states

    def _block(self, rows: Any) -> Block | None:
        """A stretch of steps at once, where nothing is near; the last row is left to single steps."""
        run, length = self._ahead, self._length
        plain = isinstance(run, CompiledRun) and self._sides is not None and run.time == self.time
        if not plain or self._windows or self._beyond is not None or not length > 0 or self._longest is not None:
            return None
        assert isinstance(run, CompiledRun)
        assert self._sides is not None
        bound = min(float(rows[-1]), self._switches.next_knot(self._sides))
        if self.work.steps + 2 * MOST > self._setting.step_limit:
            return None
        before = replace(run.work)
        block = self._blocks.ahead(run, length, bound, rows)
        self.work.add(run.work, before)
        if block is None:
            return None
        self.time, self.state, self._together, self._length = block.end, run.state, 0, block.length
        return block

    def _onwards(self, last: float) -> Piece:
        """A step of the method's own choosing; where none can be made, one that ends at ``last``."""
        start = self.time
        try:
            return self.step()
        except Breakdown:
            if self.time != start or not last > start:
                raise
            self._ahead = None
            return self.step(last)

    def step(self, until: float | None = None) -> Piece:
        """The solution to the end of a step, to a switch, or to ``until``; raises Breakdown."""
        if until is not None and not until > self.time:
            raise ValueError(f"a step to {until:.9g} from {self.time:.9g}")
        if self._beyond is not None:
            return self._rest(until)
        if self._sides is None:
            self._sides = self._switches.choose(self.time, self.state, (), ())
        self._switches.require_inside(self.time, self.state, self._sides)
        for _ in range(MOST_TOGETHER):
            piece, place, turned = self._tried(until)
            if not turned:
                return self._taken(piece)
            if place > piece.start + self._switches.together(place):
                return self._landed(place, turned, float(piece.end - piece.start))
            self._note_switch()
            self._switch(turned)
        raise endless("its switches lead back to each other", self.time, self.state)

    def _rest(self, until: float | None) -> Piece:
        """What is left of a step of which a part was asked for, or another part of it."""
        assert self._beyond is not None
        (piece, state), start = self._beyond, self.time
        if until is not None and until < piece.end:
            self.time, self.state = until, np.array(piece(np.array([until])))[:, 0]
        else:
            self.time, self.state, self._beyond = piece.end, state, None
        return Piece(start, self.time, piece.curve)

    # --- one step ---

    def _tried(self, until: float | None) -> tuple[Piece, float, tuple[int, ...]]:
        """A step on these sides, and where and which switches leave them in it; not beyond narrow features."""
        for attempt in range(MOST_WINDOWS + 1):
            start, state = self.time, self.state
            piece = self._inner_step(self._bound(until))
            window = self._window(piece) if attempt < MOST_WINDOWS else None
            if window is None:
                break
            self._windows.append(window)
            self._go_back(start, state)
        assert self._sides is not None
        place, turned = self._leaving.first(piece, self._sides)
        return piece, place, turned

    def _bound(self, until: float | None) -> float:
        far = FAR * (self._switches.time + abs(self.time))  # at rest steps know no bound
        bound = self.time + far if until is None else until
        assert self._sides is not None
        bound = min(bound, self._switches.next_knot(self._sides))
        if self._longest is not None:
            bound = min(bound, self.time + self._longest)
        for window in self._windows:
            if self.time < window.start:
                bound = min(bound, window.start)
            elif self.time < window.end:
                bound = min(bound, max(self.time + window.longest, np.nextafter(self.time, inf)))
        return bound

    def _inner_step(self, bound: float, length: float = 0.0) -> Piece:
        """A step of the run on these sides, from the state where this run is; one of this length was good there."""
        assert self._sides is not None
        run = self._run(self._sides)
        if run is not self._ahead or run.time != self.time:
            known = np.array(getattr(self._latest, "sizes", 0.0))  # what rests on one side has moved on others
            run.restart(self.time, self.state)
            sizes = getattr(run, "sizes", None)
            if sizes is not None and run is not self._runs.get(None):  # what stays at a switch is measured as it moves
                known = np.maximum(known, about(self._dynamics, float(self.time), self.state).sizes[:, 0])
            if sizes is not None:
                sizes[:] = np.maximum(sizes, known)
            if hasattr(run, "lengthen"):
                run.lengthen(length)
            self._ahead = self._latest = run
        if self.work.steps >= self._setting.step_limit:
            raise self.work.too_many(self.time, self.state)
        before, changes = replace(run.work), len(run.work.changes)
        try:
            return run.step(bound)
        finally:
            self.work.add(run.work, before)
            self.work.changes += run.work.changes[changes:]

    def _run(self, sides: tuple[int, ...]) -> Run:
        if not sides:
            return self._runs[None]
        frozen = self._dynamics.on_sides(sides)
        if frozen.sliding not in self._runs:
            started = perf_counter()
            run = self._method.start(frozen, self._setting, self._scalar, self.state, self.time)
            self._runs[frozen.sliding] = run
            self.work.compiling += perf_counter() - started
        return self._runs[frozen.sliding]

    def _go_back(self, time: float, state: Any) -> None:
        self.time, self.state, self._ahead = time, state, None

    def _taken(self, piece: Piece) -> Piece:
        assert self._ahead is not None
        self._note_narrow(piece)
        self._note_inside(piece)
        self._check_sides(piece)
        self._length = max(float(piece.end - piece.start), 0.5 * self._length)  # a piece may be the rest of a step
        self.time, self.state = piece.end, self._ahead.state
        self._windows = [window for window in self._windows if window.end > self.time]
        self._together = 0
        knots = self._switches.reached(self.time, self._sides or ())
        if knots:
            self._note_switch()
            self._switch(knots)
        return piece

    def _landed(self, place: float, turned: tuple[int, ...], length: float) -> Piece:
        """The step of that length once more, to where the switch is; the next one begins on the other side."""
        self._go_back(self.time, self.state)
        piece = self._inner_step(place, length)
        if piece.end < place:  # the step before it was longer than those from a restart: go on from its end
            self._note_narrow(piece)
            self.time, self.state = piece.end, self._ahead.state if self._ahead is not None else self.state
            return piece
        self._note_narrow(piece)
        self._note_inside(piece)
        assert self._ahead is not None
        self._check_landing(piece, self._ahead.state, turned)
        apart = place - self.time
        self.time, self.state = piece.end, self._ahead.state
        self._together = 0 if apart > 1e3 * self._switches.together(place) else self._together + 1
        if self._together > MOST_TOGETHER:
            raise endless("they come ever closer to each other", self.time, self.state)
        self._note_switch()
        self._switch(turned)
        return piece

    def _note_inside(self, piece: Piece) -> None:
        """The middle of the first step on these sides."""
        sides = self._sides or ()
        if sides in self._been or SLIDING in sides or len(self._been) >= MOST_INSIDE:
            return
        middle = piece.start + 0.5 * (piece.end - piece.start)
        if piece.start < middle < piece.end:
            self._been.add(sides)
            self.passed.inside.append((float(middle), np.array(piece(np.array([middle])), dtype=float)[:, 0]))

    def _note_switch(self) -> None:
        switches, at = self.passed.switches, float(self.time)  # which has more digits in extended arithmetic
        if len(switches) < MOST_KEPT and not (switches and switches[-1] == at):
            switches.append(at)

    # --- sides ---

    def _switch(self, turned: tuple[int, ...]) -> None:
        """Other sides for some switches: those that the motion then stays on."""
        assert self._sides is not None
        self._sides = self._switches.choose(self.time, self.state, self._sides, turned)
        self._ahead, self._length = None, 0.0
        self._blocks.begin()

    def _positive(self, points: Any) -> Any:
        """What is positive on the present sides."""
        assert self._sides is not None
        return self._switches.leaving(points, self._sides)

    def _check_sides(self, piece: Piece) -> None:
        """A step that ends on another side than it was made for has missed a switch: nothing may hide that."""
        if not self._switches.looked_for or self._ahead is None or self._sides is None:
            return
        state = np.asarray(self._ahead.state, dtype=float)
        point = np.concatenate(([piece.end], state))[:, None]
        values, sizes = self._positive(point)[:, 0], np.abs(self._switches.at(piece.end, state))
        middle = along(self._positive, piece, piece.start, piece.end)
        usual = self._switches.sizes_on(self._sides)
        allowed = 1e-6 * (np.max(np.abs(middle), axis=1) + sizes + 1e-3 * usual)
        if np.any(values < -allowed):
            raise endless("a switch was missed", piece.end, state)

    def _check_landing(self, piece: Piece, state: Any, turned: tuple[int, ...]) -> None:
        """A step to a switch has to end at it, as far as its tolerance lets it."""
        assert self._sides is not None
        state = np.array(state, dtype=float)
        sizes = np.max(np.abs(along(self._positive, piece, piece.start, piece.end)), axis=1)
        left = np.abs(self._positive(np.concatenate(([piece.end], state))[:, None])[:, 0])
        part = max(1e-5, 10 * (self._setting.tolerance or 0.0))
        sizes = part * sizes + 1e-7 * self._switches.sizes_on(self._sides)
        if np.any(left[list(turned)] > sizes[list(turned)]):
            raise endless("a switch is not where it should be", piece.end, state)

    # --- narrow features ---

    def _window(self, piece: Piece) -> _Window | None:
        """Where steps have to be short, if this one was too long: not for steps of fixed length."""
        if self._method.traits.fixed or not self._kinds:
            return None
        for time, width, place in met(self._kinds, self._narrow_values, piece):
            window = _Window(time - BESIDE * width, time + BESIDE * width, width, place)
            known = any(w.start <= time <= w.end and w.longest <= 1.5 * width for w in self._windows)
            if not known and window.end > self.time:
                return window
        return None

    def _note_narrow(self, piece: Piece) -> None:
        if not self._kinds:
            return
        length = piece.end - piece.start
        for window in self._windows:
            centre = 0.5 * (window.start + window.end)
            if piece.start <= centre < piece.end and len(self.passed.narrow) < MOST_KEPT:
                self.passed.narrow.append(Narrow(centre, window.longest, length, window.place))
        if self._method.traits.fixed and len(self.passed.narrow) < MOST_KEPT:
            self.passed.narrow += [
                Narrow(time, width, length, place)
                for time, width, place in met(self._kinds, self._narrow_values, piece)
            ]


def _longest(method: Method, setting: Setting) -> float | None:
    """The longest step, where the method itself takes no notice of it."""
    return setting.longest if method.traits.name == "taylor" else None
