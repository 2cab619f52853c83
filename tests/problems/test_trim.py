"""Inputs and parameters that hold a posture, in symbols: against virtual work by hand."""

from __future__ import annotations

import json
import math
import random
from typing import Any

import pytest
import sympy
from conftest import filed, invoked
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.report.schemas import schema

HEAD = "mbsym: 1\nname: Held\n"

FOUR_BAR = (
    HEAD
    + """
parameters: {A: positive, B: positive, C: positive, D: positive, m: positive, g: positive, p0: real, q0: real, s0: real}
inputs: [tau]
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [p]}, mass centre: [A/2, 0, 0], mass: m,
     inertia about: mass centre, inertia: [0, m*A**2/12, m*A**2/12]}
  - {name: b, attached to: a, connection point: [A, 0, 0], rotation: {axes: [3], angles: [q]}, mass centre: [B/2, 0, 0],
     mass: m, inertia about: mass centre, inertia: [0, m*B**2/12, m*B**2/12]}
  - {name: c, attached to: 0, connection point: [D, 0, 0], rotation: {axes: [3], angles: [s]},
     mass centre: [C/2, 0, 0], mass: m, inertia about: mass centre, inertia: [0, m*C**2/12, m*C**2/12]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}, {generalized force: {p: tau}}]
constraints: [{coincide: [{body: b, point: [B, 0, 0]}, {body: c, point: [C, 0, 0]}]}]
motion: {p: p0, q: q0, s: s0}
"""
)

LADDER = (
    HEAD
    + """
parameters: {m: positive, l: positive, k: positive, g: positive, q0: real, e: real}
bodies:
  - {name: rod, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [q]}, coordinates: [x, y, q],
     mass: m, inertia about: mass centre, inertia: [0, m*l**2/12, m*l**2/12]}
loads: [{uniform gravity: {vector: [0, -g, 0]}}, {generalized force: {x: -k*(x - e)}}]
constraints: [{relation: y + l/2*sin(q) = 0}, {relation: x - l/2*cos(q) = 0}]
motion: {q: q0, x: l/2*cos(q0), y: -l/2*sin(q0)}
"""
)

PENDULUM = (
    HEAD
    + """
parameters: {m: positive, l: positive, g: positive, a: real}
inputs: [tau, F]
bodies: [{name: B, attached to: 0, rotation: {axes: [3], angles: [q]}, mass centre: [l, 0, 0], mass: m}]
loads: [{uniform gravity: {vector: [0, -g, 0]}}, {generalized force: {q: tau + 2*F}}]
motion: {q: a}
"""
)


def at(formula: Any, **values: float) -> float:
    return float(formula.to_sympy().subs({str(x): values[str(x)] for x in formula.to_sympy().free_symbols}))


def test_the_torque_that_holds_a_four_bar() -> None:
    """A sin p + B sin(p + q) = C sin s turns V into m g (A sin p + C sin s), and on the loop

    C s' = A p' sin q / sin(p + q - s):    tau = dV/dp = m g A (cos p + cos s sin q / sin(p + q - s)).
    """
    found = mbsym.trim(mbsym.loads(FOUR_BAR))
    assert [name for name, _ in found.solved] == ["tau"]
    assert found.free == ()
    assert len(found.conditions) == 2  # the loop closes
    assert found.assumed
    draw = random.Random(1)
    for _ in range(5):
        p, q, s, a = (draw.uniform(0.3, 2.8) for _ in range(4))
        torque = 3 * 10 * a * (math.cos(p) + math.cos(s) * math.sin(q) / math.sin(p + q - s))
        assert at(found.solved[0][1], p0=p, q0=q, s0=s, A=a, m=3, g=10) == pytest.approx(torque)


@pytest.mark.parametrize("name", ["e", "k", "m"])
def test_the_preload_of_a_spring_that_holds_a_ladder(name: str) -> None:
    """Virtual work: m g cos q + k (l/2 cos q - e) sin q = 0."""
    found = mbsym.trim(mbsym.loads(LADDER), solve=(name,))
    values = {"m": 2.0, "l": 1.5, "k": 30.0, "g": 10.0, "q0": 0.7, "e": 0.4}
    values[name] = at(found.solved[0][1], **values)
    m, k, l, e, g, q = (values[x] for x in ("m", "k", "l", "e", "g", "q0"))
    assert m * g * math.cos(q) + k * (l / 2 * math.cos(q) - e) * math.sin(q) == pytest.approx(0)
    assert found.conditions == ()


def test_one_equation_leaves_one_of_two_inputs_free() -> None:
    found = mbsym.trim(mbsym.loads(PENDULUM))
    assert [name for name, _ in found.solved] == ["tau"]
    assert found.free == ("F",)
    assert at(found.solved[0][1], m=2, l=3, g=10, a=0.5, F=7) == pytest.approx(60 * math.cos(0.5) - 14)


def test_an_input_that_is_not_asked_for_keeps_its_value() -> None:
    found = mbsym.trim(mbsym.loads(PENDULUM), solve=("F",))
    assert at(found.solved[0][1], m=2, l=3, g=10, a=0.5) == pytest.approx(30 * math.cos(0.5))


def test_what_cannot_be_solved_for_says_so() -> None:
    with pytest.raises(Failure, match="q0: not linear"):
        mbsym.trim(mbsym.loads(LADDER), solve=("q0",))


def test_no_value_holds_what_nothing_acts_on() -> None:
    """A pendulum level with its pivot, the torque on another body: m g l = 0 never holds."""
    text = (
        PENDULUM.replace("tau + 2*F", "0*tau").replace("inputs: [tau, F]", "inputs: [tau]").replace("{q: a}", "{q: 0}")
    )
    text = text.replace("mass: m}]", "mass: m}, {name: C, attached to: 0, rotation: {axes: [3], angles: [z]}, mass: m,")
    text = text.replace("mass: m,\nloads", "mass: m, inertia about: joint, inertia: [1, 1, 1]}]\nloads").replace(
        "{q: 0*tau}", "{z: tau}"
    )
    found = mbsym.trim(mbsym.loads(text.replace("motion: {q: 0}", "motion: {q: 0, z: 0}")))
    assert [str(x) for x in found.impossible]


def test_the_command_prints_it(tmp_path: Any) -> None:
    path = filed(tmp_path / "held.yaml", PENDULUM)
    done = invoked("trim", path, "--solve", "tau", code=0)
    assert "tau = m l g cos(a)" in done.output
    assert invoked("trim", path, "--solve", "zeta").exit_code == 2


@pytest.mark.parametrize(
    ("sign", "printed", "code"),
    [
        ("real", "g = 0", 0),
        ("positive", "no values make this motion one of the system", 1),
        ("nonnegative", "g = 0", 0),
    ],
)
def test_a_value_has_the_sign_that_is_declared(sign: str, printed: str, code: int, tmp_path: Any) -> None:
    """A mass at rest in the air: m g = 0, so g = 0, which a positive g is not."""
    path = filed(
        tmp_path / "air.yaml",
        f"mbsym: 1\nname: Air\nparameters: {{m: positive, g: {sign}}}\nbodies:\n"
        "  - {name: a, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}\n"
        "loads:\n  - uniform gravity: {vector: [0, -g, 0]}\nmotion: {y: 0}\n",
    )
    done = invoked("trim", path, "--solve", "g")
    assert (done.exit_code, printed in done.output) == (code, True), done.output


def test_a_value_of_either_sign_is_told_with_the_sign_that_it_has_to_have() -> None:
    """A spring holds a weight at y = a: k a = m g, and with a of any sign k > 0 is not sure."""
    text = (
        "mbsym: 1\nname: Held\nparameters: {m: positive, g: positive, k: positive, a: nonzero}\nbodies:\n"
        "  - {name: b, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}\n"
        "loads:\n  - uniform gravity: {vector: [0, g, 0]}\n  - spring: {coordinate: y, stiffness: k}\nmotion: {y: a}\n"
    )
    found = mbsym.trim(mbsym.loads(text), solve=("k",))
    assert not found.impossible
    assert [(name, str(x), relation) for name, x, relation in found.signed] == [("k", "m*g/a", ">")]


SPRING = (
    HEAD
    + """
parameters: {k: positive, e: real, m: positive, g: positive, x0: real, y0: real}
bodies: [{name: p, mass: m, connection point: [x, y, 0], coordinates: [x, y]}]
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {between: [{body: p, point: [0, 0, 0]}, {body: 0, point: [0, 1, 0]}], stiffness: k, length: e}
motion: {x: x0, y: y0}
"""
)


@pytest.mark.parametrize(
    ("text", "name", "lines"),
    [
        # x: k x0 (1 - e/r) = 0, so e = r and the weight stays; but where x0 = 0 the length e = r - m g/k does it
        (SPRING, "e", ["no values make this motion one of the system, where no divisor is 0"]),
        (SPRING.replace("x: x0, y: y0", "x: 0, y: -2"), "e", ["  e = 3 - m g/k"]),  # r = 3
        (PENDULUM, "tau", ["  tau = m l g cos(a)", "  held at their values on the motion", "    F = 0"]),
        (PENDULUM.replace("{q: a}", "{q: a, F: 3}"), "tau", ["  tau = m l g cos(a) - 6", "    F = 3"]),
        (PENDULUM.replace("q: a", "q: 0"), "m", ["no values make this motion one of the system", "    tau = 0"]),
    ],
)
def test_what_is_held_is_told_and_divisors_leave_open_what_they_exclude(
    text: str, name: str, lines: list[str], tmp_path: Any
) -> None:
    file = filed(tmp_path / "a.yaml", text)
    done = invoked("trim", file, "--solve", name)
    assert not {line.strip() for line in lines} - {line.strip() for line in done.output.splitlines()}, done.output


def test_what_holds_a_pendulum_as_json(tmp_path: Any) -> None:
    """tau = m g l cos(a) by virtual work, F at rest; with both asked for one of them is free."""
    path = filed(tmp_path / "held.yaml", PENDULUM)
    torque = sympy.sympify("m*g*l*cos(a)")
    for options, free in ((["--solve", "tau"], set()), ([], {"tau", "F"})):
        done = invoked("trim", path, "--json", *options, code=0)
        found = json.loads(done.stdout)
        assert list(Draft202012Validator(schema("trim")).iter_errors(found)) == []
        assert found["possible"] is True
        assert set(found["free"]) <= free
        assert len(found["free"]) == bool(free)
        values = {name: sympy.sympify(value) for name, value in found["solved"].items()}
        tau, force = (values.get(name, sympy.Symbol(name)) for name in ("tau", "F"))
        assert sympy.simplify(tau + (2 * force if free else 0) - torque) == 0


def test_where_no_values_hold_it_json_says_so(tmp_path: Any) -> None:
    """An input that does nothing holds no pendulum that is level: m g l cos(0) is not zero."""
    path = tmp_path / "held.yaml"
    text = PENDULUM.replace("{q: tau + 2*F}", "{q: 0*tau}").replace("motion: {q: a}", "motion: {q: 0}")
    path.write_text(text, encoding="utf-8")
    done = invoked("trim", path, "--json", code=1)
    assert json.loads(done.stdout)["possible"] is False
