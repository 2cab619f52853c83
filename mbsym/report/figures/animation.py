"""The moving system as a value that can be drawn frame by frame: what a page or a GIF shows is made once, here.

Frames are samples of the run, equally many apart; nothing is computed between them.  Bodies are lines between joints
and mass centres (``mbsym.numerics.positions``) and, where a body has mass and inertia, the homogeneous ellipsoid that
has both: principal moments A <= B <= C and mass m give the semi-axes

    a^2 = 5 (B + C - A) / (2 m),  ...

which turn with it.  A body with shapes is drawn by their outlines instead.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.model.system import System
from mbsym.numerics.between import accelerations
from mbsym.numerics.body_motion import BodyMotions, body_motions
from mbsym.numerics.positions import JOINT, ORIGIN, Positions, positions
from mbsym.numerics.scenario import Scenario
from mbsym.picture.looking import azimuth_of
from mbsym.report.outlines import Outline, outlines
from mbsym.simulation import Simulation

#: At most so many frames, and so many numbers in all of them.
MOST_FRAMES, MOST_NUMBERS = 1_200, 400_000

#: An ellipsoid smaller than this part of the picture is not drawn.
SEEN = 0.004
#: Nor is one whose second semi-axis is thinner than this part of the longest.
THIN = 0.02
#: One that is not true to scale is so large, as a part of the picture.
SYMBOLIC = 0.14


@dataclass(frozen=True)
class Ellipsoid:
    """Of ``body``: ``axes`` has shape (3, 3, frames), row i is semi-axis i, a vector in the axes of the frame; about
    ``places`` (3, frames)."""

    body: str
    axes: Any
    places: Any


@dataclass(frozen=True)
class Animation:
    """``places`` (points, 3, frames) of Positions, thinned to ``times``; ``true_size``: ellipsoids are true to scale.

    ``kinetic``, ``energy`` and ``drift`` have shape (frames,); ``stride`` samples of the run are one frame.
    """

    positions: Positions
    times: Any
    ellipsoids: tuple[Ellipsoid, ...]
    true_size: bool
    kinetic: Any
    energy: Any
    drift: Any
    stride: int
    outlines: tuple[Outline, ...] = ()

    @property
    def system(self) -> System:
        """What moves."""
        return self.positions.system

    @property
    def frames(self) -> int:
        """How many there are."""
        return len(self.times)


def animation(run: Simulation) -> Animation | None:
    """Frames of a run; None where there is nothing to draw, or nothing moved long enough to be seen."""
    found = run.trajectory
    count = len(found.times)
    if count < 2:
        return None
    turning = sum(body.inertia is not None or bool(body.shapes) for body in run.system.bodies)
    numbers = 3 * (2 * len(run.system.bodies) + 2) + 12 * turning
    most = max(2, min(MOST_FRAMES, MOST_NUMBERS // numbers))
    stride = -(-count // most)
    times, states = found.times[::stride], np.asarray(found.states[:, ::stride], dtype=float)
    return _scene(
        run.scenario,
        times,
        states,
        accelerations(run.dynamics, times, states),
        (found.kinetic[::stride], found.energy[::stride], found.drift[::stride]),
        stride,
    )


def _scene(
    scenario: Scenario, times: Any, states: Any, rates: Any, energies: tuple[Any, Any, Any], stride: int
) -> Animation | None:
    try:
        places = positions(scenario, times, states)
        if places is None:
            return None
        bodies = body_motions(scenario, times, states, rates, places.frame)
    except Failure:
        return None
    shapes = outlines(scenario, bodies) if places.bodied else ()
    ellipsoids, true_size = _ellipsoids(scenario, places, bodies, {item.body for item in shapes})
    kinetic, energy, drift = (np.asarray(x, dtype=float) for x in energies)
    return Animation(places, times, ellipsoids, true_size, kinetic, energy, drift, stride, shapes)


def _ellipsoids(
    scenario: Scenario, places: Positions, bodies: BodyMotions, shaped: Collection[str]
) -> tuple[tuple[Ellipsoid, ...], bool]:
    """Of bodies that are not ``shaped``, those that can be seen: true to scale where bodies extend.

    Elsewhere they are as large as is good to look at.
    """
    picture = extent(places)
    found = []
    for k, name in enumerate(bodies.names):
        own = _semi_axes(scenario, name)
        if own is not None and name not in shaped:
            sizes, directions = own
            if np.sort(sizes)[1] < THIN * np.max(sizes):
                continue  # a rod is a line already
            found.append((name, k, sizes, directions))
    if not found:
        return (), True
    largest = max(float(np.max(sizes)) for _, _, sizes, _ in found)
    true_size = places.bodied and largest >= SEEN * picture
    factor = 1.0 if true_size else SYMBOLIC * picture / largest
    made = []
    for name, k, sizes, directions in found:
        if factor * float(np.max(sizes)) < SEEN * picture:
            continue
        principal = np.einsum("pi,ijm->pjm", directions, bodies.axes[k])
        made.append(Ellipsoid(name, factor * sizes[:, None, None] * principal, bodies.places[k]))
    return tuple(made), true_size


def extent(places: Positions) -> float:
    """The diagonal of the box about everything that is drawn; 1 where all is one point."""
    return places.size or 1.0


def _semi_axes(scenario: Scenario, name: str) -> tuple[Any, Any] | None:
    """(semi-axes, principal directions in rows, in the body's axes); None where a body has no such ellipsoid."""
    from mbsym.numerics.scenario import exact

    body = scenario.system.body(name)
    if body.inertia is None:
        return None
    try:
        values = scenario.parameters
        mass = float(exact(body.mass, values))
        tensor = np.array([[float(exact(x, values)) for x in row] for row in body.inertia.tensor])
        centre = np.array([float(exact(x, values)) for x in body.mass_centre])
    except Failure:  # an inertia that varies with the coordinates
        return None
    if body.inertia.about == "joint":
        tensor = tensor - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    moments, columns = np.linalg.eigh(tensor)
    if not (mass > 0 and np.all(np.isfinite(moments)) and np.max(moments) > 0):
        return None
    squares = 2.5 / mass * (np.sum(moments) - 2 * moments)
    if np.min(squares) < -1e-6 * np.max(squares):
        return None  # no body has this inertia
    return np.sqrt(np.maximum(squares, 0.0)), columns.T


def moving_points(found: Positions) -> list[tuple[int, str]]:
    """(point, body) whose paths are drawn: mass centres, or the tips of axes where nothing else moves."""
    moving = set(found.moving(range(len(found.points))))
    centres = [(i, body) for body, i in found.centres.items() if i in moving]
    tips = [(i, found.points[i].body) for i in found.tips if i in moving]
    return [*centres, *tips] if found.bodied else tips


def dots(found: Positions) -> tuple[list[int], list[int]]:
    """(joints, mass centres) as numbers of points."""
    centres = [] if not found.bodied else list(found.centres.values())
    joints = [i for i, x in enumerate(found.points) if x.kind in (JOINT, ORIGIN) and i not in centres]
    return joints, centres


def view(found: Positions) -> tuple[Sequence[float], float, float]:
    """(up, azimuth, elevation) in degrees of the first look: into the plane of a plane motion, else from above."""
    up = found.up if found.up is not None else (0.0, 1.0, 0.0) if found.plane == 3 else (0.0, 0.0, 1.0)
    if found.plane is not None:
        normal = np.eye(3)[found.plane - 1]
        if abs(float(np.dot(normal, up))) > 0.5:
            up = tuple(np.eye(3)[1 if found.plane != 2 else 2])
        return up, azimuth_of(up, normal), 0.0
    return up, 35.0, 22.0
