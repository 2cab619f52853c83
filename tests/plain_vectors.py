"""Vectors as three numbers, for what tests write down by hand: over any scalars with + - *, reduced by a ring."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

Triple = tuple[Any, Any, Any]


def add(u: Sequence[Any], v: Sequence[Any]) -> Triple:
    return (u[0] + v[0], u[1] + v[1], u[2] + v[2])


def cross(ring: Any, u: Sequence[Any], v: Sequence[Any]) -> Triple:
    """Sarrus: (u2 v3 - u3 v2, u3 v1 - u1 v3, u1 v2 - u2 v1)."""
    a = u[1] * v[2] - u[2] * v[1]
    b = u[2] * v[0] - u[0] * v[2]
    c = u[0] * v[1] - u[1] * v[0]
    return (ring.reduce(a), ring.reduce(b), ring.reduce(c))


def apply(ring: Any, matrix: Sequence[Sequence[Any]], v: Sequence[Any]) -> Triple:
    a, b, c = (ring.reduce(row[0] * v[0] + row[1] * v[1] + row[2] * v[2]) for row in matrix)
    return (a, b, c)


def inverse(matrix: Sequence[Sequence[Any]]) -> list[list[Fraction]]:
    """By elimination, of rational numbers."""
    n = len(matrix)
    rows = [[*map(Fraction, row), *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(matrix)]
    for k in range(n):
        pivot = next(i for i in range(k, n) if rows[i][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(n):
            if i != k:
                rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[n:] for row in rows]
