"""Vectors as three numbers, for what tests write down by hand: over any scalars with + - *, reduced by a ring."""

from __future__ import annotations

from collections.abc import Sequence
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
