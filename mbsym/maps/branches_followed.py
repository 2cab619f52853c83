"""Branches followed in floating point, for pictures and for which equilibrium a branch tends to.

Newton's method in the coordinates, from the sample outwards; nothing that is proved rests on it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbsym.algebra.generators import occurring
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.maps.branches_curve import Curve

Array = Any  # numpy.ndarray of floats

#: Points of a branch over an interval, on either side of its sample.
POINTS = 40
#: The last of them is so near to the end, as a part of the interval.
NEAR = 1e-7
#: Steps of Newton's method at one value of the parameter, and when they are small enough.
MOST_STEPS, SMALL = 12, 1e-11


class Floats:
    """Polynomials of a ring at floating-point numbers of coordinates and one parameter."""

    def __init__(self, ring: Ring, parameter: str) -> None:
        self.ring, self.parameter = ring, parameter
        self._tables: dict[int, tuple[Any, list[tuple[float, tuple[tuple[int, int], ...]]]]] = {}

    def __call__(self, x: Polynomial, values: Mapping[str, float]) -> float:
        return self._total(x, values, {})

    def _total(self, x: Polynomial, values: Mapping[str, float], known: dict[int, float]) -> float:
        if id(x) not in self._tables:
            terms = [
                (float(int(c.p)) / float(int(c.q)), tuple((k, int(e)) for k, e in enumerate(m) if e))
                for m, c in x.terms()
            ]
            self._tables[id(x)] = x, terms
        total = 0.0
        for coefficient, powers in self._tables[id(x)][1]:
            for k, e in powers:
                if k not in known:
                    known[k] = self._generator(k, values, known)
                coefficient *= known[k] ** e
            total += coefficient
        return total

    def _generator(self, k: int, values: Mapping[str, float], known: dict[int, float]) -> float:
        g = self.ring.generators[k]
        if g.kind in ("sine", "cosine") and g.argument is None:
            angle = values[g.name] / g.denominator
            return math.sin(angle) if g.kind == "sine" else math.cos(angle)
        if g.kind == "root":
            return math.sqrt(self._total(g.argument, values, known))
        if g.kind == "reciprocal":
            return 1 / self._total(g.argument, values, known)
        if g.kind in ("coordinate", "parameter"):
            return math.pi if g.name == "pi" else values[g.name]
        raise KeyError(g.name)


def followed(
    curve: Curve, start: Sequence[float], sample: float, low: float, high: float
) -> tuple[list[float], list[tuple[float, ...]], bool, bool]:
    """(values of the parameter, coordinates there, whether the lower end was reached, and the upper one)."""
    numbers = Floats(curve.ring, curve.parameter)
    below, reached_low = _outwards(curve, numbers, start, sample, low)
    above, reached_high = _outwards(curve, numbers, start, sample, high)
    whole = [*reversed(below), (sample, tuple(start)), *above]
    return [p for p, _ in whole], [q for _, q in whole], reached_low, reached_high


def _outwards(
    curve: Curve, numbers: Floats, start: Sequence[float], sample: float, end: float
) -> tuple[list[tuple[float, tuple[float, ...]]], bool]:
    found: list[tuple[float, tuple[float, ...]]] = []
    q = np.array(start, dtype=float)
    before: tuple[float, Array] | None = None
    at = sample
    for k in range(1, POINTS + 1):
        # evenly at first, then dense towards the end, where branches meet like square roots
        half = 2 * k / POINTS
        p = end + (sample - end) * (1 - 0.9 * half if half <= 1 else 0.1 * (10 * NEAR) ** (half - 1))
        guess = q if before is None else q + (q - before[1]) * ((p - at) / (at - before[0]))
        corrected = _newton(curve, numbers, guess, p)
        if corrected is None or np.max(np.abs(corrected - q)) > 0.6:
            corrected = _newton(curve, numbers, q, p)
        if corrected is None or np.max(np.abs(corrected - q)) > 0.6:
            return found, False
        before, q, at = (at, q), corrected, p
        found.append((p, tuple(float(x) for x in q)))
    return found, True


def _newton(curve: Curve, numbers: Floats, guess: Array, p: float) -> Array | None:
    q = np.array(guess, dtype=float)
    for _ in range(MOST_STEPS):
        values = {**dict(zip(curve.names, q.tolist(), strict=True)), curve.parameter: p}
        try:
            f = np.array([numbers(x, values) for x in curve.forcing])
            slopes = np.array([[numbers(x, values) for x in row] for row in curve.slopes])
            step = np.linalg.solve(slopes, f)
        except (ValueError, ArithmeticError, KeyError, np.linalg.LinAlgError):
            return None
        q = q - step
        if not np.all(np.isfinite(q)):
            return None
        if np.max(np.abs(step)) < SMALL * (1 + np.max(np.abs(q))):
            return q
    return None


def uses_only_known(ring: Ring, polynomials: Sequence[Polynomial]) -> bool:
    """Whether all generators are of a kind that ``Floats`` evaluates."""
    pending, seen = [*occurring(polynomials)], set()
    while pending:
        k = pending.pop()
        if k in seen:
            continue
        seen.add(k)
        g = ring.generators[k]
        if g.kind not in ("sine", "cosine", "root", "reciprocal", "coordinate", "parameter"):
            return False
        if g.argument is not None:
            pending += occurring([g.argument])
    return True
