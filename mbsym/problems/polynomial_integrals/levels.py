"""Particular integrals: polynomials whose derivative vanishes where another integral does.

    df/dt = K V  with V an integral, f and K polynomials:  f is constant on every motion with V = 0.

Both f, of a weight w, and K, of the weight w + k - w_V, are unknown: a linear system again.  f is looked for without
multiples of the leading monomial of V, so that multiples of V do not count, and modulo V the products of integrals are
those that are known.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.problems.polynomial_integrals.modular import (
    PRIMES,
    Exponents,
    ModularField,
    Terms,
    at_random,
    echelon,
    kernel_of,
    lifted,
    monomials,
    remainder,
    times,
)
from mbsym.problems.polynomial_integrals.result import UNITY, Count, Generator, OnLevel, PolynomialIntegrals
from mbsym.problems.polynomial_integrals.search import products, sparsest


@dataclass(frozen=True)
class Level:
    """V and itself modulo the prime."""

    polynomial: Any
    weight: int
    terms: Terms

    @property
    def leading(self) -> Exponents:
        return max(self.terms)


def levels(integrals: PolynomialIntegrals) -> tuple[Generator, ...]:
    """The integrals whose vanishing is looked at: all but norms, of which no state makes the first zero.

    None where the field is not quasi-homogeneous: parts of several weights are not told apart then.  Nor where square
    roots stand in it, of which divisions by V know nothing.
    """
    if (
        integrals.field.roots
        or not integrals.grading.homogeneous
        or (integrals.field.relations and not integrals.grading.free)
    ):
        return ()
    return tuple(generator for generator in integrals.generators if not generator.by_itself and generator.name != UNITY)


def on_level(integrals: PolynomialIntegrals, level: Generator) -> OnLevel:
    """The integrals of weight up to ``integrals.degree`` on  V = 0  that are no polynomials in those of everywhere.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    field, grading = integrals.field, integrals.grading
    there = at_random(field, PRIMES[0], f"level {integrals.degree}")
    zero = Level(level.polynomial, level.weight, there.terms(level.polynomial))
    known = [
        (generator.weight, there.terms(generator.polynomial))
        for generator in integrals.generators
        if generator is not level
    ]
    fresh: list[tuple[int, Any]] = []
    counts = []
    for weight in range(1, integrals.degree + 1):
        columns = standard(grading.weights, weight, zero)
        most = kernel_on(there, columns, cofactors(integrals, weight, zero), zero)

        def reduce(terms: Terms) -> Terms:
            return remainder(terms, zero.terms, there.prime)

        spanned = products(known, weight, True, there.prime, len(field.variables), reduce)
        rows, _ = echelon([reduce(terms) for terms in spanned], columns, there.prime)
        if len(most) > len(rows):
            for terms, leading in sparsest(rows, most, columns, there.prime):
                f = _lifted(integrals, there, zero, terms, leading)
                if f is not None:
                    own = there.terms(f)
                    rows, _ = echelon([*rows, own], columns, there.prime)
                    known.append((weight, own))
                    fresh.append((weight, f))
        counts.append(Count(weight, len(columns), len(most), len(rows)))
    return OnLevel(level, tuple(fresh), tuple(counts))


def standard(weights: tuple[int, ...], weight: int, zero: Level) -> list[Exponents]:
    """Monomials of a weight that the leading one of V does not divide."""
    top = zero.leading
    return [m for m in monomials(weights, weight) if not all(a >= b for a, b in zip(m, top, strict=True))]


def cofactors(integrals: PolynomialIntegrals, weight: int, zero: Level) -> list[Exponents]:
    """The monomials of K."""
    rise = integrals.grading.rise or 0
    left = weight + rise - zero.weight
    return list(monomials(integrals.grading.weights, left)) if left >= 0 else []


def images_on(
    there: ModularField, columns: Sequence[Exponents], cofactor: Sequence[Exponents], zero: Terms
) -> list[Terms]:
    """The derivatives of the columns, then -x^b V."""
    images = [there.derivative(column) for column in columns]
    return images + [times({exponents: there.prime - 1}, zero, there.prime) for exponents in cofactor]


def kernel_on(
    there: ModularField, columns: Sequence[Exponents], cofactor: Sequence[Exponents], zero: Level
) -> list[Terms]:
    """A basis of the f on these columns with  df/dt = K V  modulo the prime."""
    vectors = kernel_of(images_on(there, columns, cofactor, zero.terms), there.prime)
    count = len(columns)
    return [{columns[k]: c for k, c in vector.items() if k < count} for vector in vectors]


def _lifted(integrals: PolynomialIntegrals, there: ModularField, zero: Level, terms: Terms, leading: Exponents) -> Any:
    weight = integrals.grading.of(leading)
    cofactor = cofactors(integrals, weight, zero)
    images = [there.derivative(m) for m in terms]
    total: Terms = {}
    for (_, c), image in zip(terms.items(), images, strict=True):
        for m, d in image.items():
            total[m] = (total.get(m, 0) + c * d) % there.prime
    multiples = [times({exponents: 1}, zero.terms, there.prime) for exponents in cofactor]
    (vector, *_) = [v for v in kernel_of([total, *multiples], there.prime) if 0 in v] or [{}]
    used = [cofactor[k - 1] for k in vector if k]
    with suppress(NoClosedForm):  # too long to be written: the count of this weight stays incomplete
        return lifted(integrals.field, list(terms), False, leading, zero.polynomial, used)
    return None
