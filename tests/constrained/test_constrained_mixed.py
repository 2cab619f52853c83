"""Constraints together with dry friction, prescribed motions and moving rods, against the same in one angle."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import system_of

from mbsym.numerics.scenario import scenario
from mbsym.simulation import Request, Simulation, simulate

HEAD = """
mbsym: 1
name: A pendulum on a pivot that moves
parameters: {m: 1, g: 9.81, c: 2, J: 1/10}
prescribed: {w: {rate: 3}}
bodies:
  - {name: pivot, attached to: 0, mass: 0, connection point: [PIVOT, 0, 0]}
"""

LOADS = """
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - generalised force: {q: FORCE}
"""

ANGLE = (
    HEAD
    + """  - {name: bob, attached to: pivot, mass: m, rotation: {axes: [3], angles: [q]}, mass centre: [0, -1, 0],
     inertia about: mass centre, inertia: [J, J, J]}"""
    + LOADS
    + "initial: {q: 1.2}\n"
)

LOOP = (
    HEAD
    + """  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y, q],
     rotation: {axes: [3], angles: [q]}, inertia about: mass centre, inertia: [J, J, J]}"""
    + LOADS
    + """constraints:
  - coincide: [{body: bob, point: [0, 1, 0]}, {body: pivot, point: [0, 0, 0]}]
dependent: [x, y]
initial: {q: {position: 1.2, velocity: 0}, x: 1, y: -1/2}
"""
)


def run(text: str, pivot: str, force: str, **how: Any) -> Simulation:
    system = system_of(text.replace("PIVOT", pivot).replace("FORCE", force))
    return simulate(scenario(system), Request(time=1.5, samples=16, estimate=False, **how))


@pytest.mark.parametrize(
    ("pivot", "force", "method"),
    [
        ("0", "-6*sign(q_dot)", "radau"),
        ("0", "-c*q**2*sign(q_dot)", "bdf"),
        ("sin(w)/5", "-c*sign(q_dot)", "radau"),
        ("sin(w)/5", "-c*sign(q_dot)", "dop853"),
        ("t**2/10", "-c*abs(q_dot)*q_dot", "dop853"),
    ],
)
def test_the_loop_moves_as_the_angle_does(pivot: str, force: str, method: str) -> None:
    truth = run(ANGLE, pivot, force, tolerance=1e-11)
    found = run(LOOP, pivot, force, method=method, tolerance=1e-9)
    assert found.whole
    assert found["q"] == pytest.approx(truth["q"], abs=2e-6 if method == "bdf" else 2e-8)
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-13
    assert found.conservation.standing is truth.conservation.standing


def test_dry_friction_whose_size_moves_has_a_jacobian() -> None:
    """Its derivative by q has the sign that is held as a factor."""
    assert run(ANGLE, "0", "-c*q**2*sign(q_dot)", method="radau", tolerance=1e-8).whole
