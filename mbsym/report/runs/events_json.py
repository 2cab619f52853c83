"""What ``simulation.json`` says of events and of a section; the occurrences themselves are in the tables."""

from __future__ import annotations

from typing import Any

import numpy as np

from mbsym.numerics.events.events import Occurrence, Occurrences
from mbsym.numerics.events.surfaces import Event
from mbsym.report.documents import simulation as doc
from mbsym.simulation import Simulation


def events_json(run: Simulation) -> dict[str, Any]:
    """``events``, ``stopped`` and ``section``; nothing where nothing was watched for."""
    if run.happened is None:
        return {}
    found = run.happened.occurrences
    content: dict[str, Any] = {
        "events": [_event(found, place, event) for place, event in enumerate(found.events)],
        "stopped": _stopped(run, found.ended),
    }
    section = run.happened.section
    if section is not None:
        content["section"] = doc.Section(
            condition=section.section.condition.text,
            axes=[axis.text for axis in section.section.axes],
            count=len(section.times),
        )
    return content


def _event(found: Occurrences, place: int, event: Event) -> doc.WatchedEvent:
    times = found.times[found.which == place]
    return doc.WatchedEvent(
        name=event.name,
        condition=event.text,
        direction=event.direction,
        action=event.action,
        count=len(times),
        first=float(times[0]) if len(times) else None,
        last=float(times[-1]) if len(times) else None,
        touches=int(np.sum(found.turns[found.which == place] == 0)),
        undecided=event in found.undecided,
    )


def _stopped(run: Simulation, ended: Occurrence | None) -> doc.Stopped | None:
    if ended is None or run.happened is None:
        return None
    names = [*run.system.coordinates, *run.system.velocities]
    state: dict[str, float | str] = dict(zip(names, map(float, ended.state), strict=True))
    return doc.Stopped(event=run.happened.occurrences.events[ended.event].name, time=float(ended.time), state=state)
