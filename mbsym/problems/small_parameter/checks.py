"""The second route of expansions: series put whole into the field itself, at random rational states."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpq_poly

from mbsym.algebra.quotients import Quotient, Series
from mbsym.algebra.tower import MOST_ROOTS, Element
from mbsym.problems.small_parameter.result import Harmonics, Oscillation, Phase, ScaledField, multiples

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


# The second route of oscillations: the series put whole into the equations, with polynomials in eps, and in the cosine
# and sine of every phase.
#
# Parameters are random rationals; square roots, sin T and cos T are generators of a polynomial ring over QQ with their
# relations, and everything is multiplied out exactly.  Nothing of the way by which the series were found is used.


_SMALL = 20
MOST_SEEDS = 8


class Numbers:
    """Elements of a tower at random rational parameters, in QQ[roots][eps, s, c, ...] modulo the relations."""

    def __init__(self, found: Oscillation, seed: int) -> None:
        self.tower, random = found.tower, Random(seed)
        names = [f"r{k}" for k in reversed(range(len(self.tower.squares)))]
        waves = [f"{wave}{k}" for k in range(len(found.phases)) for wave in "sc"]
        self.context: Any = fmpq_mpoly_ctx.get([*names, "eps", *waves], Ordering.lex)
        gens = self.context.gens()
        self.roots, (self.eps, *turning) = gens[: len(names)][::-1], gens[len(names) :]
        self.phases = list(zip(turning[::2], turning[1::2], strict=True))  # sines and cosines
        self.values = [fmpq(random.randint(2, _SMALL), random.randint(2, _SMALL)) for _ in self.tower.parameters]
        self.relations = [sine**2 + cosine**2 - 1 for sine, cosine in self.phases]
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
        """cos k T = T_k(c), sin k T = s U_(k-1)(c), and those of sums of such."""
        total = self.context.constant(0)
        for k, (c, s) in harmonics.waves.items():
            even, odd = self.context.constant(1), self.context.constant(0)
            for turns, (sine, cosine) in zip(multiples(k, len(self.phases)), self.phases, strict=True):
                first, second = _chebyshev(self.context.constant(1), cosine, abs(turns))
                second = second * sine * (1 if turns > 0 else -1)
                even, odd = even * first - odd * second, odd * first + even * second
            total = total + self(c) * even + self(s) * odd
        return self.reduced(total)

    def series(self, parts: Sequence[Harmonics]) -> Any:
        return sum((self.wave(part) * self.eps**n for n, part in enumerate(parts)), self.context.constant(0))

    def slope(self, p: Any, speeds: Sequence[Any]) -> Any:
        """sum of T_j' dp/dT_j."""
        total = self.context.constant(0)
        for k, (speed, (sine, cosine)) in enumerate(zip(speeds, self.phases, strict=True)):
            place = len(self.roots) + 1 + 2 * k
            total = total + (p.derivative(place) * cosine - p.derivative(place + 1) * sine) * speed
        return total


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
    """The lowest order of eps in f(X) - sum_j omega_j (1 + eps nu_j1 + ...) dX/dT_j for each variable of the solution,
    then its drifting ones.  None: nothing is left."""
    try:
        numbers = Numbers(oscillation, seed)
        speeds = [_speed(numbers, phase) for phase in oscillation.phases]
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
        left = numbers.slope(series[name], speeds) + rates.get(name, 0)
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


def _speed(numbers: Numbers, phase: Phase) -> Any:
    """omega (1 + eps nu_1 + ...)."""
    zero = numbers.context.constant(0)
    shifts = sum((numbers(x) * numbers.eps ** (k + 1) for k, x in enumerate(phase.corrections)), zero)
    return numbers(phase.frequency) * (1 + shifts)


def _all_series(numbers: Numbers, oscillation: Oscillation) -> dict[str, Any]:
    return {
        name: numbers.series(harmonics) for name, harmonics in zip(oscillation.names, oscillation.series, strict=True)
    }
