"""Numbers as they are printed in a file: exact decimals, and angles that are rounded parts of pi."""

from __future__ import annotations

import math
from decimal import Context, Decimal, InvalidOperation
from fractions import Fraction

from mbsym.expressions.parser import MAX_DIGITS
from mbsym.model.admissibility import principal_minors

Texts = tuple[str, str, str]
NOWHERE: Texts = ("0", "0", "0")

#: Angles printed with fewer digits are not taken for a rounded part of pi: 0.5 is no pi/6.
FEWEST_DIGITS = 4

#: A printed number beyond this power of ten is refused; what is below the last digit of a description is rounded.
_LARGEST_POWER = MAX_DIGITS - 1
_SMALLEST, _EXACTLY = Decimal(1).scaleb(-MAX_DIGITS), Context(prec=2 * MAX_DIGITS + 1)

#: What is longer than this many characters as a plain decimal is written with an exponent.
_PLAIN_POWER = 6


def decimal(text: str) -> Decimal | None:
    """The number that a text is, or None: infinities and monsters are none."""
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return None
    if not value.is_finite() or len(value.as_tuple().digits) > MAX_DIGITS:
        return None
    return value if value == 0 or value.adjusted() <= _LARGEST_POWER else None


def number(text: str) -> str:
    """The number as it is printed, in a form that descriptions accept; zero is 0."""
    value = Decimal(text)
    if int(value.as_tuple().exponent) < -MAX_DIGITS:
        value = value.quantize(_SMALLEST, context=_EXACTLY)
    if value == 0:
        return "0"
    return f"{value.normalize():f}" if abs(value.adjusted()) < _PLAIN_POWER else str(value.normalize())


def angle(text: str) -> str:
    """A multiple of pi/4 or pi/6, if ``text`` is one rounded to the digits that are printed; else the number.

    >>> angle("1.5708"), angle("-0.52359877559"), angle("0.5")
    ('pi/2', '-pi/6', '0.5')
    """
    value = Decimal(text)
    _, digits, exponent = value.as_tuple()
    assert isinstance(exponent, int)
    if len(digits) >= FEWEST_DIGITS:
        for part in (4, 6):
            turns = Fraction(round(float(value) / math.pi * part), part)
            if turns and abs(float(value) - float(turns) * math.pi) <= max(0.5 * 10.0**exponent, 1e-15):
                return multiple_of_pi(turns)
    return number(text)


def multiple_of_pi(turns: Fraction) -> str:
    """``-3*pi/4``."""
    up = {1: "pi", -1: "-pi"}.get(turns.numerator, f"{turns.numerator}*pi")
    return up if turns.denominator == 1 else f"{up}/{turns.denominator}"


def degrees(text: str) -> str:
    """An angle in degrees, exactly, in radians: a fraction of pi.

    >>> degrees("90"), degrees("-22.5"), degrees("0")
    ('pi/2', '-pi/8', '0')
    """
    turns = Fraction(Decimal(text)) / 180
    return multiple_of_pi(turns) if turns else "0"


def opposite(text: str) -> str:
    """The number of the other sign."""
    return text[1:] if text.startswith("-") else text if text == "0" else "-" + text


def is_zero(values: Texts) -> bool:
    """Whether three printed numbers are zero."""
    return all(Decimal(value) == 0 for value in values)


def numbers(values: Texts) -> Texts:
    first, second, third = map(number, values)
    return first, second, third


def is_of_a_body(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether the second moments tr(J)/2 1 - J are positive semidefinite."""
    half = (xx + yy + zz) / 2
    return is_nonnegative(half - xx, -xy, -xz, half - yy, -yz, half - zz)


def is_nonnegative(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether a symmetric matrix is positive semidefinite: all its principal minors are nonnegative."""
    return all(minor >= 0 for minor in principal_minors(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))
