"""The drawing of a system on paper, as a value: lines, points, arrows and letters, in centimetres.

    sketch(system)     None where nothing of it has an extent

It shows what ``Picture`` says stands where, in one position: that of the start, but angles that would hardly be seen
there, and coordinates that would put a body upon its zero, are others (``Sketch.at`` has them all).  Bodies are their
shapes, else ellipsoids with their mass and inertia; what a body slides along, a hoop or a track, is found by moving it.
An angle is drawn as the arc that its own coordinate, from zero on, moves the body along.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cached_property, partial
from math import ceil, cos, dist, hypot, isfinite, pi, sin
from typing import Any

from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import ZERO, Expression, Name, Negative, Number, names, text
from mbsym.formulas.names import parts
from mbsym.model.constraints import Coincide, Distance
from mbsym.model.loads import (
    CoordinateDamper,
    CoordinateSpring,
    IsotropicDamper,
    PointDamper,
    PointForce,
    PointSpring,
    UniformGravity,
)
from mbsym.model.system import INERTIAL, Body, System, Vector
from mbsym.numerics.scenario import Incomplete, exact
from mbsym.picture import outlined
from mbsym.picture.build import picture_at, start
from mbsym.picture.lettering import Letters
from mbsym.picture.looking import AXES, at, combined, dot, projection, unit
from mbsym.picture.program import Varied
from mbsym.picture.values import Acting, Drawn, Ellipsoid, Guide, Hinge, Measure, Numbers, Operands, Picture, Stretch

#: The drawing fits into so many centimetres, letters apart.
WIDE, TALL = 6.2, 4.2

#: Angles nearer than this to a quarter of a turn are drawn so much away from it, one after the other.
HARDLY, SEEN = 0.3, (0.5, 0.8, 0.35, 0.65)

#: A length that is nearer to zero than this part of the whole is drawn at so large a part of it.
AWAY, MOVED = 0.12, 0.4

#: More bodies than these have no letters but those of coordinates.
LETTERED = 8

#: A longer formula is no letter.
SHORT = 9

#: Pieces of an arc on the paper.
ARC = 7

Place = tuple[float, float]


class Ink(Enum):
    """How a line is drawn; HIDDEN is dashed and thin, SOLID the edge of a body."""

    BODY = "body"
    SOLID = "solid"
    GUIDE = "guide"
    THIN = "thin"
    HIDDEN = "hidden"


@dataclass(frozen=True)
class Stroke:
    """A line through ``points``; ``of`` says what it is: "rod", "guide of bead", "angle theta".

    ``closed``: an outline, ``tinted`` inside; ``arrow``: with a head at its end; ``both``: at its start, too;
    ``smooth``: a curve through the points.
    """

    of: str
    points: tuple[Place, ...]
    ink: Ink
    closed: bool = False
    tinted: bool = False
    arrow: bool = False
    both: bool = False
    smooth: bool = False


@dataclass(frozen=True)
class Dot:
    """A point: a mass centre, ``open`` a joint."""

    of: str
    place: Place
    radius: float
    open: bool = False


@dataclass(frozen=True)
class Letter:
    """A formula, or the number of an axis, about its middle."""

    text: Expression | int
    place: Place


Mark = Stroke | Dot


@dataclass(frozen=True)
class Sketch:
    """``marks`` in the order in which they cover each other, ``letters`` upon them, between ``low`` and ``high``.

    ``at``: the position that is drawn; ``frame``: the body in whose axes; ``unknown``: parameters of the geometry
    without a value: nothing is to scale then; ``ellipsoids``: some body is drawn as the one with its mass and inertia.
    """

    marks: tuple[Mark, ...]
    letters: tuple[Letter, ...]
    low: Place
    high: Place
    at: tuple[tuple[str, float], ...]
    frame: str
    unknown: tuple[str, ...]
    ellipsoids: bool


def sketch(system: System) -> Sketch | None:
    """See the module.  What cannot be drawn (values that contradict each other, a place that is singular) is not."""
    if not system.bodies:
        return None
    try:
        begun = start(system)
        if begun.open_loop:
            return None
        paper = _Paper(picture_at(begun), system, tuple(name for name, _ in begun.stand_ins))
        return paper.sketch()
    except (Failure, Incomplete):
        return None


class Film:
    """The moving system as it is drawn on paper, without letters, in centimetres.

    ``columns`` are the inputs of the picture's program by name at ``times`` (m,); one that is not there is zero.
    ``paths`` are those of mass centres that move.
    """

    def __init__(self, found: Picture, system: System, times: Sequence[float], columns: Mapping[str, Any]) -> None:
        self.times = [float(t) for t in times]
        self._found, self._system = found, system
        count = len(self.times)
        zero = [0.0] * count
        self._columns = {name: columns.get(name, zero) for name in found.program.inputs} | {"t": self.times}
        self._names = {coordinate.name: columns.get(coordinate.name, zero) for coordinate in found.coordinates}
        values = found.program.evaluate(self._columns)
        self._rows = [[float(x) for x in value] if value.shape else [float(value)] * count for value in values]
        look = projection(found.view)
        bodies = [body for body in found.bodies if body.massive]
        flat = [[(dot(look[0], x), dot(look[1], x)) for x in self._track(body.centre)] for body in bodies]
        # The longest way that something reaches on the paper decides how large a centimetre is.
        every = [x for body in found.bodies for at_ in (body.origin, body.centre) for x in self._track(at_)]
        every += [x for line in found.lines for at_ in (line.start, line.end) for x in self._track(at_)]
        spread = [_width([dot(row, x) for x in every]) for row in look[:2]] if every else [0.0, 0.0]
        solids = [2 * max(solid.half_axes) for body in found.bodies if (solid := _shown(body))]
        wide, tall = (max([x, *solids]) for x in spread)
        size = max(hypot(wide, tall), 1e-9 * found.extent) or 1.0
        self.unit = min(WIDE / max(wide, 1e-9 * size), TALL / max(tall, 1e-9 * size), 8.0 / size)
        paths = [[(self.unit * x, self.unit * y) for x, y in track] for track in flat]
        self.paths = [path for path in paths if max(_width([x for x, _ in path]), _width([y for _, y in path])) > 0.01]

    def _track(self, operands: Operands) -> list[Numbers]:
        a, b, c = (self._rows[k] for k in operands)
        return [place for place in zip(a, b, c, strict=True) if all(map(isfinite, place))]

    def marks(self, k: int) -> tuple[Mark, ...]:
        """What is drawn of moment k."""
        state = {name: float(column[k]) for name, column in (self._columns | self._names).items()}
        ranges = {name: (float(min(x)), float(max(x))) for name, x in self._names.items()}
        paper = _Paper(self._found, self._system, (), state, [row[k] for row in self._rows])
        return paper.film(self.unit, ranges)


def _shown(body: Drawn) -> Ellipsoid | None:
    """The ellipsoid that is drawn: of a known size, and telling."""
    ellipsoid = body.ellipsoid
    return ellipsoid if ellipsoid is not None and ellipsoid.true_size and ellipsoid.telling else None


def _width(values: Sequence[float]) -> float:
    return max(values) - min(values)


class _Paper:
    def __init__(
        self,
        found: Picture,
        system: System,
        unknown: tuple[str, ...],
        state: dict[str, float] | None = None,
        values: Sequence[float] = (),
    ) -> None:
        self.picture, self.system, self.unknown = found, system, unknown
        #: How far coordinates go, where the system moves: tracks stay in their place then.
        self.ranges: Mapping[str, tuple[float, float]] = {}
        self.still = state is None
        self.bodies = {body.name: body for body in found.bodies}
        self.own: dict[str, Body] = {body.name: body for body in system.bodies}
        self.look = projection(found.view)
        self.state = self._state() if state is None else state
        self.values = found.program.at(self.state) if state is None else values
        self.marks: list[Mark] = []
        self.letters: Letters[Expression | int] = Letters()
        self.few = len(found.bodies) <= LETTERED

    # --- where ---

    def _state(self) -> dict[str, float]:
        """The position that is drawn."""
        picture = self.picture
        state = dict.fromkeys(picture.program.inputs, 0.0) | {"t": 0.0}
        for coordinate, rate in zip(picture.coordinates, self.system.velocities, strict=True):
            state[coordinate.name], state[rate] = coordinate.value, coordinate.velocity
        if picture.closure is not None:
            return state
        moved = dict(state)
        turn = 0
        # Of what turns by three angles the axes are drawn, not far from those of the frame: they are to be told apart.
        joints = [{c for x in body.joint.hinges if not x.slides for c in x.coordinates} for body in picture.bodies]
        tilted = {name for joint in joints if len(joint) > 2 for name in joint}
        for coordinate in picture.coordinates:
            nearest = pi / 2 * round(coordinate.value / (pi / 2))
            if coordinate.kind is Measure.ANGLE and not coordinate.limited and abs(coordinate.value - nearest) < HARDLY:
                moved[coordinate.name] = nearest + SEEN[turn % len(SEEN)] * (
                    (-0.5, 0.5)[turn % 2] if coordinate.name in tilted else 1
                )
                turn += 1
        size = self._size(moved)
        for slider in picture.coordinates:
            if slider.name in self._sliding and slider.kind is Measure.LENGTH and abs(slider.value) < AWAY * size:
                there = self._rounded(MOVED * size)
                moved[slider.name] = (
                    there if slider.minimum <= there <= slider.maximum or not slider.limited else slider.value
                )
        return moved if isfinite(self._size(moved)) else state

    def _size(self, state: dict[str, float]) -> float:
        """How large the system is, on the paper; of what is a point 1."""
        values = self.picture.program.at(state)
        ends = [x for body in self.picture.bodies for x in (body.origin, body.centre)]
        flat = [self.flat(at(values, x)) for x in ends]
        far = max((dist(a, b) for a in flat for b in flat), default=0.0)
        reach = [hypot(*shape.size) for body in self.picture.bodies for shape in body.shapes]
        far = max([far, *reach])
        return far if far > 1e-9 * self.picture.extent or not isfinite(far) else 1.0

    @staticmethod
    def _rounded(value: float) -> float:
        return float(f"{value:.1g}")

    def point(self, operands: Operands, values: Sequence[float] | None = None) -> Numbers:
        return at(self.values if values is None else values, operands)

    def flat(self, place: Numbers) -> Place:
        """A point of space on the paper, in the description's unit of length."""
        return dot(self.look[0], place), dot(self.look[1], place)

    def depth(self, place: Numbers) -> float:
        """How near it is to the eye."""
        return dot(self.look[2], place)

    def varied(self, name: str, value: float, zero: Iterable[str] = ()) -> Varied:
        """The program's values with one coordinate at another value, and some at zero."""
        return Varied(self.picture.program, self.values, dict.fromkeys(zero, 0.0) | {name: value})

    # --- scale ---

    def sketch(self) -> Sketch | None:
        """Everything, scaled and lettered."""
        solids = list(self._solids())
        guides = list(self._guides())
        extent = [self.flat(self.point(x)) for body in self.picture.bodies for x in (body.origin, body.centre)]
        extent += [self.flat(self.point(x)) for line in self.picture.lines for x in (line.start, line.end)]
        extent += [place for solid in solids for place in solid.outline]
        extent += [self.flat(place) for _, places in guides for place in places]
        if not all(isfinite(x) for place in extent for x in place):
            return None
        carts = [
            self.flat(self.point(body.origin, self.varied(name, 0.0)))
            for name, (body, _) in self._sliding.items()
            if body.cart
        ]
        extent += carts
        low = min(x for x, _ in extent), min(y for _, y in extent)
        high = max(x for x, _ in extent), max(y for _, y in extent)
        size = hypot(high[0] - low[0], high[1] - low[1])
        far = max(abs(x) for place in extent for x in place)
        if size <= 1e-9 * max(1e-300, far):
            return None
        self.unit = min(
            WIDE / max(high[0] - low[0], 1e-9 * size),
            TALL / max(high[1] - low[1], 1e-9 * size),
            (2.6 if carts and len(self.picture.bodies) == 1 else 8.0) / size,
        )
        self.middle = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
        self._draw(solids, guides)
        for guide, places in guides:
            self._circled(guide, places)
        self._angles()
        self._forces()
        self._body_axes()
        self._driven()
        if not any(isinstance(x, Stroke) for x in self.marks):
            return None
        self._corner()
        return self._finished()

    def film(self, unit: float, ranges: Mapping[str, tuple[float, float]]) -> tuple[Mark, ...]:
        """What is drawn of it while it moves: nothing that only carries letters."""
        self.unit, self.middle, self.ranges = unit, (0.0, 0.0), ranges
        self._draw(list(self._solids()), list(self._guides()))
        self._body_axes()
        return tuple(self.marks)

    def cm(self, place: Place) -> Place:
        """Centimetres from the middle."""
        return self.unit * (place[0] - self.middle[0]), self.unit * (place[1] - self.middle[1])

    def on(self, place: Numbers) -> Place:
        return self.cm(self.flat(place))

    def spot(self, operands: Operands) -> Place:
        return self.on(self.point(operands))

    # --- what ---

    @dataclass(frozen=True)
    class Solid:
        """A body's look: ``outline`` and ``edges`` in the plane of the paper."""

        of: str
        outline: tuple[Place, ...]
        edges: tuple[tuple[Place, ...], ...]
        depth: float
        round: bool

    def _solids(self) -> Iterator[_Paper.Solid]:
        for body in self.picture.bodies:
            axes = tuple(self.point(row) for row in body.axes)
            origin = self.point(body.origin)
            for shape in body.shapes:
                middle = combined((1.0, *shape.at), (origin, *axes))
                rows = tuple(combined(row, axes) for row in shape.axes)
                yield self._solid(body.name, shape.kind, shape.size, middle, rows)
            ellipsoid = _shown(body)
            if ellipsoid is not None:
                rows = tuple(combined(row, axes) for row in ellipsoid.axes)
                yield self._solid(body.name, "ellipsoid", ellipsoid.half_axes, self.point(body.centre), rows)

    def _solid(
        self, of: str, kind: str, size: Sequence[float], middle: Numbers, rows: Sequence[Numbers]
    ) -> _Paper.Solid:
        outline, edges = outlined.outlined(kind, size, middle, rows, self.look)
        return self.Solid(of, outline, edges, self.depth(middle), kind in ("sphere", "ellipsoid"))

    @cached_property
    def _sliding(self) -> dict[str, tuple[Drawn, Hinge]]:
        """By coordinate, the body that it moves, where one alone moves it."""
        sliders = {}
        for body in self.picture.bodies:
            hinges = [x for x in body.joint.hinges if x.slides]
            if len(hinges) == 1:
                sliders[hinges[0].coordinates[0]] = body, hinges[0]
        return sliders

    def _guides(self) -> Iterator[tuple[Guide, tuple[Numbers, ...]]]:
        """Hoops with their points in the axes of the picture."""
        for guide in self.picture.guides:
            parent = self.bodies[guide.body].parent
            carrier = None if parent is None else self.bodies[parent]
            origin = (0.0, 0.0, 0.0) if carrier is None else self.point(carrier.origin)
            axes = AXES if carrier is None else tuple(self.point(row) for row in carrier.axes)
            yield guide, tuple(combined((1.0, *point), (origin, *axes)) for point in guide.points)

    # --- drawn ---

    def _draw(self, solids: Sequence[_Paper.Solid], guides: Sequence[tuple[Guide, tuple[Numbers, ...]]]) -> None:
        for guide, places in guides:
            line = tuple(map(self.on, places))
            of = f"guide: {self.bodies[guide.body].parent or 'guide'}"
            self.line(of, line[:-1] if guide.closed else line, Ink.GUIDE, closed=guide.closed, smooth=True)
        for solid in sorted(solids, key=lambda x: x.depth):
            outline = tuple(map(self.cm, solid.outline))
            self.line(solid.of, outline, Ink.SOLID, closed=True, tinted=True, smooth=solid.round)
            for edge in solid.edges:
                self.line(solid.of, tuple(map(self.cm, edge)), Ink.THIN, smooth=len(edge) > 2)
        self._tracks()
        self._lines()
        self._points()

    def line(self, of: str, points: Sequence[Place], ink: Ink, **how: bool) -> None:
        self.marks.append(Stroke(of, tuple(points), ink, **how))
        self.letters.avoid(points, bool(how.get("closed")))

    def letter(self, what: Expression | int, place: Place, away: Place = (0.0, 0.0), near: float = 0.16) -> None:
        """A letter near a place, rather in the direction ``away``."""
        if self.still:
            self.letters.add(what, _letters_of(what), place, away, near)

    def _tracks(self) -> None:
        """Carts and blocks, on ground or held by springs, with the coordinate that moves them."""
        for name, (body, hinge) in self._sliding.items():
            along = self.flat(self.point(hinge.along))
            size = hypot(*along)
            if size < 1e-6 or self._is_angle(name):
                continue
            right = _unit(along)
            zero = self.on(self.point(body.origin, self.varied(name, 0.0)))
            here = self.spot(body.origin)
            sprung, damped = name in body.joint.sprung, name in body.joint.damped
            if body.cart:
                self._cart(body, name, here, zero, right, sprung, damped)
            elif dist(here, zero) > 0.3:
                self._tied(body, name, zero, here, sprung, damped)

    def _tied(self, body: Drawn, name: str, zero: Place, here: Place, sprung: bool, damped: bool) -> None:
        """What slides along a line from where its coordinate is zero, with its spring."""
        side = _turned(_direction(zero, here))
        before = self._before(body)
        if dist(before, zero) > 0.1 and dist(before, here) > 0.1:
            self.line(body.parent or "ground", (before, zero), Ink.HIDDEN)
        if sprung:
            self.line(f"spring: {name}", _coil(zero, here), Ink.SOLID)
            self.letter(self._stiffness(name), _between(zero, here), (-side[0], -side[1]), 0.3)
        elif damped:
            self._dashpot(f"damper: {name}", zero, here)
        else:
            self.line(body.name, (zero, here), Ink.HIDDEN)
        shift = 0.34 if sprung or damped else 0.0
        if shift and self.still:
            ends = [_moved(place, side, shift) for place in (zero, here)]
            self.line(f"length: {name}", ends, Ink.THIN, arrow=True, both=True)
            self.letter(Name(name), _between(*ends), side)
        else:
            self.letter(Name(name), _between(zero, here), side)

    def _cart(self, body: Drawn, name: str, here: Place, zero: Place, right: Place, sprung: bool, damped: bool) -> None:
        """A box on wheels where it goes level, else a block on its track; its coordinate below it."""
        up = _turned(right)
        if up[1] < -1e-9 or (abs(up[1]) < 1e-9 and up[0] > 0):
            right, up = (-right[0], -right[1]), (-up[0], -up[1])
        wide, tall, wheel = 0.55, 0.26, 0.12
        level = abs(right[1]) < 1e-6 and any(isinstance(x, UniformGravity) for x in self.system.loads)
        there = partial(_moved, here, right)
        floor = -tall - (2 * wheel if level else 0.0)
        towards = (zero[0] - here[0]) * right[0] + (zero[1] - here[1]) * right[1]
        left, end = min(-1.6, towards - 0.5), max(1.2, towards + 0.4)
        if sprung or damped:
            left = min(left, -2.1)
        if name in self.ranges:
            low, high = (self.unit * x for x in self.ranges[name])
            left, end = towards + low + (-2.1 if sprung or damped else -1.6), towards + high + 1.2
        self.line("ground", (there(left, floor), there(end, floor)), Ink.THIN)
        self._hatched("ground", there(left, floor), there(end, floor), (-up[0], -up[1]))
        corners = [there(-wide, -tall), there(wide, -tall), there(wide, tall), there(-wide, tall)]
        self.line(body.name, corners, Ink.SOLID, closed=True, tinted=True)
        if level:
            for a in (-0.32, 0.32):
                self.marks.append(Dot(f"wheel of {body.name}", there(a, floor + wheel), wheel, open=True))
        if sprung or damped:
            wall = [there(left, floor), there(left, tall + 0.25)]
            self.line("wall", wall, Ink.THIN)
            self._hatched("wall", wall[1], wall[0], (-right[0], -right[1]))
            both = sprung and damped
            if sprung:
                a = 0.13 if both else 0.0
                self.line(f"spring: {name}", _coil(there(left, a), there(-wide, a)), Ink.SOLID)
                self.letter(self._stiffness(name), there((left - wide) / 2, a), up, 0.3)
            if damped:
                b = -0.15 if both else 0.0
                self._dashpot(f"damper: {name}", there(left, b), there(-wide, b))
                if not both:
                    self.letter(self._damping(name), there((left - wide) / 2, b), up, 0.3)
        below = floor - 0.42
        if abs(towards) > 0.3 and self.still:
            self.line(f"zero: {name}", (there(towards, floor), there(towards, below - 0.1)), Ink.THIN)
            self.line(f"length: {name}", (there(towards, below), there(0.0, below)), Ink.THIN, arrow=True)
            self.line(f"end: {name}", (there(0.0, floor), there(0.0, below - 0.1)), Ink.HIDDEN)
            self.letter(Name(name), there(towards / 2, below), (-up[0], -up[1]))
        self._mass(body, there(0.3, 0.0), (0.0, 0.0), 0.0)

    def _lines(self) -> None:
        guided = set(self._sliding)
        for line in self.picture.lines:
            first, second = self.spot(line.start), self.spot(line.end)
            if dist(first, second) < 0.05:
                continue
            side = _turned(_direction(first, second))
            match line.kind:
                case Stretch.BODY | Stretch.LINK:
                    self.line(line.of or "ground", (first, second), Ink.BODY if line.of != INERTIAL else Ink.THIN)
                case Stretch.ROD:
                    self.line(line.of, (first, second), Ink.BODY)
                case Stretch.SPRING:
                    self.line(line.of, _coil(first, second), Ink.SOLID)
                    load = self.system.loads[int(line.of.split()[-1]) - 1]
                    if isinstance(load, PointSpring):
                        self.letter(load.stiffness, _between(first, second), side, 0.3)
                case Stretch.DAMPER:
                    self._dashpot(line.of, first, second)
                case Stretch.SLIDE:
                    axes = {x for hinge in self.bodies[line.of].joint.hinges if hinge.slides for x in hinge.coordinates}
                    if not axes & guided:
                        self.line(line.of, (first, second), Ink.HIDDEN)
        if self.few:
            self._lengths()

    def _lengths(self) -> None:
        """Letters of lengths beside the lines that are as long."""
        lettered: list[tuple[str, Place, Place]] = []
        for body in self.picture.bodies:
            own = self.own[body.name]
            start = INERTIAL if body.parent is None else body.parent
            before = None if body.parent is None else self.spot(self.bodies[start].origin)
            here = self.spot(body.origin)
            ends = [(own.mass_centre, here, self.spot(body.centre))] if body.massive and not self._goes_on(body) else []
            if before is not None and not any(x.slides for x in body.joint.hinges):
                ends.insert(0, (own.connection_point, before, here))
            ends += [(vector, here, end) for vector, end in self._tied_points(body)]
            for vector, first, second in ends:
                length = _length_of(vector)
                if length is None or dist(first, second) < 0.5 or (text(length), first, second) in lettered:
                    continue
                lettered.append((text(length), first, second))
                self.letter(length, _between(first, second), _turned(_direction(first, second)))

    def _tied_points(self, body: Drawn) -> Iterator[tuple[Vector, Place]]:
        """Points of a body that a constraint ties."""
        axes = [self.point(row) for row in body.axes]
        for constraint in self.system.constraints:
            if isinstance(constraint, Coincide | Distance):
                for point in (constraint.first, constraint.second):
                    arm = self._numbers(point.position) if point.body == body.name else None
                    if arm is not None:
                        yield point.position, self.on(combined((1.0, *arm), (self.point(body.origin), *axes)))

    def _numbers(self, position: Vector) -> Numbers | None:
        """A point of a body, where only parameters say which."""
        values = self.picture.values
        if not all(names(x) <= values.keys() for x in position):
            return None
        exactly = {name: Fraction(x) for name, x in values.items()}
        a, b, c = (float(exact(x, exactly)) for x in position)
        return a, b, c

    def _goes_on(self, body: Drawn) -> bool:
        """Whether its mass centre lies on a longer line of it."""
        here, centre = self.spot(body.origin), self.spot(body.centre)
        others = [self.spot(drawn.origin) for drawn in self.picture.bodies if drawn.parent == body.name]
        others += [place for _, place in self._tied_points(body)]
        return any(
            dist(here, other) > dist(here, centre) - 1e-6
            and dot(_direction(here, other), _direction(here, centre)) > 0.999
            for other in others
        )

    def _points(self) -> None:
        """Joints and mass centres, and what is held at the ground."""
        for place in self._grounded():
            lines = [x for x in self.marks if isinstance(x, Stroke) and x.ink is Ink.BODY and place in x.points]
            below = any(max(y for _, y in x.points) > place[1] + 0.1 for x in lines)
            self._held(place, -1.0 if below else 1.0)
        for body in self.picture.bodies:
            here, centre = self.spot(body.origin), self.spot(body.centre)
            turns = [x for x in body.joint.hinges if not x.slides]
            slides = any(x.slides for x in body.joint.hinges)
            if turns and not slides and body.parent is None and self.picture.frame == INERTIAL and self._has_line(body):
                self._pinned(body, here)
            if len(turns) == 1 and self._has_line(body) and not self._is_hidden(body):
                self.marks.append(Dot(f"joint of {body.name}", here, 0.06, open=True))
            if body.massive and not body.shapes and not (body.cart and body.name in self._carts):
                point = self.own[body.name].inertia is None
                self.marks.append(Dot(body.name, centre, 0.1 if point else 0.05))
                self.letters.avoid([centre], False)
                away = _direction(here, centre) if dist(here, centre) > 0.05 else (1.0, -0.6)
                self._mass(body, centre, away, 0.2)

    def _grounded(self) -> Iterator[Place]:
        """Points of the ground that a constraint or a load ties."""
        tied = [x for x in self.system.constraints if isinstance(x, Coincide | Distance)]
        for tie in [
            *tied,
            *(x for x in self.system.loads if isinstance(x, PointSpring | PointDamper | IsotropicDamper)),
        ]:
            for end in (tie.first, tie.second):
                place = self._numbers(end.position) if end.body == INERTIAL == self.picture.frame else None
                if place is not None:
                    yield self.on(place)

    @cached_property
    def _carts(self) -> set[str]:
        return {body.name for body, _ in self._sliding.values()}

    def _has_line(self, body: Drawn) -> bool:
        lines = {line.of for line in self.picture.lines if line.kind in (Stretch.BODY, Stretch.LINK)}
        return body.name in lines or any(
            child.parent == body.name and self._slides(child) for child in self.picture.bodies
        )

    def _slides(self, body: Drawn) -> bool:
        """Along a line that is drawn as a spring or a damper from the joint before."""
        tied = {*body.joint.sprung, *body.joint.damped} & {x for hinge in body.joint.hinges for x in hinge.coordinates}
        return bool(tied) and dist(self.spot(body.origin), self._before(body)) > 0.3

    def _before(self, body: Drawn) -> Place:
        return self.on((0.0, 0.0, 0.0)) if body.parent is None else self.spot(self.bodies[body.parent].origin)

    def _is_hidden(self, body: Drawn) -> bool:
        """Whether it only gives a hoop its turn."""
        return not body.massive and any(
            drawn.parent == body.name and name in drawn.joint.hinges[-1].coordinates
            for name, (drawn, _) in self._sliding.items()
            if self._is_angle(name)
        )

    def _is_angle(self, name: str) -> bool:
        return any(x.name == name and x.kind is Measure.ANGLE for x in self.picture.coordinates)

    def _mass(self, body: Drawn, place: Place, away: Place, near: float) -> None:
        mass = self.own[body.name].mass
        if self.few and len(names(mass)) == 1 and len(_letters_of(mass)) <= SHORT:
            self.letter(mass, place, away, near)

    def _pinned(self, body: Drawn, here: Place) -> None:
        """Ground at a joint: on the other side of what hangs or stands there."""
        if not self.picture.view.plane and not any(x.of is Acting.GRAVITY for x in self.picture.arrows):
            return  # nothing says that it is held, not free
        target = self._target(body)
        up = 1.0 if target is None or self.spot(target)[1] <= here[1] + 1e-6 else -1.0
        if self._is_hidden(body):
            return
        self._held(here, up)

    def _held(self, here: Place, up: float) -> None:
        """Ground above or below a point."""
        first, second = (here[0] - 0.35, here[1] + 0.06 * up), (here[0] + 0.35, here[1] + 0.06 * up)
        self.line("ground", (first, second), Ink.THIN)
        self._hatched("ground", first, second, (0.0, up))

    def _hatched(self, of: str, first: Place, second: Place, away: Place) -> None:
        """Short strokes on the far side of a line."""
        length = dist(first, second)
        along = _direction(first, second)
        count = max(3, ceil(length / 0.2))
        for k in range(count):
            s = length * (k + 0.75) / count
            foot = _moved(first, along, s)
            tip = _moved(_moved(foot, away, 0.11), along, -0.11)
            self.marks.append(Stroke(f"{of} hatched", (foot, tip), Ink.THIN))
        middle = _between(first, second)
        self.letters.avoid([first, second], False)
        self.letters.avoid([_moved(middle, away, 0.1)], False)

    def _dashpot(self, of: str, first: Place, second: Place) -> None:
        length, there = dist(first, second), partial(_moved, first, _direction(first, second))
        a, b, h = 0.4 * length, 0.62 * length, min(0.11, 0.2 * length)
        self.line(of, (first, there(a, 0.0)), Ink.SOLID)
        self.line(of, (there(b, h), there(a, h), there(a, -h), there(b, -h)), Ink.SOLID)
        self.line(of, (there((a + b) / 2, h * 0.75), there((a + b) / 2, -h * 0.75)), Ink.SOLID)
        self.line(of, (there((a + b) / 2, 0.0), second), Ink.SOLID)

    def _stiffness(self, name: str) -> Expression:
        return next(x.stiffness for x in self.system.loads if isinstance(x, CoordinateSpring) and x.coordinate == name)

    def _damping(self, name: str) -> Expression:
        return next(
            x.coefficient for x in self.system.loads if isinstance(x, CoordinateDamper) and x.coordinate == name
        )

    # --- angles ---

    def _target(self, body: Drawn) -> Operands | None:
        """What tells how a body is turned: its mass centre, else what is attached to it."""
        here = self.point(body.origin)
        near = 1e-6 * self.picture.extent
        if body.massive and dist(self.point(body.centre), here) > near:
            return body.centre
        for drawn in self.picture.bodies:
            if drawn.parent == body.name and dist(self.point(drawn.origin), here) > near:
                return drawn.origin
        return None

    def _angles(self) -> None:
        radius = 0.72
        for body in self.picture.bodies:
            target = self._target(body)
            turns = [x for x in body.joint.hinges if not x.slides and x.coordinates]
            if target is None or not turns or self._is_hidden(body) or self._shows_axes(body):
                continue
            drawn: set[str] = set()
            for k, hinge in enumerate(turns):
                name = hinge.coordinates[-1]
                later = {x for other in turns[k + 1 :] for x in other.coordinates} - {name}
                if name in drawn or name in later:
                    continue
                drawn.add(name)
                if self._arc(body, target, name, later, radius):
                    radius = 0.72 if radius > 1.0 else radius + 0.22
            for name in body.joint.sprung:
                if name in drawn:
                    self._spiral(body, name)

    def _arc(self, body: Drawn, target: Operands, name: str, later: Iterable[str], radius: float) -> bool:
        """The arc of an angle about a joint, the later ones of the joint at zero."""
        value = self.state[name]
        if abs(value) < 0.05 or abs(value) > 2 * pi:
            return False
        here, later = self.point(body.origin), tuple(later)
        arc = []
        for k in range(ARC):
            values = self.varied(name, value * k / (ARC - 1), zero=later)
            arm = combined((1.0, -1.0), (self.point(target, values), self.point(body.origin, values)))
            if not all(map(isfinite, arm)) or hypot(*arm) < 1e-9 * self.picture.extent:
                return False
            arc.append(combined((1.0, radius / self.unit), (here, unit(arm))))
        if (
            dist(arc[0], arc[-1]) < 0.05 * radius / self.unit
            and max(dist(x, arc[0]) for x in arc) < 0.1 * radius / self.unit
        ):
            return False  # it turns about its own line
        line = [self.on(x) for x in arc]
        centre = self.on(here)
        self.line(f"zero: {name}", (centre, _beyond(centre, line[0], 1.25)), Ink.HIDDEN)
        if later:
            self.line(f"side: {name}", (centre, _beyond(centre, line[-1], 1.25)), Ink.HIDDEN)
        self.line(f"angle {name}", line, Ink.THIN, arrow=True, smooth=True)
        middle = line[ARC // 2]
        self.letter(Name(name), middle, _direction(centre, middle))
        return True

    def _circled(self, guide: Guide, curve: Sequence[Numbers]) -> None:
        """The angle of a body on a circle, and its radius."""
        name, value = guide.coordinate, self.state[guide.coordinate]
        middle_of = combined([1 / (len(curve) - 1)] * (len(curve) - 1), curve[:-1])
        radii = [dist(x, middle_of) for x in curve]
        is_round = max(radii) - min(radii) <= 1e-6 * max(radii)
        if not is_round or not self._is_angle(name) or not 0.05 <= abs(value) <= 2 * pi:
            return
        body = self.bodies[guide.body]
        centre, bead = self.on(middle_of), self.spot(body.origin)
        steps = [self.varied(name, value * k / (ARC - 1)) for k in range(ARC)]
        places = [self.point(body.origin, step) for step in steps]
        radius = dist(places[0], middle_of)
        part = min(0.8, 0.55 * self.unit * radius) / (self.unit * radius)
        line = [self.on(combined((1 - part, part), (middle_of, place))) for place in places]
        self.line(f"zero: {name}", (centre, self.on(places[0])), Ink.HIDDEN)
        self.line(f"radius: {name}", (centre, bead), Ink.THIN)
        self.line(f"angle {name}", line, Ink.THIN, arrow=True, smooth=True)
        middle = line[ARC // 2]
        self.letter(Name(name), middle, _direction(centre, middle))
        own = self.own[guide.body]
        values = self.picture.values
        known = {x for expression in own.connection_point for x in names(expression)} & values.keys()
        for parameter in sorted(known):
            if abs(values[parameter] - radius) < 1e-9 * radius:
                side = _turned(_direction(centre, bead))
                sign = -1.0 if dot(side, (middle[0] - centre[0], middle[1] - centre[1])) > 0 else 1.0
                self.letter(Name(parameter), _beyond(centre, bead, 0.6), (sign * side[0], sign * side[1]))
                break

    def _spiral(self, body: Drawn, name: str) -> None:
        """A spring that turns with a joint."""
        here = self.spot(body.origin)
        turns = [(0.07 + 0.15 * k / 40, 2.5 * 2 * pi * k / 40) for k in range(41)]
        self.line(
            f"spring: {name}", [(here[0] + r * cos(a), here[1] + r * sin(a)) for r, a in turns], Ink.THIN, smooth=True
        )
        self.letter(self._stiffness(name), here, (-0.7, 0.7), 0.34)

    # --- forces and axes ---

    def _forces(self) -> None:
        for number, load in enumerate(self.system.loads):
            if not isinstance(load, PointForce) or load.point.body not in self.bodies:
                continue
            body = self.bodies[load.point.body]
            arrow = next((x for x in self.picture.arrows if x.load == number), None)
            along = (0.0, 0.0) if arrow is None else self.flat(self.point(arrow.along))
            if hypot(*along) < 1e-9:  # zero at these values: its direction is that of its only component
                vector = self._direction_of(load)
                along = (0.0, 0.0) if vector is None else self.flat(vector)
            if hypot(*along) < 1e-9:
                continue
            if arrow is not None:
                tip = self.spot(arrow.point)
            elif all(x == ZERO for x in load.point.position):
                tip = self.spot(body.origin)
            else:
                continue
            way = _unit(along)
            reach = 0.55 if body.cart else 0.12
            # Along a rod: towards the point, from outside.
            first, second = (-1.1, -0.14) if self._covered(tip, way) else (reach, reach + 0.9)
            ends = _moved(tip, way, first), _moved(tip, way, second)
            self.line(f"force {number + 1}", ends, Ink.SOLID, arrow=True)
            what = _length_of(load.components)
            if what is not None:
                self.letter(what, _between(*ends), _turned(way))

    def _covered(self, tip: Place, along: Place) -> bool:
        """Whether a rod runs from the point in this direction."""
        for mark in self.marks:
            if isinstance(mark, Stroke) and mark.ink is Ink.BODY and len(mark.points) == 2:
                for a, b in (mark.points, mark.points[::-1]):
                    if dist(a, tip) < 0.02 and dot(_direction(a, b), along) > 0.9:
                        return True
        return False

    def _direction_of(self, load: PointForce) -> Numbers | None:
        axes = AXES if load.axes == self.picture.frame else None
        if axes is None and load.axes in self.bodies:
            rows = [self.point(row) for row in self.bodies[load.axes].axes]
            axes = (rows[0], rows[1], rows[2])
        at_work = [k for k, x in enumerate(load.components) if x != ZERO]
        return axes[at_work[0]] if axes is not None and len(at_work) == 1 else None

    def _shows_axes(self, body: Drawn) -> bool:
        """Whether it turns by so many angles, or has so short a line, that its axes show it better than arcs."""
        turns = {x for hinge in body.joint.hinges if not hinge.slides for x in hinge.coordinates}
        if (
            self.picture.view.plane
            or not (body.massive or body.ellipsoid)
            or (len(turns) < 2 and not self.own[body.name].orientation)
        ):
            return False
        target = self._target(body)
        return len(turns) > 2 or target is None or dist(self.spot(target), self.spot(body.origin)) < 1.2

    def _body_axes(self) -> None:
        """The axes of what turns by several angles and has no line that would show it."""
        if self.picture.view.plane:
            return
        for body in self.picture.bodies:
            if not self._shows_axes(body):
                continue
            here = self.spot(body.origin)
            solid = [x for x in self.marks if isinstance(x, Stroke) and x.of == body.name and x.tinted]
            for k, row in enumerate(body.axes, start=1):
                along = self.flat(self.point(row))
                size = hypot(*along)
                if size < 0.15:
                    continue
                out = _unit(along)
                far = [dot((x - here[0], y - here[1]), out) for stroke in solid for x, y in stroke.points]
                far = [] if self._target(body) is not None and dist(here, self.spot(body.centre)) > 0.5 else far
                reach = max([0.9 * size + 0.2, *(0.8 * x + 0.3 for x in far)])
                tip = _moved(here, out, reach)
                self.line(f"axis {k} of {body.name}", (here, tip), Ink.THIN, arrow=True)
                self.letter(k, tip, along)

    def _driven(self) -> None:
        """Axes in the paper about which something is turned by an angle that is prescribed."""
        driven = {prescribed.name for prescribed in self.system.prescribed}
        for body in self.picture.bodies:
            turns = [x for x in body.joint.hinges if not x.slides]
            if not self.picture.view.plane or len(turns) != 1 or turns[0].coordinates:
                continue
            along = self.flat(self.point(turns[0].along))
            name = sorted({x for angle in self.own[body.name].rotation.angles for x in names(angle)} & driven)
            if len(name) != 1 or abs(hypot(*along) - 1) > 1e-6:
                continue
            here = self.spot(body.origin)
            reach = [dot((x - here[0], y - here[1]), along) for x, y in self.letters.lines]
            top, foot = (_moved(here, along, a) for a in (max(reach) + 0.75, min(reach) - 0.25))
            self.line(f"axis of {body.name}", (foot, top), Ink.HIDDEN)
            middle = _moved(top, along, -0.25)
            # Counter-clockwise seen from the top: in front it goes to the right.
            turn = [pi * (5 / 6 + 4 / 3 * k / (ARC - 1)) for k in range(ARC)]
            points = [_moved(middle, along, 0.1 * sin(a), -0.3 * cos(a)) for a in turn]
            self.line(f"turn: {name[0]}", points, Ink.THIN, arrow=True, smooth=True)
            self.letter(Name(name[0]), points[-1], (along[1], -along[0]))

    def _corner(self) -> None:
        """The directions of the axes of the frame, and of gravity, aside."""
        low, _ = self.letters.box()
        reach = 0.62
        downwards = 0.0
        arrows = []
        for k, axis in enumerate(AXES, start=1):
            along = self.flat(axis)
            if hypot(*along) > 0.1:
                arrows.append((k, along))
                downwards = min(downwards, along[1])
        left = min(0.0, min(x for _, (x, _) in arrows))
        right = max(0.0, max(x for _, (x, _) in arrows))
        corner = low[0] - 0.75 - reach * right, low[1] + 0.1 - reach * downwards
        for k, along in arrows:
            tip = _moved(corner, along, reach)
            self.line(f"axis {k}", (corner, tip), Ink.THIN, arrow=True)
            self.letter(k, tip, along, 0.14)
        gravity = next((x for x in self.system.loads if isinstance(x, UniformGravity)), None)
        if gravity is None:
            return
        up = self.flat(self.picture.view.up)
        if hypot(*up) < 0.3:
            return
        head = corner[0] + reach * left / 2, max(corner[1] + 2.0, low[1] + 2.0)
        tip = _moved(head, _unit(up), -0.7)
        self.line("gravity", (head, tip), Ink.SOLID, arrow=True)
        what = _length_of(gravity.acceleration)
        if what is not None:
            self.letter(what, _between(head, tip), (-1.0, 0.0))

    # --- finished ---

    def _finished(self) -> Sketch:
        placed = self.letters.placed()
        low, high = self.letters.box()
        names_of = [coordinate.name for coordinate in self.picture.coordinates]
        return Sketch(
            tuple(self.marks),
            tuple(Letter(what, place) for what, place in placed),
            low,
            high,
            tuple((name, self.state[name]) for name in names_of),
            self.picture.frame,
            tuple(name for name in self.unknown if name in self._geometry()),
            any(_shown(body) is not None for body in self.picture.bodies),
        )

    def _geometry(self) -> set[str]:
        """The parameters that places and shapes depend on."""
        parameters: set[str] = set()
        for body in self.system.bodies:
            shapes = (x for shape in body.shapes for x in (*shape.size, *shape.at, *shape.rotation.angles))
            for expression in (*body.connection_point, *body.mass_centre, *body.rotation.angles, *shapes):
                parameters |= names(expression)
        for relation in reversed(self.system.relations):
            parameters |= names(relation.value) if relation.name in parameters else set()
        return parameters


def _letters_of(what: Expression | int) -> str:
    """The characters that are seen of it, about."""
    words = str(what) if isinstance(what, int) else text(what).replace("*", "")
    return re.sub(r"[A-Za-z]\w*", lambda m: _seen(m[0]), words)


def _seen(name: str) -> str:
    name_parts = parts(name)
    return ("x" if name_parts.greek else name_parts.stem) + "".join(name_parts.indices)


def _length_of(vector: Sequence[Expression]) -> Expression | None:
    """The size of a vector with one component that has letters, short enough to be a letter itself."""
    there = [x for x in vector if x != ZERO]
    if len(there) != 1:
        return None
    (expression,) = there
    while isinstance(expression, Negative):
        expression = expression.operand
    if isinstance(expression, Number) or len(_letters_of(expression)) > SHORT:
        return None
    return expression


def _direction(first: Place, second: Place) -> Place:
    size = dist(first, second)
    return ((second[0] - first[0]) / size, (second[1] - first[1]) / size) if size else (1.0, 0.0)


def _unit(direction: Place) -> Place:
    return _direction((0.0, 0.0), direction)


def _moved(place: Place, along: Place, ahead: float, aside: float = 0.0) -> Place:
    """So far along a direction, and so far to its left."""
    return place[0] + ahead * along[0] - aside * along[1], place[1] + ahead * along[1] + aside * along[0]


def _turned(direction: Place) -> Place:
    """To the left."""
    return -direction[1], direction[0]


def _between(first: Place, second: Place) -> Place:
    return (first[0] + second[0]) / 2, (first[1] + second[1]) / 2


def _beyond(first: Place, second: Place, times: float) -> Place:
    return first[0] + times * (second[0] - first[0]), first[1] + times * (second[1] - first[1])


def _coil(first: Place, second: Place) -> list[Place]:
    """The zigzag of a spring."""
    along, length = _direction(first, second), dist(first, second)
    straight = min(0.2, 0.15 * length)
    turns = max(3, min(9, round((length - 2 * straight) / 0.22)))
    points = [first]
    for k in range(2 * turns + 1):
        a = straight + (length - 2 * straight) * k / (2 * turns)
        b = 0.0 if k in (0, 2 * turns) else (0.13 if k % 2 else -0.13)
        points.append(_moved(first, along, a, b))
    return [*points, second]
