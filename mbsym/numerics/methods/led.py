"""Constraints and integration methods: every step ends on the constraints, and so do the states between.

    x <- x + correction(t, x),  twice:       dq  = -M^-1 J^T (J M^-1 J^T)^-1 f,   dq' likewise of  J q' + j

The correction is the shortest, measured by the kinetic energy (``mbsym.mechanics.constraints.dynamics``).  What a step
strays is of the order of its local error, so a method keeps its order (Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.2).  Compiled methods do it in machine code (``marching``), others through ``lead``; what lies between
the ends of steps is led back here.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import (
    Breakdown,
    Cause,
    Passed,
    Piece,
    Run,
    Unusable,
    Work,
    compiled_kernel,
    met_by,
)
from mbsym.numerics.methods.magnitudes import counted, magnitudes, variables

# Over a singular position of the constraints, where accelerations do not follow from them.
#
# A four-bar whose links come in line, say: two branches of motion meet there, and J loses its rank.  The motion itself
# is smooth on its branch, but its accelerations are 0/0, and near it steps would shrink for ever.  It is continued by
# the polynomial that fits positions and velocities before,
#
#     q(t) = sum_k a_k T_k,      q and q' at ``NODES`` times in a window before the stop,
#
# over an interval that is short beside the window, and led back to the constraints behind the position.  That is
# accepted only if velocities and positions behind need no more than a small correction, and if the velocities lead from
# the positions before to those behind: another branch would show, or another motion on the same one.


#: Times in the window, the degree of the polynomial, and the window's length in distances to the singular position.
NODES, DEGREE, WINDOW = 24, 11, 60.0

#: The least window, in the same distances.
LEAST_WINDOW = 12.0

#: From so many places of the past a run is repeated at most.
REPETITIONS = 4

#: Behind the position, this many distances further.
BEYOND = 1.5

#: By how much positions and velocities may be corrected behind it, in parts of the state, and how well the polynomial
#: has to fit.
CORRECTED = 1e-6


@dataclass(frozen=True)
class Bridge:
    """From ``start`` to ``end``, where the state is ``arrived``; the singular position is about at ``singular``."""

    start: float
    end: float
    singular: float
    arrived: Any
    curve: Callable[[Any], Any]


def bridge(
    led: Any, begin: Callable[[float, Any], Run], past: Sequence[tuple[float, Any]], stop: Breakdown
) -> Bridge | None:
    """The way over the position before which a run stopped; None where there is no such position, or no safe way.

    ``led`` leads states to the constraints, ``past`` are states of the run, from which ``begin`` starts it again.
    """
    first, time = past[0][0], stop.time
    away = _distance(led, begin, past, stop)
    if away is None:
        return None
    # The step that came too near may have come much nearer than that.
    reach = away * float(np.sqrt(max(1.0, led.nearness(time, stop.state))))
    window = min(WINDOW * reach, time - first)
    if window < LEAST_WINDOW * reach:
        return None
    places = (1 - np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)) / 2
    history = _history(led, begin, past, time - window * (1 - places))
    if history is None or len(history[0]) < DEGREE:
        return None
    times, states = history
    n = len(states) // 2
    fitted = _Fitted(times, states[:n], states[n:])
    if fitted.misfit > CORRECTED:
        return None
    end = time + away + BEYOND * reach
    guess = fitted(np.array([end]))[:, 0]
    arrived = led(end, guess)
    size = led.sizes + np.max(np.abs(states), axis=1)
    near = bool(np.all(np.abs(arrived - guess) <= CORRECTED * size))
    halfway = fitted(np.array([(times[-1] + end) / 2]))[:, 0]
    by_velocities = (end - times[-1]) * (states[n:, -1] + 4 * halfway[n:] + arrived[n:]) / 6  # Simpson's rule
    near &= bool(np.all(np.abs(arrived[:n] - states[:n, -1] - by_velocities) <= CORRECTED * size[:n]))
    if not near or not np.all(np.isfinite(arrived)) or led.near(end, arrived):
        return None
    return Bridge(time, end, time + away, arrived, fitted)


def _history(
    led: Any, begin: Callable[[float, Any], Run], past: Sequence[tuple[float, Any]], times: Any
) -> tuple[Any, Any] | None:
    """Those of the times that the past reaches, and states at them from a repetition of the run; None without any.

    A repetition from amid the run takes other steps, one of which may come too near long before the stop; then it is
    tried from further back, as far as the beginning.
    """
    befores = [point for point in reversed(past) if point[0] <= times[0]] or [past[0]]
    longest: tuple[Any, Any] | None = None
    for start, state in (*befores[: REPETITIONS - 1], *befores[REPETITIONS - 1 :][-1:]):
        requested = times[times > start]
        try:
            states = begin(start, state).fill(requested) if len(requested) else None
        except Breakdown as earlier:
            states = earlier.filled
        made = 0 if states is None else states.shape[1]
        if made > (0 if longest is None else len(longest[0])):
            longest = requested[:made], states
        if made == len(requested):
            break
    return None if longest is None else (longest[0], led(*longest))


def _distance(
    led: Any, begin: Callable[[float, Any], Run], past: Sequence[tuple[float, Any]], stop: Breakdown
) -> float | None:
    """How long until the singular position: 1/sqrt(nearness) falls to zero in a straight line."""
    lengths = (stop.time - past[0][0]) * 0.5 ** np.arange(0.0, 40.0)
    history = _history(led, begin, past, stop.time - lengths)
    if history is None:
        return None
    now = 1 / np.sqrt(float(led.nearness(stop.time, stop.state)))
    before = 1 / np.sqrt(led.nearness(*history))
    away = np.flatnonzero(before >= 2 * now)
    if not len(away):
        return None
    last = away[-1]
    return float((stop.time - history[0][last]) * now / (before[last] - now))


class _Fitted:
    """The polynomials of q that fit q and q' in least squares; called, (q, q') at times."""

    def __init__(self, times: Any, positions: Any, velocities: Any) -> None:
        chebyshev = np.polynomial.chebyshev  # loaded here: few motions come so far
        self._middle, self._half = (times[0] + times[-1]) / 2, (times[-1] - times[0]) / 2
        share = (times - self._middle) / self._half
        values = chebyshev.chebvander(share, DEGREE)
        slopes = np.column_stack(
            [chebyshev.chebval(share, chebyshev.chebder(np.eye(DEGREE + 1)[k])) for k in range(DEGREE + 1)]
        )
        data = np.hstack([positions, self._half * velocities]).T.astype(float)
        rows = np.vstack([values, slopes])
        self._parts, *_ = np.linalg.lstsq(rows, data, rcond=None)
        apart = np.max(np.abs(rows @ self._parts - data), axis=0)
        self.misfit = float(np.max(apart / (1e-300 + np.max(np.abs(data), axis=0) + self._half)))

    def __call__(self, times: Any) -> Any:
        chebyshev = np.polynomial.chebyshev
        share = (np.asarray(times, dtype=float) - self._middle) / self._half
        places = chebyshev.chebval(share, self._parts)
        rates = chebyshev.chebval(share, chebyshev.chebder(self._parts)) / self._half
        return np.vstack([np.atleast_2d(places), np.atleast_2d(rates)])


#: Newton's steps for a state between the ends of steps.
TIMES = 2

#: A correction beyond this part of the state is none: the constraints are nearly singular there.
LARGEST_PART = 1e-2

#: So many states at ends of steps or questions are kept, to look back from a singular position.
REMEMBERED = 400


class Lead:
    """(t, states) -> the states on the constraints: (2n,) at one time or (2n, m) at m.

    A state whose correction is no number, or large, stays as it is.
    """

    def __init__(self, dynamics: Dynamics, scalar: str) -> None:
        self._dynamics, self._scalar = dynamics, scalar
        self._correct = compiled_kernel(dynamics, "correction", scalar)

    @cached_property
    def sizes(self) -> Any:
        """What the scene gives the components of its first state, (2n,)."""
        rates = counted(compiled_kernel(self._dynamics, "right_hand_side", self._scalar), Work())
        first = np.array([[float(x)] for x in self._dynamics.scenario.state])
        return magnitudes(rates, variables(self._dynamics), np.zeros(1), first).sizes[:, 0]

    def __call__(self, times: Any, states: Any) -> Any:
        corrected = np.array(states)
        sizes = self.sizes if corrected.ndim == 1 else self.sizes[:, None]
        with np.errstate(all="ignore"):
            for _ in range(TIMES):
                change = self._correct(_points(times, corrected))[:-1]
                near = np.all(np.abs(change) <= LARGEST_PART * (sizes + np.abs(corrected)), axis=0)
                corrected = corrected + np.where(near, change, 0.0)
        return corrected

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
    return Breakdown(Cause.SINGULAR_CONSTRAINTS, message, time, state)


def refuse(dynamics: Dynamics, method: str) -> None:
    """Raises Unusable for a method that does not lead states back, where there is something to be kept."""
    if dynamics.constraints is not None:
        listed = dynamics.constraints.told()
        raise Unusable(Message("constraints are not kept to ([[which]])", which=listed), method)
    if dynamics.correction is not None:
        raise Unusable(Message("quaternions and unit vectors are not kept at their lengths"), method)


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
        states = np.empty((len(self.state), len(at)), np.asarray(self.state).dtype)
        done = 0
        while done < len(at):
            if self._bridge is not None:
                last = max(done, int(np.searchsorted(at, self._bridge.end, side="right")))
                if last > done:
                    states[:, done:last] = self._bridge.curve(at[done:last])
                done = last
                self._along(self._bridge, float(at[-1]) if done == len(at) else self._bridge.end)
                continue
            try:
                states[:, done:] = self._led(at[done:], self._inner.fill(at[done:]))
                done = len(at)
                self._arrived()
            except Breakdown as trouble:
                made = 0 if trouble.filled is None else trouble.filled.shape[1]
                if made:
                    states[:, done : done + made] = self._led(at[done : done + made], trouble.filled)
                done += made
                trouble.filled = states[:, :done]
                self._bridged(trouble)
                # Rows that the last step before it has passed by are on its curve, not on the bridge.
                bridge = self._bridge
                assert bridge is not None
        return states

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
        if trouble.kind != Cause.SINGULAR_CONSTRAINTS:
            raise trouble
        crossing = bridge(self._led, self._begin, self._past, trouble)
        if crossing is None:
            raise trouble
        self._bridge = crossing
        self.work.singular.append(crossing.singular)

    def _along(self, over: Bridge, until: float) -> None:
        """On the way over a singular position; at its end the run goes on from there."""
        if until < over.end:
            self.time, self.state = until, over.curve(np.array([until]))[:, 0]
            return
        self._bridge = None
        self._inner.restart(over.end, over.arrived)
        self._past.clear()  # a repetition from before would stop where this run did
        self._arrived()
