"""What does not know constraints refuses a system that has some: an answer about the open tree would be false."""

from __future__ import annotations

from mbsym.algebra.failures import Constrained
from mbsym.expressions.message import Message
from mbsym.model.constraints import listed
from mbsym.model.system import System


def refuse_constraints(system: System, what: str) -> None:
    """Raises Constrained if there are constraints; ``what`` leaves them out, as in "the mass matrix alone"."""
    if system.constraints:
        message = "[[what]]: constraints are not taken into account here yet ([[constraints]])"
        told = Message(message, what=what, constraints=listed(system.constraints))
        raise Constrained(told, remedy="without its constraints this would be another system")
