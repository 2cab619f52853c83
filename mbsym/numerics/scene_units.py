"""What a scene itself offers as units, so that nothing that is measured depends on kilogram, metre and second.

    rate omega    the largest of |q'_i|/X_i, sqrt(|q''_i|/X_i), sqrt(|dq''_i/dq_j| X_j/X_i), |dq''_i/dq'_j| X_j/X_i
    length X_i    of a coordinate: 1 of an angle; else |q_i|, else the largest sqrt(M_jj/M_ii) X_j of the others

all at the initial state.  In another unit of mass, length or time every one of them changes as its dimension says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite, sqrt
from typing import Any

from flint import ctx

from mbsym.mechanics.variables import angle_denominators
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.trade.digits import Truth


@dataclass(frozen=True)
class SceneUnits:
    """``sizes`` of the coordinates (exactly 1 for angles) and the ``rate``; both exact."""

    sizes: tuple[Fraction, ...]
    rate: Fraction

    @property
    def velocities(self) -> tuple[Fraction, ...]:
        return tuple(size * self.rate for size in self.sizes)


def scene_units(given: Scenario, truth: Truth) -> SceneUnits:
    """From balls at the initial state; what is not finite there (a singular position) is left out."""
    n = len(given.positions)
    angles = angle_denominators(given.system)
    masses = _values(truth, "mass matrix", given)
    diagonal = [masses[i * (n + 1)] if masses else 0.0 for i in range(n)]
    sizes = [1.0 if name in angles else 0.0 for name in given.system.coordinates]
    for i, position in enumerate(given.positions):
        if not sizes[i] and position:
            sizes[i] = abs(float(position))
    for i in range(n):
        if not sizes[i]:
            others = [
                sizes[j] * sqrt(diagonal[j] / diagonal[i]) for j in range(n) if diagonal[i] > 0 and diagonal[j] > 0
            ]
            sizes[i] = max(others, default=0.0) or 1.0
    exact = tuple(Fraction(size) for size in sizes)
    rates = [abs(float(v)) / x for v, x in zip(given.velocities, sizes, strict=True)]
    accelerations = _values(truth, "accelerations", given)
    rates += [sqrt(abs(a) / x) for a, x in zip(accelerations, sizes, strict=False)]
    slopes = _values(truth, "Jacobian", given)
    for place, slope in enumerate(slopes):
        i, j = divmod(place, 2 * n)
        scaled = abs(slope) * sizes[j % n] / sizes[i]
        rates.append(scaled if j >= n else sqrt(scaled))
    rates += [abs(float(rate)) for name, (_, rate) in given.prescribed.items() if name in angles]
    usual = max((x for x in rates if isfinite(x)), default=0.0)
    return SceneUnits(exact, Fraction(usual) if usual > 0 else Fraction(1))


def _values(truth: Truth, name: str, given: Scenario) -> list[float]:
    """Finite midpoints; nothing where the quantity is not measured."""
    if name not in truth.functions:
        return []
    with ctx.workprec(256):
        found = truth.functions[name](truth.inputs(given, Fraction(0), given.state))
        return [float(x.mid()) if x.is_finite() else float("nan") for x in found]


def in_units(units: SceneUnits, pattern: Sequence[Any]) -> tuple[Fraction, ...]:
    """A dimensionless pattern (q, q') in the units of the scene."""
    whole = (*units.sizes, *units.velocities)
    return tuple(Fraction(x) * unit for x, unit in zip(pattern, whole, strict=True))
