"""Formulas as text, compared exactly; what is equal and what differs is known by hand."""

from __future__ import annotations

import pytest

from mbsym.diff.formulas import Known, compared

KNOWN = Known(frozenset({"q", "q1", "q2"}), {"m": "positive", "k": "positive", "n": "negative", "s": "nonnegative"})

EQUAL = [
    ("sin(q)**2 + cos(q)**2", "1"),
    ("(m + k)*(m - k)", "m**2 - k**2"),
    ("cos(q1 - q2)", "cos(q1)*cos(q2) + sin(q1)*sin(q2)"),
    ("sin(2*q)", "2*sin(q)*cos(q)"),
    ("sin(q)", "2*sin(q/2)*cos(q/2)"),
    ("1/(m + k) + 1/(m - k)", "2*m/(m**2 - k**2)"),
    ("sqrt(m**2*k)", "m*sqrt(k)"),
    ("sqrt(8)", "2*sqrt(2)"),
    ("tan(q)*cos(q)", "sin(q)"),
    ("q_dot*(m + k)/2", "m*q_dot/2 + 0.5*k*q_dot"),
    ("exp(q)/exp(q)", "1"),
]

DIFFERENT = [
    ("m*k", "m*k + k", "k"),
    ("m - k", "m + k", "2*k"),
    ("cos(q)", "sin(q)", "sin(q) - cos(q)"),
    ("q_dot**2", "q_dot**3", "q_dot**2*(q_dot - 1)"),
    ("sqrt(m)", "2*sqrt(m)", "sqrt(m)"),
    ("exp(q)", "2*exp(q)", "exp(q)"),
    ("atan(q)", "atan(q) + m", "m"),
]


@pytest.mark.parametrize(("a", "b"), EQUAL)
def test_equal_formulas_are_equal_whatever_they_look_like(a: str, b: str) -> None:
    assert compared(a, b, KNOWN).equal is True
    assert compared(b, a, KNOWN).equal is True


@pytest.mark.parametrize(("a", "b", "difference"), DIFFERENT)
def test_of_different_ones_the_difference_is_told(a: str, b: str, difference: str) -> None:
    found = compared(a, b, KNOWN)
    assert found.equal is False
    assert compared(found.difference, difference, KNOWN).equal is True
    assert found.terms > 0


def test_what_cannot_be_decided_is_said_so_and_not_called_equal() -> None:
    """log(exp q) = q, sqrt((1 + cos q)^2) = 1 + cos q: true for real numbers, and no ring knows."""
    for a, b in (("log(exp(q))", "q"), ("sqrt((1 + cos(q))**2)", "1 + cos(q)"), ("exp(q)*exp(m)", "exp(q + m)")):
        found = compared(a, b, KNOWN)
        assert (found.equal, found.points) == (None, 8)
    # A number at a point proves that these are not equal, whatever the ring knows of them.
    assert compared("log(exp(q))", "q + m/1000000", KNOWN).equal is False


def test_a_square_root_of_a_square_has_the_sign_that_is_declared() -> None:
    assert compared("sqrt(m**2)", "m", KNOWN).equal is True
    assert compared("sqrt(n**2)", "-n", KNOWN).equal is None
    assert compared("sqrt(n**2)", "n", KNOWN).equal is False
    assert compared("sqrt(x**2)", "x", KNOWN).equal is None


def test_long_formulas_are_read_and_long_differences_counted() -> None:
    terms = [f"m**{k % 60}*k**{k // 60}*cos(q)" for k in range(900)]
    a, b = " + ".join(terms), " + ".join(reversed(terms))
    assert compared(a, b, KNOWN).equal is True
    found = compared(a, " - ".join(terms), KNOWN)
    assert (found.equal, found.terms, found.difference) == (False, 899, "")
    assert found.first


def test_what_is_no_formula_is_no_reason_to_fail() -> None:
    for bad in ("m +", "(" * 5000, "__import__('os')", "m**(k)", "9**9**9**9", "", "lambda: 1"):
        found = compared("m", bad, KNOWN)
        assert found.equal is not True
        assert found.difference == ""
