"""What is said of an enclosure of the exact solution: words, ``simulation.json``, and ``enclosure.csv``."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, isfinite, log10
from typing import Any

from mbsym.expressions.message import Message, duration, joined
from mbsym.model.quantities import marked, time_unit, unit_of, with_unit
from mbsym.model.system import System
from mbsym.numerics.enclosure.compare import Certificate
from mbsym.numerics.enclosure.enclose import INTERRUPTED, NO_STEP, OUT_OF_TIME, TOO_DEAR, TOO_WIDE
from mbsym.report.documents import simulation as doc
from mbsym.report.runs.trajectory_csv import written
from mbsym.report.unit_text import pretty

#: Why an enclosure ends early.
WHY = {
    NO_STEP: Message(
        "no step could be proved there: a singularity of the equations is near, or their balls grow too fast"
    ),
    TOO_WIDE: Message("neighbouring motions part too fast"),
    OUT_OF_TIME: Message("its time is too short"),
    TOO_DEAR: Message("it takes more work than it may (as many seconds as --certify-seconds says, whatever the work)"),
    INTERRUPTED: Message("interrupted"),
}


def at_most(value: float) -> str:
    """``3.2e-11``, rounded up: a bound stays one."""
    if not 0 < value < float("inf"):
        return f"{value:.1e}"
    power = floor(log10(value)) - 1
    return f"{ceil(value / 10.0**power * (1 - 1e-15)) * 10.0**power:.1e}"


def certificate_lines(found: Certificate, system: System, rows: int) -> Iterator[Message]:
    """What is proved."""
    if found.rows:
        if found.whole:
            which = Message("all [[rows]] rows", rows=rows)
        else:
            which = Message("the first [[rows]] of [[all]] rows", rows=found.rows, all=rows)
        text = "the run is within [[error]] of the exact solution at [[which]] (proved; of each quantity's size)"
        yield Message(text, error=at_most(found.largest_error), which=which)
        known, steps = at_most(found.known), len(found.enclosure.segments)
        if found.narrow and found.width > found.wanted:
            table = "[[known]] ([[width]] in the digits of a table)"
            known = Message(table, known=known, width=at_most(found.width))
        text = "the exact solution is known to [[known]] there: [[steps]] steps of [[bits]] bits"
        yield Message(text, known=known, steps=steps, bits=found.enclosure.bits)
        if not found.narrow:
            why = [WHY[found.enclosure.cut]] if found.whole and found.enclosure.cut else []
            text = "that is wider than the [[wanted]] that was asked for"
            yield joined([Message(text, wanted=f"{found.wanted:.2g}"), *why], ": ")
    if found.passages:
        proved = [radius for radius in found.passages if radius is not None]
        if proved:
            text = (
                "the exact solution has [[count]] of the run's [[all]] events, each once within [[radius]] of its time "
                "(proved)"
            )
            yield Message(text, count=len(proved), all=len(found.passages), radius=at_most(max(proved)))
        else:
            yield Message("of the run's events none is proved to be one of the exact solution")
    if not found.whole:
        reached = with_unit(f"{found.enclosure.reached:.6g}", pretty(time_unit(system)))
        yield Message("nothing is proved beyond t = [[time]]: [[why]]", time=reached, why=_ended(found))


def _ended(found: Certificate) -> Message:
    """With how long the whole would take, where that is why it ended."""
    enclosure, why = found.enclosure, WHY[found.ended]
    if found.ended not in (OUT_OF_TIME, TOO_DEAR) or not isfinite(enclosure.whole_seconds):
        return why
    steps, spent, whole = len(enclosure.segments), duration(enclosure.seconds), duration(enclosure.whole_seconds)
    text = "[[why]], [[steps]] steps took [[spent]], at this pace all would take [[whole]]"
    return Message(text, why=why, steps=steps, spent=spent, whole=whole)


def certificate_json(found: Certificate, names: list[str]) -> doc.Certificate:
    """Bounds are proved ones, at the enclosed rows."""
    return doc.Certificate.from_result(
        found,
        ended=found.ended.replace(" ", "_") or None,
        reached=found.enclosure.reached,
        bits=found.enclosure.bits,
        steps=len(found.enclosure.segments),
        asked=found.wanted,
        known=found.known,
        narrow=found.narrow,
        largest_radius=found.width,
        events_proved=sum(radius is not None for radius in found.passages),
        largest_event_radius=max((radius for radius in found.passages if radius is not None), default=None),
        quantities={
            name: doc.Enclosure(
                largest_radius=float(found.radius[i].max(initial=0.0)),
                largest_error=float(found.error[i].max(initial=0.0)),
                scale=float(found.scale[i]),
            )
            for i, name in enumerate(names)
        },
    )


def enclosure_csv(found: Certificate, times: Any, system: System) -> str:
    """t, and of each quantity q the columns q and q_radius: the exact solution is within q_radius of q as printed."""
    heads, table = [marked("t", time_unit(system))], [times[: found.rows]]
    for i, name in enumerate((*system.coordinates, *system.velocities)):
        unit = unit_of(system, name)
        heads += [marked(name, unit), marked(f"{name}_radius", unit)]
        table += [found.centre[i], found.radius[i]]
    return written(heads, table)
