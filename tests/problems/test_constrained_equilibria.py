"""Rests under constraints: lists and verdicts by hand, and against the angle that the constraints leave free."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import system_of
from scipy.optimize import brentq, fsolve

import mbsym
from mbsym.algebra.failures import Constrained
from mbsym.analysis.resting import relative_equilibria
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import Equilibria
from mbsym.problems.stability.words import Because, Word

HEAD = "mbsym: 1\nname: Tied\n"

LADDER = (
    HEAD
    + """
parameters: {m: {positive: true, value: 2}, l: {positive: true, value: 1}, k: {positive: true, value: 20},
  g: {positive: true, value: 10}}
bodies:
  - {name: rod, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [q]}, coordinates: [x, y, q],
     mass: m, inertia about: mass centre, inertia: [0, m*l**2/12, m*l**2/12]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {between: [{body: rod, point: [l/2, 0, 0]}, {body: 0, point: [0, 0, 0]}], stiffness: k, length: 0}
constraints: [{relation: y + l/2*sin(q) = 0}, {relation: x - l/2*cos(q) = 0}]
"""
)

BOWL = (
    HEAD
    + """
parameters: {a: {positive: true, value: 1}, b: {positive: true, value: 2}, g: {value: 10}, h: {value: 3}}
bodies: [{name: P, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 1}]
loads: [{uniform gravity: {vector: [h, 0, -g]}}]
constraints: [{relation: z - (a*x**2 + b*y**2)/2 = 0}]
"""
)

SPHERE = (
    HEAD
    + """
bodies: [{name: P, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: 1}]
loads: [{uniform gravity: {vector: [0, 0, -10]}}]
constraints: [{relation: x**2 + y**2 + z**2 = 1}]
"""
)

DOUBLE = (
    HEAD
    + """
parameters: {l1: {positive: true, value: 1}, l2: {positive: true, value: 3/2}}
bodies:
  - {name: A, attached to: 0, connection point: [x1, y1, 0], coordinates: [x1, y1], mass: 1}
  - {name: B, attached to: 0, connection point: [x2, y2, 0], coordinates: [x2, y2], mass: 2}
loads: [{uniform gravity: {vector: [0, -10, 0]}}]
constraints:
  - distance: {between: [{body: A, point: [0, 0, 0]}, {body: 0, point: [0, 0, 0]}], length: l1}
  - distance: {between: [{body: B, point: [0, 0, 0]}, {body: A, point: [0, 0, 0]}], length: l2}
"""
)

#: A bar is m = 1; lengths A, B, C; the ground D.
FOUR_BAR = (
    HEAD
    + """
parameters: {A: {positive: true, value: 1}, B: {positive: true, value: 2}, C: {positive: true, value: 3/2},
  D: {positive: true, value: 2}, gx: {value: 0}, gy: {value: -10}}
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [p]}, mass centre: [A/2, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, A**2/12, A**2/12]}
  - {name: b, attached to: a, connection point: [A, 0, 0], rotation: {axes: [3], angles: [q]}, mass centre: [B/2, 0, 0],
     mass: 1, inertia about: mass centre, inertia: [0, B**2/12, B**2/12]}
  - {name: c, attached to: 0, connection point: [D, 0, 0], rotation: {axes: [3], angles: [s]},
     mass centre: [C/2, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, C**2/12, C**2/12]}
loads: [{uniform gravity: {vector: [gx, gy, 0]}}]
constraints: [{coincide: [{body: b, point: [B, 0, 0]}, {body: c, point: [C, 0, 0]}]}]
"""
)

SLIDER_CRANK = (
    HEAD
    + """
parameters: {r: {positive: true, value: 1}, l: {positive: true, value: 3}, k: {positive: true, value: 5}}
bodies:
  - {name: crank, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [r/2, 0, 0], mass: 1,
     inertia about: mass centre, inertia: [0, 1/12, 1/12]}
  - {name: rod, attached to: crank, connection point: [r, 0, 0], rotation: {axes: [3], angles: [b]},
     mass centre: [l/2, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, 1/12, 1/12]}
loads:
  - uniform gravity: {vector: [0, -10, 0]}
  - spring: {between: [{body: rod, point: [l, 0, 0]}, {body: 0, point: [3, 0, 0]}], stiffness: k, length: 0}
constraints: [{relation: r*sin(a) + l*sin(a + b) = 0}]
"""
)


def listed(text: str, **values: Fraction | int) -> Equilibria:
    system = system_of(text)
    return relative_equilibria(system, given_values(system, {name: Fraction(x) for name, x in values.items()}))


def states(found: Equilibria) -> dict[tuple[float, ...], str]:
    return {tuple(round(x.value, 6) for x in one.values): str(one.verdict.word) for one in found.equilibria}


def approx(expected: Mapping[tuple[float, ...], str]) -> dict[tuple[float, ...], str]:
    return {tuple(round(x, 6) + 0.0 for x in place): word for place, word in expected.items()}


def test_a_ladder_held_by_a_spring() -> None:
    """V = m g l/2 sin b + k l^2/2 cos^2 b with b = -q:  cos b = 0, or sin b = m g/(2 k l) = 1/2, where

    V'' = -m g l/2 sin b - k l^2 cos 2b = -15 < 0; at b = +-pi/2 it is 20 -+ 10 > 0.
    """
    found = listed(LADDER)
    assert found.complete
    h, c = math.pi / 2, math.sqrt(3) / 4
    expected = {(0, 0.5, -h): "stable", (0, -0.5, h): "stable"}
    expected |= {(c, 0.25, -math.pi / 6): "unstable", (-c, 0.25, -5 * math.pi / 6): "unstable"}
    assert states(found) == approx(expected)


def test_a_stiff_ladder_hangs_or_leans_and_a_soft_one_only_hangs() -> None:
    """m g/(2 k l) = 2 > 1: of cos b = 0 the upper place has V'' = k l^2 - m g l/2 = 5 - 10 < 0."""
    assert states(listed(LADDER, k=5)) == approx({(0, -0.5, math.pi / 2): "stable", (0, 0.5, -math.pi / 2): "unstable"})


@pytest.mark.parametrize(("g", "word"), [(10, "stable"), (-10, "unstable")])
def test_a_ball_in_a_tilted_bowl_and_on_a_dome(g: int, word: str) -> None:
    """V = g z - h x on z = (a x^2 + b y^2)/2: a x = h/g, y = 0; Hess V = g diag(a, b)."""
    x = 3 / g
    assert states(listed(BOWL, g=g)) == approx({(x, 0, x * x / 2): word})


def test_a_particle_on_a_sphere_told_by_three_coordinates() -> None:
    found = listed(SPHERE)
    assert found.complete
    assert states(found) == {(0, 0, -1): "stable", (0, 0, 1): "unstable"}


def test_a_double_pendulum_told_by_constraints_is_that_in_angles() -> None:
    """Four places, each mass below or above what carries it; only the lowest is a minimum."""
    found = listed(DOUBLE)
    assert found.complete
    expected = {(0, -1, 0, -2.5): "stable"}
    expected |= dict.fromkeys([(0, 1, 0, 2.5), (0, 1, 0, -0.5), (0, -1, 0, 0.5)], "unstable")
    assert states(found) == approx(expected)


def four_bar_by_hand(a: float, b: float, c: float, d: float, gx: float, gy: float) -> dict[tuple[float, ...], str]:
    """The loop is closed by hand for every crank angle; extrema of the potential along both branches."""
    found = {}
    for branch in (1, -1):

        def closed(p: float, branch: int = branch) -> tuple[float, float, float] | None:
            x, y = a * math.cos(p), a * math.sin(p)
            far = math.hypot(d - x, -y)
            cosine = (b * b + far * far - c * c) / (2 * b * far)
            if abs(cosine) > 1:
                return None
            direction = math.atan2(-y, d - x) + branch * math.acos(cosine)
            ex, ey = x + b * math.cos(direction), y + b * math.sin(direction)
            return direction, ex, ey

        def potential(p: float) -> float:
            place = closed(p)
            assert place is not None
            _, ex, ey = place
            x, y = a * math.cos(p), a * math.sin(p)
            return -gx * (x / 2 + (x + ex) / 2 + (d + ex) / 2) - gy * (y / 2 + (y + ey) / 2 + ey / 2)

        def slope(p: float) -> float:
            return (potential(p + 1e-5) - potential(p - 1e-5)) / 2e-5

        grid = np.linspace(-math.pi + 0.0003, math.pi + 0.0003, 4000)
        for low, high in pairwise(grid):
            if any(closed(x + e) is None for x in (low, high) for e in (-1e-4, 1e-4)) or slope(low) * slope(high) > 0:
                continue
            rising = slope(high) > 0
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (low, middle) if (slope(middle) > 0) == rising else (middle, high)
            place = closed(low)
            assert place is not None
            direction, ex, ey = place
            angles = (low, direction - low, math.atan2(ey, ex - d))
            turned = tuple(round(math.remainder(x, 2 * math.pi), 3) + 0.0 for x in angles)
            found[turned] = "stable" if rising else "unstable"
    return found


@pytest.mark.parametrize("gravity", [(0, -10), (4, -7)])
def test_a_four_bar_under_gravity(gravity: tuple[int, int]) -> None:
    """Grashof: the crank turns wholly, and no position is singular."""
    found = listed(FOUR_BAR, gx=gravity[0], gy=gravity[1])
    assert found.complete
    assert all(x.proof == "exact" for x in found.equilibria)
    rounded = {tuple(round(x.value, 3) + 0.0 for x in one.values): one.verdict.word for one in found.equilibria}
    assert rounded == four_bar_by_hand(1, 2, 1.5, 2, *gravity)


def test_a_rest_in_a_singular_position_is_told_as_such() -> None:
    """A parallelogram with all links in line along gravity: J has rank 1 there, 2 elsewhere; f = J^T lambda holds."""
    found = listed(FOUR_BAR, A=1, C=1, B=2, D=2, gx=10, gy=0)
    singular = [x for x in found.equilibria if x.verdict.because(Because.RANK_LOST)]
    assert {tuple(x.text for x in one.values) for one in singular} == {("0", "0", "0"), ("pi", "pi", "pi")}
    assert {one.verdict.word for one in singular} == {"undecided"}
    assert any("constraints are singular" in str(x) for x in found.remarks)


def test_a_slider_crank_with_a_spring() -> None:
    """V = 10 (sin a/2 + sin a/2) + 5/2 (e - 3)^2 along both branches e = cos a +- sqrt(9 - sin^2 a)."""
    expected = {}
    for branch in (1, -1):

        def potential(a: float, branch: int = branch) -> float:
            return 10 * math.sin(a) + 2.5 * (math.cos(a) + branch * math.sqrt(9 - math.sin(a) ** 2) - 3) ** 2

        grid = np.linspace(-math.pi, math.pi, 20001)
        values = [potential(x) for x in grid]
        for k in range(1, len(grid) - 1):
            if (values[k] - values[k - 1]) * (values[k + 1] - values[k]) < 0:
                expected[round(float(grid[k]), 2), branch] = "stable" if values[k] < values[k - 1] else "unstable"
    found = listed(SLIDER_CRANK)
    assert found.complete
    told = {}
    for one in found.equilibria:
        a, b = (x.value for x in one.values)
        told[round(a, 2), 1 if math.cos(a + b) > 0 else -1] = str(one.verdict.word)
    assert told == expected


def test_angles_outside_sines_are_searched_wherever_the_spring_may_be_wound() -> None:
    """A torsional spring in the crank: 10 cos a + 5 a = 0 has one root, -1.0299; two branches of the rod."""
    spring = "  - spring: {coordinate: a, stiffness: k}\n"
    text = "".join(spring if "between" in line else line for line in SLIDER_CRANK.splitlines(keepends=True))
    found = listed(text)
    assert found.complete  # the crank goes round: 10 cos a = -5 a beyond 2 has no root
    assert any("none lies farther out" in remark for remark in found.remarks)
    assert sorted(round(one.values[0].value, 4) for one in found.equilibria) == [-1.0299, -1.0299]
    assert {one.verdict.word for one in found.equilibria} == {"stable"}


def test_a_knife_edge_rests_where_gravity_is_across_it() -> None:
    """f + J^T lambda = (g + lambda sin psi, -lambda cos psi, 0): cos psi = 0, wherever it is."""
    text = (
        HEAD
        + """
bodies:
  - {name: B, attached to: 0, connection point: [x, y, 0], rotation: {axes: [3], angles: [psi]},
     coordinates: [x, y, psi], mass: 1, inertia about: mass centre, inertia: [1, 1, 1]}
loads: [{uniform gravity: {vector: [10, 0, 0]}}]
constraints: [{velocity: x_dot*sin(psi) - y_dot*cos(psi) = 0}]
"""
    )
    found = listed(text)
    assert found.complete
    assert [[x.text for x in one.values] for one in found.equilibria] == [["pi/2"], ["-pi/2"]]
    assert {one.free for one in found.equilibria} == {("x", "y")}
    assert not any(one.verdict.stable for one in found.equilibria)


def test_what_symmetries_do_not_carry_is_refused() -> None:
    """x = y^2 follows unevenly where y = v t: that no coordinate without a rate rests is no list of nothing."""
    text = (
        HEAD
        + """
bodies: [{name: B, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: 1}]
constraints: [{relation: x = y**2}]
motion: {y: {rate: 2}}
"""
    )
    with pytest.raises(Constrained, match="constraints tie what moves"):
        listed(text)


def test_the_result_of_a_description_knows_constraints() -> None:
    assert len(mbsym.loads(SPHERE).equilibria.equilibria) == 2


def test_all_rests_of_a_five_bar() -> None:
    """Two degrees of freedom.  Each place by d'Alembert with numbers: grad V in the range of J^T, the loop closed.

    And as many are reached from many points by the same conditions, w_k (s_k + 9 c_k) + e_k (s_k a - c_k b) = 0.
    """
    text = (
        FOUR_BAR.replace("C: {positive: true, value: 3/2},", "C: {positive: true, value: 3/2}, E: {value: 2},")
        .replace("loads:", _FIFTH + "loads:")
        .replace("{body: c, point: [C, 0, 0]}", "{body: e, point: [E, 0, 0]}")
        .replace(
            "attached to: a, connection point: [A, 0, 0]", "attached to: 0, connection point: [A*cos(p), A*sin(p), 0]"
        )
    )
    found = listed(text, A=2, B=3, C=2, E=3, D=3, gx=1, gy=-9)
    assert found.complete

    def conditions(x: Any) -> Any:
        c, s, (a, b) = np.cos(x[:4]), np.sin(x[:4]), x[4:]
        signs = np.array([1, 1, -1, -1])
        moments = np.array([3, 1, 3, 1]) * (s + 9 * c) + signs * (s * a - c * b)
        sides = signs * np.array([2, 3, 2, 3])
        return [*moments, sides @ c - 3, sides @ s]

    source, reached = np.random.default_rng(5), set[tuple[float, ...]]()
    for _ in range(600):
        start = [*source.uniform(-np.pi, np.pi, 4), *source.normal(0, 20, 2)]
        x, _, success, _ = fsolve(conditions, start, full_output=True, xtol=1e-13)
        if success == 1 and np.abs(conditions(x)).max() < 1e-9:
            reached.add(tuple(np.round(np.concatenate([np.cos(x[:4]), np.sin(x[:4])]), 5) + 0.0))
    assert len(found.equilibria) == len(reached) == 14
    for one in found.equilibria:
        p, q, s, w = (x.value for x in one.values)
        directions = (p, q, s, s + w)
        lengths, signs = (2, 3, 2, 3), (1, 1, -1, -1)
        along = [size * np.exp(1j * x) for size, x in zip(lengths, directions, strict=True)]
        assert abs(sum(sign * x for sign, x in zip(signs, along, strict=True)) - 3) < 1e-8
        turned = [1j * x for x in along]  # derivatives by the directions of the bars
        jacobian = np.array([[f(sign * x) for sign, x in zip(signs, turned, strict=True)] for f in (np.real, np.imag)])
        weights = (3 / 2, 1 / 2, 3 / 2, 1 / 2)  # half of its own bar, and the bar that it carries
        slope = np.array([weight * (x.real * 1 - 9 * x.imag) for weight, x in zip(weights, turned, strict=True)])
        _, residue, *_ = np.linalg.lstsq(jacobian.T, slope, rcond=None)
        assert float(residue[0]) < 1e-12


_FIFTH = """  - {name: e, attached to: c, connection point: [C, 0, 0], rotation: {axes: [3], angles: [w]},
     mass centre: [E/2, 0, 0], mass: 1, inertia about: mass centre, inertia: [0, E**2/12, E**2/12]}
"""


@pytest.mark.parametrize(
    ("relation", "singular"),
    [
        ("y**2 = x**3", True),  # a cusp: pressed into it by the force (-1, 0), which no multiple of (0, 0) balances
        ("y**2 = x**2*(x + 1)", True),  # a node in the origin
        ("y**2 = x**3 + 1", False),  # (3 x^2, 2 y) = 0 only in the origin, which is not on it
    ],
)
def test_a_rest_that_needs_unbounded_reactions_is_told_not_to_be_counted(relation: str, singular: bool) -> None:
    """V = x + y^2 on a curve: in a singular point J = 0, and V' = (1, 0) there, so that f + J^T lambda = 0 has no
    solution; near the cusp (t^2, t^3) the motion has L = (4 t^2 + 9 t^4) t'^2/2 - t^2 - t^6: the path turns there at
    any speed, and what holds a rest in it has no bound."""
    text = HEAD + (
        "bodies: [{name: P, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: 1}]\n"
        f"loads: [{{potential: x + y**2}}]\nconstraints: [{{relation: {relation}}}]\n"
    )
    found = listed(text)
    assert found.complete
    assert any("unbounded reactions" in remark for remark in found.remarks) is singular


# --- rests that no exact solution lists ---


def searched(
    potential: Callable[[Any], Any], tied: Callable[[Any], list[Any]], bounds: Sequence[float], starts: int = 400
) -> set[tuple[float, ...]]:
    """Where grad V + lambda grad phi = 0, phi = 0 within ``bounds``: Newton's method from many points, nothing else.

    Derivatives by a complex step, and those of the gradients by differences.
    """
    n, m = len(bounds), len(tied(np.zeros(len(bounds))))

    def slope(of: Callable[[Any], Any], q: Any) -> Any:
        return np.array([np.imag(of(q + 1e-30j * e)) / 1e-30 for e in np.eye(n)])

    def residual(z: Any) -> Any:
        q, held = z[:n].astype(complex), z[n:]
        rows = np.array([slope(lambda x, k=k: tied(x)[k], q) for k in range(m)])  # type: ignore[misc]
        return np.array([*(slope(potential, q) + held @ rows), *np.real(tied(q))])

    source, found = np.random.default_rng(5), set()
    for _ in range(starts):
        z = np.array([*(source.uniform(-b, b) for b in bounds), *source.normal(size=m) * 5])
        for _ in range(40):
            value = residual(z)
            steps = np.array([(residual(z + 1e-6 * e) - residual(z - 1e-6 * e)) / 2e-6 for e in np.eye(n + m)]).T
            change = np.linalg.lstsq(steps, -value, rcond=None)[0]
            z = z + change * min(1.0, 0.7 / max(1e-12, float(np.abs(change[:n]).max())))
            if np.abs(change[:n]).max() < 1e-12:
                break
        if np.abs(residual(z)).max() < 1e-8 and (np.abs(z[:n]) <= np.array(bounds)).all():
            found.add(tuple(round(float(x), 4) + 0.0 for x in z[:n]))
    return found


def turned_within(found: Equilibria, angles: Sequence[int]) -> set[tuple[float, ...]]:
    """What is listed, with all turns of ``angles`` (by their places) in (-2 pi, 2 pi)."""
    every = set()
    for one in found.equilibria:
        values = [x.value for x in one.values]
        for turns in product((-2 * math.pi, 0, 2 * math.pi), repeat=len(angles)):
            moved = [x + (turns[angles.index(k)] if k in angles else 0) for k, x in enumerate(values)]
            every.add(tuple(round(x, 4) + 0.0 for x in moved))
    return every


TORSION = "loads: [{spring: {coordinate: s, stiffness: 4}}, {uniform"
WISHBONES = (
    HEAD
    + """
bodies:
  - {name: lower, attached to: 0, rotation: {axes: [1], angles: [p]}, mass centre: [0, 1/5, 0], mass: 2,
     inertia about: mass centre, inertia: [1/10, 1/10, 1/10]}
  - {name: upright, attached to: lower, connection point: [0, 2/5, 0], rotation: {axes: [1], angles: [q]},
     mass centre: [0, 0, 1/10], mass: 10, inertia about: mass centre, inertia: [1/5, 1/5, 1/5]}
  - {name: upper, attached to: 0, connection point: [0, 1/10, 1/4], rotation: {axes: [1], angles: [s]},
     mass centre: [0, 3/20, 0], mass: 1, inertia about: mass centre, inertia: [1/10, 1/10, 1/10]}
loads:
  - uniform gravity: {vector: [0, 0, -10]}
  - spring: {between: [{body: lower, point: [0, 3/10, 0]}, {body: 0, point: [0, 1/5, 1/2]}], stiffness: 300,
     length: 1/2}
constraints: [{coincide: [{body: upright, point: [0, 0, 1/4]}, {body: upper, point: [0, 3/10, 0]}]}]
"""
)


def bars(q: Any) -> tuple[Any, ...]:
    """Ends of the bars 1 and 2 of a four-bar and of the bar 3/2 on the ground 2, as x and y."""
    x, y = np.cos(q[0]), np.sin(q[0])
    ends = x + 2 * np.cos(q[0] + q[1]), y + 2 * np.sin(q[0] + q[1])
    return x, y, *ends, 2 + 1.5 * np.cos(q[2]), 1.5 * np.sin(q[2])


def four_bar_with_torsion(q: Any) -> Any:
    _, y, _, end, _, other = bars(q)
    return 10 * (y / 2 + (y + end) / 2 + other / 2) + 2 * q[2] ** 2


def closed(q: Any) -> list[Any]:
    _, _, x, y, u, v = bars(q)
    return [x - u, y - v]


def wishbones(q: Any) -> Any:
    p, b, s = q
    weights = 2 * np.sin(p) / 5 + 10 * (2 * np.sin(p) / 5 + np.cos(p + b) / 10) + 3 * np.sin(s) / 20
    apart = np.sqrt((0.3 * np.cos(p) - 0.2) ** 2 + (0.3 * np.sin(p) - 0.5) ** 2)
    return 10 * weights + 150 * (apart - 0.5) ** 2


def wishbones_closed(q: Any) -> list[Any]:
    p, b, s = q
    across = 0.4 * np.cos(p) - np.sin(p + b) / 4 - 0.1 - 0.3 * np.cos(s)
    return [across, 0.4 * np.sin(p) + np.cos(p + b) / 4 - 0.25 - 0.3 * np.sin(s)]


def test_a_four_bar_with_a_torsional_spring_in_its_rocker() -> None:
    """The rocker may be put in with any number of turns of its spring, so no list ends; within 10 it has 15 places.

    With the pivots of one elimination seven of them were found.
    """
    found = listed(FOUR_BAR.replace("loads: [{uniform", TORSION))
    assert any("within 10" in remark for remark in found.remarks)
    assert not any("undecided" in remark for remark in found.remarks)
    truth = searched(four_bar_with_torsion, closed, (math.pi, math.pi, 10))
    assert truth
    assert truth <= turned_within(found, (0, 1))
    assert len(found.equilibria) == 15
    places = [[x.value for x in one.values] for one in found.equilibria]
    assert len(truth) == len([x for x in places if max(map(abs, x[:2])) <= math.pi])


def test_a_double_wishbone_is_listed_completely() -> None:
    """Bisection over all positions, where the exact solution is not finished."""
    found = listed(WISHBONES)
    assert found.complete
    angles = (math.pi,) * 3
    assert searched(wishbones, wishbones_closed, angles) == {
        tuple(round(x.value, 4) for x in one.values) for one in found.equilibria
    }
    assert sorted(str(one.verdict.word) for one in found.equilibria) == ["stable", "stable", "unstable", "unstable"]


def test_rests_at_positions_in_which_a_pivot_vanishes() -> None:
    """A bead of weight 10 on x^2 + y^2 = 4 sin(1/2): it hangs and stands at x = 0, where 2 x, the shortest factor of
    the multiplier, is zero; a sphere cut at x = sin(1/2) the same, at y = 0."""
    bead = HEAD + (
        "bodies: [{name: P, attached to: 0, connection point: [x, y, 0], coordinates: [x, y], mass: 1}]\n"
        "loads: [{uniform gravity: {vector: [0, -10, 0]}}]\nconstraints: [{relation: x**2 + y**2 = 4*sin(1/2)}]\n"
    )
    found, height = listed(bead), 2 * math.sqrt(math.sin(0.5))
    assert found.complete
    assert states(found) == approx({(0, -height): "stable", (0, height): "unstable"})
    cut = SPHERE.replace("{relation: x**2", "{relation: x = sin(1/2)}, {relation: x**2")
    found, x, z = listed(cut), math.sin(0.5), math.cos(0.5)
    assert found.complete
    assert states(found) == approx({(x, 0, -z): "stable", (x, 0, z): "unstable"})


def test_a_wheel_with_an_eccentric_mass_on_a_slope_is_held_by_a_spring() -> None:
    """x = -f and the mass centre at (x - sin f/4, cos f/4), against a search of its own."""
    text = HEAD + (
        "bodies: [{name: W, attached to: 0, connection point: [x, 0, 0], rotation: {axes: [3], angles: [f]},\n"
        "  coordinates: [x, f], mass centre: [0, 1/4, 0], mass: 1, inertia about: mass centre, inertia: [1, 1, 1]}]\n"
        "loads: [{uniform gravity: {vector: [10*sin(pi/12), -10*cos(pi/12), 0]}},\n"
        "  {spring: {coordinate: x, stiffness: 2}}]\nconstraints: [{relation: x + f = 0}]\n"
    )

    def potential(q: Any) -> Any:
        x, f = q
        along, up = x - np.sin(f) / 4, np.cos(f) / 4
        return -10 * (math.sin(math.pi / 12) * along - math.cos(math.pi / 12) * up) + x**2

    found = listed(text)
    assert found.complete
    assert searched(potential, lambda q: [q[0] + q[1]], (8, 8), 100) == {
        tuple(round(x.value, 4) for x in one.values) for one in found.equilibria
    }


def test_rests_of_a_linkage_with_more_rows_than_angles() -> None:
    """Bennett's linkage, five rows on three angles, of which two are independent: q3 = -q1, tan(q1/2) tan(q2/2) = 5.

    Heights of its bars along that branch are extreme where they are listed.
    """
    text = (Path(__file__).parents[1] / "cases" / "constraints" / "bennett-no.yaml").read_text(encoding="utf-8")
    found = listed(text.replace("b: {value: 5", "b: {value: 4").replace("q2: 1, q3: -1", "q2: 2.9, q3: -1"))

    def turned(angle: float, axis: int) -> Any:
        c, s = math.cos(angle), math.sin(angle)
        return np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if axis == 0 else [[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def height(q: float) -> float:
        first = turned(q, 2)
        second = first @ turned(math.atan(3 / 4), 0) @ turned(2 * math.atan2(5 * math.cos(q / 2), math.sin(q / 2)), 2)
        third = second @ turned(math.atan(4 / 3), 0) @ turned(-q, 2)
        return float(((1.5 + 3 + 3) * first[:, 0] + (2 + 4) * second[:, 0] + 1.5 * third[:, 0])[2])

    grid = np.linspace(-math.pi, math.pi, 4001)
    slopes = np.diff([height(q) for q in grid])
    extreme = {
        (round(float(grid[k + 1]), 2), "stable" if slopes[k] < 0 else "unstable")
        for k in range(len(slopes) - 1)
        if slopes[k] * slopes[k + 1] < 0
    }
    assert {(round(one.values[0].value, 2), str(one.verdict.word)) for one in found.equilibria} == extreme
    for one in found.equilibria:
        q1, q2, q3 = (x.value for x in one.values)
        assert math.tan(q1 / 2) * math.tan(q2 / 2) == pytest.approx(5)
        assert q3 == pytest.approx(-q1)


DEGENERATE = """mbsym: 1
name: bead
parameters: {k: real}
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads: [potential: POTENTIAL]
CONSTRAINTS
motion: MOTION
values: {k: 1}
"""


@pytest.mark.parametrize(
    ("potential", "constraints", "motion", "word"),
    [
        # V = cos x + x^2/2 = 1 + x^4/24 - ...: x = 0 is a threefold root of x = sin x, and x stands outside of the sine
        ("y + k*x**2/2", "constraints: [relation: y = cos(x)]", "{x: 0, y: 1}", "stable"),
        # V = y - x^2 with y = 1 - exp(-x^2) = x^2 - x^4/2 + ...
        ("y - k*x**2", "constraints: [relation: y + exp(-x**2) = 1]", "{}", "unstable"),
        # V' = exp(x - 1) - x has a double root at x = 1: no minimum
        ("exp(x - 1) - x**2/2 + k*y**2", "", "{x: 1, y: 0}", "unstable"),
    ],
)
def test_the_rest_that_is_described_is_listed(potential: str, constraints: str, motion: str, word: str) -> None:
    """Where no search finds a multiple root of what is not algebraic."""
    text = DEGENERATE.replace("POTENTIAL", potential).replace("CONSTRAINTS\n", constraints and constraints + "\n")
    analysis = mbsym.loads(text.replace("MOTION", motion))
    listed = analysis.equilibria.equilibria
    assert [one.verdict.word.value for one in listed] == [word]
    assert analysis.stability.numerical.word.value == word


GEARS = """
mbsym: 1
name: two pendulums by gears
bodies:
  - {name: A, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [1, 0, 0], mass: 1}
  - {name: B, attached to: 0, rotation: {axes: [3], angles: [b]}, mass centre: [0, -1, 0], mass: 1}
loads: [uniform gravity: {vector: [0, -1, 0]}, potential: K*a**2/2]
constraints: [relation: RELATION]
"""


@pytest.mark.parametrize(
    ("relation", "ratio"), [("a + 2*b = 0", -2), ("b = -a/2", -2), ("3*a = 3*b", 1), ("a/4 + b/4 = 0", -1)]
)
@pytest.mark.parametrize("stiffness", ["0", "1/10"])
def test_angles_that_gears_tie(relation: str, ratio: int, stiffness: str) -> None:
    """V = K a^2/2 + sin a - cos b with a = ratio b: its stationary values by SciPy, up to turns without a spring."""
    k = float(Fraction(stiffness))

    def slope(b: float) -> float:
        return float(ratio * (k * ratio * b + np.cos(ratio * b)) + np.sin(b))

    bounds = np.linspace(-np.pi, np.pi, 500) if not k else np.linspace(-21, 21, 5000)
    wanted = sorted(brentq(slope, *pair) for pair in pairwise(bounds) if slope(pair[0]) * slope(pair[1]) < 0)
    found = listed(GEARS.replace("RELATION", relation).replace("K", stiffness))
    assert found.complete
    places = [{x.name: x.value for x in one.values} for one in found.equilibria]
    assert sorted(x["b"] for x in places) == pytest.approx(wanted, abs=1e-8)
    for x in places:
        turns = (x["a"] - ratio * x["b"]) / (2 * np.pi)
        assert turns == pytest.approx(0 if k else round(turns), abs=1e-8)
    for one, b in zip(found.equilibria, [x["b"] for x in places], strict=True):
        assert (one.verdict.word is Word.STABLE) is (slope(b + 1e-5) > slope(b - 1e-5))


@pytest.mark.parametrize("load", ["", "damper: {coordinate: p, coefficient: 1}"])
def test_where_nothing_acts_every_position_that_is_allowed_is_an_equilibrium(load: str) -> None:
    """Of a loop: none is listed, and the list does not pretend to be complete; those under gravity stand above."""
    text = FOUR_BAR[: FOUR_BAR.index("loads:")] + "loads: [LOAD]\n" + FOUR_BAR[FOUR_BAR.index("constraints:") :]
    found = listed(text.replace("LOAD", load), A=2, B=3, C=2, D=3)
    assert found.everywhere
    assert not found.equilibria
    assert not found.families
    assert not found.complete


BEAD_ON_A_TABLE = """
mbsym: 1
name: E
parameters: {w: real}
PRESCRIBED
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [phi]}, MASS}
  - {name: bead, attached to: table, connection point: [x, y, 0], coordinates: [x, y], mass: 1}
constraints: [{relation: (x - 1/2)**2 + y**2 = 1}]
MOTION
"""


@pytest.mark.parametrize("given", [True, False])
def test_where_something_turns_not_every_position_is_an_equilibrium(given: bool) -> None:
    """A bead on a circle about (1/2, 0): the turning table leaves it the farthest place and, unstable, the nearest.

    Of a table that turns freely the amended potential p^2/(2 (I + r^2)) has its minimum there.
    """
    text = BEAD_ON_A_TABLE.replace("PRESCRIBED", "prescribed: {phi: {rate: w}}" if given else "")
    inertia = "mass: 0" if given else "mass: 1, inertia about: mass centre, inertia: [1, 1, 1]"
    text = text.replace("MASS", inertia).replace("MOTION", "" if given else "motion: {phi: {rate: w}, x: 3/2, y: 0}")
    found = listed(text, w=2)
    assert found.complete
    assert not found.everywhere
    far, near = found.equilibria
    assert [x.value for x in far.values] == [1.5, 0]
    assert far.verdict.word is (Word.STABLE if given else Word.STABLE_BUT_CYCLIC)
    assert [x.value for x in near.values] == [-0.5, 0]
    assert near.verdict.word is Word.UNSTABLE
    assert listed(text, w=0).everywhere


LOADED_BALL = """
mbsym: 1
name: B
bodies:
  - {name: centre, attached to: 0, connection point: [x, y, 1/2], coordinates: [x, y], mass: 0}
  - {name: ball, attached to: centre, rotation: {axes: AXES, angles: [a, b, c]}, mass: 2, mass centre: [CENTRE],
     inertia about: mass centre, inertia: [1/5, 1/4, 3/10]}
loads: [{uniform gravity: {vector: [0, 0, -9]}}]
constraints: [{rolling: {body: ball, point: [0, 0, -1/2], axes: centre, on: ground}}]
"""


@pytest.mark.parametrize(("axes", "centre"), [("[1, 2, 3]", "0, 0, -1/10"), ("[3, 1, 2]", "0, -1/10, 0")])
def test_a_loaded_ball_has_two_rests_whatever_it_is_turned_by_about_the_vertical(axes: str, centre: str) -> None:
    """The load below or above; turned by any angle about it the same rest is told by (a, b) and (a + pi, pi - b)."""
    found = listed(LOADED_BALL.replace("AXES", axes).replace("CENTRE", centre))
    assert found.complete
    below, above = found.equilibria
    assert below.verdict.word is Word.STABLE_BUT_CYCLIC
    assert above.verdict.word is Word.UNSTABLE
