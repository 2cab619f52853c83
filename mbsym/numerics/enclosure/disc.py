"""Where solutions are analytic in time: Picard's operator on functions of complex time.

Let p_i(s) be the Taylor polynomials of degree d of the solutions that start in a box H at t0, and x = p + r with series
r_i of terms of higher degree only, |r_i|_R <= e_i (the norm of ``model``).  Picard's operator leaves the terms up to
degree d what they are, and those beyond it are

    integral_0^s (terms of f(t0 + s', x(s')) of degree d and more),      |s^k integrated|_R = R |s^k|_R / (k + 1).

If their norm is at most e, all iterates stay there, and with them the solutions: they are analytic for |s| < R, and
what their series leave out after K > d terms at s = h is at most  e q^K,  q = h/R.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from flint import arb

from mbsym.numerics.enclosure.field import Field, cap
from mbsym.numerics.enclosure.model import LARGER, TINY, Model, Ring, model

#: How many radii are tried, each so much of the last, and how often e is made larger for each, and by how much.
TRIALS, SHORTER, WIDENED, ROOM = 60, 0.8, 3, 2.0


@dataclass(frozen=True)
class Disc:
    """A radius R, the solutions as models on it, whose rests are the e_i."""

    radius: float
    solutions: tuple[Model, ...]

    def tail(self, step: float, terms: int) -> list[arb]:
        """A bound of what the first ``terms`` > d coefficients leave out at ``step`` < R, for each component."""
        part = arb(step) / arb(self.radius)
        return [(arb(found.rest) * part**terms).abs_upper() for found in self.solutions]

    def within(self, radius: float) -> tuple[Model, ...]:
        """The solutions as models on a smaller disc: of the rests, all of degree d + 1 or more, less is left."""
        ring = Ring(self.solutions[0].ring.degree, radius)
        part = (radius / self.radius) ** (ring.degree + 1) * LARGER
        return tuple(Model(ring, found.poly, found.rest * part + TINY) for found in self.solutions)


def disc(field: Field, t: arb, coefficients: Sequence[Sequence[arb]], guess: float) -> Disc | None:
    """A disc about ``t`` for all solutions whose Taylor coefficients (of s^0 to s^d, n lists of balls) are these.

    Its radius is ``guess`` or less; None where none is found.
    """
    degree = len(coefficients[0]) - 1
    radius = guess
    with cap(degree + 1):
        for _ in range(TRIALS):
            ring = Ring(degree, radius)
            rests = [0.0] * field.size
            for _ in range(WIDENED):
                needed = _picard(field, ring, t, coefficients, rests)
                if not all(map(isfinite, needed)):
                    break
                if all(new <= old for new, old in zip(needed, rests, strict=True)):
                    found = zip(coefficients, rests, strict=True)
                    return Disc(radius, tuple(model(ring, row, rest) for row, rest in found))
                rests = [max(old, ROOM * new) for new, old in zip(needed, rests, strict=True)]
            radius *= SHORTER
    return None


def _picard(
    field: Field, ring: Ring, t: arb, coefficients: Sequence[Sequence[arb]], rests: Sequence[float]
) -> list[float]:
    """The rests of Picard's operator applied to  p + r,  |r_i| <= rests_i, r of higher degree than d."""
    states = [model(ring, row, rest) for row, rest in zip(coefficients, rests, strict=True)]
    try:
        slopes: list[Any] = field.rates(model(ring, [t, arb(1)]), states)
    except (ValueError, ZeroDivisionError):  # a quotient by a ball that contains zero
        return [inf] * len(rests)
    d, found = ring.degree, []
    for slope in slopes:
        rate = slope if isinstance(slope, Model) else model(ring, [slope])
        missed = float(rate.sizes[-1]) * ring.radius / (d + 1) + rate.rest * ring.radius / (d + 2)
        found.append(missed * LARGER + TINY)
    return found
