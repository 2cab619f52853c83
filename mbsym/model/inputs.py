"""Inputs of a system, known functions of time that are not chosen yet, and its outputs."""

from __future__ import annotations

from dataclasses import dataclass, field

from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression


@dataclass(frozen=True, slots=True)
class Input:
    """A name in forces and torques whose value is chosen later: the torque of a motor, a wind.

    ``held`` is its constant value on the unperturbed motion, an expression in parameters; what problems 4 to 6 say
    holds for the input at this value.
    """

    name: str
    meaning: str = ""
    held: Expression = ZERO
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Output:
    """What is measured: y = value(q, q', u), for the matrices C and D of the first-order form."""

    name: str
    value: Expression
    span: Span | None = field(default=None, compare=False, repr=False)
