"""From where something is seen: directions of the eye, and what is to the right and above on the paper then."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, degrees, fsum, hypot, radians, sin

from mbsym.picture.values import Numbers, Rows

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


def projection(up: Sequence[float], azimuth: float, elevation: float) -> Rows:
    """Rows: to the right, upwards, towards the eye."""
    first, second, third = basis(up)
    a, e = radians(azimuth), radians(elevation)
    level = combined((cos(a), sin(a)), (first, second))
    return (
        combined((-sin(a), cos(a)), (first, second)),
        combined((-sin(e), cos(e)), (level, third)),
        combined((cos(e), sin(e)), (level, third)),
    )
