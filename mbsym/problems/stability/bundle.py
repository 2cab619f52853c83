"""Chetaev's method: a combination of first integrals with a definite second variation.

Let I_1, ..., I_m be integrals of the motions near a steady one, as functions of the variables z that are constant on it
(angles that turn, and others that the equations do not know, are left out).  If multipliers exist with

    sum mu_k dI_k = 0    and    v . (sum mu_k d^2 I_k) v > 0    for all v != 0 with dI_1 . v = ... = dI_m . v = 0

then V = sum mu_k (I_k - c_k) + N sum (I_k - c_k)^2, with a large enough N, is an integral with a strict minimum
(Finsler's lemma): the motion is stable with respect to z, in the nonlinear system.  With the energy alone this is
Lagrange's theorem, with cyclic momenta Routh's; with the angular momentum of a free body (a Casimir function of the
reduced system) it decides the spins about its largest and smallest axis, with the momentum about a top's own axis the
sleeping top.  Where z is only a part of the variables it is stability with respect to that part (Rumyantsev).

Nothing follows where no combination is definite.

The multipliers that annul the first variation are found exactly, in the number field of the motion; which of them make
the second one definite is looked for in floating point and then proved with enclosures.

Sources: N. G. Chetaev, Stability of Motion (1946); V. V. Rumyantsev's papers on the stability of steady motions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from enum import Enum
from itertools import pairwise
from typing import Any

from flint import arb, arb_mat, fmpq, fmpq_poly

from mbsym.algebra.matrices import leading_determinants, null_space
from mbsym.algebra.polynomial_systems import Residues
from mbsym.algebra.rationals import rounded

Element = Any  # flint.fmpq_poly, an element of QQ[t]/modulus
Rows = Sequence[Sequence[Element]]

#: Directions that are tried where more than two multipliers are free.
ATTEMPTS = 60

#: So many turns of a pencil of two forms are tried, for one that is far from singular.
_TURNS = 16


class NumberField(Residues):
    """QQ[t]/modulus with one real root of the modulus; ``enclose`` gives a ball around an element there."""

    def __init__(self, modulus: Any, enclose: Callable[[Element], Any]) -> None:
        super().__init__(modulus)
        self.enclose = enclose


def definite_combination(gradients: Rows, hessians: Sequence[Rows], field: NumberField) -> tuple[Any, ...] | None:
    """Multipliers mu (balls) of a combination as above, or None where none was found and proved.

    ``gradients`` m x N, ``hessians`` m times N x N.  Zeros where the integrals alone determine all of z.
    """
    count, size = len(gradients), len(gradients[0])
    tangent = null_space(field, gradients, size)
    if not tangent:
        return (arb(0),) * count
    annulling = null_space(field, [[gradients[k][i] for k in range(count)] for i in range(size)], count)
    if not annulling:
        return None
    restricted = [_restricted(hessian, tangent, field) for hessian in hessians]
    forms = []
    for multipliers in annulling:
        total = [[fmpq_poly([0])] * len(tangent) for _ in tangent]
        for factor, rows in zip(multipliers, restricted, strict=True):
            total = [
                [a + field.times(factor, b) for a, b in zip(*pair, strict=True)]
                for pair in zip(total, rows, strict=True)
            ]
        forms.append([[field.enclose(x % field.modulus) for x in row] for row in total])
    weights = definite_combination_of(forms)
    if weights is None:
        return None
    return tuple(
        sum((field.enclose(vector[k]) * w for vector, w in zip(annulling, weights, strict=True)), arb(0))
        for k in range(count)
    )


def _restricted(hessian: Rows, tangent: Rows, field: NumberField) -> list[list[Element]]:
    """The values v_i . H v_j for the vectors of ``tangent``."""
    images = [[field.dot(row, v) for row in hessian] for v in tangent]
    return [[field.dot(v, image) for image in images] for v in tangent]


def definite_combination_of(forms: Sequence[Sequence[Sequence[Any]]]) -> list[fmpq] | None:
    """Rational weights w such that sum w_j forms_j is proved to be positive definite."""
    import numpy as np

    tables = [np.array([[float(x.mid()) for x in row] for row in form]) for form in forms]
    if not all(np.isfinite(table).all() for table in tables):
        return None
    sizes = [float(np.abs(table).max()) or 1.0 for table in tables]
    for direction in _directions([table / size for table, size in zip(tables, sizes, strict=True)]):
        for digits in (3, 8, 14):
            weights = [rounded(x / size, digits) for x, size in zip(direction, sizes, strict=True)]
            if _is_positive(forms, weights):
                return weights
    return None


def _directions(tables: Sequence[Any]) -> list[list[float]]:
    """Directions w in which sum w_j tables_j seems to be positive definite; for at most two tables all there are."""
    import numpy as np

    if len(tables) == 1:
        return [[1.0], [-1.0]]
    if len(tables) == 2:
        return [list(w) for w in _in_plane(tables[0], tables[1])]
    source = np.random.default_rng(1)
    best = source.standard_normal(len(tables))
    for _ in range(ATTEMPTS):
        other = source.standard_normal(len(tables))
        pencil = [sum(x * t for x, t in zip(w, tables, strict=True)) for w in (best, other)]
        found = _in_plane(pencil[0], pencil[1], best_only=True)
        best = found[0][0] * best + found[0][1] * other
        best = best / np.linalg.norm(best)
        if np.linalg.eigvalsh(sum(x * t for x, t in zip(best, tables, strict=True)))[0] > 1e-9:
            return [[float(x) for x in best]]
    return []


def _in_plane(a: Any, b: Any, best_only: bool = False) -> list[tuple[float, float]]:
    """(cos x, sin x) in the middle of every interval in which a cos x + b sin x is positive definite.

    The intervals end where its determinant vanishes.  ``best_only``: wherever its least eigenvalue is greatest.
    """
    import numpy as np

    def at(x: float) -> Any:
        return a * math.cos(x) + b * math.sin(x)

    # The pencil is turned to where it is farthest from singular: singular at x + y is then -cot y an eigenvalue.
    angle = max((math.pi * k / _TURNS for k in range(_TURNS)), key=lambda x: min(abs(np.linalg.eigvalsh(at(x)))))
    borders = {0.0, math.pi / 2}
    try:
        found = np.linalg.eigvals(np.linalg.solve(at(angle), at(angle + math.pi / 2)))
    except np.linalg.LinAlgError:  # singular everywhere: no combination is definite
        found = np.array([])
    for root in found:
        if abs(root.imag) <= 1e-7 * (1 + abs(root)) ** 2:
            borders.add((angle + math.atan2(1.0, -root.real)) % math.pi)
    ordered = sorted(borders)
    ends = [*ordered, *(x + math.pi for x in ordered), ordered[0] + 2 * math.pi]
    middles = [(p + q) / 2 for p, q in pairwise(ends)]
    seen = [(float(np.linalg.eigvalsh(at(x))[0]), (math.cos(x), math.sin(x))) for x in middles]
    seen.sort(reverse=True)
    return [pair for value, pair in seen[:1] if best_only or value > 0] or ([seen[0][1]] if best_only else [])


def _is_positive(forms: Sequence[Sequence[Sequence[Any]]], weights: Sequence[fmpq]) -> bool:
    size = len(forms[0])
    total = [
        [sum((form[i][j] * w for form, w in zip(forms, weights, strict=True)), arb(0)) for j in range(size)]
        for i in range(size)
    ]
    return all(minor > 0 for minor in leading_determinants(arb_mat, total))


# A potential energy whose second derivative has one null direction: terms of higher order decide.
#
# Let K >= 0 with K v = 0 for one direction v only.  After minimising over what is across v (the splitting lemma), with
# w = V'''(v, v, .) and K u = w,
#
#     V = V_0 + t^3/6 V'''(v, v, v) + t^4/24 (V''''(v, v, v, v) - 3 w.u) + ...        along v
#
# so V has a strict minimum if the first of these two vanishes and the second is positive.  In one coordinate the first
# derivative that does not vanish decides, whatever its order.


#: Derivatives of a potential in one coordinate are looked at up to this order.
MOST_ORDER = 10


class Extremum(Enum):
    """What is proved of a stationary point of the potential energy."""

    MINIMUM = "strict minimum"
    NONE = "no minimum"
    OPEN = "open"


def in_one_coordinate(derivative: Callable[[int], Element | None], field: NumberField) -> tuple[Extremum, int]:
    """By V'' = derivative(2), V''' = derivative(3), ...: what there is, and the order that decides."""
    for order in range(2, MOST_ORDER + 1):
        value = derivative(order)
        if value is None:
            break
        if value % field.modulus == 0:
            continue
        ball = field.enclose(value)
        if order % 2 == 0 and ball > 0:
            return Extremum.MINIMUM, order
        if order % 2 or ball < 0:
            return Extremum.NONE, order
        break
    return Extremum.OPEN, 0


def of_fourth_order(
    second: Sequence[Sequence[Element]],
    third: Callable[[int, int, int], Element | None],
    fourth: Callable[[int, int, int, int], Element | None],
    field: NumberField,
) -> bool:
    """Whether V has a strict minimum of order 4 along the one null direction of ``second``, its second derivative."""
    size, span = len(second), range(len(second))
    null = null_space(field, second, size)
    if len(null) != 1:
        return False
    v = null[0]
    left_out = next(i for i in span if v[i] != 0)
    others = [i for i in span if i != left_out]
    block = [[field.enclose(second[i][j]) for j in others] for i in others]
    if not all(x > 0 for x in leading_determinants(arb_mat, block)):
        return False
    cubic = {key: third(*key) for key in _sorted_indices(size, 3)}
    quartic = {key: fourth(*key) for key in _sorted_indices(size, 4)}
    if any(x is None for x in (*cubic.values(), *quartic.values())):
        return False
    zero = fmpq_poly([0])

    def contracted(table: dict[tuple[int, ...], Any], first: tuple[int, ...], count: int) -> Element:
        """The derivative in the directions ``first``, and ``count`` times along v."""
        if not count:
            return table[tuple(sorted(first))]
        total = zero
        for i in span:
            if v[i] != 0:
                total = total + field.times(v[i], contracted(table, (*first, i), count - 1))
        return total % field.modulus

    w = [contracted(cubic, (i,), 2) for i in span]
    along = field.dot(v, w)
    if along != 0:
        return False
    # K u = w with u = 0 at the place left out: a vector (u, -1) that the rows [K | w] annul.
    table = [[*(second[i][j] for j in others), w[i]] for i in others]
    solutions = null_space(field, table, size)
    u = solutions[-1]  # the only free place is the last, as K across v is not singular
    product = sum((field.times(-x, w[i]) for x, i in zip(u, others, strict=False)), zero)
    value = contracted(quartic, (), 4) - product * 3
    return bool(field.enclose(value % field.modulus) > 0)


def _sorted_indices(size: int, count: int) -> list[tuple[int, ...]]:
    if count == 0:
        return [()]
    return [(*rest, i) for rest in _sorted_indices(size, count - 1) for i in range(rest[-1] if rest else 0, size)]
