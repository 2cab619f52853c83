"""Velocities that are variables of their own, and orientations that need no angles, as a body declares them.

A *speed* u is a linear form in generalised velocities, with coefficients that depend on coordinates and the time,

    u = S(q, t) q' + s0(q, t),      so that      q' = Y(q, t) u + y0(q, t).

The components of the angular velocity of a body, in its own axes, may stand in such a form; they are no generalised
velocities where the body turns about more than one axis (quasi-velocities).  A *unit vector* is an axis of the frame
that a body hangs on, seen from the body: Poisson's variables, gamma' = gamma x omega.  A *quaternion* e of norm 1 tells
the whole orientation by four numbers: e' = 1/2 e o omega.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression, Name, names

#: The components 1, 2, 3 of an angular velocity in the form of a speed: names that nothing else can have.
OMEGA = ("omega[1]", "omega[2]", "omega[3]")

QUATERNION = "quaternion"


@dataclass(frozen=True, slots=True)
class Speed:
    """``name`` = ``form``, where ``OMEGA`` are the components of the absolute angular velocity of ``body``."""

    name: str
    form: Expression
    body: str
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def component(self) -> int | None:
        """1, 2 or 3 for a speed that is that component alone."""
        match self.form:
            case Name(name) if name in OMEGA:
                return OMEGA.index(name) + 1
        return None

    @property
    def turns(self) -> bool:
        """Whether an angular velocity stands in it."""
        return bool(names(self.form) & set(OMEGA))


@dataclass(frozen=True, slots=True)
class UnitVector:
    """Axis number ``axis`` of the frame that a body hangs on, in the axes of the body: name1, name2, name3.

    ``asked``: the description wants it; others tell the orientation besides.
    """

    name: str
    axis: int
    span: Span | None = field(default=None, compare=False, repr=False)
    asked: bool = field(default=True, compare=False, repr=False)

    @property
    def word(self) -> str:
        """How a description says what it is."""
        return str(self.axis)

    @property
    def components(self) -> tuple[str, str, str]:
        return (f"{self.name}1", f"{self.name}2", f"{self.name}3")


@dataclass(frozen=True, slots=True)
class Quaternion:
    """The orientation of a body against the frame that it hangs on: name0 (the scalar part), name1, name2, name3.

    (cos(phi/2), n sin(phi/2)): the axes of the body are those of the frame turned by phi about n.
    """

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def word(self) -> str:
        """How a description says what it is."""
        return QUATERNION

    @property
    def components(self) -> tuple[str, str, str, str]:
        return (f"{self.name}0", f"{self.name}1", f"{self.name}2", f"{self.name}3")
