"""Polynomials in y over the field QQ(alpha) of a real algebraic number, and their real roots.

An element is a ``fmpq_poly`` in alpha of lower degree than alpha's minimal polynomial m, zero exactly where its value
is; a polynomial is a list of elements, from low to high powers of y, without vanishing leading ones.  Greatest common
divisors are Euclid's; roots are isolated by balls around the coefficients, after the polynomial is square-free by that
exact arithmetic, at whatever precision it takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane.numbers import AlgebraicNumber, Ball, Rational, between, sign

Element = Any  # a flint.fmpq_poly in alpha
OverField = list[Element]

#: Bits at which roots over a field are given up: such roots would be closer than 2^-20000.
MOST_BITS = 40_000

ZERO = fmpq_poly([0])


@dataclass(eq=False)
class Extension:
    """QQ(alpha) with alpha real."""

    alpha: AlgebraicNumber
    modulus: Any = field(init=False)

    def __post_init__(self) -> None:
        self.modulus = self.alpha.modulus

    def inverse(self, a: Element) -> Element:
        """1/a.  Raises ZeroDivisionError for zero."""
        if a == 0:
            raise ZeroDivisionError("division by zero in a number field")
        unit, cofactor, _ = a.xgcd(self.modulus)
        return cofactor / unit[0] % self.modulus

    def sign(self, a: Element) -> int:
        return self.alpha.sign(a)

    def trimmed(self, p: Sequence[Element]) -> OverField:
        """Reduced modulo m, without vanishing leading elements."""
        found = [x % self.modulus for x in p]
        while found and found[-1] == 0:
            found.pop()
        return found

    def monic(self, p: OverField) -> OverField:
        if not p or p[-1] == 1:
            return p
        inverse = self.inverse(p[-1])
        return [*(x * inverse % self.modulus for x in p[:-1]), fmpq_poly([1])]

    def divided(self, a: OverField, b: OverField) -> tuple[OverField, OverField]:
        """(quotient, remainder) by a monic b."""
        rest = list(a)
        quotient = [ZERO] * max(len(a) - len(b) + 1, 0)
        while len(rest) >= len(b):
            top, shift = rest.pop(), len(rest) - len(b) + 1
            quotient[shift] = top
            if top != 0:
                for k, x in enumerate(b[:-1]):
                    rest[shift + k] = (rest[shift + k] - top * x) % self.modulus
        return quotient, self.trimmed(rest)

    def gcd(self, a: OverField, b: OverField) -> OverField:
        """The monic greatest common divisor; [1] where there is none."""
        a, b = self.monic(a), self.monic(b)
        while b:
            a, b = b, self.monic(self.divided(a, b)[1])
        return a

    def derivative(self, p: OverField) -> OverField:
        return self.trimmed([x * k for k, x in enumerate(p)][1:])

    def squarefree(self, p: OverField) -> OverField:
        """The monic polynomial with the same roots, each once."""
        p = self.monic(p)
        common = self.gcd(p, self.derivative(p)) if len(p) > 2 else [fmpq_poly([1])]
        return p if len(common) == 1 else self.divided(p, common)[0]

    def at(self, p: OverField, y: Rational) -> Element:
        """p(y) as an element."""
        total = ZERO
        for x in reversed(p):
            total = total * y + x
        return total

    def balls(self, p: OverField, bits: int) -> Any:
        """p with balls for its coefficients."""
        alpha = self.alpha.enclosure(bits)
        with ctx.workprec(2 * bits + 20):
            return arb_poly([self._ball(x, alpha) for x in p])

    @staticmethod
    def _ball(x: Element, alpha: Ball) -> Any:
        return arb_poly(x)(alpha)

    def roots(self, p: OverField) -> list[Over]:
        """The real roots of a monic square-free polynomial, ascending."""
        if len(p) < 2:
            return []
        bits = 64
        while bits <= MOST_BITS:
            found = self._roots(p, bits)
            if found is not None:
                return found
            bits *= 2
        raise TooLargeError("roots over a number field lie too close together", limit=Limit.DIGITS)

    def _roots(self, p: OverField, bits: int) -> list[Over] | None:
        if len(p) == 2:
            return [Over(self, p, *self._around(p, bits))]
        with ctx.workprec(bits):
            try:
                balls = self.balls(p, bits).complex_roots()
            except ValueError:
                return None
        return self._real(p, balls)

    def _real(self, p: OverField, balls: Sequence[Any]) -> list[Over] | None:
        """The real ones among isolated simple roots of p, ascending; None where the balls are too wide for that."""
        found = []
        for ball in balls:
            if not ball.imag.contains(0):
                continue
            image = ball.conjugate()
            if any(image.overlaps(other) for other in balls if other is not ball):
                return None
            low, high = ends(ball.real)
            signs = [self.sign(self.at(p, end)) for end in (low, high)]
            if 0 in signs:  # it is one end
                low = high = low if signs[0] == 0 else high
            elif signs[0] == signs[1]:  # its own mirror image, so real, and simple: the ends are too far in
                return None
            found.append(Over(self, p, low, high))
        found.sort(key=lambda root: root.low + root.high)
        return found if all(a.high < b.low for a, b in pairwise(found)) else None

    def double_root(self, p: OverField) -> tuple[Over, list[Over]] | None:
        """(the double root, the other real roots) of a monic polynomial with one double root and else simple ones.

        The double one is the root of p' that is one of p, and real, as it is its own conjugate.  None where balls of
        4096 bits do not isolate the roots.
        """
        slope, bits = self.monic(self.derivative(p)), 64
        while bits <= 4096:
            found = self._double_root(p, slope, bits)
            if found is not None:
                return found
            bits *= 2
        return None

    def _double_root(self, p: OverField, slope: OverField, bits: int) -> tuple[Over, list[Over]] | None:
        with ctx.workprec(bits):
            try:
                whole = self.balls(p, bits)
                common = [ball for ball in self.balls(slope, bits).complex_roots() if whole(ball).contains(0)]
                if len(common) != 1:
                    return None
                twice = common[0].real
                rest = _deflated(_deflated(whole.coeffs(), twice), twice)
                balls = arb_poly(rest).complex_roots() if len(rest) > 1 else []
            except ValueError:
                return None
        doubles = [Over(self, slope, *self._around(slope, bits))] if len(slope) == 2 else self._real(slope, common)
        simple = self._real(p, balls)
        if doubles is None or simple is None or len(doubles) != 1:
            return None
        double = doubles[0]
        if any(a.low <= double.high and double.low <= a.high for a in simple):
            return None
        return double, simple

    def _around(self, p: OverField, bits: int) -> tuple[Rational, Rational]:
        """An interval around the root of y + c."""
        constant = -p[0]
        if constant.degree() < 1:
            return constant[0], constant[0]
        return ends(self.alpha.value(constant, bits))


@dataclass(eq=False)
class Over:
    """The only root in [low, high] of a polynomial over QQ(alpha), a simple one; low = high where it is rational.

    ``shared``: further polynomials with this root.
    """

    over: Extension
    polynomial: OverField
    low: Rational
    high: Rational
    _rising: int = field(default=0, repr=False)
    shared: list[OverField] = field(default_factory=list, repr=False)

    @property
    def exact(self) -> Rational | None:
        """The number, where it is known to be rational."""
        return self.low if self.low == self.high else None

    def halve(self) -> None:
        """Halves the interval."""
        if self.low == self.high:
            return
        if not self._rising:
            self._rising = self.over.sign(self.over.at(self.polynomial, self.high))
            if self._rising == 0:
                self.low = self.high
                return
        middle = (self.low + self.high) / 2
        value = self.over.sign(self.over.at(self.polynomial, middle))
        if value == 0:
            self.low = self.high = middle
        elif value == self._rising:
            self.high = middle
        else:
            self.low = middle

    def narrow(self, width: Rational) -> None:
        """Halves until the interval is at most this wide."""
        while self.high - self.low > width:
            self.halve()

    def compare(self, value: Rational) -> int:
        """The sign of (this number - value)."""
        if self.low <= value <= self.high and self.low != self.high:
            if self.over.at(self.polynomial, value) % self.over.modulus == 0:
                self.low = self.high = value
            while self.low <= value <= self.high and self.low != self.high:
                self.halve()
        return sign(self.low - value) if self.low == self.high else 1 if self.low > value else -1

    def enclosure(self, bits: int) -> Ball:
        """A ball around it whose radius is about 2^-bits times its size, or 2^-bits near 0."""
        size = max(abs(self.low), abs(self.high), fmpq(1, 1 << 40))
        self.narrow(size / (1 << bits))
        return between(self.low, self.high, bits + 30)

    def sign(self, g: OverField) -> int:
        """The sign of g, a polynomial over the same field, at this root."""
        field_ = self.over
        g = field_.trimmed(g)
        if len(g) == 0:
            return 0
        if len(g) == 1:
            return field_.sign(g[0])
        bits = 40
        while True:
            if bits == 160:  # most that are not zero have shown it by now
                common = field_.gcd(self.polynomial, g)
                if len(common) > 1 and self.vanishes(common):
                    return 0
            with ctx.workprec(2 * bits + 40):
                value = field_.balls(g, bits)(self.enclosure(bits))
            if value > 0 or value < 0:
                return 1 if value > 0 else -1
            bits *= 2

    def shrink(self) -> None:
        """Puts what the polynomial has in common with those shared in its place."""
        while self.shared and len(self.polynomial) > 2:
            common = self.over.gcd(self.polynomial, self.shared.pop())
            if 1 < len(common) < len(self.polynomial):
                self.restrict(common)

    def restrict(self, divisor: OverField) -> None:
        """Puts a monic divisor that vanishes at this root in place of the polynomial."""
        self.polynomial, self._rising = divisor, 0

    def vanishes(self, divisor: OverField) -> bool:
        """Whether a monic divisor of this root's polynomial vanishes at it."""
        if len(divisor) == len(self.polynomial):
            return True
        at = self.over.at
        if self.low == self.high:
            return bool(at(divisor, self.low) % self.over.modulus == 0)
        return self.over.sign(at(divisor, self.low)) * self.over.sign(at(divisor, self.high)) < 0

    def __float__(self) -> float:
        return float(self.enclosure(60).mid())


def ends(ball: Ball) -> tuple[Rational, Rational]:
    """Rational numbers that enclose a ball."""

    def rational(x: Any) -> Rational:
        mantissa, exponent = x.man_exp()
        return fmpq(int(mantissa)) * fmpq(2) ** int(exponent)

    return rational(arb(ball).lower()), rational(arb(ball).upper())


def _deflated(coefficients: Sequence[Ball], root: Ball) -> list[Ball]:
    """The quotient by (y - root), in balls; coefficients from low to high powers."""
    quotient: list[Ball] = []
    carried = arb(0)
    for c in reversed(coefficients[1:]):
        carried = carried * root + c
        quotient.append(carried)
    return quotient[::-1]
