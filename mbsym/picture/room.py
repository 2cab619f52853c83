"""How much room a system takes, and from where it is seen first.

Both are found at the start and at random angles about it, the lengths those of the start (of a loop: at positions
near by in which it is closed): sampled, not proved, for they decide only how large things are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.positions import STILL
from mbsym.numerics.scenario import Scenario
from mbsym.picture.values import Coordinate, Measure, Numbers, Operands, View
from mbsym.report.figures.animation import azimuth_of

#: So many positions are looked at; the first is the start.
POSITIONS = 24

#: What moves by less than this part of the whole is at rest for the eye.
SAME = 1e-6

#: Degrees of the first look at something that is not plane.
AZIMUTH, ELEVATION = 35.0, 22.0


def samples(known: Sequence[Coordinate], scenario: Scenario, apart: float = 0.0) -> dict[str, Any]:
    """Inputs of the program at these positions, lengths moved by up to ``apart``; velocities of the start, t = 0."""
    source = np.random.default_rng(5)
    found: dict[str, Any] = {"t": np.zeros(POSITIONS)}
    for one, rate in zip(known, scenario.system.velocities, strict=True):
        far = np.pi if one.kind is Measure.ANGLE else apart
        moved = source.uniform(-far, far, POSITIONS)
        moved[0] = 0.0
        found[one.name] = one.value + moved
        found[rate] = np.full(POSITIONS, one.velocity)
    return found


@dataclass(frozen=True)
class Room:
    """``reach``: the diagonal of the box of everything with the origin of the frame; see Picture for the rest."""

    reach: float
    middle: Numbers
    radius: float
    view: View

    @classmethod
    def of(cls, values: Sequence[Any], points: Sequence[Operands], reach: Sequence[float], view: View) -> Room:
        """From values of the program; ``reach`` is how far something extends about each point."""
        places = placed(values, points)
        far = np.array(reach, dtype=float)
        good = np.all(np.isfinite(places), axis=(1, 2)) & np.isfinite(far)
        places, far = places[good], far[good, None, None]
        if not len(places):
            return cls(0.0, (0.0, 0.0, 0.0), 1.0, view)
        low, high = np.min(places - far, axis=(0, 2)), np.max(places + far, axis=(0, 2))
        whole = float(np.linalg.norm(np.maximum(high, 0.0) - np.minimum(low, 0.0)))
        middle = (low + high) / 2
        radius = float(np.max(np.linalg.norm(places - middle[:, None], axis=1) + far[:, 0]))
        # What is a point by itself, however far away, is drawn as one of unit size.
        point_like = radius <= STILL * float(np.max(np.abs(places), initial=0.0)) or radius == 0
        return cls(1.0 + whole if point_like else whole, _three(middle), 1.0 if point_like else radius, view)


def placed(values: Sequence[Any], points: Sequence[Operands]) -> Any:
    """Points as (points, 3, positions)."""
    count = max((np.size(x) for x in values), default=1)
    columns = [[np.broadcast_to(values[k], count) for k in point] for point in points]
    return np.array(columns, dtype=float).reshape(len(points), 3, count)


def first_look(
    values: Sequence[Any], points: Sequence[Operands], axes: Sequence[Operands], up: Operands | None
) -> View:
    """Into the plane of what is plane, else from aside and above.

    Plane is what moves in one and turns about its normal only, at positions of all kinds (``values``).
    """
    places, turned = placed(values, points), placed(values, axes)
    own = _upward(values, up)
    spread = np.ptp(places[np.all(np.isfinite(places), axis=(1, 2))], axis=(0, 2)) if len(places) else np.zeros(3)
    size = float(np.max(spread))
    turning = np.max(np.ptp(turned, axis=2), axis=0) if len(turned) else np.zeros(3)
    flat = [k for k in (2, 1, 0) if spread[k] <= SAME * size and turning[k] <= SAME]
    if not flat or np.sum(spread > SAME * size) < 2:
        return View(_three(np.eye(3)[2] if own is None else own), AZIMUTH, ELEVATION, False)
    normal = np.eye(3)[flat[0]]
    above = np.eye(3)[1 if flat[0] != 1 else 2]
    if own is not None and abs(float(normal @ own)) <= 0.5:
        above = own
    return View(_three(above), azimuth_of(_three(above), normal), 0.0, True)


def _upward(values: Sequence[Any], up: Operands | None) -> Any:
    if up is None:
        return None
    vector = placed(values, [up])[0, :, 0]
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 and np.isfinite(length) else None


def _three(vector: Any) -> Numbers:
    return float(vector[0]), float(vector[1]), float(vector[2])
