"""Tables in numbers: the piece by a search among the knots, then its polynomial by Horner's scheme.

    f(x) = c_0 + u (c_1 + u (...)),   u = x - base,   of the last piece that begins at or before x

Knots and coefficients are the exact ones, each rounded once.  At a knot it is the piece behind it.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from mbsym.expressions.table import Curve


def looked_up(curve: Curve, x: Any) -> Any:
    """f at an array of numbers, in their arithmetic; NaN at what is no number."""
    at = np.asarray(x)
    kind: Any = at.dtype.type if at.dtype.kind == "f" else np.float64
    knots, bases, coefficients = numbers_of(curve, kind)
    piece = np.searchsorted(knots, at, side="right")
    u = at - bases[piece]
    total = coefficients[-1][piece]
    for column in coefficients[-2::-1]:
        total = total * u + column[piece]
    return np.where(np.isnan(at), at, total)[()]


@lru_cache(64)
def numbers_of(curve: Curve, kind: Any) -> tuple[Any, Any, Any]:
    """Knots (n,), bases (n + 1,), and coefficients (degree + 1, n + 1) by rising powers."""

    def row(values: Iterable[Fraction]) -> Any:
        return np.array([_rounded(value, kind) for value in values], dtype=kind)

    columns = zip(*curve.polynomials, strict=True)
    return row(curve.knots), row(curve.bases), np.array([row(column) for column in columns])


def _rounded(value: Fraction, kind: Any) -> Any:
    head = float(value)
    return kind(head) if kind is not np.longdouble else kind(head) + kind(float(value - Fraction(head)))
