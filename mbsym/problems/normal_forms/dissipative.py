"""Equilibria of systems with applied forces: the roots exactly, then the critical cases on the centre manifold.

The state is x without the cyclic coordinates, and all velocities.  With det(lambda - A) = E(lambda^2) + lambda
O(lambda^2) the roots +-i w are those of the common factor of E and O: exact arithmetic tells them, and their number,
from roots near the axis.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from flint import Ordering, acb_poly, arb, ctx, fmpq, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.matrices import faddeev
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.formulas.formula import Formula
from mbsym.model.system import velocity_name
from mbsym.problems.normal_forms.exact import (
    Reduced,
    common_factor,
    exact_values,
    in_ring,
    matrix_of,
    occurring_parameters,
    on_pair,
    on_zero,
    over_tower,
)
from mbsym.problems.normal_forms.expansion import Expansion, Numbers
from mbsym.problems.normal_forms.result import Focus, Judged, Outcome, Theorem, Why


def state_field(numbers: Numbers, order: int = 3) -> tuple[list[Truncated], tuple[str, ...]]:
    """x' and v' in the state, up to ``order``, and the coordinates in it."""
    expansion, n = numbers.expansion, numbers.n
    rates = numbers.field()
    places = [*(i for i in range(n) if i not in expansion.cyclic), *range(n, 2 * n)]
    space = Space(len(places), order, numbers.zero, numbers.one)

    def cut(row: Truncated) -> Truncated:
        return Truncated(space, {tuple(key[k] for k in places): value for key, value in row.coefficients.items()})

    positions = tuple(expansion.coordinates[i] for i in places if i < n)
    velocities = [space.variable(places.index(n + expansion.coordinates.index(name))) for name in positions]
    return [*velocities, *map(cut, rates)], positions


def judged_field(to: Callable[[int], Expansion], values: Mapping[str, Any]) -> Judged:
    """What is decided at exact values; the Lagrangian is expanded ``to`` a higher order only where that decides."""
    numbers = exact_values(to(2), values)
    if numbers is None:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.IRRATIONAL)
    tower, exact = numbers

    def field(order: int) -> tuple[list[Truncated], tuple[str, ...]]:
        return state_field(over_tower(to(order + 1), tower, exact), order)

    whole_ones = faddeev(matrix_of(field(1)[0]), tower.zero, tower.one)[1]
    coefficients = [x for whole_one in whole_ones if (x := tower.rational(whole_one)) is not None]
    if len(coefficients) < len(whole_ones):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.IRRATIONAL)
    whole = fmpq_poly(coefficients)
    zeros = next(k for k in range(whole.degree() + 1) if whole[k] != 0)
    whole = fmpq_poly(whole.coeffs()[zeros:])
    square = fmpq_poly(whole.coeffs()[::2]).gcd(fmpq_poly(whole.coeffs()[1::2]))
    pairs = _negative_roots(square)
    beside = whole // _even(square)
    if pairs < square.degree() or _to_the_right(beside):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not pairs and not zeros:
        return Judged(Outcome.ASYMPTOTIC, Theorem.FIRST)
    if pairs == 1 and not zeros:
        return _pair(tower, field, tower.element(square[0] / square[1]))
    if zeros == 1 and not pairs:
        return _zero(tower, field(3)[0])
    why = Why.MIXED_ROOTS if pairs and zeros else Why.MORE_PAIRS if pairs else Why.TWO_ZERO_ROOTS
    return Judged(Outcome.UNDECIDED, Theorem.NONE, why)


def _even(square: fmpq_poly) -> fmpq_poly:
    """g(lambda^2)."""
    coefficients = [fmpq(0)] * (2 * square.degree() + 1)
    coefficients[::2] = square.coeffs()
    return fmpq_poly(coefficients)


def _square_free(x: fmpq_poly) -> list[fmpq_poly]:
    return [factor for factor, _ in x.factor()[1]]


def _roots(factor: fmpq_poly) -> list[Any]:
    return list(acb_poly(factor).roots(tol=arb(2) ** (-(ctx.prec // 2))))


def _negative_roots(x: fmpq_poly) -> int:
    """How many roots are real and negative, each as often as it is one; zero is none."""
    count = 0
    for factor, times in x.factor()[1]:
        count += times * sum(1 for root in _roots(factor) if root.imag.contains(0) and root.real < 0)
    return count


def _to_the_right(x: fmpq_poly) -> bool:
    """Whether a root has a positive real part; none has the real part 0, so that enclosures tell."""
    return any(root.real > 0 for factor in _square_free(x) for root in _roots(factor))


def _size(x: Element) -> float:
    return float(not x.is_zero())


def _pair(tower: Tower, field: Callable[[int], tuple[Sequence[Truncated], Sequence[str]]], square: Element) -> Judged:
    coefficient, amplitude_of = _coefficient(tower, *field(3), square)
    degree = None
    if coefficient.is_zero():  # Bautin's point
        coefficient, amplitude_of = _coefficient(tower, *field(5), square)
        degree = 5
    number = tower.rational(coefficient)
    w = arb(tower.rational(square)).sqrt()
    value: Any = tower.enclosed(coefficient, {}).real if number is None else number
    outcome, theorem, why = _sign(value)
    return Judged(outcome, theorem, why, frequencies=(w,), coefficient=value, amplitude_of=amplitude_of, degree=degree)


def _sign(value: Any) -> tuple[Outcome, Theorem, Why]:
    if value < 0:
        return Outcome.ASYMPTOTIC, Theorem.REDUCTION, Why.NONE
    if value > 0:
        return Outcome.UNSTABLE, Theorem.REDUCTION, Why.NONE
    return Outcome.UNDECIDED, Theorem.NONE, Why.COEFFICIENT_OPEN


def _coefficient(
    tower: Tower, field: Sequence[Truncated], positions: Sequence[str], square: Element
) -> tuple[Element, str]:
    """a of r' = a r^3, or of r' = a r^5 where the field goes so far; and the coordinate whose amplitude r is."""
    root = tower.square_root(-square)
    reduced: Reduced = on_pair(field, root, tower.reciprocal, _size)
    j = next(j for j in range(len(positions)) if not reduced.lengths[j].is_zero())
    whole, scale = (reduced.cubic, 4) if reduced.quintic is None else (reduced.quintic, reduced.lengths[j] * 16)
    real = (whole + tower.conjugate(whole, tower.places(root.top)[0])) / 2
    return real / (reduced.lengths[j] * scale), positions[j]


def _zero(tower: Tower, field: Sequence[Truncated]) -> Judged:
    reduced = on_zero(field, tower.reciprocal, _size)
    if not reduced.quadratic.is_zero():
        return Judged(Outcome.UNSTABLE, Theorem.REDUCTION, coefficient=tower.rational(reduced.quadratic))
    value = tower.rational(reduced.cubic)
    if value is None:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.COEFFICIENT_OPEN)
    outcome, theorem, why = _sign(value)
    return Judged(outcome, theorem, why, coefficient=value)


def focus(expansion: Expansion) -> Focus | None:
    """Where +-i w is a pair of roots for all parameters: w^2 and a.  None where there is none, or more than one."""
    ring = expansion.scene.ring
    tower = Tower(occurring_parameters(expansion))
    field, positions = state_field(over_tower(expansion, tower, {}))
    coefficients = faddeev(matrix_of(field), tower.zero, tower.one)[1]
    if coefficients[0].is_zero():
        return None
    factor = common_factor(tower, coefficients[::2], coefficients[1::2])
    if len(factor) != 2:
        return None
    if tower.is_positive(-factor[0]) or not tower.places(tower.square_root(-factor[0]).top):
        return None  # two real roots of opposite signs
    coefficient, amplitude_of = _coefficient(tower, field, positions, factor[0])
    formulas = [Formula(ring, in_ring(tower, ring, x)) for x in (factor[0], coefficient)]
    return Focus(formulas[0], formulas[1], amplitude_of)


def taylor_field(expansion: Expansion, order: int = 3) -> PolynomialField:
    """The Taylor field about the unperturbed motion as a polynomial vector field over the parameters, to ``order``:

        x' = v,      v' = a_1(x, v) + a_2(x, v) + ... + a_N(x, v),

    in the deviations of the coordinates that are not cyclic, and of all velocities; the Lagrangian is expanded to one
    order more.  Coefficients are rational functions of the parameters, brought over one denominator.

    Variables are named like what deviates: ``theta``, ``theta_dot``.  Square roots, and sines of parameters beside
    their cosines, are constants of the field.  Raises NoClosedForm where coefficients hold other functions of
    parameters, SingularPoint where det M = 0 on the motion.
    """
    tower = Tower(occurring_parameters(expansion))
    rows, positions = state_field(over_tower(expansion, tower, {}), order)
    variables = (*positions, *(velocity_name(name) for name in expansion.coordinates))
    kinds = [tower.kind(MOST_ROOTS - 1 - k) for k in range(len(tower.squares))]
    roots = [kind if isinstance(kind, str) else f"#{k}" for k, kind in enumerate(kinds)]
    parameters = (*tower.parameters, *roots)
    context = fmpq_mpoly_ctx.get([*parameters, *variables], Ordering.degrevlex)
    own = [context.gen(k) for k in range(len(parameters))]
    free = len(tower.parameters)
    images = [context.constant(0)] * (MOST_ROOTS - len(roots)) + own[free:][::-1] + own[:free]
    common = context.constant(1)
    entries = []
    for row in rows:
        terms = []
        for key, value in row.coefficients.items():
            product = context.term(exp_vec=(*(0 for _ in parameters), *key))
            top, bottom = (x.compose(*images, ctx=context) for x in (value.top, value.bottom))
            common = common * (bottom / common.gcd(bottom))
            terms.append((product * top, bottom))
        entries.append(terms)
    numerators = [sum((top * (common / bottom) for top, bottom in terms), context.constant(0)) for terms in entries]
    shared, denominator = in_lowest_terms(numerators, common)
    squares = tuple(
        (name, square.compose(*images, ctx=context)) for name, square in zip(roots, tower.squares, strict=True)
    )
    return PolynomialField(context, parameters, variables, tuple(shared), denominator, roots=squares)
