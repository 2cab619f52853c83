"""Rows of constraints are found once, whoever asks: counted, and what depends on the start is found anew."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED, derived

import mbsym
from mbsym.mechanics.constraints import programs
from mbsym.mechanics.constraints.rows import constraint_rows
from mbsym.numerics import constrained
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.scenario import scenario


def test_an_analysis_makes_the_program_of_its_rows_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside the one in which they are analysed, before it is known which of them are independent."""
    made = []

    def counted(*given: object) -> object:
        made.append(given)
        return constraint_rows(*given)  # type: ignore[arg-type]

    analysis = mbsym.load(SHIPPED / "four-bar.yaml", (1, 2, 3, 7))
    monkeypatch.setattr(programs, "constraint_rows", counted)
    assert all(check.outcome == "exact" or check.outcome == "verified numerically" for check in analysis.checks)
    assert len(made) == 2


def test_rows_are_listed_once_for_a_start_and_the_one_it_is_led_to(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = []
    conditions = constrained.conditions
    monkeypatch.setattr(constrained, "conditions", lambda *given: listed.append(given) or conditions(*given))
    given = scenario(mbsym.load(SHIPPED / "four-bar.yaml").system)
    moved = replace(given, positions=(given.positions[0] + Fraction(1, 10), *given.positions[1:]))
    led = closed(moved).scenario
    assert led.positions != moved.positions
    there, here = Dynamics(led).constraints, Dynamics(moved).constraints
    assert len(listed) == 1
    assert there is not None
    assert here is not None
    # Each knows its own start: only the one that was led keeps the rows.
    assert np.allclose(there.at(0.0, there._start).positions, 0.0, atol=1e-12)
    assert not np.allclose(here.at(0.0, here._start).positions, 0.0, atol=1e-3)


def test_other_numbers_have_rows_of_their_own() -> None:
    given = scenario(derived(SHIPPED / "four-bar.yaml").system)
    name = next(iter(given.parameters))
    other = replace(given, parameters={**given.parameters, name: 2 * given.parameters[name]})
    state = [float(x) for x in given.state]
    ours, theirs = Dynamics(given).constraints, Dynamics(other).constraints
    assert ours is not None
    assert theirs is not None
    assert not np.allclose(ours.weights(0.0, state), theirs.weights(0.0, state)) or not np.allclose(
        ours.at(0.0, state).positions, theirs.at(0.0, state).positions
    )
