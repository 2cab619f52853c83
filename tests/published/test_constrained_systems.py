"""Constrained systems against published numbers and closed forms, through the equations without multipliers."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED
from flint import arb

import mbsym
from mbsym.analysis.constrained import programs_of
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import Formula
from mbsym.mechanics.rest import given_values
from mbsym.problems.checks import EXACT, NUMERICAL

REFERENCES = Path(__file__).parents[1] / "references"
NAMES = ("four-bar", "rolling-disc", "chaplygin-sleigh", "rolling-sphere", "cartesian-pendulum")


@cache
def analysis_of(name: str) -> Analysis:
    return mbsym.load(SHIPPED / f"{name}.yaml", (1, 2, 3))


def reference(name: str) -> Any:
    return json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))


class AtState:
    """Formulas of an analysis in double precision, at given numbers for coordinates and independent velocities."""

    def __init__(self, name: str, state: Mapping[str, float]) -> None:
        self.analysis = analysis_of(name)
        found = self.analysis.equations.constraints
        assert found is not None
        assert found.solved is not None
        self.found, self.solved = found, found.solved
        zeros = dict.fromkeys(self.analysis.ring.names(), 0.0)
        given = {key: float(value) for key, value in given_values(self.analysis.system, {}).items()}
        self.values: dict[str, float] = {**zeros, **given, **state}
        free = [self.values[f"{key}_dot"] for key in found.free]
        velocities = self.matrix(self.solved.transformation) @ free + self.column(self.solved.shift)
        self.values |= {f"{key}_dot": x for key, x in zip(found.coordinates, velocities, strict=True)}

    def __call__(self, formula: Formula) -> float:
        return float(self.analysis.ring.evaluate(formula.polynomial, {k: arb(v) for k, v in self.values.items()}).mid())

    def matrix(self, rows: Any) -> Any:
        return np.array([[self(x) for x in row] for row in rows])

    def column(self, items: Any) -> Any:
        return np.array([self(x) for x in items])

    @property
    def velocities(self) -> Any:
        return np.array([self.values[f"{key}_dot"] for key in self.found.coordinates])

    @property
    def accelerations(self) -> Any:
        """q'' = Y u' + a0."""
        embedded = self.analysis.equations.embedded
        assert embedded is not None
        rates = np.linalg.solve(self.matrix(embedded.mass_matrix), self.column(embedded.forcing))
        return self.matrix(self.solved.transformation) @ rates + self.column(self.solved.acceleration_shift)

    @property
    def with_multipliers(self) -> Any:
        """q'' of M q'' = f + J^T lambda, J q'' + gamma = 0, from the straight-line program: another route."""
        code = programs_of(self.analysis)
        n, m = len(self.found.coordinates), len(self.found.independent)
        rows = [code.jacobian[i] for i in self.found.independent]
        nodes = [x for row in code.tree.mass_matrix for x in row] + [x for row in rows for x in row]
        nodes += [*code.tree.forcing, *(code.acceleration[i] for i in self.found.independent)]
        numbers = {k: arb(v) for k, v in self.values.items()} | {"pi": arb.pi()}
        from mbsym.algebra.point import Balls

        values = np.array([float(x.mid()) for x in code.tree.program.evaluate(nodes, numbers, Balls(numbers))])
        mass, jacobian = values[: n * n].reshape(n, n), values[n * n : n * n + m * n].reshape(m, n)
        right = np.concatenate([values[n * n + m * n :][:n], -values[n * n + m * n + n :]])
        whole = np.block([[mass, -jacobian.T], [jacobian, np.zeros((m, m))]])
        return np.linalg.solve(whole, right)[:n]


@pytest.mark.parametrize("name", NAMES)
def test_the_self_check_holds(name: str) -> None:
    outcomes = {check.name: check.outcome for check in analysis_of(name).checks}
    wanted = NUMERICAL if name == "cartesian-pendulum" else EXACT
    assert outcomes["constraints"] == outcomes["constrained motion"] == wanted
    assert set(outcomes.values()) <= {EXACT, NUMERICAL}


def test_the_four_bar_has_the_published_accelerations() -> None:
    published = reference("sympy_four_bar")
    q, u = (list(map(float, published["parameters"][key])) for key in "qu")
    at = AtState("four-bar", {"q1": q[0], "q2": q[1], "q3": q[2], "q1_dot": u[0]})
    wanted = published["reference"]
    assert at.found.free == ("q1",)
    assert at.velocities == pytest.approx(u, abs=1e-12)
    assert at.accelerations == pytest.approx([float(x) for x in wanted["accelerations"]], abs=1e-11)
    assert at.with_multipliers == pytest.approx(at.accelerations, abs=1e-12)
    rows = [[float(x) for x in row] for row in wanted["published_rows"]]
    mass = at.matrix(at.analysis.equations.mass_matrix)
    assert (at.matrix(at.solved.transformation).T @ mass)[0] == pytest.approx(rows[0], abs=1e-10)
    jacobian = at.matrix(at.found.jacobian)
    assert np.abs(jacobian) == pytest.approx(np.abs(rows[1:]), abs=1e-12)  # their loop is closed the other way round


@pytest.mark.parametrize("case", ["case1", "case2"])
def test_the_rolling_disc_has_the_published_accelerations(case: str) -> None:
    """In the components of the angular velocity along the disc's own axes, in which they are printed."""
    published = reference("sympy_rolling_disc")
    given, wanted = published["parameters"][case], [float(x) for x in published["reference"][case]]
    yaw, lean, spin = (float(x) for x in given["q"][:3])
    place = {"yaw": yaw, "lean": lean, "spin": spin} | {key: float(given[key]) for key in ("m", "r", "g")}
    disc = analysis_of("rolling-disc").kinematics.body("disc")
    names = ("yaw", "lean", "spin")
    still = AtState("rolling-disc", place)
    turning = np.array(
        [
            [
                still(Formula(still.analysis.ring, still.analysis.ring.velocity_derivative(x.polynomial, name)))
                for name in names
            ]
            for x in disc.angular_velocity
        ]
    )
    rates = np.linalg.solve(turning, [float(x) for x in given["u"]])
    at = AtState("rolling-disc", place | {f"{name}_dot": x for name, x in zip(names, rates, strict=True)})
    x, y, *angles = at.velocities
    assert [*angles, x, y] == pytest.approx(wanted[:5], abs=1e-13)
    accelerations = at.accelerations
    assert at.with_multipliers == pytest.approx(accelerations, abs=1e-12)
    ring = at.analysis.ring
    slopes = np.array(
        [[at(Formula(ring, ring.derivative(w.polynomial, name))) for name in names] for w in disc.angular_velocity]
    )
    spins = slopes @ at.velocities[2:] + turning @ accelerations[2:]
    assert spins == pytest.approx(wanted[5:8], abs=1e-12)


def test_the_cartesian_pendulum_follows_the_closed_form() -> None:
    """IFToMM A01: x and y at t = 0.1 by sixteen steps, from rest at (-1, 0)."""
    wanted = [float(x) for x in reference("iftomm_a01_pendulum")["reference"]["xy"]["0.1"]]

    def rate(state: Any) -> Any:
        y, speed = state
        at = AtState("cartesian-pendulum", {"x": -np.sqrt(1 - y * y), "y": y, "y_dot": speed})
        return np.array([speed, at.accelerations[1]])

    state, h = np.array([0.0, 0.0]), 0.1 / 16
    for _ in range(16):  # the classical Runge-Kutta method; its error is of the order h^4
        a = rate(state)
        b = rate(state + h / 2 * a)
        c = rate(state + h / 2 * b)
        state = state + h / 6 * (a + 2 * b + 2 * c + rate(state + h * c))
    assert [-np.sqrt(1 - state[0] ** 2), state[0]] == pytest.approx(wanted, abs=1e-9)


def test_a_sphere_on_a_plane_keeps_its_angular_velocity() -> None:
    """Neimark & Fufaev: omega is constant, the centre is not accelerated."""
    state = {"x": 0.1, "y": -0.3, "z": 0.5, "psi": 0.2, "theta": 1.1, "phi": -0.4}
    at = AtState("rolling-sphere", state | {"psi_dot": 1.0, "theta_dot": 0.3, "phi_dot": -2.0})
    accelerations = at.accelerations
    assert accelerations[:3] == pytest.approx([0, 0, 0], abs=1e-13)
    psi, theta = state["psi"], state["theta"]
    psi1, theta1, phi1 = at.velocities[3:]
    psi2, theta2, phi2 = accelerations[3:]
    # omega in inertial axes: (theta' cos psi + phi' sin theta sin psi, theta' sin psi - phi' sin theta cos psi,
    # psi' + phi' cos theta); its rate, by hand
    s, c, sp, cp = np.sin(theta), np.cos(theta), np.sin(psi), np.cos(psi)
    rate = [
        theta2 * cp - theta1 * psi1 * sp + phi2 * s * sp + phi1 * theta1 * c * sp + phi1 * psi1 * s * cp,
        theta2 * sp + theta1 * psi1 * cp - phi2 * s * cp - phi1 * theta1 * c * cp + phi1 * psi1 * s * sp,
        psi2 + phi2 * c - phi1 * theta1 * s,
    ]
    assert rate == pytest.approx([0, 0, 0], abs=1e-13)


def test_the_sleigh_of_chaplygin_turns_as_in_the_book() -> None:
    """v' = a omega^2,  (J + m a^2) omega' = -m a v omega,  with v along the blade."""
    at = AtState("chaplygin-sleigh", {"theta": 0.4, "x_dot": 1.2 * np.cos(0.4), "theta_dot": 0.7})
    x2, y2, turning = at.accelerations
    v, omega, m, moment, a = 1.2, 0.7, 1.0, 0.5, 0.3
    assert x2 * np.cos(0.4) + y2 * np.sin(0.4) == pytest.approx(a * omega**2, abs=1e-13)
    assert turning == pytest.approx(-m * a * v * omega / (moment + m * a**2), abs=1e-13)
