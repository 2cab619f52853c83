"""A polynomial field as x' = sum_k eps^k rows[k](x) over a tower, with x eps^power for variables that are small."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower, angle_in
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.message import Message
from mbsym.problems.small_parameter.generating import Terms

_Graded = dict[int, dict[tuple[int, ...], Element]]


def graded_rows(
    tower: Tower,
    field: PolynomialField,
    small: str,
    powers: Mapping[str, int],
    most: int,
    numbers: Mapping[str, Any] | None = None,
) -> list[Mapping[int, Terms]]:
    """Up to eps^most.  The parameters of ``field`` but ``small`` are among those of the tower, or have ``numbers``.

    Raises NoClosedForm where a right side grows without bound as eps tends to 0, or the denominator of lowest order
    depends on the state.
    """
    put = numbers or {}
    below = _graded(tower, field, field.denominator, small, powers, put)
    least = min(below)
    below = {k - least: part for k, part in below.items() if k - least <= most}
    zero = (0,) * len(field.variables)
    if set(below[0]) != {zero}:
        raise NoClosedForm(
            Message(
                "the equations are not quasi-linear: without [[small]] the mass matrix depends on the state",
                small=small,
            ),
            remedy=Message(
                "declare that the deviations are small: 'small parameter: {[[small]]: {powers: {x: 1}}}'", small=small
            ),
        )
    back = tower.reciprocal(below.pop(0)[zero])
    rows: list[Mapping[int, Terms]] = []
    for name, numerator in zip(field.variables, field.numerators, strict=True):
        above = _graded(tower, field, numerator, small, powers, put)
        shift = least + powers.get(name, 0)
        above = {k - shift: part for k, part in above.items()}
        if any(k < 0 for k in above):
            raise NoClosedForm(
                Message(
                    "[[name]]' grows without bound as [[small]] tends to 0: nothing oscillates at a rate of order 1",
                    name=name,
                    small=small,
                ),
                remedy="see 'mbsym expand' for slow manifolds, and the powers that are declared",
            )
        found: _Graded = {}
        for k in range(most + 1):
            part = dict(above.get(k, {}))
            for j, factor in below.items():
                if j <= k:
                    _subtract(part, factor, found[k - j])
            found[k] = {m: c * back for m, c in part.items() if not c.is_zero()}
        rows.append({k: part for k, part in found.items() if part})
    return rows


def _subtract(total: dict[tuple[int, ...], Element], a: Terms, b: Terms) -> None:
    for m, x in a.items():
        for n, y in b.items():
            key = tuple(map(int.__add__, m, n))
            total[key] = total[key] - x * y if key in total else -(x * y)


def _graded(
    tower: Tower, field: PolynomialField, p: Any, small: str, powers: Mapping[str, int], numbers: Mapping[str, Any]
) -> _Graded:
    names = field.context.names()
    first = len(field.parameters)
    roots = adjoined(tower, field)
    at = {n: k for k, n in enumerate(field.parameters)}
    aside = {small, *numbers, *roots}
    places = [None if n in aside else MOST_ROOTS + tower.parameters.index(n) for n in field.parameters]
    weights = [1 if n == small else powers.get(n, 0) for n in names]
    parts: dict[int, dict[tuple[int, ...], dict[tuple[int, ...], dict[tuple[int, ...], Any]]]] = {}
    width = len(tower.context.names())
    for monomial, c in p.to_dict().items():
        order = sum(w * int(e) for w, e in zip(weights, monomial, strict=True) if e)
        exponents = [0] * width
        for name, place, e in zip(names, places, monomial, strict=False):
            if place is not None:
                exponents[place] = int(e)
            elif name in numbers and e:
                c = c * numbers[name] ** int(e)
        state = tuple(int(e) for e in monomial[first:])
        held = tuple(int(monomial[at[name]]) for name in roots)
        terms = parts.setdefault(order, {}).setdefault(state, {}).setdefault(held, {})
        terms[tuple(exponents)] = terms.get(tuple(exponents), 0) + c
    one = tower.context.constant(1)

    def coefficient(shares: Mapping[tuple[int, ...], dict[tuple[int, ...], Any]]) -> Element:
        total = tower.zero
        for held, terms in shares.items():
            product = tower.made(tower.context.from_dict(terms), one)
            for root, e in zip(roots.values(), held, strict=True):
                for _ in range(e):
                    product = product * root
            total = total + product
        return total

    return {k: {m: coefficient(shares) for m, shares in part.items()} for k, part in parts.items()}


def adjoined(tower: Tower, field: PolynomialField) -> dict[str, Element]:
    """The square roots among the field's parameters, in the tower.

    Raises NoClosedForm where a square is one in the parameters that are left: of which sign its root is nobody says.
    """
    found: dict[str, Element] = {}
    for name, square in field.roots:
        inside = angle_in(name)
        if inside is not None:
            found[name] = tower.sin_cos(LinearForm(((inside[1], Fraction(1, inside[2])),)))[0]
            continue
        total = tower.zero
        for monomial, c in square.to_dict().items():
            product = tower.element(c)
            for other, e in zip(field.parameters, monomial, strict=False):
                for _ in range(int(e)):
                    product = product * (found[other] if other in found else tower.parameter(other))
            total = total + product
        root = tower.square_root(total)
        number = tower.rational(root)
        if number is not None:
            root = tower.element(abs(number))
        elif not any(root.top.degrees()[:MOST_ROOTS]):
            raise NoClosedForm(
                "a square root in the coefficients becomes rational, and its sign is not known",
                remedy="put in numbers for the parameters under it",
            )
        found[name] = root
    return found
