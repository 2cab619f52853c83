"""Darboux polynomials along a line of parameters: at which values of one there are more of them, found exactly.

D f = K f  with  K = sum_i c_i x_i^a, c_i = sum_j m_j rho_j  as in ``darboux``.  At a value of the parameter t more
eigenvalues rho_j may be rational than for almost all t: of a quadratic factor  rho = s +- sqrt(Delta)/2  of the
characteristic polynomial each root is taken by itself, besides the mean s.  The kernel of  D - K  is then that of a
matrix over  QQ(t)[sqrt(Delta_1), ...], written with blocks in place of the roots, [[0, Delta], [1, 0]].  Another f is
at t only where the rank of that matrix drops, or that of the products with the same K of what holds for almost all t;
the zeros of maximal minors are found modulo a prime (``drops``), and each rational one is looked at exactly.

What is proved of values that are not listed: they are no zeros modulo the prime, where the rank is the usual one; hence
none is rational with numerator and denominator up to 10^9 < sqrt(p/2), but for what ``DarbouxAlong`` names as left out.

Source: M. Kus, Integrals of motion for the Lorenz system, J. Phys. A 16 (1983); J. Llibre & X. Zhang, Invariant
algebraic surfaces of the Lorenz system, J. Math. Phys. 43 (2002), for the values that it is tried at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.terms import univariate
from mbsym.problems.polynomial_integrals.darboux import (
    DarbouxSearch,
    darboux_polynomials,
    powers_of_cofactor,
    rest_factors,
)
from mbsym.problems.polynomial_integrals.excess import Build, Line, dropped, others, rational, roots
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    ModularField,
    Terms,
    at_random,
    kernel_of,
    monomials,
)
from mbsym.problems.polynomial_integrals.result import (
    DarbouxAlong,
    DarbouxPolynomials,
    DarbouxSpecial,
    Obstacle,
    PolynomialIntegrals,
)
from mbsym.problems.polynomial_integrals.search import polynomial_integrals
from mbsym.problems.polynomial_integrals.values import LARGEST, lifted_factor, meets

#: Sums of eigenvalues at one point; K of one weight; columns of a matrix with blocks.
MOST_SUMS, MOST_COFACTORS, MOST_COLUMNS = 60, 3000, 400
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
    for value in sorted(one for one in search.values if low <= one <= high):
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
            choices = [self._sums(one, most) for one in listed]
            number = 1
            for choice in choices:
                number *= len(choice)
            if number > MOST_COFACTORS:
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

    def _sums(self, values: Sequence[Value], most: int) -> list[Value]:
        """All sums of at most so many of them, each once."""
        zero: Value = (self.field.context.constant(0), ())
        sums, last = [zero], [zero]
        for _ in range(most):
            new: list[Value] = []
            for total in (_added(x, y) for x in last for y in values):
                if total not in sums and total not in new:
                    new.append(total)
            sums, last = sums + new, new
            if not new or len(sums) > MOST_SUMS:
                break
        return sums

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
            found = []
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
                    found.append({key: c for key, c in image.items() if c})
            return found

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
