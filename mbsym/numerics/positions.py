"""Where everything is: connection points and mass centres along a trajectory, in a frame in which they stay close.

    r_O = r^j_O turned back body by body into the axes of the frame F,   r_C = r_O + r^k_C,      from the origin of F

F is the inertial frame, or one that it carries without a coordinate's doing (an orbit): what moves by metres is not
drawn thousands of kilometres away.  Where nothing extends, bodies show their turning by the tips of their three axes
instead; so does, besides what moves along with it, a body that turns by three angles and has no line of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.algebra.program import Program
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.expressions.tree import ZERO, names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import ring_of
from mbsym.model.constraints import Coincide, Distance
from mbsym.model.system import INERTIAL, Body, System
from mbsym.model.system import Point as PointOfBody
from mbsym.numerics.carriers import COMPACT, STILL, frames
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.scenario import Scenario, bound, substituted

#: A picture shows so much motion that the longest path is so many times as long as the picture's diagonal; more would
#: fill it.  Of the axes of one body the slowest counts.
PLANAR, SPATIAL, TURNING = 5.0, 10.0, 15.0

#: Axes of a body that is seen with others are so much longer than the others are far from it.
BEYOND = 1.25

ORIGIN, JOINT, MASS_CENTRE, AXIS, END = "origin", "joint", "mass centre", "axis", "end"


@dataclass(frozen=True)
class Point:
    """A point that is drawn: the origin of the frame; of ``body``, its joint, mass centre, or tip of an ``axis``.

    Of kind END the one that a constraint ties: ``end`` is its place in ``_tied`` (constraint, 0 or 1).
    """

    body: str
    kind: str
    axis: int = 0
    end: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Positions:
    """``places`` has shape (points, 3, times): in the description's unit of length, in the axes of ``frame``.

    ``links`` join points by number within bodies, ``slides`` along springs and joints that change their length.
    ``centres`` are the mass centres by body.  ``up`` is the direction away from gravity in the frame's axes, None where
    there is none.  Where no body extends the points of kind AXIS are the tips of unit vectors; otherwise
    (``extended``) their length means nothing.
    """

    system: System
    frame: str
    points: tuple[Point, ...]
    links: tuple[tuple[int, int], ...]
    slides: tuple[tuple[int, int], ...]
    centres: Mapping[str, int]
    times: Any
    places: Any
    up: tuple[float, float, float] | None
    extended: bool = False

    @property
    def bodied(self) -> bool:
        """Whether bodies are drawn as lines and points, not by the tips of their axes alone."""
        return self.extended or not self.tips

    @property
    def size(self) -> float:
        """The diagonal of the box about all points at all times."""
        return float(np.linalg.norm(np.ptp(self.places, axis=(0, 2))))

    @property
    def plane(self) -> int | None:
        """The axis 1, 2 or 3 of the frame along which nothing extends and nothing moves; None in space."""
        spread = np.ptp(self.places, axis=(0, 2))
        flat = [axis for axis in (3, 2, 1) if spread[axis - 1] <= STILL * self.size]
        return flat[0] if flat else None

    @property
    def tips(self) -> tuple[int, ...]:
        """The points that are tips of axes."""
        return tuple(i for i, point in enumerate(self.points) if point.kind == AXIS)

    def moving(self, numbers: Iterable[int]) -> list[int]:
        """Those of the points that change their place."""
        spread = np.max(np.ptp(self.places, axis=2), axis=1)
        return [i for i in numbers if spread[i] > STILL * max(self.size, float(np.max(np.abs(self.places))))]

    def until(self, end: int) -> Positions:
        """The first ``end`` times."""
        return replace(self, times=self.times[:end], places=self.places[:, :, :end])

    def readable(self) -> Positions:
        """The first part, in which paths do not fill the picture."""
        paths = np.concatenate(
            (np.zeros((len(self.points), 1)), np.cumsum(np.linalg.norm(np.diff(self.places, axis=2), axis=1), axis=1)),
            axis=1,
        )
        moving = self.moving(range(len(self.points)))
        if not moving:
            return self
        own = [i for i in moving if i not in self.tips]
        if self.tips and not (self.extended and own):
            length, most = np.min(paths[[i for i in self.tips if i in moving]], axis=0, initial=np.inf), TURNING
        else:
            length, most = np.max(paths[own], axis=0), SPATIAL if self.plane is None else PLANAR
        end = int(np.searchsorted(length, most * self.size, side="right"))
        return self.until(max(end, 2))


def positions(scenario: Scenario, times: Any, states: Any) -> Positions | None:
    """Points along a trajectory (``states`` of shape (2n, m)); None where there is nothing to draw."""
    system = scenario.system
    program = Program()
    scene = scene_without_accelerations(system, ring_of(system), program)
    fresh = bound(scenario)
    inputs = ("t", *system.coordinates, *system.velocities)
    carriers = frames(system)
    codes = {}
    for number, frame in enumerate(carriers):
        vectors = [*(_place(scene, frame, point) for point in _points(system, frame)), *_upward(scene, frame)]
        nodes = substituted(program, [x for vector in vectors for x in vector], fresh)
        codes[f"frame{number}"] = Code(fresh, inputs, tuple(nodes))
    compiled = kernels(codes)
    moments = np.vstack([times, np.asarray(states, dtype=float)])
    with np.errstate(all="ignore"):
        places = [compiled[f"frame{i}"](moments) for i in range(len(carriers))]
        drawings = [_positions(system, frame, rows, moments[0]) for frame, rows in zip(carriers, places, strict=True)]
        drawings = [item for item in drawings if 0 < item.size < np.inf]
        least = min(map(_extent, drawings), default=0.0)
    return next((item for item in drawings if _extent(item) <= COMPACT * least), None)


def _points(system: System, frame: str) -> list[Point]:
    """The origin, joints, mass centres that are not there, and tips of axes of bodies with inertia."""
    points = [Point(frame, ORIGIN)]
    for body in system.bodies:
        if frame not in system.path(body.name)[:-1] and frame != INERTIAL:
            continue
        points.append(Point(body.name, JOINT))
        if body.mass != ZERO and any(x != ZERO for x in body.mass_centre):
            points.append(Point(body.name, MASS_CENTRE))
        if body.inertia is not None:
            points += [Point(body.name, AXIS, axis) for axis in (1, 2, 3)]
    there = {point.body for point in points[1:]}
    for number, ends in _tied(system).items():
        for side, end in enumerate(ends):
            if end.body in there and any(x != ZERO for x in end.position):
                points.append(Point(end.body, END, end=(number, side)))
    return points


def _tied(system: System) -> dict[int, tuple[PointOfBody, PointOfBody]]:
    """The two points that a constraint lets coincide, or holds at a distance, by its number."""
    kinds = (Coincide, Distance)
    return {
        k: (constraint.first, constraint.second)
        for k, constraint in enumerate(system.constraints)
        if isinstance(constraint, kinds)
    }


def _place(scene: Scene, frame: str, point: Point) -> Vector:
    """r of a point; the tip of an axis as a unit vector."""
    if point.kind == ORIGIN:
        return scene.zero(frame)
    if point.kind == AXIS:
        return scene.to_axes(axis_vector(scene.algebra, point.axis, scene.algebra.one, point.body), frame)
    if point.kind == END:
        number, side = point.end
        return scene.position(scene.vector(_tied(scene.system)[number][side].position, point.body), frame)
    own = scene.motions[point.body].mass_centre if point.kind == MASS_CENTRE else scene.zero(point.body)
    return scene.position(own, frame)


def _upward(scene: Scene, frame: str) -> Iterator[Vector]:
    """Against gravity, in the axes of the frame: away from the centre, or opposite to uniform gravity."""
    for load in scene.system.loads:
        upward = KINDS[type(load)].upward
        up = None if upward is None else upward(load, scene, frame)
        if up is not None:
            yield up
            return


def _positions(system: System, frame: str, values: Any, times: Any) -> Positions:
    points = _points(system, frame)
    places = np.array(values[: 3 * len(points)], dtype=float).reshape(len(points), 3, -1)
    upward = np.asarray(values[3 * len(points) :, 0], dtype=float)
    length = float(np.linalg.norm(upward)) if len(upward) else 0.0
    up = (float(upward[0] / length), float(upward[1] / length), float(upward[2] / length)) if length > 0 else None
    joints = {point.body: i for i, point in enumerate(points) if point.kind == JOINT}
    own = [i for i, point in enumerate(points) if point.kind in (JOINT, MASS_CENTRE, END)]
    extent = float(np.max(np.linalg.norm(np.ptp(places[own], axis=0), axis=0)))
    travelled = float(np.linalg.norm(np.ptp(places[own], axis=(0, 2))))
    scale = float(np.max(np.abs(places[own])))
    point_like = extent <= STILL * scale
    drawn = _own_axes(system, frame, points, places) if not point_like else {}
    for i, point in enumerate(points):
        if point.body in drawn and point.kind == AXIS:
            places[i] = places[joints[point.body]] + drawn[point.body] * places[i]
        elif point.kind == AXIS:
            places[i] = places[joints[point.body]] + (0.1 * travelled if travelled > STILL * scale else 1.0) * places[i]
    selected = [
        i
        for i, point in enumerate(points)
        if point.kind in (JOINT, MASS_CENTRE, END) or (point.kind == AXIS and (point_like or point.body in drawn))
    ]
    if _ties_to_origin(system, frame) or any(_held(system, frame, points[i]) for i in selected):
        selected.insert(0, 0)
    shown = tuple(points[i] for i in selected)
    links, slides = _lines(system, frame, shown)
    centres = {body.name: _centre(shown, body) for body in system.bodies if body.mass != ZERO and body.name in joints}
    return Positions(system, frame, shown, links, slides, centres, times, places[selected], up, not point_like)


def _own_axes(system: System, frame: str, points: Sequence[Point], places: Any) -> dict[str, float]:
    """How long to draw the axes of bodies that turn by three angles about a point at rest and have no own line.

    Nothing where all motion is in a plane: there the picture says enough.
    """
    plain = [i for i, point in enumerate(points) if point.kind in (JOINT, MASS_CENTRE)]
    spread = np.ptp(places[plain], axis=(0, 2))
    size = float(np.linalg.norm(spread))
    if np.any(spread <= STILL * size):
        return {}
    links, _ = _lines(system, frame, [points[i] for i in plain])
    lined = {end for link in links if _length(places, [plain[k] for k in link]) > STILL * size for end in link}
    own_axes = {}
    for k, i in enumerate(plain):
        name, kind = points[i].body, points[i].kind
        angles = {x for angle in system.body(name).rotation.angles for x in names(angle)}
        free = len(angles & set(system.coordinates)) >= 3 and system.body(name).inertia is not None
        if kind == JOINT and free and k not in lined and np.max(np.ptp(places[i], axis=1)) <= STILL * size:
            carried = [j for j in plain if name in system.path(points[j].body)]
            reach = max(_length(places, (i, j)) for j in carried)
            own_axes[name] = BEYOND * reach if reach > STILL * size else size / 4
    return own_axes


def _length(places: Any, pair: Sequence[int]) -> float:
    """The greatest distance of two points."""
    return float(np.max(np.linalg.norm(places[pair[0]] - places[pair[1]], axis=0)))


def _centre(points: Sequence[Point], body: Body) -> int:
    own = [i for i, point in enumerate(points) if point.body == body.name and point.kind in (JOINT, MASS_CENTRE)]
    return own[-1]


def _held(system: System, frame: str, point: Point) -> bool:
    """Whether a joint hangs on the origin of the frame by a spring or a damper."""
    if point.kind != JOINT or system.body(point.body).attached_to != frame:
        return False
    held = {name for load in system.loads if not load.given for name in load.coordinates}
    return any(held & names(x) for x in system.body(point.body).connection_point)


def _lines(
    system: System, frame: str, points: Sequence[Point]
) -> tuple[tuple[tuple[int, int], ...], tuple[tuple[int, int], ...]]:
    """Links and slides; no line leads from the frame to a body that floats or rolls freely."""
    number = {(point.body, point.kind): i for i, point in enumerate(points)}
    moving = {*system.coordinates, *system.velocities}
    links: list[tuple[int, int]] = []
    slides: list[tuple[int, int]] = []
    for i, point in enumerate(points):
        if point.kind in (MASS_CENTRE, AXIS, END):
            links.append((number[point.body, JOINT], i))
        elif point.kind == JOINT:
            body = system.body(point.body)
            parent = number.get((body.attached_to, JOINT))
            if _held(system, frame, point):
                parent = number[frame, ORIGIN]
            if parent is not None:
                moves = any(moving & names(x) for x in body.connection_point)
                (slides if moves else links).append((parent, i))
    ends = {point.end: i for i, point in enumerate(points) if point.kind == END}
    for k, constraint in enumerate(system.constraints):
        if isinstance(constraint, Distance):
            sides = [
                ends.get((k, side), number.get((attachment.body, ORIGIN if attachment.body == frame else JOINT)))
                for side, attachment in enumerate((constraint.first, constraint.second))
            ]
            if sides[0] is not None and sides[1] is not None:
                links.append((sides[0], sides[1]))
    return tuple(links), tuple(slides)


def _ties_to_origin(system: System, frame: str) -> bool:
    """Whether a rod leads to the origin of the frame."""
    ends = (point for k, pair in _tied(system).items() if isinstance(system.constraints[k], Distance) for point in pair)
    return any(end.body == frame and all(x == ZERO for x in end.position) for end in ends)


def _extent(drawing: Positions) -> float:
    """How large the system looks, the origin of the frame included."""
    low = np.minimum(np.min(drawing.places, axis=(0, 2)), 0.0)
    high = np.maximum(np.max(drawing.places, axis=(0, 2)), 0.0)
    return float(np.linalg.norm(high - low))
