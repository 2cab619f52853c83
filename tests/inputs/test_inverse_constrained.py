"""Inputs of a given motion of systems with constraints: what follows by hand, and what must be refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import filed, invoked, system_of
from scipy.integrate import solve_ivp

import mbsym
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.numerics.inverse import inverse_dynamics

#: A pendulum whose bob is tied to its pivot: with q the others follow, and (m l^2 + J) q'' + m g l sin q = u.
PENDULUM = """
mbsym: 1
name: A tied pendulum
parameters: {m: 2, g: 9.81, J: 1/10}
inputs: {u: {meaning: a torque}}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y, q],
     rotation: {axes: [3], angles: [q]}, inertia about: mass centre, inertia: [J, J, J]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - generalised force: {q: u}
constraints:
  - coincide: [{body: bob, point: [0, 1, 0]}, {body: 0, point: [0, 0, 0]}]
initial: {q: 0, x: 0, y: -1}
"""

#: A wheel that rolls: with the torque u on it and a force v on its centre (m + J/r^2) r phi'' = u/r + v.
WHEEL = """
mbsym: 1
name: A wheel
parameters: {m: 2, J: 3, r: 1/2}
inputs: {u: {meaning: a torque}, v: {meaning: a force}}
bodies:
  - {name: wheel, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x, phi],
     rotation: {axes: [3], angles: [phi]}, inertia about: mass centre, inertia: [J, J, J]}
loads:
  - generalised force: {phi: u, x: v}
constraints:
  - KIND: x_dot = r*phi_dot
initial: {x: 0, phi: 0}
"""


def found_for(text: str, **motion: str) -> Any:
    system = system_of(text)
    given = {name: parse_expression(one, Complaints(), lambda a, b: Span(1, 1, 1)) for name, one in motion.items()}
    return inverse_dynamics(system, given, {}, np.linspace(0.0, 2.0, 41))  # type: ignore[arg-type]


def test_the_torque_of_a_pendulum_by_its_angle_alone() -> None:
    found = found_for(PENDULUM, q="sin(3*t)")
    q, speed = np.sin(3 * found.times), -9 * np.sin(3 * found.times)
    assert found["u"] == pytest.approx(2.1 * speed + 2 * 9.81 * np.sin(q), abs=1e-10)
    assert found["x"] == pytest.approx(np.sin(q), abs=1e-12)
    assert found.accelerations[1] == pytest.approx(
        np.cos(q) * (3 * np.cos(3 * found.times)) ** 2 + np.sin(q) * speed, abs=1e-9
    )
    assert found.exact
    assert found.unique


def test_all_coordinates_may_be_given_if_they_satisfy_the_constraints() -> None:
    alone = found_for(PENDULUM, q="t")
    assert found_for(PENDULUM, q="t", x="sin(t)", y="-cos(t)")["u"] == pytest.approx(alone["u"], abs=1e-10)
    with pytest.raises(ValueError, match="does not satisfy coincide 1"):
        found_for(PENDULUM, q="t", x="sin(t)*1.001", y="-cos(t)")


def test_a_wheel_with_one_input_more_than_freedoms() -> None:
    """u and v do the same: each solution has u/r + v = (m + J/r^2) r phi''; the ranks say that there are others."""
    found = found_for(WHEEL.replace("KIND: x_dot = r*phi_dot", "relation: x = r*phi"), phi="t**2")
    assert 2 * found["u"] + found["v"] == pytest.approx(np.full(41, (2 + 12) * 0.5 * 2), abs=1e-10)
    assert found.exact
    assert not found.unique


def test_where_a_wheel_rolls_to_follows_from_its_initial_position() -> None:
    """x = r t^2 with r = 1/2, whether it is given or not."""
    text = WHEEL.replace("KIND", "velocity")
    alone = found_for(text, phi="t**2")
    assert alone["x"] == pytest.approx(alone.times**2 / 2, abs=1e-11)
    assert 2 * alone["u"] + alone["v"] == pytest.approx(np.full(41, 14.0), abs=1e-9)
    both = found_for(text, phi="t**2", x="t**2/2")
    assert 2 * both["u"] + both["v"] == pytest.approx(np.full(41, 14.0), abs=1e-10)


def test_a_motion_that_no_input_gives_is_told() -> None:
    """The input pulls on the pivot's side only: the constraint takes it all."""
    found = found_for(PENDULUM.replace("generalised force: {q: u}", PULL), q="t**2")
    assert not found.exact
    assert not found.unique
    assert found["u"] == pytest.approx(np.zeros(41), abs=1e-9)
    # What is left does the work that is missing along (cos q, sin q, 1), the displacement that the tie allows.
    q = found.times**2
    work = found.residual[0] * np.cos(q) + found.residual[1] * np.sin(q) + found.residual[2]
    assert -work == pytest.approx(4.2 + 19.62 * np.sin(q), abs=1e-9)


PULL = "force: {body: bob, point: [0, 1, 0], components: [u, 0, 0], axes: 0}"


def test_the_command(tmp_path: Path) -> None:
    file = filed(tmp_path / "s.yaml", PENDULUM)
    words = ["inverse", str(file), "--time", "1", "--motion", "q=t**2", "--out", str(tmp_path / "out")]
    result = invoked(*words, code=0)
    assert "forces of constraints" in result.stdout
    assert (tmp_path / "out" / "inputs.csv").read_text().startswith("t,u,x,y,q")
    wrong = invoked(*words, "--motion", "x=t", code=1)
    assert "does not satisfy coincide 1" in wrong.stderr


def test_python_takes_the_motion_of_some(tmp_path: Path) -> None:
    file = filed(tmp_path / "s.yaml", PENDULUM)
    found = mbsym.inverse_dynamics(str(file), {"q": "t"}, [0.0, 1.0])
    assert found["u"] == pytest.approx([0.0, 19.62 * np.sin(1.0)], abs=1e-12)
    with pytest.raises(ValueError, match="no motion is given for x"):
        mbsym.inverse_dynamics(str(file), {}, [0.0, 1.0])


CAR = """
mbsym: 1
name: A car with a light trailer
parameters: {m: {value: 2, sign: positive}, J: {value: 0.5, sign: positive}, a: {value: 0.3, sign: positive},
             d: {value: 0.7, sign: positive}}
inputs: {F: {meaning: drive}, T: {meaning: turning moment}}
bodies:
  - {name: car, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]},
     mass centre: [a, 0, 0], mass: m, inertia about: mass centre, inertia: [J/2, J/2, J], coordinates: [x, y, th]}
  - {name: trailer, attached to: car, rotation: {axes: [3], angles: [ps]}, mass: 0}
loads:
  - force: {body: car, point: [0, 0, 0], components: [F, 0, 0], axes: car}
  - torque: {body: car, components: [0, 0, T], axes: car}
constraints:
  - velocity: x_dot*sin(th) - y_dot*cos(th) = 0
  - velocity: -x_dot*sin(th + ps) + y_dot*cos(th + ps) - d*(th_dot + ps_dot) = 0
initial: {x: 0, y: 1, th: 0, ps: 0.4}
"""


@pytest.mark.parametrize("speeds", ["", "speeds: {om: omega3}, "])
def test_where_wheels_roll_to_follows_by_integration(speeds: str) -> None:
    """Round a circle of radius R = 2 at the rate w = 1/2: y = 1 + R (1 - cos w t), F = -m a w^2, T = m a R w^2,

    and the trailer turns by  ps' = -w - (R w/d) sin ps,  integrated here by another program.
    """
    car = mbsym.loads(CAR.replace("mass: m, ", f"mass: m, {speeds}"), ())
    found = mbsym.inverse_dynamics(car, {"x": "2*sin(t/2)", "th": "t/2"}, np.linspace(0, 2, 101))
    assert found.exact
    assert found.unique
    assert found["F"] == pytest.approx(np.full(101, -2 * 0.3 / 4), abs=1e-10)
    assert found["T"] == pytest.approx(np.full(101, 2 * 0.3 * 2 / 4), abs=1e-10)
    assert found["y"] == pytest.approx(1 + 2 * (1 - np.cos(found.times / 2)), abs=1e-10)
    turned = solve_ivp(
        lambda t, ps: -0.5 - np.sin(ps) / 0.7, (0, 2), [0.4], "Radau", found.times, rtol=1e-11, atol=1e-12
    )
    assert found["ps"] == pytest.approx(turned.y[0], abs=1e-8)


#: Two bars side by side on a bar of length 2: a parallelogram, with a motor in each of its joints.
DRIVEN_PARALLELOGRAM = """
mbsym: 1
name: P
parameters: {g: 9.81}
inputs: {u: {meaning: a torque}, v: {meaning: a torque}, w: {meaning: a torque}}
bodies:
  - {name: A, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 1, mass centre: [1/2, 0, 0],
     inertia about: joint, inertia: [0, 1/3, 1/3]}
  - {name: B, attached to: A, connection point: [1, 0, 0], rotation: {axes: [3], angles: [b]}, mass: 3,
     mass centre: [1, 0, 0], inertia about: mass centre, inertia: [0, 1, 1]}
  - {name: C, attached to: 0, connection point: [2, 0, 0], rotation: {axes: [3], angles: [c]}, mass: 1,
     mass centre: [1/2, 0, 0], inertia about: joint, inertia: [0, 1/3, 1/3]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}, {generalized force: {a: u, b: v, c: 3*w}}]
constraints: [{coincide: [{body: B, point: [2, 0, 0]}, {body: C, point: [1, 0, 0]}]}]
initial: {a: 1/2, b: -1/2, c: 1/2}
"""


@pytest.mark.parametrize("motion", [{"a": "1/2 + t"}, {"a": "1/2 + t", "b": "-1/2 - t", "c": "1/2 + t"}])
def test_the_smallest_torques_of_a_parallelogram_that_turns_evenly(motion: dict[str, str]) -> None:
    """Nothing is accelerated but in circles: u - v + 3 w = 4 g cos a, and u = -v = w/3 is the smallest of it."""
    found = found_for(DRIVEN_PARALLELOGRAM, **motion)
    torque = 4 * 9.81 * np.cos(0.5 + found.times) / 11
    assert found.inputs == pytest.approx(np.array([torque, -torque, 3 * torque]), abs=1e-11)
    assert not found.unique


def test_one_motion_of_all_coordinates_that_a_parallelogram_does_not_keep() -> None:
    with pytest.raises(ValueError, match="does not satisfy coincide 1"):
        found_for(DRIVEN_PARALLELOGRAM, a="1/2 + t", b="-1/2 - t", c="1/2 + t + t**2/10**6")
