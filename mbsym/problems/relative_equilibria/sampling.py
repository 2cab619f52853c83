"""Solutions of conditions of rest from many starting points: found, not proved, and perhaps not all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Arrays
from mbsym.algebra.program import Program
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
            found = value(q)
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


def _vectorised(ring: Ring, polynomials: Sequence[Polynomial], names: Sequence[str]) -> Callable[[Any], Any]:
    """Values of polynomials at many points at once, by a straight-line program; what has no value there is 0."""
    import numpy as np

    program = Program()
    carry = Carrier(ring, program, {name: program.input(name) for name in ring.names()})
    outputs = [carry(x) for x in polynomials]

    def values(q: Any) -> Any:
        inputs = dict.fromkeys(ring.names(), 0.0) | {"pi": math.pi} | dict(zip(names, q, strict=True))
        found = program.evaluate(outputs, inputs, Arrays(inputs))
        return np.array([np.broadcast_to(x, q.shape[1:]) for x in found])

    return values
