"""Weights of variables under which a polynomial field is quasi-homogeneous, and polynomials made homogeneous.

With weights w_i all terms of x'_i have the weight w_i + k.  Then the parts of one weight of an integral are integrals
themselves, and each weight is looked at alone.

One relation  r = R - c  with R homogeneous and an integral of its own (the square of a unit vector less 1) is left out
then: an f with  df/dt = 0  modulo r, of normal form  sum f_j,  falls into the classes of weights modulo that of R (d/dt
and the ideal of r keep these), in each class  sum (R/c)^m_j f_j  with equal weights equals f modulo r, and its
derivative, homogeneous and a multiple of R - c, is zero.  So nothing is lost, nor gained.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import grouped
from mbsym.problems.polynomial_integrals.modular import Exponents, ModularField, Terms, matrix_of, monomials, times

# Two unit vectors of one body, b and c, perpendicular to each other: relations that share their leading variables.
#
# Where the field is quasi-homogeneous, b and c of one weight, and keeps |b|^2, |c|^2, (b, c) of vectors of any length,
# an integral for these is one of unit vectors. The converse is looked at by itself. With f and its classes made
# homogeneous by |b|^2 (``gradings``) an integral of unit vectors is an F whose derivative lies in the ideal J = (|c|^2
# - |b|^2, (b, c)): J is homogeneous and prime to |b|^2, so that it holds every homogeneous element of the unit vectors'
# ideal. In each weight the F are counted modulo J by ranks modulo a prime, and compared with the products of what is
# known: where there are no more, that there are none is proved of unit vectors, too. (A rank modulo a prime is at most
# that over the rationals, and that of J is the same: two polynomials without a common factor, modulo every odd prime.)


#: Columns of a matrix; where there are more, the number of monomials is the bound.
MOST_COLUMNS = 1600


def are_frames(field: PolynomialField, weights: Sequence[int]) -> bool:
    """Whether the relations are those of two such vectors of one weight, and constant by themselves."""
    if len(field.relations) != 3 or any(field.derivative(r) != 0 for r in field.relations):
        return False
    vectors = _vectors(field)
    return vectors is not None and len({weights[k] for vector in vectors for k in vector}) == 1


def _vectors(field: PolynomialField) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """The places of b's and c's components among the variables, in one order; None where the relations are others."""
    count = len(field.parameters)
    norms, pairs = [], []
    for relation in field.relations:
        terms = {tuple(map(int, m[count:])): c for m, c in relation.to_dict().items()}
        if any(any(m[:count]) for m in relation.monoms()):
            return None
        constant = terms.pop((0,) * len(field.variables), 0)
        shapes = [tuple(k for k, power in enumerate(m) for _ in range(power)) for m in terms]
        if len(shapes) != 3 or any(len(shape) != 2 for shape in shapes) or len(set(terms.values())) != 1:
            return None
        if all(a == b for a, b in shapes) and constant == -next(iter(terms.values())):
            norms.append({a for a, _ in shapes})
        elif constant == 0:
            pairs.append(shapes)
    if len(norms) != 2 or len(pairs) != 1:
        return None
    first = tuple(a if a in norms[0] else b for a, b in pairs[0])
    second = tuple(b if a in norms[0] else a for a, b in pairs[0])
    return (first, second) if set(first) == norms[0] and set(second) == norms[1] else None


def generators(field: PolynomialField, there: ModularField) -> list[Terms]:
    """|c|^2 - |b|^2 and (b, c) modulo the prime."""
    first, second = _vectors(field) or ((), ())

    def square(a: int, b: int) -> Exponents:
        return tuple((k == a) + (k == b) for k in range(len(field.variables)))

    difference = {square(k, k): 1 for k in second} | {square(k, k): there.prime - 1 for k in first}
    return [difference, {square(a, b): 1 for a, b in zip(first, second, strict=True)}]


def beyond(there: ModularField, weights: tuple[int, ...], rise: int, weight: int, products: Sequence[Terms]) -> int:
    """How many integrals of unit vectors there are at most that are no combinations of ``products``, of one weight."""
    columns = monomials(weights, weight)
    parts = generators(there.field, there)
    own = 2 * next(w for w, power in zip(weights, max(parts[1]), strict=True) if power)

    def ideal(total: int) -> list[Terms]:
        left = monomials(weights, total - own) if total >= own else ()
        return [times({m: 1}, part, there.prime) for part in parts for m in left]

    here, above = ideal(weight), ideal(weight + rise)
    if len(columns) + len(above) > MOST_COLUMNS:
        return len(columns)
    images = [there.derivative(m) for m in columns]

    def rank(terms: Sequence[Terms]) -> int:
        return int(matrix_of(terms, there.prime).rank()) if terms else 0

    dimension = len(columns) - (rank([*images, *above]) - rank(above))  # F with D F in J
    return max(0, dimension - rank([*products, *here]))


def state(there: ModularField) -> list[int] | None:
    """A random state with |b| = |c| and (b, c) = 0: columns of a quaternion's matrix; None of other relations."""
    vectors = _vectors(there.field)
    if vectors is None:
        return None
    prime, source = there.prime, random.Random(f"frames {there.prime}")
    numbers: list[Any] = [source.randrange(1, prime) for _ in there.field.variables]
    s, x, y, z = (source.randrange(1, prime) for _ in range(4))
    first = (s * s + x * x - y * y - z * z, 2 * (x * y + s * z), 2 * (x * z - s * y))
    second = (2 * (x * y - s * z), s * s - x * x + y * y - z * z, 2 * (y * z + s * x))
    for places, values in zip(vectors, (first, second), strict=True):
        for k, value in zip(places, values, strict=True):
            numbers[k] = value % prime
    return numbers


#: Weights that are tried for each kind of variables, and how many kinds are told apart.
MOST_WEIGHT, MOST_KINDS = 3, 6


@dataclass(frozen=True)
class Grading:
    """``weights`` of the variables; ``rise``: by how much d/dt raises them, None where the field has terms of several.

    ``free``: relations are left out, because their homogeneous parts are integrals; ``frames``: so are those of two
    perpendicular unit vectors, and what holds for unit vectors alone is counted besides (``frames``).
    """

    weights: tuple[int, ...]
    rise: int | None
    free: bool
    frames: bool = False

    @property
    def homogeneous(self) -> bool:
        return self.rise is not None

    def of(self, exponents: Sequence[int]) -> int:
        return sum(w * a for w, a in zip(self.weights, exponents, strict=True))


def grading(field: PolynomialField, kinds: Sequence[Sequence[str]], fixed: Sequence[int] | None = None) -> Grading:
    """The smallest weights, equal within each of ``kinds``, under which the field is quasi-homogeneous, or those given.

    Where there are none: 1 for the first kind, the speeds, and 2 for unit vectors, as the caller orders them.
    """
    if fixed is not None:
        return _judged(field, tuple(fixed))
    if len(kinds) <= MOST_KINDS:
        choices = sorted(
            product(range(1, MOST_WEIGHT + 1), repeat=len(kinds)), key=lambda choice: (sum(choice), choice)
        )
        for choice in choices:
            weights = _spread(field, kinds, choice)
            if rise(field, weights) is not None:
                return _judged(field, weights)
    return _judged(field, _spread(field, kinds, [1] + [2] * (len(kinds) - 1)))


def _spread(field: PolynomialField, kinds: Sequence[Sequence[str]], choice: Sequence[int]) -> tuple[int, ...]:
    weights = {name: weight for kind, weight in zip(kinds, choice, strict=True) for name in kind}
    return tuple(weights[name] for name in field.variables)


def _judged(field: PolynomialField, weights: tuple[int, ...]) -> Grading:
    by = rise(field, weights)
    free = by is not None and _may_be_left_out(field, weights)
    return Grading(weights, by, free, by is not None and not free and are_frames(field, weights))


def rise(field: PolynomialField, weights: Sequence[int]) -> int | None:
    """k, where every term of x'_i has the weight w_i + k; None where they differ; 0 where all x'_i vanish."""
    count = len(field.parameters)
    rises = {
        sum(w * int(a) for w, a in zip(weights, monomial[count:], strict=True)) - own
        for p, own in zip(field.numerators, weights, strict=True)
        for monomial in p.monoms()
    }
    return None if len(rises) > 1 else rises.pop() if rises else 0


def _may_be_left_out(field: PolynomialField, weights: Sequence[int]) -> bool:
    if not field.relations:
        return True
    if len(field.relations) > 1:
        return False
    relation = field.relations[0]
    parts = by_weight(field, relation, weights)
    return len(parts) == 2 and 0 in parts and parts[0].is_constant() and field.derivative(relation) == 0


def by_weight(field: PolynomialField, f: Any, weights: Sequence[int]) -> dict[int, Any]:
    """The parts of a polynomial, by their weights."""
    count = len(field.parameters)
    return grouped(f, lambda monomial: sum(w * int(a) for w, a in zip(weights, monomial[count:], strict=True)))


def homogeneous_parts(field: PolynomialField, f: Any, grading: Grading) -> list[tuple[int, Any]]:
    """f modulo the relation as a sum of homogeneous polynomials, one for each class of weights: (weight, part)."""
    parts = by_weight(field, f, grading.weights)
    if not field.relations:
        return sorted(parts.items())
    norm = by_weight(field, field.relations[0], grading.weights)
    step = max(norm)
    scale = -norm[0].leading_coefficient()
    classes: dict[int, list[int]] = {}
    for weight in parts:
        classes.setdefault(weight % step, []).append(weight)
    sums = []
    for weights in classes.values():
        most = max(weights)
        total = field.context.constant(0)
        for weight in weights:
            total += parts[weight] * (norm[step] / scale) ** ((most - weight) // step)
        if total != 0:
            sums.append((most, total))
    return sorted(sums, key=lambda pair: pair[0])
