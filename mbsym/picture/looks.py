"""What bodies look like: the shapes of the description, ellipsoids where there are none.

Principal moments A <= B <= C and the mass m give the semi-axes of the homogeneous ellipsoid that has both,

    a^2 = 5 (B + C - A) / (2 m),  ...

Without a mass (what it does may stand in the tensor) only the proportions are known.  Nothing is drawn of a tensor that
no body has, and of one whose formula moves with the coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.model.system import Body
from mbsym.numerics.scenario import exact
from mbsym.picture.values import Ellipsoid, Numbers, Outline, Rows
from mbsym.report.outlines import turned

#: So much below zero may a squared semi-axis be by roundings, as a part of the largest.
ROUNDING = 1e-9

#: A semi-axis that is zero is drawn so thick, as a part of the largest: rods and discs have one.
THICKNESS = 0.01


def shapes(body: Body, values: Mapping[str, Fraction]) -> tuple[Outline, ...]:
    """The shapes of a body whose numbers are known."""
    found = []
    for shape in body.shapes:
        try:
            size = tuple(float(exact(x, values)) for x in shape.size)
            at = _numbers([float(exact(x, values)) for x in shape.at])
            axes = turned(shape.rotation, values).T
        except (Failure, KeyError):
            continue
        if all(np.isfinite(x) and x > 0 for x in size) and np.all(np.isfinite(at)):
            found.append(Outline(shape.kind, size, at, _rows(axes)))
    return tuple(found)


def ellipsoid(body: Body, values: Mapping[str, Fraction]) -> Ellipsoid | None:
    """The homogeneous ellipsoid with a body's mass and inertia; None where there is none, or it has no number."""
    if body.inertia is None:
        return None
    try:
        mass = float(exact(body.mass, values))
        tensor = np.array([[float(exact(x, values)) for x in row] for row in body.inertia.tensor])
        if body.inertia.about == "joint" and mass:
            centre = np.array([float(exact(x, values)) for x in body.mass_centre])
            tensor = tensor - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    except (Failure, KeyError):
        return None
    if not np.all(np.isfinite(tensor)):
        return None
    moments, columns = np.linalg.eigh(tensor)
    squares = np.sum(moments) - 2 * moments
    if not np.max(moments) > 0 or np.min(squares) < -ROUNDING * np.max(squares):
        return None
    half = np.sqrt(np.maximum(squares, 0.0) * (2.5 / mass if mass > 0 else 1.0))
    half = np.maximum(half, THICKNESS * np.max(half))
    rows = columns.T * np.sign(np.linalg.det(columns))  # right-handed: what is turned is not mirrored
    return Ellipsoid(_numbers(half), _rows(rows), mass > 0)


def _numbers(values: Any) -> Numbers:
    return float(values[0]), float(values[1]), float(values[2])


def _rows(matrix: Any) -> Rows:
    return _numbers(matrix[0]), _numbers(matrix[1]), _numbers(matrix[2])
