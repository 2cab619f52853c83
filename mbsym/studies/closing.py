"""Motions whose initial state has to satisfy constraints: led there, and what is said where that cannot be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.report.language import Language
from mbsym.studies.study import NOTHING_WRITTEN, Exit, Refusal

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario

#: So many gaps are told one by one.
MOST_GAPS = 8


def closed_motion(scenario: Scenario, declared: bool = False) -> tuple[Scenario, tuple[str, ...]]:
    """The scenario on its constraints, in ``declared`` variables if it has any and they are integrated; what is said.

    Raises NotClosed, NothingMoves.
    """
    from mbsym.numerics.closing import begun, closed, moving
    from mbsym.report.runs.constrained_run_words import start_lines

    closure = moving(begun(scenario) if declared else closed(scenario))
    say = Language(scenario.system.language).say
    notes = (Message("note: [[text]]", text=text) for text in start_lines(closure, scenario.system))
    return closure.scenario, tuple(map(say, notes)) if closure.moves else ()


def not_closed(error: Exception, system: System) -> Refusal | None:
    """Which state comes closest, and its gaps, or that the constraints hold what closed; None of other errors."""
    from mbsym.model.quantities import unit_of, with_unit
    from mbsym.numerics.closing import NotClosed, NothingMoves
    from mbsym.report.unit_text import pretty

    say = Language(system.language).say
    if isinstance(error, NothingMoves):
        hint = say(Message("hint: [[hint]]", hint=error.remedy))
        told = (f"  {hint}", say(NOTHING_WRITTEN))
        return Refusal(f"error[{error.code}]: {say(error.reason)}", Exit.BROKEN_DOWN, told)
    if not isinstance(error, NotClosed):
        return None
    names = (*system.coordinates, *system.velocities)
    shown = names if any(gap.velocity for gap in error.gaps) else system.coordinates
    state = ", ".join(
        f"{name} = {with_unit(f'{value:.6g}', pretty(unit_of(system, name)))}"
        for name, value in zip(shown, error.state.tolist(), strict=False)
    )
    lines = [Message("closest found: [[state]]", state=state)]
    for gap in sorted(error.gaps, key=lambda gap: -gap.size)[:MOST_GAPS]:
        row: str = gap.row.label
        if gap.row.span is not None:
            row = Message("[[row]] (line [[line]])", row=row, line=gap.row.span.line)
        text = "gap of [[row]]: [[size]] (velocity)" if gap.velocity else "gap of [[row]]: [[size]]"
        lines.append(Message(text, row=row, size=f"{gap.size:.6g}"))
    if error.singular:
        hint = Message("accelerations do not follow from constraints in such a position; start elsewhere")
    elif error.fixed:
        hint = Message("fix fewer initial values than [[names]], or change them", names=", ".join(error.fixed))
    else:
        hint = Message("check lengths and the initial position; a start nearer to a closed one may succeed")
    lines.append(Message("hint: [[hint]]", hint=hint))
    code = Exit.BAD_INPUT if error.fixed else Exit.BROKEN_DOWN
    printed = [f"  {say(line)}" for line in lines]
    return Refusal(f"error[{error.code}]: {say(error.reason)}", code, (*printed, say(NOTHING_WRITTEN)))
