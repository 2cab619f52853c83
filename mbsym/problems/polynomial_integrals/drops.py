"""Where along a line of parameters the kernel becomes larger: zeros of all maximal minors, modulo a prime.

The matrix of d/dt on monomials is polynomial in the parameters.  On a line  a + b t  its maximal minors are polynomials
in t; the greatest common divisor of two random combinations of them is that of all with near certainty, and in any case
a multiple of it: no value at which the rank drops is lost.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import nmod, nmod_mat, nmod_poly

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.expressions.message import Message
from mbsym.problems.polynomial_integrals.modular import SMALLER, ModularField, Terms, coupled

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
    parts = [(part, one) for part, one in parts if one.rank]
    if sum((one.rank * entry + 1) * len(part) * one.height for part, one in parts) > MOST_WORK:
        told = Message("the minors of [[count]] monomials along a line take too long", count=count)
        raise NoClosedForm(told, limit=Limit.DEGREE, remedy=SMALLER)
    most = max((one.rank * entry for _, one in parts), default=0)
    values: list[list[tuple[int, int]]] = [[] for _ in parts]
    shift = source.randrange(line.prime)  # at small numbers leading coefficients may vanish
    for t in range(shift + 1, shift + most + 2):
        if all(one.rank * entry + 1 <= len(done) for (_, one), done in zip(parts, values, strict=True)):
            break
        here = build(line.at(t))
        for (_, one), done in zip(parts, values, strict=True):
            if len(done) <= one.rank * entry:
                done.append(one.minors(here))
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
    found = nmod_poly([0], prime)
    for k in range(len(table) - 1, -1, -1):
        found = found * nmod_poly([-(shift + k + 1) % prime, 1], prime) + nmod_poly([int(table[k])], prime)
    return found


def rational(value: int, prime: int) -> Fraction | None:
    """a/b = value modulo the prime with |a|, b < sqrt(prime/2), if there is such a fraction (it is the only one)."""
    most = isqrt(prime // 2)
    a, b, s, t = prime, value % prime, 0, 1
    while b > most:
        quotient = a // b
        a, b, s, t = b, a - quotient * b, t, s - quotient * t
    return Fraction(b, t) if 0 < abs(t) <= most else None


def roots(p: Any) -> list[tuple[int, int]]:
    """The zeros in the prime field with their multiplicities."""
    if p.degree() < 1:
        return []
    prime = p.modulus()
    return [(int(-factor[0] / factor[1]) % prime, power) for factor, power in p.factor()[1] if factor.degree() == 1]


def others(p: Any) -> list[Any]:
    """The irreducible factors of higher degree."""
    return [] if p.degree() < 1 else [factor for factor, _ in p.factor()[1] if factor.degree() > 1]
