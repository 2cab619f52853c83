"""The second route of expansions: series put whole into the field itself, at random rational states."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.quotients import Quotient, Series
from mbsym.algebra.tower import MOST_ROOTS, Element
from mbsym.problems.small_parameter.result import Harmonics, Oscillation, ScaledField

#: Numerators and denominators of the random states.
_SIZE = 40


def residual_orders(
    there: ScaledField, fast: Sequence[str], functions: Sequence[Series], seed: int = 1
) -> tuple[int | None, ...]:
    """The lowest order of eps in eps^k_i (N_i - sum_j dh_i/ds_j N_j), z = h cut off, for each fast variable.

    The numerators are those of ``there.field``, not sorted by powers of eps; parameters and slow variables are random
    rationals, eps is the variable of polynomials in one variable, which are multiplied out exactly.  None: nothing is
    left.
    """
    field, random = there.field, Random(seed)
    names = field.context.names()
    weights = dict(there.powers)
    if there.small in names:
        weights[there.small] = 1
    values = {
        name: fmpq(1) if name == there.small else fmpq(random.randint(2, _SIZE), random.randint(2, _SIZE))
        for name in names
    }
    at = [values[name] for name in names]
    series = dict(zip(fast, (_polynomial(function, at) for function in functions), strict=True))
    shift = max(
        (
            -sum(weights.get(n, 0) * int(e) for n, e in zip(names, m, strict=True))
            for p in field.numerators
            for m in p.monoms()
        ),
        default=0,
    )
    shift = max(0, shift)

    def whole(p: Any) -> fmpq_poly:
        total = fmpq_poly()
        for monomial, c in p.to_dict().items():
            term, order = fmpq_poly([c]), shift
            for name, exponent in zip(names, monomial, strict=True):
                if not exponent:
                    continue
                order += weights.get(name, 0) * int(exponent)
                term = term * (series[name] if name in series else values[name]) ** exponent
            total += term * fmpq_poly([0, 1]) ** order
        return total

    rows = {name: whole(p) for name, p in zip(field.variables, field.numerators, strict=True)}
    least = min(
        sum(weights.get(n, 0) * int(e) for n, e in zip(names, m, strict=True)) for m in field.denominator.monoms()
    )
    orders: list[int | None] = []
    for name, function in zip(fast, functions, strict=True):
        rest = rows[name]
        for other in field.variables:
            if other not in fast:
                place = names.index(other)
                slope = Series(
                    function.context,
                    {k: d for k, c in function.coefficients.items() if not (d := c.derivative(place)).is_zero},
                )
                rest -= _polynomial(slope, at) * rows[other]
        scale = there.scales[field.variables.index(name)]
        order = next((k for k, c in enumerate(rest.coeffs()) if c != 0), None)
        orders.append(None if order is None else order - shift - least + scale)
    return tuple(orders)


def _polynomial(series: Series, at: Sequence[fmpq]) -> fmpq_poly:
    top = max(series.coefficients, default=-1)
    return fmpq_poly([_value(series.coefficients[k], at) if k in series.coefficients else 0 for k in range(top + 1)])


def _value(x: Quotient, at: Sequence[fmpq]) -> fmpq:
    return x.top(*at) / x.bottom(*at)


# The second route of oscillations: the series put whole into the equations, with polynomials in eps, cos T and sin T.
#
# Parameters are random rationals; square roots, sin T and cos T are generators of a polynomial ring over QQ with their
# relations, and everything is multiplied out exactly.  Nothing of the way by which the series were found is used.


_SMALL = 20
MOST_SEEDS = 8


class Numbers:
    """Elements of a tower at random rational parameters, in QQ[roots][eps, s, c] modulo the relations."""

    def __init__(self, found: Oscillation, seed: int) -> None:
        self.tower, random = found.tower, Random(seed)
        names = [f"r{k}" for k in reversed(range(len(self.tower.squares)))]
        self.context: Any = fmpq_mpoly_ctx.get([*names, "eps", "s", "c"], Ordering.lex)
        gens = self.context.gens()
        self.roots, (self.eps, self.sine, self.cosine) = gens[: len(names)][::-1], gens[len(names) :]
        self.values = [fmpq(random.randint(2, _SMALL), random.randint(2, _SMALL)) for _ in self.tower.parameters]
        self.relations = [self.sine**2 + self.cosine**2 - 1]
        for root, square in zip(self.roots, self.tower.squares, strict=True):
            self.relations.append(root**2 - self._of(square))

    def reduced(self, p: Any) -> Any:
        for relation in reversed(self.relations):
            p = divmod(p, relation)[1]
        return p

    def _of(self, p: Any) -> Any:
        images = [*self.roots[::-1], *map(self.context.constant, self.values)]
        absent = [self.context.constant(0)] * (MOST_ROOTS - len(self.roots))
        return p.compose(*absent, *images, ctx=self.context)

    def __call__(self, x: Element) -> Any:
        bottom = self._of(x.bottom)
        return self.reduced(self._of(x.top)) / bottom.leading_coefficient()

    def wave(self, harmonics: Harmonics) -> Any:
        """cos k T = T_k(c), sin k T = s U_(k-1)(c)."""
        total = self.context.constant(0)
        for k, (c, s) in harmonics.waves.items():
            first, second = _chebyshev(self.context.constant(1), self.cosine, k)
            total = total + self(c) * first + self(s) * self.sine * second
        return total

    def series(self, parts: Sequence[Harmonics]) -> Any:
        return sum((self.wave(part) * self.eps**n for n, part in enumerate(parts)), self.context.constant(0))

    def slope(self, p: Any) -> Any:
        """d/dT."""
        place = len(self.roots) + 1
        return p.derivative(place) * self.cosine - p.derivative(place + 1) * self.sine


def _chebyshev(unit: Any, x: Any, k: int) -> tuple[Any, Any]:
    """T_k and U_(k-1)."""
    first, second = [unit, x], [unit * 0, unit]
    while len(first) <= k:
        first.append(2 * x * first[-1] - first[-2])
        second.append(2 * x * second[-1] - second[-2])
    return first[k], second[k]


def oscillation_orders(
    rows: Any, names: Sequence[str], oscillation: Oscillation, seed: int = 1
) -> tuple[int | None, ...]:
    """The lowest order of eps in f(X) - omega (1 + eps nu_1 + ...) X'(T) for each variable of the solution, then its
    drifting ones.  None: nothing is left."""
    try:
        numbers = Numbers(oscillation, seed)
        speed = _speed(numbers, oscillation)
        series = _all_series(numbers, oscillation)
    except ZeroDivisionError:  # a denominator vanishes at these numbers
        if seed > MOST_SEEDS:
            raise
        return oscillation_orders(rows, names, oscillation, seed + 1)
    context, eps = numbers.context, numbers.eps
    rates = {}
    for drift in oscillation.drifts:
        series[drift.variable] = numbers.series(drift.waves)
        rates[drift.variable] = sum((numbers(x) * eps**n for n, x in enumerate(drift.rates)), context.constant(0))
    powers: dict[tuple[str, int], Any] = {}

    def power(name: str, exponent: int) -> Any:
        if (name, exponent) not in powers:
            lower = power(name, exponent - 1) * series[name] if exponent > 1 else series[name]
            powers[name, exponent] = numbers.reduced(lower)
        return powers[name, exponent]

    result: list[int | None] = []
    for name in (*oscillation.names, *rates):
        left = numbers.slope(series[name]) * speed + rates.get(name, 0)
        for k, terms in rows[names.index(name)].items():
            for exponents, c in terms.items():
                term = numbers(c) * eps**k
                for other, e in zip(names, exponents, strict=True):
                    if e:
                        term = numbers.reduced(term * power(other, e))
                left = left - term
        left = numbers.reduced(left)
        place = len(numbers.roots)
        result.append(min((int(m[place]) for m in left.to_dict()), default=None))
    return tuple(result)


def _speed(numbers: Numbers, oscillation: Oscillation) -> Any:
    """omega (1 + eps nu_1 + ...)."""
    zero = numbers.context.constant(0)
    shifts = sum((numbers(x) * numbers.eps ** (k + 1) for k, x in enumerate(oscillation.corrections)), zero)
    return numbers(oscillation.frequency) * (1 + shifts)


def _all_series(numbers: Numbers, oscillation: Oscillation) -> dict[str, Any]:
    return {
        name: numbers.series(harmonics) for name, harmonics in zip(oscillation.names, oscillation.series, strict=True)
    }
