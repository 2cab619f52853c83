"""Rows of linear equations in the ring, brought to reduced echelon form with pivots that are chosen with care.

A row is a mapping from labels of columns to polynomials, absent ones are zero; only some columns may hold pivots, and
what is done to them is done to the whole row.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs

Column = Hashable
Row = dict[Column, Polynomial]


@dataclass(frozen=True)
class Echelon:
    """``pivots``: the reduced rows by their pivots, whose coefficient is 1; ``rest``: rows without any.

    ``assumed`` are the polynomials by which was divided although they may vanish at some values of the parameters:
    what is found holds where none of them does.
    """

    pivots: Mapping[int, Row]
    rest: tuple[Row, ...]
    assumed: tuple[Polynomial, ...]


def echelon(ring: Ring, signs: Signs, rows: Sequence[Mapping[Column, Polynomial]], columns: Sequence[int]) -> Echelon:
    """Reduced echelon form with pivots in ``columns``, the first ones preferred.

    In the first column that has an entry left, an entry that is a number is taken, else one that cannot vanish, else
    a later column that has such a one; only where there is none anywhere is divided by what might vanish.  Raises
    NoClosedForm.
    """
    pending = [{key: r for key, x in row.items() if not (r := ring.reduce(x)).is_zero()} for row in rows]
    found: dict[int, Row] = {}
    assumed: list[Polynomial] = []
    while True:
        best = _best(ring, signs, pending, columns)
        if best is None:
            return Echelon(found, tuple(pending), tuple(assumed))
        rank, column, chosen = best
        row = pending.pop(chosen)
        pivot = row[column]
        if rank == _OPEN:
            assumed.append(pivot)
        inverse = ring.reciprocal(pivot)
        row = {key: ring.reduce(ring.times(x, inverse)) for key, x in row.items()} | {column: ring.one}
        pending = [_without(ring, other, column, row) for other in pending]
        found = {key: _without(ring, other, column, row) for key, other in found.items()} | {column: row}


_NUMBER, _SURE, _OPEN = range(3)


def _best(ring: Ring, signs: Signs, rows: Sequence[Row], columns: Sequence[int]) -> tuple[int, int, int] | None:
    """(how sure, column, number of the row) of the next pivot."""
    open_one = None
    for column in columns:
        entries = [(number, row[column]) for number, row in enumerate(rows) if column in row]
        for number, x in entries:
            if x.is_constant():
                return _NUMBER, column, number
        for number, x in sorted(entries, key=lambda entry: len(entry[1])):
            numerator, _ = ring.fraction(x)  # what the denominator holds has been divided by before
            if numerator.is_constant() or signs.never_zero(numerator):
                return _SURE, column, number
            open_one = open_one or (_OPEN, column, number)
    return open_one


def _without(ring: Ring, row: Row, column: Column, pivot: Row) -> Row:
    """The row less its entry in a column times the pivot's row."""
    factor = row.get(column)
    if factor is None:
        return row
    left = dict(row)
    for key, x in pivot.items():
        value = ring.reduce(left.get(key, ring.zero) - ring.times(factor, x))
        if value.is_zero():
            left.pop(key, None)
        else:
            left[key] = value
    return left
