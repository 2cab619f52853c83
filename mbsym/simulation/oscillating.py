"""How far a periodic solution in powers of a small parameter is from the motion itself: measured, at parts of eps.

Both begin in the state that the series has at T = 0.  Equations in speeds are integrated by Taylor series in balls of
many bits; a system in coordinates is simulated, so that its Taylor field is put to the test, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, log, pi
from typing import Any

from flint import arb, arb_series, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.tower import Element, angle_in
from mbsym.analysis.oscillating import Oscillating
from mbsym.expressions.tree import Expression, number
from mbsym.model.system import System, velocity_name
from mbsym.numerics.scenario import Scenario, exact, scenario
from mbsym.numerics.states import scenario_in_states
from mbsym.problems.small_parameter.oscillations import AMPLITUDE
from mbsym.problems.small_parameter.result import Amplitude, Harmonics
from mbsym.simulation.request import Request
from mbsym.simulation.run import simulate

#: Parts of the given eps, and states that are compared over one period.
PARTS = tuple(Fraction(1, 2**k) for k in range(6))
ROWS, BITS, TAYLOR = 24, 200, 24
#: Errors below, in parts of the variable's size, are rounding of the simulation.
NOISE_OF_A_RUN, NOISE_OF_BALLS = 1e-10, 1e-40
TOLERANCE = 1e-13


@dataclass(frozen=True)
class MeasuredOrders:
    """``errors[v][k]``: the largest |x_v - X_v| over one period at eps times ``parts[k]``, in scaled variables.

    ``relative[k]``: the largest of them as parts of max |X_v|, but for the ``unmoved``, which the series sets to zero;
    infinite where no motion was found.  ``orders``: log2 of the ratio of the last two errors of each variable that
    rounding leaves, at ``parts[k]`` and ``parts[k + 1]`` with k from ``halved``; None where there are none.  The
    expansion to order n is right where they are about n + 1, or more.
    """

    small: float
    time: float
    parts: tuple[Fraction, ...]
    names: tuple[str, ...]
    errors: tuple[tuple[float, ...], ...]
    relative: tuple[float, ...]
    unmoved: tuple[str, ...]
    orders: tuple[float | None, ...]
    halved: tuple[int, ...]
    simulated: bool


def measured_orders(
    system: System,
    solution: Oscillating,
    values: Mapping[str, Fraction] | None = None,
    watch: Callable[[str], None] = lambda what: None,
) -> MeasuredOrders:
    """Numbers of the description, but for ``values`` of parameters and of symbols of the result, which it holds.

    Raises Incomplete where some are missing, NoClosedForm where nothing oscillates.
    """
    put = {name: number(x) for name, x in (values or {}).items() if name in system.parameter_names}
    base = scenario(system, put)
    oscillation = solution.oscillation
    parameters = {name: Fraction(value) for name, value in base.parameters.items()}
    powers = dict(oscillation.powers)
    whole = parameters[oscillation.small] if oscillation.small in solution.field.parameters else Fraction(1)
    symbols = symbol_values(base, solution, powers, whole, values or {})
    errors: list[list[float]] = [[] for _ in oscillation.names]
    sizes: list[list[float]] = [[] for _ in oscillation.names]
    time = 0.0
    simulated = not system.speeds
    for part in PARTS:
        eps = whole * part
        watch(f"{oscillation.small}/{part.denominator}")
        numbers = {name: value * part ** powers.get(name, 0) for name, value in parameters.items()}
        if oscillation.small in numbers:
            numbers[oscillation.small] = eps
        series = Numeric(solution, parameters | symbols, eps)
        time = 2 * pi / abs(series.rate)  # a root in the frequency may stand above what is negative
        times = [time * k / ROWS for k in range(1, ROWS + 1)]
        try:
            if simulated:
                rows = _simulated(system, put, base, solution, numbers, powers, series, times, whole, part)
            else:
                start = [series.at(0.0, name) * series.eps ** powers.get(name, 0) for name in oscillation.names]
                rows = _integrated(solution.field, oscillation.names, numbers, start, times)
        except (Failure, ArithmeticError, ValueError):
            if part in PARTS[-2:]:  # those that orders are told by
                raise
            rows = []  # eps as it is given may be far too large for the series
        for place, name in enumerate(oscillation.names):
            unit = series.eps ** powers.get(name, 0)
            with ctx.workprec(BITS):
                waves = [series.at(t, name) for t in times]
                away = [abs(row[place] / unit - x) for row, x in zip(rows, waves, strict=bool(rows))]
                sizes[place].append(max(abs(float(x.mid())) for x in waves))
            errors[place].append(max((_number(x) for x in away), default=inf))
    noise = NOISE_OF_A_RUN if simulated else NOISE_OF_BALLS
    extents = [max(size) for size in sizes]
    moved = [k for k, extent in enumerate(extents) if extent > NOISE_OF_BALLS * max(extents)]
    least = min(extents[k] for k in moved)
    levels = [noise * max(extent, least) for extent in extents]
    orders, halved = zip(*map(_order, errors, levels), strict=True)
    relative = tuple(max(errors[v][k] / sizes[v][k] for v in moved) for k in range(len(PARTS)))
    unmoved = tuple(name for k, name in enumerate(oscillation.names) if k not in moved)
    return MeasuredOrders(
        float(whole), time, PARTS, oscillation.names, tuple(map(tuple, errors)), relative,
        unmoved, orders, halved, simulated,
    )  # fmt: skip


def _number(x: Any) -> float:
    """The midpoint of a ball; infinity where it is not finite."""
    return float(x.mid()) if x.is_finite() else inf


def _order(errors: Sequence[float], noise: float) -> tuple[float | None, int]:
    """The power by which a halving makes an error smaller, and the place in ``errors`` from which it is halved.

    It is the last halving before which and after which there is more than rounding; None where there is none.
    """
    places = [k for k in range(len(errors) - 1) if inf > max(errors[k : k + 2]) and min(errors[k : k + 2]) > noise]
    if places:
        return log(errors[places[-1]] / errors[places[-1] + 1], 2), places[-1]
    last = len(errors) - 2
    return (log(noise / errors[-1], 2) if errors[-1] > noise else None), last


def symbol_values(
    base: Scenario, solution: Oscillating, powers: Mapping[str, int], eps: Fraction, put: Mapping[str, Fraction]
) -> dict[str, Fraction]:
    """The amplitude and the constants that belong to the initial state, by their symbols in the tower.

    Raises NoClosedForm where an amplitude is needed, not ``put`` in, and zero.
    """
    oscillation = solution.oscillation
    if len(oscillation.phases) > 1:
        raise NoClosedForm("a motion with several phases is not compared with runs")
    if base.system.speeds:
        seen = scenario_in_states(base)
        state = dict(zip((*seen.system.coordinates, *seen.system.velocities), seen.state, strict=True))
    else:
        state = dict(zip((*base.system.coordinates, *base.system.velocities), base.state, strict=True))
        for name, value in on_the_motion(base.system, solution, base).items():
            state[name] -= value
    scaled = {name: Fraction(value) / eps ** powers.get(name, 0) for name, value in state.items()}
    values = {f"#{name}": scaled[name] for name, _ in oscillation.constants if name in scaled}
    values[AMPLITUDE] = scaled[oscillation.leading]
    if not oscillation.centre.is_zero():
        numbers = {name: Fraction(value) for name, value in base.parameters.items()}
        centre = Numeric(solution, numbers, eps).value(oscillation.centre)
        away = rationals.ball(values[AMPLITUDE]) - centre
        values[AMPLITUDE] = Fraction(0) if away.contains(0) else rationals.fraction(rationals.middle(away))
    needed = oscillation.kind is Amplitude.FREE and solution.symbols.get(AMPLITUDE) not in put
    if needed and values[AMPLITUDE] == 0:
        text = "[[name]] begins at the centre of the oscillation: the initial state gives no amplitude"
        raise NoClosedForm(text, name=oscillation.leading)
    return values


def on_the_motion(system: System, solution: Oscillating, base: Scenario) -> dict[str, Fraction]:
    """What deviations are of: coordinates and velocities on the unperturbed motion; nothing where none is asked for."""
    reference: dict[str, Fraction] = {}
    for entry in system.motion if solution.taylor else ():
        reference[entry.coordinate] = value_of(entry.value, base)
        reference[velocity_name(entry.coordinate)] = value_of(entry.rate, base)
    return reference


def value_of(x: Expression, base: Scenario) -> Fraction:
    """An expression in parameters at their numbers."""
    return exact(x, base.parameters)


class Numeric:
    """The series at numbers, in balls."""

    def __init__(self, told: Oscillating, values: Mapping[str, Fraction], eps: Fraction) -> None:
        self.oscillation, tower = told.oscillation, told.oscillation.tower
        balls = {name: rationals.ball(x) for name, x in values.items()}
        plain = [name for name in tower.parameters if angle_in(name) is None]
        self._values = dict.fromkeys(plain, arb(0)) | balls
        self.eps = rationals.ball(eps)
        with ctx.workprec(BITS):
            speed = sum(
                (self.value(x) * self.eps ** (k + 1) for k, x in enumerate(self.oscillation.corrections)), arb(1)
            )
            speed = speed * self.value(self.oscillation.frequency)
            self.waves = {
                name: self._summed(series)
                for name, series in zip(self.oscillation.names, self.oscillation.series, strict=True)
            }
        self.speed, self.rate = speed, float(speed)

    def value(self, x: Element) -> Any:
        """A ball."""
        return self.oscillation.tower.enclosed(x, self._values).real

    def _summed(self, series: Sequence[Harmonics]) -> dict[int, tuple[Any, Any]]:
        total: dict[int, tuple[Any, Any]] = {}
        for n, harmonics in enumerate(series):
            for k, (c, s) in harmonics.waves.items():
                a, b = total.get(k, (arb(0), arb(0)))
                total[k] = (a + self.value(c) * self.eps**n, b + self.value(s) * self.eps**n)
        return total

    def at(self, time: float, name: str) -> Any:
        with ctx.workprec(BITS):
            phase = self.speed * arb(time)
            return sum(
                (c * (k * phase).cos() + s * (k * phase).sin() for k, (c, s) in self.waves[name].items()), arb(0)
            )

    def over(self, times: Any, name: str) -> Any:
        """x and x' at many times, shape (2, m), in double precision."""
        import numpy as np

        phase, values = self.rate * times, np.zeros((2, len(times)))
        for k, pair in self.waves[name].items():
            c, s = (float(x.mid()) for x in pair)
            values[0] += c * np.cos(k * phase) + s * np.sin(k * phase)
            values[1] += k * self.rate * (s * np.cos(k * phase) - c * np.sin(k * phase))
        return values


def _simulated(
    system: System,
    put: Mapping[str, Expression],
    base: Scenario,
    solution: Oscillating,
    numbers: Mapping[str, Fraction],
    powers: Mapping[str, int],
    series: Numeric,
    times: Sequence[float],
    whole: Fraction,
    part: Fraction,
) -> list[list[Any]]:
    """Rows of the variables of the result."""
    import numpy as np

    eps = whole * part
    changed = {solution.oscillation.small, *powers}
    chosen = {**put, **{name: number(x) for name, x in numbers.items() if name in changed}}
    shift = on_the_motion(system, solution, base)
    start = {}
    if system.constraints:  # what they tie begins near the motion, on the branch that is expanded
        chosen |= {name: number(value) for name, value in shift.items()}
    for name in solution.oscillation.names:
        start[name] = Fraction(float(series.at(0.0, name))) * eps ** powers.get(name, 0)
        chosen[name] = number(start[name] + shift.get(name, 0))
    fixed = solution.oscillation.names if system.constraints else ()
    request = Request(time=times[-1], samples=len(times) + 1, estimate=False, tolerance=TOLERANCE, fixed=tuple(fixed))
    run = simulate(scenario(system, chosen), request)
    if not run.whole:
        raise NoClosedForm("the motion ends early")
    columns = {
        name: np.asarray(run.coordinates)[k] - float(shift.get(name, 0)) for k, name in enumerate(system.coordinates)
    }
    columns |= {
        name: np.asarray(run.velocities)[k] - float(shift.get(name, 0)) for k, name in enumerate(system.velocities)
    }
    return [[arb(float(columns[name][k])) for name in solution.oscillation.names] for k in range(1, len(times) + 1)]


def _integrated(
    field: PolynomialField,
    names: Sequence[str],
    numbers: Mapping[str, Fraction],
    start: Sequence[Any],
    times: Sequence[float],
) -> list[list[Any]]:
    """The field by Taylor series, from one time to the next; variables that no equation needs are left out."""
    values = [numbers.get(name) for name in field.parameters]
    parts = []
    for p in (field.denominator, *(field.numerators[field.variables.index(name)] for name in names)):
        terms: dict[tuple[int, ...], Any] = {}
        for monomial, c in p.to_dict().items():
            for value, e in zip(values, monomial, strict=False):
                if e:
                    assert value is not None
                    c = c * rationals.exact(value) ** int(e)
            exponents = dict(zip(field.variables, monomial[len(values) :], strict=True))
            key = tuple(int(exponents[name]) for name in names)
            terms[key] = terms.get(key, 0) + c
        parts.append([(key, fmpq(c)) for key, c in terms.items()])
    with ctx.workprec(BITS):
        state, now, rows = [arb(x) for x in start], 0.0, []
        for t in times:
            state = _step(parts, state, arb(t) - arb(now))
            state, now = [x.mid() for x in state], t
            rows.append(state)
    return rows


def _step(parts: Sequence[Any], state: Sequence[Any], step: Any) -> list[Any]:
    """Picard's iteration on power series of t, a coefficient more each time."""
    known = [[x] for x in state]
    before = ctx.cap
    try:
        for length in range(1, TAYLOR):
            ctx.cap = length
            series = [arb_series(x) for x in known]
            below, *above = [_polynomial(terms, series) for terms in parts]
            for place, numerator in enumerate(above):
                rate = numerator / below
                known[place].append(rate[length - 1] / length)
    finally:
        ctx.cap = before
    return [_horner(x, step) for x in known]


def _horner(coefficients: Sequence[Any], x: Any) -> Any:
    total = arb(0)
    for c in reversed(coefficients):
        total = total * x + c
    return total


def _polynomial(terms: Sequence[Any], series: Sequence[Any]) -> Any:
    total = arb_series([0])
    for key, c in terms:
        term = arb_series([arb(c)])
        for factor, e in zip(series, key, strict=True):
            for _ in range(e):
                term = term * factor
        total = total + term
    return total
