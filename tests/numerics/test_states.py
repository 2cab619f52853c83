"""Runs in the variables that descriptions declare, against exact solutions and against the same runs in angles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, reference

import mbsym
from mbsym.analysis import Analysis
from mbsym.numerics.conservation import Standing
from mbsym.numerics.methods.interface import Unusable
from mbsym.numerics.states import StateDynamics, norm_drifts

FREE = """
mbsym: 1
name: Free rigid body
parameters: {{I1: positive, I2: positive, I3: positive}}
values: {{I1: {0}, I2: {1}, I3: {2}}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [3, 2, 1], angles: [a, b, c]}}
    mass: 0
    inertia about: joint
    inertia: {{tensor: [I1, I2, I3], accept: true}}
    speeds: {{w1: omega1, w2: omega2, w3: omega3}}
    orientation: quaternion
initial: {{a: {{position: 0, velocity: {5}}}, b: {{position: 0, velocity: {4}}}, c: {{position: 0, velocity: {3}}}}}
"""


@pytest.fixture(scope="module")
def jacobi() -> Analysis:
    return mbsym.loads(FREE.format("1/2", 2, 3, 1, 0, "9/10"))


@pytest.mark.parametrize(
    ("method", "how", "error"),
    [
        ("dop853", {"tolerance": 1e-14}, 2e-15),
        ("radau", {"tolerance": 1e-13}, 2e-13),
        ("rodas5p", {"tolerance": 1e-13}, 2e-13),
        ("rk4", {"step": 1e-3}, 2e-12),
        ("taylor", {"tolerance": 1e-15}, 2e-15),
    ],
)
def test_a_free_rigid_body_against_jacobis_functions(
    jacobi: Analysis, method: str, how: dict[str, Any], error: float
) -> None:
    """Hairer, Norsett and Wanner's problem at t = 1, to near rounding; with steps of one length as the order says."""
    if method == "taylor":
        pytest.importorskip("heyoka")
    exact = [float(x) for x in reference("free_rigid_body")["reference"]["hnw"]["t1"]]
    run = mbsym.simulate(jacobi, 1.0, method=method, samples=11, estimate=False, **how)
    assert [run[name][-1] for name in ("w1", "w2", "w3")] == pytest.approx(exact, abs=error)
    assert np.max(norm_drifts(run.dynamics, run.trajectory.states)["e"]) < 1e-15  # type: ignore[arg-type]


def product(a: Any, b: Any) -> Any:
    return np.array([a[0] * b[0] - a[1:] @ b[1:], *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


def symmetric(w: Any, transverse: float, axial: float, t: float) -> Any:
    """The quaternion of a free symmetric body that begins at (1, 0, 0, 0): about L at rate |L|/A, then about its axis
    at (1 - C/A) w3.
    """
    momentum = np.array([transverse * w[0], transverse * w[1], axial * w[2]])
    turn, own = np.linalg.norm(momentum) * t / transverse / 2, (1 - axial / transverse) * w[2] * t / 2
    about = momentum / np.linalg.norm(momentum)
    first = np.array([np.cos(turn), *(np.sin(turn) * about)])
    return product(first, np.array([np.cos(own), 0.0, 0.0, np.sin(own)]))


def test_a_body_tumbles_through_the_singular_position_of_its_angles() -> None:
    """It passes the pole of {3, 2, 1} at about 1e-7: angles lose digits there and take many steps, e does not."""
    w = (1e-7, 1.0, 1e-7)
    analysis, errors, steps = mbsym.loads(FREE.format(2, 2, 3, *w)), {}, {}
    for variables in ("declared", "coordinates"):
        run = mbsym.simulate(analysis, 6.0, tolerance=1e-12, samples=7, estimate=False, variables=variables)
        found, exact = np.array([run[f"e{k}"][-1] for k in range(4)]), symmetric(w, 2.0, 3.0, 6.0)
        errors[variables] = min(np.max(np.abs(found - exact)), np.max(np.abs(found + exact)))
        steps[variables] = run.trajectory.work.steps
    assert errors["declared"] < 2e-13
    assert errors["coordinates"] > 1e3 * errors["declared"]
    assert steps["declared"] < 100 < steps["coordinates"]


def test_lengths_are_kept_because_they_are_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    """With large steps of a method of low order; without the restoring the norm drifts, and is told to."""
    analysis = mbsym.loads(FREE.format(2, 3, 4, 1, 2, 3))
    drifts = []
    for restored in (True, False):
        if not restored:
            monkeypatch.setattr(StateDynamics, "correction", None)
        run = mbsym.simulate(analysis, 20.0, method="rk4", step=0.05, samples=101, estimate=False)
        drifts.append(np.max(norm_drifts(run.dynamics, run.trajectory.states)["e"]))  # type: ignore[arg-type]
    assert drifts[0] < 1e-6  # rows between the ends of steps are those of a cubic, led back as well
    assert drifts[0] < 1e-3 * drifts[1]


def test_kovalevskayas_integral_along_a_run() -> None:
    """(p^2 - q^2 - k gamma1)^2 + (2 p q - k gamma2)^2 with A = B = 2 C, k = m g x0/C (force -g along gamma)."""
    text = """
mbsym: 1
name: Kovalevskaya's top
parameters: {C: positive, m: positive, g: positive, x0: positive}
values: {C: 1, m: 1, g: 2, x0: 3/4}
bodies:
  - name: top
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [x0, 0, 0]
    mass: m
    inertia about: joint
    inertia: {tensor: [2*C, 2*C, C], accept: true}
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
initial:
  psi: {position: 0, velocity: 1/2}
  theta: {position: 1, velocity: 1/3}
  phi: {position: 1/2, velocity: 1}
"""
    run = mbsym.simulate(mbsym.loads(text), 20.0, tolerance=1e-12, samples=401, estimate=False)
    p, q, k = run["p"], run["q"], 1.5
    kept = {
        sign: (p**2 - q**2 + sign * k * run["gamma1"]) ** 2 + (2 * p * q + sign * k * run["gamma2"]) ** 2
        for sign in (1, -1)
    }
    spreads = {sign: float(np.ptp(values) / np.max(values)) for sign, values in kept.items()}
    assert spreads[-1] < 1e-10
    assert spreads[1] > 1e-2  # the wrong sign is no integral


def test_the_same_motion_as_in_angles() -> None:
    path = SHIPPED / "clebsch-poisson.yaml"
    runs = [
        mbsym.simulate(path, 3.0, tolerance=1e-12, samples=31, estimate=False, invariants=True, variables=variables)
        for variables in ("declared", "coordinates")
    ]
    assert runs[0].dynamics.inputs[1:4] == ("alpha1", "alpha2", "alpha3")
    assert set(runs[0].speeds) == set(runs[1].speeds)
    for name in runs[0].speeds:
        assert np.allclose(runs[0][name], runs[1][name], rtol=0, atol=1e-11)
    assert np.allclose(runs[0].energy, runs[1].energy, rtol=1e-11)
    assert runs[0].conservation.standing is Standing.PROVED
    momentum = next(kept for kept in runs[0].invariants if kept.column == "angular_momentum_3")
    assert momentum.conservation.change < 1e-11


def test_an_energy_that_changes_is_said_to() -> None:
    """T - U of a satellite that turns in its orbit is not conserved, T2 - T0 - U is."""
    run = mbsym.simulate(SHIPPED / "gravity-gradient-quaternion.yaml", 1500.0, samples=101, estimate=False)
    assert run.conservation.standing is Standing.PROVED
    assert run.energy_conservation.standing is Standing.CHANGING


@pytest.mark.parametrize("variables", ["declared", "coordinates"])
def test_no_energy_contains_the_gyrostatic_term(variables: str) -> None:
    """T = 1/2 omega . I omega = (1/2 + 2 2^2 + 3 4^2)/2 of a free gyrostat, told on a table that turns at the rate 1.

    omega . (I omega + h)' = 0: T is constant, and h . omega, 5 4 at first, is not in it.
    """
    text = FREE.format("1/2", 2, 3, 1, 2, 3).replace("speeds:", "gyrostatic moment: [0, 0, 5]\n    speeds:")
    table = "  - {name: table, attached to: 0, mass: 0, rotation: {axes: [3], angles: [s]}}\n"
    text = text.replace("attached to: 0", "attached to: table").replace("bodies:\n", f"bodies:\n{table}")
    analysis = mbsym.loads(text + "prescribed: {s: {rate: 1}}\n")
    run = mbsym.simulate(analysis, 1.0, tolerance=1e-12, samples=5, estimate=False, variables=variables)
    assert not run.dynamics.natural
    assert run.energy == pytest.approx(np.full(5, 28.25), rel=1e-10)


def test_events_are_in_the_declared_variables(jacobi: Analysis) -> None:
    """w1 = cn vanishes a quarter of the period after the start."""
    run = mbsym.simulate(jacobi, 2.0, tolerance=1e-13, samples=11, estimate=False, events="w1 = 0 falling")
    quarter = float(reference("free_rigid_body")["reference"]["hnw"]["period"]) / 4
    assert run.events is not None
    assert list(run.events.times) == pytest.approx([quarter], abs=1e-11)
    with pytest.raises(ValueError, match="unknown name 'a'"):
        mbsym.simulate(jacobi, 2.0, events="a = 0")


@pytest.mark.parametrize("method", ["midpoint", "lsoda"])
def test_methods_that_do_not_apply_are_refused(jacobi: Analysis, method: str) -> None:
    how = {"step": 0.01} if method == "midpoint" else {}
    with pytest.raises(Unusable, match=method):
        mbsym.simulate(jacobi, 1.0, method=method, **how)


def test_there_is_no_third_choice_of_variables(jacobi: Analysis) -> None:
    with pytest.raises(ValueError, match="no choice of variables angles: choose from declared, coordinates"):
        mbsym.simulate(jacobi, 1.0, variables="angles")


CHAIN = """
mbsym: 1
name: A body on a turning table, an arm on the body
parameters: {m: positive, g: positive, k: positive, c: positive}
values: {m: 2, g: 9.81, k: 3, c: 1/5}
prescribed: {chi: {rate: 2, initial: 3/10}}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - name: base
    attached to: table
    rotation: {axes: [3, 1, 3], angles: [a, b, d]}
    connection point: [x, 0, z]
    coordinates: [x, z, a, b, d]
    mass: m
    mass centre: [1/10, 0, 1/5]
    inertia about: mass centre
    inertia: [3/10, 2/5, 1/2]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {e: quaternion}
  - name: arm
    attached to: base
    connection point: [7/10, 0, 1/10]
    rotation: {axes: [1, 2, 3], angles: [u, v, w]}
    mass: m/3
    mass centre: [0, 3/10, 0]
    inertia about: mass centre
    inertia: [1/10, 2/15, 1/6]
    speeds: {p2: omega1, q2: omega2, r2: omega3}
    orientation: {h: 2}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {z: -c*sign(z_dot)}
initial:
  x: {position: 0.1, velocity: 0.2}
  z: {position: 0, velocity: 1}
  a: {position: 0.3, velocity: 1}
  b: {position: 1, velocity: 0.5}
  d: {position: 0.2, velocity: 2}
  u: {position: 0.1, velocity: 1}
  v: {position: 0.4, velocity: -1}
  w: {position: 0.3, velocity: 0.3}
"""


def test_a_tree_of_such_bodies_with_dry_friction_on_a_base_that_turns() -> None:
    """Quaternion and unit vectors, translations besides, a force that jumps, something prescribed: as in angles."""
    analysis = mbsym.loads(CHAIN, (3,))
    runs = [
        mbsym.simulate(analysis, 1.0, tolerance=1e-11, samples=11, estimate=False, variables=variables)
        for variables in ("declared", "coordinates")
    ]
    for name in analysis.system.variables:
        assert np.allclose(runs[0][name], runs[1][name], rtol=0, atol=1e-9)
    assert runs[0].conservation.standing is Standing.CHANGING
    assert max(float(np.max(x)) for x in norm_drifts(runs[0].dynamics, runs[0].trajectory.states).values()) < 1e-14  # type: ignore[arg-type]


def test_a_base_that_dry_friction_holds_stays_beneath_a_body_that_spins() -> None:
    """Upright the top turns about its axis alone: e0 = cos(s t/2), e3 = sin(s t/2); what rests gets its size by M."""
    text = """
mbsym: 1
name: a top told by a quaternion on a cart with dry friction
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}
  - {name: top, attached to: cart, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 1,
     mass centre: [0, 0, 1/2], inertia about: joint, inertia: [1, 1, 0.2], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {e: quaternion}}
loads: [{uniform gravity: {vector: [0, 0, -9.81]}}, {generalized force: {x: -sign(x_dot)}}]
initial: {x: 0, e0: 1, e1: 0, e2: 0, e3: 0, p: 0, q: 0, s: 3}
"""
    run = mbsym.simulate(mbsym.loads(text), 1.0, samples=3, estimate=False)
    assert [run[name][-1] for name in ("x", "e0", "e3")] == pytest.approx([0, np.cos(1.5), np.sin(1.5)], abs=1e-9)
