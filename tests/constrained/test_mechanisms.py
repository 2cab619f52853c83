"""Mechanisms of the literature in numbers: Andrews' squeezer, the car axis, N four-bars, a pendulum on its circle."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import reference, system_of
from scipy.integrate import solve_ivp

from mbsym.numerics.conservation import Standing
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods import led as bridge
from mbsym.numerics.methods.interface import Cause, compiled_kernel
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.simulation import Request, simulate
from mbsym.simulation.accurate import simulate_accurately

TESTS = Path(__file__).parents[1]


def shipped(name: str) -> Scenario:
    system = system_of(TESTS / "systems" / f"{name}.yaml")
    return scenario(system)


def described(text: str) -> Scenario:
    system = system_of(text)
    return scenario(system)


# --- Andrews' squeezer ---

ANGLES = ("beta", "Theta", "gam", "Phi", "delta", "Omega", "epsilon")


def test_the_squeezer_starts_as_published() -> None:
    """Accelerations at t = 0 to the digits of Hairer & Wanner; five of the seven are zero."""
    given = shipped("andrews-squeezer")
    truth = dict(zip(ANGLES, [*reference("andrews_squeezer")["parameters"]["initial_acc"], 0], strict=False))
    rhs = compiled_kernel(Dynamics(given), "right_hand_side")(np.array([0.0, *map(float, given.state)]))
    for name, found in zip(given.system.coordinates, rhs[7:], strict=True):
        assert found == pytest.approx(float(truth[name]), rel=1e-12, abs=1e-9)


@pytest.mark.parametrize(("tolerance", "error"), [(4e-9, 2e-9), (1e-12, 1e-12)])
def test_the_squeezer_at_three_hundredths_of_a_second(tolerance: float, error: float) -> None:
    """The best published run reaches 2e-11; angles turn through 15.8 rad, rates are 1e3."""
    truth = reference("andrews_squeezer")["reference"]["recomputed_t003"]
    asked = Request(0.03, method="dop853", tolerance=tolerance, samples=31, estimate=False)
    found = simulate(shipped("andrews-squeezer"), asked)
    assert found.whole
    for place, name in enumerate(ANGLES):
        assert found[name][-1] == pytest.approx(float(truth["q"][place]), abs=error)
        assert found[f"{name}_dot"][-1] == pytest.approx(float(truth["v"][place]), rel=20 * error)
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-14
    # Its multipliers, in the order and with the signs of the rows here: both loops are closed at E.
    dynamics, state = found.dynamics, found.trajectory.states[:, -1]
    forces = compiled_kernel(dynamics, "multipliers")(np.array([0.03, *state]))
    published = [float(x) for x in truth["lam"]]
    assert sorted(np.abs(forces)) == pytest.approx(sorted(np.abs(published)), rel=1e-7 if error < 1e-11 else 1e-3)
    assert found.conservation.standing is Standing.CHANGING  # the motor works


def test_an_accuracy_of_the_squeezer_is_kept() -> None:
    """At t = 0.03, beside the published state: within the bound of the plan, each of its size in the motion."""
    truth = reference("andrews_squeezer")["reference"]["recomputed_t003"]
    found = simulate_accurately(shipped("andrews-squeezer"), Request(0.03, samples=301), Accuracy(1e-6))
    assert found.plan is not None
    assert found.plan.reached
    bound = found.plan.bound.total
    for place, name in enumerate(ANGLES):
        for key, value in ((name, truth["q"][place]), (f"{name}_dot", truth["v"][place])):
            assert abs(found[key][-1] - float(value)) <= bound * np.max(np.abs(found[key]))


# --- a constraint with a prescribed motion ---


def test_the_car_axis() -> None:
    truth = [float(x) for x in reference("ivp_caraxis")["reference"]["y"][:8]]
    found = simulate(shipped("car-axis"), Request(3.0, tolerance=1e-12, estimate=False))
    # Eleven digits of the reference are to be trusted.
    assert list(found.trajectory.states[:, -1]) == pytest.approx(truth, abs=2e-11)
    assert found.conservation.standing is Standing.CHANGING


# --- N four-bars: singular positions, redundant constraints ---


def four_bars(number: int) -> str:
    """Bars on a line of bearings, links between their ends, upright at first; with angles relative to the last body."""
    bar = "mass: m, inertia about: mass centre, inertia: [0, 0, m*L**2/12]"
    lines = ["mbsym: 1", "name: Four-bars", "parameters: {m: 1, L: 1, g: 9.81}", "bodies:"]
    for i in range(number + 1):
        place = f"connection point: [{i}*L, 0, 0], rotation: {{axes: [3], angles: [th{i}]}}, mass centre: [0, L/2, 0]"
        lines.append(f"  - {{name: bar{i}, attached to: 0, {place}, {bar}}}")
        if i < number:
            place = f"connection point: [0, L, 0], rotation: {{axes: [3], angles: [ph{i}]}}, mass centre: [L/2, 0, 0]"
            lines.append(f"  - {{name: link{i}, attached to: bar{i}, {place}, {bar}}}")
    lines += ["loads:", "  - uniform gravity: {vector: [0, -g, 0]}", "constraints:"]
    for i in range(number):
        lines.append(f"  - coincide: [{{body: link{i}, point: [L, 0, 0]}}, {{body: bar{i + 1}, point: [0, L, 0]}}]")
    lines.append("initial:")
    lines += [f"  th{i}: {{position: 0, velocity: -1}}" for i in range(number + 1)]
    lines += [f"  ph{i}: {{position: 0, velocity: 1}}" for i in range(number)]
    return "\n".join(lines)


@pytest.mark.parametrize(("tolerance", "error"), [(1e-8, 1e-6), (1e-10, 1e-8), (5e-13, 2e-11)])
def test_four_bars_pass_positions_in_which_their_branches_meet(tolerance: float, error: float) -> None:
    """All bars come in line where th0 is a quarter turn; coarse steps may pass over that, fine ones are carried over.

    The parallelogram is a pendulum, (3/3 + 2) th'' = (3/2 + 2) g/L sin th by hand: its passages by th = pi/2, 3 pi/2,
    ... are counted, and with fine steps each of them is told, in the one way or the other.
    """
    truth = reference("iftomm_a02_n_four_bar")["reference"]["recomputed"]
    found = simulate(described(four_bars(2)), Request(10.0, tolerance=tolerance, samples=11, method="dop853"))
    assert found.whole, found.ended
    for when in (1, 2, 5, 10):
        x, y = (float(value) for value in truth["N=2"][str(when)])
        assert [-np.sin(found["th0"][when]), np.cos(found["th0"][when])] == pytest.approx([x, y], abs=error)
    if tolerance <= 1e-12:
        pendulum = solve_ivp(
            lambda t, x: [x[1], 3.5 / 3 * 9.81 * np.sin(x[0])],
            (0, 10),
            [0, -1],
            rtol=1e-10,
            events=lambda t, x: np.cos(x[0]),
        )
        carried = found.trajectory.work.singular
        assert len(carried) >= 3
        assert sorted([*carried, *found.stepped_over]) == pytest.approx(pendulum.t_events[0], abs=1e-3)
    assert found.conservation.standing is Standing.PROVED
    assert found.conservation.change < 100 * tolerance + 1e-12
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-13


def test_where_no_way_leads_over_it_the_position_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Never silently wrong: without the polynomial the run ends before the position, in a state that is right."""
    monkeypatch.setattr("mbsym.numerics.methods.led.bridge", lambda *_: None)
    found = simulate(described(four_bars(2)), Request(10.0, tolerance=1e-12, samples=1001, method="dop853"))
    assert found.ended is not None
    assert found.ended.kind == Cause.SINGULAR_CONSTRAINTS
    assert np.cos(found["th0"][-1]) == pytest.approx(0, abs=2e-3)  # in line
    assert found.conservation.change < 1e-11


def test_a_branch_that_does_not_fit_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A polynomial whose end is off by a part in a thousand is no motion: the way is not taken."""
    fitted = bridge._Fitted.__call__

    def bent(self: Any, times: Any) -> Any:
        return fitted(self, times) * (1 + 1e-3 * np.sign(np.arange(10) - 4.5))[:, None]

    monkeypatch.setattr(bridge._Fitted, "__call__", bent)
    found = simulate(described(four_bars(2)), Request(10.0, tolerance=1e-12, samples=11, method="dop853"))
    assert found.ended is not None
    assert found.ended.kind == Cause.SINGULAR_CONSTRAINTS
    assert found.conservation.change < 1e-11


def test_bricard_moves_though_a_count_of_its_rows_says_that_it_cannot() -> None:
    """Five angles and five rows, one of which follows from the others: one freedom (Baker, Mech. Mach. Theory, 1980).

    Its trihedral form with right angles keeps  cos A + cos B + cos A cos B = 0  between neighbouring hinges, and every
    second hinge turns alike; here A = pi/2 - a1, B = pi/2 + a2.
    """
    found = simulate(shipped("bricard"), Request(10.0, tolerance=1e-12, samples=201))
    known = found.dynamics.constraints
    assert known is not None
    assert (len(known), len(known.redundant), known.freedom) == (5, 1, 1)
    a = [found[f"a{k}"] for k in range(1, 6)]
    assert np.max(np.abs(a[0])) > 1
    one, two = np.sin(a[0]), -np.sin(a[1])
    assert np.max(np.abs(one + two + one * two)) < 1e-13
    assert np.max(np.abs(a[0] + a[2])) < 1e-12
    assert np.max(np.abs(a[1] + a[3])) < 1e-12
    assert np.max(np.abs(a[0] + a[4])) < 1e-12
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-13  # of the row that is left out, too
    assert found.conservation.standing is Standing.PROVED
    assert found.conservation.change < 1e-10


# --- the shape of SUNDIALS' table ---


def test_a_pendulum_returns_after_fifteen_periods() -> None:
    """Exactly 2 seconds each; SUNDIALS with projection is off by 1.8e-6 in y at 1e-9, and we shall not be worse."""
    known = reference("sundials_pendulum_tradeoff")
    text = f"""
mbsym: 1
name: Pendulum
parameters: {{m: 1, g: {known["parameters"]["g"]}}}
bodies:
  - {{name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}}
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
constraints:
  - relation: x**2 + y**2 = 1
initial: {{x: 1, y: 0}}
"""
    published = known["reference"]["published_errors_at_30"]
    for tolerance in ("1e-5", "1e-7", "1e-9"):
        for method in ("dop853", "rk45"):
            found = simulate(described(text), Request(30.0, method=method, tolerance=float(tolerance), samples=3))
            errors = np.abs(found.trajectory.states[:, -1] - [1, 0, 0, 0])
            assert np.all(errors < published[f"{tolerance} projected"][:4]), (tolerance, method, errors)


# --- a chain ---


def chain(number: int) -> str:
    """Point masses in Cartesian coordinates on rods of length 1."""
    names = [f"x{i}, y{i}" for i in range(number)]
    lines = ["mbsym: 1", "name: Chain", "parameters: {m: 1, L: 1, g: 9.81}", "bodies:"]
    for i in range(number):
        place = f"connection point: [x{i}, y{i}, 0], coordinates: [{names[i]}]"
        lines.append(f"  - {{name: b{i}, attached to: 0, mass: m, {place}}}")
    lines += ["loads:", "  - uniform gravity: {vector: [0, -g, 0]}", "constraints:"]
    for i in range(number):
        other = f"{{body: b{i - 1}, point: [0, 0, 0]}}" if i else "{body: 0, point: [0, 0, 0]}"
        lines.append(f"  - distance: {{between: [{{body: b{i}, point: [0, 0, 0]}}, {other}], length: L}}")
    lines.append(f"initial: {{{', '.join(f'x{i}: {i + 1}, y{i}: 0' for i in range(number))}}}")
    return "\n".join(lines)


def test_a_chain_of_ten_pendulums_takes_seconds() -> None:
    """Equations and machine code (PyDy's issue 536: 3906 s); the operations grow as its length does."""
    started = time.process_time()
    dynamics = Dynamics(described(chain(10)))
    compiled_kernel(dynamics, "right_hand_side")
    assert time.process_time() - started < 20
    assert dynamics.right_hand_side.operations < 12 * Dynamics(described(chain(2))).right_hand_side.operations
    found = simulate(described(chain(3)), Request(1.0, tolerance=1e-11, samples=11))
    assert found.conservation.standing is Standing.PROVED
    assert found.conservation.change < 1e-8
    # The first bob alone falls freely at first: rods that are level and at rest pull nothing.
    start = compiled_kernel(dynamics, "right_hand_side")(np.array([0.0, *map(float, dynamics.scenario.state)]))
    assert start[20:] == pytest.approx([0, -9.81] * 10, abs=1e-12)
