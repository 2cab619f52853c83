"""Surfaces g(t, q, q') = 0 in a system's states, as code: what events and sections are about.

    a = b              g = a - b
    a = b mod p        g = sin(pi (a - b)/p),    o = cos(pi (a - b)/p)

The sign of o turns the direction of every other zero.

    dg/dt = g_t + g_q . q' + g_q' . q''           along the motion

A condition may hold t, coordinates, velocities, parameters, prescribed quantities, and ``QUANTITIES``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import gradient
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.expressions.condition import BOTH, FALLING, RISING, Condition
from mbsym.expressions.tree import Call, Expression, Operation, names, walk
from mbsym.mechanics.variables import expressions
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code

#: What a condition may name besides the system's own: T - U, T2 - T0 - U, T.
QUANTITIES = ("energy", "generalized_energy", "kinetic_energy")


class Direction(Enum):
    """Which passages count."""

    RISING = RISING
    FALLING = FALLING
    BOTH = BOTH


class Action(Enum):
    """What happens when it happens."""

    RECORD = "record"
    STOP = "stop"


@dataclass(frozen=True)
class Event:
    """``code`` is (t, q, q') -> (g, o); it happens where g o^(+-1) passes zero in the ``direction``.

    ``side`` is -1 where it stands for g < 0, 1 for g > 0, 0 for g = 0; ``closed``: for g = 0, too; ``text`` is what was
    written.
    """

    name: str
    code: Code
    direction: Direction = Direction.BOTH
    action: Action = Action.RECORD
    text: str = ""
    side: int = 0
    closed: bool = False


def known_names(system: System) -> tuple[str, ...]:
    """The names that a condition may hold."""
    own = ("t", *system.coordinates, *system.velocities, *system.parameter_names)
    others = tuple(name for name in QUANTITIES if name not in own)
    return (*own, *(item.name for item in system.prescribed), *others)


def event(dynamics: Dynamics, condition: Condition, action: Action = Action.RECORD) -> Event:
    """A condition as an event of a scenario.

    Raises a Failure where it has no value: a division by zero at these numbers, a power that is neither whole nor half.
    """
    difference = node(dynamics, condition.difference)
    program = dynamics.right_hand_side.program
    orientation = program.one
    if condition.period is not None:
        turns = program.divide(difference * program.input("pi"), node(dynamics, condition.period))
        difference, orientation = program.sin_cos_of(turns)
    code = Code(program, dynamics.inputs, (difference, orientation))
    return Event(
        condition.title, code, Direction(condition.direction), action, condition.text, condition.side, condition.closed
    )


def node(dynamics: Dynamics, expression: Expression) -> Node:
    """An expression in the program of a scenario."""
    program = dynamics.right_hand_side.program
    own = set(known_names(dynamics.system)) - set(QUANTITIES)
    known = {name: program.input(name) for name in (names(expression) & own) | {"pi"}}
    for name in names(expression) - own:
        known[name] = _quantity(dynamics, name)
    lowered: Node = Lowering(program, known)(expression)
    return lowered


def _quantity(dynamics: Dynamics, name: str) -> Node:
    match name:
        case "energy":
            return dynamics.energies.outputs[0]
        case "generalized_energy":
            return dynamics.energies.outputs[1]
        case "kinetic_energy":
            return dynamics.relative_energy.outputs[1]
    raise KeyError(name)


def values_code(dynamics: Dynamics, events: Sequence[Event]) -> Code:
    """(t, q, q') -> g of every event."""
    program = dynamics.right_hand_side.program
    return Code(program, dynamics.inputs, tuple(event.code.outputs[0] for event in events))


def slopes_code(dynamics: Dynamics, event: Event) -> Code:
    """(t, q, q') -> g, dg/dt along the motion, o, and the derivatives of g by q and q'."""
    rates, program = dynamics.right_hand_side.outputs, dynamics.right_hand_side.program
    value, orientation = event.code.outputs
    by_time, *by_state = gradient(program, value, [program.input(name) for name in dynamics.inputs])
    slope = by_time
    for derivative, rate in zip(by_state, rates, strict=True):
        slope = slope + program.product(derivative, rate)
    return Code(program, dynamics.inputs, (value, slope, orientation, *by_state))


def source_of(dynamics: Dynamics, place: int) -> Expression | None:
    """The call, quotient or root of a load that holds the u at this place of ``Features.narrow``; None if unknown."""
    target = dynamics.features.narrow.outputs[place].number
    for load in dynamics.system.loads:
        for expression in expressions(load):
            for part in walk(expression):
                inside = (
                    part.argument if isinstance(part, Call) else part.right if isinstance(part, Operation) else None
                )
                if inside is None or (isinstance(part, Operation) and part.operator != "/"):
                    continue
                try:
                    if node(dynamics, inside).number == target:
                        return part
                except (Failure, KeyError):
                    continue
    return None
