"""What ``model.py`` and ``model.c`` hold of a system in speeds, from the straight-line program: y', y = (s, u)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.mechanics.factorisation import solve
from mbsym.mechanics.speed_programs import restoring, speed_program
from mbsym.report.code.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: (place in y, what the code calls it).
Used = tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class SpeedCode:
    """``state`` are the names of y; ``unpacked`` what the code calls them; the results of ``function`` are the upper
    half of M, f and s'; ``from_coordinates`` gives y from q and q'.  ``accelerated`` is y' = (s', u'), u' by
    factorisation; ``restored`` is y with quaternions and unit vectors led back to their lengths, None where there are
    none.  Of these two ``used`` are the states that occur, by place.
    """

    positions: tuple[str, ...]
    speeds: tuple[str, ...]
    unpacked: tuple[str, ...]
    upper: tuple[tuple[int, int], ...]
    function: Function
    from_coordinates: Function
    accelerated: Function
    accelerated_used: Used
    restored: Function | None
    restored_used: Used


def speed_code(analysis: Analysis, writer: Functions) -> SpeedCode | None:
    """The code; None where the system has no speeds, inputs besides, or no program."""
    form = analysis.speed_form
    if form is None or analysis.system.inputs:
        return None
    try:
        found = speed_program(form)
        start = form.state_in_coordinates(found.program)
        accelerations, _ = solve(found.program, found.mass_matrix, found.forcing)
    except Failure:
        return None
    n = len(form.speeds)
    upper = tuple((i, j) for i in range(n) for j in range(i, n))
    nodes = [*(found.mass_matrix[i][j] for i, j in upper), *found.forcing, *found.rates]
    state = [*(x.name for x in form.positions), *(u.name for u in form.speeds)]
    moved = restoring(found.program, analysis.system)
    inputs = [found.program.input(name) for name in state]
    restored = [x + moved[name] if name in moved else x for name, x in zip(state, inputs, strict=True)]
    derived = [*found.rates, *accelerations]

    def used(outputs: Sequence[Node]) -> Used:
        live = {found.program.instructions[number].payload for number in found.program.live(outputs)}
        return tuple((place, writer.names[name]) for place, name in enumerate(state) if name in live)

    return SpeedCode(
        positions=tuple(x.name for x in form.positions),
        speeds=tuple(u.name for u in form.speeds),
        unpacked=tuple(writer.names[name] for name in state),
        upper=upper,
        function=writer.function(found.program, nodes),
        from_coordinates=writer.function(found.program, start),
        accelerated=writer.function(found.program, derived),
        accelerated_used=used(derived),
        restored=writer.function(found.program, restored) if moved else None,
        restored_used=used(restored),
    )
