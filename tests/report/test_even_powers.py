"""Polynomials in lambda**2 in words of formulas: what SymPy reads back is the same."""

from __future__ import annotations

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from mbsym.report.even_powers import in_even_powers

COEFFICIENTS = (
    "0",
    "1",
    "-1",
    "m",
    "-m*a",
    "a - b",
    "-a - b",
    "(a - b)*(a + b)",
    "-(a - b)",
    "m*(a + b)**2/3",
    "-2*m**2",
)
z = sympy.Symbol("z")


def plain(coefficients):
    return in_even_powers(coefficients, lambda k: f"z**{k}", "*")


@given(st.lists(st.sampled_from(COEFFICIENTS), min_size=1, max_size=4))
def test_it_is_the_polynomial(coefficients):
    wanted = sum(sympy.sympify(x) * z ** (2 * k) for k, x in enumerate(coefficients))
    text = plain(coefficients)
    assert sympy.expand(sympy.sympify(text) - wanted) == 0
    assert "(1)" not in text
    assert "+ -" not in text


@pytest.mark.parametrize(
    ("coefficients", "told"),
    [
        (["A", "1"], "z**2 + A"),
        (["-c", "a - b", "m"], "m*z**4 + (a - b)*z**2 - c"),
        (["-a - b", "-m"], "-m*z**2 - a - b"),
        (["0", "-1", "1"], "z**4 - z**2"),
    ],
)
def test_as_people_write_it(coefficients, told):
    assert plain(coefficients) == told


def test_braces_of_latex_are_brackets():
    assert (
        in_even_powers(["1", "\\frac{a + b}{c}"], lambda k: f"\\lambda^{{{k}}}", "\\,")
        == "\\frac{a + b}{c}\\,\\lambda^{2} + 1"
    )
