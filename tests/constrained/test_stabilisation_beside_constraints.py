"""Problem 8 of wheeled machines, held against equations by hand.

Segway (two wheels on an axle, radius r, track 2 d, a body of mass mb at height l).  With V = r (pl' + pr')/2 and
yaw' = r (pr' - pl')/(2 d) about straight motion, Jz = 0.1 + mw r^2/2 + 2 mw d^2, Iw = mw r^2/2, to second order

    T = mw V^2 + mb (V + l tilt')^2/2 + 0.4 tilt'^2/2 + Iw (pl'^2 + pr'^2)/2 + Jz yaw'^2/2,    U = mb g l tilt^2/2,

and the torques u1, u2 act on the wheels and back on the body: Q = (-u1 - u2, u1, u2).

A car with a light trailer that it pushes (d < 0), driven by F along it and turned by T: with the speed V of its axle

    m V' = F,    (J + m a^2) th'' + m a v th' = T,    ps' = -th' - (v/d) ps,

so that (ps, th, th') is reached from T alone exactly if  det [b, A b, A^2 b] = v/d  is not 0.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.problems.checks import EXACT

CASES = Path(__file__).parents[1] / "cases" / "constraints"
SEGWAY = (CASES / "segway.yaml").read_text(encoding="utf-8")

TRAILER = """
mbsym: 1
name: A car with a light trailer
parameters: {m: {value: 2, sign: positive}, J: {value: 0.5, sign: positive}, a: {value: 0.3, sign: positive},
             d: {value: -1, sign: nonzero}, v: {value: 1, sign: real}}
inputs: {F: {meaning: drive}, T: {meaning: turning moment}}
bodies:
  - {name: car, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]},
     mass centre: [a, 0, 0], mass: m, SPEEDinertia about: mass centre, inertia: [J/2, J/2, J], coordinates: [x, y, th]}
  - {name: trailer, attached to: car, rotation: {axes: [3], angles: [ps]}, mass: 0}
loads:
  - force: {body: car, point: [0, 0, 0], components: [F, 0, 0], axes: car}
  - torque: {body: car, components: [0, 0, T], axes: car}
constraints:
  - velocity: x_dot*sin(th) - y_dot*cos(th) = 0
  - velocity: -x_dot*sin(th + ps) + y_dot*cos(th + ps) - d*(th_dot + ps_dot) = 0
dependent: [y, ps]
motion: {x: {rate: v}}
"""


def segway(length: float) -> tuple[Any, Any]:
    """A and B of (tilt, pl, pr) and their velocities, by hand."""
    mb, mw, r, d, g = 10, 1, 0.2, 0.3, 9.81
    forward, yaw = np.array([0, r / 2, r / 2]), np.array([0, -r / (2 * d), r / (2 * d)])
    swing = forward + np.array([length, 0, 0])
    spin = 0.1 + mw * r**2 / 2 + 2 * mw * d**2
    mass = 2 * mw * np.outer(forward, forward) + mb * np.outer(swing, swing) + spin * np.outer(yaw, yaw)
    mass += np.diag([0.4, mw * r**2 / 2, mw * r**2 / 2])
    stiff = np.diag([-mb * g * length, 0, 0])
    a = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(mass, stiff), np.zeros((3, 3))]])
    pushed = np.linalg.solve(mass, np.array([[-1, -1], [1, 0], [0, 1]]))
    return a, np.vstack([np.zeros((3, 2)), pushed])


def stabilises(a: Any, b: Any, found: Any) -> None:
    """The closed loop by hand has all roots to the left, and the Lyapunov function told is one."""
    closed = a - b @ np.array(found.gains, dtype=float)
    assert np.max(np.linalg.eigvals(closed).real) < -1e-3
    p = np.array(found.lyapunov, dtype=float)
    assert np.min(np.linalg.eigvalsh(p)) > 0
    assert np.max(np.linalg.eigvalsh(p @ closed + closed.T @ p)) < 0
    if found.characteristic:
        told = np.array(found.characteristic, dtype=float)[::-1]
        assert told == pytest.approx(np.poly(closed).real, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("length", ["0.7", "sqrt(2)/2"])
def test_a_segway_is_balanced_by_its_wheels(length: str) -> None:
    """At irrational values, too: they are enclosed, and the Lyapunov function is one for all that they may be."""
    found = mbsym.loads(SEGWAY.replace("l: {value: 0.7", f"l: {{value: {length}"), (8,))
    told = found.stabilisation
    assert told.left_out == ("x", "y", "yaw")
    assert told.control[0].coordinates == ("tilt", "pl", "pr")
    assert told.control[0].rank.full
    assert told.control[0].at_values
    assert told.least == (("u1", "u2"),)  # one wheel does not steer and balance
    assert bool(told.feedback.characteristic) == (length == "0.7")
    assert told.feedback.states == ("tilt", "pl", "pr", "tilt_dot", "pl_dot", "pr_dot")
    stabilises(*segway(float(eval(length, {"sqrt": np.sqrt}))), told.feedback)
    check = found.check("stabilisation")
    assert check is not None
    assert check.outcome == EXACT


def test_the_feedback_of_the_segway_catches_the_nonlinear_one(tmp_path: Path) -> None:
    """From 0.2 rad, standing and turned; integrated with the rolling constraints of both wheels."""
    text = SEGWAY.replace("v: {value: 1", "v: {value: 0")
    gains = mbsym.loads(text, (8,)).stabilisation.feedback
    laws = {
        name: " + ".join(f"({-float(k)})*{z}" for k, z in zip(row, gains.states, strict=True))
        for name, row in zip(("u1", "u2"), gains.gains, strict=True)
    }
    (tmp_path / "segway.yaml").write_text(text, encoding="utf-8")
    run = mbsym.simulate(
        tmp_path / "segway.yaml", time=40, values={"pl_dot": 0, "pr_dot": 0, "yaw": 0.5}, inputs=laws, invariants=False
    )
    assert run.whole
    assert np.max(np.abs(run["tilt"])) < 0.5
    assert abs(run["tilt"][-1]) < 1e-4


@pytest.mark.parametrize("speed", ["", "speeds: {om: omega3}, "])
def test_what_follows_by_an_equation_of_first_order_is_reached_where_the_car_moves(speed: str) -> None:
    found = mbsym.loads(TRAILER.replace("SPEED", speed), (8,))
    told = found.stabilisation
    whole = told.control[0]
    assert whole.coordinates == ("x", "th", "ps")
    assert whole.rank.full
    assert [str(x) for x in whole.rank.locus.factors] == ["v"]
    assert told.left_out == ("y",)
    assert told.least == (("F", "T"),)
    states = told.feedback.states
    assert states == ("x", "th", "ps", "x_dot", "th_dot")
    m, spin, a, d, v = 2, 0.5, 0.3, -1, 1
    whole_spin = spin + m * a**2
    rates = np.array(
        [
            [0, 0, 0, 1, 0],
            [0, 0, 0, 0, 1],
            [0, 0, -v / d, 0, -1],
            [0, 0, 0, 0, 0],
            [0, 0, 0, 0, -m * a * v / whole_spin],
        ]
    )
    pushes = np.array([[0, 0], [0, 0], [0, 0], [1 / m, 0], [0, 1 / whole_spin]])
    stabilises(rates, pushes, told.feedback)
    assert found.check("stabilisation").outcome == EXACT


def test_a_feedback_of_the_part_that_is_within_reach(tmp_path: Path) -> None:
    """Turned by T alone the car keeps its speed: of th and ps there is a feedback, of x there is none."""
    text = TRAILER.replace("SPEED", "").replace("F: {meaning: drive}, ", "")
    text = text.replace("  - force: {body: car, point: [0, 0, 0], components: [F, 0, 0], axes: car}\n", "")
    told = mbsym.loads(text, (8,)).stabilisation
    assert not told.control[0].rank.full
    assert told.feedback.states == ("th", "ps", "th_dot")
    assert "out of reach" in str(told.feedback.of_part)
