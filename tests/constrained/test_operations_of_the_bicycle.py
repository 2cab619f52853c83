"""The bicycle's nonlinear right-hand side by the straight-line program: within 1900 operations."""

from __future__ import annotations

from conftest import SHIPPED

import mbsym
from mbsym.mechanics.constraints.dynamics import Chosen, constrained_dynamics
from mbsym.mechanics.programs import constants


def test_the_right_hand_side_of_the_bicycle_takes_no_more_than_1900_operations() -> None:
    """All accelerations, of dependent coordinates too; what depends on parameters alone is computed once."""
    analysis = mbsym.load(SHIPPED / "bicycle.yaml", (3,))
    found = analysis.constraints
    kept = [(found.names[i].constraint, found.names[i].component) for i in found.independent]
    dynamics = constrained_dynamics(analysis.system, analysis.ring, Chosen(tuple(kept)))
    assert len(dynamics.accelerations) == 8
    assert dynamics.program.operations(dynamics.accelerations, constants(analysis.system)) <= 1900
