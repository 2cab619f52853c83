"""Inverse dynamics: inputs by hand, a motion given back by a simulation with them, and where there are none."""

from __future__ import annotations

import json
import math
import runpy
from pathlib import Path

import numpy as np
import pytest
from conftest import invoked
from jsonschema import Draft202012Validator
from scipy.interpolate import CubicSpline

import mbsym
from mbsym.numerics.inverse import NotLinear
from mbsym.report.code import python_module
from mbsym.report.schemas import schema

POLE = Path(__file__).parents[2] / "systems" / "cart-pole.yaml"

ARM = """mbsym: 1
name: two links with motors
parameters: {m: 2, l: 0.5, J: 0.1, g: 9.81}
prescribed: {chi: 3}
inputs: {u: shoulder, v: elbow}
bodies:
  - {name: upper, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [l/2, 0, 0], mass: m,
     inertia about: mass centre, inertia: [J, J, J]}
  - {name: lower, attached to: upper, rotation: {axes: [3], angles: [b]}, connection point: [l, 0, 0],
     mass centre: [l/2, 0, 0], mass: m, inertia about: mass centre, inertia: [J, J, J]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - torque: {body: upper, components: [0, 0, u], axes: 0}
  - torque: {body: lower, components: [0, 0, v], axes: 0, reaction on: upper}
initial: {a: 0, b: 0}
"""


def test_a_driven_pendulum_by_hand() -> None:
    text = """mbsym: 1
name: pendulum
parameters: {m: 2, l: 3, g: 10, b: 0.5}
inputs: [u]
bodies: [{name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}]
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - damper: {coordinate: theta, coefficient: b}
  - generalized force: {theta: 4*u}
"""
    times = np.linspace(0, 2, 41)
    found = mbsym.inverse_dynamics(mbsym.loads(text), {"theta": "sin(t)"}, times)
    # 18 theta'' + theta'/2 + 60 sin theta = 4 u
    s, c = np.sin(times), np.cos(times)
    assert found["u"] == pytest.approx((-18 * s + c / 2 + 60 * np.sin(s)) / 4, rel=1e-12, abs=1e-12)
    assert found["theta"] == pytest.approx(s)
    assert found.accelerations[0] == pytest.approx(-s)
    assert (found.exact, found.unique) == (True, True)
    # theta = t: 18*0 + 7*1 + 60 sin 0 = 4 u
    heavier = mbsym.inverse_dynamics(mbsym.loads(text), {"theta": "t"}, [0.0], values={"b": 7})
    assert heavier["u"] == pytest.approx([1.75])


def test_a_simulation_with_the_found_inputs_moves_as_given(tmp_path: Path) -> None:
    # The second route: the generated module solves M q'' = f for q'' and integrates.
    analysis, motion = mbsym.loads(ARM), {"a": "sin(2*t) + t**2/4", "b": "1 - cos(chi)"}
    times = np.linspace(0, 2, 2001)
    found = mbsym.inverse_dynamics(analysis, motion, times)
    assert found.exact
    assert found.unique
    (tmp_path / "arm_of_this_test.py").write_text(python_module.render(analysis, ()))
    module = runpy.run_path(str(tmp_path / "arm_of_this_test.py"))
    law = CubicSpline(times, found.inputs, axis=1)
    start = [0.0, 0.0, 2.0, 0.0]  # a' = 2, b' = 3 sin 0
    t, x = module["simulate"](2.0, module["DEFAULTS"], start, 101, u=lambda t, x: law(t))
    assert x[0] == pytest.approx(np.sin(2 * t) + t**2 / 4, abs=1e-7)
    assert x[1] == pytest.approx(1 - np.cos(3 * t), abs=1e-7)
    # A torque with its sign changed is no solution.
    _, wrong = module["simulate"](2.0, module["DEFAULTS"], start, 101, u=lambda t, x: law(t) * [1, -1])
    assert np.abs(wrong[1] - x[1]).max() > 0.1


def test_one_input_for_two_equations() -> None:
    # theta = 0 with the cart accelerated needs a moment that nobody gives: -m l p'' is left of the second equation.
    found = mbsym.inverse_dynamics(POLE, {"p": "t**2/2", "theta": 0}, [0.0, 1.0])
    assert not found.exact
    assert found.residual[1] == pytest.approx([80.0, 80.0])
    assert found["F"] == pytest.approx([90.0, 90.1])
    # The same where it hangs and coasts: the friction c p'.
    coasting = mbsym.inverse_dynamics(POLE, {"p": "2*t", "theta": "pi"}, [0.0, 1.0])
    assert coasting.exact
    assert coasting["F"] == pytest.approx([0.2, 0.2])
    # (J + m l^2) theta'' - m l cos(theta) p'' + gamma theta' - m g l sin(theta) = 0 at a constant angle:
    # p'' = -g tan(theta), F = (M + m) p'' + c p'.
    lean = mbsym.inverse_dynamics(POLE, {"p": "-g*tan(1/5)*t**2/2", "theta": "1/5"}, [0.0, 1.0])
    assert lean.exact
    pull = -9.8 * math.tan(0.2)
    assert lean["F"] == pytest.approx([90 * pull, 90 * pull + 0.1 * pull])


def test_more_inputs_than_equations_and_inputs_that_bend() -> None:
    twice = ARM.replace("u: shoulder", "u: shoulder, w: another").replace("[0, 0, u]", "[0, 0, u + w]")
    found = mbsym.inverse_dynamics(mbsym.loads(twice), {"a": "t", "b": "0"}, [0.0, 0.5])
    assert found.exact
    assert not found.unique
    assert found["u"] == pytest.approx(found["w"])  # the smallest of all pairs with that sum
    with pytest.raises(NotLinear, match="these do not: u"):
        mbsym.inverse_dynamics(mbsym.loads(ARM.replace("[0, 0, u]", "[0, 0, u**3]")), {"a": "t", "b": "0"}, [0.0])
    with pytest.raises(ValueError, match="no motion is given for b"):
        mbsym.inverse_dynamics(mbsym.loads(ARM), {"a": "t"}, [0.0])
    with pytest.raises(ValueError, match="infinite or no number"):
        mbsym.inverse_dynamics(mbsym.loads(ARM), {"a": "1/t", "b": 0}, [0.0, 1.0])


def test_the_command_writes_tells_and_refuses(tmp_path: Path) -> None:
    here = ["inverse", str(POLE), "--out", str(tmp_path), "--time", "2"]
    words = ["--motion", "p=-g*tan(1/5)*t**2/2", "--motion", "theta=1/5", "--samples", "5"]
    done = invoked(*here, *words, code=0)
    assert "these inputs give it at all 5 times" in " ".join(done.output.split())
    rows = np.genfromtxt(tmp_path / "inputs.csv", delimiter=",", names=True)
    assert rows["F"][0] == pytest.approx(-90 * 9.8 * math.tan(0.2))
    assert rows["p_ddot"] == pytest.approx(-9.8 * math.tan(0.2) * np.ones(5))
    assert {"inputs.csv", "inputs.svg", "inputs.png"} <= {path.name for path in tmp_path.iterdir()}
    none = invoked(*here, "--motion", "p=t**2/2", "--motion", "theta=0", code=3)
    assert "no inputs give this motion" in " ".join(none.output.split())
    wrong = invoked(*here, "--motion", "p=step(t)", "--motion", "q=1", code=2)
    for told in ("which has a jump", "there is no coordinate called 'q'", "no motion is given for theta"):
        assert told in wrong.stderr
    other = ["inverse", str(POLE.with_name("simple-pendulum.yaml")), "--motion", "theta=t", "--time", "1"]
    without = invoked(*other, "--out", tmp_path / "none", code=1)
    assert "the description has no inputs" in without.stderr


@pytest.mark.parametrize("tie", ["", "constraints: [{relation: z = 0}]\n"])
def test_what_is_left_is_a_part_of_the_terms_and_not_of_itself(tie: str) -> None:
    """y'' + y = e (2 sin t + 4 t cos t) where y = (1 + e t^2) sin t, which no input moves: e to 4 e of terms near 1."""
    text = """mbsym: 1
name: one is driven
inputs: [u]
bodies:
  - {name: a, attached to: 0, connection point: [x, z, 0], coordinates: [x, z], mass: 1}
  - {name: b, attached to: 0, connection point: [0, y, 0], coordinates: [y], mass: 1}
loads: [{generalized force: {x: u, y: -y}}]
"""
    motion = {"x": "0", "y": "(1 + t**2/10**9)*sin(t)", "z": "0"}
    found = mbsym.inverse_dynamics(mbsym.loads(text + tie), motion, np.linspace(0, 2, 101))
    assert np.abs(found.residual).max() == pytest.approx(3.8e-9, rel=0.02)  # at t = 1: 2 sin 1 + 4 cos 1 = 3.84
    assert 1e-9 < found.left < 5e-9
    assert not found.exact


@pytest.mark.parametrize(("theta", "exact"), [("pi", True), ("pi/2", False)])
def test_the_inputs_of_a_motion_as_json(theta, exact, tmp_path):
    """At a constant speed the friction 0.1 p' remains where the pole hangs; level it falls, whatever the force is."""
    words = ["--motion", "p=t", "--motion", f"theta={theta}", "--time", "2", "--samples", "3", "--json"]
    done = invoked("inverse", POLE, *words, "--out", tmp_path)
    assert done.exit_code == (0 if exact else 3), done.output
    found = json.loads(done.stdout)
    assert list(Draft202012Validator(schema("inverse")).iter_errors(found)) == []
    assert (found["exact"], found["unique"], found["times"]) == (exact, True, [0, 1, 2])
    assert found["inputs"]["F"] == pytest.approx([0.1] * 3) or not exact
