"""What is said of an enclosure of the exact solution: words, ``simulation.json``, and ``enclosure.csv``."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, isfinite, log10
from typing import Any

from mbsym.expressions.counting import counted
from mbsym.model.quantities import marked, time_unit, unit_of, with_unit
from mbsym.model.system import System
from mbsym.numerics.enclosure.compare import Certificate
from mbsym.numerics.enclosure.enclose import INTERRUPTED, NO_STEP, OUT_OF_TIME, TOO_DEAR, TOO_WIDE
from mbsym.report.documents import simulation as doc
from mbsym.report.runs.trajectory_csv import written
from mbsym.report.unit_text import pretty

#: Why an enclosure ends early.
WHY = {
    NO_STEP: "no step could be proved there: a singularity of the equations is near, or their balls grow too fast",
    TOO_WIDE: "neighbouring motions part too fast",
    OUT_OF_TIME: "its time is too short",
    TOO_DEAR: "it takes more work than it may (as many seconds as --certify-seconds says, whatever the work)",
    INTERRUPTED: "interrupted",
}


def at_most(value: float) -> str:
    """``3.2e-11``, rounded up: a bound stays one."""
    if not 0 < value < float("inf"):
        return f"{value:.1e}"
    power = floor(log10(value)) - 1
    return f"{ceil(value / 10.0**power * (1 - 1e-15)) * 10.0**power:.1e}"


def certificate_lines(found: Certificate, system: System, rows: int) -> Iterator[str]:
    """What is proved."""
    if found.rows:
        which = f"all {rows} rows" if found.whole else f"the first {counted(found.rows, 'row', 'rows')} of {rows}"
        yield (
            f"the run is within {at_most(found.largest_error)} of the exact solution at {which} (proved; of each "
            "quantity's size)"
        )
        steps = counted(len(found.enclosure.segments), "step", "steps")
        known = at_most(found.known)
        if found.narrow and found.width > found.wanted:
            known += f" ({at_most(found.width)} in the digits of a table)"
        yield f"the exact solution is known to {known} there: {steps} of {found.enclosure.bits} bits"
        if not found.narrow:
            why = f": {WHY[found.enclosure.cut]}" if found.whole and found.enclosure.cut else ""
            yield f"that is wider than the {found.wanted:.2g} that was asked for{why}"
    if found.passages:
        proved = [radius for radius in found.passages if radius is not None]
        which = f"{len(proved)} of the run's {counted(len(found.passages), 'event', 'events')}"
        if proved:
            yield f"the exact solution has {which}, each once within {at_most(max(proved))} of its time (proved)"
        else:
            yield "of the run's events none is proved to be one of the exact solution"
    if not found.whole:
        reached = with_unit(f"{found.enclosure.reached:.6g}", pretty(time_unit(system)))
        yield f"nothing is proved beyond t = {reached}: {WHY[found.ended]}{_pace(found)}"


def _pace(found: Certificate) -> str:
    """How long the whole would take, where that is why it ended."""
    enclosure = found.enclosure
    if found.ended not in (OUT_OF_TIME, TOO_DEAR) or not isfinite(enclosure.whole_seconds):
        return ""
    steps = counted(len(enclosure.segments), "step", "steps")
    whole = spelled(enclosure.whole_seconds)
    return f", {steps} took {spelled(enclosure.seconds)}, at this pace all would take {whole}"


def spelled(seconds: float) -> str:
    """``40 s``, ``3 h``, ``2.1e+03 days``."""
    for limit, unit, name in ((120.0, 1.0, "s"), (7200.0, 60.0, "min"), (172800.0, 3600.0, "h")):
        if seconds < limit:
            return f"{seconds / unit:.2g} {name}"
    return f"{seconds / 86400.0:.2g} days"


def certificate_json(found: Certificate, names: list[str]) -> doc.Certificate:
    """Bounds are proved ones, at the enclosed rows."""
    return doc.Certificate(
        whole=found.whole,
        ended=found.ended.replace(" ", "_") or None,
        reached=found.enclosure.reached,
        rows=found.rows,
        bits=found.enclosure.bits,
        steps=len(found.enclosure.segments),
        asked=found.wanted,
        known=found.known,
        narrow=found.narrow,
        largest_radius=found.width,
        largest_error=found.largest_error,
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
