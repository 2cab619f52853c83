"""Constraints between bodies or coordinates, as frozen dataclasses of parsed expressions.

=============  =====================================================================  ==========  ================
``Coincide``   two points are one: r_1 - r_2 = 0                                      holonomic   3 rows
``Parallel``   two axes are parallel: n . e_2 = 0 for two n normal to e_1             holonomic   2 rows
``Distance``   (|r_1 - r_2|^2 - L^2)/2 = 0                                            holonomic   1 row
``Relation``   f(q, t) = 0                                                            holonomic   1 row
``Rolling``    the material points of two bodies at a contact have one velocity       velocities  3 rows
``Velocity``   a(q, t) . q' + b(q, t) = 0                                             velocities  1 row
=============  =====================================================================  ==========  ================

Rows that are zero whatever the motion (a planar mechanism has some) count for nothing.  Points and axes are given in
the axes of their bodies; body "0" is the inertial frame.  ``mbsym.mechanics.constraints`` makes the rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from mbsym.expressions.message import Message, joined
from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression
from mbsym.model.system import Point, Vector, _span


@dataclass(frozen=True, slots=True)
class Axis:
    """A direction that is fixed in a body, in the axes of that body, of any length but zero."""

    body: str
    direction: Vector


@dataclass(frozen=True, slots=True)
class Coincide:
    """A point of one body is a point of another: the parts of a joint that was cut."""

    first: Point
    second: Point
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Parallel:
    """An axis of one body is parallel to an axis of another (or points against it)."""

    first: Axis
    second: Axis
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Distance:
    """Two points keep a distance, which may hold prescribed quantities and t."""

    first: Point
    second: Point
    length: Expression
    span: Span | None = _span()


@dataclass(frozen=True, slots=True)
class Relation:
    """f(q, t) = 0; ``left`` = ``right`` as it was written, but for unit vectors, which stand in ``in_vectors``."""

    left: Expression
    right: Expression
    span: Span | None = _span()
    in_vectors: tuple[Expression, ...] | None = None


@dataclass(frozen=True, slots=True)
class Rolling:
    """``body`` rolls on ``on`` without slipping.

    ``contact`` is the radius vector from the origin of the body to the contact, in the axes of ``axes``: a point moves
    in a body that rolls, and may be any expression in coordinates.  The material points of both bodies that are there
    have the same velocity.  Where the contact is given in unit vectors it stands in ``in_vectors`` as it was written,
    and ``contact`` has the angles that these replace.
    """

    body: str
    contact: Vector
    axes: str
    on: str
    span: Span | None = _span()
    in_vectors: tuple[Expression, ...] | None = None


@dataclass(frozen=True, slots=True)
class Velocity:
    """A relation that is linear in the velocities; ``left`` = ``right`` as it was written, or ``in_vectors``.

    It stands there where it holds speeds or unit vectors, and has coordinates and velocities in place of these.
    """

    left: Expression
    right: Expression
    span: Span | None = _span()
    in_vectors: tuple[Expression, ...] | None = None


Constraint = Coincide | Parallel | Distance | Relation | Rolling | Velocity

#: What a kind is called in descriptions and reports.
KIND_NAMES: dict[type[Constraint], str] = {
    Coincide: "coincide",
    Parallel: "parallel",
    Distance: "distance",
    Relation: "relation",
    Rolling: "rolling",
    Velocity: "velocity",
}


def as_written(constraint: Constraint) -> Constraint:
    """The constraint with unit vectors where the description has them."""
    match constraint:
        case Relation(in_vectors=(left, right)) | Velocity(in_vectors=(left, right)):
            return replace(constraint, left=left, right=right, in_vectors=None)
        case Rolling(in_vectors=(x, y, z)):
            return replace(constraint, contact=(x, y, z), in_vectors=None)
    return constraint


def kind_name(constraint: Constraint) -> str:
    """``coincide``, ``rolling``, ...: the key of a constraint in a description."""
    return KIND_NAMES[type(constraint)]


def listed(constraints: tuple[Constraint, ...]) -> Message:
    """``coincide 1, rolling 2``: each constraint by its kind and its number in the description."""
    named = ((Message(kind_name(constraint)), number) for number, constraint in enumerate(constraints, start=1))
    return joined((Message("[[kind]] [[number]]", kind=kind, number=number) for kind, number in named), ", ")


def is_holonomic(constraint: Constraint) -> bool:
    """Whether it is given as f(q, t) = 0; one that is given by velocities may still be integrable."""
    return not isinstance(constraint, Rolling | Velocity)
