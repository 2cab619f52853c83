"""Changes of a formula, f(x + d) - f(x), without subtracting nearly equal values; over any scalar.

A scalar here is a pair: the value at x, and the change from there to x + d.  The rules are the exact ones of finite
differences, not derivatives:

    a b          da b + (a + da) db
    1/a          -da / (a (a + da))
    sqrt a       da / (sqrt(a + da) + sqrt(a))
    sin a        2 cos(a + da/2) sin(da/2)
    cos a       -2 sin(a + da/2) sin(da/2)
    exp a        2 exp(a + da/2) sinh(da/2)        likewise sinh and cosh;  tanh a: sinh(da)/(cosh(a) cosh(a + da))

Near an equilibrium the energy changes by the square of the deviation, so a deviation of 1e-8 is below the rounding of
float64 in h(x + d) - h(x), and has all its digits here.  Logarithms, arcus tangents, signs and
|a| are subtracted as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.base import Algebra, Scalar
from mbsym.expressions.angles import LinearForm


@dataclass(frozen=True, slots=True)
class Increment:
    """``value`` at x and ``change`` from x to x + d, scalars of ``algebra``."""

    algebra: Algebra
    value: Scalar
    change: Scalar

    @property
    def end(self) -> Scalar:
        """The value at x + d."""
        return self.value + self.change

    def __add__(self, other: Increment) -> Increment:
        return Increment(self.algebra, self.value + other.value, self.change + other.change)

    def __sub__(self, other: Increment) -> Increment:
        return Increment(self.algebra, self.value - other.value, self.change - other.change)

    def __neg__(self) -> Increment:
        return Increment(self.algebra, -self.value, -self.change)

    def __mul__(self, other: Increment) -> Increment:
        times, end = self.algebra.times, self.end
        change = times(self.change, other.value) + times(end, other.change)
        return Increment(self.algebra, times(self.value, other.value), change)


class Increments(Algebra[Increment]):
    """Pairs over ``algebra``; ``angles`` gives every name under sin and cos its value and change."""

    def __init__(self, algebra: Algebra, angles: Mapping[str, Increment]) -> None:
        self.algebra = algebra
        self.angles = angles
        self.zero, self.one = self.number(0), self.number(1)

    def number(self, value: Fraction | int) -> Increment:
        return Increment(self.algebra, self.algebra.number(value), self.algebra.zero)

    def vanishes(self, x: Increment) -> bool:
        return self.algebra.vanishes(x.value) and self.algebra.vanishes(x.change)

    def _half(self, x: Scalar) -> Scalar:
        return self.algebra.times(self.algebra.number(Fraction(1, 2)), x)

    def sin_cos(self, angle: LinearForm) -> tuple[Increment, Increment]:
        change = self.algebra.zero
        for name, coefficient in angle.coefficients:
            change = change + self.algebra.times(self.algebra.number(coefficient), self.angles[name].change)
        total = self.algebra.zero
        for name, coefficient in angle.coefficients:
            total = total + self.algebra.times(self.algebra.number(coefficient), self.angles[name].value)
        if angle.turns:
            total = total + self.algebra.times(self.algebra.number(angle.turns), self.angles["pi"].value)
        return self.sin_cos_of(Increment(self.algebra, total, change))

    def sin_cos_of(self, argument: Increment) -> tuple[Increment, Increment]:
        algebra = self.algebra
        sine, cosine = algebra.sin_cos_of(argument.value)
        if algebra.vanishes(argument.change):
            return Increment(algebra, sine, algebra.zero), Increment(algebra, cosine, algebra.zero)
        half = self._half(argument.change)
        middle = algebra.sin_cos_of(argument.value + half)
        twice = algebra.times(algebra.number(2), algebra.sin_cos_of(half)[0])
        return (
            Increment(algebra, sine, algebra.times(middle[1], twice)),
            Increment(algebra, cosine, -algebra.times(middle[0], twice)),
        )

    def reciprocal(self, x: Increment) -> Increment:
        algebra = self.algebra
        if algebra.vanishes(x.change):
            return Increment(algebra, algebra.reciprocal(x.value), algebra.zero)
        bottom = algebra.reciprocal(algebra.times(x.value, x.end))
        return Increment(algebra, algebra.reciprocal(x.value), -algebra.times(x.change, bottom))

    def square_root(self, x: Increment) -> Increment:
        algebra = self.algebra
        root = algebra.square_root(x.value)
        if algebra.vanishes(x.change):
            return Increment(algebra, root, algebra.zero)
        both = algebra.reciprocal(root + algebra.square_root(x.end))
        return Increment(algebra, root, algebra.times(x.change, both))

    def function(self, name: str, x: Increment) -> Increment:
        algebra = self.algebra
        value = algebra.function(name, x.value)
        if algebra.vanishes(x.change):
            return Increment(algebra, value, algebra.zero)
        half = self._half(x.change)
        outer = {"exp": "exp", "sinh": "cosh", "cosh": "sinh"}.get(name)
        if outer is not None:
            twice = algebra.times(algebra.number(2), algebra.function("sinh", half))
            return Increment(algebra, value, algebra.times(algebra.function(outer, x.value + half), twice))
        if name == "tanh":
            bottom = algebra.times(algebra.function("cosh", x.value), algebra.function("cosh", x.end))
            change = algebra.times(algebra.function("sinh", x.change), algebra.reciprocal(bottom))
            return Increment(algebra, value, change)
        return Increment(algebra, value, algebra.function(name, x.end) - value)
