"""Square matrices as rows of scalars: symmetric and skew parts, determinants, parts of coupled indices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

from mbsym.algebra.base import Algebra

Rows = Sequence[Sequence[Any]]


def symmetric_part(algebra: Algebra, rows: Rows) -> list[list[Any]]:
    """(A + A^T)/2, n x n."""
    half, n = algebra.number(Fraction(1, 2)), range(len(rows))
    return [[algebra.reduce(algebra.times(half, rows[i][j] + rows[j][i])) for j in n] for i in n]


def skew_part(algebra: Algebra, rows: Rows) -> list[list[Any]]:
    """(A - A^T)/2, n x n."""
    half, n = algebra.number(Fraction(1, 2)), range(len(rows))
    return [[algebra.reduce(algebra.times(half, rows[i][j] - rows[j][i])) for j in n] for i in n]


def components(size: int, coupled: Callable[[int, int], bool]) -> list[list[int]]:
    """The connected components of 0 ... size - 1, in the order of their first indices.

    ``coupled(i, j)``, asked for i < j, says whether two indices belong together.
    """
    label = list(range(size))
    for i, j in combinations(range(size), 2):
        if label[i] != label[j] and coupled(i, j):
            old, new = max(label[i], label[j]), min(label[i], label[j])
            label = [new if x == old else x for x in label]
    return [[i for i in range(size) if label[i] == first] for first in sorted(set(label))]


def determinant(algebra: Algebra, rows: Rows) -> Any:
    """Of a square matrix, without a division: minors of the first rows, each taken once."""
    n = len(rows)
    known: dict[int, Any] = {0: algebra.one}
    for row in rows:
        following: dict[int, Any] = {}
        for columns, minor in known.items():
            for j in range(n):
                if columns >> j & 1 or algebra.vanishes(row[j]):
                    continue
                term = algebra.times(row[j], minor)
                key, beyond = columns | 1 << j, (columns >> (j + 1)).bit_count()
                previous = following.get(key, algebra.zero)
                following[key] = previous - term if beyond % 2 else previous + term
        reduced = {key: algebra.reduce(x) for key, x in following.items()}
        known = {key: x for key, x in reduced.items() if not algebra.vanishes(x)}
    return known.get((1 << n) - 1, algebra.zero)
