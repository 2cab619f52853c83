"""Rational numbers of Python and of the number library, and as balls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import arb, fmpq, fmpq_mpoly

from mbsym.algebra.terms import evaluated


def fraction(x: fmpq) -> Fraction:
    """Python's."""
    return Fraction(int(x.p), int(x.q))


def exact(value: Fraction | int) -> fmpq:
    """The library's."""
    return fmpq(value.numerator, value.denominator)


def ball(value: Fraction | int) -> arb:
    """As small as the working precision allows."""
    return arb(exact(value))


def middle(value: arb) -> fmpq:
    """Of a ball, exactly."""
    mantissa, exponent = value.mid().man_exp()
    return fmpq(int(mantissa)) * fmpq(2) ** int(exponent)


def value_at(p: fmpq_mpoly, point: Sequence[Any], kind: type) -> Any:
    """A polynomial at numbers in balls, real or complex (``kind``: arb, acb)."""
    return evaluated(p, lambda k, exponent: point[k] ** exponent, kind)


def rounded(x: float, digits: int) -> fmpq:
    """A number to some significant digits."""
    if x == 0:
        return fmpq(0)
    scale = Fraction(10) ** (digits - 1 - math.floor(math.log10(abs(x))))
    return exact(Fraction(round(Fraction(x) * scale)) / scale)


def square_root(x: fmpq) -> fmpq | None:
    """The root that is not negative, if that is rational."""
    if x < 0:
        return None
    top, bottom = x.p.isqrt(), x.q.isqrt()
    return fmpq(top, bottom) if top * top == x.p and bottom * bottom == x.q else None
