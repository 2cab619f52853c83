"""Matrices over any algebra: sums and products, symmetric and skew parts, determinants, coupled indices."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any, Generic, overload

from mbsym.algebra.base import Algebra, S

Rows = Iterable[Iterable[S]]


class ScalarMatrix(Generic[S]):
    """A rectangular array over an algebra: entries [i, j] from 0; sums, A @ B, the transpose T, c A as ``A * c``.

    Sums stay as they are; products are in the normal form of the algebra.  Shapes that do not fit raise ValueError.
    ``mbsym.formulas.formula.Matrix`` is one over a ring as reports show it.
    """

    __slots__ = ("algebra", "rows")

    def __init__(self, algebra: Algebra[S], rows: Rows[S]) -> None:
        self.algebra = algebra
        self.rows = tuple(tuple(row) for row in rows)

    @classmethod
    def by_entry(cls, algebra: Algebra[S], rows: int, columns: int, entry: Callable[[int, int], S]) -> ScalarMatrix[S]:
        """Entry [i, j] is entry(i, j)."""
        return cls(algebra, [[entry(i, j) for j in range(columns)] for i in range(rows)])

    def __repr__(self) -> str:
        return f"ScalarMatrix({self.rows!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ScalarMatrix) and self.rows == other.rows

    __hash__ = None  # type: ignore[assignment]

    def __iter__(self) -> Iterator[tuple[S, ...]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, place: int) -> tuple[S, ...]: ...

    @overload
    def __getitem__(self, place: tuple[int, int]) -> S: ...

    def __getitem__(self, place: int | tuple[int, int]) -> Any:
        return self.rows[place] if isinstance(place, int) else self.rows[place[0]][place[1]]

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.rows), len(self.rows[0]) if self.rows else 0

    @property
    def _size(self) -> str:
        return " x ".join(map(str, self.shape))

    @property
    def T(self) -> ScalarMatrix[S]:
        return ScalarMatrix(self.algebra, list(zip(*self.rows, strict=True)))

    def map(self, function: Callable[[S], S]) -> ScalarMatrix[S]:
        """function(x) of every entry."""
        return ScalarMatrix(self.algebra, [[function(x) for x in row] for row in self.rows])

    def _entrywise(self, other: ScalarMatrix[S], combined: Callable[[S, S], S]) -> ScalarMatrix[S]:
        if self.shape != other.shape:
            raise ValueError(f"matrices of {self._size} and {other._size}")
        pairs = zip(self.rows, other.rows, strict=True)
        return ScalarMatrix(self.algebra, [[combined(a, b) for a, b in zip(*pair, strict=True)] for pair in pairs])

    def __add__(self, other: ScalarMatrix[S]) -> ScalarMatrix[S]:
        return self._entrywise(other, operator.add)

    def __sub__(self, other: ScalarMatrix[S]) -> ScalarMatrix[S]:
        return self._entrywise(other, operator.sub)

    def __neg__(self) -> ScalarMatrix[S]:
        return self.map(lambda x: -x)

    def __mul__(self, factor: S) -> ScalarMatrix[S]:
        return self.map(lambda x: self.algebra.times(factor, x))

    def __matmul__(self, other: ScalarMatrix[S]) -> ScalarMatrix[S]:
        if self.shape[1] != other.shape[0]:
            raise ValueError(f"matrices of {self._size} and {other._size}")
        dot, columns = self.algebra.dot, other.T.rows
        return ScalarMatrix(self.algebra, [[dot(row, column) for column in columns] for row in self.rows])

    def cut(self, rows: Sequence[int], columns: Sequence[int]) -> ScalarMatrix[S]:
        """The entries of some rows and columns."""
        return ScalarMatrix(self.algebra, [[self.rows[i][j] for j in columns] for i in rows])


def symmetric(matrix: ScalarMatrix[S]) -> ScalarMatrix[S]:
    """(A + A^T)/2, in the normal form."""
    return _half(matrix + matrix.T)


def skew(matrix: ScalarMatrix[S]) -> ScalarMatrix[S]:
    """(A - A^T)/2, in the normal form."""
    return _half(matrix - matrix.T)


def _half(matrix: ScalarMatrix[S]) -> ScalarMatrix[S]:
    return (matrix * matrix.algebra.number(Fraction(1, 2))).map(matrix.algebra.reduce)


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


def determinant(algebra: Algebra[S], rows: Sequence[Sequence[S]]) -> S:
    """Of a square matrix, without a division: minors of the first rows, each taken once."""
    n = len(rows)
    known: dict[int, S] = {0: algebra.one}
    for row in rows:
        following: dict[int, S] = {}
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
