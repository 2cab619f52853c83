"""The sign of a number is no condition on parameters: pi, sqrt(2), sin(pi/7) alone, or as a factor of a parameter.

By hand, of m x'' + k x = 0: stable for k > 0, unstable for k < 0.  3 < pi < 22/7, sqrt(2) < sqrt(3) < 2,
log(2) = 0.693..., pi/5 = 0.628..., sin(pi/7) = 0.4338...; a rod held at th by a spring of the stiffness
m g a sin(th)/th has the stiffness m g a (cos(th) - sin(th)/th) there, negative for 0 < th < pi since tan(th) > th up
to pi/2.
"""

from __future__ import annotations

import pytest

import mbsym
from mbsym.problems.stability.words import Word

POINT = """
mbsym: 1
name: point
parameters: {{m: positive, a: positive, k: positive, q: real}}
bodies:
  - {{name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}}
loads:
  - potential: ({stiffness})*x**2/2
motion: {{}}
claims:
  - {{claim: condition, that: "{stiffness} > 0", as: necessary}}
"""
ROD = """
mbsym: 1
name: rod
parameters: {{m: positive, a: positive, g: positive}}
bodies:
  - {{name: rod, rotation: {{axes: [3], angles: [th]}}, mass centre: [a, 0, 0], mass: m}}
loads:
  - uniform gravity: {{vector: [g, 0, 0]}}
  - spring: {{coordinate: th, stiffness: "-m*g*a*sin({angle})/({angle})"}}
motion: {{th: {angle}}}
"""
POSITIVE = [
    "a*(pi - 3)",
    "a*(22/7 - pi)",
    "a*(log(2) - pi/5)",
    "k + a*(4 - pi) + q**2",
    "k + a*(2 - sqrt(2))",
    "k*pi + a*(sqrt(3) - sqrt(2)) + q**2",
    "k + a*(1 - 2*sin(pi/7))",
    "a**2*(pi - 3) - a*k*(sqrt(2) - sqrt(3)) + k**2",
]


@pytest.mark.parametrize("stiffness", POSITIVE)
def test_what_is_positive_whatever_the_parameters_are_decides(stiffness: str) -> None:
    found = mbsym.loads(POINT.format(stiffness=stiffness))
    assert found.stability.verdict.word is Word.STABLE
    assert found.claims[0].holds
    assert mbsym.loads(POINT.format(stiffness=f"-({stiffness})")).stability.verdict.word is Word.UNSTABLE


@pytest.mark.parametrize("stiffness", POSITIVE[:4])
def test_and_under_constraints(stiffness: str) -> None:
    """5 m x'' + k x = 0 of a second mass with y' = 2 x'."""
    second = "  - {{name: s, attached to: 0, mass: m, connection point: [0, y, 0], coordinates: [y]}}\n"
    text = POINT.replace("loads:", f"{second}constraints: [{{{{velocity: y_dot = 2*x_dot}}}}]\nloads:")
    assert mbsym.loads(text.format(stiffness=stiffness)).stability.verdict.word is Word.STABLE
    assert mbsym.loads(text.format(stiffness=f"-({stiffness})")).stability.verdict.word is Word.UNSTABLE


@pytest.mark.parametrize("angle", ["pi/12", "pi/7", "1/3", "atan(2/3)"])
def test_an_angle_that_is_a_number_leaves_no_condition(angle: str) -> None:
    assert mbsym.loads(ROD.format(angle=angle)).stability.verdict.word is Word.UNSTABLE


@pytest.mark.parametrize("stiffness", ["k - a*(4 - pi)", "a*q*(pi - 3)", "k + a*(sqrt(2) - sqrt(3))"])
def test_what_has_both_signs_depends_on_the_parameters(stiffness: str) -> None:
    assert mbsym.loads(POINT.format(stiffness=stiffness)).stability.verdict.word is Word.DEPENDS
