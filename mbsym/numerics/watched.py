"""A method whose runs are watched for events, and end where one of them asks for it.

The steps are those of the method itself: events look at its pieces and change nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.events import BATCH, Occurrences, Watcher
from mbsym.numerics.events.surfaces import Event
from mbsym.numerics.methods.interface import Breakdown, Cause, Method, Passed, Piece, Run, Setting, met_by
from mbsym.numerics.methods.nested import states_on
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.simulate import Trajectory, least_pivot, simulate

#: (dynamics, events, tolerance, flow) -> the watcher of a run.
Watch = Callable[..., Watcher]


class Watched:
    """``method``, watched for ``events`` of the whole system ``dynamics``; ``watcher`` is that of the last run."""

    def __init__(self, method: Method, dynamics: Dynamics, events: Sequence[Event], watch: Watch = Watcher) -> None:
        self.traits = method.traits
        self.method, self.events = method, tuple(events)
        self._dynamics, self._watch = dynamics, watch
        self._run: WatchedRun | None = None

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> WatchedRun:
        """A run that ends with a Breakdown of kind ``STOPPED`` where an event asks for it."""
        inner = self.method.start(dynamics, setting, scalar, initial, at)
        anew: list[Run] = []

        def flow(piece: Any, time: float) -> Any:
            """The state at a time of a piece, integrated from its start."""
            if not anew:
                anew.append(self.method.start(dynamics, setting, scalar, initial, at))
            anew[0].restart(piece.start, piece(piece.start))
            return np.asarray(anew[0].advance(time), dtype=float)

        watcher = self._watch(self._dynamics, self.events, setting.tolerance, flow)
        self._run = WatchedRun(inner, watcher)
        return self._run

    def occurrences(self, end: float) -> Occurrences:
        """What happened in the last run up to ``end``, where it ended."""
        assert self._run is not None
        return self._run.watcher.finish(end)


class WatchedRun:
    """A run that shows its pieces to a watcher."""

    def __init__(self, inner: Run, watcher: Watcher) -> None:
        self._inner, self.watcher = inner, watcher
        self.work = inner.work
        self.time, self.state = inner.time, inner.state
        self._piece: Piece | None = None
        self._filled = 0
        watcher.begin(np.asarray(inner.state, dtype=float), float(inner.time))

    @property
    def passed(self) -> Passed | None:
        """What is not smooth, or narrow, on the way."""
        return met_by(self._inner)

    def advance(self, until: float) -> Any:
        """The state at ``until``."""
        return self.fill([until])[:, 0]

    def fill(self, times: Sequence[float]) -> Any:
        """The states at increasing times; raises Breakdown with those that there are."""
        moments = np.asarray(times, dtype=float)
        states = np.empty((len(self.state), len(moments)), dtype=np.asarray(self.state).dtype)
        # The first of them may be where the run is.
        done = 0 if self._piece is not None else int(np.searchsorted(moments, self.time, side="right"))
        states[:, :done] = np.asarray(self.state)[:, None]
        try:
            while done < self._upto(moments):
                done = self._some(moments, states, done)
        except Breakdown as breakdown:
            if not self.watcher.settle():
                breakdown.filled = states[:, : self._filled]
                raise
            done = self._filled
        self.watcher.settle()
        if len(moments) and self._end <= moments[-1]:
            self._stopped(states[:, : min(done, self._upto(moments))])
        if len(moments):
            self.time, self.state = float(moments[-1]), states[:, -1].copy()
        return states

    def _some(self, moments: Any, states: Any, done: int) -> int:
        """Fills the rows of the next few steps; how many are done then, a Breakdown on the way or not."""
        pieces: list[Piece] = []
        parts: list[Any] = []
        upto, piece = done, self._piece
        try:
            while upto < len(moments) and len(pieces) < BATCH:
                if piece is None or piece.end < moments[upto]:
                    piece = self._next()
                last = upto + int(np.searchsorted(moments[upto:], piece.end, side="right"))
                pieces.append(piece)
                parts.append(moments[upto:last])
                upto = last
        finally:
            if upto > done:
                states[:, done:upto] = states_on(pieces, parts)
            self._filled = upto
        return upto

    def step(self, until: float | None = None) -> Piece:
        """One step, shown to the watcher."""
        piece = self._next(until)
        if self.watcher.settle():
            self._stopped(np.empty((len(self.state), 0)))
        self.time, self.state = piece.end, self._inner.state
        return piece

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state; events before and after are those of one run."""
        self._inner.restart(time, state)
        self._piece, self.time, self.state = None, time, self._inner.state

    def _next(self, until: float | None = None) -> Piece:
        self._piece = piece = self._inner.step() if until is None else self._inner.step(until)
        self.watcher.see(piece)
        return piece

    @property
    def _end(self) -> float:
        ended = self.watcher.ended
        return float("inf") if ended is None else ended.time

    def _upto(self, moments: Any) -> int:
        """How many of the times are not after the end."""
        return int(np.searchsorted(moments, self._end, side="right"))

    def _stopped(self, filled: Any) -> None:
        ended = self.watcher.ended
        assert ended is not None
        self.time, self.state = ended.time, ended.state
        event = self.watcher.events[ended.event]
        raise Breakdown(Cause.STOPPED, event.text, ended.time, ended.state, filled)


# What a run does between rows that are far apart: the same run at the ends of its steps and midway between them.
#
# A force that acts between two rows and at neither of them changes an energy; whoever looks at rows alone sees no
# force.


#: Steps whose ends are looked at one by one, and places in what is left of the interval.
MOST, PLACES = 4_000, 4_000

#: Runs that cost more than this (``mbsym.numerics.planning.prices``) are not run again.
LONG = 2.0


def between_rows(dynamics: Dynamics, trajectory: Trajectory, method: Method, scalar: str) -> Trajectory:
    """The trajectory with more rows, where its steps are many beside its rows; else as it is."""
    if (
        not trajectory.whole
        or cost(dynamics, trajectory.method, scalar, trajectory.work) > LONG
        or 2 * trajectory.work.steps < trajectory.samples
    ):
        return trajectory
    end, run = float(trajectory.times[-1]), method.start(dynamics, trajectory.setting, scalar)
    places = [0.0]
    try:
        with np.errstate(all="ignore"):
            while places[-1] < end and len(places) < MOST:
                places.append(min(float(run.step().end), end))
    except Breakdown:
        return trajectory  # a step that would have gone beyond the end
    places += [(left + right) / 2 for left, right in pairwise(places)]
    reached = max(places)
    rest = np.linspace(reached, end, PLACES if reached < end else 0)
    times = np.unique(np.concatenate([places, rest, trajectory.times]))
    more = simulate(dynamics, method, trajectory.setting, times.tolist(), scalar)
    return more if more.whole else trajectory


def nearest_to_singular(
    dynamics: Dynamics, trajectory: Trajectory, dense: Trajectory, method: Method, scalar: str
) -> tuple[float, float]:
    """(ratio, t) of ``least_pivot`` over rows and ends of steps, which crowd where M is nearly singular.

    ``dense`` is what ``between_rows`` made of ``trajectory``.  Rows alone are looked at where a run was dear,
    ended early,
    or has more than ``MOST`` steps, beyond those.
    """
    lowest = least_pivot(dynamics, dense)
    if (
        dense is not trajectory
        or not trajectory.whole
        or cost(dynamics, trajectory.method, scalar, trajectory.work) > LONG
    ):
        return lowest
    end, run = float(trajectory.times[-1]), method.start(dynamics, trajectory.setting, scalar)
    times, states = [float(run.time)], [np.array(run.state)]
    try:
        with np.errstate(all="ignore"):
            while times[-1] < end and len(times) < MOST:
                run.step(end)
                times.append(float(run.time))
                states.append(np.array(run.state))
    except Breakdown:
        pass  # a step made otherwise than the run's own; those before it count
    ends = replace(trajectory, times=np.array(times), states=np.column_stack(states))
    return min(lowest, least_pivot(dynamics, ends))
