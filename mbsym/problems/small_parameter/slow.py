"""Slow integral manifolds: z = h(s, eps) by comparing coefficients of eps.

With slow variables s and fast ones z of  D x' = N(s, z, eps)  the manifold is invariant if

    N_z(s, h, eps) = sum_j dh/ds_j N_j(s, h, eps),

times eps^k_i in row i, so that its lowest order in eps is 0.  Where the part of lowest order g(s, z) = 0 has a root
z = h_0(s) that is found by elimination (below), and L(s) = dg/dz there has det L != 0,

    h  <-  h - L^-1 (what is left in these equations),      first h = h_0,

gains an order of eps with every few steps (one for each derivative that has to be known first, such as that of a
position whose velocity is fast, too), and ends when all coefficients up to the order asked for stay the same.
(V. Sobolev and V. Strygin's method of integral manifolds; E. Shchepakina, V. Sobolev and M. Mortell, Singular
perturbations, Springer 2014, chapter 2.)
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import combinations
from operator import add

from flint import fmpq_mpoly_ctx

from mbsym.algebra import matrices
from mbsym.algebra.factors import irreducible_factors, occurring, square_apart
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.matrices import determinant_by_traces, faddeev
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.quotients import LOWER, Composition, Polynomial, Quotient, Series
from mbsym.algebra.terms import apart
from mbsym.problems.small_parameter.result import Adjoined, Hurwitz, ScaledField, SteadyStates

# The lowest order of the equations of fast variables, solved: z = h_0(s), and the matrix L of derivatives there.
#
# A root that is a square root of slow variables or parameters, rho^2 = d, is made rational by another choice of these:
# where d is linear in one of them, d = a k + b, rho stands in the place of  k = (rho^2 - b)/a.


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
    candidates = []
    for at, row in enumerate(left):
        for place in unknown:
            factor = row.top.derivative(place)
            if factor != 0 and not any(factor.degrees()[k] > 0 for k in unknown):
                candidates.append((len(row.top), at, place, factor))
    if not candidates:
        return None
    _, at, place, factor = min(candidates, key=lambda candidate: candidate[:3])
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


#: Choices of fast variables that are looked at.
MOST_CHOICES = 2000
MOST_STEPS = 60


def fast_variables(there: ScaledField, slow: Sequence[str] = ()) -> tuple[str, ...]:
    """The smallest set that holds all variables with x' ~ 1/eps or faster, and none of ``slow``, with det L != 0.

    Sets whose L holds parameters alone come before others.  Raises NoClosedForm where there is none, or more than one
    of the smallest.
    """
    names = there.field.variables
    swift = [i for i, k in enumerate(there.scales) if k > 0]
    if not swift:
        raise NoClosedForm(
            "no variable is fast: no derivative grows without bound as [[small]] tends to 0",
            small=there.small,
            remedy="see 'powers' of the small parameter: {p2: -1} says that p2 is large",
        )
    others = [i for i, name in enumerate(names) if i not in swift and name not in slow]
    looked = 0
    for constant, more in ((constant, more) for constant in (True, False) for more in range(len(others) + 1)):
        candidates = []
        for chosen in combinations(others, more):
            looked += 1
            if looked > MOST_CHOICES:
                raise NoClosedForm("too many variables to find the fast ones among them", remedy=DECLARE)
            places = tuple(sorted((*swift, *chosen)))
            if roots(there, places, constant).any:
                candidates.append(places)
        if len(candidates) > 1:
            choices = "; ".join(", ".join(names[i] for i in places) for places in candidates[:3])
            raise NoClosedForm("which variables are fast is not clear: [[told]]", told=choices, remedy=DECLARE)
        if candidates:
            return tuple(names[i] for i in candidates[0])
    raise NoClosedForm(
        "the lowest order in the small parameter does not determine fast variables by slow ones: it is singular, or "
        "not solved by equations that are linear or quadratic in one of them",
        remedy=DECLARE,
    )


def roots_of(there: ScaledField, fast: Sequence[str]) -> Roots:
    """Where the lowest order of the equations of ``fast`` vanishes.  Raises NoClosedForm where that is not known."""
    solutions = roots(there, [there.field.variables.index(name) for name in fast])
    if not solutions.any:
        raise NoClosedForm(
            "at the lowest order in [[small]] the equations of [[fast]] do not determine them: they are "
            "singular, or not solved by equations that are linear or quadratic in one of them",
            small=there.small,
            fast=", ".join(fast),
        )
    return solutions


DECLARE = "declare them: 'small parameter: {eps: {fast: [x, y]}}'"


def _on(there: ScaledField, fast: Sequence[str]) -> Composition:
    """Puts series in place of the fast variables."""
    first = len(there.field.parameters)
    return Composition(there.field.context, [first + there.field.variables.index(name) for name in fast])


def manifold(there: ScaledField, fast: Sequence[str], order: int, start: Root | None = None) -> list[Series]:
    """h up to eps^order from the root ``start``, else the first.  Raises NoClosedForm where the steps do not settle."""
    variables = there.field.variables
    indices = [variables.index(name) for name in fast]
    start = roots_of(there, fast).known[0] if start is None else start
    on = _on(there, fast)
    slow = [i for i in range(len(variables)) if i not in indices]
    functions = [Series.constant(value) for value in start.values]
    for _ in range(MOST_STEPS):
        left = equations(there, indices, slow, functions, on, order + 1)
        if not any(series.coefficients for series in left):
            return [function.exactly() for function in functions]
        changed = []
        for function, row in zip(functions, start.inverse, strict=True):
            for c, series in zip(row, left, strict=True):
                function = function - Series.constant(c) * series
            changed.append(function.up_to(order + 1).exactly())
        functions = changed
    raise NoClosedForm(
        "the coefficients up to order [[order]] do not settle within [[most]] steps",
        order=order,
        most=MOST_STEPS,
        limit=Limit.WORK,
        remedy=LOWER,
    )


def equations(
    there: ScaledField,
    fast: Sequence[int],
    slow: Sequence[int],
    functions: Sequence[Series],
    on: Composition,
    known: int | None,
) -> list[Series]:
    """eps^k_i (N_i - sum_j dh_i/ds_j N_j) on z = h, up to eps^known; what is left of the equations of the manifold."""
    first = len(there.field.parameters)
    flows: dict[int, Series] = {}
    deep = None if known is None else known + max(0, max(-there.scales[i] for i in fast))
    residuals = []
    for place, i in enumerate(fast):
        k = there.scales[i]
        most = None if known is None else known - k
        rest = on(there.rows[i], functions, most)
        for j in slow:
            slope = functions[place].derivative(first + j)
            if slope.coefficients:
                if j not in flows:
                    flows[j] = on(there.rows[j], functions, deep)
                rest = rest - (slope * flows[j]).up_to(most)
        residuals.append(rest.shifted(k))
    return residuals


def divisors(
    there: ScaledField, fast: Sequence[str], functions: Sequence[Series], start: Root | None = None
) -> tuple[Polynomial, ...]:
    """What is not zero where the expansion holds: det L, and the denominator of the equations at eps = 0 on h_0."""
    start = roots_of(there, fast).known[0] if start is None else start
    below = _on(there, fast)(there.denominator, [function.up_to(1) for function in functions], 1).coefficients.get(0)
    quotients = [quotient for quotient in (start.determinant, below) if quotient is not None]
    parts = [p for quotient in quotients for p in (quotient.top, quotient.bottom)]
    return tuple(p for p in parts if not p.is_constant())


def flow(there: ScaledField, fast: Sequence[str], functions: Sequence[Series], order: int) -> dict[str, Series]:
    """s' on the manifold, up to the order to which it follows from h up to eps^order.

    Raises NoClosedForm where the denominator vanishes at eps = 0 on the whole manifold.
    """
    on = _on(there, fast)
    near = [function.up_to(order + 1) for function in functions]
    below = on(there.denominator, near, None)
    if 0 not in below.coefficients:
        raise NoClosedForm(
            "the matrix of inertia is singular at [[small]] = 0 on the whole manifold", small=there.small
        )
    rates = {}
    for name, row in zip(there.field.variables, there.rows, strict=True):
        if name not in fast:
            rates[name] = on(row, near, None).over(below, order + 1)
    return rates


def without_root(flow: dict[str, Series], root: Adjoined, names: Sequence[str]) -> dict[str, Series]:
    """The flow with k' = sum_j dk/ds_j s_j' in place of rho', k the variable that rho stands for."""
    if root.label not in flow:
        return flow
    rates = [
        Series.constant(slope) * flow[name]
        for name in flow
        if not (slope := root.value.derivative(names.index(name))).is_zero
    ]
    total = reduce(add, rates)
    named = {root.label: root.instead}
    return {named.get(name, name): total if name in named else x for name, x in flow.items()}


def free_without_root(free: tuple[str, ...], root: Adjoined, names: Sequence[str]) -> tuple[str, ...]:
    """Variables that are free in a set of steady states, k, which rho stands for, among them; none where k depends.

    Where rho rests while others are free that stand in k, the set is no plane along the axes with k in place of rho.
    """
    if root.label in free:
        return tuple(root.instead if name == root.label else name for name in free)
    return () if any(not root.value.derivative(names.index(name)).is_zero for name in free) else free


# The first approximation on a slow manifold about a steady state, and whether the manifold attracts there.
#
# With A the matrix of all variables and A_s(eps) that of the flow on the manifold, det(S - A_s) divides det(S - A): the
# quotient belongs to the fast variables.  Its coefficients are found as series in eps by division; what remains must be
# of higher order than the expansion, which checks both.  By Hurwitz all roots of a polynomial have negative real parts
# if all leading minors D_1, ..., D_n are positive, so that for all sufficiently small eps > 0 their first coefficients
# decide.


#: Characteristic polynomials of a higher degree are not expanded.
MOST_VARIABLES = 8


def steady_states(
    there: ScaledField,
    flow: Mapping[str, Series],
    functions: Mapping[str, Series],
    values: Mapping[str, Quotient],
    order: int,
) -> SteadyStates:
    """Of the steady state ``values`` (by variable).  Raises NoClosedForm where it is none."""
    field = there.field
    first = len(field.parameters)
    names = field.variables
    if len(names) > MOST_VARIABLES:
        raise NoClosedForm(
            "more than [[most]] variables: no characteristic polynomial is expanded", most=MOST_VARIABLES
        )
    context = field.context

    def at(c: Quotient) -> Quotient:
        return _put(c, first, [values[name] for name in names])

    def on(x: Series) -> Series:
        quotients = {k: at(c) for k, c in x.coefficients.items()}
        return Series(context, {k: c for k, c in quotients.items() if not c.is_zero}, x.known)

    for name, rate in flow.items():
        if on(rate).coefficients:
            raise NoClosedForm(
                "the motion is no steady state on the manifold: [[name]] does not stay constant", name=name
            )
    for name, function in functions.items():
        series = Series.constant(values[name])
        if (on(function) - series).coefficients:
            raise NoClosedForm("the motion does not lie on the manifold: [[name]] is another one there", name=name)
    slow = list(flow)
    small = [[on(flow[i].derivative(first + names.index(j))) for j in slow] for i in slow]
    rows = [Series(context, {k: Quotient.of(p) for k, p in row.items()}) for row in there.rows]
    below = on(Series(context, {k: Quotient.of(p) for k, p in there.denominator.items()}))
    # D x' = N and N = 0 on the motion: A = (dN/dx)/D there.
    if any(on(row).coefficients for row in rows):
        raise NoClosedForm("the motion is no steady state of the equations")
    scaled = [[on(row.derivative(first + k)) for k in range(len(names))] for row in rows]
    full = characteristic(context, scaled)  # det(S - D A), in which S^(n-k) has the k-th power of D too many
    whole, power = [], Series.constant(Quotient.of(context.constant(1)))
    deep = 2 * order + 8 + 2 * sum(max(0, k) for k in there.scales)
    for c in full:
        whole.append(c.over(power, deep) if c.coefficients else c)
        power = power * below
    zeros = 0
    while len(whole) > 1 and whole[-1].is_zero:
        whole.pop()
        zeros += 1
    narrow = characteristic(context, small)
    if zeros > len(narrow) - 1:
        raise NoClosedForm("more roots are zero than there are slow variables")
    for c in narrow[len(narrow) - zeros :]:
        if c.coefficients:
            raise NoClosedForm("the flow on the manifold does not keep the zero roots: the expansion is wrong")
    narrow = narrow[: len(narrow) - zeros]
    quotient, rest = divided(whole, narrow)
    for part in rest:
        if part.coefficients:
            raise NoClosedForm("the roots of the flow on the manifold are none of the system: the expansion is wrong")
    remainder = min((part.known for part in rest if part.known is not None), default=order + 1)
    free = _free(there, values)
    return SteadyStates(
        zeros, hurwitz(context, narrow), hurwitz(context, quotient), remainder, free if len(free) == zeros else ()
    )


def _free(there: ScaledField, values: Mapping[str, Quotient]) -> tuple[str, ...]:
    """The variables of which every one, and all together, may have any values in a steady state, eps being what it is.

    Empty where each may, but not all together: then Omega is no plane along axes.
    """
    field, first = there.field, len(there.field.parameters)
    formulas = [p for row in there.rows for p in row.values()] + list(field.relations)

    def steady(free: Sequence[str]) -> bool:
        at = [
            Quotient.of(x) if name in free else values[name]
            for name, x in zip(field.variables, field.context.gens()[first:], strict=True)
        ]
        return all(_put(Quotient.of(p), first, at).is_zero for p in formulas)

    free = tuple(name for name in field.variables if steady((name,)))
    return free if steady(free) else ()


def characteristic(context: object, matrix: Sequence[Sequence[Series]]) -> list[Series]:
    """det(S - A), coefficients from S^n down, by Faddeev and LeVerrier."""
    return faddeev(matrix, *_units(context))[1][::-1]


def _units(context: object) -> tuple[Series, Series]:
    """0 and 1."""
    series = Series.constant(Quotient.of(context.constant(1)))  # type: ignore[attr-defined]
    return series - series, series


def divided(dividend: Sequence[Series], divisor: Sequence[Series]) -> tuple[list[Series], list[Series]]:
    """Quotient and remainder of polynomials, coefficients from the highest down; the divisor is monic."""
    work = list(dividend)
    count = len(dividend) - len(divisor) + 1
    for k in range(count):
        for n, c in enumerate(divisor[1:], start=1):
            work[k + n] = work[k + n] - work[k] * c
    return work[:count], work[count:]


def hurwitz(context: object, polynomial: Sequence[Series]) -> Hurwitz:
    """The leading minors of Hurwitz's matrix of a monic polynomial."""
    n = len(polynomial) - 1
    nothing, series = _units(context)
    minors = [determinant_by_traces(matrices.hurwitz(polynomial, nothing, k), nothing, series) for k in range(1, n + 1)]
    return Hurwitz(tuple(polynomial), tuple(minors))


def _put(c: Quotient, first: int, values: Sequence[Quotient]) -> Quotient:
    """c with quotients in place of the variables."""
    images = dict(enumerate(values, first))
    return put(c.top, images) / put(c.bottom, images)
