"""Second-order Taylor polynomials over the ring: "quadratisation" without ever forming the nonlinear equations.

A jet is p0 + sum p_i x_i + sum_{i<=j} p_ij x_i x_j in small deviations x_i, everything of third order dropped.  Running
the kinetic energy and force function over jets expands the Lagrangian about the unperturbed motion while it is being
built, so a system whose closed equations are out of reach can still be linearised (Banshchikov & Vetrov, Problem 5).
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from flint import fmpq

from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Expression

First = dict[int, Polynomial]
Second = dict[tuple[int, int], Polynomial]


class Jet:
    """``value`` + ``first`` + ``second``; coefficients are ring polynomials, absent ones are zero."""

    __slots__ = ("first", "second", "value")

    def __init__(self, value: Polynomial, first: First | None = None, second: Second | None = None) -> None:
        self.value = value
        self.first: First = first or {}
        self.second: Second = second or {}

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, _sum(self.first, other.first), _sum(self.second, other.second))

    def __neg__(self) -> Jet:
        return Jet(-self.value, {k: -v for k, v in self.first.items()}, {k: -v for k, v in self.second.items()})

    def __sub__(self, other: Jet) -> Jet:
        return self + (-other)


def _sum(a: dict[Any, Polynomial], b: dict[Any, Polynomial]) -> dict[Any, Polynomial]:
    total = dict(a)
    for key, value in b.items():
        total[key] = total[key] + value if key in total else value
    return total


def _accumulate(ring: Ring, into: dict[Any, Polynomial], terms: dict[Any, Polynomial], factor: Polynomial) -> None:
    if not factor.is_zero():
        for key, value in terms.items():
            product = ring.times(value, factor)
            into[key] = into[key] + product if key in into else product


class Jets(Algebra[Jet]):
    """Jets over a ring.

    ``motion`` gives each coordinate's unperturbed value as an expression in parameters; a coordinate that is not in it
    (one that turns uniformly) stays the ring's own generator.  ``deviations`` are the indices of the x_i; ``values``
    holds the unperturbed value of every name as a polynomial.
    """

    def __init__(
        self,
        ring: Ring,
        motion: Mapping[str, Expression],
        deviations: Mapping[str, int],
        values: Mapping[str, Polynomial],
    ) -> None:
        self.ring = ring
        self.values = values
        self.motion = motion
        self.deviations = deviations
        self.zero, self.one = Jet(ring.zero), Jet(ring.one)

    def number(self, value: Fraction | int) -> Jet:
        return Jet(self.ring.number(value))

    def deviation(self, index: int, base: Polynomial) -> Jet:
        """base + x_index."""
        return Jet(base, {index: self.ring.one})

    def vanishes(self, x: Jet) -> bool:
        return not x.first and not x.second and bool(x.value.is_zero())

    def times(self, a: Jet, b: Jet) -> Jet:
        """a*b; jets themselves do not multiply, because every product has to keep within the ring's budgets."""
        ring = self.ring
        first: First = {}
        _accumulate(ring, first, a.first, b.value)
        _accumulate(ring, first, b.first, a.value)
        second: Second = {}
        _accumulate(ring, second, a.second, b.value)
        _accumulate(ring, second, b.second, a.value)
        for i, x in a.first.items():
            for j, y in b.first.items():
                key = (i, j) if i <= j else (j, i)
                product = ring.times(x, y)
                second[key] = second[key] + product if key in second else product
        ring.spend(20 * (8 + len(a.second) + len(b.second)))
        return Jet(ring.times(a.value, b.value), first, second)

    def reduce(self, x: Jet) -> Jet:
        reduce = self.ring.reduce
        first = {k: r for k, v in x.first.items() if not (r := reduce(v)).is_zero()}
        second = {k: r for k, v in x.second.items() if not (r := reduce(v)).is_zero()}
        return Jet(reduce(x.value), first, second)

    def sin_cos(self, angle: LinearForm) -> tuple[Jet, Jet]:
        base = LinearForm(turns=angle.turns)
        elsewhere: list[tuple[str, Fraction, Polynomial]] = []
        first: First = {}
        for name, coefficient in angle.coefficients:
            if name in self.deviations:
                first[self.deviations[name]] = self.ring.number(coefficient)
            form: LinearForm | None = LinearForm(((name, Fraction(1)),))
            if name in self.motion:
                form = linear_form(self.motion[name])
            if form is None or (form.constant and not self.adds_constant(form.scaled(self._basic(name)))):
                elsewhere.append((name, coefficient, self.values[name]))
                continue
            base = base + LinearForm(form.coefficients, form.turns).scaled(coefficient)
            if form.constant:
                elsewhere.append((name, coefficient, self.ring.number(form.constant)))
        sine, cosine = self.ring.sin_cos(base)
        for name, coefficient, value in elsewhere:
            s, c = self._at_rest_elsewhere(name, coefficient, value)
            sine, cosine = map(self.ring.reduce, self.ring.sum_of_angles(sine, cosine, s, c))
        return self._turned(sine, cosine, Jet(self.ring.zero, first))

    def adds_constant(self, angle: LinearForm) -> bool:
        return self.ring.adds_constant(angle)

    def _basic(self, name: str) -> Fraction:
        """1/denominator: the share of a name whose sine and cosine are generators."""
        return Fraction(1, self.ring.angles.get(name, 1))

    def _at_rest_elsewhere(self, name: str, coefficient: Fraction, value: Polynomial) -> tuple[Polynomial, Polynomial]:
        """sin and cos of coefficient * value, where the unperturbed value of a name (or what a constant adds to it) is
        no linear form in angles (1/2, l*w).

        Like everywhere in the ring they are made of those of name / denominator, so that both routes meet.
        """
        basic = self.ring.sin_cos_of(value * self.ring.number(self._basic(name)))
        return self.ring.multiple_angle(*basic, int(coefficient / self._basic(name)))

    def sin_cos_of(self, argument: Jet) -> tuple[Jet, Jet]:
        return self._turned(*self.ring.sin_cos_of(argument.value), _small(argument))

    def _turned(self, sine: Polynomial, cosine: Polynomial, u: Jet) -> tuple[Jet, Jet]:
        """sin(a + u) and cos(a + u) for small u: the small parts of sin u and cos u are u and -u^2/2."""
        times, s, c = self.times, Jet(sine), Jet(cosine)
        small_cosine = self.one - times(times(u, u), self.number(Fraction(1, 2)))
        return self.reduce(times(s, small_cosine) + times(c, u)), self.reduce(times(c, small_cosine) - times(s, u))

    def _series(self, x: Jet, value: Polynomial, slope: Polynomial, half_curvature: Polynomial) -> Jet:
        """f(a) + f'(a) u + f''(a)/2 u^2."""
        u = _small(x)
        return self.reduce(Jet(value) + self.times(Jet(slope), u) + self.times(Jet(half_curvature), self.times(u, u)))

    def reciprocal(self, x: Jet) -> Jet:
        inverse = self.ring.reciprocal(x.value)
        square = self.ring.times(inverse, inverse)
        return self._series(x, inverse, -square, self.ring.times(square, inverse))

    def square_root(self, x: Jet) -> Jet:
        if not x.first and not x.second:
            return Jet(self.ring.square_root(x.value))
        root = self.ring.square_root(x.value)
        inverse = self.ring.reciprocal(root)
        half = self.ring.number(Fraction(1, 2))
        eighth = self.ring.number(Fraction(-1, 8))
        cube = self.ring.times(inverse, self.ring.times(inverse, inverse))
        return self._series(x, root, half * inverse, eighth * cube)

    def function(self, name: str, x: Jet) -> Jet:
        ring = self.ring
        half = ring.number(Fraction(1, 2))
        if name in ("sinh", "cosh", "tanh"):
            up, down = self.function("exp", x), self.function("exp", -x)
            sinh, cosh = self.times(up - down, Jet(half)), self.times(up + down, Jet(half))
            if name == "tanh":
                return self.reduce(self.times(sinh, self.reciprocal(cosh)))
            return sinh if name == "sinh" else cosh
        if name in ("abs", "sign"):
            return self._off_the_kink(name, x)
        if isinstance(name, Tabulated):
            return self._tabulated(name, x)
        value = ring.function(name, x.value)
        if name == "exp":
            return self._series(x, value, value, value * half)
        if name == "log":
            inverse = ring.reciprocal(x.value)
            return self._series(x, value, inverse, -half * ring.times(inverse, inverse))
        inverse = ring.reciprocal(ring.one + ring.times(x.value, x.value))
        return self._series(x, value, inverse, -ring.times(x.value, ring.times(inverse, inverse)))

    def _off_the_kink(self, name: str, x: Jet) -> Jet:
        """|a + u| = |a| + sign(a) u and sign(a + u) = sign(a) for small u, where a is not 0.

        Raises NoClosedForm where a is 0, or is not known to be another number: there is no expansion.
        """
        ring = self.ring
        if not x.first and not x.second:
            return Jet(ring.function(name, x.value))
        if ring.is_zero(x.value) is not False:
            what = "kink" if name == "abs" else "jump"
            raise NoClosedForm(f"{name} has a {what} at the motion that is expanded about")
        sign = ring.function("sign", x.value)
        if name == "sign":
            return Jet(sign)
        return self._series(x, ring.function("abs", x.value), sign, ring.zero)

    def _tabulated(self, name: Tabulated, x: Jet) -> Jet:
        """f(a) + f'(a) u + f''(a)/2 u^2 off the knots.

        Raises NoClosedForm where a is a knot at which a derivative jumps, or is not known to be none: it is a number,
        but no rational one, and its ball holds a knot.
        """
        ring = self.ring
        if not x.first and not x.second:
            return Jet(ring.function(name, x.value))
        ball = ring.constant_value(x.value)
        if ball is not None and any(
            name.curve.kinked_at(knot) and ball.contains(fmpq(knot.numerator, knot.denominator))
            for knot in name.curve.knots
        ):
            raise NoClosedForm(f"the table {name.table.name} has a kink at the motion that is expanded about")
        slope, bend = name.slope, name.slope.slope
        half = ring.number(Fraction(1, 2))
        values = [ring.function(one, x.value) for one in (name, slope, bend)]
        return self._series(x, values[0], values[1], ring.times(half, values[2]))


class FirstOrderJets(Jets):
    """Jets whose second-order parts are dropped: f(a + u) = f(a) + f'(a) u."""

    def times(self, a: Jet, b: Jet) -> Jet:
        first: First = {}
        _accumulate(self.ring, first, a.first, b.value)
        _accumulate(self.ring, first, b.first, a.value)
        return Jet(self.ring.times(a.value, b.value), first)


def _small(x: Jet) -> Jet:
    return Jet(x.value * 0, x.first, x.second)
