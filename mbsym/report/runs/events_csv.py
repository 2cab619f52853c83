"""``events.csv`` and ``section.csv``: what happened along a run, as plain CSV; numbers read back exactly (``%.17g``).

Columns of events: ``t``, ``event`` (its title, or the condition as it was written), ``direction`` (1: the left side
grew beyond the right one, -1: fell below it, 0: touched it, so that there were two passages or none), the coordinates
and velocities then; with a certificate ``t_radius``: the exact solution has the event, once, within that of ``t``
(nothing: not proved).  Of a section: ``t``, ``direction``, its axes, coordinates and velocities.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.model.quantities import marked, unit_of
from mbsym.model.system import System
from mbsym.numerics.events.events import Occurrences
from mbsym.simulation.watching import SectionPoints


def events_csv(found: Occurrences, system: System, radii: Sequence[float | None] | None = None) -> str:
    """The text of events.csv; ``radii`` of a certificate stand in a column of their own."""
    names = [cell(event.name) for event in found.events]
    time_unit = unit_of(system, "t")
    proved = [] if radii is None else [marked("t_radius", time_unit)]
    header = [marked("t", time_unit), *proved, "event", "direction", *_states(system)]
    columns = [[]] * len(found) if radii is None else [["" if x is None else _number(x)] for x in radii]
    rows = (
        [_number(time), *radius, names[which], str(turn), *map(_number, state)]
        for time, radius, which, turn, state in zip(
            found.times, columns, found.which, found.turns, found.states.T, strict=True
        )
    )
    return "\n".join([",".join(map(cell, header)), *map(",".join, rows), ""])


def section_csv(found: SectionPoints, system: System) -> str:
    """The text of section.csv."""
    axes = [axis.text for axis in found.section.axes if axis.text not in (*system.coordinates, *system.velocities)]
    shown = [place for place, axis in enumerate(found.section.axes) if axis.text in axes]
    header = [marked("t", unit_of(system, "t")), "direction", *axes, *_states(system)]
    rows = (
        [_number(time), str(turn), *map(_number, point[shown]), *map(_number, state)]
        for time, turn, point, state in zip(found.times, found.turns, found.points.T, found.states.T, strict=True)
    )
    return "\n".join([",".join(map(cell, header)), *map(",".join, rows), ""])


def cell(text: str) -> str:
    """Quoted where it has to be."""
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\r\n') else text


def _states(system: System) -> Sequence[str]:
    return [marked(name, unit_of(system, name)) for name in (*system.coordinates, *system.velocities)]


def _number(value: Any) -> str:
    return f"{float(value):.17g}"
