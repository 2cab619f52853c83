"""Dependent velocities and accelerations expressed by the independent ones; any scalar.

With the independent rows of J split into the columns of the dependent coordinates d and of the others,

    J_d q'_d + J_u u + j = 0          q'_d  = S u + s,         S = -J_d^-1 J_u,   s = -J_d^-1 j
    J_d q''_d + J_u u' + gamma = 0    q''_d = S u' + c,        c = -J_d^-1 gamma

so that q' = Y u + y0 and q'' = Y u' + a0 with the unit matrix in the rows of u.  The equations of motion projected on Y
hold no multipliers (Maggi's equations; J Y = 0):

    Y^T M Y u' = Y^T (f - M a0)

The pivots are chosen once, over the ring (``choose``), and used in every algebra: first numbers and positive
parameters, then, for what is left, the determinant of the block that remains, by Cramer's rule.  So the result is
singular exactly where J_d is, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, islice
from math import comb
from typing import Any

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.failures import Constrained, NoClosedForm
from mbsym.algebra.matrices import adjugate, components, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.motion import vanishing

#: So many blocks of columns are tried for the shortest determinant; of more that are possible one is taken.
MOST_BLOCKS, MOST_COMBINATIONS = 60, 5_000

NOT_SOLVED = "the dependent coordinates cannot be solved for"

#: The length of a determinant that has no closed form within the budget.
BEYOND = 1 << 60


@dataclass(frozen=True)
class Pivots:
    """How J_d is solved: ``units`` are (row, column) whose entries cannot vanish, then the block of what is left.

    Rows and columns are those of all rows that say something and of all coordinates.
    """

    units: tuple[tuple[int, int], ...]
    block_rows: tuple[int, ...]
    block_columns: tuple[int, ...]

    @property
    def rows(self) -> tuple[int, ...]:
        return tuple(sorted((*(row for row, _ in self.units), *self.block_rows)))

    @property
    def columns(self) -> tuple[int, ...]:
        return tuple(sorted((*(column for _, column in self.units), *self.block_columns)))


@dataclass(frozen=True)
class Embedding:
    """S (r x (n - r)), s (r) and c (r) for the ``dependent`` columns, in their order; ``free`` are the other columns.

    ``determinant`` is that of the block of ``Pivots``: all is regular where it is not zero.
    """

    dependent: tuple[int, ...]
    free: tuple[int, ...]
    matrix: tuple[tuple[Scalar, ...], ...]
    shift: tuple[Scalar, ...]
    acceleration: tuple[Scalar, ...]
    determinant: Scalar


def embedded(
    algebra: Algebra, jacobian: Sequence[Sequence[Scalar]], sides: Sequence[Sequence[Scalar]], pivots: Pivots
) -> Embedding:
    """The dependent velocities; ``sides`` are (j, gamma) of every row."""
    n = len(jacobian[0])
    rows = {i: [*jacobian[i], *sides[i]] for i in pivots.rows}
    for i, column in pivots.units:
        _pivot(algebra, rows, i, column)
    determined = _cramer(algebra, rows, pivots.block_rows, pivots.block_columns)
    for i, _ in pivots.units:
        for k in pivots.block_columns:
            _clear(algebra, rows, i, k, rows[pivots.block_rows[pivots.block_columns.index(k)]])
    owner = {column: i for i, column in pivots.units}
    owner |= dict(zip(pivots.block_columns, pivots.block_rows, strict=True))
    dependent = pivots.columns
    free = tuple(k for k in range(n) if k not in owner)
    solved = [rows[owner[column]] for column in dependent]
    return Embedding(
        dependent,
        free,
        tuple(tuple(algebra.reduce(-row[k]) for k in free) for row in solved),
        tuple(algebra.reduce(-row[n]) for row in solved),
        tuple(algebra.reduce(-row[n + 1]) for row in solved),
        determined,
    )


def _pivot(algebra: Algebra, rows: dict[int, list[Scalar]], i: int, column: int) -> None:
    """Row i divided by its pivot, and taken from all others."""
    if not algebra.vanishes(rows[i][column] - algebra.one):
        inverse = algebra.reciprocal(rows[i][column])
        rows[i] = [algebra.reduce(algebra.times(inverse, x)) for x in rows[i]]
        rows[i][column] = algebra.one
    for k in rows:
        if k != i:
            _clear(algebra, rows, k, column, rows[i])


def _clear(algebra: Algebra, rows: dict[int, list[Scalar]], k: int, column: int, pivot: Sequence[Scalar]) -> None:
    factor = rows[k][column]
    if algebra.vanishes(factor):
        return
    rows[k] = [
        x if algebra.vanishes(y) else algebra.reduce(x - algebra.times(factor, y))
        for x, y in zip(rows[k], pivot, strict=True)
    ]
    rows[k][column] = algebra.zero


def _cramer(algebra: Algebra, rows: dict[int, list[Scalar]], chosen: Sequence[int], columns: Sequence[int]) -> Scalar:
    """The rows of a block made unit rows in its columns: adj(A) B / det A.  Returns det A."""
    if not chosen:
        return algebra.one
    block = [[rows[i][k] for k in columns] for i in chosen]
    whole = determinant(algebra, block)
    inverse = algebra.reciprocal(whole)
    adjoint = adjugate(block, partial(determinant, algebra))
    old = [rows[i] for i in chosen]
    for a, i in enumerate(chosen):
        new = []
        for k in range(len(old[0])):
            if k in columns:
                new.append(algebra.one if columns[a] == k else algebra.zero)
                continue
            total = algebra.dot(adjoint[a], [row[k] for row in old])
            new.append(algebra.reduce(algebra.times(inverse, total)))
        rows[i] = new
    return whole


def choose(
    ring: Ring,
    jacobian: Sequence[Sequence[Polynomial]],
    independent: Sequence[int],
    columns: Sequence[int],
    regular: Callable[[Sequence[int], Sequence[int]], bool],
    required: Collection[int] = (),
    places: Sequence[Mapping[int, Polynomial]] = (),
) -> Pivots:
    """Pivots for the independent rows, in all ``required`` columns and in others, the last ones preferred.

    Where there are some that are not zero in ``places`` (by generators), these.
    ``regular(rows, columns)`` tells whether a square block of J is regular somewhere on the manifold.  Rows that have
    no columns in common (loops apart from each other) are chosen for apart.  Raises Constrained where none is.
    """
    units: list[tuple[int, int]] = []
    rows: list[int] = []
    block: list[int] = []
    waiting = {*required}
    for own_rows, own_columns in _connected(ring, jacobian, independent):
        own = _choose(
            ring,
            jacobian,
            own_rows,
            [k for k in columns if k in own_columns],
            regular,
            [k for k in required if k in own_columns],
            places,
        )
        units += own.units
        rows += own.block_rows
        block += own.block_columns
        waiting -= own_columns
    if waiting:
        raise Constrained(NOT_SOLVED)
    return Pivots(tuple(units), tuple(sorted(rows)), tuple(sorted(block)))


def _connected(
    ring: Ring, jacobian: Sequence[Sequence[Polynomial]], rows: Sequence[int]
) -> list[tuple[list[int], set[int]]]:
    """Rows that hang together by their columns, in the order of their first ones, and these columns."""
    columns = [{k for k, x in enumerate(jacobian[i]) if not ring.vanishes(x)} for i in rows]
    blocks = components(len(rows), lambda a, b: not columns[a].isdisjoint(columns[b]))
    return [([rows[a] for a in block], set().union(*(columns[a] for a in block))) for block in blocks]


def _choose(
    ring: Ring,
    jacobian: Sequence[Sequence[Polynomial]],
    independent: Sequence[int],
    columns: Sequence[int],
    regular: Callable[[Sequence[int], Sequence[int]], bool],
    required: Collection[int],
    places: Sequence[Mapping[int, Polynomial]],
) -> Pivots:
    for also in (columns, [k for k in columns if k in required]):  # units elsewhere may stand in the way
        units, rows = _units(ring, jacobian, independent, also, required)
        left = [i for i in independent if i not in {row for row, _ in units}]
        used = [k for _, k in units]
        missing = [k for k in required if k not in used]
        free = [k for k in reversed(columns) if k not in used and k not in missing]
        count = len(left) - len(missing)
        if count < 0:
            continue
        possible: Iterable[tuple[int, ...]]
        if comb(len(free), count) > MOST_COMBINATIONS:
            possible = _one_block(regular, sorted(independent), [*used, *missing], free, missing)
        else:
            blocks = ((*missing, *x) for x in combinations(free, count))
            possible = (x for x in blocks if regular(sorted(independent), [*used, *x]))
        best: tuple[tuple[bool, int], tuple[int, ...]] | None = None
        for block in islice(possible, MOST_BLOCKS):
            size = _size(ring, [[rows[i][k] for k in block] for i in left], places)
            if size[1] and (best is None or size < best[0]):
                best = size, tuple(sorted(block))
            if size[1] == BEYOND:  # the others will hardly be shorter
                break
        if best is not None:
            return Pivots(tuple(units), tuple(left), best[1])
    raise Constrained(NOT_SOLVED)


def _one_block(
    regular: Callable[[Sequence[int], Sequence[int]], bool],
    rows: Sequence[int],
    taken: Sequence[int],
    free: Sequence[int],
    missing: Sequence[int],
) -> list[tuple[int, ...]]:
    """The block of the first columns of ``free`` that can be taken, the others being left out one by one; or none."""
    remaining = list(free)
    if not regular(rows, [*taken, *remaining]):
        return []
    for k in reversed(free):
        if len(taken) + len(remaining) == len(rows):
            break
        fewer = [other for other in remaining if other != k]
        if regular(rows, [*taken, *fewer]):
            remaining = fewer
    return [(*missing, *remaining)] if len(taken) + len(remaining) == len(rows) else []


def _size(
    ring: Ring, block: Sequence[Sequence[Polynomial]], places: Sequence[Mapping[int, Polynomial]]
) -> tuple[bool, int]:
    """Whether its determinant is zero in one of the places; its terms, BEYOND the budget, where it is a program."""
    if not block:
        return False, 1
    try:
        value = determinant(ring, block)
    except NoClosedForm:
        return False, BEYOND
    return any(vanishing(ring, value, places)), len(value)


def _units(
    ring: Ring,
    jacobian: Sequence[Sequence[Polynomial]],
    independent: Sequence[int],
    columns: Sequence[int],
    required: Collection[int],
) -> tuple[list[tuple[int, int]], dict[int, list[Polynomial]]]:
    """Pivots that cannot vanish, and the rows when they are taken; room is left for the required columns."""
    rows = {i: list(jacobian[i]) for i in independent}
    units: list[tuple[int, int]] = []
    while len(units) < len(rows):
        taken_rows, taken = {i for i, _ in units}, {k for _, k in units}
        waiting = [k for k in required if k not in taken]
        allowed = waiting if len(rows) - len(units) <= len(waiting) else columns
        candidates = [
            (k not in waiting, kind, sum(not ring.vanishes(x) for x in rows[i]), -place, i, k)
            for i in rows
            if i not in taken_rows
            for place, k in enumerate(columns)
            if k not in taken and k in allowed and (kind := _unit_class(ring, rows[i][k])) is not None
        ]
        if not candidates:
            break
        *_, i, k = min(candidates)
        units.append((i, k))
        _pivot(ring, rows, i, k)
    return units, rows


def _unit_class(ring: Ring, x: Polynomial) -> int | None:
    """0 for a number, 1 for parameters that are known to be positive, None for what may vanish (or does)."""
    if ring.vanishes(x):
        return None
    if x.is_constant():
        return 0
    return 1 if len(x) == 1 and (ring.is_positive(x) or ring.is_positive(-x)) else None


def projected(
    algebra: Algebra, embedding: Embedding, mass_matrix: Sequence[Sequence[Scalar]], forcing: Sequence[Scalar]
) -> tuple[list[list[Scalar]], list[Scalar]]:
    """(Y^T M Y, Y^T (f - M a0)) of M and f as they are given."""
    n = len(forcing)
    a0 = [algebra.zero] * n
    for k, x in zip(embedding.dependent, embedding.acceleration, strict=True):
        a0[k] = x
    rest = [algebra.reduce(forcing[i] - algebra.dot(mass_matrix[i], a0)) for i in range(n)]
    columns = [basis_vector(algebra, embedding, place) for place in range(len(embedding.free))]
    products = [[algebra.dot(row, y) for row in mass_matrix] for y in columns]
    matrix = [[algebra.dot(y, product) for product in products] for y in columns]
    return matrix, [algebra.dot(y, rest) for y in columns]


def basis_vector(algebra: Algebra, embedding: Embedding, place: int) -> list[Any]:
    """A column of Y: q' for the independent velocity of that place equal to 1, the others 0."""
    y = [algebra.zero] * (len(embedding.free) + len(embedding.dependent))
    y[embedding.free[place]] = algebra.one
    for k, row in zip(embedding.dependent, embedding.matrix, strict=True):
        y[k] = row[place]
    return y
