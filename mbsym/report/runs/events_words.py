"""What is said of events on the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.counting import counted
from mbsym.model.quantities import time_unit, with_unit
from mbsym.numerics.events.events import MOST
from mbsym.report.unit_text import pretty
from mbsym.simulation import Simulation


def events_lines(run: Simulation) -> Iterator[tuple[str, str]]:
    """(title, text) of what happened; ``warning`` where something cannot be told."""
    if run.happened is None:
        return
    found, unit = run.happened.occurrences, pretty(time_unit(run.system))
    begun = run.request.earlier
    since = "" if begun is None else f" after t = {with_unit(f'{begun.time:.9g}', unit)}, from where on it was watched"
    for place, event in enumerate(found.events):
        own = found.which == place
        times, touches = found.times[own], int((found.turns[own] == 0).sum())
        said = (counted(len(times), "time", "times") if len(times) else "never") + since
        if len(times):
            said += f", first at t = {with_unit(f'{times[0]:.9g}', unit)}"
        if touches:
            said += f"; {touches} of them touch only, as far as this run can tell: two passages or none"
        yield "event", f"{event.name}: {said}"
    if found.ended is not None:
        name = found.events[found.ended.event].name
        yield "stopped", f"at t = {with_unit(f'{found.ended.time:.9g}', unit)} by {name}"
    for event in found.undecided:
        yield (
            "warning",
            f"{event.name}: the two sides were equal all along within the error of a step: nothing can be told",
        )
    if run.section is not None:
        yield (
            "section",
            f"{run.section.section.condition.text}: {counted(len(run.section.times), 'point', 'points')}{since}",
        )
    if found.beyond:
        yield "warning", f"only the first {MOST} events were kept; there were {found.beyond} more"
