"""The picture of a system: its places as one straight-line program, and what stands where.

picture(system)    the frame is the inertial one, or one that it carries without a coordinate's doing (an orbit):
                   the outermost in which the system looks at most COMPACT times as large as in the best one
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import dist, hypot, isfinite, pi
from typing import Any, NamedTuple

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.expressions import tree
from mbsym.expressions.tree import Expression, differentiate, names
from mbsym.mechanics.frames import Turn
from mbsym.mechanics.given_matrices import refuse_matrices
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import angles_of, ring_of
from mbsym.model.constraints import Coincide, Distance, is_holonomic
from mbsym.model.loads import (
    CoordinateDamper,
    CoordinateSpring,
    IsotropicDamper,
    Load,
    NewtonianGravity,
    PointDamper,
    PointForce,
    PointSpring,
    Torque,
    UniformGravity,
)
from mbsym.model.quantities import length_unit, time_unit, unit_of
from mbsym.model.system import INERTIAL, Body, Point, System
from mbsym.numerics.carriers import COMPACT, frames
from mbsym.numerics.scenario import Incomplete, Scenario, bound, exact, initial_values, own_values, scenario
from mbsym.picture.looking import Room, State, at, combined, dot, ellipsoid, first_look, samples, shapes
from mbsym.picture.program import PoseProgram, Varied, flattened
from mbsym.picture.values import (
    Acting,
    Arrow,
    Closure,
    Coordinate,
    Drawn,
    Ellipsoid,
    Given,
    Guide,
    Hinge,
    Joint,
    Line,
    Measure,
    Notes,
    Numbers,
    Operands,
    Picture,
    Stretch,
)

# The numbers a picture begins with: those of a run, and stand-ins where nobody gave any.
#
# A simulation refuses to make numbers up.  A description that is being written is drawn nevertheless, at stand-ins that
# are told: 1 for a parameter (-1 where its sign is negative), 0 for a coordinate.  Assumptions may then be broken: the
# picture proves nothing.


NEGATIVE = ("negative", "nonpositive")


@dataclass(frozen=True)
class Start:
    """``scenario`` at the start; ``stand_ins`` by name; ``at_zero``; ``moved`` (name, given, found); ``open_loop``."""

    scenario: Scenario
    stand_ins: tuple[tuple[str, float], ...] = ()
    at_zero: tuple[str, ...] = ()
    moved: tuple[tuple[str, float, float], ...] = ()
    open_loop: str = ""


def start(system: System, overrides: Mapping[str, Expression] | None = None) -> Start:
    """The start of a system.

    Raises Incomplete with what cannot be (two numbers for one parameter), Failure for a system given by its matrices.
    """
    refuse_matrices(system, "there are no bodies to draw")
    expressions = dict(overrides or {})
    found, stand_ins, at_zero = _numbers(system, expressions)
    if not found.system.constraints:
        return Start(found, stand_ins, at_zero)
    from mbsym.numerics.closing import closed

    try:
        there = closed(found)
    except Failure as reason:
        return Start(found, stand_ins, at_zero, (), str(reason))
    coordinates = system.coordinates
    moves = tuple((x.name, x.given, x.found) for x in there.moves if x.name in coordinates)
    return Start(there.scenario, stand_ins, at_zero, moves)


def _numbers(
    system: System, expressions: dict[str, Expression]
) -> tuple[Scenario, tuple[tuple[str, float], ...], tuple[str, ...]]:
    try:
        return scenario(system, expressions, declared=True), (), ()
    except Incomplete as error:
        if not error.lack.names:
            raise
        missing = {*error.lack.names} & {*system.parameter_names}
    chosen: dict[str, Expression] = {}
    while missing:
        # What follows from others is left to do so; only where nothing else is left is it stood in for as well.
        related = {item.name for item in system.relations}
        own = [x for x in system.parameters if x.name in missing and x.value is None and x.name not in related]
        for item in own or [x for x in system.parameters if x.name in missing]:
            chosen[item.name] = tree.number(-1 if item.sign in NEGATIVE else 1)
        missing = _lacking(system, expressions | chosen)
    if chosen:  # numbers that mean nothing need not agree with signs
        system = replace(system, parameters=tuple(replace(item, sign="real") for item in system.parameters))
    stand_ins = tuple((name, -1.0 if item == tree.number(-1) else 1.0) for name, item in chosen.items())
    try:
        return scenario(system, expressions | chosen, assumed=not chosen, declared=True), stand_ins, ()
    except Incomplete as error:
        if not error.lack.names:
            raise
    begun = {} if own_values(system, expressions) else initial_values(system, expressions)
    at_zero = tuple(x for x in system.coordinates if x not in begun or begun[x].position is None)
    return scenario(system, expressions | chosen, state=False, assumed=not chosen), stand_ins, at_zero


def _lacking(system: System, expressions: Mapping[str, Expression]) -> set[str]:
    """The parameters that have no value yet."""
    try:
        scenario(system, expressions, state=False, assumed=False)
    except Incomplete as error:
        return {*error.lack.names} & {*system.parameter_names} - {*expressions}
    return set()


Triple = tuple[Node, Node, Node]
Axes = tuple[Triple, Triple, Triple]


class Places:
    """Axes and origins of all bodies that ``frame`` carries, in its axes; ``carried`` are their names."""

    def __init__(self, scene: Scene[Node], frame: str) -> None:
        self.scene, self.frame = scene, frame
        program = scene.algebra
        assert isinstance(program, Program)
        self.program = program
        node, zero = program.one, program.zero
        self.axes: dict[str, Axes] = {frame: ((node, zero, zero), (zero, node, zero), (zero, zero, node))}
        self.origins: dict[str, Triple] = {frame: (zero, zero, zero)}
        #: The directions of the turns of each body's joint, in their order.
        self.turned: dict[str, list[Triple]] = {}
        for body in scene.system.bodies:
            if body.attached_to in self.axes and body.name != frame:
                self._place(body)

    @property
    def carried(self) -> list[str]:
        return [name for name in self.axes if name not in (INERTIAL, self.frame)]

    def _place(self, body: Body) -> None:
        motion = self.scene.motions[body.name]
        self.origins[body.name] = self.point(body.attached_to, motion.offset.components)
        axes = self.axes[body.attached_to]
        directions = []
        for turn in motion.turns:
            axes = self._turned(axes, turn)
            if turn.axis:
                directions.append(axes[turn.axis - 1])
        self.axes[body.name], self.turned[body.name] = axes, directions

    def _turned(self, axes: Axes, turn: Turn[Node]) -> Axes:
        """The rows after a turn: c u + s v and c v - s u of the two that it moves."""
        program = self.program
        if turn.matrix is not None:
            first, second, third = (self._combined(axes, row) for row in turn.matrix.rows)
            return first, second, third
        i, j = turn.axis % 3, (turn.axis + 1) % 3
        u, v, s, c = axes[i], axes[j], turn.sine, turn.cosine
        rows = list(axes)
        rows[i] = _triple([program.dot((c, s), (x, y)) for x, y in zip(u, v, strict=True)])
        rows[j] = _triple([program.dot((c, -s), (y, x)) for x, y in zip(u, v, strict=True)])
        return rows[0], rows[1], rows[2]

    def _combined(self, axes: Axes, components: Sequence[Node]) -> Triple:
        columns = ((axes[0][k], axes[1][k], axes[2][k]) for k in range(3))
        return _triple([self.program.dot(tuple(components), column) for column in columns])

    def direction(self, body: str, components: Sequence[Node]) -> Triple:
        """A vector given in a body's axes, in those of the frame."""
        return self._combined(self.axes[body], components)

    def point(self, body: str, components: Sequence[Node]) -> Triple:
        """A point given from a body's origin in its axes, from the frame's origin in those of the frame."""
        arm = self.direction(body, components)
        return _triple([a + b for a, b in zip(self.origins[body], arm, strict=True)])

    def given(self, body: str, components: Sequence[Expression]) -> Triple:
        """The same of expressions of the description."""
        return self.point(body, self.scene.lower.vector(components))

    def centre(self, body: str) -> Triple:
        """The mass centre."""
        return self.point(body, self.scene.motions[body].mass_centre.components)

    def slides(self, body: Body) -> list[tuple[str, Triple]]:
        """(coordinate, direction): how the connection point moves in the body before, for every coordinate it holds."""
        directions = []
        held = set().union(*map(names, body.connection_point))
        for name in (x for x in self.scene.system.coordinates if x in held):
            slope = self.scene.lower.vector([differentiate(x, name) for x in body.connection_point])
            directions.append((name, self.direction(body.attached_to, slope)))
        return directions


def _triple(values: Sequence[Node]) -> Triple:
    return values[0], values[1], values[2]


#: So many positions of a loop are looked for.
LOOPS = 8

#: Pieces of a guide.
PIECES = 24

#: What is thinner than this, as a part of its length, is a rod.
ROD = 0.05


def picture(system: System, overrides: Mapping[str, Expression] | None = None) -> Picture:
    """The picture at the start of a description, some of its values replaced.

    Raises Incomplete where values contradict each other, Failure where there is nothing to draw (a system given by its
    matrices), or a place is singular at these numbers.
    """
    return picture_at(start(system, overrides))


def picture_at(found: Start, frame: str | None = None) -> Picture:
    """The picture at a start; in a ``frame``, or the one that suits."""
    scenario = found.scenario
    system = scenario.system
    program = bound(scenario)
    scene = scene_without_accelerations(system, ring_of(system), program)
    known = coordinates(scenario)
    named = [frame] if frame is not None else frames(system)
    made = [_Made(scene, scenario, name, known) for name in named]
    least = min((x.room.reach for x in made), default=0.0)
    chosen = next(x for x in made if x.room.reach <= COMPACT * least)
    return chosen.picture(found)


class _Made:
    """Nodes of everything in one frame, the program of them, and how much room they take."""

    def __init__(self, scene: Any, scenario: Scenario, frame: str, known: Sequence[Coordinate]) -> None:
        self.scene, self.scenario, self.known = scene, scenario, known
        self.system: System = scenario.system
        self.places = Places(scene, frame)
        self.centres = {name: self.places.centre(name) for name in self.places.carried}
        self.pulls, self.without = pulls(self.places)
        self.spans = list(spans(self.places))
        self.rows, self.slopes, self.labels = rows(scene) if self.system.constraints else ([], [], [])
        self.up = self._upward()
        order = ("t", *self.system.coordinates, *self.system.velocities)
        self.program, self._value = flattened(scene.algebra, list(self._nodes()), order)
        self.room = self._room()

    def _upward(self) -> Triple | None:
        for load in self.system.loads:
            upward = KINDS[type(load)].upward
            up = None if upward is None else upward(load, self.scene, self.places.frame)
            if up is not None:
                return up.components
        return None

    def _nodes(self) -> Iterable[Node]:
        places = self.places
        for name in places.carried:
            body = self.system.body(name)
            for triple in (*places.axes[name], places.origins[name], self.centres[name], *places.turned[name]):
                yield from triple
            for _, triple in places.slides(body):
                yield from triple
        for pull in self.pulls:
            yield from (*pull.point, *pull.along)
        for span in self.spans:
            yield from (*span.start, *span.end)
        yield from self.rows
        for row in self.slopes:
            yield from row
        yield from self.up or ()

    def at(self, triple: Triple) -> Operands:
        """Where the program has these nodes."""
        a, b, c = (self._value[node.number] for node in triple)
        return a, b, c

    def _room(self) -> Room:
        places = self.places
        points = [self.at(x) for name in places.carried for x in (places.origins[name], self.centres[name])]
        axes = [self.at(row) for name in places.carried for row in places.axes[name]]
        up = None if self.up is None else self.at(self.up)
        anywhere = [self.program.at(state) for state in samples(self.known, self.scenario, 1.0)]
        look = first_look(anywhere, points, axes, up)
        points += [self.at(end) for span in self.spans for end in (span.start, span.end)]
        reach = [0.0] * len(points)
        for name in places.carried:
            body = self.system.body(name)
            own = self._ellipsoid(body, look.plane)
            size = 0.0 if own is None or not own.true_size or not own.telling else max(own.half_axes)
            for shape in shapes(body, self.scenario.parameters):
                size = max(size, hypot(*shape.at) + hypot(*shape.size))
            points += [self.at(places.origins[name]), self.at(self.centres[name])]
            reach += [size if body.shapes else 0.0, size]
        states = samples(self.known, self.scenario)
        values = [self.program.at(state) for state in (self._closed(states) if self.rows else states)]
        return Room.of(values, points, reach, look)

    def _ellipsoid(self, body: Body, plane: bool) -> Ellipsoid | None:
        """See ``Ellipsoid``: the one of a body, and whether it tells something."""
        solid = ellipsoid(body, self.scenario.parameters)
        if solid is None:
            return None
        half = sorted(solid.half_axes)
        lined = plane and any(span.of == body.name for span in self.spans)
        return replace(solid, telling=half[1] >= ROD * half[2] and not lined)

    def _guides(self) -> Iterator[Guide]:
        """What a body slides along while one coordinate alone moves it, where that is a curve."""
        start = samples(self.known, self.scenario)[0]
        values = self.program.at(start)
        for body in (self.system.body(name) for name in self.places.carried):
            slides = self.places.slides(body)
            if len(slides) != 1:
                continue
            ((name, _),) = slides
            known = next(coordinate for coordinate in self.known if coordinate.name == name)
            angle = known.kind is Measure.ANGLE
            far, middle = (pi, 0.0) if angle else (0.6 * self.room.radius, known.value)
            steps = (middle + far * (2 * k / PIECES - 1) for k in range(PIECES + 1))
            points = tuple(
                self._from_parent(body, Varied(self.program, values, {name: value}), values) for value in steps
            )
            if all(isfinite(x) for point in points for x in point) and _curved(points):
                yield Guide(body.name, name, points)

    def _from_parent(self, body: Body, moved: Sequence[float], values: Sequence[float]) -> Numbers:
        """The connection point in the axes of the body before."""
        here = at(moved, self.at(self.places.origins[body.name]))
        before = at(values, self.at(self.places.origins[body.attached_to]))
        arm = combined((1.0, -1.0), (here, before))
        x, y, z = (dot(arm, at(values, self.at(row))) for row in self.places.axes[body.attached_to])
        return x, y, z

    def _closed(self, states: Sequence[State]) -> list[State]:
        """Those of the positions near which the loops are closed, the start first."""
        closure = self._closure()
        closed_states = [states[0]]
        for state in states[1 : LOOPS + 1]:
            there, good = closed(self.program, closure, state, ())
            closed_states += [there] if good else []
        return closed_states

    def _closure(self) -> Closure:
        slopes = tuple(tuple(self._value[x.number] for x in row) for row in self.slopes)
        rows = tuple(self._value[x.number] for x in self.rows)
        points = [self.at(x) for name in self.places.carried for x in (self.places.origins[name], self.centres[name])]
        values = self.program.at(samples(self.known, self.scenario)[0])
        far = max((hypot(*at(values, x)) for x in points), default=0.0) or 1.0
        sizes = tuple(far if x.kind is Measure.LENGTH else 1.0 for x in self.known)
        return Closure(self.system.coordinates, sizes, rows, slopes, tuple(self.labels))

    def picture(self, found: Start) -> Picture:
        """All of it as values."""
        system, places, values = self.system, self.places, self.scenario.parameters
        velocity = sum(not is_holonomic(constraint) for constraint in system.constraints)
        hidden = tuple(x.name for x in system.bodies if x.name not in places.carried and x.name != places.frame)
        notes = Notes(
            found.stand_ins, found.at_zero, found.moved, found.open_loop, hidden, tuple(self.without), velocity
        )
        units = {"length": length_unit(system), "time": time_unit(system)}
        return Picture(
            name=system.name,
            frame=places.frame,
            coordinates=tuple(self._wide(x) for x in self.known),
            parameters=tuple(
                Given(x.name, float(values[x.name]), unit_of(system, x.name) or "", x.meaning)
                for x in system.parameters
                if x.name in values
            ),
            program=self.program,
            bodies=tuple(self._drawn(name) for name in places.carried),
            arrows=tuple(Arrow(x.load, x.of, x.body, self.at(x.point), self.at(x.along)) for x in self.pulls),
            lines=tuple(Line(x.kind, self.at(x.start), self.at(x.end), x.of) for x in self.spans),
            guides=tuple(self._guides()),
            closure=self._closure() if self.rows else None,
            view=self.room.view,
            middle=self.room.middle,
            extent=self.room.radius,
            notes=notes,
            units=tuple((name, unit) for name, unit in units.items() if unit),
        )

    def _wide(self, coordinate: Coordinate) -> Coordinate:
        """Lengths may be moved about as far as the system is large."""
        if coordinate.limited or coordinate.kind.value != "length":
            return coordinate
        far = max(self.room.radius, abs(coordinate.value))
        return replace(coordinate, minimum=coordinate.value - far, maximum=coordinate.value + far)

    def _drawn(self, name: str) -> Drawn:
        body, places, values = self.system.body(name), self.places, self.scenario.parameters
        motion = self.scene.motions[name]
        hinges = [
            Hinge(self.at(along), self._moved_by(turn.angle), False)
            for along, turn in zip(places.turned[name], (x for x in motion.turns if x.axis), strict=True)
        ]
        slides = places.slides(body)
        straight = [_straight(self.system, body, name) for name, _ in slides]
        hinges += [
            Hinge(self.at(along), (coordinate,), True, same)
            for (coordinate, along), same in zip(slides, straight, strict=True)
        ]
        sprung, damped = held(places, body.coordinates)
        first, second, third = places.axes[name]
        outlines = shapes(body, values)
        massive = not self.scene.algebra.vanishes(motion.mass)
        only_slides = straight == [True] and not motion.turns and motion.mass_centre.vanishes()
        # Where the line itself moves in time there is no track that could stand.
        known = {*self.system.parameter_names, *self.system.coordinates}
        on_frame = body.attached_to == places.frame and all(names(x) <= known for x in body.connection_point)
        return Drawn(
            name=name,
            parent=body.attached_to if body.attached_to in places.carried else None,
            axes=(self.at(first), self.at(second), self.at(third)),
            origin=self.at(places.origins[name]),
            centre=self.at(self.centres[name]),
            joint=Joint(tuple(hinges), sprung, damped),
            massive=massive,
            shapes=outlines,
            ellipsoid=None if outlines else self._ellipsoid(body, self.room.view.plane),
            cart=massive and only_slides and on_frame and not outlines,
        )

    def _moved_by(self, angle: Expression) -> tuple[str, ...]:
        occurring = names(angle)
        return tuple(x for x in self.system.coordinates if x in occurring)


def _straight(system: System, body: Body, name: str) -> bool:
    """Whether a coordinate moves the connection point along one line of the body before."""
    slopes = [differentiate(x, name) for x in body.connection_point]
    return not any(names(x) & {*system.coordinates} for x in slopes)


def _curved(points: Sequence[Numbers]) -> bool:
    """Whether they do not lie on one line."""
    far = max(points, key=lambda x: dist(x, points[0]))
    chord = combined((1.0, -1.0), (far, points[0]))
    size = hypot(*chord)
    arms = (combined((1.0, -1.0), (x, points[0])) for x in points)
    return size > 0 and any(hypot(*combined((1.0, -dot(x, chord) / size**2), (x, chord))) > 1e-9 * size for x in arms)


def coordinates(scenario: Scenario) -> tuple[Coordinate, ...]:
    """In the order of the system.  An angle goes half a turn either way of its start, a length as far as it is long."""
    system = scenario.system
    limits = {item.coordinate: item for item in system.limits}
    entries = []
    for name, position, velocity in zip(system.coordinates, scenario.positions, scenario.velocities, strict=True):
        kind, value = measure(system, name), float(position)
        far = pi if kind is Measure.ANGLE else max(1.0, abs(value))
        low, high, limited = value - far, value + far, False
        if name in limits:
            try:
                bounds = [float(exact(x, scenario.parameters)) for x in (limits[name].lower, limits[name].upper)]
            except (Failure, KeyError):
                bounds = []
            if bounds and bounds[0] < bounds[1]:
                low, high, limited = min(bounds[0], value), max(bounds[1], value), True
        unit = unit_of(system, name) or ""
        entries.append(Coordinate(name, kind, unit, value, float(velocity), low, high, limited))
    return tuple(entries)


def measure(system: System, name: str) -> Measure:
    """An angle stands under a sine or turns a body; a length moves a connection point and is none."""
    if any(name in names(angle) for angle in angles_of(system)):
        return Measure.ANGLE
    moving = (x for body in system.bodies for x in body.connection_point)
    return Measure.LENGTH if any(name in names(x) for x in moving) else Measure.OTHER


# Constraints between positions as operands, so that whoever moves one coordinate can lead the others back.
#
#     f(q, t) = 0,     df/dq
#
# A step that keeps the moved coordinate is the shortest solution of J dq = -f (Newton's method on rows that may be
# dependent); ``closed`` takes such steps, a page does the same in its own language.


#: Newton's steps at most.
STEPS = 60

#: No coordinate moves further in one of them, as a part of its size and where it is.
LONGEST = 0.5

#: Singular values below this part of the largest count as zero.
RANK = 1e-9


def rows(scene: Scene[Node]) -> tuple[list[Node], list[list[Node]], list[str]]:
    """f, its derivatives by the coordinates, and the names of the rows; rows that are zero at sight left out."""
    from mbsym.mechanics.constraints.rows import constraint_rows  # most systems have none

    equations: list[tuple[str, Node]] = [
        (row.name.label, row.position)
        for row in constraint_rows(scene)
        if row.position is not None and not scene.algebra.vanishes(row.position)
    ]
    if not equations:
        return [], [], []
    values = [position for _, position in equations]
    program = values[0].program
    slopes = jacobian(program, values, [program.input(name) for name in scene.system.coordinates])
    return values, [list(row) for row in slopes], [label for label, _ in equations]


def gaps(program: PoseProgram, closure: Closure, state: Mapping[str, float]) -> list[float]:
    """|f| of every row as a part of what the coordinates do to it: closed where it is below the tolerance."""
    values = program.at(state)
    sizes = [size + abs(float(state[name])) for name, size in zip(closure.coordinates, closure.sizes, strict=True)]
    residuals = []
    for row, slopes in zip(closure.rows, closure.slopes, strict=True):
        scale = sum(abs(float(values[k])) * size for k, size in zip(slopes, sizes, strict=True))
        residuals.append(abs(float(values[row])) / scale if scale > 0 else abs(float(values[row])))
    return residuals


def closed(
    program: PoseProgram, closure: Closure, state: Mapping[str, float], held: Sequence[str]
) -> tuple[dict[str, float], bool]:
    """The state led to the constraints with the coordinates ``held``, and whether it keeps them then."""
    import numpy as np

    there = dict(state)
    free = [k for k, name in enumerate(closure.coordinates) if name not in held]
    for _ in range(STEPS):
        if max(gaps(program, closure, there)) < 1e-3 * closure.tolerance:
            break
        values = program.at(there)
        f = np.array([float(values[k]) for k in closure.rows])
        slopes = np.array([[float(values[row[k]]) for k in free] for row in closure.slopes])
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(slopes))) or not free:
            break
        step = np.linalg.lstsq(slopes, -f, rcond=RANK)[0]
        sizes = np.array([closure.sizes[k] + abs(there[closure.coordinates[k]]) for k in free])
        step *= min(1.0, LONGEST / max(float(np.max(np.abs(step) / sizes)), 1e-300))
        for k, change in zip(free, step, strict=True):
            there[closure.coordinates[k]] += float(change)
    residuals = gaps(program, closure, there)
    return there, bool(max(residuals, default=0.0) < closure.tolerance)


# Loads as arrows, springs, dampers and rods as lines; all of them operands of the picture's program.
#
# An arrow is the force that a load exerts on a body (``mechanics.loads``: the wrenches of the equations of motion),
# or a torque that is given; what acts on coordinates, or as a whole, has none.


class Pull(NamedTuple):
    """An arrow of nodes."""

    load: int
    of: Acting
    body: str
    point: Triple
    along: Triple


class Span(NamedTuple):
    """A line of nodes."""

    kind: Stretch
    start: Triple
    end: Triple
    of: str


def pulls(places: Places) -> tuple[list[Pull], list[int]]:
    """The arrows, and the loads that have none though they act on something."""
    arrows: list[Pull] = []
    without = []
    for number, load in enumerate(places.scene.system.loads):
        try:
            own = list(_pulls(places, number, load))
        except Failure:  # no formula for it at these numbers
            own = []
        arrows += own
        if not own and not isinstance(load, PointSpring | PointDamper | IsotropicDamper):
            without.append(number)
    return arrows, without


def _pulls(places: Places, number: int, load: Load) -> Iterator[Pull]:
    scene, program = places.scene, places.program
    match load:
        case UniformGravity() | NewtonianGravity():
            forces: dict[str, Triple] = {}
            for wrench in KINDS[type(load)].action(load, scene).wrenches:
                if wrench.body in places.carried and not program.vanishes(scene.motions[wrench.body].mass):
                    own = places.direction(wrench.body, wrench.force.components)
                    before = forces.get(wrench.body, (program.zero,) * 3)
                    forces[wrench.body] = (before[0] + own[0], before[1] + own[1], before[2] + own[2])
            for body, force in forces.items():
                if not all(map(program.vanishes, force)):
                    yield Pull(number, Acting.GRAVITY, body, places.centre(body), force)
        case PointForce(point, components, axes) if point.body in places.axes and axes in places.axes:
            force = places.direction(axes, scene.lower.vector(components))
            yield Pull(number, Acting.FORCE, point.body, places.given(point.body, point.position), force)
        case Torque(body, components, axes, reaction_on) if axes in places.axes:
            torque = places.direction(axes, scene.lower.vector(components))
            opposite = (-torque[0], -torque[1], -torque[2])
            for name, along in ((body, torque), (reaction_on, opposite)):
                if name in places.carried:
                    yield Pull(number, Acting.TORQUE, name, places.centre(name), along)


def held(places: Places, coordinates: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Those on which a spring acts, and those on which a damper does."""
    loads = places.scene.system.loads
    sprung = {x.coordinate for x in loads if isinstance(x, CoordinateSpring)}
    damped = {x.coordinate for x in loads if isinstance(x, CoordinateDamper)}
    return tuple(x for x in coordinates if x in sprung), tuple(x for x in coordinates if x in damped)


def spans(places: Places) -> Iterator[Span]:
    """Lines within bodies, from body to body, and of what acts or is kept between two points."""
    scene, system, program = places.scene, places.scene.system, places.program
    for name in places.carried:
        body, motion = system.body(name), scene.motions[name]
        if not program.vanishes(motion.mass) and not motion.mass_centre.vanishes():
            yield Span(Stretch.BODY, places.origins[name], places.centre(name), name)
        before = body.attached_to
        slides = {x for x, _ in places.slides(body)}
        tied = bool(slides & {x for load in system.loads if not load.given for x in load.coordinates})
        if not motion.offset.vanishes() and (before in places.carried or tied or not slides):
            kind, of = (Stretch.SLIDE, name) if slides else (Stretch.LINK, before)
            yield Span(kind, places.origins[before], places.origins[name], of)
    for number, load in enumerate(system.loads, 1):
        if isinstance(load, PointSpring | PointDamper | IsotropicDamper):
            kind = Stretch.SPRING if isinstance(load, PointSpring) else Stretch.DAMPER
            yield from _between(places, kind, load.first, load.second, f"load {number}")
    for number, constraint in enumerate(system.constraints, 1):
        if isinstance(constraint, Distance):
            yield from _between(places, Stretch.ROD, constraint.first, constraint.second, f"constraint {number}")
        elif isinstance(constraint, Coincide):
            yield from _arms(places, (constraint.first, constraint.second))


def _between(places: Places, kind: Stretch, first: Point, second: Point, of: str) -> Iterator[Span]:
    if first.body in places.axes and second.body in places.axes:
        ends = [places.given(end.body, end.position) for end in (first, second)]
        yield Span(kind, ends[0], ends[1], of)
        yield from _arms(places, (first, second))


def _arms(places: Places, points: tuple[Point, ...]) -> Iterator[Span]:
    """From the joint of a body to a point of it; nothing is drawn of frames."""
    for point in points:
        arm = places.scene.vector(point.position, point.body)
        if point.body in places.carried and point.body != INERTIAL and not arm.vanishes():
            end: tuple[Node, Node, Node] = places.point(point.body, arm.components)
            yield Span(Stretch.BODY, places.origins[point.body], end, point.body)
