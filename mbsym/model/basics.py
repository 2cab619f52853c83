"""What the parts of a description are made of: vectors, points, numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from mbsym.expressions.angles import linear_form
from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression

Vector = tuple[Expression, Expression, Expression]

#: The name of the inertial frame.
INERTIAL = "0"


def _span() -> Span | None:
    return field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a body, in the axes of that body; body "0" is the inertial frame."""

    body: str
    position: Vector


def rational(value: Expression | None) -> Fraction | None:
    """The exact number that an expression without names is made of, or None."""
    form = None if value is None else linear_form(value)
    return form.constant if form is not None and form.is_constant else None
