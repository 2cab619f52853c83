"""What ``--accuracy`` promises of systems with constraints, judged by solutions that know no constraints.

The same mechanisms told in coordinates of their own are solved by hand-written equations (``truth/independent``); a
sleigh and a ball have closed forms.  Over the whole interval, at irregular times: the run is within its bound, the
bound within what was asked for and not a thousand times the error; no other setting that keeps twice the room is much
cheaper.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import atan, cosh, exp, sqrt, tanh
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from truth import test_accuracy_judged as judge
from truth.independent.solve import places

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.numerics.methods.interface import Breakdown, Setting, Unusable
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.trade.trial import trial_of
from mbsym.simulation import Simulation

SOLUTIONS = json.loads((Path(__file__).parent / "independent" / "solutions.json").read_text(encoding="utf-8"))

#: Rounding of one number, and what a handful of them make; a bound needs not be better.
FLOOR = 1e-13

#: No measured setting is to be cheaper by this factor.
FACTOR = 1.5


@dataclass(frozen=True)
class Told:
    """A description with constraints, how long it runs, and what some of its quantities are at a time."""

    text: str
    time: float
    truth: Callable[[Any], dict[str, Any]]


def of_scene(name: str, quantities: str) -> Callable[[Any], dict[str, Any]]:
    """The stored solution of a scene without constraints, whose quantities have these names."""

    def truth(times: Any) -> dict[str, Any]:
        return dict(zip(quantities.split(), np.array(SOLUTIONS[name]["states"], dtype=float).T, strict=True))

    return truth


ATWOOD = """
mbsym: 1
name: swinging Atwood machine, the string told by a relation
bodies:
  - {name: counterweight, attached to: 0, connection point: [1, 0, h], mass: 3, coordinates: [h]}
  - {name: string, attached to: 0, rotation: {axes: [2], angles: [theta]}, coordinates: [theta], mass: 0}
  - {name: bob, attached to: string, connection point: [0, 0, -r], mass: 1, coordinates: [r]}
loads: [{uniform gravity: {vector: [0, 0, -9.81]}}]
constraints: [{relation: h - r = 0}]
initial: {h: 1, r: 1, theta: pi/2}
"""

LIGHT = """
mbsym: 1
name: light pendulum held to a heavy one
bodies:
  - name: heavy
    attached to: 0
    rotation: {axes: [2], angles: [a]}
    coordinates: [a]
    mass center: [0, 0, -1]
    mass: 1
  - name: light
    attached to: 0
    connection point: [x, 0, z]
    rotation: {axes: [2], angles: [b]}
    coordinates: [x, z, b]
    mass center: [0, 0, -1/2]
    mass: 1/1000000
loads: [{uniform gravity: {vector: [0, 0, -9.81]}}]
constraints: [{coincide: [{body: light, point: [0, 0, 0]}, {body: heavy, point: [0, 0, -1]}]}]
dependent: [x, z]
initial: {a: 1, b: -1/2, x: -0.8, z: -0.5}
"""

#: m = 1, J = 0.5, a = 0.3: k^2 = J/m + a^2.
RADIUS, AHEAD = sqrt(0.59), 0.3

SLEIGH = """
mbsym: 1
name: sleigh
bodies:
  - name: sleigh
    attached to: 0
    connection point: [x, y, 0]
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0.3, 0, 0]
    mass: 1
    inertia about: mass centre
    inertia: [0, 0, 0.5]
    coordinates: [x, y, theta]
constraints: [{velocity: x_dot*sin(theta) - y_dot*cos(theta) = 0}]
initial: {x: {position: 0, velocity: 1/2}, y: 0, theta: {position: 0, velocity: 2}}
"""


def sleigh(times: Any) -> dict[str, Any]:
    """v' = a w^2, w' = -(a/k^2) v w, k^2 = J/m + a^2, of the speed v along the blade and w = theta'.

    v^2 + k^2 w^2 = V^2;  w = (V/k)/cosh s,  v = V tanh s,  s = a V t/k^2 + s0;  theta = (2 k/a) atan(tanh(s/2)) + c.
    """
    v, w = 0.5, 2.0
    whole = sqrt(v * v + RADIUS**2 * w * w)
    begun = 0.5 * np.log((whole + v) / (whole - v))
    found: dict[str, list[float]] = {"theta": [], "theta_dot": [], "x_dot": [], "y_dot": []}
    for t in times:
        s = AHEAD * whole * t / RADIUS**2 + begun
        theta = 2 * RADIUS / AHEAD * (atan(tanh(s / 2)) - atan(tanh(begun / 2)))
        speed = whole * tanh(s)
        found["theta"].append(theta)
        found["theta_dot"].append(whole / RADIUS / cosh(s))
        found["x_dot"].append(speed * np.cos(theta))
        found["y_dot"].append(speed * np.sin(theta))
    return {name: np.array(values) for name, values in found.items()}


BALL = """
mbsym: 1
name: ball told by a quaternion
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, 1/2], coordinates: [x, y], mass: 2}
  - {name: ball, attached to: centre, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 0,
     inertia about: joint, inertia: [0.1, 0.1, 0.1], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {e: quaternion}}
loads: [{uniform gravity: {vector: [0, 0, -9.81]}}]
constraints: [{rolling: {body: ball, point: [0, 0, -1/2], axes: centre, on: ground}}]
dependent: [x, y]
initial: {x: 0, y: 0, e0: 1, e1: 0, e2: 0, e3: 0, p: 3, q: 1, s: 2}
"""


def ball(times: Any) -> dict[str, Any]:
    """A homogeneous ball: the force at the contact vanishes, omega is constant, and so is the centre's velocity.

    e(0) = 1: e(t) = (cos(w t/2), sin(w t/2) omega/w);  x' = r omega_y, y' = -r omega_x.
    """
    omega = np.array([3.0, 1.0, 2.0])
    w = float(np.linalg.norm(omega))
    half = w * np.asarray(times) / 2
    parts = {"e0": np.cos(half), **{f"e{k + 1}": np.sin(half) * omega[k] / w for k in range(3)}}
    return {**parts, "x": 0.5 * omega[1] * np.asarray(times), "y": -0.5 * omega[0] * np.asarray(times)}


SCENES = {
    "atwood": Told(ATWOOD, 10.0, of_scene("atwood", "theta r theta_dot r_dot")),
    "light": Told(LIGHT, 10.0, of_scene("light", "a b a_dot b_dot")),
    "sleigh": Told(SLEIGH, 5.0, sleigh),
    "ball": Told(BALL, 10.0, ball),
}


@cache
def run_of(name: str, target: float) -> Simulation:
    return mbsym.simulate(mbsym.loads(SCENES[name].text), SCENES[name].time, samples=101, accuracy=target)


def errors(name: str, times: Any, quantity: Callable[[str], Any]) -> float:
    """The largest, each beside the quantity's size at these times."""
    found = []
    for key, truth in SCENES[name].truth(times).items():
        found.append(np.max(np.abs(quantity(key) - truth)) / np.max(np.abs(truth)))
    return float(max(found))


@pytest.mark.parametrize("target", [1e-4, 1e-8])
@pytest.mark.parametrize("name", SCENES)
def test_what_is_promised_under_constraints_is_kept(name: str, target: float) -> None:
    found, times = run_of(name, target), np.array(places(SCENES[name].time))
    assert found.whole
    assert found.plan is not None
    assert found.plan.reached
    states = found.at(times)
    names = (*found.system.coordinates, *found.system.velocities)
    error = errors(name, times, lambda key: states[names.index(key)])
    bound = found.plan.bound.total
    assert error <= bound <= target
    assert bound <= max(1000 * error, FLOOR)
    assert found.drift is not None
    assert max(found.drift.largest) < target / 100


@pytest.mark.parametrize("name", SCENES)
def test_no_measured_setting_is_much_cheaper_by_counted_work(name: str) -> None:
    """Of a ladder of tolerances of every compiled method, each judged by the same solution, its error doubled."""
    target, told = 1e-6, SCENES[name]
    found = run_of(name, target)
    assert found.plan is not None
    times, dynamics = np.array([0.0, *places(told.time)]), found.dynamics
    names = (*found.system.coordinates, *found.system.velocities)
    own, least = _cost(dynamics, found.plan.method, found.plan.setting, times)[0], float("inf")
    for method in ("dop853", "rk45"):
        for tolerance in 10.0 ** -np.arange(3.0, 12.01, 1 / 3):
            price, states = _cost(dynamics, method, Setting(float(tolerance)), times)
            wrong = errors(name, times[1:], lambda key, x=states: x[names.index(key), 1:])  # type: ignore[misc]
            if 2 * wrong <= target:
                least = min(least, price)
                break
    assert least < exp(10)
    assert own <= FACTOR * least


def _cost(dynamics: Any, method: str, setting: Setting, times: Any) -> tuple[float, Any]:
    """What a run costs, and its states; nothing and nan where it does not come to the end."""
    try:
        found = trial_of(METHODS[method], dynamics, setting, times)
    except (Breakdown, Unusable, Failure):
        return float("inf"), np.full((len(dynamics.inputs) - 1, len(times)), np.nan)
    return cost(dynamics, method, "float64", found.work), found.states


@pytest.mark.parametrize("name", ["atwood", "ball"])
@pytest.mark.parametrize(("lie", "promises"), judge.LIES)
def test_each_planted_lie_is_caught(name: str, lie: Any, promises: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """As without constraints: an estimate of a run with itself, skipped trials, half a bound, a coarse reference."""
    if lie is not None:
        lie(monkeypatch)
    found, times = judge.accurately(SCENES[name].text, SCENES[name].time, 1e-8), np.array(places(SCENES[name].time))
    names, states = (*found.system.coordinates, *found.system.velocities), found.at(times)
    error = errors(name, times, lambda key: states[names.index(key)])
    broken = judge.broken_promises(found, error, 1e-8)
    assert {*promises} <= {*broken} if promises else not broken


def test_a_mechanism_told_twice_gets_the_same_plan() -> None:
    """The machine of Atwood with and without its constraint: same errors asked for, bounds alike."""
    from truth.independent.scenes import SCENES as FREE

    free = next(scene for scene in FREE if scene.name == "atwood")
    one = mbsym.simulate(mbsym.loads(free.text), free.time, samples=101, accuracy=1e-8)
    other = run_of("atwood", 1e-8)
    assert one.plan is not None
    assert other.plan is not None
    for name in ("theta", "r", "theta_dot", "r_dot"):
        apart = np.max(np.abs(one[name] - other[name])) / np.max(np.abs(one[name]))
        assert apart <= one.plan.bound.total + other.plan.bound.total
