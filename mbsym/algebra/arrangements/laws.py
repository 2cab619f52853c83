"""Laws that every arrangement obeys, as a check of one: none of them uses how it was found.

* Euler: V - E + F = 1 + C, with vertices V (corners, ends of the box, one for a closed arc), edges E (arcs and the
  rim), faces F (regions and the outside) and components C of the graph, the rim and what hangs on it being one.
* Across an arc the sign of a given polynomial changes if and only if one of its factors vanishes there with an odd
  exponent; on the arc the polynomials named, and no others, are zero.
* At a corner so many ends of arcs meet as it has branches, and the polynomials named, and no others, are zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from flint import arb, arb_poly, ctx, fmpq

from mbsym.algebra.arrangements.arrangement import Arc, Arrangement
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.plane.numbers import Ball
from mbsym.algebra.plane.points import Point
from mbsym.algebra.plane.projection import Box, Polynomial, coefficients

#: Accuracy of the balls in which polynomials are seen to vanish.
BITS = 250


class Law(StrEnum):
    """What is broken."""

    EULER = "Euler's law"
    SIDES = "signs on both sides of an arc"
    ZEROS = "polynomials that vanish on an arc or at a corner"
    ENDS = "arcs that end at a corner"


@dataclass(frozen=True)
class Breach:
    """``arc`` or ``corner``: where; None for the whole."""

    law: Law
    arc: int | None = None
    corner: int | None = None


def breaches(found: Arrangement) -> tuple[Breach, ...]:
    """The laws that an arrangement breaks, and where: none, if it is right."""
    broken = [] if euler(found) else [Breach(Law.EULER)]
    odd = [_odd(found, k) for k in range(len(found.factors))]
    for arc in found.arcs:
        if _zeros(found, arc.point) != arc.factors:
            broken.append(Breach(Law.ZEROS, arc=arc.id))
        elif not _sides(found, arc, odd):
            broken.append(Breach(Law.SIDES, arc=arc.id))
    ends: dict[int, int] = {}
    for arc in found.arcs:
        for corner in arc.corners:
            if corner is not None:
                ends[corner] = ends.get(corner, 0) + 1
    for corner_ in found.corners:
        if _zeros(found, corner_.point) != corner_.factors:
            broken.append(Breach(Law.ZEROS, corner=corner_.id))
        if ends.pop(corner_.id, 0) != corner_.branches:
            broken.append(Breach(Law.ENDS, corner=corner_.id))
    broken += [Breach(Law.ENDS, corner=k) for k in ends]
    return tuple(broken)


def _zeros(found: Arrangement, point: Point) -> tuple[int, ...]:
    """The polynomials that vanish at a point, as far as balls of some 250 bits tell: no exact arithmetic takes part."""
    x, y = point.enclosures(BITS)
    with ctx.workprec(2 * BITS):
        return tuple(k for k, p in enumerate(found.factors) if _ball(p, x, y).contains(0))


def _ball(p: Polynomial, x: Ball, y: Ball) -> Ball:
    total = arb(0)
    for c in reversed(coefficients(p, 1)):
        total = total * y + arb_poly(c)(x)
    return total


def _odd(found: Arrangement, k: int) -> list[object]:
    """The irreducible factors of odd exponent of a given polynomial."""
    return [factor for factor, exponent in irreducible_factors(found.factors[k])[1] if exponent % 2]


def _sides(found: Arrangement, arc: Arc, odd: list[list[object]]) -> bool:
    """Whether the signs beside an arc are as they have to be; on the rim of the box there is one side only."""
    below, above = (None if k is None else found.regions[k].signs for k in arc.regions)
    if below is None or above is None:
        return True
    for k, factors in enumerate(odd):
        crossed = k in arc.factors and sum(arc.point.sign(factor) == 0 for factor in factors) % 2 == 1
        if below[k] != (-above[k] if crossed else above[k]):
            return False
    return True


def euler(found: Arrangement) -> bool:
    """Whether V - E + F = 1 + C."""
    box = found.box
    parent: dict[object, object] = {}

    def root(key: object) -> object:
        while parent.setdefault(key, key) != key:
            key = parent[key]
        return key

    at_ends = [x for corner in found.corners if (x := corner.point).rational and x.x in (box.x0, box.x1)]
    on_rim = {corner.id for corner in found.corners if is_on_rim(box, corner.point)}
    plain_ends = 4 - sum(point.y in (box.y0, box.y1) for point in at_ends)
    for corner in on_rim:
        parent[root(corner)] = root("rim")
    closed = 0
    for arc in found.arcs:
        if arc.corners == (None, None):
            closed += 1
        else:
            parent[root(arc.corners[0])] = root(arc.corners[1])
    components = len({root(key) for key in ["rim", *(corner.id for corner in found.corners)]}) + closed
    vertices = len(found.corners) + plain_ends + closed
    edges = len(found.arcs) + len(on_rim) + plain_ends - sum(None in arc.regions for arc in found.arcs)
    return vertices - edges + len(found.regions) + 1 == 1 + components


def is_on_rim(box: Box, point: Point) -> bool:
    """Whether a point lies on the edge of the box."""
    return any(
        isinstance(value, fmpq) and value in edges
        for value, edges in ((point.x, (box.x0, box.x1)), (point.y, (box.y0, box.y1)))
    )
