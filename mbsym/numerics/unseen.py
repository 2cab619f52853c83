"""What a run does between rows that are far apart: the same run at the ends of its steps and midway between them.

A force that acts between two rows and at neither of them changes an energy; whoever looks at rows alone sees no force.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from mbsym.numerics.breakdowns import least_pivot
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Method
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.simulate import Trajectory, simulate

#: Steps whose ends are looked at one by one, and places in what is left of the interval.
MOST, PLACES = 4_000, 4_000

#: Runs that cost more than this (``mbsym.numerics.planning.prices``) are not run again.
LONG = 2.0


def between_rows(dynamics: Dynamics, found: Trajectory, method: Method, scalar: str) -> Trajectory:
    """The trajectory with more rows, where its steps are many beside its rows; else as it is."""
    if (
        not found.whole
        or cost(dynamics, found.method, scalar, found.work) > LONG
        or 2 * found.work.steps < found.samples
    ):
        return found
    end, run = float(found.times[-1]), method.start(dynamics, found.setting, scalar)
    places = [0.0]
    try:
        with np.errstate(all="ignore"):
            while places[-1] < end and len(places) < MOST:
                places.append(min(float(run.step().end), end))
    except Breakdown:
        return found  # a step that would have gone beyond the end
    places += [(one + other) / 2 for one, other in pairwise(places)]
    reached = max(places)
    rest = np.linspace(reached, end, PLACES if reached < end else 0)
    times = np.unique(np.concatenate([places, rest, found.times]))
    more = simulate(dynamics, method, found.setting, times.tolist(), scalar)
    return more if more.whole else found


def nearest_to_singular(
    dynamics: Dynamics, found: Trajectory, dense: Trajectory, method: Method, scalar: str
) -> tuple[float, float]:
    """(ratio, t) of ``least_pivot`` over rows and ends of steps, which crowd where M is nearly singular.

    ``dense`` is what ``between_rows`` made of ``found``.  Rows alone are looked at where a run was dear, ended early,
    or has more than ``MOST`` steps, beyond those.
    """
    lowest = least_pivot(dynamics, dense)
    if dense is not found or not found.whole or cost(dynamics, found.method, scalar, found.work) > LONG:
        return lowest
    end, run = float(found.times[-1]), method.start(dynamics, found.setting, scalar)
    times, states = [float(run.time)], [np.array(run.state)]
    try:
        with np.errstate(all="ignore"):
            while times[-1] < end and len(times) < MOST:
                run.step(end)
                times.append(float(run.time))
                states.append(np.array(run.state))
    except Breakdown:
        pass  # a step made otherwise than the run's own; those before it count
    ends = replace(found, times=np.array(times), states=np.column_stack(states))
    return min(lowest, least_pivot(dynamics, ends))
