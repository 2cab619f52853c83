"""How much room a system takes, and from where it is seen first.

Both are found at the start and at random angles about it, the lengths those of the start (of a loop: at positions
near by in which it is closed): sampled, not proved, for they decide only how large things are drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import dist, hypot, isfinite, pi
from random import Random

from mbsym.numerics.carriers import STILL
from mbsym.numerics.scenario import Scenario
from mbsym.picture.looking import AXES, azimuth_of, combined, cross, dot, unit
from mbsym.picture.values import Coordinate, Measure, Numbers, Operands, View

#: So many positions are looked at; the first is the start.
POSITIONS = 24

#: What moves by less than this part of the whole is at rest for the eye.
SAME = 1e-6

#: Degrees of the first look at something that is not plane.
AZIMUTH, ELEVATION = 35.0, 22.0


State = dict[str, float]
Values = Sequence[float]


def samples(known: Sequence[Coordinate], scenario: Scenario, apart: float = 0.0) -> list[State]:
    """Inputs of the program at these positions, lengths moved by up to ``apart``; velocities of the start, t = 0."""
    source = Random(5)
    found = []
    for k in range(POSITIONS):
        state = {"t": 0.0}
        for one, rate in zip(known, scenario.system.velocities, strict=True):
            far = pi if one.kind is Measure.ANGLE else apart
            state[one.name] = one.value + (source.uniform(-far, far) if k else 0.0)
            state[rate] = one.velocity
        found.append(state)
    return found


@dataclass(frozen=True)
class Room:
    """``reach``: the diagonal of the box of everything with the origin of the frame; see Picture for the rest."""

    reach: float
    middle: Numbers
    radius: float
    view: View

    @classmethod
    def of(cls, values: Sequence[Values], points: Sequence[Operands], reach: Sequence[float], view: View) -> Room:
        """From values of the program; ``reach`` is how far something extends about each point."""
        placed = [([at(one, point) for one in values], far) for point, far in zip(points, reach, strict=True)]
        good = [x for x in placed if isfinite(x[1]) and all(isfinite(c) for place in x[0] for c in place)]
        if not good:
            return cls(0.0, (0.0, 0.0, 0.0), 1.0, view)
        low = [min(place[k] - far for places, far in good for place in places) for k in range(3)]
        high = [max(place[k] + far for places, far in good for place in places) for k in range(3)]
        whole = hypot(*(max(b, 0.0) - min(a, 0.0) for a, b in zip(low, high, strict=True)))
        middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2)
        radius = max(dist(place, middle) + far for places, far in good for place in places)
        # What is a point by itself, however far away, is drawn as one of unit size.
        most = max(abs(c) for places, _ in good for place in places for c in place)
        point_like = radius <= STILL * most or radius == 0
        return cls(1.0 + whole if point_like else whole, middle, 1.0 if point_like else radius, view)


def at(values: Values, operands: Operands) -> Numbers:
    """A point or a direction among the values of the program."""
    a, b, c = operands
    return float(values[a]), float(values[b]), float(values[c])


def first_look(
    values: Sequence[Values], points: Sequence[Operands], axes: Sequence[Operands], up: Operands | None
) -> View:
    """Into the plane of what is plane, else from aside and above.

    Plane is what moves in one or along a line and turns about its normal only, at positions of all kinds (``values``).
    """
    own = None if up is None else at(values[0], up)
    own = None if own is None or not isfinite(hypot(*own)) or hypot(*own) == 0 else unit(own)
    places = [[at(one, point) for one in values] for point in points]
    every = [place for those in places if all(isfinite(c) for x in those for c in x) for place in those]
    spread = [_range(place[k] for place in every) for k in range(3)]
    size = max(spread)
    turning = [max((_range(at(one, row)[k] for one in values) for row in axes), default=0.0) for k in range(3)]
    flat = [k for k in (2, 1, 0) if spread[k] <= SAME * size and turning[k] <= SAME]
    if not flat or not size:
        return View(AXES[2] if own is None else own, AZIMUTH, ELEVATION, False)
    normal = AXES[flat[0]]
    above = AXES[1 if flat[0] != 1 else 2]
    if own is not None and abs(dot(normal, own)) <= 0.5:
        above = own
    if sum(cross(above, normal)) < 0:  # the axis that goes sideways is to go to the right
        normal = combined((-1.0,), (normal,))
    return View(above, azimuth_of(above, normal), 0.0, True)


def _range(values: Iterable[float]) -> float:
    known = list(values)
    return max(known) - min(known) if known else 0.0
