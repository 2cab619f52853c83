"""Loads as arrows, springs, dampers and rods as lines; all of them operands of the picture's program.

An arrow is the force that a load exerts on a body (``mechanics.loads``: the wrenches of the equations of motion), or a
torque that is given; what acts on coordinates, or as a whole, has none.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.mechanics.loads.kinds import KINDS
from mbsym.model.constraints import Coincide, Distance
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
from mbsym.model.system import INERTIAL, Point
from mbsym.picture.placing import Places, Triple
from mbsym.picture.values import Acting, Stretch


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
    found: list[Pull] = []
    without = []
    for number, load in enumerate(places.scene.system.loads):
        try:
            own = list(_pulls(places, number, load))
        except Failure:  # no formula for it at these numbers
            own = []
        found += own
        if not own and not isinstance(load, PointSpring | PointDamper | IsotropicDamper):
            without.append(number)
    return found, without


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
    for one in points:
        arm = places.scene.vector(one.position, one.body)
        if one.body in places.carried and one.body != INERTIAL and not arm.vanishes():
            end: tuple[Node, Node, Node] = places.point(one.body, arm.components)
            yield Span(Stretch.BODY, places.origins[one.body], end, one.body)
