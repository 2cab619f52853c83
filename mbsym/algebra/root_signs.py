"""Numbers of which the signs count roots, over any algebra: for generic polynomials, whose sequences do not end early.

* ``routh_column``: the first column of Routh's array of p; p has as many roots with Re > 0 as it has changes of sign.
* ``sturm_ends``: (leading coefficients, constant terms) of Sturm's sequence of Q; with the degrees they give the
  changes of sign at -infinity, 0 and +infinity, hence how many different roots are negative, and positive.

A leading entry that vanishes means a root on a border, or an unlucky sequence: then the signs say nothing here
(``mbsym.algebra.roots`` counts there).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mbsym.algebra.base import Algebra, S


def routh_column(coefficients: Sequence[S], algebra: Algebra[S], shift: int = 0) -> list[S]:
    """The first column of Routh's array of (lambda + shift) p, of p itself for 0; coefficients from low to high powers.

    A positive shift adds one root on the left.  Raises SingularPoint at a pivot 0.
    """
    plain = list(coefficients)
    if shift:
        s = algebra.number(shift)
        plain = [*(algebra.times(s, x) for x in plain), algebra.zero]
        plain = [plain[0], *(a + b for a, b in zip(plain[1:], coefficients, strict=True))]
    falling = list(reversed(plain))
    upper, lower = falling[::2], falling[1::2]
    column = [upper[0]]
    while lower:
        column.append(lower[0])
        ratio = algebra.times(upper[0], algebra.reciprocal(lower[0]))
        following = [
            upper[j] - algebra.times(ratio, lower[j]) if j < len(lower) else upper[j] for j in range(1, len(upper))
        ]
        upper, lower = lower, following
    return column


def sturm_ends(coefficients: Sequence[S], algebra: Algebra[S], shift: int = 0) -> tuple[list[S], list[S]]:
    """Leading and constant coefficients of Q, R, -rem(Q, R), ...; coefficients from low to high powers.

    R is Q', or with a shift Q' (w + shift)^2 modulo Q: that counts the same roots, by a sequence that does not end
    early where that of Q' does (Q = w^3 + c).  Raises SingularPoint at a leading coefficient 0.
    """
    first = list(coefficients)
    second = [algebra.times(algebra.number(k), first[k]) for k in range(1, len(first))]
    for _ in range(2 if shift else 0):
        s = algebra.number(shift)
        longer = [algebra.zero, *second]
        for k, x in enumerate(second):
            longer[k] = longer[k] + algebra.times(s, x)
        ratio = algebra.times(longer[-1], algebra.reciprocal(first[-1]))
        second = [x - algebra.times(ratio, y) for x, y in zip(longer[:-1], first[:-1], strict=True)]
    leading, constant = [first[-1], second[-1]], [first[0], second[0]]
    while len(second) > 1:
        inverse = algebra.reciprocal(second[-1])
        rest = list(first)
        for shifted in (1, 0):  # the degree falls by one at every step of a generic sequence
            ratio = algebra.times(rest[-1], inverse)
            rest = [
                x - algebra.times(ratio, second[k - shifted]) if 0 <= k - shifted < len(second) else x
                for k, x in enumerate(rest[:-1])
            ]
        first, second = second, [-x for x in rest]
        leading.append(second[-1])
        constant.append(second[0])
    return leading, constant


def changes(signs: Any) -> Any:
    """Changes of sign down each column of an array (n + 1, m) of -1, 0, 1; zeros are passed over.  Shape (m,)."""
    if not np.all(signs):
        signs = signs.copy()
        for k in range(1, len(signs)):
            signs[k] = np.where(signs[k] == 0, signs[k - 1], signs[k])
        for k in range(len(signs) - 2, -1, -1):
            signs[k] = np.where(signs[k] == 0, signs[k + 1], signs[k])
    return np.sum(signs[1:] * signs[:-1] < 0, axis=0)


def real_roots(leading: Any, constant: Any) -> tuple[Any, Any]:
    """(negative, positive): how many different roots of Q lie there, by the signs of Sturm's ends, shape (n + 1, m).

    Of the leading coefficients and of Q's own constant term none may be 0.
    """
    degree = leading.shape[0] - 1
    parity = np.array([-1 if (degree - k) % 2 else 1 for k in range(degree + 1)]).reshape(-1, 1)
    below, here, above = (changes(x) for x in (leading * parity, constant, leading))
    return below - here, here - above
