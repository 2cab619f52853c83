"""The error of simpler models, estimated along their own motion: against closed forms, reruns, and planted lies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED
from scipy.special import ellipj, ellipk

import mbsym
from mbsym.algebra.derivative import directional, jacobian
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.model_choice import ModelEstimate, Propagated, confirmed, model_error
from mbsym.numerics.planning.models import Model, described, droppable, faithful, modelled, orders
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.trade.trial import trial_of

PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: positive, L: positive, g: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -L, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {theta: 0}
values: {m: 1, L: 1, g: 1}
initial: {theta: 1/20}
"""

FINE = Setting(tolerance=1e-13)


def pendulum() -> Scenario:
    return scenario(mbsym.loads(PENDULUM, ()).system)


def satellite() -> Scenario:
    return scenario(mbsym.load(SHIPPED / "satellite.yaml", ()).system)


def exact_pendulum(times: Any) -> Any:
    """sin(theta/2) = k cd(t | k^2), k = sin(theta_0/2), where g = L."""
    k = np.sin(1 / 40)
    sn, _, _, _ = ellipj(ellipk(k * k) - times, k * k)
    return 2 * np.arcsin(k * sn)


def estimate(given: Scenario, simple: Model, rich: Model, times: Any, unit: float = 1e-4) -> tuple[ModelEstimate, Any]:
    """The estimate, and the motion of the richer model."""
    truth = trial_of(METHODS["dop853"], modelled(given, rich), FINE, times).states
    scale = np.max(np.abs(truth), axis=1)
    both = modelled(given, simple), modelled(given, rich)
    return model_error(*both, METHODS["dop853"], Setting(tolerance=1e-11), times, scale, unit), truth


def test_the_error_of_the_linear_pendulum_is_that_of_the_elliptic_function() -> None:
    times = np.linspace(0, 30, 301)
    found, _ = estimate(pendulum(), Model(linear=True), Model(), times)
    true = exact_pendulum(times) - np.cos(times) / 20
    assert found.trusted
    assert np.max(np.abs(found.difference[0] - true)) < 0.01 * np.max(np.abs(true))
    assert found.by_quantity[0] == pytest.approx(np.max(np.abs(true)) * 20, rel=0.01)


@pytest.mark.parametrize("order", [3, 4])
def test_a_lower_order_of_gravity_is_as_wrong_as_a_rerun_says(order: int) -> None:
    times = np.linspace(0, 5, 101)
    found, truth = estimate(satellite(), Model(order), Model("exact"), times, 1e-3)
    own = trial_of(METHODS["dop853"], modelled(satellite(), Model(order)), FINE, times).states
    scale = np.max(np.abs(truth), axis=1)
    measured = np.max(np.abs(truth - own), axis=1) / scale
    assert found.trusted
    assert found.by_quantity == pytest.approx(measured, rel=0.05)
    assert confirmed(found, truth, scale, 1e-10).confirmed


def test_a_difference_of_roundings_rules_no_steps() -> None:
    """At a distance of 100 lengths the fourth order of gravity is 1e-4 of the second, and forces cancel to roundings.

    Ten million steps followed the roundings; the motion itself takes about ten.
    """
    given = scenario(mbsym.load(SHIPPED / "orbital-gyrostat.yaml", ()).system)
    both = modelled(given, Model(2)), modelled(given, Model("exact"))
    setting, ones = Setting(tolerance=1e-9, step_limit=100), np.ones(6)
    found = model_error(*both, METHODS["dop853"], setting, np.linspace(0, 0.5, 11), ones, 1e-6)
    assert found.trusted, found.trouble
    assert found.largest < 1e-12


def test_an_error_that_is_not_small_is_not_trusted() -> None:
    found, _ = estimate(satellite(), Model(2), Model("exact"), np.linspace(0, 10, 101))
    assert not found.trusted
    assert found.trouble


def test_nothing_neglected_is_no_error() -> None:
    found, _ = estimate(pendulum(), Model(), Model(), np.linspace(0, 5, 11))
    assert found.largest == 0


def lost_residual(rich: Any, simple: Any) -> Any:
    """A third of the residual is lost."""
    difference = rich - simple
    return difference + difference + difference


def turned(program: Any, full: Any, states: Any, e: Any) -> list[Any]:
    """The wrong sign."""
    return [-x for x in directional(program, full, states, e)]


@pytest.mark.parametrize(("name", "lie"), [("_residual", lost_residual), ("_carried", turned)])
def test_a_planted_mistake_is_noticed_by_the_rerun(monkeypatch: pytest.MonkeyPatch, name: str, lie: Any) -> None:
    times, given = np.linspace(0, 30, 301), pendulum()
    scale = np.array([0.05, 0.05])
    truth = trial_of(METHODS["dop853"], modelled(given, Model()), FINE, times).states
    honest, _ = estimate(given, Model(linear=True), Model(), times)
    assert confirmed(honest, truth, scale, 1e-9).confirmed
    monkeypatch.setattr(Propagated, name, staticmethod(lie))
    found, _ = estimate(given, Model(linear=True), Model(), times)
    judged = confirmed(found, truth, scale, 1e-9)
    assert judged.confirmed is False
    assert judged.largest >= 0.9 * honest.largest  # the larger of the two counts


def test_a_directional_derivative_is_the_jacobian_times_the_direction() -> None:
    dynamics = Dynamics(satellite())
    code = dynamics.right_hand_side
    program = code.program
    states = [program.input(name) for name in dynamics.inputs[1:]]
    along = [program.input(f"d{k}") for k in range(len(states))]
    inputs = (*dynamics.inputs, *(f"d{k}" for k in range(len(states))))
    swept = Code(program, inputs, directional(program, code.outputs, states, along))
    matrix = jacobian(program, code.outputs, states)
    whole = Code(program, dynamics.inputs, tuple(x for row in matrix for x in row))
    point = np.random.default_rng(3).uniform(-0.5, 0.5, len(inputs))
    n = len(states)
    product = arrays.kernel(whole)(point[: n + 1]).reshape(n, n) @ point[n + 1 :]
    assert arrays.kernel(swept)(point) == pytest.approx(product, rel=1e-11)


def test_models_of_a_scene() -> None:
    given = satellite()
    assert described(given) == Model(2)
    assert faithful(given) == Model("exact")
    assert orders(given) == (2, 3, 4, "exact")
    assert orders(pendulum()) == (None,)
    assert faithful(pendulum()) == described(pendulum()) == Model()
    assert Model(3, True, ("c",)).label == "gravity of order 3, linearised, without c"
    # omega0 and R are tied by a relation and a prescribed motion; nothing can be said of them alone.
    assert set(droppable(given.system)) == {"M2", "m", "m0", "l", "r", "Jx", "Jy", "Jz"}
