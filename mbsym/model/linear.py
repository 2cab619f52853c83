"""A system given by the matrices of its linear equations, as a frozen dataclass of parsed expressions:

    M x'' + (D + G) x' + (K + N) x = B u

with M, D, K symmetric and G, N skew.  In place of D and G a description may give any square C = D + G, in place of K
and N any square S = K + N; M left out is the unit matrix, what else is left out is zero.  Or equations of first order,

    x' = A x + B u

with any square A: then M = 0, C = 1, S = -A.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression
from mbsym.model.basics import _span

Rows = tuple[tuple[Expression, ...], ...]

SYMMETRIC, SKEW = "symmetric", "skew"

#: Which symmetry a matrix must have; "" where it may be any.
MATRICES: Mapping[str, str] = {
    "M": SYMMETRIC,
    "D": SYMMETRIC,
    "G": SKEW,
    "C": "",
    "K": SYMMETRIC,
    "N": SKEW,
    "S": "",
    "A": "",
    "B": "",
}

#: Matrices that make no sense beside others: their symmetric and skew parts; all others beside A.
PARTS: Mapping[str, tuple[str, ...]] = {"C": ("D", "G"), "S": ("K", "N"), "A": ("M", "D", "G", "C", "K", "N", "S")}


@dataclass(frozen=True, slots=True)
class MatrixFile:
    """The file, beside the description, that a matrix was read from; ``digest`` is its SHA-256."""

    file: str
    digest: str


@dataclass(frozen=True, slots=True)
class GivenMatrix:
    """One of MATRICES, row by row; ``spans`` are the places of its entries, in the same shape."""

    key: str
    rows: Rows
    source: MatrixFile | None = None
    span: Span | None = _span()
    spans: tuple[tuple[Span | None, ...], ...] = field(default=(), compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class LinearModel:
    """``coordinates`` x in the order of rows and columns; ``matrices`` as the description gives them."""

    coordinates: tuple[str, ...]
    matrices: tuple[GivenMatrix, ...]
    span: Span | None = _span()

    @property
    def of_first_order(self) -> bool:
        """Whether the equations are x' = A x + B u."""
        return self.matrix("A") is not None

    def matrix(self, key: str) -> GivenMatrix | None:
        """The matrix of that key, or None where it was left out."""
        return next((matrix for matrix in self.matrices if matrix.key == key), None)
