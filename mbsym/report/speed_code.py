"""What ``model.py`` holds of a system in speeds: y' for y = (positions, speeds), from the straight-line program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.mechanics.speed_programs import speed_program
from mbsym.report.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


@dataclass(frozen=True)
class SpeedCode:
    """``state`` are the names of y; ``unpacked`` what the code calls them; the results of ``function`` are the upper
    half of M, f and s'; ``from_coordinates`` gives y from q and q'."""

    positions: tuple[str, ...]
    speeds: tuple[str, ...]
    unpacked: tuple[str, ...]
    upper: tuple[tuple[int, int], ...]
    function: Function
    from_coordinates: Function


def speed_code(analysis: Analysis, writer: Functions) -> SpeedCode | None:
    """The code; None where the system has no speeds, inputs besides, or no program."""
    form = analysis.speed_form
    if form is None or analysis.system.inputs:
        return None
    try:
        found = speed_program(form)
        start = form.state_in_coordinates(found.program)
    except Failure:
        return None
    n = len(form.speeds)
    upper = tuple((i, j) for i in range(n) for j in range(i, n))
    nodes = [*(found.mass_matrix[i][j] for i, j in upper), *found.forcing, *found.rates]
    state = [*(x.name for x in form.positions), *(u.name for u in form.speeds)]
    return SpeedCode(
        positions=tuple(x.name for x in form.positions),
        speeds=tuple(u.name for u in form.speeds),
        unpacked=tuple(writer.names[name] for name in state),
        upper=upper,
        function=writer.function(found.program, nodes),
        from_coordinates=writer.function(found.program, start),
    )
