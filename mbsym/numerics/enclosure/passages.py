"""Events of the exact solution: for each that a run found, a proof that it happens, once, and when.

Let g(t) be the condition along the solution.  If g has opposite signs at the ends of [a, b], and g' one sign between
them, then g passes zero once there, and with any t in [a, b] (interval Newton)

    the passage is in   t - g(t) / g'([a, b]).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.enclosure.enclose import GUARD, Enclosure
from mbsym.numerics.enclosure.field import NotAnalytic, function_of
from mbsym.numerics.events.events import Occurrences
from mbsym.numerics.events.surfaces import slopes_code

#: An interval that is too short is made so many times longer, so often.
LONGER, TRIALS = 8.0, 16


def passage_radii(found: Enclosure, dynamics: Dynamics, happened: Occurrences) -> tuple[float | None, ...]:
    """For each occurrence a radius: the exact solution passes once within it of the time, in the same direction.

    None where that is not proved: beyond what is enclosed, where the condition only touches, or where it is not smooth.
    """
    radii: list[float | None] = []
    with ctx.workprec(found.bits + GUARD):
        functions = [_slopes(dynamics, event, found.bits + GUARD) for event in happened.events]
        for time, which, turn in zip(happened.times, happened.which, happened.turns, strict=True):
            slopes = functions[which]
            proved = slopes is not None and turn != 0
            radii.append(_radius(found, slopes, float(time), int(turn)) if proved and slopes is not None else None)
    return tuple(radii)


def _slopes(dynamics: Dynamics, event: Any, bits: int) -> Callable[[Sequence[Any]], list[Any]] | None:
    try:
        return function_of(slopes_code(dynamics, event), bits)
    except NotAnalytic:
        return None


def _radius(found: Enclosure, slopes: Callable[[Sequence[Any]], list[Any]], time: float, turn: int) -> float | None:
    def at(first: float, last: float) -> tuple[arb, arb]:
        values = slopes([arb(first).union(arb(last)), *found.within(first, last)])
        return values[0], values[1]

    if time > found.reached:
        return None
    value, slope = at(time, time)
    steepness = float(slope.abs_lower())
    if not steepness > 0:
        return None
    span = 2 * float(value.abs_upper()) / steepness + 4 * float(np.spacing(time))
    for _ in range(TRIALS):
        first, last = max(0.0, time - span), time + span
        if last > found.reached:
            return None
        rate = at(first, last)[1]
        signs = (at(first, first)[0] * turn, at(last, last)[0] * turn)
        if rate * turn > 0 and signs[0] < 0 and signs[1] > 0:
            # A time as it is printed is within half a unit in its last place of what it is.
            return float(np.nextafter(min(span, float((value / rate).abs_upper())) + np.spacing(time), inf))
        span *= LONGER
    return None
