"""Where steps, switches, narrow loads, estimates and references meet: against closed forms."""

from __future__ import annotations

from functools import cache
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from scipy.special import erf

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.switching import rates
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.trade.reference_search import whole_reference

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
    "  - potential: x**2/2\n  - generalized force:\n      x: FORCE\ninitial: {x: {position: 1}}\n"
)

#: Two milliseconds at t = 5; the same smoothly; a force that comes late; dry friction, which ends at rest.
PUSH, SMOOTH = "100*pulse(t, 5, 5.002)", "100*exp(-((t - 5)/0.001)**2)"
LATE, DRY = "3*step(t - 15)", "-0.3*sign(x_dot)"
FORCES = (PUSH, SMOOTH, LATE, DRY)


def text(force: str) -> str:
    return LINE.replace("FORCE", force)


def exact(force: str, t: float) -> float:
    """x(t) of x'' = -x + force, x(0) = 1, x'(0) = 0."""
    own, width = np.cos(t), 1e-3
    if force == PUSH:
        return float(own + 100 * sum(s * (1 - np.cos(t - a)) for s, a in ((1, 5), (-1, 5.002)) if t > a))
    if force == SMOOTH:  # the imaginary part of the integral of exp(-((s - 5)/width)^2 + i (t - s)) over s < t
        reached = 1 + erf((t - 5) / width + 0.5j * width)
        whole = 50 * sqrt(pi) * width * np.exp(-width * width / 4) * reached * np.exp(1j * (t - 5))
        return float(own + whole.imag)
    if force == LATE:
        return float(own + (3 * (1 - np.cos(t - 15)) if t > 15 else 0))
    if t < pi:
        return float(0.3 + 0.7 * np.cos(t))
    return float(-0.3 - 0.1 * np.cos(t - pi)) if t < 2 * pi else -0.2


@cache
def dynamics(force: str) -> Dynamics:
    return Dynamics(scenario(mbsym.loads(text(force)).system))


def wrong(force: str, times: Any, positions: Any) -> float:
    return float(np.max(np.abs(positions - [exact(force, float(t)) for t in times])))


@pytest.mark.parametrize("method", ["dop853", "rk45"])
@pytest.mark.parametrize("force", FORCES)
def test_where_rows_are_asked_for_changes_no_step(force: str, method: str) -> None:
    """However the rows fall into questions, and whatever a clock says: one and the same motion."""
    times = np.linspace(0, 20, 203)
    whole = METHODS[method].start(dynamics(force), Setting(1e-7)).fill(times)
    for count in (1, 7):
        run = METHODS[method].start(dynamics(force), Setting(1e-7))
        parts = np.hstack([run.fill(times[k : k + count]) for k in range(0, len(times), count)])
        assert np.max(np.abs(parts - whole)) < 1e-14
    assert wrong(force, times, whole[0]) < 1e-5


def test_steps_and_rows_of_one_run_fit_together() -> None:
    run = METHODS["dop853"].start(dynamics(PUSH), Setting(1e-11))
    for row in (0.3, 4.9, 5.001):
        assert wrong(PUSH, [row], run.fill(np.array([row]))[0]) < 1e-8
        piece = run.step()
        assert piece.start == row
        assert piece.end > row
        assert wrong(PUSH, [piece.end], run.state[0]) < 1e-8
        assert run.time == piece.end


def test_nothing_dies_out_fast_because_a_force_jumps() -> None:
    """Differences across the jump of dry friction were taken for rates of 3e5, and the scene for a stiff one."""
    assert rates(dynamics(DRY))[0] < 1e-6
    assert "stiff:" not in mbsym.simulate(mbsym.loads(text(DRY)), 10, estimate=False).chosen.why


@pytest.mark.parametrize("force", [PUSH, SMOOTH, DRY])
def test_references_know_of_switches_and_narrow_loads(force: str) -> None:
    found = whole_reference(dynamics(force), 20.0, 60.0)
    assert found.error < 1e-9
    assert wrong(force, found.times, found.states[0]) < 1e-9


def test_switches_beyond_the_end_are_not_told() -> None:
    found = mbsym.simulate(mbsym.loads(text("3*step(t - 5.1)")), 5, estimate=False)
    assert found.trajectory.passed is not None
    assert found.trajectory.passed.switches == []


@pytest.mark.parametrize("force", [PUSH, SMOOTH, DRY])
def test_members_of_an_ensemble_feel_what_is_narrow_and_what_jumps(force: str) -> None:
    """Side by side every member stepped over the push; with dry friction none came to the end."""
    found = mbsym.ensemble(mbsym.loads(text(force)), 20, {"x": (0.9, 1.0, 2)}, samples=3)
    assert not found.fates
    assert found.final[0, 1] == pytest.approx(exact(force, 20.0), abs=1e-8)


def test_a_parameter_that_varies_meets_its_own_push() -> None:
    """x'' = -x + F pulse: what the push adds is proportional to F."""
    named = text("F*pulse(t, 5, 5.002)").replace("bodies:", "parameters: {F: real}\nbodies:") + "values: {F: 1}\n"
    found = mbsym.ensemble(mbsym.loads(named), 20, {"F": (0, 100, 3)}, samples=3)
    own, whole = np.cos(20.0), exact(PUSH, 20.0)
    assert found.final[0] == pytest.approx([own, 0.5 * (own + whole), whole], abs=1e-8)


def test_the_longest_step_holds_for_many_motions_and_for_derivatives() -> None:
    from mbsym.numerics.ensembles.variation import Grid
    from mbsym.numerics.scenario import scenario as given
    from mbsym.simulation import Request
    from mbsym.simulation.ensembles import Spread, simulate_many

    one = given(mbsym.loads(text("sin(t)")).system)
    found = simulate_many(one, Spread(Request(8.0, longest=0.01), (Grid("x", 0.5, 1.0, 2),)))
    assert found.setting.longest == 0.01
    assert found.steps >= 2 * 800
