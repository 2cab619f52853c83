"""The ledger of systems with constraints or speeds says nothing that holds of open trees alone."""

from __future__ import annotations

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.numerics.ledger.table import OF_ANY_SYSTEM, ledger
from mbsym.numerics.planning.kinds import Kind


@pytest.mark.parametrize("name", ["rolling-disc", "four-bar", "gyrostat-poisson"])
def test_no_momentum_is_called_constant_because_a_coordinate_is_not_in_the_lagrangian(name: str) -> None:
    """Rolling acts on x, y and spin; the loop on q1, which does not occur in T either."""
    analysis = mbsym.load(SHIPPED / f"{name}.yaml")
    kinds = {saving.kind for saving in ledger(analysis).savings}
    assert Kind.CYCLIC not in kinds
    assert kinds <= OF_ANY_SYSTEM


def test_it_is_said_of_an_open_tree() -> None:
    kinds = {saving.kind for saving in ledger(mbsym.load(SHIPPED / "spherical-pendulum.yaml")).savings}
    assert Kind.CYCLIC in kinds
