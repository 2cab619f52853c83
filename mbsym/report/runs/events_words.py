"""What is said of events on the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.message import Message, joined
from mbsym.model.quantities import time_unit, with_unit
from mbsym.numerics.events.events import MOST
from mbsym.report.unit_text import pretty
from mbsym.simulation import Simulation


def events_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(title, text) of what happened; ``warning`` where something cannot be told."""
    if run.happened is None:
        return
    found, unit = run.happened.occurrences, pretty(time_unit(run.system))
    since: list[Message] = []
    if run.request.earlier is not None:
        begun = with_unit(f"{run.request.earlier.time:.9g}", unit)
        since = [Message("watched from t = [[time]] on", time=begun)]
    for place, event in enumerate(found.events):
        own = found.which == place
        times, touches = found.times[own], int((found.turns[own] == 0).sum())
        told = [Message("never"), *since]
        if len(times):
            first = with_unit(f"{times[0]:.9g}", unit)
            told = [Message("[[count]] times, first at t = [[time]]", count=len(times), time=first), *since]
        if len(times) == 1:
            told[0] = Message("once, at t = [[time]]", time=first)
        if touches:
            text = "[[count]] of them touch only, as far as this run can tell: two passages or none"
            told.append(Message(text, count=touches))
        yield "event", Message("[[event]]: [[said]]", event=event.name, said=joined(told, "; "))
    if found.ended is not None:
        time = with_unit(f"{found.ended.time:.9g}", unit)
        yield "stopped", Message("at t = [[time]] by [[event]]", time=time, event=found.events[found.ended.event].name)
    for event in found.undecided:
        text = "[[event]]: the two sides were equal all along within the error of a step: nothing can be told"
        yield "warning", Message(text, event=event.name)
    if run.section is not None:
        points = Message("points: [[count]]", count=len(run.section.times))
        condition, said = run.section.section.condition.text, joined([points, *since], "; ")
        yield "section", Message("[[event]]: [[said]]", event=condition, said=said)
    if found.beyond:
        text = "only the first [[most]] events were kept; there were [[more]] more"
        yield "warning", Message(text, most=MOST, more=found.beyond)
