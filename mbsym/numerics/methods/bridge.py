"""Over a singular position of the constraints, where accelerations do not follow from them.

A four-bar whose links come in line, say: two branches of motion meet there, and J loses its rank.  The motion itself is
smooth on its branch, but its accelerations are 0/0, and near it steps would shrink for ever.  It is continued by
the polynomial that fits positions and velocities before,

    q(t) = sum_k a_k T_k,      q and q' at ``NODES`` times in a window before the stop,

over an interval that is short beside the window, and led back to the constraints behind the position.  That is accepted
only if accelerations behind are those of the polynomial, and velocities and positions need no more than a small
correction: another branch would show.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.methods.interface import Breakdown, Run

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
    size = 1 + np.max(np.abs(states), axis=1)
    near = bool(np.all(np.abs(arrived - guess) <= CORRECTED * size))
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
    befores = [one for one in reversed(past) if one[0] <= times[0]] or [past[0]]
    longest: tuple[Any, Any] | None = None
    for start, state in (*befores[: REPETITIONS - 1], *befores[REPETITIONS - 1 :][-1:]):
        wanted = times[times > start]
        try:
            states = begin(start, state).fill(wanted) if len(wanted) else None
        except Breakdown as earlier:
            states = earlier.filled
        made = 0 if states is None else states.shape[1]
        if made > (0 if longest is None else len(longest[0])):
            longest = wanted[:made], states
        if made == len(wanted):
            break
    return None if longest is None else (longest[0], led(*longest))


def _distance(
    led: Any, begin: Callable[[float, Any], Run], past: Sequence[tuple[float, Any]], stop: Breakdown
) -> float | None:
    """How long until the singular position: 1/sqrt(nearness) falls to zero in a straight line."""
    lengths = (stop.time - past[0][0]) * 0.5 ** np.arange(0.0, 40.0)
    found = _history(led, begin, past, stop.time - lengths)
    if found is None:
        return None
    now = 1 / np.sqrt(float(led.nearness(stop.time, stop.state)))
    before = 1 / np.sqrt(led.nearness(*found))
    away = np.flatnonzero(before >= 2 * now)
    if not len(away):
        return None
    last = away[-1]
    return float((stop.time - found[0][last]) * now / (before[last] - now))


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
