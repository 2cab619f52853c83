"""What an input is in a simulation: closed forms, a feedback by hand, tables, generated code; and what is refused."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import filed, imported, invoked

import mbsym

POLE = Path(__file__).parents[2] / "systems" / "cart-pole.yaml"

CART = """mbsym: 1
name: cart on a spring
parameters: {m: 2, k: {value: 18}, F0: {value: 9}}
inputs: {u: push, v: {meaning: wind}}
tables: {ramp: {points: [[0, 0], [1, 1]]}}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - force: {body: cart, point: [0, 0, 0], components: [u, 0, 0], axes: 0}
  - generalized force: {x: v}
motion: {x: F0/k, v: F0}
initial: {x: 0}
"""


def at_end(found: Any) -> tuple[float, float]:
    return float(found.coordinates[0, -1]), float(found.velocities[0, -1])


def test_a_constant_a_ramp_and_a_feedback_move_as_by_hand() -> None:
    # 2 x'' + 18 x = u + v from rest, omega = 3.
    analysis, t = mbsym.loads(CART), 0.9
    held = mbsym.simulate(analysis, t)  # v = F0 = 9: x = (1 - cos 3t)/2
    assert at_end(held) == pytest.approx(((1 - math.cos(3 * t)) / 2, 1.5 * math.sin(3 * t)), rel=1e-9)
    resting = mbsym.simulate(analysis, t, inputs={"v": 0})
    assert at_end(resting) == (0, 0)
    ramp = mbsym.simulate(analysis, t, inputs={"u": "ramp(t)", "v": 0})  # x = (t - sin(3t)/3)/18
    assert at_end(ramp)[0] == pytest.approx((t - math.sin(3 * t) / 3) / 18, rel=1e-8)
    # u = -32 x + 50: 2 x'' + 50 x = 50, omega = 5.
    feedback = mbsym.simulate(analysis, t, inputs={"u": "-32*x + 50", "v": 0})
    assert at_end(feedback)[0] == pytest.approx(1 - math.cos(5 * t), rel=1e-8)
    assert feedback.conservation.standing.value == "not conserved"  # T - U holds the spring alone
    moved = mbsym.simulate(analysis, t, inputs={"v": "sin(t)"})
    assert moved.conservation.standing.value == "not conserved"


SPUN = """mbsym: 1
name: body that turns about its first axis
parameters: {A: 2, B: 3, k: {value: 1/2}, K: 7}
inputs: {u: {meaning: torque}}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 2, 1], angles: [a, b, c]}
    mass: 1
    inertia about: joint
    inertia: [A, B, B]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
loads:
  - torque: {body: body, components: [u, 0, 0], axes: body}
initial: {a: 0, b: 0, c: 1, p: 3, q: 0, r: 0}
"""


@pytest.mark.parametrize("variables", ["declared", "coordinates"])
def test_laws_hold_speeds_and_unit_vectors(variables: str) -> None:
    """A p' = -k p: p = 3 exp(-k t/A); A c'' = -K sin(c) with gamma2 = sin(c), gamma3 = cos(c): A p^2/2 - K gamma3."""
    analysis, t = mbsym.loads(SPUN), 2.0
    damped = mbsym.simulate(analysis, t, inputs={"u": "-k*p"}, variables=variables)
    assert damped["p"][-1] == pytest.approx(3 * math.exp(-t / 4), rel=1e-9)
    swung = mbsym.simulate(analysis, t, inputs={"u": "-K*gamma2"}, variables=variables)
    energy = swung["p"] ** 2 - 7 * swung["gamma3"]
    assert np.ptp(swung["gamma3"]) > 1
    assert np.max(np.abs(energy - (9 - 7 * math.cos(1)))) < 1e-8


def test_an_angle_that_is_no_variable_is_refused_in_a_law(tmp_path: Path) -> None:
    path = filed(tmp_path / "spun.yaml", SPUN)
    words = ["simulate", str(path), "--time", "1", "--input", "u=-k*c_dot", "--format", "csv", "--out", str(tmp_path)]
    refused = invoked(*words, code=2)
    assert "the angle 'c' in the law of u is no variable of this run" in refused.stderr
    assert invoked(*words, "--variables", "coordinates").exit_code == 0


def test_every_wrong_law_is_told_at_once() -> None:
    analysis = mbsym.loads(CART)
    with pytest.raises(ValueError, match=r"no input called w.*unknown name 'y'.*'v' is an input"):
        mbsym.simulate(analysis, 1, inputs={"w": 1, "u": "y + v"})
    with pytest.raises(ValueError, match="v = inf is no number"):
        mbsym.simulate(analysis, 1, inputs={"v": math.inf})


def test_the_command_tells_and_agrees_with_the_generatedimported(tmp_path: Path) -> None:
    done = invoked("run", POLE, "--out", tmp_path / "r", "--format", "python", code=0)
    words = ["--time", "1", "--set", "p=0", "--input", "F=20*sin(3*t) - p_dot", "--format", "csv"]
    done = invoked("simulate", POLE, *words, "--out", tmp_path / "s", code=0)
    assert "inputs  F = 20*sin(3*t) - p_dot\n" in done.output
    assert '"inputs": {\n    "F": "20*sin(3*t) - p_dot"\n  }' in (tmp_path / "s" / "simulation.json").read_text()
    rows = np.genfromtxt(tmp_path / "s" / "trajectory.csv", delimiter=",", names=True)
    module = imported(tmp_path / "r" / "model.py")
    start = module.initial_state(module.DEFAULTS, {"p": 0.0})
    _, x = module.simulate(1.0, module.DEFAULTS, start, u=lambda t, x: [20 * math.sin(3 * t) - x[2]])
    for k, name in enumerate(("p", "theta", "p_dot", "theta_dot")):
        assert rows[name][-1] == pytest.approx(x[k, -1], rel=1e-7)
    rate = module.rhs(0.0, start, module.DEFAULTS, [3.0])
    # From (M + m) p'' - m l c theta'' = F + ..., (J + m l^2) theta'' - m l c p'' = m g l s, by Cramer's rule.
    c, s = math.cos(0.05), math.sin(0.05)
    down = 90 * 180 - (80 * c) ** 2
    assert rate[2] == pytest.approx((180 * 3 + 80 * c * 80 * 9.8 * s) / down, rel=1e-12)
    with pytest.raises(ValueError, match="expected 1 inputs"):
        module.rhs(0.0, start, module.DEFAULTS, [3.0, 4.0])
    column = module.input_matrix(module.DEFAULTS)
    assert column.tolist() == [[1.0], [0.0]]


def test_the_command_complains_of_every_law(tmp_path: Path) -> None:
    words = ["--time", "1", "--set", "p=0", "--input", "G=1", "--input", "F=q", "--input", "F", "--out", str(tmp_path)]
    done = invoked("simulate", POLE, *words, code=2)
    assert "there is no input called 'G'" in done.stderr
    assert "hint: laws are for: F" in done.stderr
    assert "unknown name 'q'" in done.stderr
    assert "'F' gives no law" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_run_is_not_continued_with_another_law(tmp_path: Path) -> None:
    begin = ["simulate", str(POLE), "--set", "p=0", "--format", "csv", "--quiet"]
    first = [*begin, "--time", "1", "--input", "F=t", "--out", str(tmp_path / "a")]
    assert invoked(*first).exit_code == 0
    on = [*begin, "--time", "2", "--continue", str(tmp_path / "a" / "simulation.json"), "--out", str(tmp_path / "b")]
    assert invoked(*on, "--input", "F=2*t").exit_code == 2
    assert invoked(*on, "--input", "F=t").exit_code == 0


def test_other_commands_say_at_which_values(tmp_path: Path) -> None:
    done = invoked("equilibria", POLE, "--set", "c=1", code=0)
    assert "for 'equilibria' the inputs are constant, as on the unperturbed motion: F = 0" in done.stderr
