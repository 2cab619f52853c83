"""Lists of equilibria and their verdicts against Newton's method from many points and energies by hand, at random.

Nothing of the solver is used here: conditions and second derivatives are SymPy's or Euler's, roots NumPy's.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy

import mbsym
from mbsym.problems.relative_equilibria.equilibria import RelativeEquilibrium, equilibria

X, Y = sympy.symbols("x y")


def potential(source: random.Random, kind: str) -> tuple[Any, list[bool]]:
    """V(x) or V(x, y), and which of its variables are angles."""

    def number(most: int = 3) -> sympy.Rational:
        return sympy.Rational(source.randint(-2 * most, 2 * most), 2)

    if kind == "polynomial":
        terms = [number() * X**i * Y**j for i in range(4) for j in range(4 - i) if source.random() < 0.6]
        return sum(terms) + (X**4 + Y**4) / 2, [False, False]
    if kind == "angles":
        waves = (sympy.cos(X), sympy.sin(Y), sympy.cos(X - Y), sympy.sin(X + Y), sympy.cos(2 * X))
        return sum(number() * wave for wave in waves), [True, True]
    if kind == "springs":
        springs = (abs(number()) + 1) / 3 * X**2 + (abs(number()) + 1) / 3 * (Y - X) ** 2
        return springs + number() * sympy.cos(X) + number() * sympy.sin(X + Y), [False, False]
    if kind == "hoop":
        rate = source.randint(1, 6)
        return 10 * sympy.sin(X) - sympy.Rational(rate**2, 2) * sympy.cos(X) ** 2 + number() * sympy.cos(X), [True]
    stretched = abs(number() + 4) * (X - 1) ** 2
    return stretched + number() * X * sympy.cos(Y) + number() * X * sympy.sin(Y) + number() * sympy.cos(Y), [
        False,
        True,
    ]


def apart(a: Sequence[float], b: Sequence[float], angles: Sequence[bool]) -> float:
    gaps = (math.remainder(p - q, 2 * math.pi) if angle else p - q for p, q, angle in zip(a, b, angles, strict=True))
    return max(abs(gap) for gap in gaps)


def zeros(slope: Any, curvature: Any, angles: Sequence[bool], seed: int) -> list[tuple[float, ...]]:
    """Newton's method from 250 points."""
    source = np.random.default_rng(seed)
    found: list[tuple[float, ...]] = []
    for _ in range(250):
        q = np.array([source.uniform(-4, 4) if angle else source.uniform(-9, 9) for angle in angles])
        for _ in range(60):
            f = np.array(slope(*q), dtype=float)
            step = np.linalg.lstsq(np.array(curvature(*q), dtype=float), f, rcond=None)[0]
            q = q - step * min(1.0, 0.5 / max(float(np.linalg.norm(step)), 1e-300))
        if np.abs(slope(*q)).max() < 1e-10 and all(apart(q, other, angles) > 1e-5 for other in found):
            found.append(tuple(q))
    return found


KINDS = ["polynomial", "angles", "springs", "hoop", "length and angle"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_every_rest_in_a_random_potential(kind: str, seed: int) -> None:
    V, angles = potential(random.Random(f"{kind} {seed}"), kind)
    names = ["x", "y"][: len(angles)]
    symbols = [X, Y][: len(angles)]
    gradient = [sympy.diff(V, v) for v in symbols]
    slope = sympy.lambdify(symbols, gradient)
    curvature = sympy.lambdify(symbols, [[sympy.diff(g, v) for v in symbols] for g in gradient])
    point = ", ".join([*names, "0", "0"][:3])
    text = (
        f"mbsym: 1\nname: random\nbodies:\n  - {{name: p, attached to: 0, connection point: [{point}], mass: 1, "
        f"coordinates: [{', '.join(names)}]}}\nloads:\n  - potential: {sympy.expand(V)}\n"
    )
    found = equilibria(mbsym.loads(text).system, {})
    assert not found.families
    ours = [tuple(item.value for item in one.values) for one in found.equilibria]
    if found.complete:
        for q in zeros(slope, curvature, angles, seed):
            assert any(apart(q, other, angles) < 1e-4 for other in ours), q
    for k, q in enumerate(ours):
        assert all(apart(q, other, angles) > 1e-6 for other in ours[:k]), "listed twice"
        assert np.abs(slope(*q)).max() < 1e-7
        least = float(np.linalg.eigvalsh(np.array(curvature(*q), dtype=float).reshape(len(q), -1))[0])
        if abs(least) > 1e-6:
            assert found.equilibria[k].verdict.word == ("stable" if least > 0 else "unstable")


# --- bodies that turn ------------------------------------------------------------------------------------------------

SEQUENCES = [(3, 1, 3), (3, 2, 3), (3, 1, 2), (3, 2, 1), (1, 2, 3), (2, 3, 1), (1, 2, 1)]


def seen_axis(one: RelativeEquilibrium, described: Sequence[int]) -> Any:
    """Axis 3 of the frame, in the axes of the body."""
    axes = list(described)
    if one.coordinates_of:
        axes = [int(x) for x in one.coordinates_of.partition("{")[2].rstrip("}").split(",")]
    values = {item.name: item.value for item in one.values}
    n = np.array([0.0, 0.0, 1.0])
    for axis, name in zip(axes, ("psi", "theta", "phi"), strict=True):
        i, j = axis % 3, (axis + 1) % 3
        c, s = math.cos(values.get(name, 0.3)), math.sin(values.get(name, 0.3))
        n[i], n[j] = c * n[i] + s * n[j], c * n[j] - s * n[i]
    return n


def skew(v: Any) -> Any:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def permanent(J: Any, h: Any, r: Any, W: float) -> list[Any]:
    """Unit vectors n parallel to W^2 J n + W h - r (gravity 1 along -n at the mass centre r), by Newton."""
    source = np.random.default_rng(0)
    found: list[Any] = []
    for _ in range(200):
        n = source.normal(size=3)
        n /= np.linalg.norm(n)
        factor = n @ (W * W * J * n + W * h - r)
        for _ in range(60):
            f = np.r_[W * W * J * n + W * h - r - factor * n, (n @ n - 1) / 2]
            slope = np.zeros((4, 4))
            slope[:3, :3], slope[:3, 3], slope[3, :3] = np.diag(W * W * J - factor), -n, n
            step = np.linalg.lstsq(slope, f, rcond=None)[0]
            scale = min(1.0, 1.0 / max(float(np.linalg.norm(step[:3])), 1e-300))
            n, factor = n - scale * step[:3], factor - scale * step[3]
        if np.abs(f).max() < 1e-12 and all(np.abs(n - other).max() > 1e-6 for other in found):
            found.append(n)
    return found


def growth(J: Any, h: Any, r: Any, W: float, n: Any) -> float:
    """The largest real part of J w' = (J w + h) x w + n x r, n' = n x w, linearised at w = W n."""
    w = W * n
    turning = np.diag(1 / J) @ (skew(J * w + h) - skew(w) @ np.diag(J))
    whole = np.block([[turning, -np.diag(1 / J) @ skew(r)], [skew(n), -skew(w)]])
    return float(np.linalg.eigvals(whole).real.max())


def most_definite(J: Any, h: Any, r: Any, W: float, n: Any) -> float:
    """The greatest least eigenvalue of the second variation of a combination of first integrals (w, n as variables).

    Of the energy, the area integral, n.n, and without gravity |J w + h|^2; on the common kernel of their differentials.
    """
    w, zero, one, inertia = W * n, np.zeros((3, 3)), np.eye(3), np.diag(J)
    momentum = J * w + h
    slopes = [np.r_[J * w, r], np.r_[J * n, momentum], np.r_[np.zeros(3), 2 * n]]
    curvatures = [
        np.block([[inertia, zero], [zero, zero]]),
        np.block([[zero, inertia], [inertia, zero]]),
        np.block([[zero, zero], [zero, 2 * one]]),
    ]
    if not r.any():
        slopes.append(np.r_[2 * J * momentum, np.zeros(3)])
        curvatures.append(np.block([[2 * inertia @ inertia, zero], [zero, zero]]))
    left, sizes, right = np.linalg.svd(np.array(slopes))
    rank = int((sizes > 1e-9 * sizes[0]).sum())
    kernel, free = right[rank:].T, left[:, rank:]
    forms = [
        kernel.T @ sum(c * H for c, H in zip(free[:, j], curvatures, strict=True)) @ kernel
        for j in range(free.shape[1])
    ]
    directions: Any = (
        [(1,), (-1,)] if len(forms) == 1 else [(math.cos(t), math.sin(t)) for t in np.linspace(0, 6.2832, 3001)]
    )
    assert len(forms) <= 2
    return max(float(np.linalg.eigvalsh(sum(c * S for c, S in zip(w_, forms, strict=True)))[0]) for w_ in directions)


@pytest.mark.parametrize("seed", range(14))
def test_every_permanent_rotation_of_a_random_body(seed: int) -> None:
    """In a turning frame, where the azimuth is any, or with the azimuth itself turning."""
    source = random.Random(seed)

    def number(low: int, high: int, parts: int = 4) -> Fraction:
        return Fraction(source.randint(low * parts, high * parts), parts)

    moments = [Fraction(0)] * 3
    while len({*moments}) < 3 or 2 * max(moments) >= sum(moments):
        moments = [number(2, 4) for _ in range(3)]
    centre = [Fraction(0)] * 3 if seed % 2 else [number(-1, 1, 16) / 4 for _ in range(3)]
    rotor = source.choice([[0, 0, 0], [0, 0, number(-3, 3)], [number(-2, 2), 0, number(-2, 2)]])
    rate = source.choice([Fraction(1), Fraction(2), Fraction(1, 2)])
    axes = source.choice(SEQUENCES)
    in_frame = axes[0] != 3 or source.random() < 0.5
    listed = {name: ", ".join(map(str, x)) for name, x in (("m", moments), ("c", centre), ("h", rotor), ("a", axes))}
    frame = "  - {name: frame, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}\n"
    text = (
        "mbsym: 1\nname: random\n"
        + (f"prescribed: {{chi: {{rate: {rate}}}}}\n" if in_frame else "")
        + "bodies:\n"
        + (frame if in_frame else "")
        + f"  - name: body\n    attached to: {'frame' if in_frame else '0'}\n"
        + f"    rotation: {{axes: [{listed['a']}], angles: [psi, theta, phi]}}\n    mass: 1\n"
        + f"    mass centre: [{listed['c']}]\n    inertia about: joint\n    inertia: [{listed['m']}]\n"
        + f"    gyrostatic moment: [{listed['h']}]\n"
        + "loads:\n  - uniform gravity: {vector: [0, 0, -1]}\n"
        + ("" if in_frame else f"motion: {{psi: {{value: 0, rate: {rate}}}}}\n")
    )
    found = equilibria(mbsym.loads(text).system, {})
    assert found.complete
    assert not found.families
    assert not found.singular
    J, h, r = (np.array([float(x) for x in part]) for part in (moments, rotor, centre))
    W = float(rate)
    expected = permanent(J, h, r, W)
    ours = [seen_axis(one, axes) for one in found.equilibria]
    for n in expected:
        assert any(np.abs(n - other).max() < 1e-4 for other in ours)
    assert len(ours) == len(expected)
    for n, one in zip(ours, found.equilibria, strict=True):
        margin = most_definite(J, h, r, W, n)
        if growth(J, h, r, W, n) > 1e-6:
            kind = "unstable"
        elif abs(margin) < 1e-6:
            continue  # too close to a border to be told in floating point
        else:
            kind = "stable" if margin > 0 else "gyroscopically"
        assert one.verdict.word.split(" ")[0] == kind
