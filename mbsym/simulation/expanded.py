"""How far the flow on a slow manifold, or an averaged motion, is from the motion itself: at eps and at parts of it.

The motion of all equations (a tight simulation, from the bodies) starts on the manifold, z(0) = h(s(0), eps); the flow
s' = f(s, eps), cut off after the order of the expansion, starts at the same s(0).  Their largest distance over a fixed
time should shrink like eps^(order + 1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import log, pi, sqrt
from typing import Any

import numpy as np
from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.quotients import Series
from mbsym.analysis.expanding import Expansion
from mbsym.expressions.tree import Expression, number
from mbsym.model.system import System, velocity_name
from mbsym.numerics.closing import closed
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.states import scenario_in_states
from mbsym.problems.small_parameter.averaging import Averaged
from mbsym.simulation.request import Request
from mbsym.simulation.run import simulate

Floats = Any  # arrays of float64
Flow = Callable[[Floats], Floats]
Evaluated = Callable[[Floats], float]

#: Rows in which the two motions are compared, and eps in parts of that of the given numbers.
ROWS, PARTS = 201, (Fraction(1), Fraction(1, 2), Fraction(1, 4))
#: Of both integrations.
TOLERANCE = 1e-12
#: Distances below are those of the integrations, not of the expansion.
LEAST = 1e-10
#: So many times the shortest time in which the flow at the beginning changes.
SPAN = 10.0
#: Differences are taken over this part of a variable's size.
STEP = 1e-6


class NotMeasured(Exception):
    """Why there is no measurement."""


@dataclass(frozen=True)
class Measured:
    """``distances`` at ``parts`` of the given eps: the largest |s - S| over ``time``, in units of the largest |S|; S is
    the motion by the expansion, or the averaged one.

    ``orders`` are log2 of their ratios, about ``expected`` where the expansion is right and eps small.
    """

    time: float
    parts: tuple[Fraction, ...]
    distances: tuple[float, ...]
    expected: int = 1

    @property
    def exact(self) -> bool:
        """Whether the distances are no larger than the errors of the integrations."""
        return self.distances[0] < LEAST

    @property
    def orders(self) -> tuple[float, ...]:
        """As far as the distances are not those of the integrations."""
        pairs = zip(self.distances, self.distances[1:], strict=False)
        return tuple(log(a / b, 2) for a, b in pairs if b > LEAST)


def measured(
    system: System,
    expansion: Expansion,
    time: float | None = None,
    values: Mapping[str, Fraction] | None = None,
    watch: Callable[[str], None] = lambda what: None,
) -> Measured:
    """Both motions from the initial state of the description, its fast variables put onto the manifold.

    Raises Incomplete where numbers are missing, NotMeasured where motions end early, or nothing changes.
    """
    assert system.small is not None
    overrides: dict[str, Expression] = {name: number(value) for name, value in (values or {}).items()}
    begins = scenario(system, overrides, declared=True)
    base = scenario_in_states(begins) if system.speeds else closed(begins).scenario
    names = (*base.system.coordinates, *base.system.velocities)
    start = {name: Fraction(float(value)) for name, value in zip(names, base.state, strict=True)}
    manifold = expansion.manifold
    scales = dict(system.small.powers) or {system.small.name: 1}
    distances: list[float] = []
    for part in PARTS:
        watch(f"eps/{part.denominator}" if part != 1 else "eps")
        scaled = {name: number(base.parameters[name] * part**power) for name, power in scales.items()}
        own = scenario(system, overrides | scaled, declared=True)
        eps = part * (Fraction(1) if system.small.powers else base.parameters[system.small.name])
        here = _Numbers(expansion, base.parameters, eps)
        flow, first = here.flow(), [start[name] for name in manifold.slow]
        begun = start | dict(zip(manifold.fast, here.on_manifold(first), strict=True))
        if time is None:
            time = _span(flow, np.array(first, dtype=float))
        if system.speeds:
            own = replace(own, declared=tuple(begun[name] for name in names))
        else:
            own = scenario(system, overrides | scaled | {name: number(x) for name, x in begun.items()})
        told = {*manifold.slow, *manifold.fast} if system.constraints and not system.speeds else set()
        fixed = [x for x in names if x in told and (x in system.velocities or velocity_name(x) in told)]
        whole = _whole(own, time, manifold.slow, fixed)
        reduced = _reduced(flow, np.array(first, dtype=float), time)
        size = np.abs(reduced).max(axis=1)
        size[size == 0] = 1.0
        distances.append(float((np.abs(whole - reduced).max(axis=1) / size).max()))
    assert time is not None
    return Measured(time, PARTS, tuple(distances), manifold.order + 1)


class _Numbers:
    """The series of an expansion at numbers for its parameters, and eps."""

    def __init__(self, found: Expansion, values: Mapping[str, Fraction], eps: Fraction) -> None:
        self.expansion, self.eps = found, eps
        field, root = found.manifold.field.field, found.manifold.root
        names = [root.instead if root is not None and name == root.label else name for name in found.names]
        self.places = [names.index(name) for name in found.manifold.slow]
        self.known = [
            rationals.exact(values[name]) if name in values and name not in field.variables else None for name in names
        ]

    def _at(self, s: Sequence[Fraction]) -> list[fmpq]:
        """Numbers for all generators, the square root to double precision; those of fast variables are not used."""
        at = [fmpq(0) if x is None else x for x in self.known]
        for place, x in zip(self.places, s, strict=True):
            at[place] = rationals.exact(x)
        root = self.expansion.manifold.root
        if root is not None:
            square = rationals.fraction(root.square(*at))
            if square < 0:
                raise NotMeasured("the manifold is not real at the initial state")
            at[root.place] = rationals.exact(Fraction(sqrt(square)))
        return at

    def on_manifold(self, s: Sequence[Fraction]) -> list[Fraction]:
        """h(s, eps), exactly but for its square root."""
        at = self._at(s)
        total = []
        for function in self.expansion.manifold.functions:
            value = fmpq(0)
            for k, c in function.coefficients.items():
                value += c.top(*at) / c.bottom(*at) * rationals.exact(self.eps) ** k
            total.append(rationals.fraction(value))
        return total

    def flow(self) -> Flow:
        """s -> s', in floating point, cut off after the order of the expansion."""
        rows = [self._row(series) for series in self.expansion.manifold.flow]
        root = self.expansion.manifold.root
        if root is None:
            return lambda s: np.array([sum(top(s) / bottom(s) for top, bottom in row) for row in rows])
        square = self._polynomial(root.square, Fraction(1), None)

        def moved(s: Floats) -> Floats:
            s = np.append(s, np.sqrt(square(np.append(s, 0.0))))
            return np.array([sum(top(s) / bottom(s) for top, bottom in row) for row in rows])

        return moved

    def _row(self, series: Series) -> list[tuple[Evaluated, Evaluated]]:
        root = self.expansion.manifold.root
        place = None if root is None else root.place
        return [
            (self._polynomial(c.top, self.eps**k, place), self._polynomial(c.bottom, Fraction(1), place))
            for k, c in series.coefficients.items()
        ]

    def _polynomial(self, p: Any, factor: Fraction, root: int | None) -> Evaluated:
        """Of the slow variables, and of the square root behind them, which stands at the place ``root``."""
        exponents, numbers = [], []
        for monomial, c in p.to_dict().items():
            value = c * rationals.exact(factor)
            for k, (x, e) in enumerate(zip(self.known, monomial, strict=True)):
                value = value * x ** int(e) if x is not None and e and k != root else value
            powers = [int(monomial[place]) if place != root else 0 for place in self.places]
            if self.expansion.manifold.root is not None:
                powers.append(0 if root is None else int(monomial[root]))
            exponents.append(powers)
            numbers.append(int(value.p) / int(value.q))
        table, factors = np.array(exponents), np.array(numbers)
        return lambda s: float(factors @ np.prod(s**table, axis=1))


def _span(flow: Flow, s: Floats) -> float:
    """How long: some multiple of 1/max |eigenvalue of df/ds| at the beginning, whatever the units; in two digits.

    Where all eigenvalues vanish, of 1/|df/ds| for variables in parts of their sizes.
    """
    sizes = np.where(s != 0, np.abs(s), np.max(np.abs(s), initial=0.0) or 1.0)
    with np.errstate(all="ignore"):
        columns = [(flow(s + d) - flow(s - d)) / (2 * STEP) for d in np.diag(STEP * sizes)]
        slopes, rates = np.array(columns) / sizes, np.abs(flow(s)) / sizes
    if not np.isfinite(slopes).all():
        raise NotMeasured("the flow on the manifold has no derivatives at the initial state")
    norm, radius = float(np.linalg.norm(slopes, 2)), float(np.abs(np.linalg.eigvals(slopes)).max())
    rate = radius if radius > 1e-6 * norm else norm
    if rate <= 1e-9 * float(np.max(rates)):
        raise NotMeasured("the flow on the manifold does not change there; ask for a --time")
    return float(f"{SPAN / rate:.2g}")


def _whole(own: Scenario, time: float, slow: Sequence[str], fixed: Sequence[str]) -> Floats:
    """The slow variables along the motion of all equations, shape (slow, ROWS); what is tied follows ``fixed`` ones."""
    run = simulate(own, Request(time=time, samples=ROWS, tolerance=TOLERANCE, estimate=False, fixed=tuple(fixed)))
    if not run.whole:
        raise NotMeasured("the motion ends early")
    return np.array([run[name] for name in slow])


def _reduced(flow: Flow, s: Floats, time: float) -> Floats:
    from scipy.integrate import solve_ivp

    times = np.linspace(0.0, time, ROWS)
    with np.errstate(all="ignore"):
        done = solve_ivp(lambda _, x: flow(x), (0.0, time), s, "DOP853", times, rtol=TOLERANCE, atol=1e-14)
    if not done.success or not np.isfinite(done.y).all():
        raise NotMeasured("the flow on the manifold ends early")
    return np.asarray(done.y)


# How far the averaged motion is from the motion itself: average_measured, at the given eps and at parts of it.


#: Rows in which the two motions are compared.
ROWS_OF_AVERAGES = 400
#: Periods of the slowest of the fast phases, at the given numbers, that are simulated unless a time is asked for.
PERIODS = 60
#: Distances that the errors of the integrations may make up.
NOISE = 1e-6


def average_measured(
    system: System,
    averaged: System,
    average: Averaged,
    time: float | None = None,
    watch: Callable[[str], None] = lambda what: None,
) -> Measured:
    """Both motions from the initial state of the description, over ``time``: the largest |q - Q| beside that of |Q|.

    Raises Incomplete where numbers are missing, NoClosedForm where a motion does not last, or both are the same.
    """
    base = scenario(system)
    values = dict(base.parameters)
    rate = min(abs(float(values[rate_name])) for rate_name in average.rates)
    time = PERIODS * 2 * pi / rate if time is None else time
    distances = []
    for part in PARTS:
        watch(f"eps/{part.denominator}" if part != 1 else "eps")
        scaled: dict[str, Expression] = {
            name: number(Fraction(values[name]) * part**power) for name, power in average.orders
        }
        scaled |= {rate_name: number(Fraction(values[rate_name]) / part) for rate_name in average.rates}
        own = scenario(system, scaled)
        request = Request(time=time, samples=ROWS_OF_AVERAGES, estimate=False)
        exact = simulate(own, request)
        start = _start(own, average)
        slow = simulate(
            scenario(averaged, {**scaled, **start}), Request(time=time, samples=ROWS_OF_AVERAGES, estimate=False)
        )
        q, Q = np.asarray(exact.coordinates), np.asarray(slow.coordinates)
        if q.shape != Q.shape or not (np.isfinite(q).all() and np.isfinite(Q).all()):
            raise NoClosedForm("one of the motions ends before that time")
        size = np.abs(Q).max(axis=1, keepdims=True)
        size[size == 0] = 1.0
        distances.append(float(np.abs((q - Q) / size).max()))
    if max(distances) < NOISE:
        raise NoClosedForm("from this initial state both motions are the same, which tells nothing of others")
    return Measured(time, PARTS, tuple(distances))


def _start(own: Scenario, average: Averaged) -> Mapping[str, Expression]:
    """Q' = q' + M^-1 a at the beginning: the same momenta."""
    values: dict[str, Any] = {name: rationals.ball(x) for name, x in own.parameters.items()}
    places = dict(zip(own.system.coordinates, own.positions, strict=True))
    places |= {name: initial for name, (initial, _) in own.prescribed.items()}
    values |= {name: rationals.ball(x) for name, x in places.items()}
    start = {}
    for name, velocity, swing in zip(own.system.coordinates, own.velocities, average.swings, strict=True):
        shift = float(swing.ring.evaluate(swing.polynomial, values).mid())
        start[velocity_name(name)] = number(velocity + Fraction(shift))
    return start
