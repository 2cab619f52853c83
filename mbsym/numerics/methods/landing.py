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
from dataclasses import dataclass
from math import inf
from time import perf_counter
from typing import Any

import numpy as np

from mbsym.numerics.crossings import Sign, free_of_zeros, passages, resolved, series
from mbsym.numerics.dynamics import Dynamics, Frozen
from mbsym.numerics.features import SLIDING
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import COUNTS, STEP_LIMIT, Breakdown, Method, Piece, Run, Setting, Traits, Work
from mbsym.numerics.methods.kept import compiled_kernel, once
from mbsym.numerics.methods.narrow import BESIDE, along, met
from mbsym.numerics.methods.passed import Narrow, Passed

#: Why a run cannot go on at a switch.
SWITCHING = "switching without end"

#: A piece is halved so often to resolve a g.
DEPTH = 12

#: Values of g below this part of its size are 0: they are what roundings leave of a step that ends at g = 0.
BLUR = 1e-13

#: Switches so close to each other, relative to the time, that nothing moves between them; so many end the run.
TOGETHER, MOST_TOGETHER = 1e-12, 24

#: No step is longer, relative to the time: where nothing moves until it is pushed, steps would grow without end.
FAR = 100.0

#: A step is shortened so often for what it would pass.
MOST_WINDOWS = 40

#: So many passages and features are kept one by one.
MOST_KEPT = 10_000


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
        self._switch_values = _kernel(dynamics, "switches")
        self._narrow_values = _kernel(dynamics, "narrow")
        self._count = len(dynamics.features.switches.outputs)
        self._kinds = dynamics.features.kinds
        self._longest = _longest(method, setting)
        self._runs: dict[int | None, Run] = {}
        self.work, self.passed = Work(), Passed()
        first = method.start(dynamics, setting, scalar, initial, at) if not self._count else None
        start = np.array([float(x) for x in dynamics.scenario.state]) if initial is None else np.asarray(initial)
        if first is not None:
            self._runs[None] = first
            start = first.state
        self.restart(at, start)

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state; its sides are looked for anew."""
        self.time, self.state = time, np.array(state)
        self._sides: tuple[int, ...] | None = None
        self._ahead: Run | None = None
        self._windows: list[_Window] = []
        self._together = 0
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
        found = np.empty((len(self.state), len(at)), np.asarray(self.state).dtype)
        done = int(np.searchsorted(at, self.time, side="right"))
        found[:, :done] = np.asarray(self.state)[:, None]
        try:
            while done < len(at):
                # Steps of one length end at the last row: there is more in a step than in what lies between.
                piece = self.step(at[-1]) if self._method.traits.fixed else self._onwards(float(at[-1]))
                last = int(np.searchsorted(at, piece.end, side="right"))
                if last > done:
                    found[:, done:last] = piece(at[done:last])
                done = last
        except Breakdown as trouble:
            trouble.filled = found[:, :done]
            raise
        if done and self.time > at[-1]:
            # Steps do not depend on where rows are asked for: the last one goes on where the next question begins.
            self._beyond = piece, self.state
            self.time, self.state = float(at[-1]), found[:, -1].copy()
        return found

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
            self._sides = self._choose((), ())
        for _ in range(MOST_TOGETHER):
            piece, place, turned = self._tried(until)
            if not turned:
                return self._taken(piece)
            if place > piece.start + TOGETHER * max(1.0, abs(place)):
                return self._landed(place, turned)
            self._note_switch()
            self._switch(turned)
        raise self._endless("its switches lead back to each other")

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
        place, turned = self._first(piece)
        return piece, place, turned

    def _bound(self, until: float | None) -> float:
        bound = self.time + FAR * (1.0 + abs(self.time)) if until is None else until  # at rest steps know no bound
        if self._longest is not None:
            bound = min(bound, self.time + self._longest)
        for window in self._windows:
            if self.time < window.start:
                bound = min(bound, window.start)
            elif self.time < window.end:
                bound = min(bound, max(self.time + window.longest, np.nextafter(self.time, inf)))
        return bound

    def _inner_step(self, bound: float) -> Piece:
        """A step of the run on these sides, from the state where this run is."""
        assert self._sides is not None
        run = self._run(self._sides)
        if run is not self._ahead or run.time != self.time:
            run.restart(self.time, self.state)
            self._ahead = run
        if self.work.steps >= self._setting.step_limit:
            raise Breakdown(STEP_LIMIT, f"{self.work.steps} steps", self.time, np.array(self.state, dtype=float))
        before, changes = {name: getattr(run.work, name) for name in COUNTS}, len(run.work.changes)
        try:
            return run.step(bound)
        finally:
            for name in COUNTS:
                setattr(self.work, name, getattr(self.work, name) + getattr(run.work, name) - before[name])
            self.work.changes += run.work.changes[changes:]

    def _run(self, sides: tuple[int, ...]) -> Run:
        if not sides:
            return self._runs[None]
        frozen = self._dynamics.on_sides(sides)
        if frozen.sliding not in self._runs:
            started = perf_counter()
            found = self._method.start(frozen, self._setting, self._scalar, self.state, self.time)
            self._runs[frozen.sliding] = found
            self.work.compiling += perf_counter() - started
        return self._runs[frozen.sliding]

    def _go_back(self, time: float, state: Any) -> None:
        self.time, self.state, self._ahead = time, state, None

    def _taken(self, piece: Piece) -> Piece:
        assert self._ahead is not None
        self._note_narrow(piece)
        self._check_sides(piece)
        self.time, self.state = piece.end, self._ahead.state
        self._windows = [window for window in self._windows if window.end > self.time]
        self._together = 0
        return piece

    def _landed(self, place: float, turned: tuple[int, ...]) -> Piece:
        """The step once more, to where the switch is; the next one begins on the other side."""
        self._go_back(self.time, self.state)
        piece = self._inner_step(place)
        if piece.end < place:  # the step before it was longer than those from a restart: go on from its end
            self._note_narrow(piece)
            self.time, self.state = piece.end, self._ahead.state if self._ahead is not None else self.state
            return piece
        self._note_narrow(piece)
        assert self._ahead is not None
        self._check_landing(piece, self._ahead.state, turned)
        apart = place - self.time
        self.time, self.state = piece.end, self._ahead.state
        self._together = 0 if apart > 1e-9 * max(1.0, abs(place)) else self._together + 1
        if self._together > MOST_TOGETHER:
            raise self._endless("they come ever closer to each other")
        self._note_switch()
        self._switch(turned)
        return piece

    def _note_switch(self) -> None:
        kept = self.passed.switches
        if len(kept) < MOST_KEPT and not (kept and kept[-1] == self.time):
            kept.append(self.time)

    # --- sides ---

    def _switch(self, turned: tuple[int, ...]) -> None:
        """Other sides for some switches: those that the motion then stays on."""
        assert self._sides is not None
        self._sides = self._choose(self._sides, turned)
        self._ahead = None

    def _choose(self, before: tuple[int, ...], turned: tuple[int, ...]) -> tuple[int, ...]:
        """The sides from here on: of the present ones those in ``turned`` change; all are looked for where none is."""
        values = self._values(self.time, self.state)
        sides = list(before) if before else [0 if abs(v) <= self._blur(v) else int(np.sign(v)) for v in values]
        open_ = list(turned) if before else [k for k, side in enumerate(sides) if side == 0]
        for k in open_:
            was = sides[k]
            if before and was == SLIDING:  # it leaves where the sign that held it has become that of a side
                frozen = self._dynamics.on_sides(before)
                sides[k] = 1 if self._holding(frozen, self.time, self.state)[0] > 0 else -1
                continue
            first = -was if was else 1
            for side in (first, -first):
                sides[k] = side
                if self._stays(tuple(sides), k):
                    break
            else:
                sides[k] = SLIDING
                self._check_sliding(tuple(sides))
        return tuple(sides)

    def _stays(self, sides: tuple[int, ...], k: int) -> bool:
        """Whether a motion that begins on g_k = 0 goes to the given side of it, or stays: by two short steps."""
        state = np.asarray(self.state, dtype=float)
        frozen = self._dynamics.on_sides(tuple(side or 1 for side in sides) if sides.count(0) > 1 else sides)
        rates = compiled_kernel(frozen, "right_hand_side")(np.concatenate(([self.time], state)))
        scale = np.max(np.abs(state), initial=0.0) + np.max(np.abs(rates), initial=0.0) + abs(self.time) + 1.0
        reach = 1e-6 * (1.0 + np.max(np.abs(state), initial=0.0)) / (1.0 + np.max(np.abs(rates), initial=0.0))
        begun = self._values(self.time, state)[k]
        # A Taylor step of third order: g may begin to move by its second derivative only.
        for length in (reach, 1e3 * reach):
            later = state + length * rates
            middle = compiled_kernel(frozen, "right_hand_side")(np.concatenate(([self.time + length], later)))
            later = state + 0.5 * length * (rates + middle)
            moved = self._values(self.time + length, later)[k] - begun
            if abs(moved) > 1e-15 * scale * 4:
                return bool(moved * sides[k] > 0)
        return True

    def _check_sliding(self, sides: tuple[int, ...]) -> None:
        if sides.count(SLIDING) > 1:
            raise self._endless("two of its switches would have to hold at once")
        frozen = self._dynamics.on_sides(sides)
        sign, curvature = self._holding(frozen, self.time, self.state)
        if not abs(sign) <= 1 + 1e-9 or not abs(curvature) <= 1e-9 * max(1.0, abs(sign)):
            raise self._endless("no force between the two sides holds it there")

    @staticmethod
    def _holding(frozen: Frozen, times: Any, states: Any) -> Any:
        point = np.vstack([np.atleast_1d(np.asarray(times, float)), np.asarray(states, float).reshape(len(states), -1)])
        return np.squeeze(once(frozen, "holding", lambda: kernel(frozen.holding))(point))

    def _endless(self, why: str) -> Breakdown:
        return Breakdown(SWITCHING, why, self.time, np.array(self.state, dtype=float))

    def _values(self, time: float, state: Any) -> Any:
        return self._switch_values(np.concatenate(([float(time)], np.asarray(state, dtype=float))))

    @staticmethod
    def _blur(size: Any) -> Any:
        return BLUR * (1.0 + np.abs(size))

    # --- where sides are left ---

    def _first(self, piece: Piece) -> tuple[float, tuple[int, ...]]:
        """The first time at which switches leave their sides in a piece, and which do so then; (end, ()) if none."""
        if not self._count or self._sides is None:
            return piece.end, ()
        found: list[tuple[float, int]] = []
        whole = along(self._leaving, piece, piece.start, piece.end)
        for k in range(self._count):
            place = self._left(k, piece, piece.start, piece.end, whole[k], DEPTH)
            if place is not None:
                found.append((place, k))
        if not found:
            return piece.end, ()
        first = min(place for place, _ in found)
        together = TOGETHER * max(1.0, abs(first))
        return first, tuple(k for place, k in found if place <= first + together)

    def _leaving(self, points: Any) -> Any:
        """g_k s_k, positive on its side; of a sliding switch 1 - s^2."""
        assert self._sides is not None
        values = np.array(self._switch_values(points)) * np.array(self._sides)[:, None]
        if SLIDING in self._sides:
            frozen = self._dynamics.on_sides(self._sides)
            sign = once(frozen, "holding", lambda: kernel(frozen.holding))(points)[0]
            values[self._sides.index(SLIDING)] = 1.0 - sign * sign
        return values

    def _left(self, k: int, piece: Piece, start: float, end: float, values: Any, depth: int) -> float | None:
        """Where a function that begins positive, or at 0, becomes negative."""
        if not np.all(np.isfinite(values)):
            return None
        size = float(np.max(np.abs(values)))
        begins = start == piece.start
        shifted = values - min(values[0], 0.0) if begins else values
        known = series(shifted)
        if free_of_zeros(known) and shifted[0] > 0:
            return None
        if not resolved(known, 1e-14 * size) and depth > 0:
            middle = 0.5 * (start + end)
            for a, b in ((start, middle), (middle, end)):
                place = self._left(k, piece, a, b, along(self._leaving, piece, a, b)[k], depth - 1)
                if place is not None:
                    return place
            return None
        if not resolved(known, 1e-14 * size) and len(self.passed.unresolved) < MOST_KEPT:
            self.passed.unresolved.append(start)
        # Beside a switch that was just passed, what is within the tolerance of it is at it.
        near = 0.1 * (self._setting.tolerance or 0.0) if begins and abs(values[0]) < 1e-6 * (1 + size) else 0.0
        passed, _, _ = passages(known, Sign(1, begins), max(BLUR * size, near))
        down = [one.place for one in passed if one.turn < 0]
        if not down:
            return None
        return self._polished(k, piece, start + 0.5 * (down[0] + 1) * (end - start), start, end)

    def _polished(self, k: int, piece: Piece, guess: float, start: float, end: float) -> float:
        """The zero of g itself on the dense output, beside that of its interpolant; by bisection."""

        def value(time: float) -> float:
            return float(self._leaving(np.vstack([[[time]], np.asarray(piece(np.array([time])), float)]))[k, 0])

        reach = 1e-12 * (end - start)
        while reach < end - start:
            left, right = max(start, guess - reach), min(end, guess + reach)
            if value(left) > 0 >= value(right):
                for _ in range(80):
                    middle = 0.5 * (left + right)
                    if middle in (left, right):
                        break
                    left, right = (middle, right) if value(middle) > 0 else (left, middle)
                return right
            reach *= 16
        return guess

    def _check_sides(self, piece: Piece) -> None:
        """A step that ends on another side than it was made for has missed a switch: nothing may hide that."""
        if not self._count or self._ahead is None:
            return
        point = np.concatenate(([piece.end], np.asarray(self._ahead.state, dtype=float)))[:, None]
        values, sizes = self._leaving(point)[:, 0], np.abs(self._switch_values(point)[:, 0])
        middle = along(self._leaving, piece, piece.start, piece.end)
        allowed = 1e-6 * (np.max(np.abs(middle), axis=1) + sizes) + 1e-9
        if np.any(values < -allowed):
            raise Breakdown(SWITCHING, "a switch was missed", piece.end, np.array(self._ahead.state, dtype=float))

    def _check_landing(self, piece: Piece, state: Any, turned: tuple[int, ...]) -> None:
        """A step to a switch has to end at it."""
        state = np.array(state, dtype=float)
        sizes = np.max(np.abs(along(self._leaving, piece, piece.start, piece.end)), axis=1)
        left = np.abs(self._leaving(np.concatenate(([piece.end], state))[:, None])[:, 0])
        if np.any(left[list(turned)] > (1e-5 * sizes + 1e-7)[list(turned)]):
            raise Breakdown(SWITCHING, "a switch is not where it should be", piece.end, state)

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


def _kernel(dynamics: Dynamics, name: str) -> Callable[[Any], Any]:
    code = getattr(dynamics.features, name)
    return once(dynamics, ("features", name), lambda: kernel(code)) if code.outputs else lambda points: np.empty((0,))
