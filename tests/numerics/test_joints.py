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
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.reference_search import whole_reference
from mbsym.numerics.scenario import scenario
from mbsym.numerics.switching import rates

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


@pytest.mark.slow
@pytest.mark.parametrize("force", [PUSH, SMOOTH, DRY])
def test_references_know_of_switches_and_narrow_loads(force: str) -> None:
    found = whole_reference(dynamics(force), 20.0, 60.0)
    assert found.error < 1e-9
    assert wrong(force, found.times, found.states[0]) < 1e-9


def test_switches_beyond_the_end_are_not_told() -> None:
    found = mbsym.simulate(mbsym.loads(text("3*step(t - 5.1)")), 5, estimate=False)
    assert found.trajectory.passed is not None
    assert found.trajectory.passed.switches == []
