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
    _, complaints = read(TEXT + "abbreviations: {w: u*m}\n", "x")
    assert [one.code for one in complaints.items] == ["misplaced-name"]
