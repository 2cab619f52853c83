"""Trajectories against published, exact and certified ones: the whole way from the description to the numbers.

References: Kane's babyboot, the torque-free rigid body (Jacobi's functions, 20 digits), a pendulum (Jacobi's cd), a
spring along its line (sine), the satellite with a stabilizer, the tethered satellites (28 digits), the gyrostat and the
satellite with a damper (30 digits each).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import cos, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import OWN, SHIPPED, filed, parsed, reference, system_of

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.simulate import Trajectory, simulate

PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: 1, L: 1, g: 9.81}
bodies:
  - name: rod
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -L, 0]
    mass: m
loads:
  - uniform gravity: {vector: [0, -g, 0]}
initial: {theta: -pi/2}
"""

BODY = """
mbsym: 1
name: Free body
parameters: {I1: positive, I2: positive, I3: positive}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [1, 2, 3], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: [I1, I2, I3]
"""


def dynamics_of(path: Path, **values: object) -> Dynamics:
    """The description with some values replaced."""
    system = system_of(path)
    return Dynamics(scenario(system, {name: parsed(str(value)) for name, value in values.items()}))


def written(folder: Path, text: str) -> Path:
    return filed(folder / "system.yaml", text)


def run(dynamics: Dynamics, times: Sequence[Any], tolerance: float = 1e-13, scalar: str = "float64") -> Trajectory:
    """The trajectory at 0 and the times."""
    moments = [0.0, *(float(Fraction(t)) for t in times)]
    found = simulate(dynamics, METHODS["dop853"], Setting(tolerance=tolerance), moments, scalar)
    assert found.whole, found.breakdown
    return found


def state(found: Trajectory, place: int) -> dict[str, float]:
    """Coordinates and velocities by name; the place counts from the first time after 0."""
    names = [*found.system.coordinates, *found.system.velocities]
    return dict(zip(names, found.states[:, place + 1].astype(float), strict=True))


def angular_velocity(s: dict[str, float], a: str, b: str, c: str, axes: tuple[int, int, int]) -> Any:
    """In the body's axes, from the angles a, b, c about the numbered axes, turned in this order."""
    omega = np.zeros(3)
    for name, axis in zip((a, b, c), axes, strict=True):
        i, j = axis % 3, (axis + 1) % 3
        x = s[name]
        omega[i], omega[j] = cos(x) * omega[i] + sin(x) * omega[j], -sin(x) * omega[i] + cos(x) * omega[j]
        omega[axis - 1] += s[name + "_dot"]
    return omega


# --- one and two degrees of freedom ---


def test_pendulum_of_the_iftomm_benchmark(tmp_path: Path) -> None:
    truth = reference("iftomm_a01_pendulum")["reference"]
    found = run(dynamics_of(written(tmp_path, PENDULUM)), list(truth["xy"]))
    for place, (x, y) in enumerate(truth["xy"].values()):
        theta = state(found, place)["theta"]
        assert abs(sin(theta) - float(x)) < 1e-11
        assert abs(-cos(theta) - float(y)) < 1e-11
    assert np.max(np.abs(found.energy)) < 1e-11  # the benchmark's own measure: it starts at zero


def test_pendulum_is_periodic(tmp_path: Path) -> None:
    period = reference("iftomm_a01_pendulum")["reference"]["period"]
    found = run(dynamics_of(written(tmp_path, PENDULUM)), [period, f"{10 * Fraction(period)}"])
    for place in (0, 1):
        s = state(found, place)
        assert abs(s["theta"] + pi / 2) < 1e-11
        assert abs(s["theta_dot"]) < 1e-10


def test_spring_along_its_line_and_its_equilibrium() -> None:
    """With theta = 0 the bob swings about r0 = l0 + m g/k with the frequency sqrt(k/m), exactly."""
    m, k, l0, g = 1.0, 40.0, 1.0, 9.81
    times = [0.1, 0.5, 2, 20]
    moving = run(dynamics_of(SHIPPED / "spring-pendulum.yaml", theta=0, r="l0 + m*g/k", r_dot=0.3), times)
    resting = run(dynamics_of(SHIPPED / "spring-pendulum.yaml", theta=0, r="l0 + m*g/k"), times)
    r0, omega = l0 + m * g / k, sqrt(k / m)
    for place, t in enumerate(times):
        assert abs(state(moving, place)["r"] - (r0 + 0.3 / omega * sin(omega * t))) < 1e-11
        assert state(moving, place)["theta"] == 0
        assert abs(state(resting, place)["r"] - r0) < 1e-12


def test_small_swings_of_the_spring_pendulum() -> None:
    """theta swings with sqrt(g/r0) where the swing is small: the relative error is of second order."""
    r0 = 1 + 9.81 / 40
    quarter = pi / 2 / sqrt(9.81 / r0)
    dynamics = dynamics_of(SHIPPED / "spring-pendulum.yaml", theta=Fraction(1, 10**5), r="l0 + m*g/k")
    found = run(dynamics, [Fraction(quarter)], 1e-15)
    assert abs(state(found, 0)["theta"]) < 1e-14


@pytest.mark.parametrize(
    ("scalar", "tolerance", "bound"), [("float64", 1e-9, 1e-2), ("float64", 1e-14, 1e-7), ("extended", 1e-17, 1e-10)]
)
def test_babyboot(scalar: str, tolerance: float, bound: float) -> None:
    """Errors grow a million times in these ten seconds: the bounds follow tolerance and arithmetic."""
    if not available(scalar):
        pytest.skip(f"this machine has no {scalar} arithmetic")
    content = reference("kane_babyboot")
    given = {name: value for name, value in content["parameters"].items() if name[0] in "gILm"}
    dynamics = dynamics_of(OWN / "babyboot.yaml", **given, IAy=1, IAz=1, qA="pi/2", qB="pi/180")
    found = run(dynamics, [10], tolerance, scalar)
    truth, s = content["reference"]["recomputed"], state(found, 0)
    assert abs(s["qA"] - radians(float(truth["qA_deg"]))) < bound
    assert abs(s["qB"] - radians(float(truth["qB_deg"]))) < bound
    assert abs(s["qA_dot"] - float(truth["qAp"])) < 10 * bound
    assert abs(s["qB_dot"] - float(truth["qBp"])) < 10 * bound


# --- the free rigid body ---

FREE = reference("free_rigid_body")


def free(folder: Path, inertia: Sequence[object], omega: Sequence[object]) -> Dynamics:
    """A body that starts with its axes along those of space, where the rates of the angles are the angular velocity."""
    numbers = dict(zip(("I1", "I2", "I3"), inertia, strict=True))
    angles = ("psi", "theta", "phi")
    rates = {f"{name}_dot": value for name, value in zip(angles, omega, strict=True)}
    return dynamics_of(written(folder, BODY), **numbers, **dict.fromkeys(angles, 0), **rates)


def test_free_body_of_basilisk(tmp_path: Path) -> None:
    given = FREE["parameters"]["basilisk"]
    found = run(free(tmp_path, given["I"], given["omega0"]), [given["t"]])
    omega = angular_velocity(state(found, 0), "psi", "theta", "phi", (1, 2, 3))
    truth = [float(x) for x in FREE["reference"]["basilisk"]["omega"]]
    assert np.max(np.abs(omega - truth)) < 1e-8  # eight digits are printed


@pytest.mark.parametrize(
    ("rates", "start", "inertia", "known"),
    [
        (("-2", "5/4", "-1/2"), (1, 0, Fraction(9, 10)), (1, 2, Fraction(5, 2)), {1: "t1", 10: "t10", 20: "t20"}),
        (("1", "-1", "-51/100"), (0, 1, 1), (2, Fraction(5, 2), 1), {20: None}),
    ],
)
def test_free_bodies_by_jacobis_functions(
    rates: tuple[str, str, str], start: Sequence[Any], inertia: Sequence[Any], known: dict[int, str], tmp_path: Path
) -> None:
    """y_i' = c_i y_j y_k is Euler's equation of any body with the right order of moments, in scaled components.

    With y_i = s_i omega_i and k_1 = (I2 - I3)/I1 and so on: c_1 = k_1 s_1/(s_2 s_3), hence s_3^2 = k_1 k_2/(c_1 c_2).
    """
    c = [Fraction(x) for x in rates]
    moments = [Fraction(x) for x in inertia]
    k = [(moments[i - 2] - moments[i - 1]) / moments[i] for i in range(3)]
    squares = [k[i - 2] * k[i - 1] / (c[i - 2] * c[i - 1]) for i in range(3)]
    assert all(square > 0 for square in squares)
    signs = [1, 1, 1]
    if k[0] * c[0] < 0:  # the product of the scales has the sign that Euler's equations want
        signs[0] = -1
    s = [sign * sqrt(square) for sign, square in zip(signs, squares, strict=True)]
    scaled = [f"{sign}*({y})/sqrt({square})" for sign, y, square in zip(signs, start, squares, strict=True)]
    found = run(free(tmp_path, moments, scaled), list(known))
    for place, name in enumerate(known.values()):
        omega = angular_velocity(state(found, place), "psi", "theta", "phi", (1, 2, 3))
        truth = FREE["reference"]["hnw"][name] if name else FREE["reference"]["detest_b5"]
        assert np.max(np.abs(omega * s - [float(x) for x in truth])) < 1e-10


# --- the systems of the papers ---


def test_satellite_with_a_stabilizer() -> None:
    """The reference itself is good to 1e-10 up to t = 20, to 2e-9 at t = 40."""
    truth = reference("satellite-trajectory")
    found = run(dynamics_of(SHIPPED / "satellite.yaml"), truth["t"][1:])
    assert list(found.states[:, 0].astype(float)) == truth["y0"]
    for place, t in enumerate(truth["t"]):
        bound = 2e-10 if t <= 20 else 4e-9
        assert np.max(np.abs(found.states[:, place] - truth["y"][place])) < bound


@pytest.mark.parametrize(("variant", "d"), [("table1", 4), ("uniform", 25)])
def test_tethered_satellites(variant: str, d: int) -> None:
    states = reference("tethered-satellites")["trajectories"][variant]["states"]
    found = run(dynamics_of(SHIPPED / "tethered-satellites.yaml", d_Ccm1=d, d_Dcm2=d), [s["t"] for s in states[1:]])
    assert found.times[-1] == 60
    for place, truth in enumerate(states[1:]):
        s = state(found, place)
        for name in found.system.coordinates:
            size = max(1.0, abs(float(truth["q"][name])))
            assert abs(s[name] - float(truth["q"][name])) < 1e-9 * size, (truth["t"], name)
            assert abs(s[name + "_dot"] - float(truth["qdot"][name])) < 1e-9 * size, (truth["t"], name)
        assert abs(found.energy[place + 1] / float(truth["energy"]) - 1) < 1e-12


def test_the_step_of_the_paper_against_a_tolerance() -> None:
    """The paper integrates by Runge and Kutta's fourth order in steps of 1 ms: 240,000 evaluations for 60 s.

    Its error is that of rounding by then; steps that follow a tolerance (of the largest values so far) are as good in a
    fiftieth of the evaluations.
    """
    states = reference("tethered-satellites")["trajectories"]["table1"]["states"]
    dynamics = dynamics_of(SHIPPED / "tethered-satellites.yaml")
    truth = np.array(
        [[float(s[part][name]) for s in states] for part in ("q", "qdot") for name in dynamics.system.coordinates]
    )
    size = np.max(np.abs(truth), axis=1, keepdims=True)
    times = [float(s["t"]) for s in states]
    evaluations = []
    for name, setting in (("rk4", Setting(step=1e-3)), ("dop853", Setting(tolerance=5e-12))):
        found = simulate(dynamics, METHODS[name], setting, times)
        assert np.max(np.abs(found.states - truth) / size) < 3e-11, name
        evaluations.append(found.work.evaluations)
    assert evaluations[0] == pytest.approx(240_000, rel=1e-3)
    assert evaluations[1] < evaluations[0] / 50


@pytest.mark.parametrize("case", ["clean_E1_simple_ic", "clean_E0_no_gyrostat_simple_ic"])
def test_gyrostat(case: str) -> None:
    content = reference("gyrostat")[case]
    rows = [row for row in content["rows"] if Fraction(row["t"]) > 0]
    given = {name: content["parameters"][name] for name in ("lx", "lz")}
    found = run(dynamics_of(SHIPPED / "gyrostat.yaml", **given), [row["t"] for row in rows])
    for place, row in enumerate(rows):
        s = state(found, place)
        omega = angular_velocity(s, "psi", "theta", "phi", (3, 1, 3))
        truth = [float(row[name]) for name in "pqr"]
        assert np.max(np.abs(omega - truth)) < 1e-9 * max(truth), row["t"]
        direction = [sin(s["theta"]) * sin(s["phi"]), sin(s["theta"]) * cos(s["phi"]), cos(s["theta"])]
        assert np.max(np.abs(direction - np.array([float(row[n]) for n in ("gamma", "gammap", "gammapp")]))) < 1e-9


@pytest.mark.parametrize("case", ["S_stable", "U_unstable", "U2_strong_unstable", "S2_strong_stable"])
def test_satellite_with_a_damper(case: str) -> None:
    """The relations turn the reduced parameters into masses, moments of inertia and the rotor's rate."""
    content = reference("satellite-with-damper-trajectories")["sets"][case]
    given = content["parameters"]
    chosen = {name: given[name] for name in ("s", "rho", "e")}
    chosen |= {"Lambda": content["lambda"], "p2": content["p2"], "dc": given["delta"]}
    # h = Ja (omega + sigma') = eta A with Ja = 36, A = 198 and omega = 1.
    rows = content["rows"]
    spin = Fraction(198, 36) * Fraction(given["eta"]) - 1
    dynamics = dynamics_of(SHIPPED / "satellite-with-damper.yaml", **chosen, sigma_dot=spin)
    assert dynamics.scenario.parameters["Omega"] == spin
    found = run(dynamics, [row["t"] for row in rows[1:]])
    for place, row in enumerate(rows[1:]):
        s = state(found, place)
        omega = angular_velocity(s, "c", "a", "b", (3, 1, 2))
        ours = [omega[2], omega[0], omega[1], s["z"], s["z_dot"]]
        truth = [float(row[name]) for name in ("omega", "omega1", "omega2", "x", "y")]
        assert np.max(np.abs(np.array(ours) - truth)) < 1e-9, row["t"]


# --- a planted error is seen ---


def test_a_wrong_value_is_noticed() -> None:
    truth = reference("satellite-trajectory")
    found = run(dynamics_of(SHIPPED / "satellite.yaml", Jx="2.4 + 1e-7"), truth["t"][1:])
    assert np.max(np.abs(found.states[:, -1] - truth["y"][-1])) > 1e-8
