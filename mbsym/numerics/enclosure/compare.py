"""How far a computed trajectory is from the exact solution: proved, at every row and of every event."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.enclosure.enclose import GUARD, Enclosure, enclosed
from mbsym.numerics.enclosure.field import NotAnalytic, function_of
from mbsym.numerics.events.events import Occurrences
from mbsym.numerics.events.surfaces import slopes_code
from mbsym.numerics.planning.sizes import scaled_by_another, sizes_of_scene

#: How much further than the last row the solution is enclosed where events are looked at.
AFTER = 1 + 1e-6

#: What a float bound is multiplied by, so that it stays one after its own rounding.
LARGER = 1 + 1e-15


#: An interval that is too short is made so many times longer, so often.
LONGER, TRIALS = 8.0, 16


@dataclass(frozen=True)
class Certificate:
    """The exact solution of the equations of a run, enclosed: row k of component i is within ``radius[i, k]`` of
    ``centre[i, k]`` (floats, as they are printed), and within ``error[i, k]`` of what the run has there.

    ``scale`` is what each component is measured by; only the first ``rows`` rows are enclosed, up to ``reached``, and
    ``ended`` says why they are not all ("": they are).  ``passages`` has a radius for every event of the run: the exact
    solution has it once within that of its time; None where that is not proved.

    ``known`` is the largest radius of the enclosure itself at these rows, before anything is printed, as a part of the
    scale, and ``wanted`` what it should be at most.
    """

    enclosure: Enclosure
    centre: Any
    radius: Any
    error: Any
    scale: Any
    ended: str
    known: float
    wanted: float
    passages: tuple[float | None, ...] = ()

    @property
    def narrow(self) -> bool:
        """Whether the solution is known as narrowly as was asked for, at the rows that are enclosed."""
        return self.known <= self.wanted

    @property
    def whole(self) -> bool:
        """Whether all rows are enclosed."""
        return not self.ended

    @property
    def rows(self) -> int:
        """How many rows are enclosed."""
        return int(self.centre.shape[1])

    @property
    def width(self) -> float:
        """The largest radius over rows and components, each as a part of its scale."""
        return _largest(self.radius, self.scale)

    @property
    def largest_error(self) -> float:
        """A proved bound of the run's error at the enclosed rows, each component as a part of its scale."""
        return _largest(self.error, self.scale)

    def error_of(self, component: int) -> float:
        """The same of one component."""
        return float(np.max(self.error[component], initial=0.0) / self.scale[component]) * LARGER


def analytic(dynamics: Dynamics) -> None:
    """Raises NotAnalytic where the equations of motion or their Jacobian have a function without a power series."""
    tied = dynamics.constraints
    for code in (dynamics.right_hand_side, dynamics.jacobian):
        try:
            function_of(code, GUARD)
        except NotAnalytic as error:
            name = str(error)
            if name != "sign" or tied is None or not tied.chosen.dependent:
                raise
            raise NotAnalytic(name, tuple(row.label for row in tied.redundant)) from error


def certified(
    dynamics: Dynamics,
    times: Any,
    states: Any,
    width: float,
    seconds: float = inf,
    limit: float = inf,
    watch: Callable[[float], None] = lambda t: None,
    happened: Occurrences | None = None,
) -> Certificate:
    """The solution of the scenario's equations enclosed to ``width``, and the distance of ``states`` (n, m) from it.

    A component is measured by its largest absolute value at the rows; where it rests but for rounding, by what the
    scene would move it (``planning.sizes``).  Raises NotAnalytic where the equations have no power series.
    """
    scale = scaled_by_another(dynamics, times, states, sizes_of_scene(dynamics, times, states))
    # An event at the end needs a little of what comes after it.
    end = float(times[-1]) * (1.0 if happened is None else AFTER)
    state = dynamics.scenario.state
    equations = dynamics.right_hand_side, dynamics.jacobian
    enclosure = enclosed(*equations, state, end, width, scale.tolist(), seconds, watch, limit)
    rows = int(np.searchsorted(times, enclosure.reached, side="right")) if enclosure.segments else 0
    centre, radius, error, own = (np.zeros((len(states), rows)) for _ in range(4))
    with ctx.workprec(enclosure.bits + GUARD):
        for k in range(rows):
            for i, value in enumerate(enclosure.at(float(times[k]))):
                middle = float(value.mid())
                centre[i, k] = middle
                # What is printed of a float is within half a unit in its last place of it.
                own[i, k] = _above(value - value.mid())
                radius[i, k] = _above(value - arb(middle)) + 2.0**-52 * abs(middle)
                error[i, k] = _above(value - _exact(states[i, k]))
    passages = passage_radii(enclosure, dynamics, happened) if happened is not None and enclosure.segments else ()
    ended = enclosure.ended if rows < len(times) else ""
    known = _largest(own, scale)
    return Certificate(enclosure, centre, radius, error, scale, ended, known, width, passages)


def _largest(values: Any, scale: Any) -> float:
    """The largest over rows of (n, m) numbers, each as a part of its scale, rounded up."""
    return float(np.max(np.max(values, axis=1, initial=0.0) / scale, initial=0.0)) * LARGER


def _above(value: arb) -> float:
    """A float no smaller than |value|."""
    return float(np.nextafter(float(value.abs_upper()), inf))


def _exact(value: Any) -> arb:
    """A float of any width as it is."""
    numerator, denominator = value.as_integer_ratio()
    return arb(fmpq(int(numerator), int(denominator)))


def passage_radii(enclosure: Enclosure, dynamics: Dynamics, happened: Occurrences) -> tuple[float | None, ...]:
    """For each occurrence a radius: the exact solution passes once within it of the time, in the same direction.

    Let g(t) be the condition along the solution.  If g has opposite signs at the ends of [a, b], and g' one sign
    between them, then g passes zero once there, and with any t in [a, b] (interval Newton)

        the passage is in   t - g(t) / g'([a, b]).

    None where that is not proved: beyond what is enclosed, where the condition only touches, or where it is not smooth.
    """
    radii: list[float | None] = []
    with ctx.workprec(enclosure.bits + GUARD):
        functions = [_slopes(dynamics, event, enclosure.bits + GUARD) for event in happened.events]
        for time, which, turn in zip(happened.times, happened.which, happened.turns, strict=True):
            slopes = functions[which]
            proved = slopes is not None and turn != 0
            radii.append(_radius(enclosure, slopes, float(time), int(turn)) if proved and slopes is not None else None)
    return tuple(radii)


def _slopes(dynamics: Dynamics, event: Any, bits: int) -> Callable[[Sequence[Any]], list[Any]] | None:
    try:
        return function_of(slopes_code(dynamics, event), bits)
    except NotAnalytic:
        return None


def _radius(enclosure: Enclosure, slopes: Callable[[Sequence[Any]], list[Any]], time: float, turn: int) -> float | None:
    def at(first: float, last: float) -> tuple[arb, arb]:
        values = slopes([arb(first).union(arb(last)), *enclosure.within(first, last)])
        return values[0], values[1]

    if time > enclosure.reached:
        return None
    value, slope = at(time, time)
    steepness = float(slope.abs_lower())
    if not steepness > 0:
        return None
    span = 2 * float(value.abs_upper()) / steepness + 4 * float(np.spacing(time))
    for _ in range(TRIALS):
        first, last = max(0.0, time - span), time + span
        if last > enclosure.reached:
            return None
        rate = at(first, last)[1]
        signs = (at(first, first)[0] * turn, at(last, last)[0] * turn)
        if rate * turn > 0 and signs[0] < 0 and signs[1] > 0:
            # A time as it is printed is within half a unit in its last place of what it is.
            return float(np.nextafter(min(span, float((value / rate).abs_upper())) + np.spacing(time), inf))
        span *= LONGER
    return None
