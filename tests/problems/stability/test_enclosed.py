"""Verdicts by enclosures: what a ball leaves open is not claimed."""

from __future__ import annotations

from typing import Any

import pytest
from flint import arb

import mbsym
from mbsym.problems.stability.enclosed import enclosed_verdict
from mbsym.problems.stability.words import Because, Word
from mbsym.report.words.claims import decided

NOTHING = [[arb(0), arb(0)], [arb(0), arb(0)]]
UNIT = [[arb(1), arb(0)], [arb(0), arb(1)]]


def diagonal(*values: Any) -> list[list[arb]]:
    return [[arb(values[i]) if i == j else arb(0) for j in range(2)] for i in range(2)]


def spinning(rate: Any) -> list[list[arb]]:
    return [[arb(0), arb(rate)], [-arb(rate), arb(0)]]


def test_gyroscopic_only_where_stiffness_is_certainly_not_positive() -> None:
    """K = -1 twice and G = 3: (s^2 - 1)^2 + 9 s^2 has four imaginary roots."""
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(-1, -1), NOTHING], True)
    assert found.word is Word.GYROSCOPIC
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(1, 2), NOTHING], True)
    assert (found.word, found.theorem) == (Word.STABLE, "Routh")
    # One of the two, but the ball does not tell which: a frequency near 0.
    wide = arb(0, 1e-30)
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(1, wide), NOTHING], True)
    assert found.word is Word.UNDECIDED


def test_partial_damping() -> None:
    """K = 2 twice and a dashpot on the first coordinate: the second swings for ever."""
    parts = [UNIT, diagonal(1, 0), NOTHING, diagonal(2, 2), NOTHING]
    found = enclosed_verdict(parts, True)
    assert (found.word, found.theorem) == (Word.STABLE, "Lagrange-Dirichlet")
    assert enclosed_verdict(parts, False).word is Word.UNDECIDED
    negative = [UNIT, diagonal(-1, 0), NOTHING, diagonal(2, 2), NOTHING]
    assert enclosed_verdict(negative, False).word is Word.UNSTABLE


CONE = """
mbsym: 1
name: conical motion that a torque keeps up
parameters: {{m: positive, l: positive, g: positive, w: positive, a: real, c: nonnegative}}
bodies:
  - name: bob
    attached to: 0
    rotation: {{axes: [3, 1], angles: [phi, theta]}}
    mass centre: [0, 0, -l]
    mass: m
loads:
  - uniform gravity: {{vector: [0, 0, -g]}}
  - damper: {{coordinate: phi, coefficient: c}}
  - generalized force: {{phi: c*w}}
motion: {{phi: {{rate: w}}, theta: a}}
values: {{m: 1, l: 1, g: 8, w: {w}, a: {a}, c: {c}}}
"""


@pytest.mark.parametrize(("w", "a"), [("4", "pi/3"), ("sqrt(8*sqrt(2))", "pi/4"), ("sqrt(16/sqrt(3))", "pi/6")])
def test_a_motion_at_an_angle_like_pi_3_is_known_to_exist(w: str, a: str) -> None:
    """l w^2 cos a = g exactly.  With S = w^2 sin(a)^2, C = w^2 cos(a)^2 and d = c/(m l^2 sin(a)^2) the first
    approximation has the roots 0 and those of s^3 + d s^2 + (S + 4 C) s + d S: d (S + 4 C) > d S, all left."""
    found = mbsym.loads(CONE.format(w=w, a=a, c=0)).stability.numerical
    assert (found.word, found.theorems) == (Word.STABLE_BUT_CYCLIC, ("Routh",))
    damped = mbsym.loads(CONE.format(w=w, a=a, c="1/10")).stability
    assert damped.numerical.word is Word.ASYMPTOTIC_BUT_CYCLIC
    assert "enclosures" in decided(damped)
    assert "does not exist" in mbsym.loads(CONE.format(w="401/100", a=a, c=0)).stability.numerical.explanation


@pytest.mark.parametrize(("angle", "word"), [("pi/3", Word.UNSTABLE), ("pi/4", Word.STABLE), ("pi/2", Word.UNSTABLE)])
def test_a_border_at_an_angle_whose_cosine_is_rational(angle: str, word: Word) -> None:
    """x'' + (cos(a) - 1/2) x = 0: at a = pi/3 x'' = 0, and x grows."""
    text = (
        "mbsym: 1\nname: x\nparameters: {a: real}\nlinear system: {coordinates: [x], K: [[cos(a) - 1/2]]}\nvalues: {a: "
    )
    found = mbsym.loads(f"{text}{angle}}}\n").stability
    assert found.numerical.word is word
    assert ("exactly" in decided(found)) == (angle == "pi/3")  # elsewhere balls tell the sign


def test_on_a_border_at_such_an_angle_terms_of_higher_order_decide_or_it_is_said_what_leaves_it_open() -> None:
    """x'' + (cos(a) - 1/2) x + 4 x^3 = 0 at a = pi/3: the root 0 is double, which is decided exactly; V = x^4 there."""
    text = (
        "mbsym: 1\nname: x\nparameters: {a: real}\nbodies: [{name: p, attached to: 0, mass: 1, "
        "connection point: [x, 0, 0], coordinates: [x]}]\nloads: [force function: -(cos(a) - 1/2)*x**2/2 - x**4]\n"
        "motion: {x: 0}\nvalues: {a: pi/3}\n"
    )
    assert mbsym.loads(text).stability.numerical.word is Word.STABLE
    assert mbsym.loads(text.replace("x**4", "x**12")).stability.numerical.because(Because.JORDAN_BLOCK)
