"""Real algebraic numbers, each a root of an irreducible polynomial in an interval of rational ends; all answers exact.

Roots in an interval are isolated by Descartes' rule after Moebius' substitution (Collins & Akritas 1976): with
q(t) = (1 + t)^n p((a + b t)/(1 + t)) the number of sign changes of q's coefficients is at least the number of roots of
p in (a, b), of the same parity; 0 and 1 are exact.  Halving ends because p is square-free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cmp_to_key
from itertools import pairwise
from typing import Any

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz_poly

from mbsym.algebra import rationals
from mbsym.algebra.roots import by_square_root
from mbsym.expressions.tree import Expression

Rational = Any  # a flint.fmpq
Integer = Any  # a flint.fmpz_poly
Univariate = Any  # a flint.fmpq_poly
Ball = Any  # a flint.arb

_SHIFT = fmpz_poly([1, 1])


class Isolated:
    """The only root of a polynomial in [low, high]; low = high where it is known to be rational.

    The interval shrinks where a question needs that.
    """

    low: Rational
    high: Rational
    _rising: int

    def sign_at(self, x: Rational) -> int:
        """The sign of the polynomial there."""
        raise NotImplementedError

    def narrow(self, width: Rational) -> None:
        """Shrinks the interval until it is at most this wide."""
        raise NotImplementedError

    @property
    def exact(self) -> Rational | None:
        """The number, where it is known to be rational."""
        return self.low if self.low == self.high else None

    def halve(self) -> None:
        """Halves the interval."""
        if self.low == self.high:
            return
        if not self._rising:
            self._rising = self.sign_at(self.high)
            if self._rising == 0:
                self.low = self.high
                return
        middle = (self.low + self.high) / 2
        value = self.sign_at(middle)
        if value == 0:
            self.low = self.high = middle
        elif value == self._rising:
            self.high = middle
        else:
            self.low = middle

    def compare(self, value: Rational) -> int:
        """The sign of (this number - value)."""
        if self.low <= value <= self.high and self.low != self.high:
            if self.sign_at(value) == 0:
                self.low = self.high = value
            while self.low <= value <= self.high and self.low != self.high:
                self.halve()
        return sign(self.low - value) if self.low == self.high else 1 if self.low > value else -1

    def enclosure(self, bits: int) -> Ball:
        """A ball around it whose radius is about 2^-bits times its size, or 2^-bits near 0."""
        size = max(abs(self.low), abs(self.high), fmpq(1, 1 << 40))
        self.narrow(size / (1 << bits))
        return between(self.low, self.high, bits + 30)


@dataclass(eq=False)
class Root(Isolated):
    """A root of the square-free ``polynomial``, which vanishes at neither end unless low = high."""

    polynomial: Integer
    low: Rational
    high: Rational
    _rising: int = field(default=0, repr=False)

    def sign_at(self, x: Rational) -> int:
        return sign(self.polynomial(x))

    def narrow(self, width: Rational) -> None:
        """Shrinks the interval until it is at most this wide.

        Quadratic refinement (Abbott 2006): the secant tells which of N parts has the zero; where it is right the next
        N is the square, otherwise the interval is halved and N is the root.
        """
        power = 2  # N = 2^power
        while self.high - self.low > width:
            if power > 1 and self._part(power):
                power = min(2 * power, 1 << 20)
            else:
                self.halve()
                power = max(power // 2, 2)

    def _part(self, power: int) -> bool:
        """Takes the one of 2^power parts that the secant points to, if the polynomial changes its sign there."""
        step = (self.high - self.low) / (1 << power)
        below, above = self.polynomial(self.low), self.polynomial(self.high)
        at = int((below / (below - above) * (1 << power)).floor())
        at = min(max(at, 0), (1 << power) - 1)
        low, high = self.low + at * step, self.low + (at + 1) * step
        signs = sign(self.polynomial(low)), sign(self.polynomial(high))
        if 0 in signs:
            self.low = self.high = low if signs[0] == 0 else high
        elif signs[0] == signs[1]:
            return False
        else:
            self.low, self.high = low, high
        return True

    def __float__(self) -> float:
        ball = self.enclosure(60)
        return float(ball.mid())


class AlgebraicNumber(Root):
    """A root of an irreducible polynomial with integer coefficients, of degree 2 at least: it is not rational."""

    @property
    def modulus(self) -> Univariate:
        """The polynomial over the rationals."""
        return fmpq_poly(self.polynomial)

    def sign(self, p: Univariate) -> int:
        """The sign of p(this): zero exactly where the minimal polynomial divides p."""
        p = fmpq_poly(p) % self.modulus
        if p.degree() < 1:
            return sign(p[0])
        bits = 40
        while True:
            with ctx.workprec(2 * bits + 20):
                value: Ball = arb_poly(p)(self.enclosure(bits))
            if value > 0 or value < 0:
                return 1 if value > 0 else -1
            bits *= 2

    def value(self, p: Univariate, bits: int = 64) -> Ball:
        """A ball around p(this)."""
        with ctx.workprec(2 * bits + 20):
            return arb_poly(p)(self.enclosure(bits))

    def same(self, other: object) -> bool:
        """Whether they are one number."""
        return isinstance(other, AlgebraicNumber) and compare(self, other) == 0


Number = Any  # a flint.fmpq or an AlgebraicNumber


def sign(value: Any) -> int:
    """-1, 0 or 1."""
    return (value > 0) - (value < 0)


def between(low: Rational, high: Rational, bits: int) -> Ball:
    """The ball over an interval."""
    with ctx.workprec(bits):
        return arb(low) if low == high else arb(low).union(arb(high))


def enclosure(x: Number, bits: int = 64) -> Ball:
    """A ball around a number."""
    return x.enclosure(bits) if isinstance(x, Root) else between(x, x, bits)


def number(root: Root) -> Number:
    """A root of an irreducible or a linear polynomial as a number."""
    if root.exact is not None:
        return root.exact
    if root.polynomial.degree() == 1:
        return fmpq(-root.polynomial[0], root.polynomial[1])
    return AlgebraicNumber(root.polynomial, root.low, root.high)


def in_square_roots(x: Number) -> Fraction | Expression | None:
    """A rational number, or one of degree 2 as an expression; None of others."""
    if isinstance(x, fmpq):
        return rationals.fraction(x)
    return by_square_root(x.modulus, x.enclosure(80)) if isinstance(x, AlgebraicNumber) else None


def compare(a: Number, b: Number) -> int:
    """The sign of a - b."""
    if not isinstance(a, Root):
        return sign(a - b) if not isinstance(b, Root) else -b.compare(a)
    if not isinstance(b, Root):
        return a.compare(b)
    alike = a.polynomial == b.polynomial
    while True:
        if a.high < b.low:
            return -1
        if b.high < a.low:
            return 1
        if a.exact is not None:
            return -b.compare(a.exact)
        if b.exact is not None:
            return a.compare(b.exact)
        low, high = max(a.low, b.low), min(a.high, b.high)
        # One polynomial that changes its sign over what is common to two intervals with one root each.
        if alike and low < high and sign(a.polynomial(low)) * sign(a.polynomial(high)) < 0:
            return 0
        a.halve()
        b.halve()


def ascending(numbers: Sequence[Number]) -> list[Number]:
    """Sorted; their intervals are disjoint afterwards."""
    ordered = sorted(numbers, key=cmp_to_key(compare))
    for a, b in pairwise(ordered):
        while high(a) >= low(b):
            for x in (a, b):
                if isinstance(x, Root):
                    x.halve()
    return ordered


def low(x: Any) -> Rational:
    """The lower end of what is known of a number, which is rational or has its interval."""
    return x if isinstance(x, fmpq) else x.low


def high(x: Any) -> Rational:
    """The upper end of what is known of a number."""
    return x if isinstance(x, fmpq) else x.high


def changes(p: Integer) -> int:
    """Sign changes among the coefficients."""
    signs = [c > 0 for c in p.coeffs() if c]
    return sum(a != b for a, b in pairwise(signs))


def _shifted(p: Integer) -> int:
    """The bound of Descartes for roots in (0, 1)."""
    return changes(fmpz_poly(p.coeffs()[::-1])(_SHIFT))


def _on_unit(p: Integer, low: Rational, high: Rational) -> Integer:
    """p(low + (high - low) t), primitive."""
    image = fmpq_poly(p)(fmpq_poly([low, high - low])).numer()
    return image / abs(image.content())


def bound(p: Integer, low: Rational, high: Rational) -> int:
    """At least as many as the roots of p in (low, high); 0 and 1 are exact."""
    return _shifted(_on_unit(p, low, high)) if p.degree() > 0 else 0


def roots_between(p: Integer, low: Rational, high: Rational) -> list[Root]:
    """The roots of a square-free polynomial in the open interval (low, high), ascending."""
    if p.degree() < 1 or low >= high:
        return []
    if p.degree() == 1:
        value = fmpq(-p[0], p[1])
        return [Root(p, value, value)] if low < value < high else []
    roots: list[Root] = []
    work = [(_on_unit(p, low, high), low, high)]
    while work:
        q, a, b = work.pop()
        count = _shifted(q)
        if count == 0:
            continue
        if count == 1:
            roots.append(_open_ended(p, a, b))
            continue
        middle = (a + b) / 2
        n = q.degree()
        left = fmpz_poly([c << (n - k) for k, c in enumerate(q.coeffs())])
        right = left(_SHIFT)
        if right[0] == 0:
            roots.append(Root(p, middle, middle))
            right = fmpz_poly(right.coeffs()[1:])
        work += [(left, a, middle), (right, middle, b)]
    return sorted(roots, key=lambda root: root.low + root.high)


def _open_ended(p: Integer, low: Rational, high: Rational) -> Root:
    """The one root in (low, high), in an interval at whose ends p does not vanish."""
    while p(low) == 0 or p(high) == 0:
        middle = (low + high) / 2
        if p(middle) == 0:
            return Root(p, middle, middle)
        inside = roots_between(p, low, middle)
        if inside:
            return inside[0]
        low = middle
    return Root(p, low, high)


def primitive(p: Univariate) -> Integer:
    """The integer polynomial without content that is a positive multiple of p; p is not zero."""
    numerator = fmpq_poly(p).numer()
    return numerator / numerator.content()


def simplest(low: Rational, high: Rational) -> Rational:
    """The rational number with the least denominator in the open interval (low, high)."""
    if low < 0 < high:
        return fmpq(0)
    if high <= 0:
        return -simplest(-high, -low)
    below = low.floor()
    if below + 1 < high:
        return fmpq(below + 1)
    if low == below:  # the next candidates are below + 1/k
        return below + fmpq(1, (1 / (high - below)).floor() + 1)
    return below + 1 / simplest(1 / (high - below), 1 / (low - below))


def between_simply(below: Any, above: Any) -> Rational:
    """A rational number with a small denominator in the middle of what lies between two numbers, below < above."""
    while True:
        a, b = high(below), low(above)
        if b > a and all(isinstance(x, fmpq) or x.high - x.low <= (b - a) / 4 for x in (below, above)):
            return simplest(a + (b - a) / 4, b - (b - a) / 4)
        for x in (below, above):
            if not isinstance(x, fmpq):
                x.halve()
