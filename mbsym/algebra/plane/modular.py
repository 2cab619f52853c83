"""Greatest common divisors over QQ(alpha) by way of finite rings, where Euclid's numbers would grow without bound.

Let m be the minimal polynomial of alpha, P a prime that divides no denominator, neither lc(m) nor disc(m), such that
the leading coefficients of a and b are units of R = F_P[x]/m.  Then Z_(P)[alpha] is integrally closed, so the monic
g = gcd(a, b) has its coefficients there (Gauss's lemma), and its image divides those of a and b.  Euclid's algorithm in
R, all of whose leading coefficients turn out to be units, therefore ends in a polynomial of degree deg g at least; a
candidate of that degree, its coefficients reconstructed as fractions, that divides a and b over QQ(alpha) is g
(Langemyr & McCallum 1989, Encarnacion 1995).  The primes are Mersenne's, each about twice as long as the one before.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import fmpq, fmpq_poly, fmpz, fmpz_mod_ctx, fmpz_mod_poly_ctx

from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.expressions.message import Message

Element = Any  # a flint.fmpq_poly in alpha
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
            found = ring.gcd([ring.image(x) for x in a], [ring.image(x) for x in b])
        except _Unlucky:
            continue
        if len(found) == 1:
            return [fmpq_poly([1])]
        candidate = _reconstructed(found, ring.prime)
        if candidate is not None and all(divides(modulus, candidate, p) for p in (a, b)):
            return candidate
    raise TooLargeError(
        Message(
            "a common divisor of polynomials of degrees [[count]] and [[other]] over a number field of "
            "degree [[degree]]",
            count=len(a) - 1,
            other=len(b) - 1,
            degree=modulus.degree(),
        ),
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
    rest = list(a)
    while len(rest) >= len(g):
        top, shift = rest.pop() % modulus, len(rest) - len(g) + 1
        if top != 0:
            for k, x in enumerate(g[:-1]):
                rest[shift + k] = (rest[shift + k] - top * x) % modulus
    return all(x % modulus == 0 for x in rest)


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
    found = []
    for x in p:
        row = []
        for c in x.coeffs():
            value = _fraction(int(c) * below % prime, prime, most)
            if value is None or below * value[1] > most:
                return None
            below *= value[1]
            row.append(fmpq(value[0], below))
        found.append(fmpq_poly(row))
    return found


def _fraction(value: int, prime: int, most: int) -> tuple[int, int] | None:
    """(n, d) with n = d value modulo the prime, |n| <= most, 0 < d <= most; None where there are none."""
    if value <= most:
        return value, 1
    if prime - value <= most:
        return value - prime, 1
    r0, r1, s0, s1 = prime, value, 0, 1
    while r1 > most:
        quotient = r0 // r1
        r0, r1, s0, s1 = r1, r0 - quotient * r1, s1, s0 - quotient * s1
    if not 0 < abs(s1) <= most:
        return None
    return (r1, s1) if s1 > 0 else (-r1, -s1)
