"""Constants of generated code."""

from __future__ import annotations

from fractions import Fraction

from mbsym.algebra.failures import Limit, NoClosedForm


def number(value: Fraction) -> str:
    """A correctly rounded constant: decimals where they are exact, else a quotient of exact numbers if it is short.

    Raises NoClosedForm beyond the range of double.
    """
    try:
        shown = repr(float(value))
    except OverflowError:
        raise NoClosedForm("a number in it is beyond 1.8e308, where double ends", limit=Limit.DIGITS) from None
    if Fraction(shown) == value or max(abs(value.numerator), value.denominator) > 10**6:
        return shown
    return f"{value.numerator}.0/{value.denominator}.0"
