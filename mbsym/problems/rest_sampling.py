"""Solutions of conditions of rest from many starting points: found, not proved, and perhaps not all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.states import SEED

#: Starting points of a search from many points.
STARTS = 400


def turned(value: float, denominator: int = 1) -> float:
    """The same angle in (-pi, pi]."""
    period = 2 * math.pi * denominator
    return value - period * math.ceil((value - period / 2) / period - 1e-12)


def from_many_points(
    ring: Ring,
    equations: Sequence[Polynomial],
    slopes: Sequence[Sequence[Polynomial]],
    names: Sequence[str],
    bounds: Sequence[tuple[float, float]],
) -> list[list[float]]:
    """Where damped Newton iterations from random points end, without repetition; found, not proved."""
    import numpy as np

    source = np.random.default_rng(SEED)
    n = len(names)
    q = np.array([source.uniform(low, high, STARTS) for low, high in bounds])
    value = _vectorised(ring, [*equations, *(x for row in slopes for x in row)], names)
    for _ in range(60):
        with np.errstate(all="ignore"):
            found = np.array(value(q))
        f, jacobian = found[:n], found[n:].reshape(n, n, -1)
        matrices = np.moveaxis(jacobian, 2, 0)
        usable = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(f).all(axis=0)
        change = np.zeros_like(q)
        damping = 1e-14 * np.eye(n)
        normal = np.einsum("kji,kjl->kil", matrices[usable], matrices[usable])
        scale = np.trace(normal, axis1=1, axis2=2)[:, None, None] + 1e-300
        right = np.einsum("kji,jk->ki", matrices[usable], f[:, usable])
        change[:, usable] = -np.linalg.solve(normal + scale * damping, right[..., None])[..., 0].T
        length = np.sqrt((change**2).sum(axis=0))
        q = q + change * np.minimum(1.0, 0.7 / np.maximum(length, 1e-300))
    ends: dict[tuple[float, ...], list[float]] = {}
    for k in range(STARTS):
        if usable[k] and length[k] < 1e-8:
            point = [float(x) for x in q[:, k]]
            for i, name in enumerate(names):
                if bounds[i][1] - bounds[i][0] > 2 * math.pi * ring.angles.get(name, 10**6):
                    point[i] = turned(point[i], ring.angles[name])
            ends.setdefault(tuple(round(x, 6) for x in point), point)
    return [ends[key] for key in sorted(ends)]


def _vectorised(ring: Ring, polynomials: Sequence[Polynomial], names: Sequence[str]) -> Callable[[Any], list[Any]]:
    """Values of polynomials at many points at once."""
    import numpy as np

    tables = [
        [(float(Fraction(int(c.p), int(c.q))), [(k, int(e)) for k, e in enumerate(m) if e]) for m, c in x.terms()]
        for x in polynomials
    ]

    def generator(index: int, q: Any, known: dict[int, Any]) -> Any:
        if index in known:
            return known[index]
        g = ring.generators[index]
        if g.argument is not None:
            table = [
                (float(Fraction(int(c.p), int(c.q))), [(k, int(e)) for k, e in enumerate(m) if e])
                for m, c in g.argument.terms()
            ]
            inner = total(table, q, known)
            outer: dict[str, Callable[[Any], Any]] = {
                "sine": np.sin,
                "cosine": np.cos,
                "root": np.sqrt,
                "reciprocal": lambda x: 1 / x,
                "exp": np.exp,
                "log": np.log,
                "atan": np.arctan,
            }
            known[index] = outer[g.name if g.kind == "function" else g.kind](inner)
        elif g.name == "pi":
            known[index] = np.pi
        else:
            plain = q[names.index(g.name)] if g.name in names else np.zeros(q.shape[1])
            inner = plain / g.denominator
            known[index] = {"sine": np.sin, "cosine": np.cos}.get(g.kind, lambda x: x)(inner)
        return known[index]

    def total(table: Sequence[tuple[float, list[tuple[int, int]]]], q: Any, known: dict[int, Any]) -> Any:
        result = np.zeros(q.shape[1])
        for coefficient, powers in table:
            term: Any = coefficient
            for index, exponent in powers:
                base = generator(index, q, known)
                term = term * (base if exponent == 1 else base**exponent)
            result = result + term
        return result

    def values(q: Any) -> list[Any]:
        known: dict[int, Any] = {}
        return [total(table, q, known) for table in tables]

    return values
