"""Linear runs of constrained systems: against closed formulas, problem 5 and whole runs, from which they part as a^2.

Problem 5 is derived in symbols by an expansion of the rows, a run takes the Jacobian of the equations: two routes.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED
from scipy.linalg import expm

import mbsym
from mbsym.expressions.tree import Number
from mbsym.model.system import System
from mbsym.numerics.planning.models import Model
from mbsym.numerics.scenario import exact, scenario
from mbsym.numerics.tangent import NoTangent
from mbsym.simulation import Request, Simulation, simulate
from mbsym.simulation.accurate import read_accuracy, settled_by, simulate_accurately
from tests.constrained.test_constrained_runs import called
from tests.constrained.test_flow_on_the_manifold import CASES, analysed, masses, numbers, trailers

#: A bob on a rod of length 1 in Cartesian coordinates, where it hangs.
PENDULUM = """
mbsym: 1
name: Pendulum in Cartesian coordinates
parameters: {m: 1, g: 1, l: 1}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
constraints:
  - relation: x**2 + y**2 = l**2
motion: {x: 0, y: -l}
initial: {x: 1/10, y: -1}
"""


def run(system: System, time: float, values: dict[str, Any] | None = None, linear: bool = True) -> Simulation:
    given = {name: Number(Fraction(value)) for name, value in (values or {}).items()}
    request = Request(time, samples=11, tolerance=1e-11, model=Model(linear=linear), estimate=False)
    return simulate(scenario(system, given, declared=True), request)


def states(found: Simulation) -> dict[str, Any]:
    names = (*found.system.coordinates, *found.system.velocities)
    return dict(zip(names, np.asarray(found.trajectory.states, dtype=float), strict=True))


@pytest.mark.parametrize("dependent", ["", "dependent: [y]\n"])
def test_a_pendulum_swings_as_a_cosine_at_one_height(dependent: str) -> None:
    """x = x(0) cos t, y = -1, whatever x(0) the given place is led to."""
    found = run(mbsym.loads(PENDULUM.replace("motion:", f"{dependent}motion:")).system, 5.0)
    got = states(found)
    assert got["x"][0] == pytest.approx(0.1, abs=0 if dependent else 1e-3)
    assert got["x"] == pytest.approx(got["x"][0] * np.cos(found.trajectory.times), abs=1e-9)
    assert got["y"] == pytest.approx(-1.0, abs=1e-12)
    assert got["y_dot"] == pytest.approx(0.0, abs=1e-12)
    assert found.drift is not None
    assert 1e-3 < found.drift.largest[0] < 1e-2  # x^2 = a^2 off the rod


def test_an_upright_disc_wobbles_as_appell_and_routh_say() -> None:
    """yaw' = -2 w (lean - lean(0)),  5 r lean'' = 4 g lean + 6 r w yaw',  x' = r w,  y' = r w yaw, at yaw'(0) = 0.

    Moments about the vertical, A yaw'' + C w lean' = 0, and about the contact, with C = 2 A = m r^2/2.
    """
    system = mbsym.load(SHIPPED / "rolling-disc.yaml").system
    zero = dict.fromkeys(("x", "y", "yaw", "spin", "yaw_dot", "lean_dot"), "0")
    found = run(system, 1.0, {**zero, "lean": "1/100", "spin_dot": "5"})
    got, r, g, w = states(found), 0.26, 9.81, 5.0
    t, stiffness = found.trajectory.times, 3 * r * w**2 - g
    middle = 3 * r * w**2 * 0.01 / stiffness
    lean = middle + (0.01 - middle) * np.cos(np.sqrt(4 * stiffness / (5 * r)) * t)
    assert got["lean"] == pytest.approx(lean, abs=1e-9)
    assert got["yaw_dot"] == pytest.approx(-2 * w * (lean - 0.01), abs=1e-9)
    assert got["x_dot"] == pytest.approx(r * w, abs=1e-9)
    assert got["y_dot"] == pytest.approx(r * w * got["yaw"], abs=1e-9)


@pytest.mark.parametrize("dependent", [False, True])
@pytest.mark.parametrize("kind", [trailers, masses])
def test_random_systems_run_as_problem_5_says(kind: Any, dependent: bool) -> None:
    """exp(A t) of the state space, from independent deviations of the size 1e-3; dependent ones to first order."""
    tried = 0
    for seed in range(5):
        text = kind(Random(f"{kind.__name__} {seed}"), dependent)
        analysis = analysed(text) if text else None
        if analysis is None or analysis.reduced.about.leaf:
            continue
        system, space = analysis.system, analysis.state_space
        base = {name: float(found) for name, found in _motion(system).items()}
        begun = {name: Fraction(k + 1, 5000) + Fraction(base[name]) for k, name in enumerate(space.states)}
        found = run(_independent(system, space.states), 0.7, begun)
        got = states(found)
        flow = expm(0.7 * numbers(space.A.polynomials)) @ [got[x][0] - base[x] for x in space.states]
        turned = {name: base[name] + 0.7 * base.get(f"{name}_dot", 0.0) for name in space.states}
        wanted = [turned[name] + x for name, x in zip(space.states, flow, strict=True)]
        assert [got[name][-1] for name in space.states] == pytest.approx(wanted, abs=1e-8), text
        tried += 1
    assert tried >= 2


def _motion(system: System) -> dict[str, Fraction]:
    known = dict.fromkeys((*system.coordinates, *system.velocities), Fraction(0))
    for entry in system.motion:
        known |= {entry.coordinate: exact(entry.value, {}), f"{entry.coordinate}_dot": exact(entry.rate, {})}
    return known


def _independent(system: System, names: tuple[str, ...]) -> System:
    """With the coordinates of no independent speed called dependent, so that a run keeps the others."""
    return replace(system, dependent=tuple(x for x in system.coordinates if f"{x}_dot" not in names))


#: A crank and a rocker of length 1 on a ground and a coupler of length 2, turned by springs: gravity would bend it.
TRAPEZIUM = """
mbsym: 1
name: Trapezium
parameters: {m: 1, k: 3}
bodies:
  - {name: left, attached to: 0, rotation: {axes: [3], angles: [p]}, mass centre: [0, -1, 0], mass: m}
  - {name: rod, attached to: left, connection point: [0, -1, 0], rotation: {axes: [3], angles: [q]},
     mass centre: [1, 0, 0], mass: 2*m, inertia about: mass centre, inertia: [0, 0, m]}
  - {name: right, attached to: 0, connection point: [3, 0, 0], rotation: {axes: [3], angles: [r]},
     mass centre: [0, -1, 0], mass: m}
loads:
  - force function: -k*(p**2 + 2*q**2)/2 + p**3
constraints:
  - distance: {between: [{body: rod, point: [2, 0, 0]}, {body: right, point: [0, -1, 0]}], length: 1}
dependent: [r]
motion: {p: 0, q: 0, r: 0}
initial: {p: 0, q: 0, r: 0}
"""


def apart(system: System, amplitude: str, start: dict[str, tuple[str, str]], time: float) -> float:
    values = {name: Fraction(base) + Fraction(way) * Fraction(amplitude) for name, (base, way) in start.items()}
    whole, linear = (states(run(system, time, values, model)) for model in (False, True))
    return max(float(np.max(np.abs(whole[name] - linear[name]))) for name in whole)


SPEEDS = "speeds: {p: omega1, q: omega2, w: omega3}"

CASES_OF_SMALL = {
    "trapezium": (TRAPEZIUM, {"p": ("0", "1"), "q": ("0", "-1/2"), "q_dot": ("0", "2")}, 2.0),
    "pendulum": (PENDULUM.replace("initial: {x: 1/10,", "dependent: [y]\ninitial: {"), {"x": ("0", "1")}, 3.0),
    "disc": (
        (SHIPPED / "rolling-disc.yaml").read_text(encoding="utf-8"),
        {"lean": ("0", "1"), "yaw": ("0", "1"), "spin_dot": ("5", "3"), "yaw_dot": ("0", "2"), "lean_dot": ("0", "1")},
        1.0,
    ),
    "segway": (
        (CASES / "segway.yaml").read_text(encoding="utf-8"),
        {"tilt": ("0", "1"), "tilt_dot": ("0", "1"), "yaw": ("0", "9"), "pl_dot": ("5", "1"), "pr_dot": ("5", "-2")},
        0.5,
    ),
    "disc in speeds": (
        (SHIPPED / "rolling-disc-speeds.yaml").read_text(encoding="utf-8"),
        {"lean": ("0", "1"), "yaw": ("0", "1"), "spin": ("0", "1"),
         "spin_dot": ("5", "3"), "yaw_dot": ("0", "2"), "lean_dot": ("0", "1")},
        1.0,
    ),
    "ball in a bowl by quaternion": (
        (SHIPPED / "dish-sphere.yaml")
        .read_text(encoding="utf-8")
        .replace("gamma]\n\n", f"gamma]\n    {SPEEDS}\n    orientation: {{e: quaternion}}\n\n")
        .replace("z, alpha, beta]", "x, y, z]"),
        {"x": ("0", "1"), "y": ("0", "-2"), "z": ("-1/2", "0"), "x_dot": ("0", "0"), "y_dot": ("0", "1"),
         "alpha": ("0", "1"), "alpha_dot": ("0", "2"), "beta_dot": ("0", "1"), "gamma_dot": ("1", "1")},
        1.0,
    ),
    "satellite in unit vectors": (
        (SHIPPED / "gravity-gradient-quaternion.yaml").read_text(encoding="utf-8").split("initial:")[0]
        .replace("{e: quaternion}", "{a: 1, b: 2, c: 3}")
        .replace("R: 7000000, omega0: 0.001, nu: 343000000000000", "R: 10, omega0: 1, nu: 1000"),
        {"psi": ("0", "1"), "theta": ("0", "2"), "phi": ("0", "-1"), "psi_dot": ("0", "1"), "phi_dot": ("0", "3")},
        2.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES_OF_SMALL)
def test_what_a_linear_run_leaves_out_falls_as_the_square(name: str) -> None:
    text, start, time = CASES_OF_SMALL[name]
    system = mbsym.loads(text).system
    rough, fine = (apart(system, amplitude, start, time) for amplitude in ("1/1000", "1/2000"))
    assert fine > 1e-8  # no roundings
    assert rough / fine == pytest.approx(4, rel=0.1)


@pytest.mark.parametrize(
    ("orientation", "turns"), [("e: quaternion", 1), ("e: quaternion", -1), ("a: 1, b: 2, c: 3", 1)]
)
def test_declared_variables_run_where_angles_are_singular(orientation: str, turns: int) -> None:
    """A symmetric body that spins at n about its axis, at the pole of 3-1-3: by hand, with k = (C - A) n/A,

        p' = -k q,  q' = k p,  r = n;      c1' = n c2 - q,  c2' = p - n c1  of space's third axis (c1, c2, c3).

    The quaternion -e is the same orientation.
    """
    n, k = 2.0, 1.0
    start = "a1: 0.8, a2: 0, a3: 0.6, b1: 0, b2: 1, b3: 0, c1: -0.6, c2: 0, c3: 0.8"
    if "quaternion" in orientation:
        start = f"e0: {turns * 0.8}, e1: 0, e2: {turns * 0.6}, e3: 0"
    text = f"""
mbsym: 1
name: Top without a moment
bodies:
  - {{name: body, attached to: 0, rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}, mass: 0,
     inertia about: joint, inertia: [2, 2, 3], speeds: {{p: omega1, q: omega2, r: omega3}},
     orientation: {{{orientation}}}}}
motion: {{psi: 0, theta: 0, phi: {{rate: 2}}}}
initial: {{{start}, p: 1/50, q: 0, r: 2}}
"""
    found = run(mbsym.loads(text).system, 3.0)
    got, t = states(found), found.trajectory.times
    assert got["p"] == pytest.approx(0.02 * np.cos(k * t), abs=1e-9)
    assert got["q"] == pytest.approx(0.02 * np.sin(k * t), abs=1e-9)
    assert got["r"] == pytest.approx(n, abs=1e-12)
    # c = c1 + i c2 obeys  c' = -i n c + i (p + i q), from c(0) = c1, or -2 e2 to first order.
    wave = 0.02 / (n + k) * np.exp(1j * k * t)
    wanted = wave + ((-1.2 if "quaternion" in orientation else -0.6) - wave[0]) * np.exp(-1j * n * t)
    if "quaternion" in orientation:
        e = np.array([got[f"e{i}"] for i in range(4)])
        assert e[:, 0] == pytest.approx([1, 0, 0.6, 0], abs=1e-12)
        e0, e3 = np.cos(t), np.sin(t)  # of the motion; to first order c1 = 2 (e1 e3 - e0 e2), c2 = 2 (e2 e3 + e0 e1)
        first = 2 * (e[1] * e3 - e0 * e[2]) + 2j * (e[2] * e3 + e0 * e[1])
    else:
        vectors = [[got[f"{x}{i}"] for i in (1, 2, 3)] for x in "abc"]
        first = np.array(vectors[2][0]) + 1j * np.array(vectors[2][1])
    assert first == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (PENDULUM.replace("y: -l}", "y: -l/2}"), "does not keep the constraints at these values"),
        (PENDULUM.replace("{x: 0, y: -l}", "{x: 0, y: {value: -l, rate: 1}}"), "not with its rates"),
        (PENDULUM.replace("l**2", "l**2*(1 + sin(t))"), "at t = 0 only"),
        (PENDULUM.replace("x**2 + y**2 = l**2", "x**2 = (y + l)**3").replace("x: 1/10, y: -1", "x: 1, y: 0"), "rank"),
        ((SHIPPED / "rolling-disc-in-a-circle.yaml").read_text(encoding="utf-8"), "at t = 0 only"),
    ],
)
def test_no_linear_run_where_there_is_no_motion_to_linearise_about(text: str, told: str) -> None:
    with pytest.raises(NoTangent, match=told):
        run(mbsym.loads(text).system, 1.0)


def test_what_begins_near_the_motion_begins_to_first_order_and_says_so(tmp_path: Path) -> None:
    result = called(tmp_path, PENDULUM.replace("motion:", "dependent: [y]\nmotion:"), "--linear", "--format", "csv")
    assert result.exit_code == 0, result.output
    told = " ".join(result.stdout.split())
    assert "the initial state satisfies the constraints to first order about the unperturbed motion" in told
    assert "linear equations keep the constraints to first order" in told
    result = called(tmp_path, PENDULUM.replace("y: -l}", "y: -l/2}"), "--linear")
    assert result.exit_code != 0
    assert "does not keep the constraints" in result.stderr


def test_a_linear_run_is_gone_on_with_and_planned(tmp_path: Path) -> None:
    """Half and half is one run; what the model misses is told of y_dot, which does not move in it at all."""
    text = PENDULUM.replace("motion:", "dependent: [y]\nmotion:").replace("y: -1", "y: -0.9")
    how = ("--linear", "--format", "csv", "--method", "rk4", "--step", "0.01", "--every", "0.5")
    whole, half = tmp_path / "whole", tmp_path / "half"
    for folder in (whole, half):
        folder.mkdir()
    called(whole, text, *how, "--time", "4")
    called(half, text, *how, "--time", "2")
    earlier = ("--continue", str(half / "out" / "simulation.json"))
    result = called(half, text, *earlier, "--time", "4", "--every", "0.5", "--format", "csv")
    assert result.exit_code == 0, result.output
    one, two = (np.genfromtxt(folder / "out" / "trajectory.csv", delimiter=",", names=True) for folder in (whole, half))
    assert two["x"] == pytest.approx(one["x"], abs=1e-15)
    system = mbsym.loads(text).system
    request = Request(5.0, samples=101, model=Model(linear=True))
    planned = simulate_accurately(scenario(system), request, read_accuracy(system, 1e-3), settled_by(request))
    assert planned.plan is not None
    assert [bound.quantity for bound in planned.plan.bounds] == ["y_dot"]
