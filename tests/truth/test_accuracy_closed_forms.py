"""What ``--accuracy`` promises of motions that have closed forms: decaying to nothing, growing, drifting slowly, stiff,
driven, over stops and dry friction, in metres of an orbit, beside a large offset; bound and target are kept, the error
that is estimated is the error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import atan, cos, cosh, exp, findroot, floor, log, mp, mpf, pi, sin, sinh, sqrt, tanh
from truth.independent.solve import places

import mbsym
from mbsym.numerics.accuracy import ErrorEstimate

LINE = (
    "mbsym: 1\nname: line\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
)

#: Rounding of one number, and what a handful of them make.
FLOOR = 1e-13


def coulomb(t: Any) -> list[Any]:
    """x'' + 4 x = -sign x' from 5.3: half swings about +-1/4, until one ends within it."""
    x = mpf("5.3")
    while t >= pi / 2 and abs(x) > 0.25:
        x, t = (1 if x < 0 else -1) * (abs(x) - mpf(1) / 2), t - pi / 2
    side, far = (1 if x > 0 else -1), abs(x) - mpf(1) / 4
    return [x, 0] if far <= 0 else [side * (mpf(1) / 4 + far * cos(2 * t)), -2 * side * far * sin(2 * t)]


def gap(t: Any) -> list[Any]:
    """Free between stops of 10^6 at +-1/10, from the middle with 1."""
    wide, stiff = mpf(1) / 10, mpf(1000)
    t -= 2 * (half := 2 * wide + pi / stiff) * floor(t / (2 * half))
    side, t = (1, t) if t < half else (-1, t - half)
    if t < wide:
        return [side * t, side]
    if t < wide + pi / stiff:
        return [side * (wide + sin(stiff * (t - wide)) / stiff), side * cos(stiff * (t - wide))]
    return [side * (half - t), -side]


def bounce(t: Any) -> list[Any]:
    """Falls by 1 in 9.81 on a floor of 10^6:  x = g/w^2 (cos ws - 1) - v/w sin ws  in it, s from where it begins."""
    g, w = mpf("9.81"), mpf(1000)
    fall = sqrt(2 / g)
    v = g * fall
    inside = 2 * (pi - atan(v * w / g)) / w
    s = t + fall - (2 * fall + inside) * floor((t + fall) / (2 * fall + inside))
    if s < 2 * fall:
        return [v * s - g * s * s / 2, v - g * s]
    s -= 2 * fall
    return [g / w**2 * (cos(w * s) - 1) - v / w * sin(w * s), -g / w * sin(w * s) - v * cos(w * s)]


def overdamped(t: Any) -> list[Any]:
    """x'' + 10^4 x' + x = 0 from 1."""
    fast = -(10**4 + sqrt(mpf(10) ** 8 - 4)) / 2
    slow = 1 / fast
    away = fast - slow
    return [(fast * exp(slow * t) - slow * exp(fast * t)) / away, (exp(slow * t) - exp(fast * t)) / away]


def orbit(t: Any) -> list[Any]:
    """Kepler's ellipse of 10^7 m with e = 3/10 about the Earth, from its pericentre."""
    a, e, mu = mpf(10) ** 7, mpf(3) / 10, mpf(398600441800000)
    n = sqrt(mu / a**3)
    anomaly = findroot(lambda x: x - e * sin(x) - n * t, n * t + e * sin(n * t))
    c, s, b, r = cos(anomaly), sin(anomaly), sqrt(1 - e * e), 1 - e * cos(anomaly)
    return [a * (c - e), a * b * s, -a * n * s / r, a * n * b * c / r]


ORBIT = """
mbsym: 1
name: orbit in metres
bodies: [{name: p, attached to: 0, connection point: [x, y, 0], mass: 500, coordinates: [x, y]}]
loads: [{potential: -500*398600441800000/sqrt(x**2 + y**2)}]
initial: {x: 7000000, y: {position: 0, velocity: sqrt(398600441800000/10000000*13/7)}}
"""

DRIFT = """
mbsym: 1
name: slow beside a quick oscillation
bodies: [{name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}]
loads: [{potential: 50*y**2}]
initial: {x: {position: 0, velocity: 1e-5}, y: 1}
"""

HOOP = """
mbsym: 1
name: hoop on a slope, with drag
bodies:
  - {name: h, attached to: 0, connection point: [x, 0, 0], rotation: {axes: [3], angles: [f]}, mass: 2,
     inertia about: joint, inertia: [0, 0, 2], coordinates: [x, f]}
loads: [{generalized force: {x: 6 - x_dot/2}}]
constraints: [{velocity: x_dot + f_dot = 0}]
initial: {x: 0, f: 0}
"""


def hoop(t: Any) -> list[Any]:
    """4 x'' = 6 - x'/2, f = -x."""
    v = 12 * (1 - exp(-t / 8))
    return [12 * t - 8 * v, 8 * v - 12 * t, v, -v]


def on_a_line(load: str, initial: str) -> str:
    return LINE + f"loads: [{load}]\ninitial: {{x: {initial}}}\n"


STOP, PUSHED = "10**6", "{position: 0, velocity: 1}"
SPRING = "{spring: {coordinate: x, stiffness: 1}}"


def force(text: str) -> str:
    return f'{{generalized force: {{x: "{text}"}}}}'


SCENES: dict[str, tuple[str, float, Callable[[Any], list[Any]]]] = {
    "decay": (
        on_a_line(f"{SPRING}, {{damper: {{coordinate: x, coefficient: 2}}}}", "1"), 40.0,
        lambda t: [(1 + t) * exp(-t), -t * exp(-t)],
    ),
    "growth": (on_a_line("{potential: -x**2/2}", "1e-6"), 25.0, lambda t: [cosh(t) / 10**6, sinh(t) / 10**6]),
    "drift": (DRIFT, 100.0, lambda t: [t / 10**5, cos(10 * t), mpf(1) / 10**5, -10 * sin(10 * t)]),
    "orbit": (ORBIT, 30000.0, orbit),
    "coulomb": (on_a_line("{spring: {coordinate: x, stiffness: 4}}, " + force("-sign(x_dot)"), "5.3"), 12.0, coulomb),
    "gap": (
        on_a_line(force(f"-{STOP}*(x - 1/10)*step(x - 1/10) - {STOP}*(x + 1/10)*step(-x - 1/10)"), PUSHED), 2.0, gap,
    ),
    "bounce": (on_a_line(force("-9.81 - 10**6*x*step(-x)"), "1"), 3.0, bounce),
    "overdamped": (on_a_line(f"{SPRING}, {{damper: {{coordinate: x, coefficient: 10000}}}}", "1"), 10.0, overdamped),
    "resonance": (
        on_a_line(f"{SPRING}, {force('cos(t)')}", "0"), 100.0,
        lambda t: [t * sin(t) / 2, (sin(t) + t * cos(t)) / 2],
    ),
    "drag": (on_a_line(force("1 - x_dot*abs(x_dot)"), "0"), 20.0, lambda t: [log(cosh(t)), tanh(t)]),
    "offset": (
        on_a_line("{spring: {coordinate: x, stiffness: 1, rest: 10**9}}", "10**9 + 1"), 20.0,
        lambda t: [10**9 + cos(t), -sin(t)],
    ),
    "hoop": (HOOP, 5.0, hoop),
}  # fmt: skip


@pytest.mark.parametrize("target", [1e-4, 1e-8])
@pytest.mark.parametrize("name", SCENES)
def test_what_is_promised_is_kept(name: str, target: float) -> None:
    text, time, truth = SCENES[name]
    found, times = mbsym.simulate(mbsym.loads(text), time, samples=101, accuracy=target, estimate=True), places(time)
    assert found.plan is not None
    assert found.plan.reached
    with mp.workdps(40):
        exact = np.array([[float(x) for x in truth(mpf(t))] for t in times]).T
    sizes = np.max(np.abs(exact), axis=1)
    error = float(np.max(np.max(np.abs(found.at(np.array(times)).astype(float) - exact), axis=1) / sizes))
    assert error <= found.plan.bound.total + FLOOR
    assert error <= target
    assert isinstance(found.error, ErrorEstimate)
    assert error <= 3 * found.error.largest + FLOOR
