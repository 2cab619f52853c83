"""The second route of expansions: series put whole into the field itself, at random rational states."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.quotients import Quotient, Series
from mbsym.problems.small_parameter.result import ScaledField

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
    series = dict(zip(fast, (_polynomial(one, at) for one in functions), strict=True))
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
    found: list[int | None] = []
    for name, one in zip(fast, functions, strict=True):
        rest = rows[name]
        for other in field.variables:
            if other not in fast:
                place = names.index(other)
                slope = Series(
                    one.context, {k: d for k, c in one.coefficients.items() if not (d := c.derivative(place)).is_zero}
                )
                rest -= _polynomial(slope, at) * rows[other]
        scale = there.scales[field.variables.index(name)]
        order = next((k for k, c in enumerate(rest.coeffs()) if c != 0), None)
        found.append(None if order is None else order - shift - least + scale)
    return tuple(found)


def _polynomial(one: Series, at: Sequence[fmpq]) -> fmpq_poly:
    top = max(one.coefficients, default=-1)
    return fmpq_poly([_value(one.coefficients[k], at) if k in one.coefficients else 0 for k in range(top + 1)])


def _value(x: Quotient, at: Sequence[fmpq]) -> fmpq:
    return x.top(*at) / x.bottom(*at)
