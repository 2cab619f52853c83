"""Where in a description a narrow function stands: the call whose argument is the u that was found in the program."""

from __future__ import annotations

from mbsym.algebra.failures import Failure
from mbsym.expressions.tree import Call, Expression, Operation, walk
from mbsym.mechanics.variables import expressions
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.surfaces import node


def source_of(dynamics: Dynamics, place: int) -> Expression | None:
    """The call, quotient or root of a load that holds the u at this place of ``Features.narrow``; None if unknown."""
    wanted = dynamics.features.narrow.outputs[place].number
    for load in dynamics.system.loads:
        for expression in expressions(load):
            for one in walk(expression):
                inside = one.argument if isinstance(one, Call) else one.right if isinstance(one, Operation) else None
                if inside is None or (isinstance(one, Operation) and one.operator != "/"):
                    continue
                try:
                    if node(dynamics, inside).number == wanted:
                        return one
                except (Failure, KeyError):
                    continue
    return None
