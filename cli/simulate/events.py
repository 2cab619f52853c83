"""What ``mbsym simulate`` watches for: ``--event``, ``--stop``, ``--section``, ``--axes``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym.expressions.condition import AxisText, Condition, parse_axes, parse_condition
from mbsym.expressions.place import Complaints
from mbsym.source import render_option
from mbsym_cli.options import Options, group, place_in

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request


@dataclass(frozen=True)
class Watched:
    """As they were typed."""

    events: tuple[str, ...]
    stops: tuple[str, ...]
    section: str | None
    axes: str | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the conditions; whatever is wrong with them joins the complaints of ``asked``."""
        if not (self.events or self.stops or self.section is not None or self.axes is not None):
            return request
        from mbsym.simulation.watching import Watch, section_of

        if system is None:
            return request
        events = _read("--event", self.events, system, asked)
        stops = _read("--stop", self.stops, system, asked)
        surfaces = _read("--section", () if self.section is None else (self.section,), system, asked)
        axes = _axes(self.axes, system, asked)
        sections = [section_of(system, surface, axes) for surface in surfaces]
        return replace(request, events=Watch(events, stops, sections[0] if sections else None))


watch_options = group(
    "watched",
    Watched,
    click.option(
        "--event", "events", multiple=True, metavar="CONDITION", help='Record when: "theta = 0 rising"; repeatable.'
    ),
    click.option(
        "--stop", "stops", multiple=True, metavar="CONDITION", help='End the run when: "r < 1/10"; repeatable.'
    ),
    click.option("--section", metavar="CONDITION", help='Poincare section: "t = 0 mod 2*pi/Omega", "q1 = 0 rising".'),
    click.option("--axes", metavar="X,Y", help='Of the section: "q2, q2_dot".  [default: the first free coordinate]'),
)


def _read(option: str, texts: Sequence[str], system: System, asked: Options) -> tuple[Condition, ...]:
    """The conditions that are sound."""
    from mbsym.numerics.events.surfaces import known_names

    found = []
    for text in (" ".join(one.splitlines()) for one in texts):
        complaints = Complaints()
        found.append(parse_condition(text, known_names(system), complaints, place_in))
        asked.complaints += [render_option(complaint, text, option) for complaint in complaints.sorted()]
    return tuple(one for one in found if one is not None)


def _axes(text: str | None, system: System, asked: Options) -> tuple[AxisText, ...]:
    from mbsym.numerics.events.surfaces import known_names

    complaints = Complaints()
    found = () if text is None else parse_axes(text, known_names(system), complaints, place_in)
    asked.complaints += [render_option(complaint, text or "", "--axes") for complaint in complaints.sorted()]
    return found
