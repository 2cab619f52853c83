"""From where something is seen: directions of the eye, and what is to the right and above on the paper then."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import atan2, cos, degrees, dist, fsum, hypot, isfinite, pi, radians, sin, sqrt
from random import Random

from mbsym.algebra.failures import Failure
from mbsym.model.system import Body, Rotation
from mbsym.numerics.carriers import STILL
from mbsym.numerics.scenario import Scenario, exact
from mbsym.picture.values import Coordinate, Ellipsoid, Measure, Numbers, Operands, Outline, Rows, View

AXES: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """The scalar product."""
    return fsum(float(x) * float(y) for x, y in zip(a, b, strict=True))


def cross(a: Numbers, b: Numbers) -> Numbers:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def combined(factors: Sequence[float], vectors: Sequence[Numbers]) -> Numbers:
    """The sum of the vectors times their factors."""
    x, y, z = (fsum(c * v[k] for c, v in zip(factors, vectors, strict=True)) for k in range(3))
    return x, y, z


def unit(vector: Sequence[float]) -> Numbers:
    """Of length 1, in the same direction."""
    x, y, z = map(float, vector)
    size = hypot(x, y, z)
    return x / size, y / size, z / size


def basis(up: Sequence[float]) -> Rows:
    """(first, second, up): level directions from which azimuths count, right-handed."""
    third = unit(up)
    sizes = [abs(x) for x in third]
    least, most = sizes.index(min(sizes)), sizes.index(max(sizes))
    level = AXES[(most + 1) % 3 if least == most else least]
    first = unit(combined((1.0, -dot(third, level)), (level, third)))
    return first, cross(third, first), third


def azimuth_of(up: Sequence[float], towards: Sequence[float]) -> float:
    """The azimuth, in degrees, of an eye in the direction ``towards``."""
    first, second, _ = basis(up)
    return degrees(atan2(dot(towards, second), dot(towards, first)))


def projection(view: View) -> Rows:
    """Rows: to the right, upwards, towards the eye."""
    first, second, third = basis(view.up)
    a, e = radians(view.azimuth), radians(view.elevation)
    level = combined((cos(a), sin(a)), (first, second))
    return (
        combined((-sin(a), cos(a)), (first, second)),
        combined((-sin(e), cos(e)), (level, third)),
        combined((cos(e), sin(e)), (level, third)),
    )


# How much room a system takes, and from where it is seen first.
#
# Both are found at the start and at random angles about it, the lengths those of the start (of a loop: at positions
# near by in which it is closed): sampled, not proved, for they decide only how large things are drawn.


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
    states = []
    for k in range(POSITIONS):
        state = {"t": 0.0}
        for coordinate, rate in zip(known, scenario.system.velocities, strict=True):
            far = pi if coordinate.kind is Measure.ANGLE else apart
            state[coordinate.name] = coordinate.value + (source.uniform(-far, far) if k else 0.0)
            state[rate] = coordinate.velocity
        states.append(state)
    return states


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
        placed = [([at(value, point) for value in values], far) for point, far in zip(points, reach, strict=True)]
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
    places = [[at(value, point) for value in values] for point in points]
    every = [place for those in places if all(isfinite(c) for x in those for c in x) for place in those]
    spread = [_range(place[k] for place in every) for k in range(3)]
    size = max(spread)
    turning = [max((_range(at(value, row)[k] for value in values) for row in axes), default=0.0) for k in range(3)]
    flat = [k for k in (2, 1, 0) if spread[k] <= SAME * size and turning[k] <= SAME]
    return looked_at(own, flat[0] if flat and size else None)


def looked_at(up: Numbers | None, flat: int | None) -> View:
    """From where something is seen: along the axis (0, 1, 2) along which it is ``flat``, else from aside and above.

    ``up`` is the direction away from gravity, None where there is none.
    """
    if flat is None:
        return View(AXES[2] if up is None else up, AZIMUTH, ELEVATION, False)
    normal = AXES[flat]
    above = AXES[1 if flat != 1 else 2]
    if up is not None and abs(dot(normal, up)) <= 0.5:
        above = up
    if sum(cross(above, normal)) < 0:  # the axis that goes sideways is to go to the right
        normal = combined((-1.0,), (normal,))
    return View(above, azimuth_of(above, normal), 0.0, True)


def _range(values: Iterable[float]) -> float:
    known = list(values)
    return max(known) - min(known) if known else 0.0


# What bodies look like: the shapes of the description, ellipsoids where there are none.
#
# Principal moments A <= B <= C and the mass m give the semi-axes of the homogeneous ellipsoid that has both,
#
#     a^2 = 5 (B + C - A) / (2 m),  ...
#
# Without a mass (what it does may stand in the tensor) only the proportions are known.  Nothing is drawn of a tensor
# that no body has, and of one whose formula moves with the coordinates.


#: So much below zero may a squared semi-axis be by roundings, as a part of the largest.
ROUNDING = 1e-9

#: A semi-axis that is zero is drawn so thick, as a part of the largest: rods and discs have one.
THICKNESS = 0.01

#: Jacobi's rotations of a tensor of three rows converge quadratically: fewer are enough.
SWEEPS = 12


def shapes(body: Body, values: Mapping[str, Fraction]) -> tuple[Outline, ...]:
    """The shapes of a body whose numbers are known."""
    outlines = []
    for shape in body.shapes:
        try:
            size = tuple(float(exact(x, values)) for x in shape.size)
            at = _numbers([float(exact(x, values)) for x in shape.at])
            axes = turned(shape.rotation, values)
        except (Failure, KeyError):
            continue
        if all(isfinite(x) and x > 0 for x in size) and all(map(isfinite, at)):
            outlines.append(Outline(shape.kind, size, at, axes))
    return tuple(outlines)


def ellipsoid(body: Body, values: Mapping[str, Fraction]) -> Ellipsoid | None:
    """The homogeneous ellipsoid with a body's mass and inertia; None where there is none, or it has no number.

    No semi-axis is shorter than ``THICKNESS`` times the longest.
    """
    if body.inertia is None:
        return None
    try:
        mass = float(exact(body.mass, values))
        tensor = [[float(exact(x, values)) for x in row] for row in body.inertia.tensor]
        if body.inertia.about == "joint" and mass:
            centre = [float(exact(x, values)) for x in body.mass_centre]
            for i in range(3):
                for j in range(3):
                    tensor[i][j] -= mass * ((dot(centre, centre) if i == j else 0.0) - centre[i] * centre[j])
    except (Failure, KeyError):
        return None
    if not all(isfinite(x) for row in tensor for x in row):
        return None
    moments, rows = principal(tensor)
    squares = [sum(moments) - 2 * x for x in moments]
    if not max(moments) > 0 or min(squares) < -ROUNDING * max(squares):
        return None
    half = [sqrt(max(x, 0.0) * (2.5 / mass if mass > 0 else 1.0)) for x in squares]
    return Ellipsoid(_numbers([max(x, THICKNESS * max(half)) for x in half]), rows, mass > 0)


def turned(rotation: Rotation, values: Mapping[str, Fraction]) -> Rows:
    """The axes of what is turned so, in rows, in the axes upon which it is turned."""
    rows = list(AXES)
    for axis, angle in rotation.turns():
        c, s = cos(float(exact(angle, values))), sin(float(exact(angle, values)))
        i, j = axis % 3, (axis + 1) % 3
        rows[i], rows[j] = combined((c, s), (rows[i], rows[j])), combined((c, -s), (rows[j], rows[i]))
    return rows[0], rows[1], rows[2]


def principal(tensor: Sequence[Sequence[float]]) -> tuple[Numbers, Rows]:
    """(moments, the least first; principal axes in rows, right-handed) of a symmetric tensor, by Jacobi's rotations."""
    a, rows = [list(row) for row in tensor], [list(row) for row in AXES]
    for _ in range(SWEEPS):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if a[p][q] == 0:
                continue
            turn = atan2(2 * a[p][q], a[p][p] - a[q][q]) / 2
            c, s = cos(turn), sin(turn)
            a = _rotated(a, p, q, c, s)
            a = [
                list(row)
                for row in zip(*_rotated([list(row) for row in zip(*a, strict=True)], p, q, c, s), strict=True)
            ]
            a[p][q] = a[q][p] = 0.0
            rows = _rotated(rows, p, q, c, s)
    order = sorted(range(3), key=lambda k: a[k][k])
    first, second = _numbers(rows[order[0]]), _numbers(rows[order[1]])
    return _numbers([a[k][k] for k in order]), (first, second, cross(first, second))


def _rotated(rows: list[list[float]], p: int, q: int, c: float, s: float) -> list[list[float]]:
    rotated = list(rows)
    rotated[p] = [c * x + s * y for x, y in zip(rows[p], rows[q], strict=True)]
    rotated[q] = [c * y - s * x for x, y in zip(rows[p], rows[q], strict=True)]
    return rotated


def _numbers(values: Sequence[float]) -> Numbers:
    return float(values[0]), float(values[1]), float(values[2])
