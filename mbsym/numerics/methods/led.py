"""Constraints and integration methods: every step ends on the constraints, and so do the states between.

    x <- x + correction(t, x),  twice:       dq  = -M^-1 J^T (J M^-1 J^T)^-1 f,   dq' likewise of  J q' + j

The correction is the shortest, measured by the kinetic energy (``mbsym.mechanics.constraints.dynamics``).  What a step
strays is of the order of its local error, so a method keeps its order (Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.2).  Compiled methods do it in machine code (``marching``), others through ``lead``; what lies between
the ends of steps is led back here.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.bridge import Bridge, bridge
from mbsym.numerics.methods.interface import SINGULAR_CONSTRAINTS, Breakdown, Passed, Piece, Run, Unusable, met_by
from mbsym.numerics.methods.kept import compiled_kernel

#: Newton's steps for a state between the ends of steps.
TIMES = 2

#: A correction beyond this part of the state is none: the constraints are nearly singular there.
LARGEST_PART = 1e-2

DO = Message("these methods do: rk4, rk45, dop853, taylor, scipy-rk45, scipy-dop853, radau, bdf")

#: So many states at ends of steps or questions are kept, to look back from a singular position.
REMEMBERED = 400


class Lead:
    """(t, states) -> the states on the constraints: (2n,) at one time or (2n, m) at m.

    A state whose correction is no number, or large, stays as it is.
    """

    def __init__(self, dynamics: Dynamics, scalar: str) -> None:
        self._correct = compiled_kernel(dynamics, "correction", scalar)

    def __call__(self, times: Any, states: Any) -> Any:
        found = np.array(states)
        with np.errstate(all="ignore"):
            for _ in range(TIMES):
                change = self._correct(_points(times, found))[:-1]
                size = np.max(np.abs(change), axis=0)
                near = size <= LARGEST_PART * (1 + np.max(np.abs(found), axis=0))
                found = found + np.where(near, change, 0.0)
        return found

    def nearness(self, times: Any, states: Any) -> Any:
        """How near to a singular position: beyond 1 nothing is computed; about 1/distance^2."""
        with np.errstate(all="ignore"):
            return self._correct(_points(times, np.asarray(states)))[-1]

    def near(self, time: float, state: Any) -> bool:
        """Whether a run has to end there."""
        return bool(self.nearness(time, state) > 1)


def _points(times: Any, states: Any) -> Any:
    return np.concatenate([np.atleast_1d(times)[None] if states.ndim > 1 else [times], states])


def lead(dynamics: Dynamics, scalar: str = "float64") -> Lead | None:
    """What leads states back to the constraints; None where there are none."""
    return None if dynamics.correction is None else Lead(dynamics, scalar)


def nearly_singular(time: Any, state: Any) -> Breakdown:
    """The end of a run before a singular position of the constraints."""
    message = "the constraints are about to lose their rank, and the accelerations with them"
    return Breakdown(SINGULAR_CONSTRAINTS, message, float(time), np.array(state, dtype=float))


def refuse(dynamics: Dynamics, method: str) -> None:
    """Raises Unusable for a method that does not lead states back, where there is something to be kept."""
    if dynamics.constraints is not None:
        told = dynamics.constraints.told()
        raise Unusable(
            Message("[[method]] does not keep to constraints ([[told]]); [[these]]", method=method, told=told, these=DO)
        )
    if dynamics.correction is not None:
        text = "[[method]] does not keep quaternions and unit vectors at their lengths; [[these]]"
        raise Unusable(Message(text, method=method, these=DO))


class LedRun:
    """A run whose states are on the constraints between the ends of its steps, and that passes singular positions.

    ``begin`` starts the method at a time in a state, without any of this.
    """

    def __init__(self, inner: Run, led: Lead, begin: Callable[[float, Any], Run]) -> None:
        self._inner, self._led, self._begin = inner, led, begin
        self.time, self.work = inner.time, inner.work
        self.state = led(inner.time, inner.state)
        self._past: deque[tuple[float, Any]] = deque([(float(self.time), np.array(inner.state))], REMEMBERED)
        self._bridge: Bridge | None = None

    @property
    def passed(self) -> Passed | None:
        """What it has met."""
        return met_by(self._inner)

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``; raises Breakdown."""
        if until > self.time:
            self.fill(np.array([until]))
        return self.state

    def step(self, until: float | None = None) -> Piece:
        """The solution to the end of a step, or to ``until``; raises Breakdown."""
        led = self._led
        if self._bridge is None:
            try:
                piece = self._inner.step(until)
                self._arrived()
                return Piece(piece.start, piece.end, lambda times: led(times, piece.curve(times)))
            except Breakdown as trouble:
                self._bridged(trouble)
        bridge, start = self._bridge, self.time
        assert bridge is not None
        end = bridge.end if until is None else min(until, bridge.end)
        self._along(bridge, end)
        return Piece(start, end, bridge.curve)

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times; raises Breakdown with those that there are."""
        at = np.asarray(times)
        found = np.empty((len(self.state), len(at)), np.asarray(self.state).dtype)
        done = 0
        while done < len(at):
            if self._bridge is not None:
                last = max(done, int(np.searchsorted(at, self._bridge.end, side="right")))
                if last > done:
                    found[:, done:last] = self._bridge.curve(at[done:last])
                done = last
                self._along(self._bridge, float(at[-1]) if done == len(at) else self._bridge.end)
                continue
            try:
                found[:, done:] = self._led(at[done:], self._inner.fill(at[done:]))
                done = len(at)
                self._arrived()
            except Breakdown as trouble:
                made = 0 if trouble.filled is None else trouble.filled.shape[1]
                if made:
                    found[:, done : done + made] = self._led(at[done : done + made], trouble.filled)
                done += made
                trouble.filled = found[:, :done]
                self._bridged(trouble)
                # Rows that the last step before it has passed by are on its curve, not on the bridge.
                bridge = self._bridge
                assert bridge is not None
        return found

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state."""
        self._bridge = None
        self._inner.restart(time, state)
        self._past.clear()
        self._arrived()

    def _arrived(self) -> None:
        self.time = self._inner.time
        self.state = self._led(self.time, self._inner.state)
        self._past.append((float(self.time), np.array(self._inner.state)))  # to the last bit, to be repeated

    def _bridged(self, trouble: Breakdown) -> None:
        """The way over a singular position; raises what ended the run where that is another thing, or none is found."""
        if trouble.kind != SINGULAR_CONSTRAINTS:
            raise trouble
        found = bridge(self._led, self._begin, self._past, trouble)
        if found is None:
            raise trouble
        self._bridge = found
        self.work.singular.append(found.singular)

    def _along(self, over: Bridge, until: float) -> None:
        """On the way over a singular position; at its end the run goes on from there."""
        if until < over.end:
            self.time, self.state = until, over.curve(np.array([until]))[:, 0]
            return
        self._bridge = None
        self._inner.restart(over.end, over.arrived)
        self._past.clear()  # a repetition from before would stop where this run did
        self._arrived()
