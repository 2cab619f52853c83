"""Motions whose initial state has to satisfy constraints: led there, and what is said where that cannot be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.studies.study import Exit, Refusal

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario

#: So many gaps are told one by one.
MOST_GAPS = 8


def closed_motion(given: Scenario) -> tuple[Scenario, tuple[str, ...]]:
    """The scenario with an initial state on its constraints, and what is said of that.  Raises NotClosed."""
    if not given.system.constraints:
        return given, ()
    from mbsym.numerics.closing import closed
    from mbsym.report.runs.constrained_run_words import start_lines

    found = closed(given)
    return found.scenario, tuple(f"note: {text}" for text in start_lines(found, given.system)) if found.moves else ()


def not_closed(error: Exception, system: System) -> Refusal | None:
    """Which state comes closest, and its gaps; None of other errors."""
    from mbsym.model.quantities import unit_of, with_unit
    from mbsym.numerics.closing import NotClosed
    from mbsym.report.unit_text import pretty

    if not isinstance(error, NotClosed):
        return None
    names = (*system.coordinates, *system.velocities)
    shown = names if any(gap.velocity for gap in error.gaps) else system.coordinates
    state = ", ".join(
        f"{name} = {with_unit(f'{value:.6g}', pretty(unit_of(system, name)))}"
        for name, value in zip(shown, error.state.tolist(), strict=False)
    )
    lines = [f"  closest found: {state}"]
    for gap in sorted(error.gaps, key=lambda one: -one.size)[:MOST_GAPS]:
        place = "" if gap.row.span is None else f" (line {gap.row.span.line})"
        lines.append(f"  gap of {gap.row.label}{place}: {gap.size:.6g}{' (velocity)' if gap.velocity else ''}")
    if error.singular:
        lines.append("  hint: accelerations do not follow from constraints in such a position; start elsewhere")
    elif error.fixed:
        lines.append(f"  hint: fix fewer initial values than {', '.join(error.fixed)}, or change them")
    else:
        lines.append("  hint: check lengths and the initial position; a start nearer to a closed one may succeed")
    code = Exit.BAD_INPUT if error.fixed else Exit.BROKEN_DOWN
    return Refusal(f"error[{error.code}]: {error}", code, (*lines, "nothing was written."))
