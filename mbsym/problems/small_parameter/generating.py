"""The equations of quasi-linear oscillations sorted by powers of the small parameter, and their generating system.

    x' = f_0(x) + eps f_1(x) + eps^2 f_2(x) + ...

where f_0 leaves some variables c constant and is linear in the others z:  z' = A(c) z + b(c).  A splits into blocks of
variables that drive each other; an irreducible factor lambda^2 + omega^2 of a block's characteristic polynomial is a
mode.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import coefficients_in, evaluated
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower, angle_in
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.message import Message

#: Exponents of the variables -> coefficient.
Terms = Mapping[tuple[int, ...], Element]
#: By variable, then by power of eps.
Rows = Sequence[Mapping[int, Terms]]

MOST_BLOCK = 6


@dataclass(frozen=True)
class Mode:
    """Variables of a block, and omega^2 of one of its pairs of roots +-i omega."""

    block: tuple[int, ...]
    square: Element


@dataclass(frozen=True)
class Generating:
    """``constant`` and ``moving`` variables by number; A over ``moving``, b; ``blocks``, each after what drives it.

    ``aside`` are variables that no equation needs; they are found by quadrature, in this order.  Blocks that have other
    roots than those of ``modes``: surely some that are not imaginary (``damped``), zero, or some that are not known.
    """

    tower: Tower
    names: tuple[str, ...]
    rows: Rows
    constant: tuple[int, ...]
    moving: tuple[int, ...]
    aside: tuple[int, ...]
    matrix: Mapping[tuple[int, int], Element]
    shift: Mapping[int, Element]
    blocks: tuple[tuple[int, ...], ...]
    modes: tuple[Mode, ...]
    damped: tuple[tuple[int, ...], ...] = ()
    with_zero: tuple[tuple[int, ...], ...] = ()
    not_known: tuple[tuple[int, ...], ...] = ()

    def block_matrix(self, block: Sequence[int]) -> list[list[Element]]:
        zero = self.tower.zero
        return [[self.matrix.get((i, j), zero) for j in block] for i in block]


def generating(tower: Tower, names: Sequence[str], rows: Rows, start: Callable[[int], Element]) -> Generating:
    """``start``: the constant value of a variable that f_0 leaves constant, by its number.

    Raises NoClosedForm where f_0 is not as above.
    """
    count = len(names)
    aside = _aside(rows, count)
    constant = tuple(i for i in range(count) if i not in aside and not rows[i].get(0))
    moving = tuple(i for i in range(count) if i not in aside and i not in constant)
    values = {i: start(i) for i in constant}
    matrix: dict[tuple[int, int], Element] = {}
    shift: dict[int, Element] = {}
    for i in moving:
        for exponents, c in rows[i][0].items():
            rest = [(j, e) for j, e in enumerate(exponents) if e and j not in values]
            if len(rest) > 1 or any(e > 1 for _, e in rest):
                term = "*".join(f"{names[j]}**{e}" if e > 1 else names[j] for j, e in rest)
                raise NoClosedForm(
                    "the equations are not quasi-linear: without the small parameter that of [[name]] holds [[told]]",
                    name=names[i],
                    told=term,
                    remedy="declare which variables are small: 'small parameter: {eps: {powers: {x: 1}}}'",
                )
            for j, e in enumerate(exponents):
                for _ in range(e if j in values else 0):
                    c = c * values[j]
            if rest:
                key = (i, rest[0][0])
                matrix[key] = matrix[key] + c if key in matrix else c
            else:
                shift[i] = shift[i] + c if i in shift else c
    matrix = {key: c for key, c in matrix.items() if not c.is_zero()}
    blocks = _blocks(moving, matrix)
    system = Generating(tower, tuple(names), rows, constant, moving, aside, matrix, shift, blocks, ())
    roots = [(block, _roots_of(system, block)) for block in blocks]
    return replace(
        system,
        modes=tuple(x for _, block_roots in roots for x in block_roots.modes),
        damped=tuple(block for block, block_roots in roots if block_roots.damped),
        with_zero=tuple(block for block, block_roots in roots if block_roots.zero),
        not_known=tuple(block for block, block_roots in roots if block_roots.not_known),
    )


def _aside(rows: Rows, count: int) -> tuple[int, ...]:
    """Variables on which no other equation depends, one after the other; what is found first is integrated last."""
    left = list(range(count))
    aside: list[int] = []
    while True:
        used = {
            j for i in left for part in rows[i].values() for exponents in part for j, e in enumerate(exponents) if e
        }
        fresh = [i for i in left if i not in used]
        if not fresh or len(fresh) == len(left):
            return tuple(reversed(aside))
        aside += fresh
        left = [i for i in left if i not in fresh]


def _blocks(moving: Sequence[int], matrix: Mapping[tuple[int, int], Element]) -> tuple[tuple[int, ...], ...]:
    """Strongly connected parts, each after those that it depends on."""
    reach = {i: {i} | {j for (k, j) in matrix if k == i} for i in moving}
    grown = True
    while grown:
        grown = False
        for i in moving:
            more = set().union(*(reach[j] for j in reach[i]))
            if more - reach[i]:
                reach[i], grown = reach[i] | more, True
    parts = list(dict.fromkeys(tuple(j for j in moving if j in reach[i] and i in reach[j]) for i in moving))
    return tuple(sorted(parts, key=lambda part: (len(reach[part[0]]), part)))


@dataclass(frozen=True)
class _Roots:
    """The modes of a block; and whether it has roots that are surely not imaginary, zero, or not known."""

    modes: tuple[Mode, ...]
    damped: bool
    zero: bool
    not_known: bool


def _roots_of(system: Generating, block: tuple[int, ...]) -> _Roots:
    tower = system.tower
    if len(block) > MOST_BLOCK:
        raise NoClosedForm(
            "more than [[most]] variables oscillate together without the small parameter", most=MOST_BLOCK
        )
    whole = faddeev(system.block_matrix(block), tower.zero, tower.one)[1]  # low to high
    coefficients = without_zeros(whole)
    factors = [coefficients] if _even(coefficients) else _factors(tower, coefficients)
    even = [factor for factor in factors if _even(factor)]
    # A real polynomial, not zero at 0, with imaginary roots only is even.
    squares = [x for factor in even for x in _roots(tower, [c / factor[-1] for c in factor[::2]])]  # of lambda^2
    modes = tuple(Mode(block, -x) for x in squares if not _negative(tower, -x))
    damped = len(even) < len(factors) or len(modes) < len(squares)
    lost = 2 * len(squares) < sum(len(factor) - 1 for factor in even)
    return _Roots(modes, damped, len(coefficients) < len(whole), lost)


def without_zeros(polynomial: Sequence[Element]) -> list[Element]:
    """Divided by as many lambda as there are; coefficients from low to high."""
    first = next(i for i, c in enumerate(polynomial) if not c.is_zero())
    return list(polynomial[first:])


def _even(polynomial: Sequence[Element]) -> bool:
    return len(polynomial) % 2 == 1 and all(c.is_zero() for c in polynomial[1::2])


def _negative(tower: Tower, x: Element) -> bool:
    number = tower.rational(x)
    return number is not None and number <= 0


def _roots(tower: Tower, polynomial: Sequence[Element]) -> list[Element]:
    """Of a monic polynomial, coefficients from low to high: those of factors of degrees 1 and 2."""
    degree = len(polynomial) - 1
    if degree == 1:
        return [-polynomial[0]]
    if degree == 2:
        half = polynomial[1] / tower.number(2)
        root = tower.square_root(half * half - polynomial[0])
        return [root - half, -root - half]
    roots: list[Element] = []
    for factor in _factors(tower, polynomial):
        if len(factor) <= 3:
            lead = factor[-1]
            roots += _roots(tower, [c / lead for c in factor])
    return roots


def _factors(tower: Tower, polynomial: Sequence[Element]) -> list[list[Element]]:
    """Irreducible factors over the field of the parameters; the polynomial itself where it holds roots."""
    context = tower.context
    common = context.constant(1)
    for c in polynomial:
        common = common * (c.bottom / common.gcd(c.bottom))
    gens = context.gens()
    free = gens[-1] if not any(c.top.degrees()[-1] > 0 or c.bottom.degrees()[-1] > 0 for c in polynomial) else None
    if free is None or any(d > 0 for c in polynomial for d in c.top.degrees()[: len(gens) - len(tower.parameters)]):
        return [list(polynomial)]
    whole = sum((c.top * (common / c.bottom) * free**k for k, c in enumerate(polynomial)), context.constant(0))
    factors: list[list[Element]] = []
    for factor, exponent in whole.factor()[1]:
        parts = coefficients_in(factor, len(gens) - 1)
        if len(parts) > 1:
            factors += [[tower.made(part, context.constant(1)) for part in parts]] * int(exponent)
    return factors


# A polynomial field as x' = sum_k eps^k rows[k](x) over a tower, with x eps^power for variables that are small.


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
            "the equations are not quasi-linear: without [[small]] the mass matrix depends on the state",
            small=small,
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
                "[[name]]' grows without bound as [[small]] tends to 0: nothing oscillates at a rate of order 1",
                name=name,
                small=small,
                remedy="see 'mbsym expand' for slow manifolds, and the powers that are declared",
            )
        graded: _Graded = {}
        for k in range(most + 1):
            part = dict(above.get(k, {}))
            for j, factor in below.items():
                if j <= k:
                    _subtract(part, factor, graded[k - j])
            graded[k] = {m: c * back for m, c in part.items() if not c.is_zero()}
        rows.append({k: part for k, part in graded.items() if part})
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
    elements: dict[str, Element] = {}
    for name, square in field.roots:
        inside = angle_in(name)
        if inside is not None:
            elements[name] = tower.sin_cos(LinearForm(((inside[1], Fraction(1, inside[2])),)))[0]
            continue

        def power(k: int, exponent: int) -> Element:
            other = field.parameters[k]
            return prod([elements[other] if other in elements else tower.parameter(other)] * exponent, start=tower.one)

        root = tower.square_root(evaluated(square, power, tower.element))
        number = tower.rational(root)
        if number is not None:
            root = tower.element(abs(number))
        elif not any(root.top.degrees()[:MOST_ROOTS]):
            raise NoClosedForm(
                "a square root in the coefficients becomes rational, and its sign is not known",
                remedy="put in numbers for the parameters under it",
            )
        elements[name] = root
    return elements
