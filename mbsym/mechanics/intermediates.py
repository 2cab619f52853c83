"""Quantities between a description and its formulas that have a name in mechanics, and a scene that forms them.

A long formula is told through them: direction cosines, components of angular velocities, velocities and accelerations,
composite bodies, forces and moments.  ``NamedScene`` works body by body with whole direction cosine matrices, so that
their entries occur in what follows; turn by turn they never would.  What it forms is noted with its meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.algebra.vectors import Tensor, Vector, axis_vector
from mbsym.mechanics.frames import direction_cosines, forward
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.model.system import INERTIAL, Body, System


class Quantity(Enum):
    """What a named intermediate is; vectors and tensors are in the axes of the body they belong to.

    ``stem``: the letter that it would like to be called; the body's number and the component follow as indices.
    ``words``: how its definitions are introduced.  There ``[[b]]`` is the body, ``[[p]]`` its predecessor, ``[[it]]``
    the body with what it carries, ``[[o]]`` the expansion point, ``[[l]]`` the number of a load, ``[[common]]`` the
    body that carries both of its ends.
    """

    DIRECTION_COSINE = "a", "Direction cosines of [[b]] relative to [[p]], by row and column"
    ANGULAR_VELOCITY = "omega", "Angular velocity of [[b]]"
    RELATIVE_ANGULAR_VELOCITY = "Omega", "Angular velocity of [[b]] relative to [[p]]"
    CARRIED_VELOCITY = "v", "Velocity of the connection point of [[b]], in the axes of [[p]]"
    VELOCITY_ORIGIN = "V", "Velocity of the connection point of [[b]]"
    VELOCITY_CENTRE = "VC", "Velocity of the mass centre of [[b]]"
    ANGULAR_ACCELERATION = "epsilon", "Angular acceleration of [[b]]"
    CARRIED_ACCELERATION = "y", "Acceleration of the connection point of [[b]], in the axes of [[p]]"
    ACCELERATION = "w", "Acceleration of the connection point of [[b]]"
    OUTWARD = "e", "Unit vector from the attracting centre to the connection point of [[o]], in the axes of [[b]]"
    RADIUS = "rho", "Radius vector from the attracting centre to the mass centre of [[b]]"
    PLACE = "c", "Radius vector from the connection point of [[o]] to the mass centre of [[b]]"
    ALONG = "p", "Projection of that radius vector on that unit vector, for [[b]]"
    SPAN = "s", "Vector between the ends of load [[l]] (the first index), in the axes of [[common]]"
    MASS = "mu", "Mass of [[it]]"
    FIRST_MOMENT = "S", "Mass times radius vector of the mass centre, of [[it]]"
    INERTIA = "J", "Inertia tensor of [[it]] about the connection point"
    UNIT_FORCE = "u", "Force at the connection point of [[b]] required by a unit acceleration of"
    UNIT_MOMENT = "n", "Moment about the connection point of [[b]] required by a unit acceleration of"
    FORCE = "F", "Force that [[it]] needs beyond the loads"
    MOMENT = "H", "Moment about the connection point that [[it]] needs beyond the loads"
    COMMON = "z", ""

    def __init__(self, stem: str, words: str) -> None:
        self.stem, self.words = stem, words


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

    def vector(
        self, v: Vector[Node], quantity: Quantity, body: str, coordinate: str = "", load: int = 0
    ) -> Vector[Node]:
        for i, x in enumerate(v, 1):
            self.scalar(x, Meaning(quantity, body, (i,), coordinate, load))
        return v

    def symmetric(self, rows: Tensor[Node], quantity: Quantity, body: str) -> Tensor[Node]:
        for i in range(3):
            for j in range(i, 3):
                self.scalar(rows[i][j], Meaning(quantity, body, (i + 1, j + 1)))
        return rows

    def matrix(self, rows: Tensor[Node], quantity: Quantity, body: str) -> Tensor[Node]:
        for i in range(3):
            for j in range(3):
                self.scalar(rows[i][j], Meaning(quantity, body, (i + 1, j + 1)))
        return rows


class NamedScene(Scene[Node]):
    """A scene over a straight-line program that notes what its nodes mean.

    ``rotations``: R^jk of every body; ``joint_rates``: for every turn its axis in the body's own axes times its rate,
    and times its second rate.
    """

    def __init__(
        self,
        system: System,
        program: Program,
        environment: Mapping[str, Node],
        ring: Ring,
        notes: Notes,
        falling: frozenset[str] = frozenset(),
    ) -> None:
        self.notes = notes
        self.program = program
        self.rotations: dict[str, Tensor[Node]] = {}
        self.axes: dict[str, tuple[Vector[Node], ...]] = {}
        super().__init__(system, program, environment, ring, falling=falling)

    def _motion(self, body: Body) -> BodyMotion[Node]:
        algebra, lower, notes = self.algebra, self.lower, self.notes
        name, before = body.name, body.attached_to
        turns = tuple(self._turns(body))
        rotation = direction_cosines(algebra, turns, before, name)
        self.rotations[name] = notes.matrix(rotation, Quantity.DIRECTION_COSINE, name)
        # The axes of the turns in the body's own axes: what comes after a turn carries them on.
        self.axes[name] = tuple(
            forward(turns[place + 1 :], axis_vector(algebra, turn.axis, algebra.one, turn.frame), name)
            for place, turn in enumerate(turns)
        )
        relative = self.zero(name)
        for turn, axis in zip(turns, self.axes[name], strict=True):
            relative = relative + axis * turn.rate
        notes.vector(relative, Quantity.RELATIVE_ANGULAR_VELOCITY, name)
        parent_spin = parent_velocity = self.zero(before)
        if before != INERTIAL:
            parent_spin, parent_velocity = self.motions[before].angular_velocity, self.motions[before].velocity_origin
        spin = rotation @ parent_spin + relative
        notes.vector(spin, Quantity.ANGULAR_VELOCITY, name)
        offset = self.vector(body.connection_point, before)
        relative_velocity = self.vector([self.rate(x) for x in body.connection_point], before)
        carried = parent_velocity + parent_spin.cross(offset) + relative_velocity
        if before != INERTIAL:  # of the base it is as the description says
            notes.vector(carried, Quantity.CARRIED_VELOCITY, name)
        velocity = rotation @ carried
        if name in self.falling:
            velocity = self.zero(name)
        notes.vector(velocity, Quantity.VELOCITY_ORIGIN, name)
        centre = self.vector(body.mass_centre, name)
        inertia = self._inertia(body)
        at_centre = velocity + spin.cross(centre)
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
            inertia=inertia,
            gyrostatic_moment=self._gyrostatic_moment(body),
        )

    def out(self, body: str, v: Vector[Node]) -> Vector[Node]:
        return self.rotations[body] @ v

    def back(self, body: str, v: Vector[Node]) -> Vector[Node]:
        return self.rotations[body].T @ v
