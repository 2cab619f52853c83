"""What is said of an enclosure of the exact solution: words, ``simulation.json``, and ``enclosure.csv``."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import Any

from mbsym.expressions.message import Message, at_most, duration, joined
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


def certificate_lines(certificate: Certificate, system: System, rows: int) -> Iterator[Message]:
    """What is proved."""
    if certificate.rows:
        if certificate.whole:
            which = Message("all [[rows]] rows", rows=rows)
        else:
            which = Message("the first [[rows]] of [[all]] rows", rows=certificate.rows, all=rows)
        text = "the run is within [[error]] of the exact solution at [[which]] (proved; of each quantity's size)"
        yield Message(text, error=at_most(certificate.largest_error), which=which)
        known, steps = at_most(certificate.known), len(certificate.enclosure.segments)
        if certificate.narrow and certificate.width > certificate.wanted:
            table = "[[known]] ([[width]] in the digits of a table)"
            known = Message(table, known=known, width=at_most(certificate.width))
        text = "the exact solution is known to [[known]] there: [[steps]] steps of [[bits]] bits"
        yield Message(text, known=known, steps=steps, bits=certificate.enclosure.bits)
        if not certificate.narrow:
            why = [WHY[certificate.enclosure.cut]] if certificate.whole and certificate.enclosure.cut else []
            text = "that is wider than the [[wanted]] that was asked for"
            yield joined([Message(text, wanted=f"{certificate.wanted:.2g}"), *why], ": ")
    if certificate.passages:
        proved = [radius for radius in certificate.passages if radius is not None]
        if proved:
            text = (
                "the exact solution has [[count]] of the run's [[all]] events, each once within [[radius]] of its time "
                "(proved)"
            )
            yield Message(text, count=len(proved), all=len(certificate.passages), radius=at_most(max(proved)))
        else:
            yield Message("of the run's events none is proved to be one of the exact solution")
    if not certificate.whole:
        reached = with_unit(f"{certificate.enclosure.reached:.6g}", pretty(time_unit(system)))
        yield Message("nothing is proved beyond t = [[time]]: [[why]]", time=reached, why=_ended(certificate))


def _ended(certificate: Certificate) -> Message:
    """With how long the whole would take, where that is why it ended."""
    enclosure, why = certificate.enclosure, WHY[certificate.ended]
    if certificate.ended not in (OUT_OF_TIME, TOO_DEAR) or not isfinite(enclosure.whole_seconds):
        return why
    steps, spent, whole = len(enclosure.segments), duration(enclosure.seconds), duration(enclosure.whole_seconds)
    text = "[[why]], [[steps]] steps took [[spent]], at this pace all would take [[whole]]"
    return Message(text, why=why, steps=steps, spent=spent, whole=whole)


def certificate_json(certificate: Certificate, names: list[str]) -> doc.Certificate:
    """Bounds are proved ones, at the enclosed rows."""
    return doc.Certificate.from_result(
        certificate,
        ended=certificate.ended.replace(" ", "_") or None,
        reached=certificate.enclosure.reached,
        bits=certificate.enclosure.bits,
        steps=len(certificate.enclosure.segments),
        asked=certificate.wanted,
        known=certificate.known,
        narrow=certificate.narrow,
        largest_radius=certificate.width,
        events_proved=sum(radius is not None for radius in certificate.passages),
        largest_event_radius=max((radius for radius in certificate.passages if radius is not None), default=None),
        quantities={
            name: doc.Enclosure(
                largest_radius=float(certificate.radius[i].max(initial=0.0)),
                largest_error=float(certificate.error[i].max(initial=0.0)),
                scale=float(certificate.scale[i]),
            )
            for i, name in enumerate(names)
        },
    )


def enclosure_csv(certificate: Certificate, times: Any, system: System) -> str:
    """t, and of each quantity q the columns q and q_radius: the exact solution is within q_radius of q as printed."""
    heads, table = [marked("t", time_unit(system))], [times[: certificate.rows]]
    for i, name in enumerate((*system.coordinates, *system.velocities)):
        unit = unit_of(system, name)
        heads += [marked(name, unit), marked(f"{name}_radius", unit)]
        table += [certificate.centre[i], certificate.radius[i]]
    return written(heads, table)
