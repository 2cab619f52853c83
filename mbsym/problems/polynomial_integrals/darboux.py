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

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from operator import add
from random import Random
from typing import Any, TypeVar

from flint import fmpq_mpoly_ctx, nmod_poly

from mbsym.algebra import rationals
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import coefficients_in, univariate
from mbsym.problems.polynomial_integrals.excess import Build, Line, dropped, others, rational, roots
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
    DarbouxAlong,
    DarbouxCount,
    DarbouxPolynomial,
    DarbouxPolynomials,
    DarbouxSpecial,
    Obstacle,
    PolynomialIntegrals,
)
from mbsym.problems.polynomial_integrals.search import polynomial_integrals, products, sparsest
from mbsym.problems.polynomial_integrals.values import LARGEST, lifted_factor, meets

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
        bottom, f = put_in(field, condition, (bottom, f))
    if bottom == 0:
        return False
    if not any(bottom.degrees()[k] for k in field.places):
        return True
    return any(_meets(f, bottom, images, scale) for images, scale in _curves(field))


def put_in(field: PolynomialField, condition: Any, formulas: Sequence[Any]) -> list[Any]:
    """The formulas where the condition vanishes, if that is linear in a parameter; else as they are."""
    degrees = condition.degrees()
    for k in range(len(field.parameters)):
        slope = condition.derivative(k)
        if degrees[k] == 1 and slope.is_constant():
            images = list(field.context.gens())
            images[k] = -(condition - slope * images[k]) / slope.leading_coefficient()
            return [x.compose(*images, ctx=field.context) for x in formulas]
    return list(formulas)


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
    if any(not group for group in groups):
        return  # of other relations no points are known
    alone = [(k,) for k in field.places if not any(k in group for group in groups)]
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
                values = [value * inverse for value in values]
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
    integrals: PolynomialIntegrals, prime: int = PRIMES[0], known: Sequence[tuple[int, Any]] = ()
) -> DarbouxPolynomials:
    """All that are no products of others and of ``integrals``, up to their degree; each proved by division.

    ``known``: weights and polynomials of some, which are not listed again, nor their products.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    field, grading = integrals.field, integrals.grading
    rise, weights = grading.rise, grading.weights
    if rise is None or (field.relations and not grading.free):
        return DarbouxPolynomials(integrals.degree, weights, (), (), Obstacle.NOT_HOMOGENEOUS)
    powers = powers_of_cofactor(grading)
    if any(sum(1 for a in power if a) > 1 for power in powers):
        return DarbouxPolynomials(integrals.degree, weights, (), (), Obstacle.MIXED)
    means = [rest_means(field, power) for power in powers]
    if any(mean is None for mean in means):
        return DarbouxPolynomials(integrals.degree, weights, (), (), Obstacle.NOT_AT_REST)
    there = at_random(field, prime, f"darboux {integrals.degree}")
    before = [(weight, f, cofactor_of(field, f)) for weight, f in known]
    search = DarbouxSearch(
        integrals, there, [DarbouxPolynomial(f, w, k) for w, f, k in before if k is not None and k != 0]
    )
    counts: list[DarbouxCount] = []
    for weight in range(1, integrals.degree + 1):
        most = weight // min(weights)
        choices = [_sums(mean or [], most, field.context.constant(0)) for mean in means]
        number = 1
        for choice in choices:
            number *= len(choice)
        if number > MOST_COFACTORS:
            return DarbouxPolynomials(integrals.degree, weights, tuple(search.found), tuple(counts), Obstacle.TOO_MANY)
        cofactors = [
            sum(
                (c * monomial(field, power) for c, power in zip(values, powers, strict=True)), field.context.constant(0)
            )
            for values in product(*choices)
        ]
        counts += [search.of(weight, cofactor) for cofactor in cofactors if cofactor != 0]
    return DarbouxPolynomials(integrals.degree, weights, tuple(search.found), tuple(counts), None)


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
    means: list[Any] = []
    for factor in factors:
        if factor.mean != 0 and factor.mean not in means:
            means.append(factor.mean)
    return means


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
    factors = []
    for factor, _ in irreducible_factors(characteristic)[1]:
        parts = coefficients_in(factor, 0)  # the last a number: the characteristic polynomial is monic
        scaled = [c / parts[-1].leading_coefficient() for c in parts]
        factors.append(RestFactor(tuple(c.compose(context.constant(0), *context.gens(), ctx=context) for c in scaled)))
    return factors


T = TypeVar("T")


def _sums(
    values: Sequence[T], most: int, zero: T, bound: int = MOST_COFACTORS, join: Callable[[T, T], T] = add
) -> list[T]:
    """All sums of at most so many of them, each once, until there are more than ``bound``."""
    sums, last = [zero], [zero]
    for _ in range(most):
        new: list[T] = []
        for total in (join(x, y) for x in last for y in values):
            if total not in sums and total not in new:
                new.append(total)
        sums, last = sums + new, new
        if not new or len(sums) > bound:
            break
    return sums


@dataclass(frozen=True)
class _Factor:
    """A Darboux polynomial that is known, and itself modulo the prime."""

    polynomial: DarbouxPolynomial
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
        return [factor.polynomial for factor in self.factors[self.before :]]

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
        unit: Terms = {(0,) * count: 1}
        for left, terms in self._multiples(0, weight, cofactor, unit):
            for rest in products(self.integrals, left, True, prime, count, lambda terms: terms):
                yield times(terms, rest, prime)

    def _multiples(self, first: int, left: int, cofactor: Any, terms: Terms) -> Iterator[tuple[int, Terms]]:
        """Products of factors from ``first`` on whose cofactors add up to that: (weight left, product)."""
        if cofactor == 0:
            yield left, terms
        for k in range(first, len(self.factors)):
            factor = self.factors[k]
            if factor.polynomial.weight <= left:
                yield from self._multiples(
                    k,
                    left - factor.polynomial.weight,
                    cofactor - factor.polynomial.cofactor,
                    times(terms, factor.terms, self.there.prime),
                )


def _less(a: Terms, b: Terms, prime: int) -> Terms:
    difference = dict(a)
    for m, c in b.items():
        difference[m] = (difference.get(m, 0) - c) % prime
    return {m: c for m, c in difference.items() if c}


def cofactor_of(field: PolynomialField, f: Any) -> Any | None:
    """K with D f = K f by division, the second route; None where f does not divide D f."""
    quotient, rest = divmod(field.derivative(f), f)
    return quotient if rest == 0 else None


# Darboux polynomials along a line of parameters: at which values of one there are more of them, found exactly.
#
# D f = K f  with  K = sum_i c_i x_i^a, c_i = sum_j m_j rho_j  as in ``darboux``.  At a value of the parameter t more
# eigenvalues rho_j may be rational than for almost all t: of a quadratic factor  rho = s +- sqrt(Delta)/2  of the
# characteristic polynomial each root is taken by itself, besides the mean s.  The kernel of  D - K  is then that of a
# matrix over  QQ(t)[sqrt(Delta_1), ...], written with blocks in place of the roots, [[0, Delta], [1, 0]].  Another f is
# at t only where the rank of that matrix drops, or that of the products with the same K of what holds for almost all t;
# the zeros of maximal minors are found modulo a prime (``drops``), and each rational one is looked at exactly.
#
# What is proved of values that are not listed: they are no zeros modulo the prime, where the rank is the usual one;
# hence none is rational with numerator and denominator up to 10^9 < sqrt(p/2), but for what ``DarbouxAlong`` names as
# left out.
#
# Source: M. Kus, Integrals of motion for the Lorenz system, J. Phys. A 16 (1983); J. Llibre & X. Zhang, Invariant
# algebraic surfaces of the Lorenz system, J. Math. Phys. 43 (2002), for the values that it is tried at.


#: Sums of eigenvalues at one point; K of one weight; columns of a matrix with blocks.
MOST_SUMS, MOST_COFACTORS_ALONG, MOST_COLUMNS = 60, 3000, 400
#: Work for all K, in products of numbers; so many of these are worth one column.
MOST_TOTAL, COLUMN = 4 * 10**10, 100_000

#: c + sum_j n_j sqrt(Delta_j) of one coefficient of K: c, and pairs (j, n_j), n_j not zero.
Value = tuple[Any, tuple[tuple[int, Fraction], ...]]


def darboux_along(usual: PolynomialIntegrals, low: Fraction, high: Fraction) -> DarbouxAlong:
    """The values in  low <= t <= high  of the field's only parameter at which there are Darboux polynomials besides.

    Raises ValueError where the field has not one parameter, NoClosedForm where more monomials are coupled than the
    bounds allow.
    """
    field = usual.field
    if len(field.parameters) != 1:
        raise ValueError(f"one parameter is wanted, not {len(field.parameters)}")
    general = darboux_polynomials(usual)
    empty = DarbouxAlong(field.parameters[0], low, high, general)
    if general.obstacle is not None and general.obstacle is not Obstacle.TOO_MANY:
        return empty
    search = _Drops(usual, general)
    search.run()
    specials, undecided = [], []
    for value in sorted(value for value in search.values if low <= value <= high):
        try:
            special = at_value(usual, general, value)
        except ZeroDivisionError:
            continue  # there are no equations there
        except NoClosedForm:
            undecided.append(value)
            continue
        if special.polynomials:
            specials.append(special)
        if not special.complete:
            undecided.append(value)
    return DarbouxAlong(
        field.parameters[0],
        low,
        high,
        general,
        tuple(specials),
        tuple(undecided),
        tuple(p for p in search.irrational if meets(p, low, high)),
        tuple(search.square),
        search.left,
        not search.lost,
    )


def at_value(usual: PolynomialIntegrals, general: DarbouxPolynomials, value: Fraction) -> DarbouxSpecial:
    """What there is at a value beyond products of what there is in general and of integrals, each proved by division.

    Raises ZeroDivisionError where the field divides by zero, NoClosedForm where that takes too much.
    """
    name = usual.field.parameters[0]
    number = rationals.exact(value)
    field = usual.field.at({name: number})
    images = [field.context.constant(number), *field.context.gens()]
    named = [(str(k), one.polynomial.compose(*images, ctx=field.context)) for k, one in enumerate(usual.generators)]
    here = polynomial_integrals(field, usual.grading, usual.degree, named)
    known = [(one.weight, one.polynomial.compose(*images, ctx=field.context)) for one in general.polynomials]
    polynomials = darboux_polynomials(here, known=known)
    return DarbouxSpecial(value, field, polynomials.polynomials, polynomials.complete and here.complete)


@dataclass(frozen=True)
class _Orbit:
    """One K with all its conjugates: pairs of a monomial's exponents and its coefficient."""

    weight: int
    terms: tuple[tuple[tuple[int, ...], Value], ...]

    @property
    def roots(self) -> list[int]:
        return sorted({j for _, (_, signs) in self.terms for j, _ in signs})

    def is_zero(self) -> bool:
        return all(c == 0 and not signs for _, (c, signs) in self.terms)


class _Drops:
    """Values of t at which a rank drops.

    ``square``: polynomials Delta with an f over sqrt(Delta) for almost all t; ``left``: K that were not looked at;
    ``lost``: eigenvalues of higher degree that move with t, whose separate roots were not followed, or zeros that are
    no small fractions.
    """

    def __init__(self, usual: PolynomialIntegrals, general: DarbouxPolynomials) -> None:
        self.usual, self.field, self.general = usual, usual.field, general
        self.values: dict[Fraction, None] = {}
        self.irrational: list[Any] = []
        self.square: list[Any] = []
        self.discriminants: list[Any] = []
        self.left, self.lost = 0, False
        self.line = Line(self.field, PRIMES[0], {self.field.parameters[0]: 0}, {self.field.parameters[0]: 1})
        self.there = at_random(self.field, PRIMES[0], "darboux along")

    def run(self) -> None:
        grading = self.usual.grading
        powers = powers_of_cofactor(grading)
        listed = [self._eigenvalues(power) for power in powers]
        budget = MOST_TOTAL
        orbits = []
        for weight in range(1, self.usual.degree + 1):
            most = weight // min(grading.weights)
            zero: Value = (self.field.context.constant(0), ())
            choices = [_sums(eigenvalues, most, zero, MOST_SUMS, _added) for eigenvalues in listed]
            number = 1
            for choice in choices:
                number *= len(choice)
            if number > MOST_COFACTORS_ALONG:
                self.left += number - 1
                continue
            orbits += list(self._orbits(weight, powers, choices))
        for orbit in sorted(orbits, key=self._price):
            price = self._price(orbit)
            if price > budget or self._columns(orbit) > MOST_COLUMNS:
                self.left += 1
                continue
            budget -= price
            self._look(orbit)
        for p in self.discriminants:
            self._double_roots(p)
        self._of_products()

    def _eigenvalues(self, power: tuple[int, ...]) -> list[Value]:
        eigenvalues: list[Value] = []

        def add(value: Value) -> None:
            if (value[0] != 0 or value[1]) and value not in eigenvalues:
                eigenvalues.append(value)

        for factor in rest_factors(self.field, power) or []:
            add((factor.mean, ()))
            if factor.degree == 2:
                delta = factor.discriminant()
                if _moves(delta):  # otherwise the roots are as rational at any t as they are in general
                    j = self._place(delta)
                    for sign in (1, -1):
                        add((factor.mean, ((j, Fraction(sign, 2)),)))
            elif factor.degree > 2 and factor.moves:
                self.lost = True
        return eigenvalues

    def _place(self, delta: Any) -> int:
        if delta not in self.discriminants:
            self.discriminants.append(delta)
        return self.discriminants.index(delta)

    def _orbits(
        self, weight: int, powers: Sequence[tuple[int, ...]], choices: Sequence[Sequence[Value]]
    ) -> Iterator[_Orbit]:
        """Each K up to the signs of roots, without zero."""
        for chosen in product(*choices):
            terms = tuple(
                (power, value) for power, value in zip(powers, chosen, strict=True) if value[0] != 0 or value[1]
            )
            orbit = _Orbit(weight, terms)
            first: dict[int, Fraction] = {}
            for _, (_, signs) in terms:
                for j, n in signs:
                    first.setdefault(j, n)
            if not orbit.is_zero() and all(n > 0 for n in first.values()):
                yield orbit

    def _columns(self, orbit: _Orbit) -> int:
        return len(monomials(self.usual.grading.weights, orbit.weight)) << len(orbit.roots)

    def _price(self, orbit: _Orbit) -> int:
        columns = self._columns(orbit)
        values = columns * max(1, self.line.degree(), self._extra(orbit)) + 1
        return values * (columns**3 + COLUMN * columns)

    def _extra(self, orbit: _Orbit) -> int:
        parts = [c for _, (c, _) in orbit.terms] + [self.discriminants[j] for j in orbit.roots]
        return max(int(p.degrees()[0]) for p in parts)

    def _build(self, orbit: _Orbit) -> Build:
        """The columns of D - K, a block of 2^r for each monomial: rows have the number of a product of roots behind."""
        columns = monomials(self.usual.grading.weights, orbit.weight)
        places = orbit.roots

        def images(there: ModularField) -> list[Terms]:
            prime = there.prime
            squares = [_constant(there, self.discriminants[j]) for j in places]
            image_columns = []
            for m in columns:
                rate = there.derivative(m)
                for mask in range(1 << len(places)):
                    image: Terms = {(*key, mask): c for key, c in rate.items()}
                    for power, (c, signs) in orbit.terms:
                        moved = tuple(map(int.__add__, m, power))
                        parts = [(mask, _constant(there, c))]
                        for j, n in signs:
                            k = places.index(j)
                            factor = n.numerator * pow(n.denominator, -1, prime)
                            parts.append((mask ^ (1 << k), factor * (squares[k] if mask >> k & 1 else 1) % prime))
                        for other, value in parts:
                            key = (*moved, other)
                            image[key] = (image.get(key, 0) - value) % prime
                    image_columns.append({key: c for key, c in image.items() if c})
            return image_columns

        return images

    def _look(self, orbit: _Orbit) -> None:
        build = self._build(orbit)
        if orbit.roots and kernel_of(build(self.there), PRIMES[0]):
            for j in orbit.roots:
                if self.discriminants[j] not in self.square:
                    self.square.append(self.discriminants[j])
        try:
            self._take(dropped(self.line, build, self._extra(orbit)))
        except NoClosedForm:
            self.left += 1

    def _of_products(self) -> None:
        """Where products of Darboux polynomials and integrals that hold for almost all t become dependent."""
        for count in self.general.counts:
            if not count.products:
                continue

            def build(there: ModularField, weight: int = count.weight, cofactor: Any = count.cofactor) -> list[Terms]:
                return list(DarbouxSearch(self.usual, there, self.general.polynomials).products(weight, cofactor))

            parts = [polynomial.polynomial for polynomial in self.general.polynomials]
            parts += [generator.polynomial for generator in self.usual.generators]
            degree = max((int(p.degrees()[0]) for p in parts), default=0)
            try:
                self._take(dropped(self.line, build, count.weight * degree))
            except NoClosedForm:
                self.left += 1

    def _take(self, g: Any) -> None:
        if g == 0:
            self.lost = True
            return
        for root, _ in roots(g):
            value = rational(root, PRIMES[0])
            if value is not None and max(abs(value.numerator), value.denominator) <= LARGEST:
                self.values[value] = None
        for factor in others(g):
            lifted = lifted_factor(factor)
            if lifted is not None and lifted not in self.irrational:
                self.irrational.append(lifted)

    def _double_roots(self, delta: Any) -> None:
        for factor, _ in univariate(delta).factor()[1]:
            if factor.degree() == 1:
                root = -factor[0] / factor[1]
                self.values[rationals.fraction(root)] = None


def _moves(delta: Any) -> bool:
    """Whether it depends on t if Delta is the square of a rational number: not where it is one but for a constant."""
    return any(power % 2 for _, power in univariate(delta).factor()[1])


def _constant(there: ModularField, p: Any) -> int:
    """The value of a polynomial in the parameters alone."""
    return sum(there.terms(p).values()) % there.prime


def _added(a: Value, b: Value) -> Value:
    signs = dict(a[1])
    for j, n in b[1]:
        signs[j] = signs.get(j, Fraction(0)) + n
    return a[0] + b[0], tuple(sorted((j, n) for j, n in signs.items() if n))
