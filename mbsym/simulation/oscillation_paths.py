"""A periodic solution in powers of a small parameter as curves, beside the motion that begins in the same state.

Angles that the equations in speeds do not hold follow from both by q' = Y(q) (u - s0), from one beginning: of the
positions that are nearest to the description's, those with the unit vectors of the series.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.program import Program
from mbsym.algebra.terms import evaluated
from mbsym.analysis.oscillating import Oscillating
from mbsym.expressions.tree import Expression, number
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import System, velocity_name
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.states import scenario_in_states
from mbsym.simulation.oscillating import Numeric, on_the_motion, symbol_values
from mbsym.simulation.request import Request
from mbsym.simulation.run import simulate

Floats = Any  # arrays of float64

#: Samples of a period; relative tolerance of the motion; steps to the positions of the beginning.
SAMPLES, TOLERANCE, STEPS = 400, 1e-11, 30


@dataclass(frozen=True)
class Paths:
    """``series[x]`` and ``motion[x]``: (x, x') of shape (2, m) at ``times``, not scaled by the small parameter.

    ``angles``: coordinates that are no variables of the series, (series, motion) of shape (m,); ``no_angles``: why
    there are none.
    """

    times: Floats
    period: float
    small: float
    names: tuple[str, ...]
    series: Mapping[str, Floats]
    motion: Mapping[str, Floats]
    angles: Mapping[str, tuple[Floats, Floats]]
    no_angles: str = ""


def oscillation_paths(
    system: System, solution: Oscillating, values: Mapping[str, Fraction] | None = None, periods: float = 3.0
) -> Paths:
    """Both over so many periods of the series, at the numbers of the description and ``values``.

    Raises Incomplete where numbers are missing, NoClosedForm where the initial state gives no amplitude or the motion
    ends early.
    """
    put: dict[str, Expression] = {n: number(x) for n, x in (values or {}).items() if n in system.parameter_names}
    base = scenario(system, put)
    parameters = {name: Fraction(value) for name, value in base.parameters.items()}
    powers = dict(solution.oscillation.powers)
    small = solution.oscillation.small
    eps = parameters[small] if small in solution.field.parameters else Fraction(1)
    numeric = Numeric(solution, parameters | symbol_values(base, solution, powers, eps, values or {}), eps)
    units = {name: float(eps) ** powers.get(name, 0) for name in solution.oscillation.names}
    period = 2 * pi / abs(numeric.rate)
    times = np.linspace(0.0, periods * period, int(SAMPLES * max(1.0, periods)) + 1)
    waves = {name: units[name] * numeric.over(times, name) for name in solution.oscillation.names}
    start = {
        name: Fraction(float(numeric.at(0.0, name))) * Fraction(units[name]) for name in solution.oscillation.names
    }
    names = tuple(name for name in solution.oscillation.names if name not in solution.velocities)
    if not system.speeds:
        motion = _in_coordinates(system, put, base, solution, start, times)
        return Paths(times, period, float(eps), names, {x: waves[x] for x in names}, motion, {})
    own, declared = scenario(system, put, declared=True), scenario_in_states(base)
    states = (*declared.system.coordinates, *declared.system.velocities)
    begun = dict(zip(states, declared.state, strict=True)) | start
    run = simulate(
        replace(own, declared=tuple(begun[name] for name in states)),
        Request(time=float(times[-1]), samples=len(times), tolerance=TOLERANCE, estimate=False),
    )
    if not run.whole:
        raise NoClosedForm("the motion ends early")
    columns = {name: np.asarray(run[name], dtype=float) for name in states}
    rates = _rates(solution.field, parameters, columns)
    motion = {name: np.array([columns[name], rates[name]]) for name in names}
    angles, missing = _angles(system, base, waves, columns, times, begun)
    return Paths(times, period, float(eps), names, waves, motion, angles, missing)


def _in_coordinates(
    system: System,
    put: Mapping[str, Expression],
    base: Scenario,
    solution: Oscillating,
    start: Mapping[str, Fraction],
    times: Floats,
) -> dict[str, Floats]:
    """(q, q') of the motion, from the rest that deviations are of."""
    shift = on_the_motion(system, solution, base)
    begun = {name: number(value + shift.get(name, 0)) for name, value in start.items()}
    run = simulate(
        scenario(system, {**put, **begun}),
        Request(time=float(times[-1]), samples=len(times), tolerance=TOLERANCE, estimate=False),
    )
    if not run.whole:
        raise NoClosedForm("the motion ends early")
    return {
        name: np.array([run[x] - float(shift.get(x, 0)) for x in (name, velocity_name(name))], dtype=float)
        for name in system.coordinates
        if name in start
    }


def _rates(field: PolynomialField, parameters: Mapping[str, Fraction], columns: Mapping[str, Floats]) -> dict[str, Any]:
    """x' by the equations."""
    known = [float(parameters[name]) for name in field.parameters] + [columns[name] for name in field.variables]

    def at(p: Any) -> Floats:
        return evaluated(p, lambda k, e: known[k] ** e, lambda c: int(c.p) / int(c.q)) + np.zeros_like(known[-1])

    below = at(field.denominator)
    return {name: at(p) / below for name, p in zip(field.variables, field.numerators, strict=True)}


def _angles(
    system: System,
    base: Scenario,
    waves: Mapping[str, Floats],
    columns: Mapping[str, Floats],
    times: Floats,
    begun: Mapping[str, Fraction],
) -> tuple[dict[str, tuple[Floats, Floats]], str]:
    """Coordinates that are no variables, along both."""
    from scipy.interpolate import CubicSpline

    form = SpeedForm(system, ring_of(system))
    positions, speeds = [x.name for x in form.positions], [u.name for u in form.speeds]
    angle_names = [name for name in system.coordinates if name not in positions]
    if not angle_names:
        return {}, ""
    if system.prescribed:
        return {}, "quantities are prescribed"
    if any(name not in waves for name in speeds):
        return {}, "a speed is no variable of the series"
    states = _states(form, system, base)
    q = np.array([float(x) for x in base.positions])
    target = np.array([float(begun[name]) for name in positions])
    for _ in range(STEPS):  # Gauss and Newton: the smallest change, angles that are free stay
        step = 1e-6 * np.vstack([np.zeros_like(q), np.eye(len(q)), -np.eye(len(q))])
        values = states(q + step, np.zeros_like(step))[: len(positions)]
        slopes = (values[:, 1 : 1 + len(q)] - values[:, 1 + len(q) :]) / 2e-6
        q = q + np.linalg.pinv(slopes, rcond=1e-8) @ (target - values[:, 0])
    along = []
    for rows in ({name: waves[name][0] for name in speeds}, columns):
        path = _followed(states, CubicSpline(times, np.array([rows[name] for name in speeds]).T), q, times)
        if path is None:
            return {}, "the angles become singular"
        along.append(path)
    place = {name: k for k, name in enumerate(system.coordinates)}
    return {name: (along[0][place[name]], along[1][place[name]]) for name in angle_names}, ""


def _states(form: SpeedForm, system: System, base: Scenario) -> Callable[[Floats, Floats], Floats]:
    """(q, q') of shape (m, n) -> (s, u) of shape (2 n', m)."""
    program = Program()
    nodes = tuple(form.state_in_coordinates(program))
    names = ("t", "pi", *base.parameters, *system.coordinates, *system.velocities)
    run = arrays.kernel(Code(program, names, nodes))
    known = np.array([0.0, pi, *(float(x) for x in base.parameters.values())])

    def states(q: Floats, v: Floats) -> Floats:
        inputs = np.vstack([np.repeat(known[:, None], len(q), axis=1), np.asarray(q).T, np.asarray(v).T])
        return np.asarray(run(inputs))

    return states


def _followed(states: Callable[[Floats, Floats], Floats], speeds: Any, q: Floats, times: Floats) -> Floats | None:
    """q over the time by its speeds; None where the angles are singular."""
    from scipy.integrate import solve_ivp

    n = len(q)
    units = np.vstack([np.zeros((1, n)), np.eye(n)])

    def rate(t: float, q: Floats) -> Floats:
        values = states(np.repeat(q[None], n + 1, axis=0), units)[-n:]
        return np.linalg.solve(values[:, 1:] - values[:, :1], speeds(t) - values[:, 0])

    try:
        with np.errstate(all="ignore"):
            done = solve_ivp(rate, (0.0, times[-1]), q, "DOP853", times, rtol=1e-10, atol=1e-12)
    except np.linalg.LinAlgError:
        return None
    return np.asarray(done.y) if done.success and np.isfinite(done.y).all() else None
