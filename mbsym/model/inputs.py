"""Inputs of a system, known functions of time that are not chosen yet, and its outputs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression

if TYPE_CHECKING:
    from mbsym.model.system import System


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


def force_names(system: System) -> tuple[str, ...]:
    """Names for generalised forces that the system has not, in the order of its coordinates."""
    taken = {*system.coordinates, *system.velocities, *system.parameter_names, *system.input_names, *system.variables}
    taken |= {item.name for item in system.prescribed}
    stem = "tau"
    while any(f"{stem}_{name}" in taken for name in system.coordinates):
        stem += "u"
    return tuple(f"{stem}_{name}" for name in system.coordinates)
