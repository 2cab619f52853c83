"""Claimed conditions that are printed with roots: what they say of the parameters is decided without.

By hand: w < sqrt(k/m) is m w^2 < k for positive numbers.  Thomson and Tait's pair on a hill, x'' + g y' - k1 x = 0,
y'' - g x' - k2 y = 0, has (g^2 - k1 - k2)^2 > 4 k1 k2 with g^2 > k1 + k2, that is g > sqrt(k1) + sqrt(k2), for simple
imaginary roots; with equality they are double and growing like t.  Ziegler's column without damping flutters from
P l = (7/2 - sqrt(2)) k on (Ziegler 1952): 4 x^2 - 28 x + 41 = 0 and 2 x < 7.  A shaft with inner damping ci and outer
damping ce whirls beyond w = (1 + ce/ci) sqrt(k/m), and does not where neither acts; with
inner damping alone, turning to either side, beyond |w| = sqrt(k/m).
"""

from __future__ import annotations

import pytest

import mbsym
from mbsym.problems.claims import ClaimResult, Outcome

POINT = """
mbsym: 1
name: point
parameters: {m: positive, k: positive, w: positive}
bodies:
  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}
loads:
  - potential: (k - m*w**2)*x**2/2
motion: {}
"""
HILL = """
mbsym: 1
name: hill
parameters: {k1: positive, k2: positive, g: positive}
linear system:
  coordinates: [x, y]
  G: [[0, g], [-g, 0]]
  K: [[-k1, 0], [0, -k2]]
"""
ZIEGLER = """
mbsym: 1
name: Ziegler
parameters: {m: positive, l: positive, k: positive, P: real}
bodies:
  - {name: a, rotation: {axes: [3], angles: [q1]}, mass centre: [l, 0, 0], mass: 2*m}
  - name: b
    attached to: a
    connection point: [l, 0, 0]
    rotation: {axes: [3], angles: [q2]}
    mass centre: [l, 0, 0]
    mass: m
loads:
  - spring: {coordinate: q1, stiffness: k}
  - spring: {coordinate: q2, stiffness: k}
  - force: {body: b, point: [l, 0, 0], components: [-P, 0, 0], axes: b}
motion: {}
"""
SHAFT = """
mbsym: 1
name: shaft
parameters: {m: positive, k: positive, ci: nonnegative, ce: nonnegative, w: positive}
prescribed: {f: w}
bodies:
  - {name: frame, rotation: {axes: [3], angles: [f]}, mass: 0}
  - {name: disc, attached to: frame, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - potential: k*(x**2 + y**2)/2
  - rayleigh: ci*(x_dot**2 + y_dot**2)/2
  - generalized force: {x: -ce*(x_dot - w*y), y: -ce*(y_dot + w*x)}
motion: {}
"""
FRAME = SHAFT.replace("ci: nonnegative, ce: nonnegative, w: positive", "ci: positive, w: real").replace(
    "  - generalized force: {x: -ce*(x_dot - w*y), y: -ce*(y_dot + w*x)}\n", ""
)
TRUE = [
    (POINT, "w < sqrt(k/m)", "necessary", Outcome.EXACT),
    (POINT, "w < sqrt(k/m)", "sufficient", Outcome.EXACT),
    (POINT, "w <= sqrt(k/m)", "necessary", Outcome.EXACT),
    (POINT, "w*sqrt(m)/sqrt(k) < 1", "necessary", Outcome.EXACT),
    (POINT, "1/w > sqrt(m/k)", "sufficient", Outcome.EXACT),
    (HILL, "g >= sqrt(k1) + sqrt(k2)", "necessary", Outcome.EXACT),
    (HILL, "g > sqrt(k1) + sqrt(k2)", "necessary", Outcome.BORDERS),
    (HILL, "g > sqrt(k1) + sqrt(k2)", "sufficient", Outcome.EXACT),
    (HILL, "g > sqrt(k1 + k2 + 2*sqrt(k1*k2))", "sufficient", Outcome.EXACT),
    (HILL, "g > sqrt(k1 + k2)", "necessary", Outcome.EXACT),
    (ZIEGLER, "P*l/k <= 7/2 - sqrt(2)", "necessary", Outcome.EXACT),
    (ZIEGLER, "P*l/k < 7/2 - sqrt(2)", "necessary", Outcome.BORDERS),
    (FRAME, "w > -sqrt(k/m)", "necessary", Outcome.BORDERS),
    (FRAME, "w >= -sqrt(k/m)", "necessary", Outcome.EXACT),
    (FRAME, "w <= sqrt(k/m)", "necessary", Outcome.EXACT),
    (SHAFT, "ci*w*sqrt(m/k) < ci + ce", "necessary", Outcome.BORDERS),
]
FALSE = [
    (FRAME, "w < sqrt(k/m)", "sufficient"),
    (FRAME, "w < sqrt(k/m)/2", "necessary"),
    (FRAME, "w > -sqrt(k/m)/2", "necessary"),
    (POINT, "w <= sqrt(k/m)", "sufficient"),
    (POINT, "w < sqrt(k/m)/2", "necessary"),
    (POINT, "w < 2*sqrt(k/m)", "sufficient"),
    (HILL, "g > sqrt(k1) + 2*sqrt(k2)", "necessary"),
    (HILL, "g > sqrt(k1) - sqrt(k2)", "sufficient"),
    (HILL, "g > sqrt(k1 + k2)", "sufficient"),
    (ZIEGLER, "P*l/k < 7/2 - sqrt(3)", "necessary"),
]


def claimed(text: str, that: str, role: str) -> ClaimResult:
    (found,) = mbsym.loads(f"{text}claims:\n  - {{claim: condition, that: {that}, as: {role}}}\n").claims
    return found


@pytest.mark.parametrize(("text", "that", "role", "outcome"), TRUE)
def test_what_is_true_of_roots_is_proved(text: str, that: str, role: str, outcome: str) -> None:
    assert claimed(text, that, role).outcome == outcome


@pytest.mark.parametrize(("text", "that", "role"), FALSE)
def test_what_is_false_of_roots_is_not(text: str, that: str, role: str) -> None:
    assert claimed(text, that, role).outcome in (Outcome.FAILS, Outcome.UNDECIDED)
    assert not claimed(text, that, role).holds
