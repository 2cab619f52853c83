"""What is said of the constraints of a run: its start, its drift, its columns; for the terminal and simulation.json."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from msgspec import UNSET, UnsetType

from mbsym.expressions.message import Message, joined
from mbsym.model.quantities import time_unit, unit_of, with_unit
from mbsym.numerics.closing import NOUGHT
from mbsym.report.documents import simulation as doc
from mbsym.report.unit_text import pretty

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.closing import Closed
    from mbsym.numerics.constrained import Constraints, Drift
    from mbsym.simulation import Simulation

#: The columns of the drift.
POSITIONS, VELOCITIES = "constraint_drift", "constraint_velocity_drift"

#: So many moves of initial values are told one by one.
MOST_MOVES = 6


def constraint_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(title, text) of the summary's lines, without a title what goes on; none without constraints."""
    known = run.dynamics.measured
    if known is None or run.drift is None or run.closed is None:
        return
    unit, linear = pretty(time_unit(run.system)), run.request.model.linear
    yield "loops", rows_line(known)
    for place, text in enumerate(start_lines(run.closed, run.system, linear)):
        yield "" if place else "start", text
    yield "drift", drift_line(run.drift, known)
    if linear:
        yield "", Message("linear equations keep the constraints to first order about the unperturbed motion")
    if run.trajectory.work.singular:
        yield "singular", singular_line(run.trajectory.work.singular, unit)
    if run.stepped_over:
        yield "warning", stepped_over_line(run.stepped_over, unit)


def rows_line(known: Constraints) -> Message:
    """``independent constraint rows: 2; free velocities: 1 of 3``; which rows follow from others."""
    free = (
        "free velocities: at most [[free]] of [[all]]" if known.more_is_held else "free velocities: [[free]] of [[all]]"
    )
    messages = [
        Message("independent constraint rows: [[rows]]", rows=len(known.kept)),
        Message(free, free=known.freedom, all=known.size),
    ]
    if known.redundant:
        text = (
            "these follow from the others (seen at positions near the start, not proved) and drift with them: "
            "[[names]]; forces of single constraints are not unique"
        )
        messages.append(Message(text, names="; ".join(name.label for name in known.redundant)))
    return joined(messages, "; ")


def start_lines(closed: Closed, system: System, linear: bool = False) -> Iterator[Message]:
    """How far the initial state was moved to satisfy the constraints; of a ``linear`` model to first order."""
    held = [Message("fixed: [[names]]", names=", ".join(closed.fixed))] if closed.fixed else []
    satisfied = Message("the initial state satisfies the constraints")
    if linear:
        satisfied = Message("the initial state satisfies the constraints to first order about the unperturbed motion")
    if not closed.moves:
        yield joined([satisfied, *held], "; ")
        return
    units = {x.name: pretty(unit_of(system, x.name)) for x in closed.moves}
    if closed.given_stays:
        left_out = Message("velocities that were left out follow from those given")
        if not closed.follow:
            left_out = Message("velocities that were left out are as small as the constraints allow (mass matrix)")
        yield joined([satisfied, left_out, *held], "; ")
        shown = [f"{x.name} = {with_unit(_shown(x.found), units[x.name])}" for x in closed.moves]
        yield joined([*shown[:MOST_MOVES], *(["..."] if len(shown) > MOST_MOVES else [])], ", ")
        return
    if linear:
        text = "begun from a state that satisfies the constraints to first order about the unperturbed motion"
    elif closed.closest:
        text = "what was given does not satisfy the constraints: begun from the closest state that does (mass matrix)"
    else:
        text = (
            "what was given does not satisfy the constraints: begun from a state near it that does (not certain to be "
            "the closest)"
        )
    yield joined([Message(text), *held], "; ")
    largest = sorted(closed.moves, key=lambda move: -move.part)
    for move in largest[:MOST_MOVES]:
        taken = with_unit(_shown(move.found), units[move.name])
        yield Message(
            "[[name]] = [[taken]] instead of [[given]]", name=move.name, taken=taken, given=f"{move.given:.9g}"
        )
    if len(largest) > MOST_MOVES:
        yield Message("... and [[more]] more; all are in simulation.json", more=len(largest) - MOST_MOVES)


def _shown(value: float) -> str:
    return f"{value if abs(value) > NOUGHT else 0:.9g}"


def drift_line(drift: Drift, known: Constraints) -> Message:
    """The largest drifts of the rows shown, scaled by the scene."""
    positions, velocities = (f"{x:.1e}" for x in drift.largest)
    if known.holonomic:
        text = "positions [[q]], velocities [[v]] off the constraints at most, in parts of the motion's size"
        return Message(text, q=positions, v=velocities)
    text = "velocities [[v]] off the constraints at most, in parts of the motion's size; no positions are constrained"
    return Message(text, v=velocities)


def _times(times: Sequence[float], digits: int, unit: str | None) -> str:
    shown = [f"{time:.{digits}g}" for time in times[:MOST_MOVES]] + (["..."] if len(times) > MOST_MOVES else [])
    return with_unit(", ".join(shown), unit)


def singular_line(times: Sequence[float], unit: str | None) -> Message:
    """Where the motion was continued through positions in which constraints lose their rank."""
    text = (
        "at t = [[times]] the constraints lose their rank (branches of motion may meet): there the motion is the "
        "polynomial that fits it before; it satisfies the constraints behind"
    )
    return Message(text, times=_times(times, 6, unit))


def stepped_over_line(times: Sequence[float], unit: str | None) -> Message:
    """Where steps went over positions in which constraints lose their rank."""
    text = (
        "near t = [[times]] steps went over a position in which the constraints lose their rank (branches of motion "
        "may meet): the branch behind is the one that the step met; a smaller tolerance or step shows whether it is "
        "the smooth one"
    )
    return Message(text, times=_times(times, 4, unit))


def drift_columns(run: Simulation) -> Mapping[str, Any]:
    """The columns of the drift by their names; none without constraints."""
    if run.drift is None:
        return {}
    taken = (*run.system.coordinates, *run.system.velocities)
    columns = {POSITIONS: run.drift.positions, VELOCITIES: run.drift.velocities}
    return {name + "_" if name in taken else name: values for name, values in columns.items()}


def constraints_json(run: Simulation) -> doc.Constraints | UnsetType:
    """What simulation.json says; nothing without constraints."""
    known, closed, drift = run.dynamics.measured, run.closed, run.drift
    if known is None or closed is None or drift is None:
        return UNSET
    positions, velocities = drift.largest
    return doc.Constraints(
        rows=[name.label for name in known.names],
        left_out=[name.label for name in known.redundant],
        free_velocities=known.freedom,
        start=doc.Start.from_result(
            closed, moved={move.name: doc.Moved(given=move.given, taken=move.found) for move in closed.moves}
        ),
        drift=doc.Drift(positions=positions, velocities=velocities),
        singular=list(run.trajectory.work.singular),
        stepped_over=list(run.stepped_over),
    )
