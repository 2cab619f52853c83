"""Quantities between a description and its formulas that have a name in mechanics, and a scene that forms them.

A long formula is told through them: direction cosines, components of angular velocities, velocities and accelerations,
composite bodies, forces and moments.  ``NamedScene`` works body by body with whole direction cosine matrices, so that
their entries occur in what follows; turn by turn they never would.  What it forms is noted with its meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from mbsym.algebra.base import Scalar, Vector
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.mechanics.frames import axis_vector, direction_cosines, forward
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.model.system import INERTIAL, Body, System

Matrix = tuple[Vector, Vector, Vector]


class Quantity(StrEnum):
    """What a named intermediate is; vectors and tensors are in the axes of the body they belong to."""

    DIRECTION_COSINE = "direction cosine"
    ANGULAR_VELOCITY = "angular velocity"
    RELATIVE_ANGULAR_VELOCITY = "angular velocity relative to the predecessor"
    CARRIED_VELOCITY = "velocity of the connection point in the axes of the predecessor"
    VELOCITY_ORIGIN = "velocity of the connection point"
    VELOCITY_CENTRE = "velocity of the mass centre"
    ANGULAR_ACCELERATION = "angular acceleration at q'' = 0"
    CARRIED_ACCELERATION = "acceleration of the connection point in the axes of the predecessor at q'' = 0"
    ACCELERATION = "acceleration of the connection point at q'' = 0, less gravity"
    OUTWARD = "unit vector from the attracting centre"
    RADIUS = "radius vector from the attracting centre"
    PLACE = "radius vector from the expansion point of a field"
    ALONG = "projection of the radius vector on the unit vector"
    SPAN = "vector between the ends of a load"
    MASS = "composite mass"
    FIRST_MOMENT = "composite first moment"
    INERTIA = "composite inertia"
    UNIT_FORCE = "force that a unit acceleration takes"
    UNIT_MOMENT = "moment that a unit acceleration takes"
    FORCE = "force at q'' = 0"
    MOMENT = "moment at q'' = 0"
    COMMON = "common factor"


@dataclass(frozen=True, slots=True)
class Meaning:
    """``place``: the component (1 to 3), or row and column; ``coordinate`` of a unit acceleration.

    ``load``: the number of the load it belongs to, from 1; 0 for none.
    """

    quantity: Quantity
    body: str = ""
    place: tuple[int, ...] = ()
    coordinate: str = ""
    load: int = 0


class Notes:
    """What the nodes of a program mean: the first meaning of a node is kept."""

    def __init__(self) -> None:
        self.meanings: dict[int, Meaning] = {}

    def scalar(self, node: Node, meaning: Meaning) -> Node:
        self.meanings.setdefault(node.number, meaning)
        return node

    def vector(self, v: Vector, quantity: Quantity, body: str, coordinate: str = "", load: int = 0) -> Vector:
        for i, x in enumerate(v, 1):
            self.scalar(x, Meaning(quantity, body, (i,), coordinate, load))
        return v

    def symmetric(self, rows: Matrix, quantity: Quantity, body: str) -> Matrix:
        for i in range(3):
            for j in range(i, 3):
                self.scalar(rows[i][j], Meaning(quantity, body, (i + 1, j + 1)))
        return rows

    def matrix(self, rows: Matrix, quantity: Quantity, body: str) -> Matrix:
        for i in range(3):
            for j in range(3):
                self.scalar(rows[i][j], Meaning(quantity, body, (i + 1, j + 1)))
        return rows


def transposed(rows: Matrix) -> Matrix:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a, d, g), (b, e, h), (c, f, i)


class NamedScene(Scene):
    """A scene over a straight-line program that notes what its nodes mean.

    ``rotations``: R^jk of every body; ``joint_rates``: for every turn its axis in the body's own axes times its rate,
    and times its second rate.
    """

    def __init__(
        self,
        system: System,
        program: Program,
        environment: Mapping[str, Scalar],
        ring: Ring,
        notes: Notes,
        falling: frozenset[str] = frozenset(),
    ) -> None:
        self.notes = notes
        self.program = program
        self.rotations: dict[str, Matrix] = {}
        self.axes: dict[str, tuple[Vector, ...]] = {}
        super().__init__(system, program, environment, ring, falling=falling)

    def _motion(self, body: Body) -> BodyMotion:
        algebra, lower, notes = self.algebra, self.lower, self.notes
        name = body.name
        turns = tuple(self._turns(body))
        rotation = direction_cosines(algebra, turns)
        self.rotations[name] = notes.matrix(rotation, Quantity.DIRECTION_COSINE, name)
        # The axes of the turns in the body's own axes: what comes after a turn carries them on.
        self.axes[name] = tuple(
            forward(algebra, turns[place + 1 :], axis_vector(algebra, turn.axis, algebra.one))
            for place, turn in enumerate(turns)
        )
        relative = algebra.zero_vector
        for turn, axis in zip(turns, self.axes[name], strict=True):
            relative = algebra.add(relative, algebra.scale(turn.rate, axis))
        notes.vector(relative, Quantity.RELATIVE_ANGULAR_VELOCITY, name)
        parent_spin, parent_velocity = algebra.zero_vector, algebra.zero_vector
        if body.attached_to != INERTIAL:
            parent = self.motions[body.attached_to]
            parent_spin, parent_velocity = parent.angular_velocity, parent.velocity_origin
        spin = algebra.add(algebra.apply(rotation, parent_spin), relative)
        notes.vector(spin, Quantity.ANGULAR_VELOCITY, name)
        offset = lower.vector(body.connection_point)
        relative_velocity = lower.vector([self.rate(x) for x in body.connection_point])
        carried = algebra.add(algebra.add(parent_velocity, algebra.cross(parent_spin, offset)), relative_velocity)
        if body.attached_to != INERTIAL:  # of the base it is as the description says
            notes.vector(carried, Quantity.CARRIED_VELOCITY, name)
        velocity = algebra.apply(rotation, carried)
        if name in self.falling:
            velocity = algebra.zero_vector
        notes.vector(velocity, Quantity.VELOCITY_ORIGIN, name)
        centre = lower.vector(body.mass_centre)
        tensor = None
        if body.inertia is not None:
            rows = body.inertia.tensor
            tensor = (lower.vector(rows[0]), lower.vector(rows[1]), lower.vector(rows[2]))
        at_centre = algebra.add(velocity, algebra.cross(spin, centre))
        return BodyMotion(
            body=body,
            turns=turns,
            offset=offset,
            relative_angular_velocity=relative,
            angular_velocity=spin,
            velocity_origin=velocity,
            velocity_mass_centre=notes.vector(at_centre, Quantity.VELOCITY_CENTRE, name),
            mass=lower(body.mass),
            mass_centre=centre,
            inertia=tensor,
            gyrostatic_moment=None if body.gyrostatic_moment is None else lower.vector(body.gyrostatic_moment),
        )

    def out(self, body: str, v: Vector) -> Vector:
        """From the predecessor's axes to the body's."""
        return self.algebra.apply(self.rotations[body], v)

    def back(self, body: str, v: Vector) -> Vector:
        """From the body's axes to the predecessor's."""
        return self.algebra.apply(transposed(self.rotations[body]), v)

    def to_axes(self, v: Vector, source: str, target: str) -> Vector:
        up, down = self.system.path(source), self.system.path(target)
        common = sum(a == b for a, b in zip(up, down, strict=False))
        for name in reversed(up[common:]):
            v = self.back(name, v)
        for name in down[common:]:
            v = self.out(name, v)
        return v

    def position(self, body: str, point: Vector, frame: str) -> Vector:
        while body != frame:
            motion = self.motions[body]
            point = self.algebra.add(motion.offset, self.back(body, point))
            body = motion.body.attached_to
        return point
