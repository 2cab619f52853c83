"""The tree that a formula is shown as: sums, products and powers of generators, waves and brackets.

Printers walk it; ``shape`` makes it.  How angles stand in it is asked for once around all that is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import floor, gcd, log2
from typing import Any, Literal, NamedTuple

from mbsym.algebra.failures import Limit, NoClosedForm

Rational = Any  # flint.fmpq

#: Sines and cosines as products of those of single angles, as waves of sums of angles, or what is shorter to read.
Angles = Literal["products", "sums", "shorter"]


class Wave(NamedTuple):
    """sin or cos (``kind`` sine or cosine) of ``q1 + 2*q2 - q3/2``: (name, coefficient) in reading order."""

    kind: str
    angle: tuple[tuple[str, Fraction], ...]


class Factor(NamedTuple):
    """``base ** exponent``; the base is the number of a generator (never a reciprocal), a wave or a sum."""

    base: int | Wave | Sum
    exponent: int = 1


class Product(NamedTuple):
    """coefficient * (product of ``over``) / (product of ``under``)."""

    coefficient: Rational
    over: tuple[Factor, ...] = ()
    under: tuple[Factor, ...] = ()

    @property
    def magnitude(self) -> tuple[int, int]:
        """|coefficient| as numerator and denominator.  Raises NoClosedForm where one of them is too long to write."""
        top, bottom = abs(int(self.coefficient.p)), int(self.coefficient.q)
        writable(top, bottom)
        return top, bottom


@dataclass(frozen=True, eq=False)
class Sum:
    """The sum of the terms; zero is the empty sum.  Equal brackets of one ring are mostly one object."""

    terms: tuple[Product, ...]

    @cached_property
    def leaves(self) -> int:
        """How many symbols and numbers a reader meets."""
        return sum([_leaves(term) for term in self.terms])


def leaves(shape: Sum) -> int:
    """How many symbols and numbers a reader meets."""
    return shape.leaves


def _leaves(product: Product) -> int:
    total = abs(product.coefficient) != 1
    for base, _ in product.over:
        total += base.leaves if isinstance(base, Sum) else 1
    for base, _ in product.under:
        total += base.leaves if isinstance(base, Sum) else 1
    return total or 1


_ASKED: ContextVar[Angles | None] = ContextVar("angles", default=None)


@contextmanager
def angles_as(choice: Angles | None) -> Iterator[None]:
    """Within this block every formula that is written has its angles so; None leaves it to each kind of text."""
    token = _ASKED.set(choice)
    try:
        yield
    finally:
        _ASKED.reset(token)


def angles_or(usual: Angles) -> Angles:
    """What was asked for, else what a kind of text usually has."""
    return _ASKED.get() or usual


# How long a written number may be.


#: Python reads and writes integers of at most so many digits unless it is told otherwise, and so do its users.
MOST_DIGITS = 4300


_MOST_BITS = floor(MOST_DIGITS * log2(10))


def writable(*numbers: int) -> None:
    """Raises NoClosedForm if one of the integers has more digits than can be read again."""
    if max(map(int.bit_length, numbers)) > _MOST_BITS:
        raise NoClosedForm("a number in it has more than [[most]] digits", most=MOST_DIGITS, limit=Limit.DIGITS)


# Polynomials as dictionaries of monomials, for showing them: what is common, what is obviously irreducible, signs.


#: (generator, exponent) pairs in the order in which people read: accelerations first, parameters last.
Monomial = tuple[tuple[int, int], ...]
#: Coefficients are whole: a common denominator is set aside.  (Integers of Python are compared and hashed quickly.)
Terms = dict[Monomial, int]
Split = Callable[[Monomial], tuple[Monomial, Monomial]]


def by(variable: int) -> Split:
    """Splits off the power of one generator."""

    def split(monomial: Monomial) -> tuple[Monomial, Monomial]:
        for place, (index, _) in enumerate(monomial):
            if index == variable:
                return monomial[place : place + 1], monomial[:place] + monomial[place + 1 :]
        return (), monomial

    return split


def obviously_irreducible(terms: Terms) -> bool:
    """Whether terms without a common factor cannot be factored, as far as that is seen without work.

    Two terms: their exponents have no common divisor.  More: some generator is linear and occurs in one term only, or
    in all but one; a factor without that generator would divide this one term, so it would be a common monomial.
    """
    if len(terms) == 2:
        return gcd(*(e for monomial in terms for _, e in monomial)) == 1
    degrees: dict[int, int] = {}
    counts: dict[int, int] = {}
    for monomial in terms:
        for k, e in monomial:
            degrees[k] = degrees.get(k, 0) + e
            counts[k] = counts.get(k, 0) + 1
    lonely = (1, len(terms) - 1)
    return any(count in lonely and degrees[k] == count for k, count in counts.items())


def without_common(terms: Terms) -> tuple[int, Monomial, Terms]:
    """(content, common monomial, rest), the cheap part of a factorisation."""
    content = gcd(*terms.values())
    monomials = iter(terms)
    shared = dict(next(monomials))
    for monomial in monomials:
        if not shared:
            break
        shared = {k: min(e, shared[k]) for k, e in monomial if k in shared}
    if not shared:
        return content, (), terms if content == 1 else {m: c // content for m, c in terms.items()}
    gone = set(shared.items())
    rest = {
        tuple([p if p[0] not in shared else (p[0], p[1] - shared[p[0]]) for p in monomial if p not in gone]): c
        // content
        for monomial, c in terms.items()
    }
    return content, tuple(shared.items()), rest


def powers(inner: Sum, exponent: int) -> Iterator[Factor]:
    """The factors of 1/inner**exponent's denominator; a lone symbol needs no bracket."""
    if len(inner.terms) == 1 and inner.terms[0].coefficient == 1 and not inner.terms[0].under:
        for factor in inner.terms[0].over:
            yield Factor(factor.base, factor.exponent * exponent)
    else:
        yield Factor(inner, exponent)


def takes_sign(bracket: Sum) -> bool:
    return only_negative(bracket) or any(term.coefficient < 0 for term in bracket.terms)


def only_negative(bracket: Sum) -> bool:
    return all(term.coefficient < 0 for term in bracket.terms)


def tidy(products: Sequence[Product]) -> Sum:
    """The sum, with a positive term in front if there is one."""
    ordered = list(products)
    first = next((i for i, product in enumerate(ordered) if product.coefficient > 0), 0)
    ordered.insert(0, ordered.pop(first))
    return Sum(tuple(ordered))
