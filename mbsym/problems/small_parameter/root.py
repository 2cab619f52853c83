"""The lowest order of the equations of fast variables, solved: z = h_0(s), and the matrix L of derivatives there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.quotients import Quotient
from mbsym.problems.small_parameter.result import ScaledField

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types


@dataclass(frozen=True)
class Root:
    """g(s, z) = 0 at z = ``values``(s), the only root where ``determinant`` = det dg/dz there is not zero.

    ``inverse`` is that of the matrix dg/dz at the root.
    """

    values: tuple[Quotient, ...]
    inverse: tuple[tuple[Quotient, ...], ...]
    determinant: Quotient


def root(there: ScaledField, fast: Sequence[int], constant: bool = False) -> Root | None:
    """Of the rows ``fast`` at their lowest order; None where they do not determine these variables.

    Equations are taken that are linear in one variable with a factor that holds no fast variable, one after the other;
    what they give is put into the others.  With ``constant`` the matrix must be one of parameters alone.
    """
    first = len(there.field.parameters)
    if any(-there.scales[i] not in there.rows[i] for i in fast):
        return None
    rows = [there.rows[i][-there.scales[i]] for i in fast]
    places = [first + i for i in fast]
    slopes = [[row.derivative(place) for place in places] for row in rows]
    if constant and any(any(x.degrees()[first:]) for line in slopes for x in line if x != 0):
        return None
    solved = _solved(rows, places)
    if solved is None:
        return None
    matrix = [[put(x, solved) for x in line] for line in slopes]
    found = inverse(matrix)
    if found is None:
        return None
    inverted, determinant = found
    return Root(tuple(solved[place] for place in places), tuple(map(tuple, inverted)), determinant)


def _solved(rows: Sequence[Polynomial], places: Sequence[int]) -> dict[int, Quotient] | None:
    """Values of the generators at ``places``, each free of all of them."""
    left, unknown = [Quotient.of(row) for row in rows], list(places)
    solved: dict[int, Quotient] = {}
    while unknown:
        chosen = _linear_in_one(left, unknown)
        if chosen is None:
            return None
        at, place, value = chosen
        left.pop(at)
        unknown.remove(place)
        left = [put(x.top, {place: value}) for x in left]
        solved = {k: put(x.top, {place: value}) / put(x.bottom, {place: value}) for k, x in solved.items()}
        solved[place] = value
    return solved


def _linear_in_one(left: Sequence[Quotient], unknown: Sequence[int]) -> tuple[int, int, Quotient] | None:
    """(row, place, value) of the shortest equation p z + q = 0 with p free of the unknown ones."""
    found = []
    for at, row in enumerate(left):
        for place in unknown:
            factor = row.top.derivative(place)
            if factor != 0 and not any(factor.degrees()[k] > 0 for k in unknown):
                found.append((len(row.top), at, place, factor))
    if not found:
        return None
    _, at, place, factor = min(found, key=lambda one: one[:3])
    rest = left[at].top - factor * factor.context().gen(place)
    return at, place, Quotient.of(-rest, factor)


def put(p: Polynomial, values: Mapping[int, Quotient]) -> Quotient:
    """p with quotients in place of some generators.  Raises NoClosedForm where it becomes too long."""
    context = p.context()
    parts: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    places = tuple(values)
    for monomial, c in p.to_dict().items():
        key = tuple(int(monomial[k]) for k in places)
        rest = tuple(0 if k in values else e for k, e in enumerate(monomial))
        parts.setdefault(key, {})[rest] = c
    total = Quotient.of(context.constant(0))
    for key, terms in parts.items():
        term = Quotient.of(context.from_dict(terms))
        for place, exponent in zip(places, key, strict=True):
            for _ in range(exponent):
                term = term * values[place]
        total = total + term
    return total


def inverse(matrix: Sequence[Sequence[Quotient]]) -> tuple[list[list[Quotient]], Quotient] | None:
    """Gauss-Jordan's, exactly, and the determinant; None for a singular matrix."""
    n = len(matrix)
    context = matrix[0][0].top.context()
    one, nothing = Quotient.of(context.constant(1)), Quotient.of(context.constant(0))
    work = [[*row, *(one if i == j else nothing for j in range(n))] for i, row in enumerate(matrix)]
    determinant = one
    for column in range(n):
        pivot = next((r for r in range(column, n) if not work[r][column].is_zero), None)
        if pivot is None:
            return None
        if pivot != column:
            work[column], work[pivot] = work[pivot], work[column]
            determinant = -determinant
        lead = work[column][column]
        determinant = determinant * lead
        work[column] = [x / lead for x in work[column]]
        for r in range(n):
            factor = work[r][column]
            if r != column and not factor.is_zero:
                work[r] = [a - factor * b for a, b in zip(work[r], work[column], strict=True)]
    return [row[n:] for row in work], determinant
