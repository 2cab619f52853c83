"""Linear algebra over any scalars: products, determinants, adjugates, characteristic polynomials, kernels.

What an algebra says of its scalars (products in normal form, what vanishes, reciprocals) is asked of it; ``Operators``
is the algebra of scalars whose own + - * are all that is wanted.  Rational matrices are ``fmpq_mat``, those modulo a
prime ``nmod_mat``, balls ``arb_mat``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import combinations
from typing import Any, Generic, TypeVar, overload

from flint import fmpq

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.failures import Failure, Limit, NoClosedForm, TooLargeError

T = TypeVar("T")
Rows = Iterable[Iterable[S]]
Table = Sequence[Sequence[S]]


class Operators(Algebra[S]):
    """Scalars whose own + - * are all that is wanted: polynomials, elements of a tower, truncated series."""

    def __init__(self, zero: S, one: S) -> None:
        self.zero, self.one = zero, one


def dot(u: Iterable[S], v: Iterable[S]) -> S:
    """u_1 v_1 + u_2 v_2 + ..., of one component at least, by the scalars' own operators; see also ``Algebra.dot``."""
    products: list[S] = [operator.mul(a, b) for a, b in zip(u, v, strict=True)]
    return reduce(operator.add, products)


def added(a: Table[S], b: Table[S]) -> tuple[tuple[S, ...], ...]:
    """A + B, by the scalars' own operator."""
    return tuple(tuple(x + y for x, y in zip(*rows, strict=True)) for rows in zip(a, b, strict=True))


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


def united(groups: Iterable[Collection[T]]) -> list[set[T]]:
    """The unions of groups that share a member, directly or through others, by their members met first."""
    union_of: dict[T, set[T]] = {}
    for group in groups:
        touched = {id(union): union for x in group if (union := union_of.get(x)) is not None}
        largest = max(touched.values(), key=len, default=set[T]())
        for part in (group, *touched.values()):
            if part is not largest:  # the largest is not copied: n members cost n log n
                largest.update(part)
                union_of.update(dict.fromkeys(part, largest))
    return list({id(union): union for union in union_of.values()}.values())


# --- determinants ---


def leading_minors(algebra: Algebra[S], rows: Table[S]) -> list[S]:
    """Of the upper left 1 x 1, 2 x 2, ..., n x n blocks, without a division: minors of the first rows, each taken once.

    Zeros cost nothing; of a full matrix up to 2^n sets of columns are looked at.
    """
    known: dict[int, S] = {0: algebra.one}  # minors of the rows so far, by their columns as a bit mask
    minors = []
    for size, row in enumerate(rows, start=1):
        entries = [(j, x) for j, x in enumerate(row) if not algebra.vanishes(x)]
        following: dict[int, S] = {}
        for columns, minor in known.items():
            for j, x in entries:
                if columns >> j & 1:
                    continue
                term = algebra.times(x, minor)
                key, beyond = (
                    columns | 1 << j,
                    (columns >> j).bit_count(),
                )  # the sign: how many columns are to the right
                previous = following.get(key, algebra.zero)
                following[key] = previous - term if beyond % 2 else previous + term
        known = {key: minor for key, x in following.items() if not algebra.vanishes(minor := algebra.reduce(x))}
        minors.append(known.get((1 << size) - 1, algebra.zero))
    return minors


def determinant(algebra: Algebra[S], rows: Table[S]) -> S:
    """Of a square matrix, without a division; 1 without rows."""
    return leading_minors(algebra, rows)[-1] if rows else algebra.one


def without(rows: Table[S], i: int, j: int) -> list[list[S]]:
    """The matrix without row i and column j."""
    return [[*row[:j], *row[j + 1 :]] for k, row in enumerate(rows) if k != i]


def adjugate(rows: Table[S], determinant: Callable[[list[list[S]]], S]) -> list[list[S]]:
    """adj A, with A adj A = det A, entry by entry by the ``determinant`` of what is left without a row and a column."""

    def entry(i: int, j: int) -> S:
        minor = determinant(without(rows, j, i))
        return -minor if (i + j) % 2 else minor

    size = range(len(rows))
    return [[entry(i, j) for j in size] for i in size]


def cramer(algebra: Algebra[S], rows: Table[S], right: Sequence[S]) -> list[S]:
    """x_k det A with A x = b: the determinants of A with b in place of column k."""
    size = range(len(right))
    return [
        determinant(algebra, [[*row[:k], b, *row[k + 1 :]] for row, b in zip(rows, right, strict=True)]) for k in size
    ]


def solved(algebra: Algebra[S], rows: Table[S], right: Table[S]) -> list[list[S]]:
    """A^-1 B by Cramer's rule: the denominator is the determinant, and nothing that it does not need.

    Raises what ``reciprocal`` of the algebra raises where that is zero.
    """
    inverse = algebra.reciprocal(determinant(algebra, rows))
    columns = [cramer(algebra, rows, column) for column in zip(*right, strict=True)]
    return [[algebra.reduce(algebra.times(x, inverse)) for x in row] for row in zip(*columns, strict=True)]


# --- characteristic polynomials ---


def faddeev(rows: Table[Any], zero: Any, one: Any) -> tuple[list[list[list[Any]]], list[Any]]:
    """(B_0 ... B_(m-1)) and (c_0 ... c_m):  adj(s - A) = sum B_k s^(m-1-k),  det(s - A) = sum c_k s^k.

    m >= 1; scalars can be divided by whole numbers.  Source: Faddeev & LeVerrier (Gantmacher, The Theory of Matrices,
    chapter IV, section 5).
    """
    m = len(rows)
    now = [[one if i == j else zero for j in range(m)] for i in range(m)]
    adjugates, coefficients = [now], [one]
    for k in range(1, m + 1):
        columns = list(zip(*now, strict=True))
        product = [[dot(row, column) for column in columns] for row in rows]
        c = -reduce(operator.add, [product[i][i] for i in range(m)]) / k
        coefficients.append(c)
        now = [[x + c if i == j else x for j, x in enumerate(row)] for i, row in enumerate(product)]
        if k < m:
            adjugates.append(now)
    return adjugates, coefficients[::-1]


def determinant_by_traces(rows: Table[Any], zero: Any, one: Any) -> Any:
    """det A = (-1)^m c_0 of ``faddeev``: of scalars for which m^4 products are cheaper than 2^m minors."""
    constant = faddeev(rows, zero, one)[1][0]
    return -constant if len(rows) % 2 else constant


def inverted(rows: Table[Any], inverse: Callable[[Any], Any], zero: Any, one: Any) -> list[list[Any]]:
    """A^-1 = -B_(m-1) / c_0 of ``faddeev``: one division, by the determinant.

    Raises what ``inverse`` raises where the determinant is zero.
    """
    adjugates, coefficients = faddeev(rows, zero, one)
    factor = -inverse(coefficients[0])
    return [[value * factor for value in row] for row in adjugates[-1]]


def adjugate_at(rows: Table[Any], root: Any, zero: Any, one: Any) -> list[list[Any]]:
    """adj(s - A) at s = ``root``: Horner's rule for sum B_k s^(m-1-k)."""
    adjugates, _ = faddeev(rows, zero, one)
    whole = adjugates[0]
    for further in adjugates[1:]:
        whole = _horner(whole, root, further)
    return whole


def adjugate_slope_at(rows: Table[Any], root: Any, zero: Any, one: Any) -> list[list[Any]]:
    """d/ds adj(s - A) at s = ``root``: Horner's rule for the derivative."""
    adjugates, _ = faddeev(rows, zero, one)
    whole, slope = adjugates[0], [[zero] * len(rows) for _ in rows]
    for further in adjugates[1:]:
        slope, whole = _horner(slope, root, whole), _horner(whole, root, further)
    return slope


def _horner(rows: Table[Any], s: Any, further: Table[Any]) -> list[list[Any]]:
    return [[x * s + y for x, y in zip(*pair, strict=True)] for pair in zip(rows, further, strict=True)]


def hurwitz(polynomial: Sequence[S], zero: S, size: int) -> list[list[S]]:
    """Hurwitz's matrix of c_0 s^n + c_1 s^(n-1) + ... + c_n, its first rows and columns: H_ij = c_(2j - i)."""
    places = range(1, size + 1)
    return [[polynomial[k] if 0 <= (k := 2 * j - i) < len(polynomial) else zero for j in places] for i in places]


def leading_determinants(kind: Callable[[list[list[Any]]], Any], rows: Table[Any]) -> Iterator[Any]:
    """``leading_minors`` of numbers or balls, by the library's matrices (``kind``: fmpq_mat, arb_mat)."""
    return (kind([list(row[:size]) for row in rows[:size]]).det() for size in range(1, len(rows) + 1))


# --- kernels ---


def _weight(x: Any) -> int | None:
    return None if x == 0 else 0


def echelon(
    algebra: Algebra[S], rows: Table[S], columns: int, weight: Callable[[S], int | None] = _weight
) -> tuple[list[list[S]], list[int]]:
    """Gauss and Jordan over a field: the rows reduced in the first ``columns``, and the columns of the pivots in order.

    A pivot is the first entry of the least ``weight``, None of a zero; what vanishes as it stands is left out of
    products.
    """
    work = [[algebra.reduce(x) for x in row] for row in rows]
    pivots: list[int] = []
    for column in range(columns):
        at = len(pivots)
        held = ((w, r) for r in range(at, len(work)) if (w := weight(work[r][column])) is not None)
        least = next(held, None) if weight is _weight else min(held, default=None)
        if least is None:
            continue
        work[at], work[least[1]] = work[least[1]], work[at]
        inverse = algebra.reciprocal(work[at][column])
        top = work[at] = [x if algebra.vanishes(x) else algebra.times(x, inverse) for x in work[at]]
        for r, row in enumerate(work):
            factor = row[column]
            if r != at and weight(factor) is not None:
                work[r] = [
                    x if algebra.vanishes(y) else x - algebra.times(factor, y) for x, y in zip(row, top, strict=True)
                ]
        pivots.append(column)
    return work, pivots


def reduced_rows(matrix: Any) -> dict[int, list[Any]]:
    """Of a flint matrix, or one like it: the rows of the reduced echelon form by the columns of their pivots."""
    rows, rank = matrix.rref()
    return {next(k for k, x in enumerate(row) if x != 0): row for row in rows.tolist()[:rank]}


def null_space_of_rationals(rows: Iterable[Mapping[int, fmpq]], size: int) -> list[list[fmpq]]:
    """A basis of what rows {column: entry} annul that come one by one; none is asked for once nothing is left."""
    reduced: dict[int, dict[int, fmpq]] = {}
    for given in rows:
        row = dict(given)
        for column in [column for column in given if column in reduced]:
            _subtract(row, row[column], reduced[column])
        if not row:
            continue
        pivot = min(row)
        row = {column: x / row[pivot] for column, x in row.items()}
        for other in reduced.values():
            if pivot in other:
                _subtract(other, other[pivot], row)
        reduced[pivot] = row
        if len(reduced) == size:
            return []
    zero, one = fmpq(0), fmpq(1)
    whole = {pivot: [row.get(column, zero) for column in range(size)] for pivot, row in reduced.items()}
    return null_vectors(Operators(zero, one), whole, size)


def _subtract(row: dict[int, fmpq], factor: fmpq, other: Mapping[int, fmpq]) -> None:
    """row -= factor * other, in place; no zeros are kept."""
    for column, x in other.items():
        left = row.get(column, 0) - factor * x
        if left:
            row[column] = left
        else:
            del row[column]


def null_space(algebra: Algebra[S], rows: Table[S], size: int) -> list[list[S]]:
    """A basis of the vectors of ``size`` components that every row annuls, over a field."""
    reduced, pivots = echelon(algebra, rows, size)
    return null_vectors(algebra, dict(zip(pivots, reduced, strict=False)), size)


def null_vectors(algebra: Algebra[S], reduced: Mapping[int, Sequence[S]], size: int) -> list[list[S]]:
    """The kernel of reduced rows, each by the column of its pivot: one vector for each other column, with 1 there."""
    basis = []
    for free in (k for k in range(size) if k not in reduced):
        vector = [algebra.zero] * size
        vector[free] = algebra.one
        for column, row in reduced.items():
            vector[column] = -row[free]
        basis.append(vector)
    return basis


def null_space_of_polynomials(
    algebra: Algebra[Any], rows: Table[Any], size: int, certain: Callable[[Any], bool] = bool, most: int | None = None
) -> list[list[Any]]:
    """A basis of the vectors of ``size`` components that every row annuls, without fractions: times their pivots.

    A pivot is the first entry, column by column, that is ``certain`` not to vanish.  Raises Failure where there is
    none, TooLargeError where an entry on the way has more than ``most`` terms.
    """
    work, pivots = [[algebra.reduce(x) for x in row] for row in rows], list[int]()
    while held := [
        (r, c) for c in range(size) for r in range(len(pivots), len(work)) if not algebra.vanishes(work[r][c])
    ]:
        at, place = len(pivots), next(((r, c) for r, c in held if certain(work[r][c])), None)
        if place is None:
            raise Failure("no pivot is known to differ from zero")
        (r, column), top = place, work[place[0]]
        work[at], work[r] = top, work[at]
        for r, row in enumerate(work):
            if r != at and not algebra.vanishes(row[column]):
                if most is not None and max(map(len, (*row, *top))) > most:
                    raise TooLargeError
                products = (
                    (algebra.times(top[column], x), algebra.times(row[column], y))
                    for x, y in zip(row, top, strict=True)
                )
                work[r] = [algebra.reduce(a - b) for a, b in products]
        pivots.append(column)
    basis = []
    for free in (k for k in range(size) if k not in pivots):
        involved = {c: row for c, row in zip(pivots, work, strict=False) if not algebra.vanishes(row[free])}
        vector = [algebra.zero] * size
        for k in (free, *involved):
            factors = (row[c] for c, row in involved.items() if c != k)
            product = reduce(lambda a, b: algebra.reduce(algebra.times(a, b)), factors, algebra.one)
            vector[k] = product if k == free else algebra.reduce(-algebra.times(product, involved[k][free]))
        basis.append(vector)
    return basis


class PrimitiveRows(Generic[S]):
    """Sparse rows of polynomials in reduced echelon form, without fractions: entries have no common factor.

    ``pivots`` holds each row by the column of its pivot.  Raises NoClosedForm (``too_long``, ``remedy``) where an entry
    has more than ``most`` terms.
    """

    def __init__(self, algebra: Algebra[S], most: int, too_long: str, remedy: str = "") -> None:
        self.algebra, self._most, self._too_long, self._remedy = algebra, most, too_long, remedy
        self.pivots: dict[int, dict[int, Any]] = {}

    def reduced(self, row: dict[int, Any]) -> dict[int, Any]:
        """What is left of a row in columns without a pivot."""
        for k in [k for k in row if k in self.pivots]:
            if k in row:
                row = self._without(row, self.pivots[k], k)
        return row

    def add(self, row: dict[int, Any], k: int) -> None:
        """A reduced row, with its pivot in column k."""
        for place, other in list(self.pivots.items()):
            if k in other:
                self.pivots[place] = self._without(other, row, k)
        self.pivots[k] = row

    def _without(self, row: dict[int, Any], pivot: dict[int, Any], k: int) -> dict[int, Any]:
        common = pivot[k].gcd(row[k])
        a, b, zero = pivot[k] / common, row[k] / common, self.algebra.zero
        remaining: dict[int, Any] = {}
        for j in {*row, *pivot}:
            if j == k:
                continue
            value: Any = (row[j] * a if j in row else zero) - (pivot[j] * b if j in pivot else zero)
            value = self.algebra.reduce(value)
            if value != 0:
                if len(value) > self._most:
                    raise NoClosedForm(self._too_long, limit=Limit.TERMS, remedy=self._remedy)
                remaining[j] = value
        if not remaining:
            return remaining
        shared = reduce(lambda x, y: x.gcd(y), remaining.values())
        shared = shared * next(iter(remaining.values())).leading_coefficient()
        return {j: value / shared for j, value in remaining.items()}
