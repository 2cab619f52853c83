"""The first approximation on a slow manifold about a steady state, and whether the manifold attracts there.

With A the matrix of all variables and A_s(eps) that of the flow on the manifold, det(S - A_s) divides det(S - A): the
quotient belongs to the fast variables.  Its coefficients are found as series in eps by division; what remains must be
of higher order than the expansion, which checks both.  By Hurwitz all roots of a polynomial have negative real parts if
all leading minors D_1, ..., D_n are positive, so that for all sufficiently small eps > 0 their first coefficients
decide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mbsym.algebra import matrices
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import determinant_by_traces, faddeev
from mbsym.algebra.quotients import Quotient, Series
from mbsym.problems.small_parameter.result import Hurwitz, ScaledField, SteadyStates
from mbsym.problems.small_parameter.root import put

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

    for name, one in flow.items():
        if on(one).coefficients:
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
    for one in rest:
        if one.coefficients:
            raise NoClosedForm("the roots of the flow on the manifold are none of the system: the expansion is wrong")
    remainder = min((one.known for one in rest if one.known is not None), default=order + 1)
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
