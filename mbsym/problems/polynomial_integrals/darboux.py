"""Darboux polynomials  D f = K f,  K not zero, of a quasi-homogeneous field: all of them up to a weighted degree.

D = sum_i P_i d/dx_i  is the derivative along the field, times its denominator.  A motion that begins on f = 0 stays
there; K, the cofactor, is homogeneous of the weight k by which D raises weights.  For one K they are the kernel of a
linear map, as integrals are.  Which K there may be is read off where the field is at rest: let P vanish at a point a.
With  f = f_m + ...  about a, f_m the terms of lowest degree m,  L f_m = K(a) f_m  with the linear part L of P there, so

    K(a) = sum_j m_j rho_j,    sum_j m_j = m <= degree of f,    rho_j the eigenvalues of dP/dx at a.

K(a) is rational in the parameters, so all conjugates of it are itself: in their mean every rho_j is replaced by that of
the roots of its irreducible factor.  There are finitely many such sums.  The points are a = e_i, one for every x_i of
whose powers K is made (the origin, where K is constant).  What is found holds for almost all values of the parameters;
coefficients are rational in them.  Where the field is quasi-homogeneous every polynomial f is a sum of homogeneous ones
with the same K.

Source: J. Moulin Ollagnier, Polynomial first integrals of the Lotka-Volterra system, Bull. Sci. math. 121 (1997), on
cofactors at points of rest; W. Hess, Math. Ann. 37 (1890), for the heavy rigid body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from typing import Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.gradings import Grading
from mbsym.problems.polynomial_integrals.lifting import lifted, monomial
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    Exponents,
    ModularField,
    Terms,
    at_random,
    echelon,
    kernel_of,
    monomials,
    times,
)
from mbsym.problems.polynomial_integrals.regular import is_regular_on
from mbsym.problems.polynomial_integrals.result import (
    DarbouxCount,
    DarbouxPolynomial,
    DarbouxPolynomials,
    Obstacle,
    PolynomialIntegrals,
)
from mbsym.problems.polynomial_integrals.search import products, sparsest

#: Cofactors that are looked at for one weight.
MOST_COFACTORS = 400


def powers_of_cofactor(grading: Grading) -> list[Exponents]:
    """The monomials of K in a quasi-homogeneous field."""
    return list(monomials(grading.weights, grading.rise)) if grading.rise is not None and grading.rise >= 0 else []


def darboux_polynomials(
    found: PolynomialIntegrals, prime: int = PRIMES[0], known: Sequence[tuple[int, Any]] = ()
) -> DarbouxPolynomials:
    """All that are no products of others and of the integrals ``found``, up to their degree; each proved by division.

    ``known``: weights and polynomials of some, which are not listed again, nor their products.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    field, grading = found.field, found.grading
    rise, weights = grading.rise, grading.weights
    if rise is None or (field.relations and not grading.free):
        return DarbouxPolynomials(found.degree, weights, (), (), Obstacle.NOT_HOMOGENEOUS)
    powers = powers_of_cofactor(grading)
    if any(sum(1 for a in one if a) > 1 for one in powers):
        return DarbouxPolynomials(found.degree, weights, (), (), Obstacle.MIXED)
    means = [rest_means(field, one) for one in powers]
    if any(one is None for one in means):
        return DarbouxPolynomials(found.degree, weights, (), (), Obstacle.NOT_AT_REST)
    there = at_random(field, prime, f"darboux {found.degree}")
    before = [(weight, f, cofactor_of(field, f)) for weight, f in known]
    search = DarbouxSearch(found, there, [DarbouxPolynomial(f, w, k) for w, f, k in before if k is not None and k != 0])
    counts: list[DarbouxCount] = []
    for weight in range(1, found.degree + 1):
        most = weight // min(weights)
        choices = [_sums(one or [], most, field.context.constant(0)) for one in means]
        number = 1
        for choice in choices:
            number *= len(choice)
        if number > MOST_COFACTORS:
            return DarbouxPolynomials(found.degree, weights, tuple(search.found), tuple(counts), Obstacle.TOO_MANY)
        cofactors = [
            sum((c * monomial(field, one) for c, one in zip(values, powers, strict=True)), field.context.constant(0))
            for values in product(*choices)
        ]
        counts += [search.of(weight, one) for one in cofactors if one != 0]
    return DarbouxPolynomials(found.degree, weights, tuple(search.found), tuple(counts), None)


@dataclass(frozen=True)
class RestFactor:
    """An irreducible factor of det(x - dP/dx) at a point of rest, the highest coefficient 1: that of x^0 first."""

    coefficients: tuple[Any, ...]

    @property
    def degree(self) -> int:
        return len(self.coefficients) - 1

    @property
    def mean(self) -> Any:
        """Of its roots."""
        return -self.coefficients[-2] / self.degree

    @property
    def moves(self) -> bool:
        """Whether parameters occur in it."""
        return not all(c.is_constant() for c in self.coefficients)

    def discriminant(self) -> Any:
        """Delta of a quadratic one, whose roots are  mean +- sqrt(Delta)/2."""
        c, b, _ = self.coefficients
        return b**2 - 4 * c


def rest_means(field: PolynomialField, power: Exponents) -> list[Any] | None:
    """The means of conjugate eigenvalues of dP/dx at e_i (0 where ``power`` is empty), each once, without zero.

    None where the field is not at rest there.
    """
    factors = rest_factors(field, power)
    if factors is None:
        return None
    found: list[Any] = []
    for factor in factors:
        if factor.mean != 0 and factor.mean not in found:
            found.append(factor.mean)
    return found


def rest_factors(field: PolynomialField, power: Exponents) -> list[RestFactor] | None:
    """The irreducible factors of the characteristic polynomial of dP/dx there; None where the field is not at rest."""
    context, count = field.context, len(field.parameters)
    images = [*context.gens()[:count], *(context.constant(1 if a else 0) for a in power)]

    def at(p: Any) -> Any:
        return p.compose(*images, ctx=context)

    if any(at(p) != 0 for p in field.numerators):
        return None
    matrix = [[at(p.derivative(k)) for k in field.places] for p in field.numerators]
    wide = fmpq_mpoly_ctx.get(["#", *context.names()], context.ordering())
    root, gens = wide.gen(0), wide.gens()
    characteristic = sum(
        (
            c.compose(*gens[1:], ctx=wide) * root**k
            for k, c in enumerate(faddeev(matrix, context.constant(0), context.constant(1))[1])
        ),
        wide.constant(0),
    )
    found = []
    for factor, _ in irreducible_factors(characteristic)[1]:
        degree = int(factor.degrees()[0])
        leading = _coefficient(wide, factor, degree)  # a number: the characteristic polynomial is monic
        scaled = [_coefficient(wide, factor, k) / leading.leading_coefficient() for k in range(degree + 1)]
        found.append(RestFactor(tuple(c.compose(context.constant(0), *context.gens(), ctx=context) for c in scaled)))
    return found


def _coefficient(context: Any, p: Any, power: int) -> Any:
    """Of the first generator to that power."""
    return context.from_dict({(0, *m[1:]): c for m, c in p.to_dict().items() if int(m[0]) == power})


def _sums(means: Sequence[Any], most: int, zero: Any) -> list[Any]:
    """All sums of at most so many of them, each once."""
    found, last = [zero], [zero]
    for _ in range(most):
        new: list[Any] = []
        for total in (x + mean for x in last for mean in means):
            if total not in found and total not in new:
                new.append(total)
        found, last = found + new, new
        if not new or len(found) > MOST_COFACTORS:
            break
    return found


@dataclass(frozen=True)
class _Factor:
    """A Darboux polynomial that is known, and itself modulo the prime."""

    one: DarbouxPolynomial
    terms: Terms


class DarbouxSearch:
    """Weight by weight, cofactor by cofactor, modulo one prime; ``known`` are not found again."""

    def __init__(
        self, usual: PolynomialIntegrals, there: ModularField, known: Sequence[DarbouxPolynomial] = ()
    ) -> None:
        self.usual, self.there, self.field = usual, there, usual.field
        self.integrals = [(one.weight, there.terms(one.polynomial)) for one in usual.generators]
        self.factors = [_Factor(one, there.terms(one.polynomial)) for one in known]
        self.before = len(known)

    @property
    def found(self) -> list[DarbouxPolynomial]:
        return [factor.one for factor in self.factors[self.before :]]

    def of(self, weight: int, cofactor: Any) -> DarbouxCount:
        """What there is for one cofactor, found and counted."""
        prime, terms = self.there.prime, self.there.terms(cofactor)
        columns = list(monomials(self.usual.grading.weights, weight))
        images = [_less(self.there.derivative(m), times({m: 1}, terms, prime), prime) for m in columns]
        most = [{columns[k]: c for k, c in vector.items()} for vector in kernel_of(images, prime)]
        rows: list[Terms] = []
        if most:
            rows, _ = echelon(list(self.products(weight, cofactor)), columns, prime)
        if len(most) > len(rows):
            for support, leading in sparsest(rows, most, columns, prime):
                f = None
                with suppress(NoClosedForm):  # too long to be written: the count stays incomplete
                    f = lifted(self.field, list(support), False, leading, factor=cofactor)
                if f is not None:
                    one = DarbouxPolynomial(f, weight, cofactor, is_regular_on(self.field, f))
                    own = _Factor(one, self.there.terms(f))
                    self.factors.append(own)
                    rows, _ = echelon([*rows, own.terms], columns, prime)
        return DarbouxCount(weight, cofactor, len(most), len(rows))

    def products(self, weight: int, cofactor: Any) -> Iterator[Terms]:
        """Products of those that are known and of integrals: of that weight, with that sum of cofactors."""
        prime, count = self.there.prime, len(self.field.variables)
        one: Terms = {(0,) * count: 1}
        for left, terms in self._multiples(0, weight, cofactor, one):
            for rest in products(self.integrals, left, True, prime, count, lambda terms: terms):
                yield times(terms, rest, prime)

    def _multiples(self, first: int, left: int, cofactor: Any, terms: Terms) -> Iterator[tuple[int, Terms]]:
        """Products of factors from ``first`` on whose cofactors add up to that: (weight left, product)."""
        if cofactor == 0:
            yield left, terms
        for k in range(first, len(self.factors)):
            factor = self.factors[k]
            if factor.one.weight <= left:
                yield from self._multiples(
                    k,
                    left - factor.one.weight,
                    cofactor - factor.one.cofactor,
                    times(terms, factor.terms, self.there.prime),
                )


def _less(a: Terms, b: Terms, prime: int) -> Terms:
    found = dict(a)
    for m, c in b.items():
        found[m] = (found.get(m, 0) - c) % prime
    return {m: c for m, c in found.items() if c}


def cofactor_of(field: PolynomialField, f: Any) -> Any | None:
    """K with D f = K f by division, the second route; None where f does not divide D f."""
    quotient, rest = divmod(field.derivative(f), f)
    return quotient if rest == 0 else None
