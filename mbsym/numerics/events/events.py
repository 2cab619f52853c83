"""Events along a run: every time at which g(t, q, q') passes zero, in order, with the state there.

Each step of a method comes as a ``Piece``, its dense output.  On a piece g is interpolated at Chebyshev's points
(``events.crossings``), pieces on which that does not give g are cut in two, down to 2**-DEPTH of a step; so no
sign change is missed within a step, however many there are, but for those of a g that jumps back and forth within
so small a part.  The time is then polished on the solution itself: with the motion integrated anew from the start of
the step,

    t <- t - g / (dg/dt)

What the run cannot tell apart is not told apart.  A step is wrong by about tol (1 + |x|), and so g by

    blur = tol sum_i |dg/dx_i| (1 + |x_i|)        (and by the rounding of t, eps |t dg/dt|);

g has passed zero when it has left the blur on the other side, and *touches* zero where it comes back on the same side.
Where it comes to zero and stays there to the end, as friction brings a motion to rest, it has come down or up to it.
A touch may be two passages or none; it is recorded with direction 0 for events in both directions, and stops nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.crossings import NODES, Sign, free_of_zeros, nodes, passages, resolved, series
from mbsym.numerics.events.surfaces import Action, Direction, Event, slopes_code, values_code
from mbsym.numerics.kernels.llvm import kernel, kernels
from mbsym.numerics.methods.interface import Piece
from mbsym.numerics.methods.magnitudes import about
from mbsym.numerics.methods.nested import states_on

#: Pieces are looked at so many at a time.
BATCH = 32

#: A piece is cut in two at most so many times.
DEPTH = 12

#: No arithmetic is finer than so many roundings; a method of fixed step is taken to be as good as this.
ROUNDINGS, OF_FIXED_STEP = 16, 1e-12

#: So many occurrences are kept; further ones are counted.
MOST = 1_000_000


@dataclass(frozen=True)
class Occurrence:
    """Of ``event``, by its place in the list, at ``time``: rising (``turn`` 1), falling (-1), or touching (0)."""

    event: int
    time: float
    turn: int
    state: Any


@dataclass(frozen=True)
class Occurrences:
    """What happened along a run, in order of time: ``times``, ``which`` event, ``turns`` (m,), ``states`` (2n, m).

    ``ended`` is the occurrence that stopped the run; ``undecided`` are events of which g stayed within the blur all
    along, so that nothing can be said of them; ``beyond`` so many occurrences were not kept.
    """

    events: tuple[Event, ...]
    times: Any
    which: Any
    turns: Any
    states: Any
    ended: Occurrence | None = None
    undecided: tuple[Event, ...] = ()
    beyond: int = 0

    def of(self, name: str) -> Any:
        """The times of one event, by its name.  Raises KeyError where there is none."""
        places = [place for place, event in enumerate(self.events) if event.name == name]
        if not places:
            raise KeyError(name)
        return self.times[np.isin(self.which, places)]

    def __len__(self) -> int:
        return len(self.times)


#: (piece, time) -> the state of the motion that starts where the piece does.
Flow = Callable[[Piece, float], Any]


def sampled(pieces: Sequence[Piece]) -> Any:
    """(t, q, q') in columns at the nodes of every piece, one piece after the other."""
    times = [nodes(float(piece.start), float(piece.end)) for piece in pieces]
    return np.vstack([np.concatenate(times), np.asarray(states_on(pieces, times), dtype=float)])


@dataclass
class _Course:
    """How far one event has been followed: the sign of g, and where it was nearest to zero since it lost that.

    ``stays``: since then it has been within the blur all along some part of the motion, as where friction holds: it
    was nearest where it came.
    """

    sign: Sign = field(default_factory=Sign)
    near: tuple[float, Piece] | None = None
    stays: bool = False
    left: bool = False  # whether g has ever been outside the blur


class Watcher:
    """Is shown the pieces of a run one after the other, and finds the events in them."""

    def __init__(self, dynamics: Dynamics, events: Sequence[Event], tolerance: float | None, flow: Flow) -> None:
        self.events = tuple(events)
        named = {f"event{place}": slopes_code(dynamics, event) for place, event in enumerate(self.events)}
        self._slopes = list(kernels(named).values())
        self._values = kernel(values_code(dynamics, self.events))
        self._tolerance = max(OF_FIXED_STEP if tolerance is None else tolerance, ROUNDINGS * np.finfo(float).eps)
        self._flow = flow
        self._courses = [_Course() for _ in self.events]
        self._waiting: list[Piece] = []
        self._found: list[Occurrence] = []
        self._beyond = 0
        self._sizes = np.zeros(len(self.events))
        self._dynamics, self._state_sizes = dynamics, np.zeros((dynamics.dimension, 1))
        self._start = 0.0
        self.ended: Occurrence | None = None

    def begin(self, state: Any, time: float = 0.0) -> bool:
        """Looks at the initial state; whether a condition that stops the run holds there already."""
        self._start = time
        self._state_sizes = about(self._dynamics, time, state).sizes
        for place, event in enumerate(self.events):
            value = float(self._slopes[place](np.concatenate(([time], state)))[0])
            holds = value * event.side > 0 or (event.closed and value == 0)
            if event.action is Action.STOP and event.side and holds and self.ended is None:
                self.ended = Occurrence(place, time, event.side, np.array(state, dtype=float))
                self._found.append(self.ended)
        return self.ended is not None

    def see(self, piece: Piece) -> bool:
        """Takes a piece; whether the run is known to have ended by now (it may end up to BATCH pieces earlier)."""
        self._waiting.append(piece)
        if len(self._waiting) >= BATCH:
            self.settle()
        return self.ended is not None

    def settle(self) -> bool:
        """Looks at all pieces that were taken; whether the run has ended in them."""
        waiting, self._waiting = self._waiting, []
        if not waiting or self.ended is not None:
            return self.ended is not None
        values = self._values(sampled(waiting))
        coefficients = series(values.reshape(len(self.events), len(waiting), NODES))
        free, signs = free_of_zeros(coefficients) & ~self._faint(coefficients), np.sign(coefficients[..., 0])
        met: list[Occurrence] = []
        for event, course in enumerate(self._courses):
            same = np.ones(len(waiting), bool)
            same[1:] = free[event, :-1] & (signs[event, 1:] == signs[event, :-1])
            same[0] = not course.sign.near and course.sign.last == signs[event, 0]
            for place in np.flatnonzero(~(free[event] & same)):
                piece = waiting[place]
                blur = self._blur(event, piece)
                met += self._within(event, piece, piece.start, piece.end, coefficients[event, place], blur, DEPTH)
        self._keep(met)
        return self.ended is not None

    def _faint(self, coefficients: Any) -> Any:
        """Pieces (events, pieces) on which g may come within the tolerance of zero, in parts of its largest value."""
        with np.errstate(invalid="ignore"):
            sizes = np.sum(np.abs(coefficients), axis=-1)
            self._sizes = np.fmax(self._sizes, np.nanmax(sizes, axis=1, initial=0.0))
            least = 2 * np.abs(coefficients[..., 0]) - sizes
            return least <= self._tolerance * self._sizes[:, None]

    def finish(self, end: float) -> Occurrences:
        """Everything that was found up to ``end``; what has begun there and is not over counts as having happened."""
        if not self.settle():
            self._keep([occurrence for event in range(len(self.events)) for occurrence in self._unfinished(event)])
        latest = end + 8 * np.finfo(float).eps * abs(end)
        if self.ended is not None and self.ended.time > latest:
            self.ended = None  # a step may lead beyond the end
        occurrences = sorted(
            (
                replace(candidate, time=min(candidate.time, end))
                for candidate in self._found
                if candidate.time <= latest
            ),
            key=lambda candidate: (candidate.time, candidate.event),
        )
        undecided = () if self.ended is not None else tuple(self._undecided())
        return Occurrences(
            events=self.events,
            times=np.array([occurrence.time for occurrence in occurrences]),
            which=np.array([occurrence.event for occurrence in occurrences], dtype=int),
            turns=np.array([occurrence.turn for occurrence in occurrences], dtype=int),
            states=np.array([occurrence.state for occurrence in occurrences]).T if occurrences else np.empty((0, 0)),
            ended=self.ended,
            undecided=undecided,
            beyond=self._beyond,
        )

    # --- one event in one piece ---

    def _within(
        self, event: int, piece: Piece, start: float, end: float, known: Any, blur: float, depth: int
    ) -> list[Occurrence]:
        """What happens between two times of a piece, where g has the series ``known``; nothing where g has no value."""
        course = self._courses[event]
        if not np.all(np.isfinite(known)):
            return []
        met: list[Occurrence] = []
        if not resolved(known, blur) and not free_of_zeros(known) and depth > 0:
            middle = 0.5 * (start + end)
            for a, b in ((start, middle), (middle, end)):
                part = series(self._on(event, piece, nodes(a, b))[0])
                met += self._within(event, piece, a, b, part, blur, depth - 1)
            return met
        blur = max(blur, ROUNDINGS * np.finfo(float).eps * float(np.sum(np.abs(known))))
        begins = piece.start == self._start and abs(float(known @ (-1.0) ** np.arange(NODES))) <= blur
        passed, sign, nearest = passages(known, course.sign, blur)
        for passage in passed:
            time, where = start + 0.5 * (passage.place + 1) * (end - start), piece
            if course.near is not None and course.sign.near and passage is passed[0] and passage.place == -1:
                time, where = course.near
            if course.sign.last == 0 and passage is passed[0] and begins:
                time = self._start
            met.append(self._occurrence(event, where, time, passage.turn))
        stays = course.sign.near and not passed and float(np.sum(np.abs(known))) <= blur
        course.stays = sign.near and (course.stays or stays)
        if sign.near and not stays and (course.near is None or not course.sign.near or passed or nearest > -1):
            course.near = (start + 0.5 * (nearest + 1) * (end - start), piece)
        course.sign, course.left = sign, course.left or sign.last != 0
        return met

    def _on(self, event: int, piece: Piece, times: Any) -> Any:
        """(g, dg/dt, o, derivatives) at times of a piece."""
        return self._slopes[event](np.vstack([times, np.asarray(piece(times), dtype=float)]))

    def _blur(self, event: int, piece: Piece) -> float:
        """tol sum |dg/dx_i| (S_i + |x_i|) and what g changes by within the rounding of the time, at worst.

        S_i are the sizes of the scene about the state where the run began.
        """
        times = nodes(piece.start, piece.end)
        states = np.asarray(piece(times), dtype=float)
        _, rates, _, *derivatives = self._slopes[event](np.vstack([times, states]))
        with np.errstate(all="ignore"):
            sizes = self._tolerance * np.sum(np.abs(derivatives) * (self._state_sizes + np.abs(states)), axis=0)
            sizes += ROUNDINGS * np.finfo(float).eps * np.abs(times * rates)
        return float(np.max(sizes[np.isfinite(sizes)], initial=0.0))

    def _occurrence(self, event: int, piece: Piece, time: float, turn: int) -> Occurrence:
        """Polished on the motion from the start of the piece; the direction is that of a - b."""
        state = np.asarray(piece(np.array([time])), dtype=float)[:, 0]
        if turn and time > self._start:
            time, state = self._polished(event, piece, time, state)
        orientation = self._slopes[event](np.concatenate(([time], state)))[2]
        return Occurrence(event, time, turn * (1 if orientation > 0 else -1), state)

    def _polished(self, event: int, piece: Piece, time: float, state: Any) -> tuple[float, Any]:
        """Newton's method on the motion; the time on the dense output where it leads away."""
        length, guess, best = piece.end - piece.start, time, (time, state)
        for _ in range(4):
            if guess > piece.start:
                state = self._flow(piece, guess)
            value, slope = self._slopes[event](np.concatenate(([guess], state)))[:2]
            best = (guess, np.array(state, dtype=float))
            if not (np.isfinite(value) and np.isfinite(slope)) or slope == 0:
                return best
            following = max(guess - float(value / slope), piece.start)
            if abs(following - time) > 0.1 * length:
                return time, np.asarray(piece(np.array([time])), dtype=float)[:, 0]
            if abs(following - guess) <= 4 * np.finfo(float).eps * max(abs(guess), length):
                return best
            guess = following
        return best

    # --- what is kept ---

    def _keep(self, met: list[Occurrence]) -> None:
        """Those that count, up to the first that stops the run."""
        for occurrence in sorted(met, key=lambda candidate: (candidate.time, candidate.event)):
            event = self.events[occurrence.event]
            turns = {Direction.BOTH: (-1, 0, 1), Direction.RISING: (1,), Direction.FALLING: (-1,)}[event.direction]
            if occurrence.turn not in turns or (self.ended is not None and occurrence.time > self.ended.time):
                continue
            begun = occurrence.time > self._start or event.side
            if event.action is Action.STOP and occurrence.turn and begun and self.ended is None:
                self.ended = occurrence
            if len(self._found) < MOST or occurrence is self.ended:
                self._found.append(occurrence)
            else:
                self._beyond += 1

    def _unfinished(self, event: int) -> list[Occurrence]:
        """An event at the very end: g is within the blur there, and has not come out of it."""
        course = self._courses[event]
        if not (course.sign.near and course.left and course.near is not None):
            return []
        time, piece = course.near
        state = np.asarray(piece(np.array([time])), dtype=float)[:, 0]
        slope = float(self._slopes[event](np.concatenate(([time], state)))[1])
        turn = -course.sign.last if course.stays or slope * course.sign.last < 0 else 0
        occurrence = self._occurrence(event, piece, time, turn)
        return [occurrence]

    def _undecided(self) -> list[Event]:
        return [event for event, course in zip(self.events, self._courses, strict=True) if not course.left]
