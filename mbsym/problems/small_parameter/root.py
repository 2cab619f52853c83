"""The lowest order of the equations of fast variables, solved: z = h_0(s), and the matrix L of derivatives there.

A root that is a square root of slow variables or parameters, rho^2 = d, is made rational by another choice of these:
where d is linear in one of them, d = a k + b, rho stands in the place of  k = (rho^2 - b)/a.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra.factors import irreducible_factors, occurring, square_apart
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.quotients import Quotient
from mbsym.algebra.terms import apart
from mbsym.problems.small_parameter.result import Adjoined, ScaledField

Polynomial = Any  # a flint.fmpq_mpoly: python-flint carries no types


@dataclass(frozen=True)
class Root:
    """g(s, z) = 0 at z = ``values``(s), where ``determinant`` = det dg/dz is not zero.

    ``inverse`` is that of the matrix dg/dz at the root.
    """

    values: tuple[Quotient, ...]
    inverse: tuple[tuple[Quotient, ...], ...]
    determinant: Quotient


@dataclass(frozen=True)
class Roots:
    """``known`` ones; ``squares``: what needs a square root for two more each; ``others``: how many are neither."""

    known: tuple[Root, ...] = ()
    squares: tuple[Polynomial, ...] = ()
    others: int = 0

    @property
    def any(self) -> bool:
        return bool(self.known or self.squares)


def roots(there: ScaledField, fast: Sequence[int], constant: bool = False) -> Roots:
    """Of the rows ``fast`` at their lowest order; none where they do not determine these variables.

    Equations are taken that are linear in one variable with a factor that holds no fast variable, one after the other;
    what they give is put into the others.  Where none is left, one that holds a single fast variable is taken apart
    into factors of degree 1 and 2.  With ``constant`` the matrix must be one of parameters alone.
    """
    first = len(there.field.parameters)
    if any(-there.scales[i] not in there.rows[i] for i in fast):
        return Roots()
    rows = [there.rows[i][-there.scales[i]] for i in fast]
    places = [first + i for i in fast]
    slopes = [[row.derivative(place) for place in places] for row in rows]
    if constant and any(any(x.degrees()[first:]) for line in slopes for x in line if x != 0):
        return Roots()
    known, squares, others = [], [], 0
    for solved in _solutions([Quotient.of(row) for row in rows], places):
        if isinstance(solved, int):
            others += solved
        elif isinstance(solved, dict):
            found = inverse([[put(x, solved) for x in line] for line in slopes])
            if found is not None:
                inverted, determinant = found
                known.append(Root(tuple(solved[k] for k in places), tuple(map(tuple, inverted)), determinant))
        else:
            squares.append(solved)
    return Roots(tuple(known), tuple(squares), others)


def _solutions(left: Sequence[Quotient], unknown: Sequence[int]) -> Iterator[dict[int, Quotient] | Polynomial | int]:
    """Values of the generators ``unknown``, each free of all of them; what needs a square root; how many others."""
    if not unknown:
        yield {}
        return
    linear = _linear_in_one(left, unknown)
    for chosen in [linear] if linear is not None else _by_factors(left, unknown):
        if not isinstance(chosen, tuple):
            yield chosen
            continue
        at, place, value = chosen
        further = [put(x.top, {place: value}) for k, x in enumerate(left) if k != at]
        for solved in _solutions(further, [k for k in unknown if k != place]):
            if not isinstance(solved, dict):
                yield solved
            elif not (below := put(value.bottom, solved)).is_zero:
                yield solved | {place: put(value.top, solved) / below}


def _by_factors(
    left: Sequence[Quotient], unknown: Sequence[int]
) -> Iterator[tuple[int, int, Quotient] | Polynomial | int]:
    """What ``_linear_in_one`` gives, by the factors of the shortest equation that holds a single unknown one."""
    held = [
        (len(row.top), at, places[0])
        for at, row in enumerate(left)
        if len(places := [k for k in unknown if row.top.degrees()[k] > 0]) == 1
    ]
    if not held:
        return
    _, at, place = min(held)
    for factor, exponent in irreducible_factors(left[at].top)[1]:
        degree = factor.degrees()[place]
        if degree < 1 or exponent > 1:  # of a multiple root L is singular
            continue
        slope = factor.derivative(place)
        z = factor.context().gen(place)
        if degree == 1:
            yield at, place, Quotient.of(slope * z - factor, slope)
        elif degree == 2:
            a = slope.derivative(place) / 2
            b = slope - 2 * a * z
            yield square_apart(b**2 - 4 * a * (factor - a * z**2 - b * z))[1]
        else:
            yield int(degree)


def adjoined(
    field: PolynomialField, square: Polynomial, held: Collection[str]
) -> tuple[PolynomialField, Adjoined] | None:
    """The field with rho in the place of a parameter or variable k, rho^2 = ``square`` = a k + b, not one of ``held``.

    With a variable in ``square`` it is one of those:  rho' = (d square/dt)/(2 rho).  None where there is no such k.
    """
    names, first = field.context.names(), len(field.parameters)
    inside = occurring([square])
    moving = [k for k in inside if k >= first]
    linear = [k for k in moving or inside if names[k] not in held and square.degrees()[k] == 1]
    if not linear:
        return None
    k = min(linear, key=lambda k: (len(square.derivative(k)), not square.derivative(k).is_constant()))
    rho, slope = field.context.gen(k), square.derivative(k)
    value = Quotient.of(rho**2 - (square - slope * rho), slope)
    rates, below = [*field.numerators], field.denominator
    if moving:
        rates[k - first] = field.derivative(square)
        rates = [x if i == k - first else x * 2 for i, x in enumerate(rates)]
    moved = [put(x, {k: value}) for x in (below * 2 if moving else below, *rates)]
    if moving:
        moved = [x if i == k - first + 1 else x * Quotient.of(rho) for i, x in enumerate(moved)]
    common = field.context.constant(1)
    for x in moved:
        common = common * (x.bottom / x.bottom.gcd(common))
    cleared = [x.top * (common / x.bottom) for x in moved]
    label = f"sqrt({square})"
    context = fmpq_mpoly_ctx.get([label if i == k else name for i, name in enumerate(names)], field.context.ordering())

    def renamed(p: Polynomial) -> Polynomial:
        return context.from_dict(p.to_dict())

    tops, bottom = in_lowest_terms(cleared[1:], cleared[0])
    polynomial_field = replace(
        field,
        context=context,
        parameters=tuple(context.names()[:first]),
        variables=tuple(context.names()[first:]),
        numerators=tuple(map(renamed, tops)),
        denominator=renamed(bottom),
        relations=tuple(renamed(put(p, {k: value}).top) for p in field.relations),
    )
    return polynomial_field, Adjoined(label, k, names[k], square, Quotient(renamed(value.top), renamed(value.bottom)))


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
    total = Quotient.of(p.context().constant(0))
    for key, part in apart(p, values).items():
        term = Quotient.of(part)
        for place, exponent in zip(values, key, strict=True):
            for _ in range(exponent):
                term = term * values[place]
        total = total + term
    return total


def inverse(matrix: Sequence[Sequence[Quotient]]) -> tuple[list[list[Quotient]], Quotient] | None:
    """Gauss-Jordan's, exactly, and the determinant; None for a singular matrix."""
    n = len(matrix)
    context = matrix[0][0].top.context()
    quotient, nothing = Quotient.of(context.constant(1)), Quotient.of(context.constant(0))
    work = [[*row, *(quotient if i == j else nothing for j in range(n))] for i, row in enumerate(matrix)]
    determinant = quotient
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
