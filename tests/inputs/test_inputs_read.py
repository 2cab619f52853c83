"""Inputs and outputs in a description: both spellings, units, hints, and what ``motion`` says of them."""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest
import yaml
from conftest import system_of

from mbsym.expressions.tree import ONE, text
from mbsym.model.substitution import driven, held
from mbsym.model.system import System
from mbsym.source import read
from mbsym.source.schema import json_schema
from mbsym.source.text_writer import to_text
from mbsym.source.yaml_writer import to_yaml

POLE = (Path(__file__).parents[2] / "systems" / "cart-pole.yaml").read_text(encoding="utf-8")

SMALL = """mbsym: 1
name: two inputs
parameters: {m: positive, F0: real}
inputs: INPUTS
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: b, attached to: a, connection point: [0, y, 0], mass: m, coordinates: [y]}
loads:
  - generalized force: {x: u*x_dot + v, y: v}
motion: {x: 0, u: 0, v: F0}
outputs: {z: x + v, w: y_dot}
"""


def parsed(source: str) -> System:
    return system_of(source, "x")


@pytest.mark.parametrize(
    "spelled", ["[u, v]", "{u: , v: }", '{u: "a; b # c", v: {meaning: torque}}', "{u: {}, v: {meaning: a}}"]
)
def test_both_spellings_give_one_system(spelled: str) -> None:
    system = parsed(SMALL.replace("INPUTS", spelled))
    assert system.input_names == ("u", "v")
    assert [text(one.held) for one in system.inputs] == ["0", "F0"]
    assert parsed(to_yaml(system)) == system
    assert parsed(to_text(system)) == system


def test_the_pole_in_both_spellings() -> None:
    system = parsed(POLE)
    assert parsed(to_yaml(system)) == system == parsed(to_text(system))
    jsonschema.validate(yaml.safe_load(POLE), json_schema())


def test_a_motion_of_inputs_alone_is_the_rest_of_all_coordinates() -> None:
    system = parsed(SMALL.replace("INPUTS", "[u, v]").replace("x: 0, u: 0, ", ""))
    assert [(one.coordinate, text(one.value), text(one.rate)) for one in system.motion] == [
        ("x", "0", "0"),
        ("y", "0", "0"),
    ]


def test_units_follow_through_inputs() -> None:
    source = SMALL.replace("INPUTS", "{u: , v: {unit: N}}") + "units: {m: kg, x: m, y: m}\n"
    _, complaints = read(source, "x")
    # z = x + v adds a length and a force.
    assert [one.code for one in complaints.items] == ["dimension"]
    system = parsed(source.replace("x + v", "m*x/v"))
    assert system.units.of("u") == "kg/s"
    assert system.units.of("z") == "s^2"
    assert system.units.of("w") == "m/s"


def test_an_input_that_no_load_holds_is_told() -> None:
    _, complaints = read(SMALL.replace("INPUTS", "[u, v, idle]").replace("y_dot", "idle"), "x")
    assert [(one.severity, one.message) for one in complaints.items] == [
        ("warning", "the input 'idle' is used nowhere")
    ]


def test_inputs_are_held_or_driven() -> None:
    system = parsed(SMALL.replace("INPUTS", "[u, v]"))
    (load,) = held(system).loads
    assert {name: text(x) for name, x in load.components} == {"x": "F0", "y": "F0"}  # type: ignore[union-attr]
    (load,) = driven(system, {"u": ONE}).loads
    assert {name: text(x) for name, x in load.components} == {"x": "x_dot + F0", "y": "F0"}  # type: ignore[union-attr]
    assert held(system).inputs == () == driven(system, {}).outputs
