"""What bodies look like: the shapes of the description, ellipsoids where there are none.

Principal moments A <= B <= C and the mass m give the semi-axes of the homogeneous ellipsoid that has both,

    a^2 = 5 (B + C - A) / (2 m),  ...

Without a mass (what it does may stand in the tensor) only the proportions are known.  Nothing is drawn of a tensor that
no body has, and of one whose formula moves with the coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import atan2, cos, isfinite, sin, sqrt

from mbsym.algebra.failures import Failure
from mbsym.model.system import Body, Rotation
from mbsym.numerics.scenario import exact
from mbsym.picture.looking import AXES, combined, cross, dot
from mbsym.picture.values import Ellipsoid, Numbers, Outline, Rows

#: So much below zero may a squared semi-axis be by roundings, as a part of the largest.
ROUNDING = 1e-9

#: A semi-axis that is zero is drawn so thick, as a part of the largest: rods and discs have one.
THICKNESS = 0.01

#: Jacobi's rotations of a tensor of three rows converge quadratically: fewer are enough.
SWEEPS = 12


def shapes(body: Body, values: Mapping[str, Fraction]) -> tuple[Outline, ...]:
    """The shapes of a body whose numbers are known."""
    found = []
    for shape in body.shapes:
        try:
            size = tuple(float(exact(x, values)) for x in shape.size)
            at = _numbers([float(exact(x, values)) for x in shape.at])
            axes = turned(shape.rotation, values)
        except (Failure, KeyError):
            continue
        if all(isfinite(x) and x > 0 for x in size) and all(map(isfinite, at)):
            found.append(Outline(shape.kind, size, at, axes))
    return tuple(found)


def ellipsoid(body: Body, values: Mapping[str, Fraction]) -> Ellipsoid | None:
    """The homogeneous ellipsoid with a body's mass and inertia; None where there is none, or it has no number."""
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


def _transposed(rows: list[list[float]]) -> list[list[float]]:
    return [[row[k] for row in rows] for k in range(3)]


def _rotated(rows: list[list[float]], p: int, q: int, c: float, s: float) -> list[list[float]]:
    found = list(rows)
    found[p] = [c * x + s * y for x, y in zip(rows[p], rows[q], strict=True)]
    found[q] = [c * y - s * x for x, y in zip(rows[p], rows[q], strict=True)]
    return found


def _numbers(values: Sequence[float]) -> Numbers:
    return float(values[0]), float(values[1]), float(values[2])
