"""Published mechanisms: their descriptions, and where they are at the end, found without mbsym.

References are closed formulas, published digits, or equations of motion of their own under SciPy's DOP853: by hand in
few coordinates, or those of free bodies on which the constraints act (``tests/free_bodies.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.constrained.test_mechanisms import ANGLES, chain, four_bars, reference
from tests.free_bodies import (
    Rows,
    bodies_of,
    hinge,
    motion,
    placed,
    point,
    rim,
    rolling,
    spin,
    turn,
)

ROOT = Path(__file__).parents[1]
CASES = ROOT / "tests" / "cases" / "constraints"

#: By the name of a position or velocity its value at the end; of an angle that of exp(i angle).
Truth = Mapping[str, complex]

E1, E2, E3 = np.eye(3)


@dataclass(frozen=True)
class Mechanism:
    """A description that runs to ``end``, the errors that are wanted there, and what is true then.

    ``published`` is what others say they need, and who.
    """

    name: str
    text: str
    end: float
    targets: tuple[float, ...]
    truth: Callable[[float], Truth]
    published: str = ""
    method: str = "dop853"


def turned(angle: float) -> complex:
    return complex(np.exp(1j * angle))


def angle_about(axis: int, R: Any) -> complex:
    """exp(i angle) of a turn about a coordinate axis."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    return complex(R[one, one], R[other, one])


def written(name: str, bodies: list[str], loads: list[str], ties: list[str], start: Mapping[str, Any]) -> str:
    """A description; what it begins with as numbers, or as the text is to have it."""
    lists = {"bodies": bodies, "loads": loads, "constraints": ties}
    text = "".join(f"{key}:\n" + "".join(f"  - {one}\n" for one in listed) for key, listed in lists.items() if listed)
    told = ", ".join(f"{key}: {x if isinstance(x, str) else format(x, '.17f')}" for key, x in start.items())
    return f"mbsym: 1\nname: {name}\n{text}initial: {{{told}}}\n"


def by_free_bodies(
    masses: Sequence[float], inertias: Sequence[Any], rows: Rows, start: Any, end: float, **how: Any
) -> list[Any]:
    """(r, R) of each body at the end."""
    return bodies_of(motion(masses, inertias, rows, start, [0.0, end], **how)[:, -1])


def velocities(rows: Any, given: Sequence[tuple[Any, float]]) -> Any:
    """u with J u = 0 in which each of the given rows has its value: the least one."""
    whole = np.vstack([rows, *(row for row, _ in given)])
    return np.linalg.lstsq(whole, np.r_[np.zeros(len(rows)), [x for _, x in given]], rcond=None)[0]


def own(name: str) -> str:
    """A description of these tests."""
    return (ROOT / "tests" / "systems" / f"{name}.yaml").read_text(encoding="utf-8")


FALLING = chain(1).replace("initial: {x0: 1", "initial: {x0: -1")


def pendulum(end: float) -> Truth:
    """The closed form, elliptic functions."""
    x, y = reference("iftomm_a01_pendulum")["reference"]["xy"][f"{end:g}"]
    return {"x0": float(x), "y0": float(y)}


def car_axis(_: float) -> Truth:
    names = [f"{x}{rate}" for rate in ("", "_dot") for x in ("xl", "yl", "xr", "yr")]
    return dict(zip(names, map(float, reference("ivp_caraxis")["reference"]["y"][:8]), strict=True))


def squeezer(_: float) -> Truth:
    truth = reference("andrews_squeezer")["reference"]["recomputed_t003"]["q"]
    return dict(zip(ANGLES, map(float, truth), strict=True))


def by_one_angle(number: int) -> Callable[[float], Truth]:
    """So many four-bars move as one pendulum, I th'' = G sin th, th'(0) = -1."""
    inertia, weight = (number + 1) / 3 + number, ((number + 1) / 2 + number) * 9.81

    def truth(end: float) -> Truth:
        run = solve_ivp(
            lambda t, x: [x[1], weight / inertia * np.sin(x[0])], (0, end), [0, -1], "DOP853", rtol=3e-14, atol=1e-15
        )
        return {"th0": turned(run.y[0, -1])}

    return truth


#: Bennett's linkage with sin(alpha)/3 = sin(beta)/4 = 1/5, as q3 = -q1 and tan(q1/2) tan(q2/2) = 5 want it.
BENNETT = (
    (CASES / "bennett-no.yaml")
    .read_text(encoding="utf-8")
    .replace("b: {value: 5", "b: {value: 4")
    .replace("q2: 1", "q2: 2*atan(5*cos(1/2)/sin(1/2))")
)


def bennett(end: float) -> Truth:
    """Four hinges, twenty rows on three bodies, of which three follow from others."""
    alpha, beta = np.arctan2(3, 4), np.arctan2(4, 3)
    first = turn(2, 1)
    second = first @ turn(0, alpha) @ turn(2, 2 * np.arctan(5 / np.tan(0.5)))
    third = second @ turn(0, beta) @ turn(2, -1)
    a, b, joint = 1.5 * E1, 2 * E1, 3 * first[:, 0]
    start = [(first @ a, first), (joint + second @ b, second), (joint + second @ (2 * b) + third @ a, third)]

    def rows(bodies: list[Any], t: Any) -> tuple[Any, Any]:
        chained = [hinge(bodies, 1, -b, 0, a, E3), hinge(bodies, 2, -a, 1, b, E3)]
        ends = [hinge(bodies, 0, -a, None, None, E3), hinge(bodies, 2, a, None, None, turn(0, alpha) @ E3)]
        return np.vstack(chained + ends), 0.0

    found = by_free_bodies([1, 1, 1], [np.array([0.1, 1, 1])] * 3, rows, placed(start, np.zeros(18)), end)
    return {"q1": angle_about(2, found[0][1])}


#: IFToMM's A04: rods of square section, their axes at first along the edges of a cube.
BRICARD = (CASES / "bricard.yaml").read_text(encoding="utf-8")


def bricard(end: float) -> Truth:
    """Six hinges, thirty rows on five bodies, of which one follows from the others."""
    long, thick = 101 / 1200, 1 / 600
    along = [E1, -E2, E3, -E1, E2]
    axes = [E2, E3, E1, E2, E3]
    joint, start = np.zeros(3), []
    for rod in along:
        start.append((joint + rod / 2, np.eye(3)))
        joint = joint + rod

    def rows(bodies: list[Any], t: Any) -> tuple[Any, Any]:
        ends = [hinge(bodies, 0, -E1 / 2, None, None, E2), hinge(bodies, 4, E2 / 2, None, None, E1)]
        return np.vstack(
            ends + [hinge(bodies, k, -along[k] / 2, k - 1, along[k - 1] / 2, axes[k]) for k in range(1, 5)]
        ), 0.0

    tensors = [np.where(np.abs(rod) > 0, thick, long) for rod in along]
    found = by_free_bodies([1] * 5, tensors, rows, placed(start, np.zeros(30)), end, gravity=-9.81 * E2)
    return {"q1": angle_about(1, found[0][1]), "q2": angle_about(2, found[0][1].T @ found[1][1])}


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


def by_directions(end: float) -> Truth:
    """p and s of the five-bar at ``end``: two double pendulums in directions x of their bars by hand, tied at the ends.

    M x'' + c(x, x') = J^T lambda,  J x'' = -J' x'
    """
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
    return {"p": turned(run.y[0, -1]), "s": turned(run.y[2, -1])}


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
    return written("Stewart", bodies, loads, ties, start)


def by_forces_of_legs(end: float) -> Truth:
    """x, y, z, h of the platform by Newton and Euler in inertial axes, every leg being a force on its joint.

    A leg to P, L = |P - B| and u along it, has T = A v.v/2 + (m' - A) (u.v)^2/2 with
    A = (J + J' + m h^2 + m' (L - h')^2)/L^2; the force is d/dt dT/dv - dT/dP + dU/dP.
    """
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
    return dict(zip("xyzh", [*run.y[:3, -1], np.arcsin(run.y[5, -1])], strict=True))


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
    return written("delta", bodies, ["uniform gravity: {vector: [0, 0, -981/100]}"], ties, start)


def by_parallel_rods(end: float) -> Truth:
    """x, y, z of a platform that keeps its directions: one rod an arm, three multipliers, by hand."""
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
    return dict(zip("xyz", run.y[:3, -1], strict=True))


#: A double wishbone in space: arms about hinges that are not parallel, an upright on two ball joints, held by a rod.
WISHBONE_INERTIAS = ([1 / 20, 1 / 100, 1 / 20], [1 / 50, 1 / 100, 1 / 50], [3 / 10, 1 / 2, 3 / 10])
TILT, RACK = 0.1, np.array([-0.08, 0.12, 0.06])
WISHBONE = """mbsym: 1
name: double wishbone
bodies:
  - {name: lower, attached to: 0, rotation: {axes: [1], angles: [p]}, mass centre: [0, 1/5, 0], mass: 2,
     inertia about: mass centre, inertia: [1/20, 1/100, 1/20]}
  - {name: upper, attached to: 0, connection point: [0, 1/10, 1/4], rotation: {axes: [2, 1], angles: [1/10, s]},
     mass centre: [0, 3/20, 0], mass: 1, inertia about: mass centre, inertia: [1/50, 1/100, 1/50]}
  - {name: upright, attached to: lower, connection point: [1/50, 2/5, 0], mass centre: [0, 1/20, 3/25], mass: 10,
     rotation: {axes: [1, 2, 3], angles: [f, h, k]}, inertia about: mass centre, inertia: [3/10, 1/2, 3/10]}
loads:
  - uniform gravity: {vector: [0, 0, -981/100]}
  - spring: {between: [{body: lower, point: [0, 3/10, 0]}, {body: 0, point: [0, 1/5, 1/2]}], stiffness: 3000,
     length: 1/2}
  - damper: {between: [{body: lower, point: [0, 3/10, 0]}, {body: 0, point: [0, 1/5, 1/2]}], coefficient: 20}
constraints:
  - coincide: [{body: upright, point: [-(1 + cos(1/10))/50, 0, 1/4 + sin(1/10)/50]},
     {body: upper, point: [-1/50, 3/10, 0]}]
  - distance: {between: [{body: upright, point: [-1/10, 1/20, 1/20]}, {body: 0, point: [-2/25, 3/25, 3/50]}],
     length: sqrt(109/1000)}
initial: {p: 0, s: 0, f: 0, h: 0, k: 0}
"""


def wishbone(end: float) -> Truth:
    """Two hinges, two balls and a rod: seventeen rows on three bodies."""
    tilted, centre = turn(1, TILT), np.array([0, 0.05, 0.12])
    lower, upper = np.array([0.02, 0.2, 0]), np.array([-0.02, 0.15, 0])
    top = np.array([0, 0.1, 0.25]) + tilted @ [-0.02, 0.3, 0] - [0.02, 0.4, 0]
    start = [
        (np.array([0, 0.2, 0]), np.eye(3)),
        ([0, 0.1, 0.25] + tilted @ [0, 0.15, 0], tilted),
        (np.array([0.02, 0.4, 0]) + centre, np.eye(3)),
    ]
    arm, strut = np.array([-0.1, 0.05, 0.05]) - centre, np.array([0, 0.1, 0])

    def rows(bodies: list[Any], t: Any) -> tuple[Any, Any]:
        hinges = [hinge(bodies, 0, [0, -0.2, 0], None, None, E1), hinge(bodies, 1, [0, -0.15, 0], None, None, E1)]
        balls = [
            point(bodies, 2, -centre) - point(bodies, 0, lower),
            point(bodies, 2, top - centre) - point(bodies, 1, upper),
        ]
        r, R = bodies[2]
        return np.vstack([*hinges, *balls, (r + R @ arm - RACK)[None] @ point(bodies, 2, arm)]), 0.0

    def forces(bodies: list[Any], u: Any, t: float) -> Any:
        r, R = bodies[0]
        moves, apart = point(bodies, 0, strut), r + R @ strut - [0, 0.2, 0.5]
        long = np.sqrt(apart @ apart)
        along = apart / long
        return -moves.T @ along * (3000 * (long - 0.5) + 20 * along @ (moves @ u))

    found = by_free_bodies([2, 1, 10], WISHBONE_INERTIAS, rows, placed(start, np.zeros(18)), end, forces=forces)
    (_, low), (_, up), (_, upright) = found
    turned_by = low.T @ upright
    return {"p": angle_about(0, low), "s": angle_about(0, tilted.T @ up), "h": np.arcsin(turned_by[0, 2])}


#: SUNDIALS' idaSlCrank: a crank of 1/2 and a rod of 1, a spring with damper between their centres, a force on the rod.
SLIDER_CRANK = """mbsym: 1
name: slider-crank
bodies:
  - {name: crank, attached to: 0, rotation: {axes: [3], angles: [q]}, mass: 0, inertia about: joint, inertia: [0, 0, 1]}
  - {name: slider, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}
  - {name: rod, attached to: slider, rotation: {axes: [3], angles: [p]}, mass: 0, inertia about: joint,
     inertia: [0, 0, 2]}
loads:
  - spring: {between: [{body: crank, point: [1/4, 0, 0]}, {body: rod, point: [-1/2, 0, 0]}], stiffness: 1, length: 1}
  - damper: {between: [{body: crank, point: [1/4, 0, 0]}, {body: rod, point: [-1/2, 0, 0]}], coefficient: 1}
  - force function: x + cos(p)
constraints: [{coincide: [{body: crank, point: [1/2, 0, 0]}, {body: rod, point: [-1, 0, 0]}]}]
initial: {q: pi/2, x: cos(pi/6), p: -pi/6}
"""


def slider_crank(end: float) -> Truth:
    """I(q) q'' + I' q'^2/2 = Q with sin p = -sin(q)/2, x = cos p + cos(q)/2 (Haug, Intermediate Dynamics, 6.1.8)."""

    def geometry(q: float) -> tuple[float, ...]:
        s, c = np.sin(q), np.cos(q)
        p = np.arcsin(-s / 2)
        p1 = -c / 2 / np.cos(p)
        p2 = (s / 2 + np.sin(p) * p1**2) / np.cos(p)
        x1 = -np.sin(p) * p1 - s / 2
        return p, p1, p2, np.cos(p) + c / 2, x1, -np.cos(p) * p1**2 - np.sin(p) * p2 - c / 2

    def rates(_: float, state: Any) -> list[float]:
        q, v = state
        p, p1, p2, x, x1, x2 = geometry(q)
        apart = np.exp(1j * q) / 4 - (x - np.exp(1j * p) / 2)
        slope = 1j * np.exp(1j * q) / 4 - (x1 - 1j * p1 * np.exp(1j * p) / 2)
        long = abs(apart)
        grows = (apart.conjugate() * slope).real / long
        force = -(long - 1 + grows * v) * grows + x1 - np.sin(p) * p1
        return [v, (force - (x1 * x2 + 2 * p1 * p2) * v**2) / (1 + x1**2 + 2 * p1**2)]

    run = solve_ivp(rates, (0, end), [np.pi / 2, 0], "DOP853", rtol=3e-14, atol=1e-15)
    q = run.y[0, -1]
    return {"q": q, "p": geometry(q)[0], "x": geometry(q)[3]}


#: IFToMM's A05: Watt's governor whose couplers are springs with dampers, or (B) rods of the same length.
GOVERNOR = """mbsym: 1
name: flyball governor
bodies:
  - {name: shaft, attached to: 0, rotation: {axes: [3], angles: [psi]}, mass: 0, inertia about: joint,
     inertia: [0, 0, 5e-6]}
  - {name: slider, attached to: shaft, connection point: [0, 0, s], coordinates: [s], mass: 3, inertia about: joint,
     inertia: [1/200, 1/200, 1/200]}
  - {name: rod1, attached to: shaft, connection point: [1/20, 0, 1], rotation: {axes: [2], angles: [a]}, mass: 3/10,
     mass centre: [1/2, 0, 0], inertia about: mass centre, inertia: [5e-6, 0.0250025, 0.0250025]}
  - {name: ball1, attached to: rod1, connection point: [1, 0, 0], mass: 5}
  - {name: rod2, attached to: shaft, connection point: [-1/20, 0, 1], rotation: {axes: [3, 2], angles: [pi, b]},
     mass: 3/10, mass centre: [1/2, 0, 0], inertia about: mass centre, inertia: [5e-6, 0.0250025, 0.0250025]}
  - {name: ball2, attached to: rod2, connection point: [1, 0, 0], mass: 5}
loads:
  - uniform gravity: {vector: [0, 0, -981/100]}
COUPLERS
initial: {psi: {position: 0, velocity: 2*pi}, s: 1/2, a: pi/6, b: pi/6}
"""
ENDS = [
    f"[{{body: slider, point: [{x}/20, 0, 0]}}, {{body: rod{k}, point: [1/2, 0, 0]}}]" for k, x in ((1, 1), (2, -1))
]
STIFF = GOVERNOR.replace(
    "COUPLERS",
    "\n".join(
        f"  - spring: {{between: {one}, stiffness: 8e5, length: 1/2}}\n  - damper: {{between: {one}, coefficient: 4e4}}"
        for one in ENDS
    ),
)
COUPLED = GOVERNOR.replace(
    "COUPLERS", "constraints:\n" + "\n".join(f"  - distance: {{between: {one}, length: 1/2}}" for one in ENDS)
)


def governor(stiff: bool) -> Callable[[float], Truth]:
    """Both rods at one angle a below the level, I(a) psi' constant; with rigid couplers s = 1 - sin a."""
    across, along, mass, g = 0.0250025, 5e-6, 0.3, 9.81

    def moment(a: float) -> tuple[float, float]:
        """I and dI/da."""
        s, c = np.sin(a), np.cos(a)
        middle, end = 0.05 + c / 2, 0.05 + c
        whole = 5e-6 + 0.005 + 2 * (mass * middle**2 + across * c * c + along * s * s + 5 * end**2)
        return whole, 2 * (-mass * middle * s - 2 * (across - along) * s * c - 10 * end * s)

    swing = 2 * (mass / 4 + across + 5)
    start = np.pi / 6
    kept = moment(start)[0] * 2 * np.pi

    def rates(_: float, x: Any) -> list[float]:
        a, height, v, w = x[1:]
        s, c = np.sin(a), np.cos(a)
        inertia, slope = moment(a)
        rate = kept / inertia
        pull = slope * rate**2 / 2 + 2 * g * (mass / 2 + 5) * c
        if not stiff:  # the slider's 3 s'^2/2 + 3 g s is that of s = 1 - sin a
            turned_by = (pull + 3 * g * c + 3 * s * c * v * v) / (swing + 3 * c * c)
            return [rate, v, -c * v, turned_by, s * v * v - c * turned_by]
        high = 1 - s / 2 - height
        long = np.sqrt((c / 2) ** 2 + high**2)
        by_a, by_s = (-s * c / 4 - high * c / 2) / long, -high / long
        force = 2 * (8e5 * (long - 0.5) + 4e4 * (by_a * v + by_s * w))
        return [rate, v, w, (pull - force * by_a) / swing, -g - force * by_s / 3]

    def truth(end: float) -> Truth:
        how = (
            {"method": "Radau", "rtol": 1e-12, "atol": 1e-13}
            if stiff
            else {"method": "DOP853", "rtol": 3e-14, "atol": 1e-15}
        )
        run = solve_ivp(rates, (0, end), [0, start, 0.5, 0, 0], **how)
        psi, a, s = run.y[:3, -1]
        return {"psi": psi, "a": a, "b": a, "s": s}

    return truth


#: Chaplygin's sphere: three different moments of inertia, the mass centre in the middle.
BALL = """mbsym: 1
name: Chaplygin's sphere
parameters: {m: {value: 2, sign: positive}, r: {value: 0.5, sign: positive}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, r], coordinates: [x, y], mass: m}
  - {name: sphere, attached to: centre, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 0,
     inertia about: joint, inertia: [0.1, 0.15, 0.22], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {e: quaternion}}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - rolling: {body: sphere, point: [0, 0, -r], axes: centre, on: ground}
dependent: [x, y]
"""
BALL_START = "initial: {x: 0, y: 0, e0: 1, e1: 0, e2: 0, e3: 0, p: -1, q: 0.3, s: 2}\n"


def rolling_ball(bodies: list[Any], t: Any) -> tuple[Any, Any]:
    return rolling(bodies, 0, [0, 0, -0.5]), 0.0


TORUS = """mbsym: 1
name: A wheel that rolls, its tube of radius tube
parameters: {rho: {value: 0.4, sign: positive}, tube: {value: TUBE, sign: real}, g: {value: 9.81, sign: positive}}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 0}
  - {name: wheel, attached to: centre, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 1.5,
     inertia about: joint, inertia: [0.06, 0.12, 0.06], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {alpha: 1, beta: 2, gamma: 3}}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints:
  - rolling:
      body: wheel
      point: [-rho*gamma1/sqrt(gamma1**2 + gamma3**2) - tube*gamma1, -tube*gamma2,
              -rho*gamma3/sqrt(gamma1**2 + gamma3**2) - tube*gamma3]
      on: ground
  - relation: z = tube + rho*sqrt(1 - gamma2**2)
initial: {x: 0, y: 0, z: 0.5, alpha1: 1, alpha2: 0, alpha3: 0, beta1: 0, beta2: 1, beta3: 0, gamma1: 0, gamma2: 0,
          gamma3: 1, p: 0.4, q: 3, s: 0.5}
"""


def rolling_torus(tube: float) -> Rows:
    return lambda bodies, t: (rolling(bodies, 0, rim(bodies[0][1], E2, -E3, 0.4) - tube * E3), 0.0)


#: Kane and Levinson's rattleback (Int. J. Non-Linear Mechanics 17 (1982) 175): half an ellipsoid, spun the wrong way.
RATTLEBACK_AXES, RATTLEBACK_TENSOR = np.array([0.2, 0.03, 0.02]), [[2e-4, -2e-5, 0], [-2e-5, 16e-4, 0], [0, 0, 17e-4]]
RATTLEBACK = """mbsym: 1
name: rattleback
parameters: {a: 0.2, b: 0.03, c: 0.02}
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 0}
  - {name: celt, attached to: centre, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 1,
     mass centre: [0, 0, -1/100], inertia about: mass centre,
     inertia: [[2e-4, -2e-5, 0], [-2e-5, 16e-4, 0], [0, 0, 17e-4]], speeds: {p: omega1, q: omega2, s: omega3},
     orientation: {alpha: 1, beta: 2, gamma: 3}}
loads: [{uniform gravity: {vector: [0, 0, -981/100]}}]
constraints:
  - rolling:
      body: celt
      point: [-a**2*gamma1/sqrt(a**2*gamma1**2 + b**2*gamma2**2 + c**2*gamma3**2),
              -b**2*gamma2/sqrt(a**2*gamma1**2 + b**2*gamma2**2 + c**2*gamma3**2),
              -c**2*gamma3/sqrt(a**2*gamma1**2 + b**2*gamma2**2 + c**2*gamma3**2)]
      on: ground
  - relation: z = sqrt(a**2*gamma1**2 + b**2*gamma2**2 + c**2*gamma3**2)
initial: {x: 0, y: 0, z: sqrt(9e-4*sin(1/100)**2 + 4e-4*cos(1/100)**2), alpha1: 1, alpha2: 0, alpha3: 0,
          beta1: 0, beta2: cos(1/100), beta3: -sin(1/100), gamma1: 0, gamma2: sin(1/100), gamma3: cos(1/100),
          p: 0, q: 0, s: 5}
"""


def rolling_celt(bodies: list[Any], t: Any) -> tuple[Any, Any]:
    """The arm is from the mass centre, 1/100 below the middle of the ellipsoid."""
    R = bodies[0][1]
    low = RATTLEBACK_AXES**2 * R[2]
    return rolling(bodies, 0, R @ ([0, 0, 0.01] - low / np.sqrt(low @ R[2]))), 0.0


ATTITUDE = ("alpha", "beta", "gamma")


def rolled(
    mass: float, tensor: Any, rows: Rows, attitude: Any, w: Any, middle: Any, names: str
) -> Callable[[float], Truth]:
    """One body that rolls from above the origin: its middle, in body axes from the centre, and its attitude."""

    def truth(end: float) -> Truth:
        begun = [(-attitude @ middle, attitude)]
        turns = [(row, x) for row, x in zip(np.eye(6)[3:], w, strict=True)]
        start = placed(begun, velocities(rows(begun, 0.0)[0], turns))
        if names == "e":
            state = motion([mass], [tensor], rows, start, [0.0, end])[:, -1]
            return {"x": state[0], "y": state[1]} | {f"e{k}": state[3 + k] for k in range(4)}
        ((r, R),) = by_free_bodies([mass], [tensor], rows, start, end)
        x, y, _ = r + R @ middle
        return {"x": x, "y": y} | {
            f"{name}{k + 1}": R[ATTITUDE.index(name), k] for name in names.split() for k in range(3)
        }

    return truth


SPINNING = rolled(2, [0.1, 0.15, 0.22], rolling_ball, np.eye(3), [-1, 0.3, 2], np.zeros(3), "e")
TURNING = rolled(1.5, [0.06, 0.12, 0.06], rolling_torus(0.1), np.eye(3), [0.4, 3, 0.5], np.zeros(3), "alpha gamma")
RATTLING = rolled(1, RATTLEBACK_TENSOR, rolling_celt, turn(0, 0.01), [0, 0, 5], E3 / 100, "alpha gamma")


@dataclass(frozen=True)
class Axles:
    """Bodies in a plane one behind another, each with an axle that does not slip: of body k > 0 at -arm from the hinge
    that is at ``hinge`` of the body before, its mass centre at ``centre``; the first has its axle at its origin.
    """

    hinges: tuple[float, ...]
    arms: tuple[float, ...]
    centres: tuple[float, ...]
    masses: tuple[float, ...]
    angles: tuple[float, ...]
    spin: float

    @property
    def text(self) -> str:
        names = ["th", *(f"p{k}" for k in range(1, len(self.arms)))]
        heading = [" + ".join(names[: k + 1]) for k in range(len(names))]
        rate = [" + ".join(f"{name}_dot" for name in names[: k + 1]) for k in range(len(names))]
        bodies, ties = [], []
        for k, (at, arm, centre, mass) in enumerate(
            zip(self.hinges, self.arms, self.centres, self.masses, strict=True)
        ):
            place = "[x, y, 0], coordinates: [x, y, th]" if k == 0 else f"[{at}, 0, 0]"
            bodies.append(
                f"{{name: b{k}, attached to: {f'b{k - 1}' if k else 0}, connection point: {place}, mass: {mass}, "
                f"rotation: {{axes: [3], angles: [{names[k]}]}}, mass centre: [{centre}, 0, 0], "
                f"inertia about: mass centre, inertia: [{mass}/10, {mass}/10, {mass}/10]}}"
            )
            carried = "".join(
                f" + ({self.hinges[j]})*({rate[j - 1]})*cos({heading[j - 1]} - ({heading[k]}))" for j in range(1, k + 1)
            )
            ties.append(
                f"velocity: -x_dot*sin({heading[k]}) + y_dot*cos({heading[k]}){carried} - ({arm})*({rate[k]}) = 0"
            )
        start = {"x": "{position: 0, velocity: 1}", "y": "0", "th": f"{{position: 0, velocity: {self.spin}}}"}
        start |= {name: str(x) for name, x in zip(names[1:], self.angles, strict=True)}
        dependent = f"dependent: [{', '.join(['y', *names[1:]])}]\n"
        return written("axles", bodies, [], ties, start) + dependent

    def rows(self, bodies: list[Any], t: Any) -> tuple[Any, Any]:
        found = []
        for k, (at, arm, centre) in enumerate(zip(self.hinges, self.arms, self.centres, strict=True)):
            found.append((bodies[k][1] @ E2)[None] @ point(bodies, k, [-arm - centre, 0, 0]))
            if k:
                found.append(hinge(bodies, k, [-centre, 0, 0], k - 1, [at - self.centres[k - 1], 0, 0], E3))
        return np.vstack(found), 0.0

    def truth(self, end: float) -> Truth:
        place, angle, begun = np.zeros(3), 0.0, []
        for k, (at, centre) in enumerate(zip(self.hinges, self.centres, strict=True)):
            if k:
                place, angle = place + turn(2, angle) @ [at, 0, 0], angle + self.angles[k - 1]
            begun.append((place + turn(2, angle) @ [centre, 0, 0], turn(2, angle)))
        n, first = len(begun), self.centres[0] * E1
        given = [(point(begun, 0, -first)[0], 1.0), (spin(begun, 0)[2], self.spin)]
        start = placed(begun, velocities(self.rows(begun, 0.0)[0], given))
        tensors = [np.full(3, mass / 10) for mass in self.masses]
        found = by_free_bodies(self.masses, tensors, self.rows, start, end, gravity=np.zeros(3))
        r, R = found[0]
        x, y, _ = r - R @ first
        turns = {f"p{k}": angle_about(2, found[k - 1][1].T @ found[k][1]) for k in range(1, n)}
        return {"x": x, "y": y, "th": angle_about(2, R)} | turns


RACER = Axles((0, 0.5), (0, 0.3), (0.1, -0.1), (2, 1), (0.5,), 0.5)
TRAILERS = Axles((0, -0.3, -1, -1), (0, 1, 1, 1), (0.2, -0.8, -0.9, -1), (3, 1, 1, 1), (0.4, -0.3, 0.2), 0.6)

#: Whipple's bicycle begins with a lean, the angles that follow from it nearly.
BICYCLE = (ROOT / "systems" / "bicycle.yaml").read_text(encoding="utf-8").partition("initial:")[0] + (
    "initial: {x: 0, y: 0, yaw: 0, roll: {position: 1/20, velocity: 0}, steer: {position: 0, velocity: 0}, pitch: 0,\n"
    "  rear: {position: 0, velocity: -v/rR}, front: 0}\n"
)


def bicycle(end: float) -> Truth:
    """Two wheels, frame and fork: three hinges and two wheels that roll, twenty-one rows; z is down."""
    given = reference("bicycle_whipple")["parameters"]
    n = {name: np.pi / 10 if "pi" in x else float(x) for name, x in given.items()}
    speed, lean = 5.0, 0.05
    axis = np.array([np.sin(n["lam"]), 0, np.cos(n["lam"])])
    rear, front, crown = np.array([0, 0, -n["rR"]]), np.array([n["w"], 0, -n["rF"]]), np.array([n["w"] + n["c"], 0, 0])
    frame, fork = np.array([n["xB"], 0, n["zB"]]), np.array([n["xH"], 0, n["zH"]])
    radii, leaning = (n["rR"], n["rF"]), turn(0, lean)

    def at(pitch: float) -> list[Any]:
        """Rear wheel, frame, fork, front wheel; the rear wheel stands on the origin."""
        R, hub = leaning @ turn(1, pitch), leaning @ rear
        return [(hub + R @ (place - rear), R) for place in (rear, frame, fork, front)]

    def height(pitch: float) -> float:
        r, R = at(pitch)[3]
        return float((r + rim(R, E2, E3, radii[1]))[2])

    def rows(bodies: list[Any], t: Any) -> tuple[Any, Any]:
        hinges = [
            hinge(bodies, 1, rear - frame, 0, np.zeros(3), E2),
            hinge(bodies, 2, crown - fork, 1, crown - frame, axis),
            hinge(bodies, 2, front - fork, 3, np.zeros(3), E2),
        ]
        wheels = [
            rolling(bodies, k, rim(bodies[k][1], E2, E3, radius)) for k, radius in zip((0, 3), radii, strict=True)
        ]
        return np.vstack(hinges + wheels), 0.0

    begun = at(brentq(height, -0.1, 0.1, xtol=1e-16))
    s, c = np.sin(lean), np.cos(lean)
    yawing = leaning[:, 2] @ spin(begun, 1) / c  # of the frame, whose lean does not change
    still = [(E1 @ spin(begun, 1), 0.0), ((begun[1][1] @ axis) @ (spin(begun, 2) - spin(begun, 1)), 0.0)]
    wheel = leaning[:, 1] @ spin(begun, 0) - s * yawing, -speed / n["rR"]
    start = placed(begun, velocities(rows(begun, 0.0)[0], [*still, wheel]))
    masses = [n[f"m{x}"] for x in "RBHF"]
    tensors = [np.array([n[f"I{x}xx"], n[f"I{x}yy"], n[f"I{x}xx"]]) for x in "RF"]
    for x in "BH":
        across = n[f"I{x}xz"]
        tensors.insert(-1, np.array([[n[f"I{x}xx"], 0, across], [0, n[f"I{x}yy"], 0], [across, 0, n[f"I{x}zz"]]]))
    (hub, wheel_turned), (_, R), (_, H), _ = by_free_bodies(masses, tensors, rows, start, end, gravity=9.81 * E3)
    x, y, _ = hub + rim(wheel_turned, E2, E3, radii[0])
    across = turn(1, n["lam"]).T @ R.T @ H @ E2
    angles = {"yaw": complex(R[1, 1], -R[0, 1]), "steer": complex(across[1], -across[0])}
    return {"x": x, "y": y, "roll": np.arcsin(R[2, 1]), **{k: z / abs(z) for k, z in angles.items()}}


OPENSIM = "OpenSim 3.2: {} s to {} (i5-4570)"

#: In the order of the table.
MECHANISMS = (
    Mechanism("A01 pendulum, Cartesian", FALLING, 10, (1e-6,), pendulum, OPENSIM.format(0.637, 10)),
    Mechanism("A02, N = 1", four_bars(1), 10, (1e-6,), by_one_angle(1)),
    Mechanism("A02, N = 2", four_bars(2), 10, (1e-3, 1e-6, 1e-9), by_one_angle(2), OPENSIM.format(0.455, 10)),
    Mechanism("A02, N = 10", four_bars(10), 10, (1e-6,), by_one_angle(10)),
    Mechanism("A02, N = 40", four_bars(40), 10, (1e-6,), by_one_angle(40)),
    Mechanism(
        "A03 Andrews' squeezer",
        own("andrews-squeezer"),
        0.03,
        (1e-4, 1e-8, 1e-12),
        squeezer,
        OPENSIM.format(0.384, 0.05),
    ),
    Mechanism("A04 Bricard's mechanism", BRICARD, 9, (1e-4, 1e-8), bricard, OPENSIM.format(0.258, 10)),
    Mechanism(
        "A05 governor, stiff couplers", STIFF, 2, (1e-4, 1e-8), governor(True), OPENSIM.format(0.233, 10), "rodas5p"
    ),
    Mechanism("governor, rigid couplers", COUPLED, 10, (1e-8,), governor(False)),
    Mechanism("SUNDIALS' slider-crank", SLIDER_CRANK, 10, (1e-4, 1e-8), slider_crank),
    Mechanism("car axis", own("car-axis"), 3, (1e-8,), car_axis),
    Mechanism("five-bar, bars 2, 3, 2, 3 over 3", five_bar(), 3, (1e-8,), by_directions),
    Mechanism("Bennett's linkage, a = 3, b = 4", BENNETT, 5, (1e-8,), bennett),
    Mechanism("double wishbone, spatial", WISHBONE, 2, (1e-8,), wishbone),
    Mechanism("Stewart platform, legs with mass", stewart(), 2, (1e-8,), by_forces_of_legs),
    Mechanism("delta robot, six rods", delta(), 2, (1e-8,), by_parallel_rods),
    Mechanism("bicycle, from a lean of 1/20", BICYCLE, 3, (1e-8,), bicycle),
    Mechanism("rattleback", RATTLEBACK, 2, (1e-8,), RATTLING),
    Mechanism("rolling torus", TORUS.replace("TUBE", "0.1"), 4, (1e-8,), TURNING),
    Mechanism("Chaplygin's sphere", BALL + BALL_START, 6, (1e-8,), SPINNING),
    Mechanism("roller racer", RACER.text, 10, (1e-8,), RACER.truth),
    Mechanism("car with three trailers", TRAILERS.text, 10, (1e-8,), TRAILERS.truth),
)
