"""Slow integral manifolds: z = h(s, eps) by comparing coefficients of eps.

With slow variables s and fast ones z of  D x' = N(s, z, eps)  the manifold is invariant if

    N_z(s, h, eps) = sum_j dh/ds_j N_j(s, h, eps),

times eps^k_i in row i, so that its lowest order in eps is 0.  Where the part of lowest order g(s, z) = 0 has a root
z = h_0(s) that is found by elimination (``root``), and L(s) = dg/dz there has det L != 0,

    h  <-  h - L^-1 (what is left in these equations),      first h = h_0,

gains an order of eps with every few steps (one for each derivative that has to be known first, such as that of a
position whose velocity is fast, too), and ends when all coefficients up to the order asked for stay the same.
(V. Sobolev and V. Strygin's method of integral manifolds; E. Shchepakina, V. Sobolev and M. Mortell, Singular
perturbations, Springer 2014, chapter 2.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import combinations
from operator import add

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.quotients import LOWER, Composition, Polynomial, Series
from mbsym.problems.small_parameter.result import Adjoined, ScaledField
from mbsym.problems.small_parameter.root import Root, Roots, roots

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
        found = []
        for chosen in combinations(others, more):
            looked += 1
            if looked > MOST_CHOICES:
                raise NoClosedForm("too many variables to find the fast ones among them", remedy=DECLARE)
            places = tuple(sorted((*swift, *chosen)))
            if roots(there, places, constant).any:
                found.append(places)
        if len(found) > 1:
            told = "; ".join(", ".join(names[i] for i in one) for one in found[:3])
            raise NoClosedForm("which variables are fast is not clear: [[told]]", told=told, remedy=DECLARE)
        if found:
            return tuple(names[i] for i in found[0])
    raise NoClosedForm(
        "the lowest order in the small parameter does not determine fast variables by slow ones: it is singular, or "
        "not solved by equations that are linear or quadratic in one of them",
        remedy=DECLARE,
    )


def roots_of(there: ScaledField, fast: Sequence[str]) -> Roots:
    """Where the lowest order of the equations of ``fast`` vanishes.  Raises NoClosedForm where that is not known."""
    found = roots(there, [there.field.variables.index(name) for name in fast])
    if not found.any:
        raise NoClosedForm(
            "at the lowest order in [[small]] the equations of [[fast]] do not determine them: they are "
            "singular, or not solved by equations that are linear or quadratic in one of them",
            small=there.small,
            fast=", ".join(fast),
        )
    return found


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
        if not any(one.coefficients for one in left):
            return [one.exactly() for one in functions]
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
    found = []
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
        found.append(rest.shifted(k))
    return found


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
    found = {}
    for name, row in zip(there.field.variables, there.rows, strict=True):
        if name not in fast:
            found[name] = on(row, near, None).over(below, order + 1)
    return found


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
