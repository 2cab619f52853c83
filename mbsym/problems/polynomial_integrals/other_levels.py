"""Particular integrals on levels other than zero:  df/dt = K (V - c), c not zero, with c unknown.

In a quasi-homogeneous field let V be an integral of weight v.  Of an f that is constant on V = c the terms fall into
classes of weights modulo v, which D and the ideal of V - c keep.  In each class  F = sum (V/c)^m_j f_j  with equal
weights equals f on the level, and D F, homogeneous and a multiple of V - c, is zero:  there are none but the integrals
that hold everywhere.  So it is where no other quantity is fixed.

Where one is, U = 1 of weight u (the square of a unit vector, or the constant that made the field quasi-homogeneous),
the same with both gives  D F = K W,  W = V^a - k U^b,  a v = b u the least common multiple, k = c^a: the level's union
over all sizes.  F has the weight N for which N less the weight of each term is a sum of multiples of u and v.  Columns
are  D x^m  and  -x^m W,  linear in k; where the rank drops, or that of the products of integrals modulo W, is found as
along a line of parameters (``drops``), each rational k looked at exactly and each F proved by division.  A dimension of
a kernel is the same over any larger field: F with irrational coefficients are none besides.

Levels are taken whole: where V - c is a product, integrals on one factor's zeros alone are not looked for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import gcd
from random import Random
from typing import Any

from flint import fmpq_mpoly_ctx, nmod_mat, nmod_poly

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals import modular
from mbsym.problems.polynomial_integrals.excess import Line, dropped, interpolated, others, rational, roots
from mbsym.problems.polynomial_integrals.levels import Level, cofactors, kernel_on, levels, on_level, standard
from mbsym.problems.polynomial_integrals.result import (
    Generator,
    OtherLevel,
    OtherLevels,
    PolynomialIntegrals,
    SpecialLevel,
)
from mbsym.problems.polynomial_integrals.search import polynomial_integrals, products
from mbsym.problems.polynomial_integrals.values import LARGEST, lifted_factor

#: Monomials of one weight that are looked at.
MOST_COLUMNS = 250


def other_levels(integrals: PolynomialIntegrals, fixed: Generator | None) -> OtherLevels:
    """What holds where an integral of the list has a value that is not zero, and ``fixed`` is 1.

    Of a quasi-homogeneous field; ``fixed`` is one of ``integrals.generators``, None where there is no such quantity.
    """
    listed = [level for level in levels(integrals) if level is not fixed]
    return OtherLevels(integrals.degree, fixed is not None, tuple(_level(integrals, fixed, level) for level in listed))


def _level(integrals: PolynomialIntegrals, fixed: Generator | None, generator: Generator) -> OtherLevel:
    if fixed is None:
        return OtherLevel(generator, 1, complete=integrals.complete)
    step = gcd(generator.weight, fixed.weight)
    power, other = fixed.weight // step, generator.weight // step
    weights = _weights(integrals.degree, generator.weight, fixed.weight)
    rise = integrals.grading.rise or 0
    top = generator.weight * power
    most = max(weights)
    if most + rise < top:  # K is zero: F is an integral everywhere, and those are all known where the list is complete
        return OtherLevel(generator, power, complete=_general(integrals, most).complete)
    if modular.count(integrals.grading.weights, most) > MOST_COLUMNS:
        return OtherLevel(generator, power, looked=False)
    try:
        usual = _general(integrals, most)
        return _Search(usual, fixed, generator, power, other, weights).result()
    except NoClosedForm:
        return OtherLevel(generator, power, looked=False)


def _weights(degree: int, first: int, second: int) -> list[int]:
    """For each class modulo the common divisor: the weight to which all terms up to a degree can be raised."""
    step = gcd(first, second)
    reached = {0}
    bound = degree + first * second + first + second
    for n in range(1, bound + 1):
        if n - first in reached or n - second in reached:
            reached.add(n)
    weights = []
    for start in range(min(step, degree + 1)):
        own = range(start, degree + 1, step)
        weights.append(next(n for n in range(own[-1], bound + 1) if all(n - w in reached for w in own)))
    return sorted({n for n in weights if n})


def _general(integrals: PolynomialIntegrals, degree: int) -> PolynomialIntegrals:
    """The integrals up to a larger degree; those known keep their names."""
    if degree <= integrals.degree:
        return integrals
    known = [(generator.name, generator.polynomial) for generator in integrals.generators]
    larger = polynomial_integrals(integrals.field, integrals.grading, degree, known)
    return replace(
        larger, generators=(*integrals.generators, *(x for x in larger.generators if x.weight > integrals.degree))
    )


class _Search:
    def __init__(
        self,
        usual: PolynomialIntegrals,
        fixed: Generator,
        one: Generator,
        power: int,
        other: int,
        weights: Sequence[int],
    ) -> None:
        self.usual, self.one, self.power, self.weights = usual, one, power, weights
        self.top, self.bottom = one.polynomial**power, fixed.polynomial**other
        self.weight = one.weight * power
        field = usual.field
        name = "level"
        while name in field.context.names():
            name += "_"
        context = fmpq_mpoly_ctx.get([name, *field.context.names()], field.context.ordering())

        self.context = context
        up = self._up
        self.name = name
        self.field = PolynomialField(
            context, (name, *field.parameters), field.variables, tuple(map(up, field.numerators)), up(field.denominator)
        )
        self.level = up(self.top) - context.gen(0) * up(self.bottom)
        self.known = [(x.weight, up(x.polynomial)) for x in usual.generators]

    def _up(self, p: Any) -> Any:
        return self.context.from_dict({(0, *m): c for m, c in p.to_dict().items()})

    def result(self) -> OtherLevel:
        source = Random("levels")
        numbers = {name: source.randrange(1, modular.PRIMES[0]) for name in self.usual.field.parameters}
        line = Line(self.field, modular.PRIMES[0], numbers | {self.name: 0}, dict.fromkeys(numbers, 0) | {self.name: 1})
        total = nmod_poly([1], modular.PRIMES[0])
        for weight in self.weights:
            total = total * self._drops(line.at(source.randrange(1, modular.PRIMES[0])), weight, source)
            steps = weight // self.weight + 1
            total = total * dropped(line, lambda there, w=weight, s=steps: self._products(there, w, s), steps)  # type: ignore[misc]
        if total == 0:
            return OtherLevel(self.one, self.power, looked=False)
        zeros = [root for root, _ in roots(total) if root]
        whole = not zeros and not others(total)
        usual = self._usual_is_complete(line, source)
        if self.usual.field.parameters:
            return OtherLevel(self.one, self.power, whole=whole, complete=usual, drops=not whole, by_rank=True)
        return self._at_numbers(zeros, others(total), whole, usual)

    def _at_numbers(self, zeros: Sequence[int], factors: Sequence[Any], whole: bool, usual: bool) -> OtherLevel:
        values, undecided = [], []
        for value in sorted(x for x in (rational(root, modular.PRIMES[0]) for root in zeros) if x is not None):
            if max(abs(value.numerator), value.denominator) > LARGEST:
                continue
            there = self.at(value)
            if there is None:
                undecided.append(value)
            elif there.integrals:
                values.append(there)
        irrational = tuple(p for p in map(lifted_factor, factors) if p is not None)
        return OtherLevel(self.one, self.power, tuple(values), tuple(undecided), irrational, whole, usual, by_rank=True)

    def at(self, value: Fraction) -> SpecialLevel | None:
        """What there is on one level beyond the integrals that hold everywhere; None where that takes too much."""
        polynomial = self.top - rationals.exact(value) * self.bottom
        zero = replace(self.one, polynomial=polynomial, weight=self.weight)
        try:
            on_value = on_level(self.usual, zero)
        except NoClosedForm:
            return None
        return SpecialLevel(value, on_value.integrals, on_value.complete)

    def _zero(self, there: modular.ModularField) -> Level:
        return Level(self.level, self.weight, there.terms(self.level))

    def _drops(self, there: modular.ModularField, weight: int, source: Random) -> nmod_poly:
        """A polynomial in k that vanishes where the K with  K W  in the image of D become more.

        With N the linear relations of that image the K are the kernel of  N (x^b V^a) - k N (x^b U^b).
        """
        prime = there.prime
        zero = self._zero(there)
        columns = standard(self.usual.grading.weights, weight, zero)
        multiples = cofactors(self.usual, weight, zero)
        parts = [there.derivative(m) for m in columns]
        upper, lower = (there.terms(p) for p in (self._up(self.top), self._up(self.bottom)))
        tops = [modular.times({b: 1}, upper, prime) for b in multiples]
        bottoms = [modular.times({b: 1}, lower, prime) for b in multiples]
        rows = {key: k for k, key in enumerate(dict.fromkeys(m for p in (*parts, *tops, *bottoms) for m in p))}
        if not multiples:
            return nmod_poly([1], prime)
        basis, size = (
            _matrix(parts, rows, prime).transpose().nullspace() if parts else (_identity(rows, prime), len(rows))
        )
        if not size:
            return nmod_poly([1], prime)
        relations = nmod_mat([[int(basis[r, k]) for r in range(len(rows))] for k in range(size)], prime)
        first, second = relations * _matrix(tops, rows, prime), relations * _matrix(bottoms, rows, prime)

        def at(t: int, a: nmod_mat, b: nmod_mat) -> nmod_mat:
            return a - nmod_mat([[int(x) * t % prime for x in row] for row in b.table()], prime)

        rank = at(source.randrange(prime), first, second).rank()
        drops = nmod_poly([0], prime)
        for _ in range(2):
            left = _random(rank, size, prime, source)
            right = _random(len(multiples), rank, prime, source)
            a, b = left * first * right, left * second * right
            shift = source.randrange(prime - rank - 2)
            values = [int(at(shift + 1 + k, a, b).det()) if rank else 1 for k in range(rank + 1)]
            drops = drops.gcd(interpolated(values, shift, prime))
        return drops

    def _products(self, there: modular.ModularField, weight: int, steps: int) -> list[modular.Terms]:
        """Products of integrals modulo W, times a power of its leading coefficient."""
        zero = self._zero(there)
        pairs = [(own, there.terms(f)) for own, f in self.known]
        spanned = products(pairs, weight, True, there.prime, len(self.field.variables), lambda terms: terms)
        scale = pow(zero.terms[zero.leading], steps, there.prime)
        rests = [modular.remainder(terms, zero.terms, there.prime) for terms in spanned]
        return [{m: c * scale % there.prime for m, c in rest.items()} for rest in rests]

    def _usual_is_complete(self, line: Line, source: Random) -> bool:
        """Whether for almost all k there is nothing beyond products."""
        there = line.at(source.randrange(1, modular.PRIMES[0]))
        zero = self._zero(there)
        for weight in self.weights:
            columns = standard(self.usual.grading.weights, weight, zero)
            most = kernel_on(there, columns, cofactors(self.usual, weight, zero), zero)
            rows, _ = modular.echelon(self._products(there, weight, 1), columns, there.prime)
            if len(most) > len(rows):
                return False
        return True


def _matrix(columns: Sequence[modular.Terms], rows: Mapping[modular.Exponents, int], prime: int) -> nmod_mat:
    entries = [0] * (len(rows) * len(columns))
    for k, column in enumerate(columns):
        for key, value in column.items():
            entries[rows[key] * len(columns) + k] = value
    return nmod_mat(len(rows), len(columns), entries, prime)


def _identity(rows: Mapping[modular.Exponents, int], prime: int) -> nmod_mat:
    return nmod_mat([[int(i == j) for j in range(len(rows))] for i in range(len(rows))], prime)


def _random(rows: int, columns: int, prime: int, source: Random) -> nmod_mat:
    return nmod_mat(rows, columns, [source.randrange(prime) for _ in range(rows * columns)], prime)
