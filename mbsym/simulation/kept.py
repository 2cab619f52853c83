"""How far a run keeps its energies and first integrals, and how it is known that they are constant."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from mbsym.numerics.columns import columns
from mbsym.numerics.conservation import (
    Conservation,
    Measure,
    Standing,
    between_switches,
    confronted,
    energy_standing,
    standing,
    visited,
)
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.invariants import invariants, values
from mbsym.numerics.linearised import LinearisedDynamics
from mbsym.simulation.result import Kept

if TYPE_CHECKING:
    from mbsym.numerics.simulate import Trajectory


def energies(dynamics: Dynamics, found: Trajectory, held: Collection[str]) -> tuple[Conservation, Conservation]:
    """Of T2 - T0 - U, and of T - U; the coordinates ``held`` provably rest."""
    points = _seen(found, "change", found.change)
    scale, near = found.energy_scale, _near(found)
    if isinstance(dynamics, LinearisedDynamics):
        # The energy is that of the whole system, the motion that of the linear equations: no theorem joins them.
        known, doubt = standing(dynamics, dynamics.relative_energy, 0, points, held, near)
    else:
        known, doubt = energy_standing(dynamics, points, scale / max(float(found.times[-1]), 1e-300), held, near)
    moving = Measure.KINETIC if found.largest_kinetic else Measure.INITIAL
    measure = moving if moving is Measure.KINETIC or found.generalized_energy[0] else Measure.UNIT
    if dynamics.natural:
        same = confronted("energy", known, found.change, scale, doubt, measure)
        return same, same
    generalized = confronted("generalised energy", known, found.change, scale, doubt, measure)
    known, doubt = standing(dynamics, dynamics.energies, 0, _seen(found, "energy", found.energy), held, near)
    return generalized, confronted("energy", known, found.energy, scale, doubt, measure)


def _seen(found: Trajectory, name: str, values: Any) -> Any:
    """States of a run at which a quantity changes most, and others: among all rows, where these are some of them."""
    return visited(found.times, found.states, values) if found.table is None else found.table.visited[name]


def _near(found: Trajectory) -> list[list[float]]:
    """States beside the motion, where something acts for less than the distance of two rows."""
    met = found.passed
    return [] if met is None else between_switches(found.times, found.states, met.switches, met.inside)


def kept_integrals(
    dynamics: Dynamics, found: Trajectory, integrals: tuple[Any, ...], held: Collection[str], dense: Trajectory
) -> tuple[Kept, ...]:
    """First integrals at the rows of ``found``; judged along ``dense``, the same run with places between its rows.

    One that is not proved is looked at where the run goes.
    """
    if not integrals:
        return ()
    known = invariants(dynamics, integrals, columns(dynamics.system, dynamics.natural))
    shown, seen = (list(values(known, run.times, run.states)) for run in (found, dense))
    kept = []
    for item, (column, _), (along, size) in zip(known, shown, seen, strict=True):
        state, doubt = Standing.PROVED, None
        if not item.proved or isinstance(dynamics, LinearisedDynamics):
            state, doubt = standing(dynamics, item.code, 0, _seen(dense, item.column, along), held, _near(dense))
        kept.append(
            Kept(item.column, column, confronted(item.name, state, along, size, doubt, Measure.TERMS), item.unit)
        )
    return tuple(kept)
