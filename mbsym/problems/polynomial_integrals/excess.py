"""How many integrals there are beyond the products of those that hold for all parameters, modulo a prime."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from fractions import Fraction
from functools import cached_property
from math import isqrt
from typing import Any

from flint import fmpq, fmpq_mat, fmpq_poly, nmod, nmod_mat, nmod_poly

from mbsym.algebra import rationals
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import fraction_modulo
from mbsym.expressions.message import Message
from mbsym.problems.polynomial_integrals.levels import (
    Level,
    cofactors,
    images_on,
    kernel_on,
    levels,
    on_level,
    standard,
)
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    SMALLER,
    ModularField,
    Terms,
    at_random,
    coupled,
    echelon,
    kernel,
    monomial,
    monomials,
    remainder,
)
from mbsym.problems.polynomial_integrals.result import OnLevel, PolynomialIntegrals
from mbsym.problems.polynomial_integrals.search import products

# Where along a line of parameters the kernel becomes larger: zeros of all maximal minors, modulo a prime.
#
# The matrix of d/dt on monomials is polynomial in the parameters.  On a line  a + b t  its maximal minors are
# polynomials in t; the greatest common divisor of two random combinations of them is that of all with near certainty,
# and in any case a multiple of it: no value at which the rank drops is lost.


#: Values of t that are put in, for one part of the matrix, times its rows and columns.
MOST_WORK = 400_000_000

Build = Callable[[ModularField], list[Terms]]


@dataclass(frozen=True)
class Line:
    """Parameters  start + slope t  modulo a prime."""

    field: PolynomialField
    prime: int
    start: Mapping[str, int]
    slope: Mapping[str, int]
    #: Fields at values of t that were asked for.
    seen: dict[int, ModularField] = dataclass_field(default_factory=dict, compare=False, repr=False)

    def at(self, t: int) -> ModularField:
        if t in self.seen:
            return self.seen[t]
        values = {name: (self.start[name] + self.slope[name] * t) % self.prime for name in self.field.parameters}
        self.seen[t] = ModularField(self.field, self.prime, values)
        return self.seen[t]

    def degree(self) -> int:
        """Of the field's coefficients in t, at most."""
        count = len(self.field.parameters)
        moving = [k for k, name in enumerate(self.field.parameters) if self.slope[name]]
        return (
            max((sum(int(m[k]) for k in moving) for p in self.field.numerators for m in p.monoms()), default=0)
            if (count)
            else 0
        )


def dropped(line: Line, build: Build, extra: int = 0) -> nmod_poly:
    """A polynomial in t that vanishes wherever the rank of the matrix with columns ``build`` is not the usual one.

    ``extra``: the degree in t of columns that are no derivatives, where it is larger.  Raises NoClosedForm where that
    takes too much work.
    """
    source = random.Random(f"line {line.prime}")
    somewhere = [build(line.at(source.randrange(line.prime))) for _ in range(2)]
    count = len(somewhere[0])
    images = [{**a, **b} for a, b in zip(*somewhere, strict=True)]
    entry = max(line.degree(), extra)
    total = nmod_poly([1], line.prime)
    parts = [(part, _Part(somewhere[0], images, part, line.prime, source)) for part in coupled(images)]
    parts = [(part, block) for part, block in parts if block.rank]
    if sum((block.rank * entry + 1) * len(part) * block.height for part, block in parts) > MOST_WORK:
        message = Message("the minors of [[count]] monomials along a line take too long", count=count)
        raise NoClosedForm(message, limit=Limit.DEGREE, remedy=SMALLER)
    most = max((block.rank * entry for _, block in parts), default=0)
    values: list[list[tuple[int, int]]] = [[] for _ in parts]
    shift = source.randrange(line.prime)  # at small numbers leading coefficients may vanish
    for t in range(shift + 1, shift + most + 2):
        if all(block.rank * entry + 1 <= len(done) for (_, block), done in zip(parts, values, strict=True)):
            break
        here = build(line.at(t))
        for (_, part), done in zip(parts, values, strict=True):
            if len(done) <= part.rank * entry:
                done.append(part.minors(here))
    for done in values:
        first = interpolated([a for a, _ in done], shift, line.prime)
        second = interpolated([b for _, b in done], shift, line.prime)
        total = total * first.gcd(second)
    return total


class _Part:
    """A block of the matrix, its usual rank, and two random combinations of rows and of columns."""

    def __init__(
        self, usual: Sequence[Terms], images: Sequence[Terms], part: Sequence[int], prime: int, source: random.Random
    ) -> None:
        self.part, self.prime = part, prime
        self.rows = {key: k for k, key in enumerate(dict.fromkeys(key for j in part for key in images[j]))}
        self.height = max(1, len(self.rows))
        self.rank = self._matrix(usual).rank()

        def mixed(rows: int, columns: int) -> nmod_mat:
            return nmod_mat(rows, columns, [source.randrange(prime) for _ in range(rows * columns)], prime)

        self.mixtures = [
            (mixed(self.rank, self.height), mixed(len(part), self.rank)) for _ in range(2 if self.rank else 0)
        ]

    def _matrix(self, images: Sequence[Terms]) -> nmod_mat:
        entries = [0] * (self.height * len(self.part))
        for k, j in enumerate(self.part):
            for key, value in images[j].items():
                entries[self.rows[key] * len(self.part) + k] = value
        return nmod_mat(self.height, len(self.part), entries, self.prime)

    def minors(self, images: Sequence[Terms]) -> tuple[int, int]:
        matrix = self._matrix(images)
        (a, b), (c, d) = self.mixtures
        return int((a * matrix * b).det()), int((c * matrix * d).det())


def interpolated(values: Sequence[int], shift: int, prime: int) -> nmod_poly:
    """The polynomial with these values at shift + 1, shift + 2, ...: Newton's divided differences."""
    table = [nmod(x, prime) for x in values]
    for k in range(1, len(table)):
        inverse = nmod(1, prime) / nmod(k, prime)
        for j in range(len(table) - 1, k - 1, -1):
            table[j] = (table[j] - table[j - 1]) * inverse
    polynomial = nmod_poly([0], prime)
    for k in range(len(table) - 1, -1, -1):
        polynomial = polynomial * nmod_poly([-(shift + k + 1) % prime, 1], prime) + nmod_poly([int(table[k])], prime)
    return polynomial


def rational(value: int, prime: int) -> Fraction | None:
    """a/b = value modulo the prime with |a|, b < sqrt(prime/2), if there is such a fraction (it is the only one)."""
    parts = fraction_modulo(value % prime, prime, isqrt(prime // 2))
    return None if parts is None else Fraction(*parts)


def roots(p: Any) -> list[tuple[int, int]]:
    """The zeros in the prime field with their multiplicities."""
    if p.degree() < 1:
        return []
    prime = p.modulus()
    return [(int(-factor[0] / factor[1]) % prime, power) for factor, power in p.factor()[1] if factor.degree() == 1]


def others(p: Any) -> list[Any]:
    """The irreducible factors of higher degree."""
    return [] if p.degree() < 1 else [factor for factor, _ in p.factor()[1] if factor.degree() > 1]


#: Columns of a matrix whose rank is found over QQ.
MOST_EXACT = 400


@dataclass(frozen=True)
class Block:
    """Integrals of one weight, everywhere or where the integral ``level`` (its number in the list) vanishes."""

    weight: int
    level: int | None = None


class Excess:
    """Of a quasi-homogeneous field with the integrals ``usual`` for almost all parameters.

    ``columns`` counts those of all matrices so far.
    """

    def __init__(self, usual: PolynomialIntegrals) -> None:
        self.usual = usual
        self.columns = 0
        weights = range(1, usual.degree + 1)
        chosen = [None, *(usual.generators.index(level) for level in levels(usual))]
        self.blocks = [Block(weight, level) for level in chosen for weight in weights]

    @cached_property
    def on_levels(self) -> dict[int, OnLevel]:
        """What holds for almost all parameters where an integral vanishes, by the number of that one."""
        return {self.usual.generators.index(level): on_level(self.usual, level) for level in levels(self.usual)}

    def _known(self, block: Block) -> list[tuple[int, Any]]:
        """Weights and polynomials of what holds for almost all parameters."""
        general = [
            (generator.weight, generator.polynomial)
            for k, generator in enumerate(self.usual.generators)
            if k != block.level
        ]
        return general if block.level is None else [*general, *self.on_levels[block.level].integrals]

    def build(self, block: Block) -> Build:
        """The columns of the matrix whose kernel the integrals of a block are."""

        def images(there: ModularField) -> list[Any]:
            columns, zero = self._monomials(there, block)
            if zero is None:
                return [there.derivative(m) for m in columns]
            if not zero.terms:
                return []
            return images_on(there, columns, cofactors(self.usual, block.weight, zero), zero.terms)

        return images

    def _monomials(self, there: ModularField, block: Block) -> tuple[list[Any], Any]:
        """Those of a block, and V on its level: None where it has none; without terms there are no monomials."""
        weights, zero = self.usual.grading.weights, None
        if block.level is None:
            columns = list(monomials(weights, block.weight))
        else:
            zero = self._zero(there, block.level)
            columns = standard(weights, block.weight, zero) if zero.terms else []
        self.columns += len(columns)
        return columns, zero

    def extra(self, block: Block) -> int:
        """The degree in the parameters of what multiplies the cofactor."""
        if block.level is None:
            return 0
        count = len(self.usual.field.parameters)
        f = self.usual.generators[block.level].polynomial
        return max(sum(int(a) for a in m[:count]) for m in f.monoms())

    def dimension(self, there: ModularField, block: Block) -> int:
        """The dimension of the kernel at these parameters."""
        columns, zero = self._monomials(there, block)
        if zero is None:
            return len(kernel(there, columns, False))
        if not zero.terms:
            return 0
        return len(kernel_on(there, columns, cofactors(self.usual, block.weight, zero), zero))

    @cached_property
    def dimensions(self) -> dict[Block, int]:
        """That for almost all parameters."""
        there = at_random(self.usual.field, PRIMES[0], "usual dimensions")
        return {block: self.dimension(there, block) for block in self.blocks}

    def at(self, there: ModularField, block: Block) -> int:
        """The dimension of the kernel less that of the products, at these parameters."""
        columns, zero = self._monomials(there, block)
        if zero is not None and not zero.terms:  # there the integral is zero everywhere: it has no levels
            return 0
        pairs = [(weight, there.terms(f)) for weight, f in self._known(block)]

        def reduce(terms: Terms) -> Terms:
            return terms if zero is None else remainder(terms, zero.terms, there.prime)

        count = len(self.usual.grading.weights)
        spanned = products(pairs, block.weight, True, there.prime, count, reduce)
        return self.dimension(there, block) - len(echelon(list(map(reduce, spanned)), columns, there.prime)[0])

    def build_products(self, block: Block) -> tuple[Build, int]:
        """The products as columns, and their degree in the parameters; on a level times a power of the leading
        coefficient of V, so that remainders are polynomials.
        """
        weights, usual = self.usual.grading.weights, self.usual.generators
        count = len(self.usual.field.parameters)

        def degree(f: Any) -> int:
            return max(sum(map(int, m[:count])) for m in f.monoms())

        known = self._known(block)
        most = max((block.weight // weight * degree(f) for weight, f in known), default=0)
        steps = 0 if block.level is None else block.weight // usual[block.level].weight

        def images(there: ModularField) -> list[Terms]:
            pairs = [(weight, there.terms(f)) for weight, f in known]
            spanned = products(pairs, block.weight, True, there.prime, len(weights), lambda terms: terms)
            if block.level is None or not spanned:
                return spanned
            zero = self._zero(there, block.level)
            scale = pow(zero.terms[zero.leading], steps, there.prime)
            rests = [remainder(terms, zero.terms, there.prime) for terms in spanned]
            return [{m: c * scale % there.prime for m, c in rest.items()} for rest in rests]

        return images, most + (0 if block.level is None else steps * degree(usual[block.level].polynomial))

    def leading(self) -> list[Any]:
        """Of every level the leading coefficient of V, as a polynomial over QQ in the only parameter."""
        found = []
        for level in levels(self.usual):
            terms = level.polynomial.to_dict()
            top = max(tuple(map(int, m[1:])) for m in terms)
            powers = {int(m[0]): c for m, c in terms.items() if tuple(map(int, m[1:])) == top}
            found.append(fmpq_poly([powers.get(k, 0) for k in range(max(powers) + 1)]))
        return found

    def exactly(self, value: Fraction, block: Block) -> int | None:
        """The dimension of the kernel over QQ at a value of the only parameter; None where V has no such leading
        monomial there, or the matrix is too large.
        """
        usual = self.usual
        number = rationals.exact(value)
        field = usual.field.at({usual.field.parameters[0]: number})
        weights = usual.grading.weights
        columns, multiples = list(monomials(weights, block.weight)), []
        if block.level is not None:
            one = usual.generators[block.level]
            zero = self._zero(at_random(usual.field, PRIMES[0], "leading"), block.level)
            images = [field.context.constant(number), *field.context.gens()]
            level = one.polynomial.compose(*images, ctx=field.context)
            if level == 0 or max(tuple(map(int, m)) for m in level.monoms()) != zero.leading:
                return None
            columns = standard(weights, block.weight, zero)
            multiples = [monomial(field, m) * level for m in cofactors(usual, block.weight, zero)]
        if len(columns) + len(multiples) > MOST_EXACT:
            return None
        image_terms = [field.derivative(monomial(field, m)).to_dict() for m in columns] + [
            f.to_dict() for f in multiples
        ]
        rows = {key: k for k, key in enumerate(dict.fromkeys(key for terms in image_terms for key in terms))}
        table = [[fmpq(0)] * max(1, len(rows)) for _ in image_terms]
        for k, one in enumerate(image_terms):
            for key, c in one.items():
                table[k][rows[key]] = c
        return len(image_terms) - int(fmpq_mat(table).rank()) if image_terms else 0

    def signature(self, there: ModularField) -> tuple[int, ...]:
        """The excess of every block."""
        return tuple(self.at(there, block) for block in self.blocks)

    @cached_property
    def nothing(self) -> tuple[int, ...]:
        return (0,) * len(self.blocks)

    def _zero(self, there: ModularField, level: int) -> Level:
        generator = self.usual.generators[level]
        return Level(generator.polynomial, generator.weight, there.terms(generator.polynomial))


def larger(first: Sequence[int], second: Sequence[int]) -> bool:
    """Whether some entry of the first is larger."""
    return any(a > b for a, b in zip(first, second, strict=True))
