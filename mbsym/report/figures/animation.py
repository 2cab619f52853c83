"""The moving system as a value that can be drawn frame by frame: what a page or a GIF shows is made once, here.

Frames are samples of the run, equally many apart; nothing is computed between them.  Bodies are lines between joints
and mass centres (``mbsym.numerics.positions``) and, where a body has mass and inertia, the homogeneous ellipsoid that
has both: principal moments A <= B <= C and mass m give the semi-axes

    a^2 = 5 (B + C - A) / (2 m),  ...

which turn with it.  A body with shapes is drawn by their outlines instead.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.model.system import System
from mbsym.numerics.between import accelerations
from mbsym.numerics.body_motion import BodyMotions, body_motions
from mbsym.numerics.positions import JOINT, ORIGIN, Positions, positions
from mbsym.numerics.scenario import Scenario
from mbsym.picture.looking import ellipsoid, looked_at
from mbsym.picture.values import View
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
        own = ellipsoid(scenario.system.body(name), scenario.parameters, thickness=0.0)
        if own is not None and own.true_size and name not in shaped:
            sizes, directions = np.array(own.half_axes), np.array(own.axes)
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


def view(found: Positions) -> View:
    """The first look: into the plane of a plane motion, else from above."""
    return looked_at(found.up, None if found.plane is None else found.plane - 1)
