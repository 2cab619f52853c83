"""Events and sections of a run: what ``simulation.json`` and the terminal say of them, and their tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from mbsym.expressions.message import Message, joined
from mbsym.model.quantities import marked, time_unit, unit_of, with_unit
from mbsym.model.system import System
from mbsym.numerics.events.events import MOST, Occurrence, Occurrences
from mbsym.numerics.events.surfaces import Action, Event
from mbsym.report.documents import simulation as doc
from mbsym.report.runs.trajectory_csv import shortest, text_table
from mbsym.report.unit_text import pretty
from mbsym.simulation import Simulation
from mbsym.simulation.watching import SectionPoints


def events_json(run: Simulation) -> dict[str, Any]:
    """``events``, ``stopped`` and ``section``; nothing where nothing was watched for."""
    if run.happened is None:
        return {}
    occurrences = run.happened.occurrences
    content: dict[str, Any] = {
        "events": [_event(occurrences, place, event) for place, event in enumerate(occurrences.events)],
        "stopped": _stopped(run, occurrences.ended),
    }
    cut = run.happened.section
    if cut is not None:
        content["section"] = doc.Section(
            condition=cut.section.condition.text, axes=[axis.text for axis in cut.section.axes], count=len(cut.times)
        )
    return content


def _event(occurrences: Occurrences, place: int, event: Event) -> doc.WatchedEvent:
    times = occurrences.times[occurrences.which == place]
    return doc.WatchedEvent.from_result(
        event,
        condition=event.text,
        count=len(times),
        first=float(times[0]) if len(times) else None,
        last=float(times[-1]) if len(times) else None,
        touches=int(np.sum(occurrences.turns[occurrences.which == place] == 0)),
        undecided=event in occurrences.undecided,
    )


def _stopped(run: Simulation, ended: Occurrence | None) -> doc.Stopped | None:
    if ended is None or run.happened is None:
        return None
    names = [*run.system.coordinates, *run.system.velocities]
    state: dict[str, float | str] = dict(zip(names, map(float, ended.state), strict=True))
    return doc.Stopped(event=run.happened.occurrences.events[ended.event].name, time=float(ended.time), state=state)


# What is said of events on the terminal.


def events_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(title, text) of what happened; ``warning`` where something cannot be told."""
    if run.happened is None:
        return
    occurrences, unit = run.happened.occurrences, pretty(time_unit(run.system))
    since: list[Message] = []
    if run.request.earlier is not None:
        begun = with_unit(f"{run.request.earlier.time:.9g}", unit)
        since = [Message("watched from t = [[time]] on", time=begun)]
    for place, event in enumerate(occurrences.events):
        own = occurrences.which == place
        times, touches = occurrences.times[own], int((occurrences.turns[own] == 0).sum())
        messages = [Message("never"), *since]
        if len(times):
            first = with_unit(f"{times[0]:.9g}", unit)
            messages = [Message("[[count]] times, first at t = [[time]]", count=len(times), time=first), *since]
        if len(times) == 1:
            messages[0] = Message("once, at t = [[time]]", time=first)
        if touches:
            text = "[[count]] of them touch only, as far as this run can tell: two passages or none"
            messages.append(Message(text, count=touches))
        idle = event.action is Action.STOP and (touches or (len(times) and times[0] == run.trajectory.times[0]))
        if idle and occurrences.ended is None:
            messages.append(Message("touching, or at the start, it stops nothing"))
        yield "event", Message("[[event]]: [[said]]", event=event.name, said=joined(messages, "; "))
    if occurrences.ended is not None:
        time = with_unit(f"{occurrences.ended.time:.9g}", unit)
        text = "at t = [[time]] by [[event]]"
        if occurrences.ended.time <= (0.0 if run.request.earlier is None else run.request.earlier.time):
            text = "at t = [[time]] by [[event]], which holds at the start: nothing was integrated"
        yield "stopped", Message(text, time=time, event=occurrences.events[occurrences.ended.event].name)
    for event in occurrences.undecided:
        text = "[[event]]: the two sides were equal all along within the error of a step: nothing can be told"
        yield "warning", Message(text, event=event.name)
    if run.section is not None:
        points = Message("points: [[count]]", count=len(run.section.times))
        condition, said = run.section.section.condition.text, joined([points, *since], "; ")
        yield "section", Message("[[event]]: [[said]]", event=condition, said=said)
    if occurrences.beyond:
        text = "only the first [[most]] events were kept; there were [[more]] more"
        yield "warning", Message(text, most=MOST, more=occurrences.beyond)


# ``events.csv`` and ``section.csv``: what happened along a run, as plain CSV; numbers read back exactly.
#
# Columns of events: ``t``, ``event`` (its title, or the condition as it was written), ``direction`` (1: the left side
# grew beyond the right one, -1: fell below it, 0: touched it, so that there were two passages or none), the coordinates
# and velocities then; with a certificate ``t_radius``: the exact solution has the event, once, within that of ``t``
# (nothing: not proved).  Of a section: ``t``, ``direction``, its axes, coordinates and velocities.


def events_csv(occurrences: Occurrences, system: System, radii: Sequence[float | None] | None = None) -> str:
    """The text of events.csv; ``radii`` of a certificate stand in a column of their own."""
    names = [event.name for event in occurrences.events]
    time_unit = unit_of(system, "t")
    proved = [] if radii is None else [marked("t_radius", time_unit)]
    header = [marked("t", time_unit), *proved, "event", "direction", *_states(system)]
    columns = [[]] * len(occurrences) if radii is None else [["" if x is None else shortest(x)] for x in radii]
    rows = (
        [shortest(time), *radius, names[which], str(turn), *map(shortest, state)]
        for time, radius, which, turn, state in zip(
            occurrences.times, columns, occurrences.which, occurrences.turns, occurrences.states.T, strict=True
        )
    )
    return text_table(header, rows)


def section_csv(section_points: SectionPoints, system: System) -> str:
    """The text of section.csv."""
    axes = [
        axis.text for axis in section_points.section.axes if axis.text not in (*system.coordinates, *system.velocities)
    ]
    shown = [place for place, axis in enumerate(section_points.section.axes) if axis.text in axes]
    header = [marked("t", unit_of(system, "t")), "direction", *axes, *_states(system)]
    rows = (
        [shortest(time), str(turn), *map(shortest, point[shown]), *map(shortest, state)]
        for time, turn, point, state in zip(
            section_points.times, section_points.turns, section_points.points.T, section_points.states.T, strict=True
        )
    )
    return text_table(header, rows)


def _states(system: System) -> Sequence[str]:
    return [marked(name, unit_of(system, name)) for name in (*system.coordinates, *system.velocities)]
