"""Between the samples of a trajectory, for drawing: the quintic that fits q, q' and q'' at both ends of an interval.

    q(t0 + s h) = q0 H0 + h q0' H1 + h^2 q0'' H2 + h^2 q1'' H3 + h q1' H4 + q1 H5,     0 <= s <= 1

The velocity is its derivative; the error of q is of order h^6, that of q' of order h^5.  Where an acceleration is not
finite, or the samples are too far apart for such a curve, the states are joined by straight lines.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import compiled_kernel

#: A sample is joined smoothly to the next one if Hermite's rule for the integral of q' misses q1 - q0 by no more than
#: this part of the range of q.
ALLOWED = 1e-2

#: Coefficients of 1, s, ..., s^5 in H0 to H5.
_BASIS = np.array(
    [
        [1, 0, 0, -10, 15, -6],
        [0, 1, 0, -6, 8, -3],
        [0, 0, 0.5, -1.5, 1.5, -0.5],
        [0, 0, 0, 0.5, -1, 0.5],
        [0, 0, 0, -4, 7, -3],
        [0, 0, 0, 10, -15, 6],
    ]
)


def accelerations(dynamics: Dynamics, times: Any, states: Any) -> Any:
    """q'' along a trajectory (``states`` of shape (2n, m)), of shape (n, m); not finite where it does not exist.

    Of a run in declared variables the rates of all of them.
    """
    moments = np.vstack([np.asarray(times, dtype=float), np.asarray(states, dtype=float)])
    with np.errstate(all="ignore"):
        rates = np.asarray(compiled_kernel(dynamics, "right_hand_side")(moments), dtype=float)
    return rates if dynamics.in_states else rates[len(states) // 2 :]


def between(times: Any, states: Any, rates: Any, pieces: Any) -> tuple[Any, Any]:
    """(times, states) with interval k cut into ``pieces[k]`` equal parts; the samples themselves stay what they are.

    ``states`` has shape (2n, m), ``rates`` are the accelerations of shape (n, m), ``pieces`` has m - 1 whole numbers.
    """
    times, states = np.asarray(times, dtype=float), np.asarray(states, dtype=float)
    n = len(states) // 2
    pieces = np.asarray(pieces, dtype=int)
    interval = np.repeat(np.arange(len(pieces)), pieces)
    part = np.arange(len(interval)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    s = part / pieces[interval]
    h = np.diff(times)
    refined = np.empty((2 * n, len(interval) + 1))
    refined[:, -1] = states[:, -1]
    for i in range(n):
        q, v, a = states[i], states[n + i], rates[i]
        smooth = _smooth(h, q, v, a)
        ends = np.array([q[:-1], h * v[:-1], h**2 * a[:-1], h**2 * a[1:], h * v[1:], q[1:]])
        straight = np.zeros_like(ends)
        straight[0], straight[1] = q[:-1], np.diff(q)
        # Powers of s: the polynomial of each interval, its derivative, or a straight line.
        powers = np.where(smooth, _BASIS.T @ np.where(smooth, ends, 0.0), straight)[:, interval]
        refined[i, :-1] = _at(powers, s)
        slope = powers[1:] * np.arange(1, 6)[:, None] / h[interval]
        line = v[interval] + s * np.diff(v)[interval]
        refined[n + i, :-1] = np.where(smooth[interval], _at(slope, s), line)
        refined[[i, n + i], :-1] = np.where(part == 0, states[[i, n + i]][:, interval], refined[[i, n + i], :-1])
    return np.append(times[interval] + s * h[interval], times[-1]), refined


def _smooth(h: Any, q: Any, v: Any, a: Any) -> Any:
    """Whether the samples are so close that the intervals may be rounded."""
    with np.errstate(all="ignore"):
        missed = np.diff(q) - h * (v[1:] + v[:-1]) / 2 + h**2 * np.diff(a) / 12
        return np.abs(missed) <= ALLOWED * np.ptp(q)


def _at(powers: Any, s: Any) -> Any:
    """Horner's rule: sum of powers[k] s^k."""
    value = powers[-1]
    for row in powers[-2::-1]:
        value = value * s + row
    return value
