"""Claims about systems with inputs: what holds for every input, what does not, and what cannot be claimed."""

from __future__ import annotations

import mbsym
from mbsym.source import read

TEXT = """mbsym: 1
name: claims
parameters: {m: positive, k: positive}
inputs: [u]
bodies: [{name: c, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}]
loads: [{generalized force: {x: u*k}}]
motion: {x: 0, y: 0}
claims:
  - {claim: first integral, equals: "m*y_dot"}
  - {claim: first integral, equals: "m*x_dot"}
  - {claim: value, of: x_ddot, equals: 6, state: {u: 3, k: 4, m: 2, x: 0, y: 0, x_dot: 0, y_dot: 0}}
  - {claim: value, of: x_ddot, equals: 5, state: {u: 3, k: 4, m: 2, x: 0, y: 0, x_dot: 0, y_dot: 0}}
  - {claim: equation of motion, of: x, equals: "m*x_ddot - k*u"}
  - {claim: equation of motion, of: x, equals: "m*x_ddot + k*u"}
"""


def test_claims_hold_and_are_refuted_whatever_the_input() -> None:
    words = [claim.outcome for claim in mbsym.loads(TEXT).claims]
    assert words[::2] == ["holds exactly", "holds to the digits printed", "holds exactly"]
    assert words[1::2] == ["does not hold", "differs", "differs"]


def test_an_integral_holds_no_input() -> None:
    _, complaints = read(TEXT.replace('equals: "m*y_dot"', 'equals: "u*m"'), "x")
    assert [one.code for one in complaints.items] == ["misplaced-name"]
    # nor does one that holds some, be it in another abbreviation
    held = TEXT.replace("claims:", "abbreviations: {w: u*m, v: 2*w}\nclaims:")
    _, complaints = read(held.replace('equals: "m*y_dot"', "equals: v"), "x")
    assert [one.message.split(",")[0] for one in complaints.items] == ["'v' is an abbreviation that holds an input"]


def test_abbreviations_hold_inputs() -> None:
    """m x'' = k u: with S = k u/m the acceleration is S; what a wrong equation has too much is told as 2 S."""
    text = (
        TEXT[: TEXT.index("claims:")]
        + """
abbreviations: {S: k*u/m}
claims:
  - {claim: acceleration, of: x, equals: S}
  - {claim: equation of motion, of: x, equals: "x_ddot - S"}
  - {claim: equation of motion, of: x, equals: "x_ddot + S"}
  - {claim: acceleration, of: x, equals: 2*S}
"""
    )
    found = mbsym.loads(text).claims
    outcomes = ["holds exactly", "holds up to a factor", "differs", "differs by a factor"]
    assert [claim.outcome for claim in found] == outcomes
    assert [part.same_as for part in found[2].parts] == ["2*S"]


def test_what_an_input_does_is_no_part_of_an_energy() -> None:
    """m l^2 theta'' = -m g l sin theta + u with u any function of time: no energy; with u a constant there is one."""
    motor = """
mbsym: 1
name: Pendulum with a motor
parameters: {m: positive, l: positive, g: positive}
inputs: [u]
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -l, 0], mass: m}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - torque: {body: rod, components: [0, 0, u], axes: 0}
motion: {theta: 0}
"""
    assert mbsym.loads(motor).integrals == ()
    constant = motor.replace("inputs: [u]\n", "").replace("g: positive}", "g: positive, u: real}")
    (energy,) = mbsym.loads(constant.replace("motion: {theta: 0}\n", "")).integrals
    assert energy.name == "energy with the potential of the forces"
