"""Closed loops of the IFToMM library: error against references, seconds, and what others published.

    python tests/bench/loops_bench.py [--large] [--table] [--forty]

Each problem at the loosest tolerance of dop853 (decades) with which the error at the end is within the target.  Seconds
are processor time of the run alone, median of some, and of everything before it: reading, equations, machine code.
Published times are from other machines, and at errors that their authors did not all state: they show orders of
magnitude, nothing else.  ``--large`` adds forty four-bars, whose machine code takes some seconds the first time;
nobody's time at a stated error was found for them.  Then what equations and machine code take: a chain of ten pendulums
(PyDy's issue 536: 3906 s), and the operations of the bicycle's nonlinear right-hand side.  ``--table`` prints the rows
of docs/howto/constraints.md, whose errors tests/constrained/test_loops_told.py holds, ``--forty`` the forty four-bars
alone as a JSON record.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")  # as the command has it; waiting threads would be counted
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "constrained"))

from test_mechanisms import ANGLES, chain, described, four_bars, reference, shipped  # noqa: E402

import mbsym  # noqa: E402
from mbsym.mechanics.constraints.dynamics import Chosen, constrained_dynamics  # noqa: E402
from mbsym.mechanics.programs import constants  # noqa: E402
from mbsym.numerics.closing import closed  # noqa: E402
from mbsym.numerics.dynamics import Dynamics  # noqa: E402
from mbsym.numerics.methods.interface import Setting, compiled_kernel  # noqa: E402
from mbsym.numerics.methods.table import METHODS  # noqa: E402
from mbsym.numerics.scenario import Scenario, scenario  # noqa: E402

REPEATS = 5
SHIPPED = TESTS.parent / "systems"


@dataclass(frozen=True)
class Problem:
    """``wrong`` is the error of the states at ``end``; ``published`` what others say they need, and who."""

    name: str
    made: Callable[[], Scenario]
    end: float
    target: float
    wrong: Callable[[Dynamics, Any], float]
    published: str = ""


def bob(dynamics: Dynamics, state: Any) -> float:
    truth = [float(x) for x in reference("iftomm_a01_pendulum")["reference"]["xy"]["10"]]
    return float(np.max(np.abs(state[:2] - truth)))


def first_bar(truth: tuple[float, float]) -> Callable[[Dynamics, Any], float]:
    def wrong(dynamics: Dynamics, state: Any) -> float:
        angle = state[dynamics.system.coordinates.index("th0")]
        return float(np.max(np.abs(np.array([-np.sin(angle), np.cos(angle)]) - truth)))

    return wrong


def squeezed(dynamics: Dynamics, state: Any) -> float:
    truth = reference("andrews_squeezer")["reference"]["recomputed_t003"]["q"]
    names = dynamics.system.coordinates
    return max(abs(float(state[names.index(name)]) - float(x)) for name, x in zip(ANGLES, truth, strict=True))


def by_one_angle(number: int, end: float) -> tuple[float, float]:
    """B0 of ``number`` four-bars at ``end``: they move as one pendulum, I th'' = G sin th, th'(0) = 1."""
    from scipy.integrate import solve_ivp

    inertia, weight = (number + 1) / 3 + number, ((number + 1) / 2 + number) * 9.81
    run = solve_ivp(
        lambda t, x: [x[1], weight / inertia * np.sin(x[0])], (0, end), [0, 1], "DOP853", rtol=3e-14, atol=1e-15
    )
    return float(np.sin(run.y[0, -1])), float(np.cos(run.y[0, -1]))


#: Bennett's linkage with sin(alpha)/3 = sin(beta)/4 = 1/5, as q3 = -q1 and tan(q1/2) tan(q2/2) = 5 want it.
BENNETT = (
    (TESTS / "cases" / "constraints" / "bennett-no.yaml")
    .read_text(encoding="utf-8")
    .replace("b: {value: 5", "b: {value: 4")
    .replace("q2: 1", "q2: 2*atan(5*cos(1/2)/sin(1/2))")
)


@cache
def by_bennett(end: float) -> float:
    """q1 at ``end``: J q1'' + J' q1'^2/2 + V' = 0, J and V of the places of the bars at q1, all by hand.

    q2 and q3 by the closed formulas of the linkage; derivatives of places by a complex step, of J and V by differences
    of the eighth order.
    """
    from scipy.integrate import solve_ivp

    def turned(angle: Any, axis: int) -> Any:
        c, s, one = np.cos(angle), np.sin(angle), 1 + 0 * angle
        rows = {0: [[one, 0, 0], [0, c, -s], [0, s, c]], 2: [[c, -s, 0], [s, c, 0], [0, 0, one]]}
        return np.array(rows[axis])

    def bars(q: complex) -> list[tuple[Any, Any]]:
        """Mass centres and axes of the three bars that move."""
        alpha, beta = np.arctan2(3, 4), np.arctan2(4, 3)
        first = turned(q, 2)
        # q2 = 2 atan2(5 cos(q/2), sin(q/2)), whose cosine and sine are rational in those of q/2
        c, s = 5 * np.cos(q / 2), np.sin(q / 2)
        cosine, sine = (s * s - c * c) / (c * c + s * s), 2 * c * s / (c * c + s * s)
        middle = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        second = first @ turned(alpha, 0) @ middle
        third = second @ turned(beta, 0) @ turned(-q, 2)
        joint = 3 * first[:, 0]
        return [
            (1.5 * first[:, 0], first),
            (joint + 2 * second[:, 0], second),
            (joint + 4 * second[:, 0] + 1.5 * third[:, 0], third),
        ]

    def inertia(q: float) -> float:
        total = 0.0
        for here, moved in zip(bars(complex(q)), bars(q + 1e-30j), strict=True):
            speed, rates = np.imag(moved[0]) / 1e-30, np.real(here[1]).T @ np.imag(moved[1]) / 1e-30
            spin = np.array([rates[2, 1], rates[0, 2], rates[1, 0]])
            total += speed @ speed + spin @ (np.array([0.1, 1, 1]) * spin)
        return total

    def potential(q: float) -> float:
        return 9.81 * sum(float(np.real(place[2])) for place, _ in bars(complex(q)))

    def slope(of: Callable[[float], float], q: float, h: float = 0.01) -> float:
        weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
        return sum(w * (of(q + k * h) - of(q - k * h)) for k, w in enumerate(weights, 1)) / h

    def rates(_: float, x: Any) -> list[float]:
        return [x[1], -(slope(inertia, x[0]) * x[1] ** 2 / 2 + slope(potential, x[0])) / inertia(x[0])]

    run = solve_ivp(rates, (0, end), [1, 0], "DOP853", rtol=3e-14, atol=1e-15)
    return float(run.y[0, -1])


#: Bars 2, 3 and 2, 3 over a ground of 3: two degrees of freedom.
FIVE_BAR = """mbsym: 1
name: five-bar
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [p]}, mass centre: [1, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 1/3, 1/3]}
  - {name: b, attached to: a, connection point: [2, 0, 0], rotation: {axes: [3], angles: [q]}, mass centre: [3/2, 0, 0],
     mass: 1, inertia about: mass centre, inertia: [0, 3/4, 3/4]}
  - {name: c, attached to: 0, connection point: [3, 0, 0], rotation: {axes: [3], angles: [s]}, mass centre: [1, 0, 0],
     mass: 1, inertia about: mass centre, inertia: [0, 1/3, 1/3]}
  - {name: e, attached to: c, connection point: [2, 0, 0], rotation: {axes: [3], angles: [w]}, mass centre: [3/2, 0, 0],
     mass: 1, inertia about: mass centre, inertia: [0, 3/4, 3/4]}
loads: [{uniform gravity: {vector: [0, -10, 0]}}]
constraints: [{coincide: [{body: b, point: [3, 0, 0]}, {body: e, point: [3, 0, 0]}]}]
initial: {p: 2, s: 1, q: START1, w: START2}
"""


def five_bar_start() -> tuple[float, float, float, float]:
    """Directions of the bars at p = 2, s = 1, the joint of the long ones above."""
    left, right = 2 * np.exp(2j), 3 + 2 * np.exp(1j)
    across = (right - left) / 2
    top = left + across + 1j * across / abs(across) * np.sqrt(9 - abs(across) ** 2)
    return 2.0, float(np.angle(top - left)), 1.0, float(np.angle(top - right))


def five_bar() -> str:
    p, q, s, w = five_bar_start()
    return FIVE_BAR.replace("START1", f"{q - p:.17f}").replace("START2", f"{w - s:.17f}")


@cache
def by_directions(end: float) -> tuple[float, float]:
    """p and s of the five-bar at ``end``: two double pendulums in directions x of their bars by hand, tied at the ends.

    M x'' + c(x, x') = J^T lambda,  J x'' = -J' x'
    """
    from scipy.integrate import solve_ivp

    signs, lengths = (1, 1, -1, -1), (2.0, 3.0, 2.0, 3.0)

    def rates(_: float, z: Any) -> Any:
        x, v = z[:4], z[4:]
        table, right = np.zeros((6, 6)), np.zeros(6)
        for i in (0, 2):  # the bars i and i + 1 are a double pendulum
            long, end_bar = lengths[i], lengths[i + 1]
            apart, coupled = x[i] - x[i + 1], long * end_bar / 2
            table[i, i], table[i + 1, i + 1] = long**2 / 3 + long**2, end_bar**2 / 3
            table[i, i + 1] = table[i + 1, i] = coupled * np.cos(apart)
            right[i] = -coupled * np.sin(apart) * v[i + 1] ** 2 - 10 * 1.5 * long * np.cos(x[i])
            right[i + 1] = coupled * np.sin(apart) * v[i] ** 2 - 10 * end_bar / 2 * np.cos(x[i + 1])
        for i in range(4):
            column = signs[i] * lengths[i] * np.array([-np.sin(x[i]), np.cos(x[i])])
            table[4:, i] = table[i, 4:] = column
            right[4:] += signs[i] * lengths[i] * np.array([np.cos(x[i]), np.sin(x[i])]) * v[i] ** 2
        return np.concatenate([v, np.linalg.solve(table, right)[:4]])

    run = solve_ivp(rates, (0, end), [*five_bar_start(), 0, 0, 0, 0], "DOP853", rtol=3e-14, atol=1e-15)
    return float(run.y[0, -1]), float(run.y[2, -1])


def directions(**truth: float) -> Callable[[Dynamics, Any], float]:
    """How far unit vectors at angles are from those at true ones."""

    def wrong(dynamics: Dynamics, state: Any) -> float:
        places = ((state[dynamics.system.coordinates.index(name)], angle) for name, angle in truth.items())
        return max(float(abs(np.exp(1j * x) - np.exp(1j * angle))) for x, angle in places)

    return wrong


#: Joints of a Stewart platform at the base and on it, in its axes; its legs are thin rods in two parts, with springs.
BASE = ((1.9, -0.7), (1.9, 0.7), (-0.3, 2.0), (-1.5, 1.3), (-1.5, -1.3), (-0.3, -2.0))
TOP = ((0.7, -0.7), (0.7, 0.7), (0.2, 1.0), (-0.9, 0.3), (-0.9, -0.3), (0.2, -1.0))
LOWER, UPPER, STIFFNESS, LENGTH, GRAVITY = (1.0, 0.4, 0.05), (0.5, 0.3, 0.02), 400.0, 1.9, 9.81
PLATFORM = {"x": 0.1, "y": -0.05, "z": 1.6, "f": 0.1, "h": -0.15, "p": 0.2}
TENSOR = (0.3, 0.4, 0.5)


def turned_platform() -> Any:
    """R of the platform at the start: columns are its axes."""
    (cf, sf), (ch, sh), (cp, sp) = ((np.cos(PLATFORM[name]), np.sin(PLATFORM[name])) for name in "fhp")
    first = np.array([[1, 0, 0], [0, cf, sf], [0, -sf, cf]])
    second = np.array([[ch, 0, -sh], [0, 1, 0], [sh, 0, ch]])
    return (np.array([[cp, sp, 0], [-sp, cp, 0], [0, 0, 1]]) @ second @ first).T


def stewart() -> str:
    """Six coordinates of the platform, and two angles and the length of every leg; eighteen rows leave six freedoms."""
    place = np.array([PLATFORM[name] for name in "xyz"])
    bodies, ties, start, loads = [], [], dict(PLATFORM), ["uniform gravity: {vector: [0, 0, -981/100]}"]
    for k, (base, top) in enumerate(zip(BASE, TOP, strict=True)):
        leg = place + turned_platform() @ [*top, 0] - [*base, 0]
        long = float(np.linalg.norm(leg))
        start |= {f"a{k}": np.arctan2(-leg[1], leg[2]), f"b{k}": np.arcsin(leg[0] / long), f"s{k}": long}
        (m, h, j), (m2, h2, j2) = LOWER, UPPER
        bodies += [
            f"{{name: lower{k}, attached to: 0, connection point: [{base[0]}, {base[1]}, 0], mass: {m}, "
            f"rotation: {{axes: [1, 2], angles: [a{k}, b{k}]}}, mass centre: [0, 0, {h}], "
            f"inertia about: mass centre, "
            f"inertia: [{j}, {j}, 0]}}",
            f"{{name: upper{k}, attached to: lower{k}, connection point: [0, 0, s{k}], coordinates: [s{k}], "
            f"mass: {m2}, mass centre: [0, 0, {-h2}], inertia about: mass centre, inertia: [{j2}, {j2}, 0]}}",
        ]
        loads.append(f"spring: {{coordinate: s{k}, stiffness: {STIFFNESS}, rest: {LENGTH}}}")
        ends = f"[{{body: upper{k}, point: [0, 0, 0]}}, {{body: platform, point: [{top[0]}, {top[1]}, 0]}}]"
        ties.append(f"coincide: {ends}")
    bodies.insert(
        0,
        "{name: platform, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z, f, h, p], mass: 2, "
        "rotation: {axes: [1, 2, 3], angles: [f, h, p]}, inertia about: mass centre, "
        f"inertia: {[*TENSOR]}}}",
    )
    lists = {"bodies": bodies, "loads": loads, "constraints": ties}
    text = "".join(f"{key}:\n" + "".join(f"  - {one}\n" for one in listed) for key, listed in lists.items())
    told = ", ".join(f"{name}: {value:.17f}" for name, value in start.items())
    return f"mbsym: 1\nname: Stewart\n{text}initial: {{{told}}}\n"


@cache
def by_forces_of_legs(end: float) -> tuple[float, ...]:
    """x, y, z, h of the platform by Newton and Euler in inertial axes, every leg being a force on its joint.

    A leg to P, L = |P - B| and u along it, has T = A v.v/2 + (m' - A) (u.v)^2/2 with
    A = (J + J' + m h^2 + m' (L - h')^2)/L^2; the force is d/dt dT/dv - dT/dP + dU/dP.
    """
    from scipy.integrate import solve_ivp

    (m, h, j), (m2, h2, j2) = LOWER, UPPER
    base, top = (np.array([[*x, 0.0] for x in joints]) for joints in (BASE, TOP))

    def leg(p: Any, v: Any) -> tuple[Any, Any]:
        """The matrix M and the rest w of its force M a + w."""
        long = np.sqrt(p @ p)
        u = p / long
        along = u @ v
        across = v - along * u
        a = (j + j2 + m * h * h + m2 * (long - h2) ** 2) / long**2
        slope = 2 * m2 * (long - h2) / long**2 - 2 * a / long
        b = m2 - a
        weight = GRAVITY * ((m * h - m2 * h2) / long + m2) * np.array([0, 0, 1.0])
        weight = weight - GRAVITY * (m * h - m2 * h2) * p[2] / long**2 * u
        turning = b / long * (across * along + u * (across @ across))
        grown = slope * along * (v - along * u) - u * slope * (v @ v - along**2) / 2 - b * along * across / long
        return a * np.eye(3) + b * np.outer(u, u), turning + grown + weight + STIFFNESS * (long - LENGTH) * u

    def crossed(x: Any) -> Any:
        return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])

    def rates(_: float, state: Any) -> Any:
        place, turned, v, w = state[:3], state[3:12].reshape(3, 3), state[12:15], state[15:]
        tensor = turned @ np.diag(TENSOR) @ turned.T
        table = np.zeros((6, 6))
        table[:3, :3], table[3:, 3:] = 2 * np.eye(3), tensor
        right = np.concatenate([[0, 0, -2 * GRAVITY], -crossed(w) @ tensor @ w])
        for below, above in zip(base, top, strict=True):
            r = turned @ above
            m_leg, rest = leg(place + r - below, v + crossed(w) @ r)
            moves = np.hstack([np.eye(3), -crossed(r)])
            table += moves.T @ m_leg @ moves
            right -= moves.T @ (m_leg @ (crossed(w) @ crossed(w) @ r) + rest)
        return np.concatenate([v, (crossed(w) @ turned).ravel(), np.linalg.solve(table, right)])

    start = [*(PLATFORM[name] for name in "xyz"), *turned_platform().ravel(), *np.zeros(6)]
    run = solve_ivp(rates, (0, end), start, "DOP853", rtol=3e-14, atol=1e-15)
    return (*map(float, run.y[:3, -1]), float(np.arcsin(run.y[3:12, -1].reshape(3, 3)[0, 2])))


#: A delta robot: radii of the base and of the platform, half the distance of two rods; arms of 1, pairs of rods of 2.
RADIUS, INNER, HALF = 1.0, 0.3, 0.2
AIMED = (0.15, -0.1, -1.7)


def arms() -> list[tuple[Any, float]]:
    """The direction in which every arm stands from the axis, and its angle at the start."""
    found = []
    for k in range(3):
        out = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0])
        d = AIMED + (INNER - RADIUS) * out
        a, b, c = d @ out, -d[2], (d @ d - 3) / 2
        found.append((out, float(np.arctan2(b, a) - np.arccos(c / np.hypot(a, b)))))
    return found


def delta() -> str:
    """A platform with six coordinates, three arms and six rods of one length, which leave three freedoms."""
    bodies = [
        "{name: platform, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z, f, h, p], mass: 1, "
        "rotation: {axes: [1, 2, 3], angles: [f, h, p]}, inertia about: mass centre, inertia: [1/50, 1/50, 1/30]}"
    ]
    ties = []
    for k, (out, _) in enumerate(arms()):
        at = ", ".join(f"{RADIUS * x:.17f}" for x in out)
        bodies.append(
            f"{{name: arm{k}, attached to: 0, connection point: [{at}], mass: 1, mass centre: [1/2, 0, 0], "
            f"rotation: {{axes: [3, 2], angles: [{k}*2*pi/3, t{k}]}}, inertia about: mass centre, "
            "inertia: [0, 1/12, 1/12]}"
        )
        for side in (HALF, -HALF):
            end = INNER * out + side * np.array([-out[1], out[0], 0])
            point = ", ".join(f"{x:.17f}" for x in end)
            ends = f"[{{body: arm{k}, point: [1, {side}, 0]}}, {{body: platform, point: [{point}]}}]"
            ties.append(f"distance: {{between: {ends}, length: 2}}")
    start = dict(zip("xyz", AIMED, strict=True)) | dict.fromkeys("fhp", 0.0)
    start |= {f"t{k}": angle for k, (_, angle) in enumerate(arms())}
    lists = {"bodies": bodies, "loads": ["uniform gravity: {vector: [0, 0, -981/100]}"], "constraints": ties}
    text = "".join(f"{key}:\n" + "".join(f"  - {one}\n" for one in listed) for key, listed in lists.items())
    told = ", ".join(f"{name}: {value:.17f}" for name, value in start.items())
    return f"mbsym: 1\nname: delta\n{text}initial: {{{told}}}\n"


@cache
def by_parallel_rods(end: float) -> tuple[float, ...]:
    """x, y, z of a platform that keeps its directions: one rod an arm, three multipliers, by hand."""
    from scipy.integrate import solve_ivp

    outs, angles = zip(*arms(), strict=True)
    up = np.array([0, 0, 1.0])

    def rates(_: float, state: Any) -> Any:
        x, v = state[:6], state[6:]
        table, right = np.zeros((9, 9)), np.zeros(9)
        table[:6, :6] = np.diag([1, 1, 1, 1 / 3, 1 / 3, 1 / 3])
        right[2] = -GRAVITY
        for k, out in enumerate(outs):
            c, s = np.cos(x[3 + k]), np.sin(x[3 + k])
            tip, slope = c * out - s * up, -s * out - c * up
            rod = x[:3] + (INNER - RADIUS) * out - tip
            right[3 + k] = GRAVITY / 2 * c
            row = np.zeros(6)
            row[:3], row[3 + k] = rod, -rod @ slope
            rate = v[:3] - slope * v[3 + k]
            table[6 + k, :6], table[:6, 6 + k] = row, row
            right[6 + k] = -(rate @ rate) - rod @ tip * v[3 + k] ** 2
        return np.concatenate([v, np.linalg.solve(table, right)[:6]])

    run = solve_ivp(rates, (0, end), [*AIMED, *angles, *np.zeros(6)], "DOP853", rtol=3e-14, atol=1e-15)
    return tuple(map(float, run.y[:3, -1]))


def coordinates(names: str, truth: Callable[[], tuple[float, ...]]) -> Callable[[Dynamics, Any], float]:
    """How far coordinates are from true values, which are found when they are wanted."""

    def wrong(dynamics: Dynamics, state: Any) -> float:
        places = [dynamics.system.coordinates.index(name) for name in names]
        return float(np.max(np.abs(np.asarray(state, dtype=float)[places] - truth())))

    return wrong


def on_the_axis(dynamics: Dynamics, state: Any) -> float:
    return float(np.max(np.abs(state - [float(x) for x in reference("ivp_caraxis")["reference"]["y"][:8]])))


PENDULUM = chain(1).replace("initial: {x0: 1", "initial: {x0: -1")


def forty() -> Problem:
    wrong = first_bar(by_one_angle(40, 20.0))
    return Problem("A02 forty four-bars", lambda: described(four_bars(40)), 20.0, 1e-3, wrong)


def problems(large: bool) -> Iterator[Problem]:
    """By name and target."""
    yield Problem("A01 pendulum, Cartesian", lambda: described(PENDULUM), 10.0, 1e-6, bob)
    x, y = (float(value) for value in reference("iftomm_a02_n_four_bar")["reference"]["recomputed"]["N=2"]["10"])
    told = "OpenSim 3.2: 0.455 s (i5-4570)"
    for target in (1e-3, 1e-6, 1e-9):
        yield Problem("A02 two four-bars", lambda: described(four_bars(2)), 10.0, target, first_bar((x, y)), told)
    for number, name in ((1, "one four-bar"), (10, "ten four-bars")):
        wrong = first_bar(by_one_angle(number, 10.0))
        yield Problem(f"A02 {name}", lambda number=number: described(four_bars(number)), 10.0, 1e-6, wrong)  # type: ignore[misc]
    yield Problem("car axis", lambda: shipped("car-axis"), 3.0, 1e-8, on_the_axis)
    left, right = by_directions(3.0)
    yield Problem(
        "five-bar, bars 2, 3, 2, 3 over 3", lambda: described(five_bar()), 3.0, 1e-8, directions(p=left, s=right)
    )
    yield Problem(
        "Bennett's linkage, a = 3, b = 4", lambda: described(BENNETT), 5.0, 1e-8, directions(q1=by_bennett(5.0))
    )
    yield Problem(
        "Stewart platform, legs with mass",
        lambda: described(stewart()),
        2.0,
        1e-8,
        coordinates("xyzh", lambda: by_forces_of_legs(2.0)),
    )
    yield Problem(
        "delta robot, six rods",
        lambda: described(delta()),
        2.0,
        1e-8,
        coordinates("xyz", lambda: by_parallel_rods(2.0)),
    )
    if large:
        yield forty()
    for target in (1e-4, 1e-8, 1e-12):
        yield Problem("A03 Andrews' squeezer", lambda: shipped("andrews-squeezer"), 0.03, target, squeezed)


@dataclass(frozen=True)
class Measured:
    """At the loosest tolerance 10^``power`` that reaches the target; seconds of processor time."""

    power: int
    error: float
    steps: int
    seconds: float
    before: float


def error_at(problem: Problem, dynamics: Dynamics, power: int) -> float:
    """At the end of a run with the tolerance 10^``power``."""
    run = METHODS["dop853"].start(dynamics, Setting(tolerance=10.0**power))
    return problem.wrong(dynamics, run.advance(problem.end))


def measured(problem: Problem) -> Measured:
    begun = time.process_time()
    dynamics = Dynamics(closed(problem.made()).scenario)
    METHODS["dop853"].start(dynamics, Setting(tolerance=1e-3))
    before = time.process_time() - begun
    power = next(k for k in range(-3, -15, -1) if error_at(problem, dynamics, k) <= problem.target)
    spent = []
    for _ in range(REPEATS):
        run = METHODS["dop853"].start(dynamics, Setting(tolerance=10.0**power))
        started = time.process_time()
        state = run.advance(problem.end)
        spent.append(time.process_time() - started)
    return Measured(power, problem.wrong(dynamics, state), run.work.steps, float(np.median(spent)), before)


def line(problem: Problem, found: Measured) -> str:
    told = f"tolerance 1e{found.power}, error {found.error:.1e}, {found.steps} steps, {found.seconds * 1e3:.3g} ms"
    further = f"; {problem.published}" if problem.published else ""
    return f"{problem.name}: {told} (before: {found.before:.2f} s){further}"


def row(problem: Problem, found: Measured) -> str:
    cells = (problem.name, f"{problem.end:g}", f"1e{found.power}", f"{found.error:.1e}", f"{found.steps}")
    return "| " + " | ".join((*cells, f"{found.seconds * 1e3:.2g} ms", problem.published)) + " |"


def chain_of_ten() -> str:
    """Equations and machine code of ten pendulums in Cartesian coordinates."""
    begun = time.process_time()
    dynamics = Dynamics(described(chain(10)))
    compiled_kernel(dynamics, "right_hand_side")
    spent, operations = time.process_time() - begun, dynamics.right_hand_side.operations
    return f"chain of ten pendulums: {operations} operations, equations and machine code {spent:.2f} s; PyDy: 3906 s"


def bicycle() -> str:
    """Operations with parameters as names (constants once), and with their numbers."""
    analysis = mbsym.load(SHIPPED / "bicycle.yaml", (3,))
    found = analysis.constraints
    kept = [(found.names[i].constraint, found.names[i].component) for i in found.independent]
    dynamics = constrained_dynamics(analysis.system, analysis.ring, Chosen(tuple(kept)))
    named = dynamics.program.operations(dynamics.accelerations, constants(analysis.system))
    numbers = Dynamics(scenario(analysis.system)).right_hand_side.operations
    return f"bicycle, right-hand side: {named} operations with named parameters, {numbers} with numbers"


def main() -> None:
    if "--forty" in sys.argv[1:]:
        print(json.dumps(asdict(measured(forty()))))
        return
    told = row if "--table" in sys.argv[1:] else line
    for problem in problems("--large" in sys.argv[1:]):
        print(told(problem, measured(problem)), flush=True)
    if told is row:
        return
    print(chain_of_ten(), flush=True)
    print(bicycle(), flush=True)


if __name__ == "__main__":
    main()
