"""How many integrals there are beyond the products of those that hold for all parameters, modulo a prime."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mbsym.problems.polynomial_integrals.drops import Build
from mbsym.problems.polynomial_integrals.levels import Level, cofactors, images_on, kernel_on, levels, standard
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    ModularField,
    Terms,
    at_random,
    echelon,
    kernel,
    monomials,
    remainder,
)
from mbsym.problems.polynomial_integrals.result import PolynomialIntegrals
from mbsym.problems.polynomial_integrals.search import products


@dataclass(frozen=True)
class Block:
    """Integrals of one weight, everywhere or where the integral ``level`` (its number in the list) vanishes."""

    weight: int
    level: int | None = None


class Excess:
    """Of a quasi-homogeneous field with the integrals ``usual`` for almost all parameters."""

    def __init__(self, usual: PolynomialIntegrals) -> None:
        self.usual = usual
        weights = range(1, usual.degree + 1)
        chosen = [None, *(usual.generators.index(one) for one in levels(usual))]
        self.blocks = [Block(weight, level) for level in chosen for weight in weights]

    def build(self, block: Block) -> Build:
        """The columns of the matrix whose kernel the integrals of a block are."""
        weights = self.usual.grading.weights

        def images(there: ModularField) -> list[Any]:
            if block.level is None:
                return [there.derivative(m) for m in monomials(weights, block.weight)]
            zero = self._zero(there, block.level)
            if not zero.terms:
                return []
            columns = standard(weights, block.weight, zero)
            return images_on(there, columns, cofactors(self.usual, block.weight, zero), zero.terms)

        return images

    def extra(self, block: Block) -> int:
        """The degree in the parameters of what multiplies the cofactor."""
        if block.level is None:
            return 0
        count = len(self.usual.field.parameters)
        f = self.usual.generators[block.level].polynomial
        return max(sum(int(a) for a in m[:count]) for m in f.monoms())

    def dimension(self, there: ModularField, block: Block) -> int:
        """The dimension of the kernel at these parameters."""
        weights = self.usual.grading.weights
        if block.level is None:
            return len(kernel(there, list(monomials(weights, block.weight)), False))
        zero = self._zero(there, block.level)
        if not zero.terms:
            return 0
        columns = standard(weights, block.weight, zero)
        return len(kernel_on(there, columns, cofactors(self.usual, block.weight, zero), zero))

    @cached_property
    def dimensions(self) -> dict[Block, int]:
        """That for almost all parameters."""
        there = at_random(self.usual.field, PRIMES[0], "usual dimensions")
        return {block: self.dimension(there, block) for block in self.blocks}

    def at(self, there: ModularField, block: Block) -> int:
        """The dimension of the kernel less that of the products, at these parameters."""
        weights, usual = self.usual.grading.weights, self.usual.generators
        if block.level is None:
            columns = list(monomials(weights, block.weight))
            pairs = [(one.weight, there.terms(one.polynomial)) for one in usual]
            spanned = products(pairs, block.weight, True, there.prime, len(weights), lambda terms: terms)
            return self.dimension(there, block) - len(echelon(spanned, columns, there.prime)[0])
        zero = self._zero(there, block.level)
        if not zero.terms:  # at these parameters the integral is zero everywhere: it has no levels
            return 0
        columns = standard(weights, block.weight, zero)
        pairs = [(x.weight, there.terms(x.polynomial)) for k, x in enumerate(usual) if k != block.level]

        def reduce(terms: Terms) -> Terms:
            return remainder(terms, zero.terms, there.prime)

        spanned = products(pairs, block.weight, True, there.prime, len(weights), reduce)
        return self.dimension(there, block) - len(echelon(list(map(reduce, spanned)), columns, there.prime)[0])

    def signature(self, there: ModularField) -> tuple[int, ...]:
        """The excess of every block."""
        return tuple(self.at(there, block) for block in self.blocks)

    @cached_property
    def nothing(self) -> tuple[int, ...]:
        return (0,) * len(self.blocks)

    def _zero(self, there: ModularField, level: int) -> Level:
        one = self.usual.generators[level]
        return Level(one.polynomial, one.weight, there.terms(one.polynomial))


def larger(one: Sequence[int], other: Sequence[int]) -> bool:
    """Whether some entry of the first is larger."""
    return any(a > b for a, b in zip(one, other, strict=True))
