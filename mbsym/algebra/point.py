"""Numbers at one state: exact rationals through half-angle tangents, rigorous balls; and floats at many states.

At a point where every angle is given by a rational t through sin = 2t/(1+t^2), cos = (1-t^2)/(1+t^2), everything
that is polynomial in sines and cosines is a rational number, so two routes must agree exactly, without tolerance.
A coordinate that also occurs outside sin and cos gets an independent rational value there: the identities that are
compared are identities of the ring, in which q, sin q and cos q are independent but for sin^2 + cos^2 = 1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from flint import acb, arb, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.failures import NotRational, NoValue, SingularPoint
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.table import Curve, Tabulated

#: Multiples of an angle up to this one are formed from its sine and cosine.
MOST_MULTIPLE = 256


class Rationals(Algebra[fmpq]):
    """``fmpq`` scalars.  ``half_tangents`` gives t for each angle name; ``denominators`` the d of sin(name / d)."""

    def __init__(self, half_tangents: Mapping[str, fmpq], denominators: Mapping[str, int]) -> None:
        self.zero, self.one = fmpq(0), fmpq(1)
        self.denominators = denominators
        self.basic = {name: sine_and_cosine(t) for name, t in half_tangents.items()}

    def number(self, value: Fraction | int) -> fmpq:
        return rationals.exact(value)

    def sin_cos(self, angle: LinearForm) -> tuple[fmpq, fmpq]:
        sine, cosine = _quarter_turns(angle.turns)
        for name, coefficient in angle.coefficients:
            if name not in self.basic:
                raise NoValue(name)
            s, c = self.basic[name]
            n = coefficient * self.denominators[name]
            if abs(n) > MOST_MULTIPLE:
                raise NotRational("sin and cos of a high multiple of an angle are too long as rational numbers")
            for _ in range(abs(int(n))):
                sign = 1 if n > 0 else -1
                sine, cosine = sine * c + sign * cosine * s, cosine * c - sign * sine * s
        return sine, cosine

    def sin_cos_of(self, argument: Scalar) -> tuple[Scalar, Scalar]:
        raise NotRational("an angle that is no linear form")

    def reciprocal(self, x: fmpq) -> fmpq:
        if x == 0:
            raise SingularPoint("division by zero")
        return 1 / x

    def square_root(self, x: fmpq) -> fmpq:
        if x < 0:
            raise NotRational("the square root of a negative number")
        top, bottom = x.p.isqrt(), x.q.isqrt()
        if top * top != x.p or bottom * bottom != x.q:
            raise NotRational("an irrational square root")
        return fmpq(top, bottom)

    def function(self, name: str, x: Scalar) -> Scalar:
        if name in ("abs", "sign"):
            return abs(x) if name == "abs" else fmpq((x > 0) - (x < 0))
        if isinstance(name, Tabulated):
            value = name.curve(rationals.fraction(x))
            return rationals.exact(value)
        raise NotRational("[[name]] of a rational number", name=name)


def sine_and_cosine(half_tangent: fmpq) -> tuple[fmpq, fmpq]:
    """2t/(1 + t^2) and (1 - t^2)/(1 + t^2)."""
    bottom = 1 + half_tangent * half_tangent
    return 2 * half_tangent / bottom, (1 - half_tangent * half_tangent) / bottom


def _quarter_turns(turns: Fraction) -> tuple[fmpq, fmpq]:
    quarter = turns * 2
    if quarter.denominator != 1:
        raise NotRational("sin and cos of a fraction of pi")
    sine, cosine = ((0, 1), (1, 0), (0, -1), (-1, 0))[int(quarter) % 4]
    return fmpq(sine), fmpq(cosine)


class Balls(Algebra[arb]):
    """``arb`` scalars: rigorous enclosures at the working precision; ``angles`` gives each angle's value."""

    def __init__(self, angles: Mapping[str, arb]) -> None:
        self.zero, self.one = arb(0), arb(1)
        self.values = angles

    def number(self, value: Fraction | int) -> arb:
        return rationals.ball(value)

    def vanishes(self, x: arb) -> bool:
        return bool(x.is_zero())

    def sin_cos(self, angle: LinearForm) -> tuple[arb, arb]:
        total = arb.pi() * self.number(angle.turns)
        for name, coefficient in angle.coefficients:
            if name not in self.values:
                raise NoValue(name)
            total += self.number(coefficient) * self.values[name]
        sine: Any = total.sin()
        return sine, total.cos()

    def sin_cos_of(self, argument: Scalar) -> tuple[Scalar, Scalar]:
        return argument.sin(), argument.cos()

    def reciprocal(self, x: arb) -> arb:
        return 1 / x

    def square_root(self, x: arb) -> arb:
        return x.sqrt()

    def function(self, name: str, x: Scalar) -> Scalar:
        return enclosed(name, x)


def enclosed(name: str, x: arb) -> arb:
    """A ball that holds f(x) for every x of a ball; [-1, 1] for the sign of what may be 0."""
    if isinstance(name, Tabulated):
        return _tabulated(name.curve, x)
    enclosure: arb = getattr(x, {"abs": "__abs__", "sign": "sgn"}.get(name, name))()
    return enclosure


def _tabulated(curve: Curve, x: arb) -> arb:
    """The union of what the pieces are that a ball touches, each on its part of the ball."""
    if not x.is_finite():
        return arb("nan")
    lower, upper = (rationals.fraction(rationals.middle(end)) for end in (x.lower(), x.upper()))
    union = arb("nan")
    for piece in range(curve.pieces_at(lower)[0], curve.pieces_at(upper)[-1] + 1):
        u = x if lower == upper else _part(curve, piece, x, lower, upper)
        u = u - rationals.ball(curve.bases[piece])
        value = arb(0)
        for coefficient in reversed(curve.polynomials[piece]):
            value = value * u + rationals.ball(coefficient)
        union = union.union(value) if union.is_finite() else value
    if lower == upper and len(curve.pieces_at(lower)) == 2:  # at a knot it is the mean
        mean = curve(lower)
        return rationals.ball(mean)
    return union


def _part(curve: Curve, piece: int, x: arb, lower: Fraction, upper: Fraction) -> arb:
    """What of a ball lies over a piece."""
    ends = (None, *curve.knots, None)
    left, right = ends[piece], ends[piece + 1]
    low = lower if left is None else max(lower, left)
    high = upper if right is None else min(upper, right)
    if (low, high) == (lower, upper):
        return x
    return rationals.ball(low).union(rationals.ball(high))


class BallsAtRationals(Balls):
    """Balls at a state that is rational but for the roots and functions in the formulas: the ``half_tangents`` t of the
    angles and the ``exact`` values of the names.

    What is polynomial there is computed exactly and enclosed last: many times faster than with balls throughout.  As in
    ``Rationals``, q, sin q and cos q are independent; so every angle has to be a linear form.
    """

    def __init__(
        self, half_tangents: Mapping[str, fmpq], denominators: Mapping[str, int], exact: Mapping[str, fmpq]
    ) -> None:
        super().__init__({name: arb(value) for name, value in exact.items()})
        self.denominators, self.exact = denominators, exact
        self.basic = {name: sine_and_cosine(t) for name, t in half_tangents.items()}

    def sin_cos(self, angle: LinearForm) -> tuple[arb, arb]:
        point = (acb(0, 1) * acb.pi() * acb(self.number(angle.turns))).exp()
        for name, coefficient in angle.coefficients:
            sine, cosine = self.basic[name]
            multiple = coefficient * self.denominators[name]
            if multiple.denominator != 1:
                raise NotRational(
                    "sin and cos of [[coefficient]]*[[name]] were not foreseen", coefficient=coefficient, name=name
                )
            point *= acb(arb(cosine), arb(sine)) ** int(multiple)
        return point.imag, point.real


class Arrays(Algebra):
    """NumPy arrays of floats, many points at once; ``angles`` gives each angle's values."""

    def __init__(self, angles: Mapping[str, Any]) -> None:
        import numpy  # here, because reading a description needs exact numbers only

        self.zero, self.one = 0.0, 1.0
        self.values, self._functions = angles, numpy

    def number(self, value: Fraction | int) -> float:
        return float(value)

    def vanishes(self, x: Any) -> bool:
        return isinstance(x, float) and x == 0

    def sin_cos(self, angle: LinearForm) -> tuple[Any, Any]:
        total: Any = math.pi * float(angle.turns)
        for name, coefficient in angle.coefficients:
            total = total + float(coefficient) * self.values[name]
        return self.sin_cos_of(total)

    def sin_cos_of(self, argument: Any) -> tuple[Any, Any]:
        return self._functions.sin(argument), self._functions.cos(argument)

    def reciprocal(self, x: Any) -> Any:
        return self._functions.true_divide(1.0, x)

    def square_root(self, x: Any) -> Any:
        return self._functions.sqrt(x)

    def function(self, name: str, x: Any) -> Any:
        if isinstance(name, Tabulated):
            from mbsym.algebra.lookup import looked_up  # NumPy's

            return looked_up(name.curve, x)
        return getattr(self._functions, {"atan": "arctan"}.get(name, name))(x)
