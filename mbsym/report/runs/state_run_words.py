"""What is said of a run in the variables that a description declares: which they are, and how well lengths are kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import UNSET, UnsetType

from mbsym.expressions.message import Message
from mbsym.model.states import InStates
from mbsym.numerics.states import StateDynamics, has_quaternions, norm_drifts
from mbsym.report.documents import simulation as doc

if TYPE_CHECKING:
    from mbsym.simulation import Simulation


def norm_columns(run: Simulation) -> Mapping[str, Any]:
    """``e_drift`` for every quaternion and unit vector e: how far its products are from 1 and 0; none otherwise."""
    dynamics = run.dynamics
    if not isinstance(dynamics, StateDynamics):
        return {}
    taken = dynamics.inputs
    drifts = norm_drifts(dynamics, run.trajectory.states)
    return {f"{name}_drift" + "_" * (f"{name}_drift" in taken): values for name, values in drifts.items()}


def state_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(title, text) of the summary's lines; none for a run in coordinates of a system that declares nothing else."""
    system = run.system
    if not isinstance(system, InStates):
        if run.given is not None and run.given.system.speeds:
            yield "variables", Message("coordinates and their velocities; speeds are computed from them")
        return
    assert system.described is not None
    positions, speeds = ", ".join(system.positions), ", ".join(system.own_speeds)
    yield "variables", Message("[[positions]]; [[speeds]], as declared", positions=positions, speeds=speeds)
    columns = norm_columns(run)
    if columns:
        worst = max(float(np.max(values)) for values in columns.values())
        if has_quaternions(system.described):
            text = (
                "norms of quaternions are restored after every step; left of their drift at the rows: [[drift]] at most"
            )
        else:
            text = "unit vectors are restored after every step; left of their drift at the rows: [[drift]] at most"
        yield "drift", Message(text, drift=f"{worst:.1e}")


def states_json(run: Simulation) -> doc.Variables | UnsetType:
    """What simulation.json says; nothing for a run in coordinates."""
    if not isinstance(run.system, InStates):
        return UNSET
    drifts = {name: float(np.max(values)) for name, values in norm_columns(run).items()}
    return doc.Variables(
        positions=list(run.system.positions),
        speeds=list(run.system.own_speeds),
        norm_drift=drifts,
    )
