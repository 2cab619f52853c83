"""What ``model.py`` holds of a constrained system: functions of its rows, from the straight-line program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.analysis.constrained import programs_of
from mbsym.analysis.stages import Unavailable
from mbsym.mechanics.programs import Programs
from mbsym.report.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class TiedCode:
    """Functions of the independent rows: phi (of those on positions), J q' + j, J and gamma.

    ``rows`` are their labels, ``held`` the places of those on positions among them, ``places`` the entries of J that
    need not be zero.
    """

    rows: tuple[str, ...]
    held: list[int]
    phi: Function
    velocity: Function
    jacobian: Function
    gamma: Function
    places: tuple[tuple[int, int], ...]

    @property
    def positions(self) -> int:
        """How many constraints on positions there are."""
        return len(self.held)


def tied_code(analysis: Analysis, writer: Functions) -> tuple[TiedCode | None, Programs | None, str]:
    """The functions and the program of the open tree; or the reason why there are none."""
    try:
        found, code = analysis.constraints, programs_of(analysis)
    except Unavailable as missing:
        return None, None, missing.failure.reason
    program, rows = code.tree.program, found.independent
    held = [k for k, i in enumerate(rows) if code.position[i] is not None]
    phi = [node for i in rows if (node := code.position[i]) is not None]
    places = tuple(
        (k, j) for k, i in enumerate(rows) for j, node in enumerate(code.jacobian[i]) if not program.vanishes(node)
    )
    tied = TiedCode(
        tuple(found.names[i].label for i in rows),
        held,
        writer.function(program, phi),
        writer.function(program, [code.velocity[i] for i in rows]),
        writer.function(program, [code.jacobian[rows[k]][j] for k, j in places]),
        writer.function(program, [code.acceleration[i] for i in rows]),
        places,
    )
    return tied, code.tree, ""
