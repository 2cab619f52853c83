"""Where the roots of a polynomial with rational coefficients lie, exactly: counts by half-planes, no floats.

With p(lambda) = E(lambda^2) + lambda O(lambda^2) let g = gcd(E, O).  Then p = g(lambda^2) q(lambda), where

* g holds every root whose negative is a root too, so everything on the imaginary axis: a root mu of g gives the
  imaginary pair +-sqrt(mu) when mu < 0, and one root on either side of the axis otherwise;
* q has no such roots, so arg q(i w) is continuous, and left - right is its increase over the axis divided by pi,
  a Cauchy index, read off the signed remainder sequence of the real and the imaginary part (Sturm, Hurwitz).

The degenerate cases of Routh's table (a zero pivot, a row of zeros, repeated roots) need no epsilon: they are the
ordinary course here.  Coefficients are listed from low to high powers and may be int, Fraction or fmpq.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import ctx, fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.expressions.tree import Call, Expression, add, number, subtract

Rational = Any  # int, Fraction or flint.fmpq
Univariate = Any  # a flint.fmpq_poly


@dataclass(frozen=True)
class RootCount:
    """Roots with their multiplicities: Re > 0, Re = 0 but not 0, Re < 0, and exactly 0.

    ``imaginary_multiplicity`` is the largest multiplicity of a single root on the axis other than 0 (0: none there).
    """

    right: int
    imaginary: int
    left: int
    zero: int
    imaginary_multiplicity: int

    @property
    def degree(self) -> int:
        return self.right + self.imaginary + self.left + self.zero


@dataclass(frozen=True)
class Root:
    """A certified enclosure ``ball`` (flint.acb) of one root and its multiplicity."""

    ball: Any
    multiplicity: int


def rational(value: Rational) -> Any:
    """int, Fraction or fmpq as fmpq; anything inexact is refused with TypeError."""
    if isinstance(value, Fraction):
        return rationals.exact(value)
    if isinstance(value, (bool, float)):
        raise TypeError(f"an exact rational number is needed, not {value!r}")
    return fmpq(value)


def univariate(coefficients: Sequence[Rational]) -> Univariate:
    """The polynomial with these coefficients, low to high.  Raises ValueError for the zero polynomial."""
    p = fmpq_poly([rational(c) for c in coefficients])
    if p.degree() < 0:
        raise ValueError("the zero polynomial has no definite roots")
    return p


def count_roots(coefficients: Sequence[Rational]) -> RootCount:
    """How many roots lie to the right, on and to the left of the imaginary axis; exact in every degenerate case."""
    return counted(univariate(coefficients))


def counted(p: Univariate) -> RootCount:
    """The same for a polynomial that is not zero, over the rationals or another ordered field (``plane.elements``)."""
    cs, made = p.coeffs(), type(p)
    zero = next(i for i, c in enumerate(cs) if c != 0)
    cs = cs[zero:]
    even, odd = made(cs[::2]), made(cs[1::2])
    symmetric = even.gcd(odd)
    # The constant coefficient of p is not 0, so neither is that of the symmetric part: no root mu = 0.
    imaginary, largest = 0, 0
    for factor, multiplicity in symmetric.factor_squarefree()[1]:
        negative = _real_roots_below_zero(factor)
        imaginary += 2 * multiplicity * negative
        if negative:
            largest = max(largest, multiplicity)
    one_sided = _spread(even // symmetric, odd // symmetric)
    difference = _left_minus_right(one_sided)
    symmetric_right = symmetric.degree() - imaginary // 2
    rest = one_sided.degree()
    right = symmetric_right + (rest - difference) // 2
    left = symmetric_right + (rest + difference) // 2
    return RootCount(right, imaginary, left, zero, largest)


def count_real_roots(coefficients: Sequence[Rational]) -> tuple[int, int, int]:
    """Real roots with multiplicities: (negative, zero, positive)."""
    return counted_real(univariate(coefficients))


def counted_real(p: Univariate) -> tuple[int, int, int]:
    """The same for a polynomial that is not zero, over the rationals or another ordered field."""
    cs = p.coeffs()
    zero = next(i for i, c in enumerate(cs) if c != 0)
    negative = positive = 0
    for factor, multiplicity in type(p)(cs[zero:]).factor_squarefree()[1]:
        below = _real_roots_below_zero(factor)
        chain = _sturm_chain(factor, factor.derivative())
        total = _variations(chain, -1) - _variations(chain, 1)
        negative += multiplicity * below
        positive += multiplicity * (total - below)
    return negative, zero, positive


def enclosures(coefficients: Sequence[Rational], bits: int = 80) -> tuple[Root, ...]:
    """Certified balls around all roots, each isolated from the others; sorted by real, then imaginary part.

    For display and for checks; counts and verdicts never rest on them.
    """
    p = univariate(coefficients)
    with ctx.workprec(bits):
        roots = [Root(ball, int(multiplicity)) for ball, multiplicity in p.complex_roots()]
    return tuple(sorted(roots, key=lambda root: (float(root.ball.real.mid()), float(root.ball.imag.mid()))))


def _spread(even: Univariate, odd: Univariate) -> Univariate:
    """E(x^2) + x O(x^2)."""
    length = 2 * max(even.length(), odd.length())
    cs = [even[0] * 0] * length
    cs[0 : 2 * even.length() : 2] = even.coeffs()
    cs[1 : 2 * odd.length() + 1 : 2] = odd.coeffs()
    return type(even)(cs)


def _left_minus_right(p: Univariate) -> int:
    """left - right for a polynomial without imaginary roots: the increase of arg p(i w), w from -oo to oo, over pi.

    With p(i w) = F(w) + i H(w): minus the Cauchy index of H/F when F has the larger degree (n even), the index of F/H
    when H has (n odd).
    """
    n = p.degree()
    signs = (1, 1, -1, -1)
    cs, made = [signs[i % 4] * c for i, c in enumerate(p.coeffs())], type(p)
    real = made([c if i % 2 == 0 else c * 0 for i, c in enumerate(cs)])
    imag = made([c if i % 2 == 1 else c * 0 for i, c in enumerate(cs)])
    if n % 2 == 0:
        return -_cauchy_index(imag, real)
    return _cauchy_index(real, imag)


def _cauchy_index(numerator: Univariate, denominator: Univariate) -> int:
    """Jumps of numerator/denominator from -oo to +oo, less those from +oo to -oo, along the real line."""
    chain = _sturm_chain(denominator, numerator)
    return _variations(chain, -1) - _variations(chain, 1)


def _sturm_chain(first: Univariate, second: Univariate) -> list[Univariate]:
    chain = [first]
    while second.degree() >= 0:
        chain.append(second)
        remainder = -(chain[-2] % chain[-1])
        second = _tidied(remainder) if remainder.degree() >= 0 else remainder
    return chain


def _tidied(p: Univariate) -> Univariate:
    """A positive multiple with small numbers: over the rationals with leading coefficient 1 or -1."""
    own = getattr(p, "tidied", None)
    return p / abs(p.leading_coefficient()) if own is None else own()


def _variations(chain: Sequence[Univariate], where: int) -> int:
    """Sign changes in a chain at -oo (where = -1), at 0 (0) or at +oo (1)."""
    values = []
    for p in chain:
        value = p[0] if where == 0 else p.leading_coefficient() * (where if p.degree() % 2 else 1)
        if value != 0:
            values.append(value > 0)
    return sum(a != b for a, b in pairwise(values))


def _real_roots_below_zero(squarefree: Univariate) -> int:
    """Sturm: the number of roots in (-oo, 0) of a square-free polynomial that does not vanish at 0."""
    chain = _sturm_chain(squarefree, squarefree.derivative())
    return _variations(chain, -1) - _variations(chain, 0)


def by_square_root(minimal: Univariate, value: Any) -> Expression | None:
    """The root of a polynomial of degree 1 or 2 that is in the ball ``value``; None of others, or where both may be.

    -c,    -b/2 + sqrt(b^2/4 - c),    -b/2 - sqrt(b^2/4 - c)    of x + c and x^2 + b x + c
    """
    if minimal.degree() > 2:
        return None
    monic = [rationals.fraction(x / minimal[minimal.degree()]) for x in minimal.coeffs()]
    if len(monic) == 2:
        return number(-monic[0])
    middle = -monic[1] / 2
    if value.overlaps(rationals.ball(middle)):
        return None
    root = Call("sqrt", number(middle**2 - monic[0]))
    return (add if value > rationals.ball(middle) else subtract)(number(middle), root)
