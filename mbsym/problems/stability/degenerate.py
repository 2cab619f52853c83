"""A potential energy whose second derivative has one null direction: terms of higher order decide.

Let K >= 0 with K v = 0 for one direction v only.  After minimising over what is across v (the splitting lemma), with
w = V'''(v, v, .) and K u = w,

    V = V_0 + t^3/6 V'''(v, v, v) + t^4/24 (V''''(v, v, v, v) - 3 w.u) + ...        along v

so V has a strict minimum if the first of these two vanishes and the second is positive.  In one coordinate the first
derivative that does not vanish decides, whatever its order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import Any

from flint import arb_mat, fmpq_poly

from mbsym.algebra.matrices import leading_determinants, null_space
from mbsym.problems.stability.bundle import Element, NumberField

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
