"""The picture of a system: its places as one straight-line program, and what stands where.

picture(system)    the frame is the inertial one, or one that it carries without a coordinate's doing (an orbit):
                   the outermost in which the system looks at most COMPACT times as large as in the best one
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import hypot, pi
from typing import Any

from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.expressions.tree import Expression, names
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import angles_of, program_environment, ring_of
from mbsym.model.constraints import is_holonomic
from mbsym.model.quantities import length_unit, time_unit, unit_of
from mbsym.model.system import System
from mbsym.numerics.carriers import COMPACT, frames
from mbsym.numerics.scenario import Scenario, exact
from mbsym.numerics.specialise import bound
from mbsym.picture import acting, loops
from mbsym.picture.looks import ellipsoid, shapes
from mbsym.picture.placing import Places, Triple
from mbsym.picture.program import flattened
from mbsym.picture.room import Room, State, first_look, samples
from mbsym.picture.start import Start, start
from mbsym.picture.values import (
    Arrow,
    Closure,
    Coordinate,
    Drawn,
    Hinge,
    Joint,
    Line,
    Measure,
    Notes,
    Operands,
    Picture,
)

#: So many positions of a loop are looked for.
LOOPS = 8


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
    scene = scene_without_accelerations(system, ring_of(system), program, program_environment(system, program))
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
        self.pulls, self.without = acting.pulls(self.places)
        self.spans = list(acting.spans(self.places))
        self.rows, self.slopes, self.labels = loops.rows(scene) if self.system.constraints else ([], [], [])
        self.up = self._upward()
        order = ("t", *self.system.coordinates, *self.system.velocities)
        self.program, self._value = flattened(scene.algebra, list(self._nodes()), order)
        self.room = self._room()

    def _upward(self) -> Triple | None:
        for load in self.system.loads:
            found = KINDS[type(load)].upward
            up = None if found is None else found(load, self.scene, self.places.frame)
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
        points += [self.at(end) for span in self.spans for end in (span.start, span.end)]
        reach = [0.0] * len(points)
        for name in places.carried:
            body = self.system.body(name)
            own = ellipsoid(body, self.scenario.parameters)
            size = 0.0 if own is None or not own.true_size else max(own.half_axes)
            for shape in shapes(body, self.scenario.parameters):
                size = max(size, hypot(*shape.at) + hypot(*shape.size))
            points += [self.at(places.origins[name]), self.at(self.centres[name])]
            reach += [size if body.shapes else 0.0, size]
        axes = [self.at(row) for name in places.carried for row in places.axes[name]]
        up = None if self.up is None else self.at(self.up)
        anywhere = [self.program.at(state) for state in samples(self.known, self.scenario, 1.0)]
        states = samples(self.known, self.scenario)
        values = [self.program.at(state) for state in (self._closed(states) if self.rows else states)]
        return Room.of(values, points, reach, first_look(anywhere, points[: 2 * len(places.carried)], axes, up))

    def _closed(self, states: Sequence[State]) -> list[State]:
        """Those of the positions near which the loops are closed, the start first."""
        closure = self._closure()
        found = [states[0]]
        for state in states[1 : LOOPS + 1]:
            there, good = loops.closed(self.program, closure, state, ())
            found += [there] if good else []
        return found

    def _closure(self) -> Closure:
        slopes = tuple(tuple(self._value[x.number] for x in row) for row in self.slopes)
        rows = tuple(self._value[x.number] for x in self.rows)
        return Closure(self.system.coordinates, rows, slopes, tuple(self.labels))

    def picture(self, found: Start) -> Picture:
        """All of it as values."""
        system, places, values = self.system, self.places, self.scenario.parameters
        velocity = sum(not is_holonomic(one) for one in system.constraints)
        hidden = tuple(x.name for x in system.bodies if x.name not in places.carried and x.name != places.frame)
        notes = Notes(
            found.stand_ins, found.at_zero, found.moved, found.open_loop, hidden, tuple(self.without), velocity
        )
        units = {"length": length_unit(system), "time": time_unit(system)}
        return Picture(
            name=system.name,
            frame=places.frame,
            coordinates=tuple(self._wide(x) for x in self.known),
            parameters=tuple((name, float(value)) for name, value in values.items()),
            program=self.program,
            bodies=tuple(self._drawn(name) for name in places.carried),
            arrows=tuple(Arrow(x.load, x.of, x.body, self.at(x.point), self.at(x.along)) for x in self.pulls),
            lines=tuple(Line(x.kind, self.at(x.start), self.at(x.end), x.of) for x in self.spans),
            closure=self._closure() if self.rows else None,
            view=self.room.view,
            middle=self.room.middle,
            extent=self.room.radius,
            notes=notes,
            units=tuple((name, unit) for name, unit in units.items() if unit),
        )

    def _wide(self, one: Coordinate) -> Coordinate:
        """Lengths may be moved about as far as the system is large."""
        if one.limited or one.kind.value != "length":
            return one
        far = max(self.room.radius, abs(one.value))
        return replace(one, minimum=one.value - far, maximum=one.value + far)

    def _drawn(self, name: str) -> Drawn:
        body, places, values = self.system.body(name), self.places, self.scenario.parameters
        motion = self.scene.motions[name]
        hinges = [
            Hinge(self.at(along), self._moved_by(turn.angle), False)
            for along, turn in zip(places.turned[name], (x for x in motion.turns if x.axis), strict=True)
        ]
        hinges += [Hinge(self.at(along), (coordinate,), True) for coordinate, along in places.slides(body)]
        sprung, damped = acting.held(places, body.coordinates)
        first, second, third = places.axes[name]
        outlines = shapes(body, values)
        return Drawn(
            name=name,
            parent=body.attached_to if body.attached_to in places.carried else None,
            axes=(self.at(first), self.at(second), self.at(third)),
            origin=self.at(places.origins[name]),
            centre=self.at(self.centres[name]),
            joint=Joint(tuple(hinges), sprung, damped),
            massive=not self.scene.algebra.vanishes(motion.mass),
            shapes=outlines,
            ellipsoid=None if outlines else ellipsoid(body, values),
        )

    def _moved_by(self, angle: Expression) -> tuple[str, ...]:
        found = names(angle)
        return tuple(x for x in self.system.coordinates if x in found)


def coordinates(scenario: Scenario) -> tuple[Coordinate, ...]:
    """In the order of the system.  An angle goes half a turn either way of its start, a length as far as it is long."""
    system = scenario.system
    limits = {item.coordinate: item for item in system.limits}
    found = []
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
        found.append(Coordinate(name, kind, unit, value, float(velocity), low, high, limited))
    return tuple(found)


def measure(system: System, name: str) -> Measure:
    """An angle stands under a sine or turns a body; a length moves a connection point and is none."""
    if any(name in names(angle) for angle in angles_of(system)):
        return Measure.ANGLE
    moving = (x for body in system.bodies for x in body.connection_point)
    return Measure.LENGTH if any(name in names(x) for x in moving) else Measure.OTHER
