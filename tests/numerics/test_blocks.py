"""Stretches of steps in machine code: the same motion as by single steps, closed forms, and what must not be passed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods import landing as blocks
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.landing import Blocks, LandingRun
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
)
SPRING = "  - potential: x**2/2\n"
ROWS = np.linspace(0, 100, 1001)[1:]


def run_of(method: str, loads: str, start: str = "1") -> Any:
    system = mbsym.loads(f"{LINE}{loads}initial: {{x: {start}}}\n").system
    setting = Setting(None, 0.005) if METHODS[method].traits.fixed else Setting(1e-10)
    return METHODS[method].start(Dynamics(scenario(system)), setting)


def force(text: str) -> str:
    return f"{SPRING}  - generalized force:\n      x: {text}\n"


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The lengths of the blocks that are taken."""
    taken: list[float] = []
    plain = LandingRun._block

    def block(self: LandingRun, rows: Any) -> Any:
        start, found = self.time, plain(self, rows)
        if found is not None:
            taken.append(found.end - start)
        return found

    monkeypatch.setattr(LandingRun, "_block", block)
    return taken


@pytest.mark.parametrize("method", ["dop853", "rk45", "rk4"])
@pytest.mark.parametrize("load", ["-0.01*tanh(x_dot/0.0001)", "500*pulse(t, 90, 90.002)", "exp(-3600*(t - 90)**2)"])
def test_blocks_change_nothing(method: str, load: str, counted: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows come from the same steps by other code of the same polynomials: the last digit may differ, the number of
    steps does not."""
    run = run_of(method, force(load))
    found = run.fill(ROWS)
    assert sum(counted) > 2
    monkeypatch.setattr(LandingRun, "_block", lambda self, rows: None)
    other = run_of(method, force(load))
    assert np.max(np.abs(found - other.fill(ROWS))) < 3e-14
    assert run.work.steps == other.work.steps
    assert run.passed.switches == other.passed.switches


@pytest.mark.parametrize("method", ["dop853", "rk45", "rk4"])
def test_periods_of_a_well_with_an_edge(method: str, counted: list[float]) -> None:
    """x'' = -sign x from rest at x0 = 50: back after 4 sqrt(2 x0) = 40."""
    found = run_of(method, "  - potential: abs(x)\n", "50").fill(ROWS)
    assert counted or method == "dop853"  # whose steps are as long as the way from edge to edge
    assert np.max(np.abs(found[0] - well(ROWS, 50.0))) < 1e-8


def well(times: Any, start: float) -> Any:
    """x'' = -sign x: parabolas between the passages of x = 0 at sqrt(2 x0), 3 sqrt(2 x0), ..."""
    half = 2 * (2 * start) ** 0.5
    count, rest = np.divmod(times + half / 2, half)
    return (-1.0) ** count * (start - (rest - half / 2) ** 2 / 2)


@pytest.mark.parametrize("method", ["dop853", "rk45", "rk4"])
def test_friction_stops_after_a_known_number_of_half_periods(method: str, counted: list[float]) -> None:
    """x'' = -x - 0.021 sign x': each half period takes 0.042 from the amplitude, until 1 - 24*0.042 = -0.008 holds."""
    found = run_of(method, force("-0.021*sign(x_dot)")).fill(ROWS)
    assert counted
    assert found[:, -1] == pytest.approx([1 - 24 * 0.042, 0], abs=1e-7)


@pytest.mark.parametrize("method", ["rk45", "rk4"])
def test_a_switch_in_a_block_is_found(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Were blocks taken without a look, the edge would be passed on the wrong side: the closed form sees it."""
    monkeypatch.setattr(Blocks, "_free", lambda self, probes, states: True)
    try:
        found = run_of(method, "  - potential: abs(x)\n", "50").fill(ROWS)
    except Exception:  # or the run notices that it is on another side
        return
    assert np.max(np.abs(found[0] - well(ROWS, 50.0))) > 1.0


def test_a_narrow_load_in_a_block_is_met(monkeypatch: pytest.MonkeyPatch) -> None:
    """A push of 2 ms at t = 90.0137 changes x' by its impulse; blocks that do not look for it pass it by."""
    load, impulse = force("1e4*exp(-((t - 90.0137)/0.00005)**2)"), 1e4 * 5e-5 * np.pi**0.5
    wanted = -np.sin(100) + impulse * np.cos(100 - 90.0137)
    assert run_of("dop853", load).fill(ROWS)[1, -1] == pytest.approx(wanted, abs=1e-6)
    monkeypatch.setattr(blocks, "harmless", lambda kind, found: np.ones(found.shape[:-1], bool))
    assert abs(run_of("rk45", load).fill(ROWS)[1, -1] - wanted) > 0.1


@pytest.mark.parametrize("method", ["dop853", "rk45", "rk4", "rodas5p", "radau", "bdf", "taylor"])
def test_every_method_counts_the_same_events_where_friction_holds(method: str) -> None:
    """x'' = -x - 0.3 sign x' from x = 1: x' passes zero at pi, x = -0.4, and comes to rest at 2 pi, x = -0.2."""
    if method == "taylor":
        pytest.importorskip("heyoka")
    analysis = mbsym.loads(f"{LINE}{force('-0.3*sign(x_dot)')}initial: {{x: 1}}\n")
    more = {"step": 0.01} if METHODS[method].traits.fixed else {}
    found = mbsym.simulate(analysis, 20, method=method, events=["x_dot = 0"], **more).events
    assert found.times == pytest.approx([0, np.pi, 2 * np.pi], abs=1e-7)
    assert list(found.turns) == [-1, 1, -1]
    assert found.states[0] == pytest.approx([1, -0.4, -0.2], abs=1e-7)
