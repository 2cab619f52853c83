"""The truth suite, runs: what a simulation says of its error and of its energy, against motions in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from truth.statements import Run, false_run

import mbsym
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.trade.comparison import uneven

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
)
PLANE = LINE.replace("[x, 0, 0]", "[x, y, 0]").replace("[x]", "[x, y]")


@dataclass(frozen=True)
class Motion:
    """A description, the time it runs, x(t) and x'(t) in closed form, and whether the energy is constant."""

    name: str
    text: str
    time: float
    exact: Callable[[Any], tuple[Any, ...]]
    conserves: bool
    samples: int = 201


def _pendulum(t: Any) -> tuple[Any, ...]:
    """q'' = -sin q from q = 2, at rest: sin(q/2) = k cd(t, k), k = sin 1."""
    k = mpmath.sin(1)
    cd = mpmath.ellipfun("cd", t, m=k * k)
    q = 2 * mpmath.asin(k * cd)
    fall = mpmath.sqrt(max(mpmath.mpf(0), 2 * (mpmath.cos(q) - mpmath.cos(2))))
    quarter = mpmath.ellipk(k * k)
    return q, -fall if mpmath.floor(t / (2 * quarter)) % 2 == 0 else fall


def _kepler(t: Any) -> tuple[Any, ...]:
    """The ellipse of e = 1/2, a = 1 from its pericentre: E - e sin E = t."""
    e = mpmath.mpf(1) / 2
    E = mpmath.findroot(lambda x: x - e * mpmath.sin(x) - t, t + e * mpmath.sin(t))
    rate, minor = 1 / (1 - e * mpmath.cos(E)), mpmath.sqrt(1 - e * e)
    return (mpmath.cos(E) - e, minor * mpmath.sin(E), -mpmath.sin(E) * rate, minor * mpmath.cos(E) * rate)


def _damped(t: Any) -> tuple[Any, ...]:
    """x'' + x'/5 + x = 0."""
    w = mpmath.sqrt(mpmath.mpf(99)) / 10
    fall = mpmath.exp(-t / 10)
    x = fall * (mpmath.cos(w * t) + mpmath.sin(w * t) / (10 * w))
    return x, -fall * mpmath.sin(w * t) * (w + 1 / (100 * w))


def _pushed(t: Any) -> tuple[Any, ...]:
    """x'' + x = exp(-(t - 5)^2/w^2)/w, w = 1/10, x(0) = 1: (cos t, -sin t) and Duhamel's integral.

    int_0^t exp(i (t - s)) exp(-(s - 5)^2/w^2)/w ds, u = (s - 5)/w, is exp(i (t - 5)) int exp(-u^2 - i w u) du; a square
    is completed: sqrt(pi)/2 exp(i (t - 5) - w^2/4) (erf((t - 5)/w + i w/2) - erf(-5/w + i w/2)).
    """
    w, i = mpmath.mpf(1) / 10, mpmath.mpc(0, 1)
    whole = mpmath.erf((t - 5) / w + i * w / 2) - mpmath.erf(-5 / w + i * w / 2)
    felt = mpmath.sqrt(mpmath.pi) / 2 * mpmath.exp(i * (t - 5) - w * w / 4) * whole
    return mpmath.cos(t) + felt.imag, -mpmath.sin(t) + felt.real


@pytest.mark.parametrize("t", [3, 4.9, 5.05, 7, 10])
def test_the_push_is_its_integral(t: float) -> None:
    w = 0.1
    ends = [0, *(end for end in (4, 5, 6) if end < t), t]

    def felt(turn: Callable[[float], float]) -> float:
        return float(mpmath.quad(lambda s: turn(t - s) * mpmath.exp(-(((s - 5) / w) ** 2)) / w, ends))

    expected = math.cos(t) + felt(mpmath.sin), -math.sin(t) + felt(mpmath.cos)
    assert [float(x) for x in _pushed(mpmath.mpf(t))] == pytest.approx(expected, abs=1e-13)


MOTIONS = [
    Motion("oscillator", LINE + "loads:\n  - potential: x**2/2\ninitial: {x: 1}\n", 20,
           lambda t: (mpmath.cos(t), -mpmath.sin(t)), True),
    Motion("damped", LINE + "loads:\n  - potential: x**2/2\n  - rayleigh: x_dot**2/10\ninitial: {x: 1}\n", 20,
           _damped, False),
    Motion("driven", LINE + "loads:\n  - generalized force: {x: sin(t)}\ninitial: {x: 0}\n", 10,
           lambda t: (t - mpmath.sin(t), 1 - mpmath.cos(t)), False),
    Motion("falling away", LINE + "loads:\n  - potential: -x**2/2\ninitial: {x: 1/1000}\n", 8,
           lambda t: (mpmath.cosh(t) / 1000, mpmath.sinh(t) / 1000), True),
    Motion("pushed", LINE + "loads:\n  - potential: x**2/2\n  - generalized force: {x: 10*exp(-((t - 5)*10)**2)}\n"
           "initial: {x: 1}\n", 10, _pushed, False, 41),
    Motion("projectile", PLANE + "loads:\n  - uniform gravity: {vector: [0, -10, 0]}\n"
           "initial: {x: {position: 0, velocity: 3}, y: {position: 0, velocity: 4}}\n", 2,
           lambda t: (3 * t, 4 * t - 5 * t * t, mpmath.mpf(3), 4 - 10 * t), True),
    Motion("Kepler", PLANE + "loads:\n  - potential: -1/sqrt(x**2 + y**2)\n"
           "initial: {x: 1/2, y: {position: 0, velocity: sqrt(3)}}\n", 20, _kepler, True),
    Motion("pendulum", LINE.replace("[x, 0, 0]", "[sin(x), -cos(x), 0]")
           + "loads:\n  - uniform gravity: {vector: [0, -1, 0]}\ninitial: {x: 2}\n", 20, _pendulum, True),
    # the linear term of the friction is small beside the cubic one: nothing here is conserved, and slowly
    Motion("slow loss", LINE + "loads:\n  - potential: x**2/2\n  - rayleigh: x_dot**2/2000000\ninitial: {x: 1}\n", 20,
           lambda t: _slow(t), False),
]  # fmt: skip


def _slow(t: Any) -> tuple[Any, ...]:
    """x'' + 2 d x' + x = 0, d = 1/2000000."""
    d = mpmath.mpf(1) / 2000000
    w = mpmath.sqrt(1 - d * d)
    fall = mpmath.exp(-d * t)
    x = fall * (mpmath.cos(w * t) + d * mpmath.sin(w * t) / w)
    return x, -fall * mpmath.sin(w * t) / w


METHODS: list[dict[str, Any]] = [
    {},
    {"method": "rk45", "tolerance": 1e-6},
    {"method": "rk4", "step": 0.01},
    {"method": "midpoint", "step": 0.01},
    {"method": "dop853", "tolerance": 1e-15},  # as fine as the arithmetic: nothing may be compared with itself
    {"method": "lsoda", "tolerance": 1e-8},
]


@cache
def truth_of(motion: Motion, times: tuple[float, ...]) -> np.ndarray:
    with mpmath.workdps(30):
        return np.array([[float(x) for x in motion.exact(mpmath.mpf(t))] for t in times]).T


def run_of(motion: Motion, asked: dict[str, Any]) -> Run:
    """The rows, and what the run shows between them."""
    found = mbsym.simulate(mbsym.loads(motion.text), motion.time, samples=motion.samples, estimate=True, **asked)
    assert found.whole
    error = found.error.largest if isinstance(found.error, ErrorEstimate) else None
    again = found.chosen.method.start(found.dynamics, found.chosen.setting)
    times = np.union1d(found.times, uneven(0.0, motion.time, 150)[1:])
    states = np.column_stack([again.state, again.fill(times[1:])])
    states[:, np.searchsorted(times, found.times)] = found.trajectory.states
    return Run(times, states, error, found.conservation.standing.conserved)


RUNS = [
    pytest.param(motion, asked, id=f"{motion.name}, {asked.get('method', 'auto')}")
    for motion in MOTIONS
    for asked in METHODS
    if motion.conserves or asked.get("method") != "midpoint"  # which is for conservative systems
]


@pytest.mark.parametrize(("motion", "asked"), RUNS)
def test_what_a_run_says_is_true(motion: Motion, asked: dict[str, Any]) -> None:
    run = run_of(motion, asked)
    truth = truth_of(motion, tuple(map(float, run.times)))
    assert false_run(motion.name, run, truth, motion.conserves) == []
    assert run.error is not None, "a better run can be had for each of these"
    assert run.conserved is motion.conserves
    # Planted lies.
    assert false_run(motion.name, replace(run, conserved=not motion.conserves), truth, motion.conserves)
    assert false_run(motion.name, replace(run, error=0.0), truth, motion.conserves)
    if run.error > 1e-11:  # not rounding alone
        assert false_run(motion.name, replace(run, error=run.error / 100), truth, motion.conserves)
