"""What is drawn of a system, as frozen values: no pixels, no words but names of the description.

Numbers that depend on the state are **operands**: places in the values of one straight-line program
(``mbsym.picture.program``), in the description's unit of length and in the axes of ``Picture.frame``, from its origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import dist

from mbsym.picture.program import PoseProgram

Operands = tuple[int, int, int]
Numbers = tuple[float, float, float]
Rows = tuple[Numbers, Numbers, Numbers]


class Measure(Enum):
    """What a coordinate is: it decides how far its slider goes."""

    ANGLE = "angle"
    LENGTH = "length"
    OTHER = "other"


@dataclass(frozen=True)
class Coordinate:
    """``value`` and ``velocity`` at the start; a slider goes from ``minimum`` to ``maximum``.

    ``limited``: these are limits that the description gives; otherwise they are chosen for the slider and mean nothing.
    """

    name: str
    kind: Measure
    unit: str
    value: float
    velocity: float
    minimum: float
    maximum: float
    limited: bool = False


@dataclass(frozen=True)
class Outline:
    """A shape of the description: ``kind`` of ``model.system.SHAPES``, its sizes, its middle, its axes in rows.

    Middle and axes are in the axes of the body, from its connection point.
    """

    kind: str
    size: tuple[float, ...]
    at: Numbers
    axes: Rows


@dataclass(frozen=True)
class Ellipsoid:
    """The homogeneous ellipsoid that has the mass and the inertia of a body, about its mass centre.

    ``half_axes`` along the rows of ``axes`` (principal axes in the axes of the body).  ``true_size``: the ellipsoid has
    the body's own mass; otherwise only its proportions are the body's.  ``telling``: nothing else that is drawn tells
    the same: not that of a rod, which is a line already, nor in a plane, where one moment is all, that of what has one.
    """

    half_axes: Numbers
    axes: Rows
    true_size: bool
    telling: bool = True


@dataclass(frozen=True)
class Hinge:
    """An axis about which a joint turns (``slides`` False), or the direction in which a coordinate moves it.

    ``along``: operands; a unit vector for a turn.  ``coordinates`` move it; none: a constant or prescribed turn.
    ``straight``: the direction is the same at every position.
    """

    along: Operands
    coordinates: tuple[str, ...]
    slides: bool
    straight: bool = False


@dataclass(frozen=True)
class Joint:
    """At the origin of the body; ``sprung`` and ``damped`` are its coordinates on which a spring or damper acts."""

    hinges: tuple[Hinge, ...]
    sprung: tuple[str, ...] = ()
    damped: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drawn:
    """A body: rows ``axes`` are its axes, ``origin`` its connection point, ``centre`` its mass centre.

    ``parent`` is None where that is the frame of the picture; ``massive``: it has mass, so that its mass centre means
    something.  ``cart``: it has no look of its own and only slides, along a straight line in the frame.
    """

    name: str
    parent: str | None
    axes: tuple[Operands, Operands, Operands]
    origin: Operands
    centre: Operands
    joint: Joint
    massive: bool
    shapes: tuple[Outline, ...] = ()
    ellipsoid: Ellipsoid | None = None
    cart: bool = False


@dataclass(frozen=True)
class Guide:
    """The curve along which ``coordinate`` moves the origin of ``body``: a hoop.

    ``points`` are in the axes of the body's parent, from its origin.
    """

    body: str
    coordinate: str
    points: tuple[Numbers, ...]

    @property
    def closed(self) -> bool:
        """Whether it returns to where it began."""
        return dist(self.points[0], self.points[-1]) < 1e-6 * max(dist(self.points[0], x) for x in self.points)


@dataclass(frozen=True)
class Given:
    """The value of a parameter."""

    name: str
    value: float
    unit: str
    meaning: str


class Acting(Enum):
    """What an arrow is."""

    GRAVITY = "gravity"
    FORCE = "force"
    TORQUE = "torque"


@dataclass(frozen=True)
class Arrow:
    """A force at ``point``, or a torque on ``body``; ``load`` counts the loads of the description from 0."""

    load: int
    of: Acting
    body: str
    point: Operands
    along: Operands


class Stretch(Enum):
    """What a line is."""

    BODY = "body"  # from a joint to the mass centre, or to a point that is tied or pulled
    LINK = "link"  # from the joint of a body to a joint upon it that does not move in it
    SLIDE = "slide"  # to one that does
    SPRING = "spring"
    DAMPER = "damper"
    ROD = "rod"  # a distance that is kept


@dataclass(frozen=True)
class Line:
    """From point to point; ``of`` is the body, or "load 1", "constraint 2" (counted from 1)."""

    kind: Stretch
    start: Operands
    end: Operands
    of: str


@dataclass(frozen=True)
class Closure:
    """Constraints between positions: ``rows`` vanish where they hold; ``slopes`` are their derivatives, row by row.

    Columns belong to ``coordinates``, of ``sizes`` (how far the scene reaches, for a length; 1 for others); ``names``
    says which constraint a row is.  It counts as closed where it is below ``tolerance`` times the sum of |slope|
    (size + |coordinate|).
    """

    coordinates: tuple[str, ...]
    sizes: tuple[float, ...]
    rows: tuple[int, ...]
    slopes: tuple[tuple[int, ...], ...]
    names: tuple[str, ...]
    tolerance: float = 1e-9


@dataclass(frozen=True)
class View:
    """Away from gravity, or else upwards on the paper; where the eye is first, in degrees; ``plane``: all is in one."""

    up: Numbers
    azimuth: float
    elevation: float
    plane: bool


@dataclass(frozen=True)
class Notes:
    """What is to be told of a picture.

    ``stand_ins``: numbers that nobody gave, taken to draw at all.  ``at_zero``: coordinates whose start is not given.
    ``moved``: values of the start that were led to the constraints, with those given; ``open_loop``: why that failed.
    ``hidden``: bodies that the frame does not carry.  ``without_arrow``: loads that act on coordinates or as a whole,
    by their numbers from 0.  ``velocity_rows``: so many constraints are between velocities, which no position breaks.
    """

    stand_ins: tuple[tuple[str, float], ...] = ()
    at_zero: tuple[str, ...] = ()
    moved: tuple[tuple[str, float, float], ...] = ()
    open_loop: str = ""
    hidden: tuple[str, ...] = ()
    without_arrow: tuple[int, ...] = ()
    velocity_rows: int = 0


@dataclass(frozen=True)
class Picture:
    """A system in three dimensions; ``frame`` is the body in whose axes it is seen, "0" for the inertial one.

    ``extent``: the radius of a ball about ``middle`` in which everything is for all angles at the lengths of the start.
    """

    name: str
    frame: str
    coordinates: tuple[Coordinate, ...]
    parameters: tuple[Given, ...]
    program: PoseProgram
    bodies: tuple[Drawn, ...]
    arrows: tuple[Arrow, ...]
    lines: tuple[Line, ...]
    guides: tuple[Guide, ...]
    closure: Closure | None
    view: View
    middle: Numbers
    extent: float
    notes: Notes
    units: tuple[tuple[str, str], ...] = ()

    @property
    def values(self) -> dict[str, float]:
        """The parameters by name."""
        return {parameter.name: parameter.value for parameter in self.parameters}
