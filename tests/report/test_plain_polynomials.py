"""Polynomials in the terminal: what SymPy reads back is the same, and it is written as people write it."""

from __future__ import annotations

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from mbsym.report.plain_writer import in_powers

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


@given(st.lists(st.sampled_from(COEFFICIENTS), min_size=1, max_size=5))
def test_it_is_the_polynomial(coefficients: list[str]) -> None:
    wanted = sum(sympy.sympify(x) * z**k for k, x in enumerate(coefficients))
    text = in_powers(coefficients, "z")
    assert sympy.expand(sympy.sympify(text) - wanted) == 0
    assert "(1)" not in text
    assert "+ -" not in text


@pytest.mark.parametrize(
    ("coefficients", "told"),
    [
        (["A", "0", "1"], "z**2 + A"),
        (["-c", "a - b", "m"], "m*z**2 + (a - b)*z - c"),
        (["-a - b", "-m"], "-m*z - a - b"),
        (["0", "-1", "0", "1"], "z**3 - z"),
        (["k/m", "(12 terms; see the reports)", "1"], "z**2 + (12 terms; see the reports)*z + k/m"),
        (["0"], "0"),
    ],
)
def test_as_people_write_it(coefficients: list[str], told: str) -> None:
    assert in_powers(coefficients, "z") == told
