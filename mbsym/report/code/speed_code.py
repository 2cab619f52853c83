"""What ``model.py`` and ``model.c`` hold of a system in speeds, from the straight-line program: y', y = (s, u).

With constraints u' is that of ``mbsym.mechanics.constraints.dynamics``, and states are led back to them as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.program import Node
from mbsym.mechanics.factorisation import solve
from mbsym.mechanics.speed_programs import SpeedProgram, restoring, speed_program
from mbsym.mechanics.speeds import SpeedForm
from mbsym.report.code.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: (place in y, what the code calls it).
Used = tuple[tuple[int, str], ...]


def _solved(analysis: Analysis, form: SpeedForm, found: SpeedProgram) -> tuple[Sequence[Node], Mapping[str, Node]]:
    """u', and by name what is added to states to lead them back.  Raises Failure."""
    program = found.program
    if not analysis.system.constraints:
        return solve(program, found.mass_matrix, found.forcing)[0], restoring(program, analysis.system)
    from mbsym.mechanics.constraints.dynamics import state_dynamics  # few systems have constraints
    from mbsym.report.code.constrained_code import tied_of

    tied = tied_of(analysis)
    if isinstance(tied, str):
        raise NoClosedForm(tied)
    own = state_dynamics(form, tied.chosen)
    nodes = [*own.accelerations, *own.position_correction, *own.velocity_correction]
    made = own.program.evaluate(nodes, {name: program.input(name) for name in own.environment}, program)
    n = len(form.speeds)
    names = (*(x.name for x in form.positions), *(u.name for u in form.speeds))
    return made[:n], dict(zip(names, made[n:], strict=True))


@dataclass(frozen=True)
class SpeedCode:
    """``state`` are the names of y; ``unpacked`` what the code calls them; the results of ``function`` are the upper
    half of M, f and s'; ``from_coordinates`` gives y from q and q'.  ``accelerated`` is y' = (s', u'), u' by
    factorisation; ``restored`` is y with quaternions and unit vectors led back to their lengths, and to constraints;
    None where there are none.  Of these two ``used`` are the states that occur, by place.
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
    if not analysis.system.speeds or analysis.system.inputs:
        return None
    form = analysis.form
    try:
        program = speed_program(form)
        start = form.state_in_coordinates(program.program)
        accelerations, moved = _solved(analysis, form, program)
    except Failure:
        return None
    n = len(form.speeds)
    upper = tuple((i, j) for i in range(n) for j in range(i, n))
    nodes = [*(program.mass_matrix[i][j] for i, j in upper), *program.forcing, *program.rates]
    state = [*(x.name for x in form.positions), *(u.name for u in form.speeds)]
    inputs = [program.program.input(name) for name in state]
    restored = [x + moved[name] if name in moved else x for name, x in zip(state, inputs, strict=True)]
    derived = [*program.rates, *accelerations]

    def used(outputs: Sequence[Node]) -> Used:
        live = {program.program.instructions[number].payload for number in program.program.live(outputs)}
        return tuple((place, writer.names[name]) for place, name in enumerate(state) if name in live)

    return SpeedCode(
        positions=tuple(x.name for x in form.positions),
        speeds=tuple(u.name for u in form.speeds),
        unpacked=tuple(writer.names[name] for name in state),
        upper=upper,
        function=writer.function(program.program, nodes),
        from_coordinates=writer.function(program.program, start),
        accelerated=writer.function(program.program, derived),
        accelerated_used=used(derived),
        restored=writer.function(program.program, restored) if moved else None,
        restored_used=used(restored),
    )
