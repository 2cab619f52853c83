"""Polynomials as dictionaries of monomials, for showing them: what is common, what is obviously irreducible, signs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import gcd

from mbsym.formulas.tree import Factor, Product, Sum

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
