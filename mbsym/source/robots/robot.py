"""What both formats describe: a tree of links, each placed on its parent, moved by joints, with inertia and shapes.

Numbers are texts as they are printed.  Turns are passive and in the order of turning, as in descriptions.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mbsym.expressions.place import Span
from mbsym.source.robots.numbers import NOWHERE, Texts

#: (axis, angle) of the turns that lead from one set of axes to another.
Turns = tuple[tuple[int, str], ...]

#: The link on which the first one stands.
GROUND = "0"


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, mass centre in axes of the link, turns to its own axes, and the tensor there (xx, xy, xz, yy, yz, zz)."""

    mass: str
    centre: Texts = NOWHERE
    turned: Turns = ()
    tensor: tuple[str, str, str, str, str, str] = ("0",) * 6


@dataclass(frozen=True, slots=True)
class Joint:
    """A movement of a link.  ``kind`` is turn, slide, ball or free; ``axis`` and ``anchor`` are in axes of the link.

    ``limits`` are the least and greatest value; ``damping`` and ``stiffness`` act on the joint's coordinate, the
    latter about ``rest``.  ``armature`` is the inertia of a rotor, which adds armature q'^2/2 to the kinetic energy.
    A joint is ``driven`` where something can exert a torque or a force in it, of ``effort`` at most ("": not said).
    Its coordinate is ``ref`` where it is at zero.  One that is ``led`` has no coordinate: it stands at
    multiplier * q + offset, with q that of the joint of this name.
    """

    name: str
    kind: str
    axis: Texts = ("0", "0", "1")
    anchor: Texts = NOWHERE
    limits: tuple[str, str] | None = None
    damping: str = "0"
    stiffness: str = "0"
    rest: str = "0"
    armature: str = "0"
    driven: bool = False
    effort: str = ""
    led: tuple[str, str, str] | None = None
    ref: str = "0"


@dataclass(frozen=True, slots=True)
class Shape:
    """What a link looks like: ``kind`` box, sphere, cylinder, capsule or ellipsoid, its sizes, place and turns.

    Sizes: the three edges of a box; a radius; radius and length along the third axis; three half axes.
    """

    kind: str
    size: tuple[str, ...]
    place: Texts = NOWHERE
    turned: Turns = ()


@dataclass(frozen=True, slots=True)
class Link:
    """``place`` and ``turned`` lead from the axes of ``parent`` to this link's where all its joints are at zero."""

    name: str
    parent: str
    place: Texts = NOWHERE
    turned: Turns = ()
    joints: tuple[Joint, ...] = ()
    inertials: tuple[Inertial, ...] = ()
    shapes: tuple[Shape, ...] = ()
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class JointTie:
    """y - y_ref = sum of coefficients[k] (x - x_ref)^k between two joints; of one alone where second is ""."""

    first: str
    second: str
    coefficients: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PointTie:
    """A point of one link is a point of another; both in the axes of their links."""

    first: str
    first_point: Texts
    second: str
    second_point: Texts


@dataclass(frozen=True, slots=True)
class Robot:
    """Links, each after its parent, and ``ties`` between them; ``left_out`` says in words what is no part of it.

    ``snapped`` are the printed angles that were read as parts of pi: ``1.5708 as pi/2``.
    """

    name: str
    links: tuple[Link, ...]
    gravity: Texts = ("0", "0", "-9.81")
    left_out: tuple[str, ...] = ()
    snapped: tuple[str, ...] = ()
    ties: tuple[JointTie | PointTie, ...] = ()
