"""Joints that move as any function of time: against prescribed quantities, by hand, and what must then be denied."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from conftest import system_of

import mbsym
from mbsym.source import read
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

SHAKEN = """mbsym: 1
name: pendulum with a moving pivot
parameters: {m: {sign: positive, value: 1}, l: {sign: positive, value: 1}, g: {sign: positive, value: 9.81},
  h: {sign: positive, value: 0.1}, nu: {sign: positive, value: 7}}
PRESCRIBED
bodies:
  - {name: rod, attached to: 0, connection point: [XX, YY, 0], rotation: {axes: [3], angles: [ANGLE]},
     coordinates: [theta], mass centre: [0, l, 0], mass: m}
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
motion: {theta: 0}
initial: {theta: 0.1}
"""


def shaken(x: str = "0", y: str = "0", angle: str = "theta", prescribed: str = "") -> str:
    return SHAKEN.replace("XX", x).replace("YY", y).replace("ANGLE", angle).replace("PRESCRIBED", prescribed)


def test_a_shaken_pivot_is_the_prescribed_one() -> None:
    # m l^2 th'' = m l sin th (g + y''), y = h cos(nu t), with the angle from the upward vertical.
    timed = mbsym.loads(shaken(y="h*cos(nu*t)"))
    known = mbsym.loads(shaken(y="h*cos(phi)", prescribed="prescribed: {phi: nu}"))
    (force,) = timed.equations.forcing
    x = {str(s): s for s in force.to_sympy().free_symbols}
    by_hand = x["m"] * x["l"] * sympy.sin(x["theta"]) * (x["g"] - x["h"] * x["nu"] ** 2 * sympy.cos(x["nu"] * x["t"]))
    assert sympy.simplify(force.to_sympy() - by_hand) == 0
    assert not [check for check in timed.checks if check.failed]
    one, other = mbsym.simulate(timed, 3), mbsym.simulate(known, 3)
    assert one.coordinates[0, -1] == pytest.approx(other.coordinates[0, -1], rel=1e-8)
    assert one.conservation.standing.value == "not conserved"


def test_polynomials_and_exponentials_of_time() -> None:
    # x = t^2/5, y = h exp(-t), the angle theta + t/3:
    # m l^2 th'' = m l (g + y'') sin(theta + t/3) + m l x'' cos(theta + t/3), x'' = 2/5, y'' = h exp(-t).
    found = mbsym.loads(shaken("t**2/5", "h*exp(-t)", "theta + t/3"))
    (force,) = found.equations.forcing
    x = {str(s): s for s in force.to_sympy().free_symbols}
    angle = x["theta"] + x["t"] / 3
    lift = x["g"] + x["h"] * sympy.exp(-x["t"])
    by_hand = x["m"] * x["l"] * (lift * sympy.sin(angle) + sympy.Rational(2, 5) * sympy.cos(angle))
    numbers = {
        x["m"]: 2,
        x["l"]: 3,
        x["g"]: 5,
        x["h"]: 7,
        x["theta"]: sympy.Rational(1, 3),
        x["t"]: sympy.Rational(3, 2),
    }
    assert abs(sympy.N((force.to_sympy() - by_hand).subs(numbers), 30)) < 1e-25
    assert not [check for check in found.checks if check.failed]
    assert found.integrals == ()
    # At theta = 0 it does not rest, and no verdict is given.
    assert found.equilibrium.unsteady == ("t",)
    assert found.stage(6).failure is not None


def test_what_moves_with_time_is_not_conserved_nor_steady() -> None:
    still, moved = mbsym.loads(shaken()), mbsym.loads(shaken(y="h/(1 + t**2)"))
    assert [item.kind for item in still.integrals] == ["generalised energy"]
    assert moved.integrals == ()
    assert still.stage(6).failure is None
    failure = moved.stage(6).failure
    assert failure is not None
    assert "time-dependent" in failure.reason
    # A pivot that moves uniformly is another inertial frame: the equations are those at rest.
    uniform = mbsym.loads(shaken(x="3*t"))
    assert str(uniform.equations.forcing[0]) == str(still.equations.forcing[0])
    assert uniform.stability.verdict.word == still.stability.verdict.word


def test_a_body_turned_by_a_motor_as_the_square_of_time() -> None:
    text = shaken(angle="t**2")
    text = text.replace("motion: {theta: 0}\ninitial: {theta: 0.1}\n", "initial: {theta: 0}\n")
    text = text.replace("coordinates: [theta], ", "coordinates: [theta], ").replace(
        "[0, 0, 0], rot", "[theta, 0, 0], rot"
    )
    analysis = mbsym.loads(text)
    # x + the rod's point -l sin(t^2): m theta'' = -m d^2/dt^2 (-l sin t^2) = m l (2 cos t^2 - 4 t^2 sin t^2).
    run = mbsym.simulate(analysis, 2)
    t = run.times
    # theta = x with x(0) = x'(0) = 0: x - l sin(t^2) has no acceleration and starts at 0 with the rate 0.
    assert run.coordinates[0] == pytest.approx(np.sin(t**2), abs=1e-8)


def test_both_spellings_and_a_wrong_velocity() -> None:
    text = shaken("t**2/5", "h*exp(-t)", "theta + t/3")
    system = system_of(text, "x")
    assert read(to_yaml(system), "y")[0] == system == read(to_text(system), "t")[0]
    given = text.replace("rotation:", "relative velocity: [2*t/5, -h*exp(-t), 0], rotation:")
    assert read(given, "x")[0] is not None
    _, complaints = read(given.replace("2*t/5", "t/5"), "x")
    assert [one.message for one in complaints.items] == ["component 1 is not the derivative of the connection point"]


def test_a_coordinate_is_a_free_function_of_time_in_the_equations_of_the_others() -> None:
    """A cart that moves as x(t): m l (l th'' + g cos th - x'' sin th) = 0, whatever x is (SymPy's issue 8244).

    Said where somebody writes an input in a joint; the shared description with an acceleration a takes a t^2/2.
    """
    joint = "mbsym: 1\nname: pendulum on a cart\nparameters: {m: positive, l: positive, g: positive}\nbodies:\n"
    cart = "  - {name: cart, attached to: 0, connection point: [PLACE, 0, 0], mass: 0}\n"
    rest = (
        "  - {name: bob, attached to: cart, rotation: {axes: [3], angles: [th]}, mass centre: [l, 0, 0], mass: m}\n"
        "loads: [{uniform gravity: {vector: [0, -g, 0]}}]\n"
    )
    system, complaints = read(
        (joint + cart + rest).replace("bodies", "inputs: {a: {}}\nbodies").replace("PLACE", "a*t**2/2")
    )
    assert system is None
    assert "stands under 'given': a: {of: t}" in str(complaints.errors[0].hint)
    led = mbsym.loads((joint + cart + rest).replace("bodies", "given: {x: {of: t}}\nbodies").replace("PLACE", "x"))
    free = mbsym.loads((joint + cart + rest).replace("PLACE", "x").replace("mass: 0", "mass: 0, coordinates: [x]"))
    row = free.equations.equality(list(free.system.coordinates).index("th"), free.system.coordinates).to_sympy()
    x = {str(s): s for s in row.free_symbols}
    by_hand = x["l"] * x["th_ddot"] + x["g"] * sympy.cos(x["th"]) - x["x_ddot"] * sympy.sin(x["th"])
    assert sympy.simplify(row - x["m"] * x["l"] * by_hand) == 0
    own = led.equations.equality(0, led.system.coordinates).to_sympy()
    assert sympy.simplify(own.subs({s: x[str(s)] for s in own.free_symbols}) - x["m"] * x["l"] * by_hand) == 0
