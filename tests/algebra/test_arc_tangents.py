"""Sines and cosines of arc tangents have closed forms: cos(atan x) = 1/sqrt(1 + x^2), sin(atan x) = x/sqrt(1 + x^2)."""

from __future__ import annotations

import math

import pytest
from conftest import TESTS, Exact
from flint import arb

import mbsym

NUMBERS = {"a": 4.0, "g": 3.0, "b": -2.0, "q": 0.7}
RING = """
mbsym: 1
name: ring
parameters: {a: positive, g: positive, b: real}
bodies: [{name: rod, attached to: 0, rotation: {axes: [3], angles: [q]}, mass centre: [1, 0, 0], mass: 1}]
loads: [{potential: exp(b*q) + log(a + b**2) + sqrt(a*q**2 + g) + atan(b) + atan(a) + atan(g) + atan(q)}]
"""


@pytest.fixture(scope="module")
def exact() -> Exact:
    return Exact(mbsym.loads(RING))


@pytest.mark.parametrize(
    ("angle", "closed"),
    [
        ("cos(atan(a/g))", "g/sqrt(a**2 + g**2)"),
        ("sin(atan(a/g))", "a/sqrt(a**2 + g**2)"),
        ("sin(-atan(a/g))", "-a/sqrt(a**2 + g**2)"),
        ("cos(-atan(a/g))", "g/sqrt(a**2 + g**2)"),
        ("cos(2*atan(b))", "(1 - b**2)/(1 + b**2)"),
        ("sin(2*atan(b))", "2*b/(1 + b**2)"),
        ("sin(atan(b))", "b/sqrt(1 + b**2)"),
        ("cos(atan(a) + atan(g))", "(1 - a*g)/(sqrt(1 + a**2)*sqrt(1 + g**2))"),
        ("sin(atan(g/b))", "g/(b*sqrt(1 + g**2/b**2))"),  # the sign of b is that of the sine
        ("sin(pi/2 - atan(b))", "1/sqrt(1 + b**2)"),
        ("sin(q - atan(b))", "(sin(q) - b*cos(q))/sqrt(1 + b**2)"),
        ("cos(pi/2 + q + 2*atan(b))", "-(sin(q)*(1 - b**2) + 2*b*cos(q))/(1 + b**2)"),
        ("cos(atan(q))**2", "1/(1 + q**2)"),
    ],
)
def test_the_closed_form_is_found_and_right(exact: Exact, angle: str, closed: str) -> None:
    ours, theirs = exact(angle), exact(closed)
    assert exact.ring.is_zero(ours.polynomial - theirs.polynomial) is True
    expected = eval(angle, vars(math) | NUMBERS)
    value = exact.ring.evaluate(ours.polynomial, {name: arb(NUMBERS.get(name, 0)) for name in exact.ring.names()})
    assert abs(float(value) - expected) < 1e-12


def test_the_derivative_is_that_of_the_closed_form(exact: Exact) -> None:
    """d/dq sin(atan q) = (1 + q^2)^(-3/2)."""
    slope = exact.ring.derivative(exact("sin(atan(q))").polynomial, "q")
    assert exact.ring.is_zero(slope - exact("1/sqrt(1 + q**2)**3").polynomial) is True


def test_a_pendulum_leans_in_an_accelerating_car() -> None:
    """By hand: th = -atan(a/g) is a motion, identically, and K = m l sqrt(g^2 + a^2)."""
    analysis = mbsym.load(TESTS / "cases" / "statements" / "lean.yaml")
    assert analysis.equilibrium.satisfied
    assert analysis.linearisation.K[0, 0] == Exact(analysis)("m*l*sqrt(g**2 + a**2)")
    verdict = analysis.stability.numerical
    assert verdict is not None
    assert "about 0" not in verdict.explanation
    assert str(verdict.word) != "undecided"
    [root] = [x for x in analysis.stability.spectra[0].roots if x.ball.imag > 0]
    assert abs(complex(root.ball) - 1j * math.sqrt(5)) < 1e-12
