"""Reductions: the equations of motion in fewer variables, or other ones, step by step.

    x' = X(x, eps),      x = x(y, eps),  y' = Y(y, eps)      with      dx/dy Y(y) = X(x(y))

Every step puts something in for variables, exactly or as a series in eps:

* integrals used to eliminate u:  J(u, v) = J(u_0, v_0) is solved for u; or, without eps,  J(u, v) = c  for a u in which
  it is linear (the velocity of a cyclic coordinate, as Routh does);
* equations used to eliminate u:  v' = V(u, v) is solved for u, and v'' is the rate of v':  equations of second order;
* a change of variables  x = x(y),  with  x' = dx/dy y'  for those that are of second order.

Implicit equations are solved by u <- u - L^-1 (what is left in them), L their slope at eps = 0, which gains an order
with every round.  Each result is put into the original equations at random rational states, with eps a variable
(``order_left``).

Source: I. Malkin, Some Problems in the Theory of Nonlinear Oscillations, 1956 (quasi-linear systems); for Routh's step
Landau & Lifshitz, Mechanics, section 41.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import combinations
from random import Random
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.failures import Limit, NoClosedForm, SingularPoint
from mbsym.algebra.quotients import LOWER, Composition, Polynomial, Quotient, Series
from mbsym.algebra.terms import evaluated

MOST_ROUNDS = 40
#: Numerators and denominators of the random states.
_SIZE = 40


class How(Enum):
    """What a step is called."""

    SORTED = "the equations, solved for the rates"
    INTEGRALS = "integrals used to eliminate variables"
    EQUATIONS = "equations used to eliminate variables"
    CHANGE = "change of variables"


@dataclass(frozen=True)
class Flow:
    """``rates`` of the variables, which are generators of the context by their places.

    ``integrals`` are constant along it, and zero if ``fixed``; ``velocities`` are the places of rates by those of what
    moves so, where a rate may be a variable.
    """

    context: Any
    rates: Mapping[int, Series]
    integrals: tuple[Series, ...]
    velocities: Mapping[int, int]
    fixed: bool = False

    def rate(self, x: Series) -> Series:
        """dx/dt."""
        total = Series(self.context, {}, x.known)
        for place, moved in self.rates.items():
            slope = x.derivative(place)
            if slope.coefficients:
                total = total + slope * moved
        return total

    def variable(self, place: int) -> Series:
        return Series.constant(Quotient.of(self.context.gen(place)))


@dataclass(frozen=True)
class Step:
    """What was put in for variables, and the equations then.

    ``left``: the power of eps of what is left of the original equations (None: nothing).
    """

    how: How
    images: Mapping[int, Series]
    flow: Flow
    left: int | None = None


@dataclass(frozen=True)
class Reduction:
    """``rows``: numerator and denominator of every rate at first, ``small`` the place of eps in them (-1: none)."""

    rows: Mapping[int, tuple[Polynomial, Polynomial]]
    small: int
    steps: tuple[Step, ...]

    @property
    def flow(self) -> Flow:
        return self.steps[-1].flow

    def then(self, how: How, images: Mapping[int, Series], flow: Flow) -> Reduction:
        """With one more step.  Raises NoClosedForm where, put into the original equations, it does not satisfy them."""
        longer = replace(self, steps=(*self.steps, Step(how, images, flow)))
        left, allowed = longer.order_left()
        if left is not None and (allowed is None or left < allowed):
            raise NoClosedForm("withdrawn: put into the original equations, the reduction does not satisfy them")
        return replace(longer, steps=(*self.steps, Step(how, images, flow, left)))

    def images(self) -> dict[int, Series]:
        """The first variables in terms of the last ones."""
        series_by_place = {place: self.flow.variable(place) for place in self.rows}
        for step in self.steps:
            put = _put(step.flow.context, step.images)
            series_by_place = {place: put(x) for place, x in series_by_place.items()}
        return series_by_place

    def order_left(self, seed: int = 1) -> tuple[int | None, int | None]:
        """The lowest power of eps in  dx/dy Y - X(x(y)), and in that of integrals; and from which one on it may be.

        Numerators and denominators of X are not sorted by powers of eps, but multiplied out at random rational states.
        """
        flow, images, random = self.flow, self.images(), Random(seed)
        every = [*images.values(), *flow.rates.values(), *flow.integrals]
        shift = max(0, *(-series.lowest for series in every if series.lowest is not None))
        known = min((series.known for series in every if series.known is not None), default=None)
        at = [fmpq(random.randint(2, _SIZE), random.randint(2, _SIZE)) for _ in flow.context.names()]

        def value(x: Series) -> fmpq_poly:
            top = max(x.coefficients, default=0) + shift
            terms = [x.coefficients.get(k - shift) for k in range(top + 1)]
            return fmpq_poly([0 if c is None else c.top(*at) / c.bottom(*at) for c in terms])

        def whole(p: Polynomial, put: Mapping[int, fmpq_poly]) -> fmpq_poly:
            there = [put[place] if place in put else fmpq_poly([x]) for place, x in enumerate(at)]
            return evaluated(p, lambda place, power: there[place] ** power, lambda c: fmpq_poly([c]))

        eps = fmpq_poly([0, 1])
        put = {place: _lowered(value(x), shift) for place, x in images.items()} | {self.small: eps}
        rates = {place: value(x) for place, x in flow.rates.items()}
        residuals = []
        for place, (top, bottom) in self.rows.items():
            moved = fmpq_poly()
            for other, rate in rates.items():
                slope = images[place].derivative(other)
                if slope.coefficients:
                    moved += _lowered(value(slope), shift) * rate
            residuals.append(whole(bottom, put) * moved - whole(top, put) * eps**shift)
        for integral in flow.integrals:
            residuals.append(sum((value(integral.derivative(k)) * rate for k, rate in rates.items()), fmpq_poly()))
        orders = [next(k for k, c in enumerate(residual.coeffs()) if c != 0) for residual in residuals if residual != 0]
        return (min(orders) - shift if orders else None), None if known is None else known - shift


def _lowered(x: fmpq_poly, shift: int) -> fmpq_poly:
    """Without the factor eps^shift.  Raises NoClosedForm where it is none."""
    if any(c != 0 for c in x.coeffs()[:shift]):
        raise NoClosedForm("what is put in for variables grows without bound as the small parameter tends to 0")
    return fmpq_poly(x.coeffs()[shift:])


def _put(context: Any, images: Mapping[int, Series], known: int | None = None) -> Callable[[Series], Series]:
    """Puts series in place of generators."""
    on, functions = Composition(context, tuple(images)), tuple(images.values())
    return lambda x: on.of(x, functions, known) if functions else x.up_to(known)


def by_integrals(
    before: Reduction,
    unknown: Sequence[int],
    initial: Mapping[int, Series],
    constants: Sequence[Series],
    known: int | None,
) -> Reduction:
    """The ``unknown`` from as many integrals.

    With eps they are solved near the ``initial`` values of the variables; without, ``constants`` are the values of the
    integrals, which are linear in the unknown.  Raises NoClosedForm where no integrals determine them.
    """
    flow = before.flow
    at_first = _put(flow.context, initial)
    starts = None if known is None else [initial[place] for place in unknown]
    for chosen in combinations(flow.integrals, len(unknown)):
        values = [at_first(x) for x in chosen] if known is not None else constants
        rows = [x if flow.fixed else x - c for x, c in zip(chosen, values, strict=True)]
        solution = _implicit(flow.context, rows, unknown, starts, known)
        if solution is not None:
            images = dict(zip(unknown, solution, strict=True))
            put = _put(flow.context, images, known)
            fixed = known is not None
            others = (x for x in flow.integrals if not any(x is series for series in chosen))
            left = tuple(put(x - at_first(x) if fixed and not flow.fixed else x) for x in others)
            rates = {place: put(x) for place, x in flow.rates.items() if place not in images}
            return before.then(How.INTEGRALS, images, replace(flow, rates=rates, integrals=left, fixed=fixed))
    raise NoClosedForm(
        "no integrals determine these variables: near the initial values of variables with a power series, else linear "
        "equations are solved",
        remedy="end with O(eps**3) for a series in eps",
    )


def by_equations(before: Reduction, unknown: Sequence[int], of: Sequence[int], known: int | None) -> Reduction:
    """The ``unknown`` from the equations ``of`` as many variables, whose rates become variables."""
    flow = before.flow
    rows = [flow.rates[place] - flow.variable(flow.velocities[place]) for place in of]
    solution = _implicit(flow.context, rows, unknown, None, known)
    if solution is None:
        raise NoClosedForm("at the lowest order these equations are not linear in the variables, or singular")
    images = dict(zip(unknown, solution, strict=True))
    put = _put(flow.context, images, known)
    rates = {place: put(x) for place, x in flow.rates.items() if place not in (*unknown, *of)}
    for place in of:
        rates[place] = flow.variable(flow.velocities[place])
        rates[flow.velocities[place]] = put(flow.rate(flow.rates[place]))
    integrals = tuple(map(put, flow.integrals))
    return before.then(How.EQUATIONS, images, replace(flow, rates=rates, integrals=integrals))


def by_change(
    before: Reduction, replacements: Mapping[int, Series], new: Sequence[int], known: int | None
) -> Reduction:
    """Variables in terms of as many ``new`` ones; with their velocities where these are variables, too."""
    flow = before.flow
    second = [place for place in replacements if flow.velocities.get(place) in flow.rates]
    if len(new) != len(replacements) or second not in ([], list(replacements)):
        raise NoClosedForm("as many new variables as old ones are wanted, and those of second order apart from others")
    if any(x.derivative(place).coefficients for x in replacements.values() for place in flow.rates if place not in new):
        raise NoClosedForm("variables that stay cannot stand in what is put in for others")
    images = {place: x.up_to(known) for place, x in replacements.items()}
    moving = {place: flow.variable(flow.velocities[place]) for place in new}
    old, tops = list(replacements), list(new)
    if second:
        old, tops = [flow.velocities[place] for place in replacements], [flow.velocities[place] for place in new]
        images |= {
            v: replace(flow, rates=moving).rate(images[place]) for v, place in zip(old, replacements, strict=True)
        }
    put = _put(flow.context, images, known)
    rates = {place: put(x) for place, x in flow.rates.items() if place not in images} | (moving if second else {})
    lower = replace(flow, rates=rates)
    matrix = [[images[x].derivative(top) for top in tops] for x in old]
    right = [put(flow.rates[x]) - lower.rate(images[x]) for x in old]
    moved = dict(zip(tops, _linear(matrix, right, known), strict=True))
    integrals = tuple(map(put, flow.integrals))
    return before.then(How.CHANGE, images, replace(lower, rates=rates | moved, integrals=integrals))


def _implicit(
    context: Any, rows: Sequence[Series], unknown: Sequence[int], start: Sequence[Series] | None, known: int | None
) -> list[Series] | None:
    """The ``unknown`` from rows = 0, near ``start`` or linear; None where the lowest order does not determine them."""
    if any(row.lowest is None for row in rows):
        return None
    rows = [row.shifted(-(row.lowest or 0)).up_to(known) for row in rows]
    slopes = [[Series.constant(row.coefficient(0).derivative(place)) for place in unknown] for row in rows]
    if start is None and any(x.derivative(place).coefficients for line in slopes for x in line for place in unknown):
        return None
    solution = [Series(context) for _ in unknown] if start is None else list(start)
    put = _put(context, dict(zip(unknown, solution, strict=True)))
    if start is not None and any(put(Series.constant(row.coefficient(0))).coefficients for row in rows):
        return None
    slopes = [[put(x) for x in line] for line in slopes]
    for _ in range(MOST_ROUNDS):
        put = _put(context, dict(zip(unknown, solution, strict=True)), known)
        left = [put(row) for row in rows]
        if not any(x.coefficients for x in left):
            return [x if all(series.is_zero for series in left) else x.up_to(known) for x in solution]
        try:
            steps = _linear(slopes, left, known)
        except SingularPoint:
            return None
        solution = [(x - step).exactly() for x, step in zip(solution, steps, strict=True)]
    raise NoClosedForm("the coefficients do not settle", limit=Limit.WORK, remedy=LOWER)


def _linear(matrix: Sequence[Sequence[Series]], right: Sequence[Series], known: int | None) -> list[Series]:
    """matrix^-1 right, by elimination.  Raises SingularPoint."""
    rows = [[*line, x] for line, x in zip(matrix, right, strict=True)]
    for k in range(len(rows)):
        rest = [row for row in rows[k:] if row[k].coefficients]
        if not rest:
            raise SingularPoint("the variables are not determined: a determinant vanishes")
        pivot = min(rest, key=lambda row: (row[k].lowest, len(row[k].coefficients)))
        unit = [x.over(pivot[k], known) for x in pivot]
        others = [row for row in rows if row is not pivot]
        others = [
            [x - row[k] * y for x, y in zip(row, unit, strict=True)] if row[k].coefficients else row for row in others
        ]
        rows = [*others[:k], unit, *others[k:]]
    return [row[-1] for row in rows]
