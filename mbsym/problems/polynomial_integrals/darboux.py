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
from random import Random
from typing import Any

from flint import fmpq_mpoly_ctx, nmod_poly

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import coefficients_in
from mbsym.problems.polynomial_integrals.gradings import Grading
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    Exponents,
    ModularField,
    Terms,
    at_random,
    echelon,
    kernel_of,
    lifted,
    monomial,
    monomials,
    times,
)
from mbsym.problems.polynomial_integrals.result import (
    DarbouxCount,
    DarbouxPolynomial,
    DarbouxPolynomials,
    Obstacle,
    PolynomialIntegrals,
)
from mbsym.problems.polynomial_integrals.search import products, sparsest

# Whether the field is defined on  f = 0:  where f divides its denominator there is no motion to speak of.
#
# With  f' = K f / d  a motion that begins on f = 0 stays there if d is not zero all over f = 0: a length r with r' =
# r_dot has  r r' = r_dot r,  and r = 0 is no invariant relation.  Looked for is a point with f = 0 and d not zero, on
# curves through random points of the relations modulo a prime (the sphere and the circle seen from a pole).  One that
# is found may have coordinates in an extension of the prime field; if d vanished all over f = 0, there would be none.


#: Curves that are tried for each variable.
TRIALS = 2


def is_regular_on(field: PolynomialField, f: Any, conditions: Sequence[Any] = ()) -> bool:
    """Whether the field's denominator is not zero at some point with f = 0; it is so at random ones modulo a prime.

    False of products of variables that vanish nowhere.
    ``conditions``: polynomials in the parameters that vanish; those linear in one of them are put in.
    """
    if field.units.issuperset(field.context.names()[k] for k in occurring([f])):
        return False
    bottom = field.denominator
    for condition in conditions:
        place = next((k for k in range(len(field.parameters)) if _solvable(condition, k)), None)
        if place is not None:
            slope = condition.derivative(place)
            images = list(field.context.gens())
            images[place] = -(condition - slope * images[place]) / slope.leading_coefficient()
            bottom, f = (p.compose(*images, ctx=field.context) for p in (bottom, f))
    if bottom == 0:
        return False
    if not any(bottom.degrees()[k] for k in field.places):
        return True
    return any(_meets(f, bottom, images, scale) for images, scale in _curves(field))


def _solvable(condition: Any, place: int) -> bool:
    return bool(condition.degrees()[place] == 1 and condition.derivative(place).is_constant())


def _meets(f: Any, bottom: Any, images: Sequence[Any], scale: Any) -> bool:
    """Whether f has a zero on the curve at which the denominator has none."""
    upper, lower = _on(f, images, scale), _on(bottom, images, scale)
    if upper.degree() < 1:
        return False
    return any(divmod(lower, g)[1] != 0 and divmod(scale, g)[1] != 0 for g, _ in upper.factor()[1])


def _on(p: Any, images: Sequence[Any], scale: Any) -> Any:
    """p on the curve, times a power of ``scale``, which divides each image that is not constant."""
    prime = PRIMES[0]
    moving = [k for k, image in enumerate(images) if image.degree() > 0]
    most = max((sum(int(m[k]) for k in moving) for m in p.monoms()), default=0)
    total = nmod_poly([0], prime)
    for m, c in p.to_dict().items():
        term = nmod_poly([int(c.p) * pow(int(c.q), -1, prime) % prime], prime)
        for image, power in zip(images, m, strict=True):
            if power:
                term *= image ** int(power)
        total += term * scale ** (most - sum(int(m[k]) for k in moving))
    return total


def _curves(field: PolynomialField) -> Iterator[tuple[list[Any], Any]]:
    """Curves with a parameter s on the relations: images of the generators, the moving ones times ``scale``."""
    prime, random = PRIMES[0], Random("regular")
    count = len(field.context.names())
    groups = [_group(relation) for relation in field.relations]
    if any(not one for one in groups):
        return  # of other relations no points are known
    alone = [(k,) for k in field.places if not any(k in one for one in groups)]
    for moving in [*alone, *groups] * TRIALS:
        images = [nmod_poly([random.randrange(1, prime)], prime) for _ in range(count)]
        scale = nmod_poly([1], prime)
        if len(moving) == 1:
            images[moving[0]] = nmod_poly([0, 1], prime)
        for group in groups:
            places = random.sample(group, len(group))
            others = [nmod_poly([random.randrange(1, prime)], prime) for _ in places[1:]]
            if group == moving:
                others[0] = nmod_poly([0, 1], prime)
            total = sum((other * other for other in others), nmod_poly([1], prime))
            values = [*(2 * other for other in others), total - 2]
            if group == moving:
                scale = total
            else:
                inverse = pow(int(total[0]), -1, prime)
                values = [one * inverse for one in values]
            for place, value in zip(places, values, strict=True):
                images[place] = value
        yield images, scale


def _group(relation: Any) -> tuple[int, ...]:
    """The generators of which a relation says that their squares have the sum 1; () where it says something else."""
    terms = dict(relation.to_dict())
    constant = terms.pop((0,) * len(relation.context().names()), 0)
    if len(terms) < 2 or any(sorted(m)[-2:] != [0, 2] or c != -constant for m, c in terms.items()):
        return ()
    return tuple(next(k for k, power in enumerate(m) if power) for m in terms)


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
    if any(sum(1 for a in power if a) > 1 for power in powers):
        return DarbouxPolynomials(found.degree, weights, (), (), Obstacle.MIXED)
    means = [rest_means(field, power) for power in powers]
    if any(mean is None for mean in means):
        return DarbouxPolynomials(found.degree, weights, (), (), Obstacle.NOT_AT_REST)
    there = at_random(field, prime, f"darboux {found.degree}")
    before = [(weight, f, cofactor_of(field, f)) for weight, f in known]
    search = DarbouxSearch(found, there, [DarbouxPolynomial(f, w, k) for w, f, k in before if k is not None and k != 0])
    counts: list[DarbouxCount] = []
    for weight in range(1, found.degree + 1):
        most = weight // min(weights)
        choices = [_sums(mean or [], most, field.context.constant(0)) for mean in means]
        number = 1
        for choice in choices:
            number *= len(choice)
        if number > MOST_COFACTORS:
            return DarbouxPolynomials(found.degree, weights, tuple(search.found), tuple(counts), Obstacle.TOO_MANY)
        cofactors = [
            sum((c * monomial(field, one) for c, one in zip(values, powers, strict=True)), field.context.constant(0))
            for values in product(*choices)
        ]
        counts += [search.of(weight, cofactor) for cofactor in cofactors if cofactor != 0]
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
        parts = coefficients_in(factor, 0)  # the last a number: the characteristic polynomial is monic
        scaled = [c / parts[-1].leading_coefficient() for c in parts]
        found.append(RestFactor(tuple(c.compose(context.constant(0), *context.gens(), ctx=context) for c in scaled)))
    return found


def _sums(means: Sequence[Any], most: int, zero: Any) -> list[Any]:
    """All sums of at most so many of them, each once."""
    sums, last = [zero], [zero]
    for _ in range(most):
        new: list[Any] = []
        for total in (x + mean for x in last for mean in means):
            if total not in sums and total not in new:
                new.append(total)
        sums, last = sums + new, new
        if not new or len(sums) > MOST_COFACTORS:
            break
    return sums


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
        self.integrals = [(generator.weight, there.terms(generator.polynomial)) for generator in usual.generators]
        self.factors = [_Factor(polynomial, there.terms(polynomial.polynomial)) for polynomial in known]
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
                    polynomial = DarbouxPolynomial(f, weight, cofactor, is_regular_on(self.field, f))
                    own = _Factor(polynomial, self.there.terms(f))
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
