"""Singular positions of constraints that a run's steps went over without being stopped by them.

A step may be longer than the neighbourhood in which a position with dependent rows is felt.  Then nothing ends the run
and nothing carries it over, and which branch of motion it is on behind is what the step happened to meet.  They are
found afterwards: where the least singular value of J (each row by its own length) has a minimum between rows or steps,
a singular position is sought from there (``extremes.singular_positions``), and is one that was gone over if the
curve through positions and velocities comes to it within ``WITHIN``, in parts of the motion's size.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes.singular_positions import Search
from mbsym.numerics.methods.kept import compiled_kernel

#: How near the curve comes, and the part of its usual size to which the least singular value has fallen beside it.
WITHIN, FALLEN = 2e-3, 0.5

#: Minima that are looked into; samples of the curve beside one.
MOST, FINE = 12, 400


def stepped_over(dynamics: Dynamics, times: Any, states: Any, known: Sequence[float]) -> tuple[float, ...]:
    """The times at which a run, with rows as dense as its steps, went over a singular position.

    ``states`` (2n, m) at ``times``; ``known`` are times of those over which the motion was carried.  Times are good to
    the distance of rows where the constraints move by themselves: positions are sought with the time held.  In declared
    variables the least singular value itself has to fall to ``WITHIN`` on the curve.
    """
    constraints = dynamics.constraints
    if constraints is None or not constraints.kept or len(times) < 4:
        return ()
    states = np.asarray(states, dtype=float)
    n = constraints.size
    sizes = np.max(np.abs(states[:n]), axis=1)
    search = None if dynamics.in_states else Search(dynamics.scenario, constraints, np.where(sizes > 0, sizes, 1.0))
    scales = np.ones(n) if search is None else search.scales
    least = _least(constraints, scales, times, states)
    usual = float(np.median(least))
    inner = (
        np.flatnonzero((least[1:-1] <= least[:-2]) & (least[1:-1] <= least[2:]) & (least[1:-1] < FALLEN * usual)) + 1
    )
    found: list[float] = []
    for k in sorted(inner.tolist(), key=lambda k: float(least[k]))[:MOST]:
        span = slice(max(0, k - 1), min(len(times), k + 2))
        if any(times[span][0] <= one <= times[span][-1] for one in known):
            continue
        if search is None:
            time = _fallen(dynamics, times[span], states[:, span], WITHIN * usual)
        else:
            time = _met(search, times[span], states[:, span], times[k])
        if time is not None:
            found.append(time)
    return tuple(sorted(found))


def _least(constraints: Any, scales: Any, times: Any, states: Any) -> Any:
    """Of all rows, each of length 1, the singular value that falls to zero where their rank does, at every time."""
    rows = constraints.along(times, states).partials * scales[None, :, None]
    lengths = np.linalg.norm(rows, axis=1)
    rows = rows / np.maximum(np.max(lengths, axis=1), 1e-300)[:, None, None]
    return np.linalg.svd(np.moveaxis(rows, 2, 0), compute_uv=False)[:, constraints.rank - 1]


def _fallen(dynamics: Dynamics, times: Any, states: Any, least: float) -> float | None:
    """When the least singular value falls to ``least`` on the curve through states and their rates; None if never."""
    from scipy.interpolate import CubicHermiteSpline

    assert dynamics.constraints is not None
    rates = compiled_kernel(dynamics, "right_hand_side")(np.vstack([times, states]))
    at = np.linspace(times[0], times[-1], FINE)
    found = _least(
        dynamics.constraints,
        np.ones(dynamics.constraints.size),
        at,
        CubicHermiteSpline(times, states, rates, axis=1)(at),
    )
    best = int(np.argmin(found))
    return float(at[best]) if found[best] <= least else None


def _met(search: Search, times: Any, states: Any, middle: float) -> float | None:
    """When the curve comes within ``WITHIN`` of a singular position that is found from it; None if it does not."""
    from scipy.interpolate import CubicHermiteSpline  # half of the time that importing numbers took

    n = len(states) // 2
    curve = CubicHermiteSpline(times, states[:n], states[n:], axis=1)
    at = np.linspace(times[0], times[-1], FINE)
    places = curve(at)
    start = np.concatenate([curve(middle), np.zeros(n)])
    position = search.reached(start, float(middle))
    if position is None or not search.falls(position, float(middle)):
        return None
    apart = np.array([np.linalg.norm(search.difference(place, position)) for place in places.T])
    best = int(np.argmin(apart))
    # Between two samples the curve is a straight line for this purpose.
    step = np.max(np.linalg.norm(np.diff(places, axis=1) / search.scales[:, None], axis=0))
    return float(at[best]) if apart[best] <= WITHIN + step else None
