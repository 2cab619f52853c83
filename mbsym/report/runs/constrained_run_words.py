"""What is said of the constraints of a run: its start, its drift, its columns; for the terminal and simulation.json."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from msgspec import UNSET, UnsetType

from mbsym.expressions.counting import counted
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


def constraint_lines(run: Simulation) -> Iterator[tuple[str, str]]:
    """(title, text) of the summary's lines; none without constraints."""
    known = run.dynamics.constraints
    if known is None or run.drift is None or run.closed is None:
        return
    yield "loops", rows_line(known)
    for place, text in enumerate(start_lines(run.closed, run.system)):
        yield "" if place else "start", text
    yield "drift", drift_line(run.drift, known)
    if run.trajectory.work.singular:
        yield "singular", singular_line(run.trajectory.work.singular, pretty(time_unit(run.system)))
    if run.stepped_over:
        yield "warning", stepped_over_line(run.stepped_over, pretty(time_unit(run.system)))


def rows_line(known: Constraints) -> str:
    """``2 independent constraint rows, 1 velocity of 3 is free``; which rows follow from others."""
    kept = counted(len(known.kept), "independent constraint row", "independent constraint rows")
    free = f"{known.freedom} of {counted(known.size, 'velocity', 'velocities')} {'is' if known.freedom == 1 else 'are'}"
    text = f"{kept}, {'at most ' if known.more_is_held else ''}{free} free"
    if known.redundant:
        names = "; ".join(name.label for name in known.redundant)
        follow = "follows" if len(known.redundant) == 1 else "follow"
        text += (
            f"; {names} {follow} from the others (seen at positions near the start, not proved) and drift with them: "
            "forces of single constraints are not unique"
        )
    return text


def start_lines(closed: Closed, system: System) -> Iterator[str]:
    """How far the initial state was moved to satisfy the constraints."""
    held = f"; {', '.join(closed.fixed)} fixed" if closed.fixed else ""
    if not closed.moves:
        yield f"the initial state satisfies the constraints{held}"
        return
    if closed.given_stays:
        yield f"the initial state satisfies the constraints; velocities that were left out follow from them{held}"
        shown = [f"{x.name} = {with_unit(_shown(x.found), pretty(unit_of(system, x.name)))}" for x in closed.moves]
        yield ", ".join(shown[:MOST_MOVES]) + (", ..." if len(shown) > MOST_MOVES else "")
        return
    how = "closest state" if closed.closest else "state near it (not certain to be the closest)"
    yield f"what was given does not satisfy the constraints: begun from the {how} that does, by the mass matrix{held}"
    largest = sorted(closed.moves, key=lambda move: -abs(move.found - move.given) / (1 + abs(move.given)))
    for move in largest[:MOST_MOVES]:
        unit = pretty(unit_of(system, move.name))
        yield f"{move.name} = {with_unit(_shown(move.found), unit)} instead of {move.given:.9g}"
    if len(largest) > MOST_MOVES:
        yield f"... and {len(largest) - MOST_MOVES} more; all are in simulation.json"


def _shown(value: float) -> str:
    return f"{value if abs(value) > NOUGHT else 0:.9g}"


def drift_line(found: Drift, known: Constraints) -> str:
    """The largest drifts of the rows shown, scaled by the scene."""
    positions, velocities = found.largest
    first = f"positions {positions:.1e}, " if known.holonomic else "no positions are constrained, "
    return f"{first}velocities {velocities:.1e} off the constraints at most, in parts of the motion's size"


def singular_line(times: Sequence[float], unit: str | None) -> str:
    """Where the motion was continued through positions in which constraints lose their rank."""
    shown = ", ".join(f"{time:.6g}" for time in times[:MOST_MOVES]) + (", ..." if len(times) > MOST_MOVES else "")
    return (
        f"at t = {with_unit(shown, unit)} the constraints lose their rank (branches of motion may meet): there the "
        "motion is the polynomial that fits it before; it satisfies the constraints behind"
    )


def stepped_over_line(times: Sequence[float], unit: str | None) -> str:
    """Where steps went over positions in which constraints lose their rank."""
    shown = ", ".join(f"{time:.4g}" for time in times[:MOST_MOVES]) + (", ..." if len(times) > MOST_MOVES else "")
    return (
        f"near t = {with_unit(shown, unit)} steps went over a position in which the constraints lose their rank "
        "(branches of motion may meet): the branch behind is the one that the step met; a smaller tolerance or step "
        "shows whether it is the smooth one"
    )


def drift_columns(run: Simulation) -> Mapping[str, Any]:
    """The columns of the drift by their names; none without constraints."""
    if run.drift is None:
        return {}
    taken = (*run.system.coordinates, *run.system.velocities)
    found = {POSITIONS: run.drift.positions, VELOCITIES: run.drift.velocities}
    return {name + "_" if name in taken else name: values for name, values in found.items()}


def constraints_json(run: Simulation) -> doc.Constraints | UnsetType:
    """What simulation.json says; nothing without constraints."""
    known, closed, drift = run.dynamics.constraints, run.closed, run.drift
    if known is None or closed is None or drift is None:
        return UNSET
    positions, velocities = drift.largest
    return doc.Constraints(
        rows=[name.label for name in known.names],
        left_out=[name.label for name in known.redundant],
        free_velocities=known.freedom,
        start=doc.Start(
            closest=closed.closest,
            fixed=list(closed.fixed),
            moved={move.name: doc.Moved(given=move.given, taken=move.found) for move in closed.moves},
        ),
        drift=doc.Drift(positions=positions, velocities=velocities),
        singular=list(run.trajectory.work.singular),
        stepped_over=list(run.stepped_over),
    )
