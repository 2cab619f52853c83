"""How much room a system takes, and from where it is seen first.

Both are found at the start and at random angles about it, the lengths those of the start: sampled, not proved, for
they decide only how large things are drawn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.positions import STILL
from mbsym.numerics.scenario import Scenario
from mbsym.picture.values import Coordinate, Measure, Numbers, Operands, View
from mbsym.report.animation import azimuth_of

#: So many positions are looked at; the first is the start.
POSITIONS = 24

#: Degrees of the first look at something that is not plane.
AZIMUTH, ELEVATION = 35.0, 22.0


def samples(known: Sequence[Coordinate], scenario: Scenario) -> Mapping[str, Any]:
    """Inputs of the program at these positions: velocities those of the start, t = 0."""
    source = np.random.default_rng(5)
    found: dict[str, Any] = {"t": np.zeros(POSITIONS)}
    for one, rate in zip(known, scenario.system.velocities, strict=True):
        turned = source.uniform(-np.pi, np.pi, POSITIONS) if one.kind is Measure.ANGLE else np.zeros(POSITIONS)
        turned[0] = 0.0
        found[one.name] = one.value + turned
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
    def of(cls, values: Sequence[Any], points: Sequence[Operands], reach: Sequence[float], up: Operands | None) -> Room:
        """From values of the program; ``reach`` is how far something extends about each point."""
        columns = [[np.broadcast_to(values[k], POSITIONS) for k in point] for point in points]
        places = np.array(columns, dtype=float).reshape(len(points), 3, POSITIONS)
        far = np.array(reach, dtype=float)
        good = np.all(np.isfinite(places), axis=(1, 2)) & np.isfinite(far)
        places, far = places[good], far[good, None, None]
        if not len(places):
            return cls(0.0, (0.0, 0.0, 0.0), 1.0, _view(np.zeros(3), 0.0, None))
        low, high = np.min(places - far, axis=(0, 2)), np.max(places + far, axis=(0, 2))
        whole = float(np.linalg.norm(np.maximum(high, 0.0) - np.minimum(low, 0.0)))
        # What is a point by itself, however far away, is drawn as one of unit size.
        middle = (low + high) / 2
        span = places - middle[:, None]
        radius = float(np.max(np.linalg.norm(span, axis=1) + far[:, 0]))
        point_like = radius <= STILL * float(np.max(np.abs(places), initial=0.0)) or radius == 0
        spread = np.ptp(places, axis=(0, 2)) if not point_like else np.zeros(3)
        own = None
        if up is not None:
            vector = np.array([float(np.broadcast_to(values[k], POSITIONS)[0]) for k in up])
            length = float(np.linalg.norm(vector))
            own = vector / length if length > 0 and np.isfinite(length) else None
        first, second, third = (float(x) for x in middle)
        return cls(
            whole if not point_like else 1.0 + whole,
            (first, second, third),
            1.0 if point_like else radius,
            _view(spread, radius, own),
        )


def _view(spread: Any, size: float, up: Any) -> View:
    """Into the plane of what is plane, else from aside and above."""
    flat = [k for k in (2, 1, 0) if spread[k] <= 1e-6 * size] if np.max(spread) > 0 else []
    axes = np.eye(3)
    if not flat or np.sum(spread > 1e-6 * size) < 2:
        above = axes[2] if up is None else up
        return View(_three(above), AZIMUTH, ELEVATION, False)
    normal = axes[flat[0]]
    above = up if up is not None else axes[1 if flat[0] != 1 else 2]
    if abs(float(normal @ above)) > 0.5:
        above = axes[1 if flat[0] != 1 else 2]
    return View(_three(above), azimuth_of(_three(above), normal), 0.0, True)


def _three(vector: Any) -> Numbers:
    return float(vector[0]), float(vector[1]), float(vector[2])
