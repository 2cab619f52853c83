"""Polynomials in y over the field QQ(alpha) of a real algebraic number, and their real roots.

An element is a ``fmpq_poly`` in alpha of lower degree than alpha's minimal polynomial m, zero exactly where its value
is; a polynomial is a list of elements, from low to high powers of y, without vanishing leading ones.  Greatest common
divisors are modular (``modular``); roots are isolated by balls around the coefficients, after the polynomial is
square-free by that exact arithmetic, at whatever precision it takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from flint import acb, acb_poly, arb, arb_poly, ctx, fmpq, fmpq_poly, fmpz, fmpz_mod_ctx, fmpz_mod_poly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane.numbers import AlgebraicNumber, Ball, Isolated, Rational, enclosure, sign
from mbsym.algebra.plane.projection import Polynomial, coefficients
from mbsym.algebra.terms import fraction_modulo

# Greatest common divisors over QQ(alpha) by way of finite rings, where Euclid's numbers would grow without bound.
#
# Let m be the minimal polynomial of alpha, P a prime that divides no denominator, neither lc(m) nor disc(m), such that
# the leading coefficients of a and b are units of R = F_P[x]/m.  Then Z_(P)[alpha] is integrally closed, so the monic g
# = gcd(a, b) has its coefficients there (Gauss's lemma), and its image divides those of a and b.  Euclid's algorithm in
# R, all of whose leading coefficients turn out to be units, therefore ends in a polynomial of degree deg g at least; a
# candidate of that degree, its coefficients reconstructed as fractions, that divides a and b over QQ(alpha) is g
# (Langemyr & McCallum 1989, Encarnacion 1995).  The primes are Mersenne's, each about twice as long as the one before.


Image = Any  # a flint.fmpz_mod_poly

#: 2^e - 1 are primes.  The last one bounds the length of the numbers of a divisor: some 1,400 digits.
EXPONENTS = (61, 127, 521, 1279, 2203, 4423, 9689)
#: Bits of a prime times the degree of alpha and the lengths of a and b: a second or so.
MOST_WORK = 20_000_000


class _Unlucky(Exception):
    """A prime that says nothing: it divides a denominator, or a leading coefficient is no unit."""


def common_divisor(modulus: Element, a: Sequence[Element], b: Sequence[Element]) -> list[Element]:
    """The monic gcd of a and b over QQ[x]/modulus, a field; coefficients from low to high powers, none leading zero.

    Raises TooLargeError where its coefficients are longer than the primes above, or ``MOST_WORK`` allows.
    """
    if not a or not b:
        raise ValueError("a polynomial that is zero")
    for exponent in EXPONENTS:
        if exponent * modulus.degree() * len(a) * len(b) > MOST_WORK:
            break
        try:
            ring = _Ring(modulus, (1 << exponent) - 1)
            modular_gcd = ring.gcd([ring.image(x) for x in a], [ring.image(x) for x in b])
        except _Unlucky:
            continue
        if len(modular_gcd) == 1:
            return [fmpq_poly([1])]
        candidate = _reconstructed(modular_gcd, ring.prime)
        if candidate is not None and all(divides(modulus, candidate, p) for p in (a, b)):
            return candidate
    raise TooLargeError(
        "a common divisor of polynomials of degrees [[count]] and [[other]] over a number field of degree [[degree]]",
        count=len(a) - 1,
        other=len(b) - 1,
        degree=modulus.degree(),
        limit=Limit.DIGITS,
    )


def proved_coprime(modulus: Element, a: Sequence[Element], b: Sequence[Element]) -> bool:
    """Whether the first prime that says something shows that gcd(a, b) = 1."""
    for exponent in EXPONENTS[:2]:
        try:
            ring = _Ring(modulus, (1 << exponent) - 1)
            return len(ring.gcd([ring.image(x) for x in a], [ring.image(x) for x in b])) == 1
        except _Unlucky:
            continue
    return False


def divides(modulus: Element, g: Sequence[Element], a: Sequence[Element]) -> bool:
    """Whether the monic g divides a over QQ[x]/modulus, exactly."""
    return all(x == 0 for x in _divided([x % modulus for x in a], g, modulus)[1])


def _divided(a: Sequence[Element], b: Sequence[Element], modulus: Element) -> tuple[list[Element], list[Element]]:
    """(quotient, remainder) by a monic b over QQ[x]/modulus."""
    rest, quotient = list(a), [ZERO] * max(len(a) - len(b) + 1, 0)
    while len(rest) >= len(b):
        top, shift = rest.pop(), len(rest) - len(b) + 1
        quotient[shift] = top
        if top != 0:
            for k, x in enumerate(b[:-1]):
                rest[shift + k] = (rest[shift + k] - top * x) % modulus
    return quotient, rest


class _Ring:
    """R = F_P[x]/m, which need not be a field."""

    def __init__(self, modulus: Element, prime: int) -> None:
        self.prime = prime
        self._context = fmpz_mod_poly_ctx(fmpz_mod_ctx(prime))
        self.modulus = self._raw(modulus)
        if self.modulus.degree() != modulus.degree() or self.modulus.gcd(self.modulus.derivative()).degree() > 0:
            raise _Unlucky

    def _raw(self, x: Element) -> Image:
        below = int(x.denom()) % self.prime
        if below == 0:
            raise _Unlucky
        return self._context([int(c) for c in x.numer().coeffs()]) * pow(below, -1, self.prime)

    def image(self, x: Element) -> Image:
        return self._raw(x) % self.modulus

    def inverse(self, x: Image) -> Image:
        unit, cofactor, _ = x.xgcd(self.modulus)
        if unit.degree() != 0:
            raise _Unlucky
        return cofactor

    def monic(self, p: list[Image]) -> list[Image]:
        """Without leading zeros, divided by the leading coefficient."""
        while p and p[-1].is_zero():
            p.pop()
        if p and not p[-1].is_one():
            inverse = self.inverse(p[-1])
            p = [*(x.mul_mod(inverse, self.modulus) for x in p[:-1]), self._context([1])]
        return p

    def gcd(self, a: list[Image], b: list[Image]) -> list[Image]:
        """The monic one.  Raises _Unlucky where a leading coefficient is no unit, one of a and b first of all."""
        if a[-1].is_zero() or b[-1].is_zero():
            raise _Unlucky
        a, b = self.monic(list(a)), self.monic(list(b))
        while b:
            rest, size = a, len(b)
            while len(rest) >= size:
                top, shift = rest.pop(), len(rest) - size + 1
                if not top.is_zero():
                    for k in range(size - 1):
                        rest[shift + k] = rest[shift + k] - top.mul_mod(b[k], self.modulus)
            a, b = b, self.monic(rest)
        return a


def _reconstructed(p: Sequence[Image], prime: int) -> list[Element] | None:
    """The polynomial over the rationals with these images, of numerators and denominators below sqrt(prime/2)."""
    most = int(fmpz(prime // 2).isqrt())
    below = 1  # what the denominators so far have for a common multiple
    elements = []
    for x in p:
        row = []
        for c in x.coeffs():
            value = fraction_modulo(int(c) * below % prime, prime, most)
            if value is None or below * value[1] > most:
                return None
            below *= value[1]
            row.append(fmpq(value[0], below))
        elements.append(fmpq_poly(row))
    return elements


Element = Any  # a flint.fmpq_poly in alpha
OverField = list[Element]

#: Bits at which roots over a field are given up: such roots would be closer than 2^-20000.
MOST_BITS = 40_000

#: Bits at which balls are given up as a way to tell which roots are common.
MOST_BALL_BITS = 1024

ZERO = fmpq_poly([0])


#: Steps of Newton's method; it squares its error.
MOST_STEPS = 60


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
        over_field = [x % self.modulus for x in p]
        while over_field and over_field[-1] == 0:
            over_field.pop()
        return over_field

    def monic(self, p: OverField) -> OverField:
        if not p or p[-1] == 1:
            return p
        inverse = self.inverse(p[-1])
        return [*(x * inverse % self.modulus for x in p[:-1]), fmpq_poly([1])]

    def divided(self, a: OverField, b: OverField) -> tuple[OverField, OverField]:
        """(quotient, remainder) by a monic b."""
        quotient, rest = _divided(a, b, self.modulus)
        return quotient, self.trimmed(rest)

    def coprime(self, a: OverField, b: OverField) -> bool:
        """Whether one prime proves that two polynomials have no common root; False says nothing."""
        return len(a) == 1 or len(b) == 1 or proved_coprime(self.modulus, a, b)

    def gcd(self, a: OverField, b: OverField) -> OverField:
        """The monic greatest common divisor; [1] where there is none.

        Raises TooLargeError where its coefficients are too long.
        """
        if not a or not b:
            return self.monic(a or b)
        return common_divisor(self.modulus, a, b)

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
            overs = self._roots(p, bits)
            if overs is not None:
                return overs
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
        overs = []
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
            overs.append(Over(self, p, low, high))
        overs.sort(key=lambda root: root.low + root.high)
        return overs if all(a.high < b.low for a, b in pairwise(overs)) else None

    def common_roots(self, p: OverField, q: OverField) -> tuple[list[Over], int] | None:
        """(the real common roots, the number of all) of polynomials that have at least one; all are simple ones of p.

        Balls show at which roots of p q may vanish.  These are common roots if they are one orbit under conjugation
        and, where p and q have even or odd powers only, change of sign: with one root every image of it is common.
        None where balls of ``MOST_BALL_BITS`` do not show that; then there may be several, or p has a multiple root.
        """
        bits = 64
        while bits <= MOST_BALL_BITS:
            with ctx.workprec(bits):
                common = self._orbit(p, q, bits)
            overs = None if common is None else self._real(p, common)
            if common is not None and overs is not None:
                return overs, len(common)
            bits *= 2
        return None

    def _orbit(self, p: OverField, q: OverField, bits: int) -> list[Any] | None:
        whole, other = self.balls(p, bits), self.balls(q, bits)
        try:
            balls = whole.complex_roots()
        except ValueError:
            return None
        sharp = acb_poly(whole), acb_poly(whole.derivative())
        balls = [sharpened(*sharp, ball) for ball in balls]
        common = [k for k, ball in enumerate(balls) if other(ball).contains(0)]
        if not common:
            return None
        images = [acb.conjugate] if not _one_parity(p) or not _one_parity(q) else [acb.conjugate, acb.__neg__]
        orbit, pending = {common[0]}, [common[0]]
        while pending:
            at = pending.pop()
            for image in images:
                met = [k for k, ball in enumerate(balls) if ball.overlaps(image(balls[at]))]
                if len(met) != 1:
                    return None
                if met[0] not in orbit:
                    orbit.add(met[0])
                    pending.append(met[0])
        return [balls[k] for k in common] if orbit == {*common} else None

    def double_roots(self, p: OverField) -> tuple[list[Over], list[Over], int] | None:
        """(the real double roots, the real simple ones, the number of all double ones) of a polynomial.

        p has a multiple root.  Those of p' that are roots of p are double ones where they are simple ones of p'; the
        others are what p has after division by them.  None as ``common_roots``.
        """
        slope = self.derivative(p)
        bits = 64
        while bits <= MOST_BALL_BITS:
            with ctx.workprec(bits):
                common = self._orbit(slope, p, bits)
                roots = None if common is None else self._double_roots(p, slope, common, bits)
            if roots is not None:
                return roots
            bits *= 2
        return None

    def _double_roots(
        self, p: OverField, slope: OverField, common: Sequence[Any], bits: int
    ) -> tuple[list[Over], list[Over], int] | None:
        rest = [acb(c) for c in self.balls(p, bits).coeffs()]
        for ball in common:
            rest = deflated(deflated(rest, ball), ball)
        try:
            balls = acb_poly(rest).complex_roots() if len(rest) > 1 else []
        except ValueError:
            return None
        doubles, simple = self._real(slope, common), self._real(p, balls)
        if doubles is None or simple is None:
            return None
        if any(a.low <= b.high and b.low <= a.high for a in simple for b in doubles):
            return None
        return doubles, simple, len(common)

    def _around(self, p: OverField, bits: int) -> tuple[Rational, Rational]:
        """An interval around the root of y + c."""
        constant = -p[0]
        if constant.degree() < 1:
            return constant[0], constant[0]
        return ends(self.alpha.value(constant, bits))


@dataclass(eq=False)
class Over(Isolated):
    """The only root in [low, high] of a polynomial over QQ(alpha), a simple one; low = high where it is rational.

    The polynomial need not be monic.  ``shared``: further polynomials with this root.
    """

    over: Extension
    polynomial: OverField
    low: Rational
    high: Rational
    _rising: int = field(default=0, repr=False)
    shared: list[OverField] = field(default_factory=list, repr=False)

    def sign_at(self, x: Rational) -> int:
        return self.over.sign(self.over.at(self.polynomial, x))

    def narrow(self, width: Rational) -> None:
        """Shrinks the interval until it is at most this wide: by Newton's method, by halves where that fails."""
        while self.high - self.low > width:
            if self.high - self.low < width * 64 or not self._sharpened(width):
                self.halve()

    def _sharpened(self, width: Rational) -> bool:
        """Takes an interval from Newton's method, if the polynomial changes its sign over it."""
        size = max(abs(self.low), abs(self.high), fmpq(1))
        bits = int((size / width).ceil()).bit_length() + 40
        with ctx.workprec(2 * bits):
            p = acb_poly(self.over.balls(self.polynomial, bits))
            slope = p.derivative()
            ball = sharpened(p, slope, acb(arb(self.low).union(arb(self.high)), arb(0, 1)))
            low, high = ends(ball.real)
        if not (self.low <= low < high <= self.high and high - low <= (self.high - self.low) / 4):
            return False
        signs = [self.sign_at(x) for x in (low, high)]
        if signs[0] * signs[1] >= 0:
            return False
        self.low, self.high = low, high
        return True

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


def _one_parity(p: OverField) -> bool:
    """Whether all powers are even, or all odd."""
    return all(x == 0 for x in p[len(p) % 2 :: 2])


def ends(ball: Ball) -> tuple[Rational, Rational]:
    """Rational numbers that enclose a ball."""
    return rationals.middle(arb(ball).lower()), rationals.middle(arb(ball).upper())


def sharpened(p: Any, slope: Any, ball: Any) -> Any:
    """A ball as small as the working precision allows around the only root of p in a ball, a simple one.

    Newton's method, whose end z is a guess; the disc about z of radius n |p(z)/p'(z)|, n the degree, holds a root of p,
    and is the answer if it lies in the ball.
    """
    z, last = _middle(ball), None
    for _ in range(MOST_STEPS):
        step = p(z) / slope(z)
        size = abs(step).upper()
        if not step.is_finite() or (last is not None and not size < last):
            break
        z, last = _middle(z - step), size
    radius = abs(p(z) / slope(z)).upper() * p.degree()
    if not radius.is_finite():
        return ball
    real, imaginary = (x + arb(0, radius) for x in (z.real, z.imag))
    return acb(real, imaginary) if ball.real.contains(real) and ball.imag.contains(imaginary) else ball


def _middle(ball: Any) -> Any:
    return acb(ball.real.mid(), ball.imag.mid())


def deflated(coefficients: Sequence[Ball], root: Ball) -> list[Ball]:
    """The quotient by (y - root), in balls; coefficients from low to high powers."""
    quotient: list[Ball] = []
    carried = acb(0)
    for c in reversed(coefficients[1:]):
        carried = carried * root + c
        quotient.append(carried)
    return quotient[::-1]


# Exact points of the plane, at which the sign of every polynomial with rational coefficients is decided.


@dataclass(frozen=True, eq=False)
class Point:
    """(x, y): each a flint.fmpq or an AlgebraicNumber; y may be the root of a polynomial over QQ(x) instead."""

    x: Any
    y: Any

    @property
    def rational(self) -> bool:
        return isinstance(self.x, fmpq) and isinstance(self.y, fmpq)

    def sign(self, polynomial: Polynomial) -> int:
        """The sign of polynomial(x, y), exactly."""
        in_y = coefficients(polynomial, 1)
        if isinstance(self.x, fmpq):
            over = fmpq_poly([c(self.x) for c in in_y])
            return sign(over(self.y)) if isinstance(self.y, fmpq) else self.y.sign(over)
        x: AlgebraicNumber = self.x
        if isinstance(self.y, fmpq):
            total = fmpq_poly([0])
            for c in reversed(in_y):
                total = total * self.y + c
            return x.sign(total)
        root: Over = self.y
        return root.sign(root.over.trimmed(in_y))

    def enclosures(self, bits: int = 64) -> tuple[Ball, Ball]:
        """Balls around x and y of about this relative accuracy."""
        return enclosure(self.x, bits), self.y.enclosure(bits) if isinstance(self.y, Over) else enclosure(self.y, bits)

    def floats(self) -> tuple[float, float]:
        """The nearest doubles, or their neighbours."""
        x, y = self.enclosures(60)
        return float(x.mid()), float(y.mid())
