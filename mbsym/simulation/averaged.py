"""How far the averaged motion is from the motion itself: measured, at the given eps and at parts of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.tree import Expression, number
from mbsym.model.system import System, velocity_name
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.problems.small_parameter.averaging import Averaged
from mbsym.simulation.expanded import PARTS, Measured
from mbsym.simulation.request import Request
from mbsym.simulation.run import simulate

#: Rows in which the two motions are compared.
ROWS = 400
#: Periods of the slowest of the fast phases, at the given numbers, that are simulated unless a time is asked for.
PERIODS = 60
#: Distances that the errors of the integrations may make up.
NOISE = 1e-6


def measured(
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
        exact = simulate(own, Request(time=time, samples=ROWS, estimate=False))
        start = _start(own, average)
        slow = simulate(scenario(averaged, {**scaled, **start}), Request(time=time, samples=ROWS, estimate=False))
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
