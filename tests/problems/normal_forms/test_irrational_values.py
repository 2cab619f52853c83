"""Resonances at values with square roots: told exactly, and the same as in units in which the values are rational."""

from __future__ import annotations

import pytest

import mbsym
from mbsym.problems.normal_forms.result import Outcome, Theorem, Why
from mbsym.problems.stability.words import Word

#: A charge on the top of a hill in a magnetic field: w = n +- sqrt(n^2 - k), of which w_1 w_2 = k, w_1 + w_2 = 2 n.
HILL = """
mbsym: 1
name: a charge on a hill
parameters: {{n: positive, k: positive, c: real, d: real}}
motion: {{x: 0, y: 0}}
bodies:
  - {{name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 0}}
  - {{name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: 1}}
loads:
  - potential: -k*(x**2 + y**2)/2 + c*(x**3 - 3*x*y**2) + d*x**2*y
  - generalized force: {{x: 2*n*y_dot, y: -2*n*x_dot}}
values: {{n: {n}, k: {k}, c: 1, d: {d}}}
"""


def _judged(**values):
    return mbsym.loads(HILL.format(**values)).normal_forms.at_values


@pytest.mark.parametrize(("n", "k"), [("3/sqrt(2)", 4), (3, 8), ("3*sqrt(3)", 24), ("3/sqrt(2)", "sqrt(16)")])
def test_one_to_two_at_three_over_the_root_of_two(n, k):
    """8 n^2 = 9 k: w_1 = 2 w_2.  Both oscillations turn the same way, and a third of a turn carries x^3 - 3 x y^2 into

    itself: a term  A_1 conj(A_2)^2  is carried into exp(-2 pi i/3) times itself, so that it is none of the potential's.
    """
    found = _judged(n=n, k=k, d=0)
    assert [one.vector for one in found.resonances] == [(1, -2)]
    assert (found.outcome, found.theorem) == (Outcome.STABLE, Theorem.ARNOLD_MOSER)


@pytest.mark.parametrize(("n", "k"), [("3/sqrt(2)", 4), (3, 8)])
def test_a_term_of_the_resonance_makes_it_unstable(n, k):
    """x^2 y holds what a third of a turn does not keep: energies of opposite signs grow together (Markeev)."""
    found = _judged(n=n, k=k, d=1)
    assert [one.vector for one in found.resonances] == [(1, -2)]
    assert found.outcome is Outcome.UNSTABLE


def test_beside_the_resonance_it_is_none():
    """n^2 = 9/2 + 1/10^6: enclosures exclude it."""
    found = _judged(n="sqrt(4500001/1000000)", k=4, d=1)
    assert not found.resonances
    assert found.outcome is Outcome.STABLE


def test_roots_that_depend_on_each_other_decide_nothing():
    """sqrt(2) and sqrt(8) are two roots of the tower, where sqrt(8) - 2 sqrt(2) is no zero: nothing is denied by it."""
    found = _judged(n="3/sqrt(2)", k="2*sqrt(2)*sqrt(8)/2", d=0)
    assert found.why is Why.RESONANCE_OPEN


def test_the_frequencies_of_a_penning_trap_add_up():
    """w_+ + w_- = w_c = 2 w_z, of w_+- = (2 +- sqrt(2))/2, whose squares are not rational."""
    text = HILL.format(n=1, k="1/2", d=0).replace("k*(x**2 + y**2)/2", "k*(x**2 + y**2 - 2*z**2)/2 + z**2*x**2")
    text = text.replace("motion: {x: 0, y: 0}", "motion: {x: 0, y: 0, z: 0}").replace("mass: 1}", "mass: 0}")
    body = "  - {name: c, attached to: b, connection point: [0, 0, z], coordinates: [z], mass: 1}\nloads:"
    found = mbsym.loads(text.replace("loads:", body)).normal_forms.at_values
    assert [one.vector for one in found.resonances] == [(1, -2, 1)]


PLANE = """
mbsym: 1
name: a valley
parameters: {m: positive, a: real}
bodies:
  - {name: p, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - potential: (BORDER)*x**2 + FURTHER + y**2
  - rayleigh: c*(x_dot**2 + y_dot**2)
motion: {x: 0, y: 0}
values: {m: 1, a: VALUE}
"""


@pytest.mark.parametrize("damping", [0, 1])
@pytest.mark.parametrize(("further", "stays"), [("x**4 + x*y**2", True), ("x**2*y + x**4/5", False), ("a*x**3", False)])
@pytest.mark.parametrize(
    ("border", "value", "rises"),
    [
        ("cos(a) - 1/2", "pi/3", False),
        ("cos(a/2) - sqrt(3)/2", "pi/3", False),
        ("cos(2*a) + 1/2", "pi/3", False),
        ("tan(a) - 1", "pi/4", True),
        ("sin(a) - cos(a)", "-3*pi/4", False),
        ("a**2 - pi**2/9", "pi/3", True),
        ("a*cos(a) - pi/6", "pi/3", False),
        ("a*cos(a) - sqrt(2)*pi/8", "pi/4", True),
    ],
)
def test_terms_of_higher_order_where_a_sine_makes_the_border(border, value, rises, further, stays, damping):
    """x^2 y + x^4/5 + y^2 is -x^4/20 along y = -x^2/2; beside the border the first approximation decides."""
    text = PLANE.replace("BORDER", border).replace("FURTHER", further).replace("VALUE", value)
    text = text.replace("c*(", "(") if damping else text.replace("  - rayleigh: c*(x_dot**2 + y_dot**2)\n", "")
    staying = Outcome.ASYMPTOTIC if damping else Outcome.STABLE
    assert mbsym.loads(text).normal_forms.at_values.outcome is (staying if stays else Outcome.UNSTABLE)
    beside = mbsym.loads(text.replace(f"a: {value}", f"a: {value} + 1/10**40"), (4, 5, 6)).stability.numerical
    assert beside.word is ((Word.ASYMPTOTIC if damping else Word.STABLE) if rises else Word.UNSTABLE)
