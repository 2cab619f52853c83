"""Runs that change their method on the way: what they compute, when they change, and that nothing else changes."""

from __future__ import annotations

from math import log

import numpy as np
import pytest
from conftest import SHIPPED, VAN_DER_POL

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events import switching
from mbsym.numerics.events.switching import Switching
from mbsym.numerics.methods.interface import Breakdown, Cause, Setting
from mbsym.numerics.methods.runge_kutta import METHODS as COMPILED
from mbsym.numerics.scenario import scenario

EXPLICIT = next(method for method in COMPILED if method.traits.name == "dop853")
IMPLICIT = next(method for method in COMPILED if method.traits.name == "rodas5p")

#: x'' = -L(t) (x' - cos t) - sin t has the solution sin t whatever L is (after Prothero & Robinson, 1974); L is large
#: between t = 30 and t = 70.
LATE = """
mbsym: 1
name: a force that is stiff for a while
parameters: {L: positive}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -L*exp(-((t - 50)/20)**64)*(x_dot - cos(t)) - sin(t)}
values: {L: 10000000}
initial: {x: {position: 0, velocity: 1}}
"""

#: A block that begins at rest, where its friction jumps; it stops at pi, 2 pi, 3 pi and stays at 1/2.
BLOCK = """
mbsym: 1
name: a block with dry friction
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
  - generalized force: {x: -sign(x_dot)}
initial: {x: 11/2}
"""


def test_a_jump_at_the_first_state_is_not_stiffness() -> None:
    given = Dynamics(scenario(mbsym.loads(BLOCK).system))
    decay, frequency = switching.rates(given)
    assert decay < 1e-6
    assert abs(frequency - 1) < 1e-6
    run = mbsym.simulate(mbsym.loads(BLOCK), 12)
    assert run.method == "dop853"
    assert "stiff: " not in run.why
    assert abs(run["x"][-1] - 0.5) < 1e-9
    assert len(repr(run)) < 120  # a line in a notebook, not every row of the table


def test_stiffness_that_comes_late_and_goes_again() -> None:
    run = mbsym.simulate(mbsym.loads(LATE), 100, estimate=False)  # it is held against sin and cos
    assert run.whole
    changes = run.trajectory.work.changes
    assert [one.method for one in changes] == ["rodas5p", "dop853"]
    assert 20 < changes[0].time < 50 < changes[1].time < 80
    assert np.max(np.abs(run["x"] - np.sin(run.times))) < 1e-7
    assert np.max(np.abs(run["x_dot"] - np.cos(run.times))) < 1e-7
    assert run.trajectory.work.steps < 400_000


def test_without_the_change_the_same_motion_takes_a_thousand_times_as_many_steps() -> None:
    dynamics = Dynamics(scenario(mbsym.loads(LATE).system))
    with pytest.raises(Breakdown, match=Cause.STEP_LIMIT):
        EXPLICIT.start(dynamics, Setting(1e-10, step_limit=2_000_000)).advance(100)


def test_a_change_to_a_wrong_state_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """The control: the implicit run goes on a little beside where the explicit one was."""
    dynamics = Dynamics(scenario(mbsym.loads(LATE).system))
    method = Switching(EXPLICIT, IMPLICIT)

    def error() -> float:
        found = method.start(dynamics, Setting(1e-8)).fill(np.linspace(0, 33, 12))
        return float(np.max(np.abs(found[0] - np.sin(np.linspace(0, 33, 12)))))

    right = error()
    original = switching.SwitchingRun._turned

    def forgetful(self, stiff, time, state, *sizes):  # type: ignore[no-untyped-def]
        original(self, stiff, time, np.asarray(state) + (np.array([0.1, 0.0]) if stiff else 0), *sizes)

    monkeypatch.setattr(switching.SwitchingRun, "_turned", forgetful)
    assert right < 1e-6 < 1e-2 < error()


def test_half_a_relaxation_oscillation_of_van_der_pol_at_a_hundred_thousand() -> None:
    """T = (3 - 2 ln 2) mu + 7.01432 mu**(-1/3) + O(ln mu / mu) (Haag; Dorodnitsyn), from zero to zero half of it."""
    mu = 1e5
    run = mbsym.simulate(mbsym.loads(VAN_DER_POL), 1.3e5, events="x = 0", tolerance=1e-9, estimate=False)
    assert run.whole
    assert run.events is not None
    assert len(run.events) == 3
    period = 2 * (run.events.times[2] - run.events.times[1])
    assert period == pytest.approx((3 - 2 * log(2)) * mu + 7.01432 * mu ** (-1 / 3), abs=4 * log(mu) / mu)
    assert run.trajectory.work.changes[0].method == "rodas5p"
    assert run.trajectory.work.steps < 100_000


@pytest.mark.parametrize("way", ["fill", "advance", "step"])
def test_where_nothing_is_stiff_it_is_the_explicit_method_to_the_last_bit(way: str) -> None:
    dynamics = Dynamics(scenario(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system))
    explicit = EXPLICIT
    times = np.linspace(0, 40, 77)
    states = []
    for method in (explicit, Switching(explicit, IMPLICIT)):
        run = method.start(dynamics, Setting(1e-10))
        if way == "fill":
            states.append(np.hstack([run.fill(times[:40]), run.fill(times[40:])]))
        elif way == "advance":
            states.append(np.array([run.advance(float(t)) for t in times]).T)
        else:
            states.append(np.array([run.step().end for _ in range(700)]))
        assert run.work.changes == []
    assert np.array_equal(*states)


def test_all_ways_to_ask_for_a_run_that_changes_agree() -> None:
    dynamics = Dynamics(scenario(mbsym.loads(LATE).system))
    method = Switching(EXPLICIT, IMPLICIT)
    times = np.linspace(0, 100, 41)
    rows = method.start(dynamics, Setting(1e-9)).fill(times)
    run = method.start(dynamics, Setting(1e-9))
    assert np.allclose(rows, np.array([run.advance(float(t)) for t in times]).T, rtol=0, atol=1e-7)
    run, found = method.start(dynamics, Setting(1e-9)), []
    while run.time < 100:
        piece = run.step()
        assert piece.end > piece.start
        found.append(np.max(np.abs(piece(np.linspace(piece.start, piece.end, 5)) - _exact(piece.start, piece.end))))
    assert max(found) < 1e-6


def _exact(start: float, end: float) -> object:
    times = np.linspace(start, end, 5)
    return np.array([np.sin(times), np.cos(times)])


def test_a_run_that_begins_stiff_goes_back_to_explicit_steps() -> None:
    early = LATE.replace("((t - 50)/20)**64", "(t/20)**64")
    run = mbsym.simulate(mbsym.loads(early), 200, estimate=False)  # it is held against sin
    assert np.max(np.abs(run["x"] - np.sin(run.times))) < 1e-7
    assert run.trajectory.work.steps < 100_000
    assert run.method == "rodas5p"
    assert run.trajectory.work.changes[0].method == "dop853"


def test_the_limit_of_steps_counts_both_methods() -> None:
    dynamics = Dynamics(scenario(mbsym.loads(LATE).system))
    run = Switching(EXPLICIT, IMPLICIT).start(dynamics, Setting(1e-10, step_limit=1500))
    with pytest.raises(Breakdown, match=Cause.STEP_LIMIT):
        run.fill(np.linspace(0, 100, 11))
    assert run.work.steps <= 1500 + switching.WINDOW + switching.TRIAL
