"""Weights of variables under which a polynomial field is quasi-homogeneous, and polynomials made homogeneous.

With weights w_i all terms of x'_i have the weight w_i + k.  Then the parts of one weight of an integral are integrals
themselves, and each weight is looked at alone.

One relation  r = R - c  with R homogeneous and an integral of its own (the square of a unit vector less 1) is left out
then: an f with  df/dt = 0  modulo r, of normal form  sum f_j,  falls into the classes of weights modulo that of R (d/dt
and the ideal of r keep these), in each class  sum (R/c)^m_j f_j  with equal weights equals f modulo r, and its
derivative, homogeneous and a multiple of R - c, is zero.  So nothing is lost, nor gained.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.frames import are_frames

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


def grading(field: PolynomialField, kinds: Sequence[Sequence[str]], given: Sequence[int] | None = None) -> Grading:
    """The smallest weights, equal within each of ``kinds``, under which the field is quasi-homogeneous, or those given.

    Where there are none: 1 for the first kind, the speeds, and 2 for unit vectors, as the caller orders them.
    """
    if given is not None:
        return _judged(field, tuple(given))
    if len(kinds) <= MOST_KINDS:
        choices = sorted(product(range(1, MOST_WEIGHT + 1), repeat=len(kinds)), key=lambda one: (sum(one), one))
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
    found = {
        sum(w * int(a) for w, a in zip(weights, monomial[count:], strict=True)) - own
        for p, own in zip(field.numerators, weights, strict=True)
        for monomial in p.monoms()
    }
    return None if len(found) > 1 else found.pop() if found else 0


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
    parts: dict[int, dict[tuple[int, ...], Any]] = {}
    for monomial, c in f.to_dict().items():
        weight = sum(w * int(a) for w, a in zip(weights, monomial[count:], strict=True))
        parts.setdefault(weight, {})[monomial] = c
    return {weight: field.context.from_dict(terms) for weight, terms in parts.items()}


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
    found = []
    for weights in classes.values():
        most = max(weights)
        total = field.context.constant(0)
        for weight in weights:
            total += parts[weight] * (norm[step] / scale) ** ((most - weight) // step)
        if total != 0:
            found.append((most, total))
    return sorted(found, key=lambda one: one[0])
