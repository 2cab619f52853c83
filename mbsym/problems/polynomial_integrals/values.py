"""At which values of one parameter there are more integrals: where a rank drops, each value looked at exactly.

Along the line of a parameter t, with numbers for the others, there is a further integral at a value only where

* the kernel of d/dt is larger than for almost all t: all maximal minors vanish, a zero of their common divisor G; or
* products of the integrals become dependent (what they leave may be an integral): likewise, of the products' matrix; or
* the leading coefficient of an integral V vanishes, so that on  V = 0  other monomials are standard.

What is proved of the values that are not listed.  Let P be the primitive irreducible polynomial over ZZ of a zero, with
coefficients up to N = 10^9 < sqrt(p/2) for the prime p.  P divides G, so that P modulo p, of the same degree, divides
the g that is found modulo p (a multiple of G).  Let g have linear factors only, with zeros a/b, |a| and b up to N, m
times each.  Where the kernel over QQ at a/b is larger by j (found exactly), b t - a divides G at least j times
(Smith's form); so P is b t - a for one of them, or P divides, modulo p, the product of the (b t - a)^(m - j).  If the
product of the (|a| + b)^(m - j) is at most N, so are the coefficients of every such divisor; quotients of numbers up to
N are equal if they are modulo p; hence P is a product of the b t - a, one of them.  ``whole`` is that.  Otherwise it is
proved of rational numbers with |a| and b up to N only: each is a zero of g, and each of these is looked at.

Both need that for almost all t the list is complete: the rank modulo p is that over QQ(t) then.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import prod
from typing import Any

from flint import fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.excess import Block, Excess, Line, dropped, larger, others, rational, roots
from mbsym.problems.polynomial_integrals.levels import levels, on_level
from mbsym.problems.polynomial_integrals.modular import PRIMES, ModularField, at_random
from mbsym.problems.polynomial_integrals.result import FUNCTION, Along, OnLevel, PolynomialIntegrals, Special
from mbsym.problems.polynomial_integrals.search import polynomial_integrals

#: N: twice its square is less than the prime.
LARGEST = 10**9


def along(usual: PolynomialIntegrals, low: Fraction, high: Fraction) -> Along:
    """The values in  low <= t <= high  of the field's only parameter at which there are more integrals than ``usual``.

    Raises ValueError where the field has not one parameter, NoClosedForm where it has no weights or takes too much.
    """
    field = usual.field
    if len(field.parameters) != 1:
        raise ValueError(f"one parameter is wanted, not {len(field.parameters)}")
    if not usual.grading.homogeneous or (field.relations and not usual.grading.free):
        raise NoClosedForm("special values are looked for where equations are quasi-homogeneous; these are not")
    (name,) = field.parameters
    excess = Excess(usual)
    somewhere = at_random(field, PRIMES[0], "whole")
    complete = usual.complete and not any(excess.signature(somewhere))
    zeros = _Zeros(usual, excess, whole=complete)
    specials, undecided = [], []
    for value in sorted(value for value in zeros.values if low <= value <= high):
        image = value.numerator * pow(value.denominator, -1, PRIMES[0]) % PRIMES[0]
        there = ModularField(field, PRIMES[0], {name: image})
        if not there.terms(field.denominator):
            if not zeros.undefined(value):
                undecided.append(value)
        elif larger(excess.signature(there), excess.nothing):
            special = at_value(usual, name, value)
            if special is not None:
                specials.append(special)
            if special is None or not special.complete:
                undecided.append(value)
    irrational = tuple(p for p in zeros.irrational if meets(p, low, high))
    listed = tuple(specials)
    return Along(name, low, high, listed, irrational, zeros.whole, tuple(undecided), complete)


class _Zeros:
    """The values at which a rank drops: rational ones, and polynomials of others; ``whole``: as above."""

    def __init__(self, usual: PolynomialIntegrals, excess: Excess, whole: bool) -> None:
        self.field, self.excess, self.whole = usual.field, excess, whole
        self.values: dict[Fraction, None] = {}
        self.irrational: list[fmpq_poly] = []
        (name,) = self.field.parameters
        line = Line(self.field, PRIMES[0], {name: 0}, {name: 1})
        for block in excess.blocks:
            self._take(dropped(line, excess.build(block), excess.extra(block)), block)
            build, degree = excess.build_products(block)
            self._take(dropped(line, build, degree), None)
        for p in excess.leading():
            for factor, _ in p.factor()[1]:
                if factor.degree() == 1:
                    root = -factor[0] / factor[1]
                    self.values[rationals.fraction(root)] = None
                elif factor.degree() > 1:
                    self._irrational(factor)

    def undefined(self, value: Fraction) -> bool:
        """Whether the field divides by zero there."""
        try:
            self.field.at({self.field.parameters[0]: rationals.exact(value)})
        except ZeroDivisionError:
            return True
        return False

    def _take(self, g: Any, block: Block | None) -> None:
        zeros = []
        for root, power in roots(g):
            value = rational(root, PRIMES[0])
            if value is None:
                self.whole = False
            else:
                self.values[value] = None
                zeros.append((value, power))
        for factor in others(g):
            lifted = lifted_factor(factor)
            self.whole = False
            if lifted is not None:
                self._irrational(lifted)
        if self.whole and prod(_height(value) ** power for value, power in zeros) > LARGEST:
            left = [(value, power - self._jump(value, block)) for value, power in zeros]
            self.whole = all(power >= 0 for _, power in left) and prod(_height(x) ** k for x, k in left) <= LARGEST

    def _jump(self, value: Fraction, block: Block | None) -> int:
        """By how much the kernel over QQ is larger at the value, at least."""
        if block is None or _height(value) == 1 or self.undefined(value):
            return 0
        kernel = self.excess.exactly(value, block)
        return 0 if kernel is None else max(0, kernel - self.excess.dimensions[block])

    def _irrational(self, p: Any) -> None:
        self.whole = False
        if p not in self.irrational:
            self.irrational.append(p)


def _height(value: Fraction) -> int:
    """|a| + b of a/b: 1 at zero."""
    return abs(value.numerator) + value.denominator


def at_value(usual: PolynomialIntegrals, name: str, value: Fraction) -> Special | None:
    """What there is at a value beyond what there is in general; None where that is nothing."""
    field = usual.field.at({name: rationals.exact(value)})
    image = field.context.constant(rationals.exact(value))
    images = [image, *field.context.gens()]
    known = [
        (str(k), generator.polynomial.compose(*images, ctx=field.context))
        for k, generator in enumerate(usual.generators)
    ]
    return special_of(usual, field, known, value)


def special_of(
    usual: PolynomialIntegrals, field: PolynomialField, known: Sequence[tuple[str, Any]], value: Fraction | None
) -> Special | None:
    """The new integrals of a field that is a special case, ``known`` those of the usual one by their numbers."""
    here = polynomial_integrals(field, usual.grading, usual.degree, known)
    # A root of what is known in general, as r is of r^2, is one more, although it is a function of that.
    new = tuple(
        (generator.weight, generator.polynomial) for generator in here.generators if generator.name in ("", FUNCTION)
    )
    named = {generator.name: generator for generator in here.generators}
    on: list[OnLevel] = []
    for level in levels(usual):
        k = usual.generators.index(level)
        if str(k) in named:
            there = on_level(here, named[str(k)])
            if len(there.integrals) > len(on_level(usual, level).integrals):
                on.append(OnLevel(level, there.integrals, there.counts))
    complete = here.complete and all(level.complete for level in on)
    return Special(value, field, new, tuple(on), complete) if new or on else None


def lifted_factor(factor: Any) -> fmpq_poly | None:
    """The polynomial over QQ with small coefficients that it is the image of, leading coefficient 1."""
    prime = factor.modulus()
    top = int(factor[factor.degree()])
    inverse = pow(top, -1, prime)
    numbers = [rational(int(factor[k]) * inverse % prime, prime) for k in range(factor.degree() + 1)]
    if any(x is None or max(abs(x.numerator), x.denominator) > 10**6 for x in numbers):
        return None
    return fmpq_poly([rationals.exact(x) for x in numbers if x is not None])


def meets(p: fmpq_poly, low: Fraction, high: Fraction) -> bool:
    """Whether a polynomial may have a zero in the interval: signs at the ends and at the enclosed real zeros."""
    zeros: Any = p.complex_roots()  # pairs of a zero and its multiplicity
    for root, _ in zeros:
        if root.imag.contains(0):
            real = root.real
            if not (real < low.numerator / low.denominator or real > high.numerator / high.denominator):
                return True
    return False
