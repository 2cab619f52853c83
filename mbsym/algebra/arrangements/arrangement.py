"""The arrangement of algebraic curves in a box: its regions, arcs and corners as values, and where a point lies."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache, cached_property
from typing import Any

from flint import arb, arb_poly, ctx, fmpq

from mbsym.algebra.arrangements.stacks import Column, Fibre
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.matrices import united
from mbsym.algebra.plane.fields import Point
from mbsym.algebra.plane.numbers import Ball, Rational, Root, compare, high, low, primitive, roots_between, sign
from mbsym.algebra.plane.projection import Box, Curve, Polynomial, coefficients


class CornerKind(StrEnum):
    """What an exact point is."""

    CROSSING = "crossing"  # of different curves, or a point where they touch
    SINGULAR = "singular"  # of one curve: a cusp, a self-crossing
    ISOLATED = "isolated"  # a point of curves near which they have no other real points in the box
    EDGE = "edge"  # a point of a curve on the edge of the box


@dataclass(frozen=True)
class Region:
    """A connected component of the box's inside without the curves; ``signs`` are those of the given factors."""

    id: int
    sample: tuple[Rational, Rational]
    signs: tuple[int, ...]
    arcs: tuple[int, ...]
    cells: tuple[tuple[int, int], ...] = field(repr=False)  # (strip, cell) that it is made of


@dataclass(frozen=True)
class Piece:
    """A part of an arc: a section of a column, or the open interval above point ``section`` of a fibre (vertical)."""

    strip: int
    section: int
    vertical: bool = False
    backwards: bool = False


@dataclass(frozen=True)
class Arc:
    """A smooth piece of a curve between corners; ``factors`` vanish on it.

    ``regions`` are those below and above its ``point`` (to the left and right of a vertical line); None is outside of
    the box.  ``corners``: where it starts and ends; None twice: it is closed and meets no corner.
    """

    id: int
    factors: tuple[int, ...]
    point: Point
    regions: tuple[int | None, int | None]
    corners: tuple[int | None, int | None]
    pieces: tuple[Piece, ...] = field(repr=False)


@dataclass(frozen=True)
class Corner:
    """A point where curves cross, touch, are singular or isolated, or meet the edge of the box."""

    id: int
    factors: tuple[int, ...]
    point: Point
    kind: CornerKind
    branches: int
    arcs: tuple[int, ...]
    place: tuple[int, int] = field(repr=False)  # (abscissa, point of its fibre)


Place = Region | Arc | Corner


@dataclass(frozen=True)
class Places:
    """Where the parts of stacks belong: by (strip, cell), (strip, section), (abscissa, point), (abscissa, interval)."""

    cells: dict[tuple[int, int], int]
    sections: dict[tuple[int, int], int]
    corners: dict[tuple[int, int], int]
    smooth: dict[tuple[int, int], int]  # the arc through a point that is no corner
    verticals: dict[tuple[int, int], int]
    intervals: dict[tuple[int, int], int]  # the region around an interval that is no arc


@dataclass(frozen=True)
class Arrangement:
    """What ``decompose`` finds."""

    box: Box
    factors: tuple[Polynomial, ...]
    regions: tuple[Region, ...]
    arcs: tuple[Arc, ...]
    corners: tuple[Corner, ...]
    curves: tuple[Curve, ...] = field(repr=False)
    columns: tuple[Column, ...] = field(repr=False)
    fibres: tuple[Fibre, ...] = field(repr=False)
    places: Places = field(repr=False)

    def locate(self, x: Rational, y: Rational) -> Place:
        """The region, arc or corner that a rational point of the box belongs to, exactly.

        Points on the edge of the box that lie on no curve belong to the region beside them.  Raises ValueError outside.
        """
        x, y = fmpq(x), fmpq(y)
        if (x, y) not in self.box:
            raise ValueError("a point outside of the box")
        at = bisect_left(self._order, 0, key=lambda k: compare(self.fibres[k].abscissa.x, x))
        if compare(self.fibres[at].abscissa.x, x) == 0:
            return self._over_fibre(at, y)
        return self._over_strip(at - 1, x, y)

    @cached_property
    def _order(self) -> range:
        return range(len(self.fibres))

    def _over_fibre(self, at: int, y: Rational) -> Place:
        places = self.places
        for j, point in enumerate(self.fibres[at].points):
            order = sign(point.y - y) if isinstance(point.y, fmpq) else point.y.compare(y)
            if order > 0:
                interval = (at, j - 1)
                if interval in places.verticals:
                    return self.arcs[places.verticals[interval]]
                return self.regions[places.intervals[interval]]
            if order == 0:
                if (at, j) in places.corners:
                    return self.corners[places.corners[at, j]]
                if (at, j) in places.smooth:
                    return self.arcs[places.smooth[at, j]]
                return self.regions[places.intervals[at, max(j - 1, 0)]]  # an edge of the box
        raise AssertionError("the upper edge of the box is a point of every fibre")

    def _over_strip(self, strip: int, x: Rational, y: Rational) -> Place:
        sections = self.columns[strip].sections
        signs = tuple(sign(curve.polynomial(x, y)) for curve in self.curves)
        if 0 not in signs:
            cells = self._by_signs[strip].get(signs, ())
            if len(cells) == 1:
                return self.regions[self.places.cells[strip, cells[0]]]
        below = on = 0
        for k, curve in enumerate(self.curves):
            p = curve.over(x)
            if p.degree() > 0:
                below += len(roots_between(primitive(p), self.box.y0, y))
                on += signs[k] == 0 and self.box.y0 < y < self.box.y1
        if on:
            return self.arcs[self.places.sections[strip, below + 1]]
        edge = 0 if y == self.box.y0 else len(sections) - 1 if y == self.box.y1 else None
        if edge is not None and (strip, edge) in self.places.sections:
            return self.arcs[self.places.sections[strip, edge]]
        return self.regions[self.places.cells[strip, below]]

    @cached_property
    def _by_signs(self) -> tuple[dict[tuple[int, ...], list[int]], ...]:
        """For every strip, the cells by the signs of the curves there."""
        by_signs = []
        for at, column in enumerate(self.columns):
            table: dict[tuple[int, ...], list[int]] = {}
            for cell in range(len(column.sections) - 1):
                y = column.middle(cell)
                signs = tuple(sign(curve.polynomial(column.x, y)) for curve in self.curves)
                table.setdefault(signs, []).append(cell)
            by_signs.append(table)
            assert at < len(self.columns)
        return tuple(by_signs)


def sample_of(root: Any) -> Any:
    """The ordinate of a section as an exact number: its polynomial is factored."""
    if isinstance(root, fmpq):
        return root
    return _irreducible(root)


def _irreducible(root: Root) -> Any:
    from mbsym.algebra.plane.numbers import number

    if root.exact is not None:
        return root.exact
    for factor, _ in root.polynomial.factor()[1]:
        if factor.degree() < 1:
            continue
        if factor.degree() == 1:
            value = fmpq(-factor[0], factor[1])
            if root.low <= value <= root.high:
                return value
        elif sign(factor(root.low)) * sign(factor(root.high)) < 0:
            return number(Root(factor, root.low, root.high))
    raise AssertionError("one of the factors has the root")


def signs_of(factors: Sequence[Polynomial], x: Rational, y: Rational) -> tuple[int, ...]:
    """The signs of polynomials at a rational point."""
    return tuple(sign(p(x, y)) for p in factors)


# Arcs as polylines and regions' areas, in floats: branches are followed by isolating their roots, never on a grid.
#
# Over a strip a < x < b the branches are smooth, with vertical tangents, cusps and the like at its ends only, so that
#
#     x = (a + b)/2 - (b - a)/2 cos t,    0 < t < pi
#
# makes y(t) smooth where a branch is like a square root of the distance to an end.  At every x that is used the roots
# of f(x, .) are isolated exactly, and are then as many and in the same order as in the whole strip.


XY = tuple[float, float]

#: Halvings of the parameter of a piece, at most.
MOST_HALVINGS = 11
#: Binary digits of x within its strip.
DIGITS = 30
#: Nodes of the quadrature, from the first to the last attempt.
FEWEST_NODES, MOST_NODES = 8, 128


@dataclass
class Branches:
    """The ordinates of all sections over any abscissa of a strip, remembered."""

    of: Arrangement
    _known: dict[tuple[int, Rational], tuple[float, ...]] = field(default_factory=dict)

    def bounds(self, strip: int) -> tuple[float, float]:
        """The ends of a strip."""
        return float(self.of.fibres[strip].abscissa.x), float(self.of.fibres[strip + 1].abscissa.x)

    def at(self, strip: int, t: float) -> tuple[float, tuple[float, ...]]:
        """(x, the ordinates of the sections there from below to above), 0 < t < pi."""
        a, b = high(self.of.fibres[strip].abscissa.x), low(self.of.fibres[strip + 1].abscissa.x)
        share = fmpq(max(1, min((1 << DIGITS) - 1, round((1 - math.cos(t)) / 2 * (1 << DIGITS)))), 1 << DIGITS)
        x = _short(a + (b - a) * share, (b - a) / (1 << DIGITS + 2))
        if (strip, x) not in self._known:
            self._known[strip, x] = self._ordinates(strip, x)
        return float(x), self._known[strip, x]

    def _ordinates(self, strip: int, x: Rational) -> tuple[float, ...]:
        box, sections = self.of.box, self.of.columns[strip].sections
        ordinates = []
        for k in {section.curve for section in sections if section.curve >= 0}:
            p = self.of.curves[k].over(x)
            if p.degree() == 1:
                ordinates.append(float(-p[0] / p[1]))
            else:
                ordinates += [_number(root) for root in roots_between(primitive(p), box.y0, box.y1)]
        return (float(box.y0), *sorted(ordinates), float(box.y1))

    def end(self, strip: int, section: int, right: bool) -> XY:
        """The point of a fibre in which a section ends."""
        fibre = self.of.fibres[strip + right]
        firsts = fibre.left if right else fibre.right
        j = next(j for j in range(len(firsts) - 1) if firsts[j] <= section < firsts[j + 1])
        return Point(fibre.abscissa.x, fibre.points[j].y).floats()


def _short(x: Rational, width: Rational) -> Rational:
    """A dyadic number within ``width`` of x."""
    scale = 1 << max(0, 1 - (int(width.p).bit_length() - int(width.q).bit_length()))
    return fmpq((x * scale).round(), scale)


def _number(root: Root) -> float:
    """A root in floats: halved to some digits, then by Newton's steps that stay inside."""
    if root.exact is not None:
        return float(root.low)
    root.narrow((root.high - root.low) / 64)
    slope = root.polynomial.derivative()
    y = (root.low + root.high) / 2
    for _ in range(6):
        step_down = slope(y)
        if step_down == 0:
            break
        nearer = _short(y - fmpq(root.polynomial(y)) / step_down, fmpq(1, 1 << 60))
        if not root.low <= nearer <= root.high:
            break
        if abs(nearer - y) < fmpq(1, 1 << 50):
            return float(nearer)
        y = nearer
    return float(root)


def polyline(arrangement: Arrangement, arc: Arc, tolerance: float = 1e-3) -> list[XY]:
    """Points along an arc, from its first corner to its last, that deviate from it by about ``tolerance`` at most.

    The tolerance is a part of the box's width and height.
    """
    branches = Branches(arrangement)
    points: list[XY] = []
    for piece in arc.pieces:
        run = _vertical(arrangement, piece) if piece.vertical else _followed(branches, piece, tolerance)
        points += run if not points else run[1:]
    return points


def _vertical(arrangement: Arrangement, piece: Piece) -> list[XY]:
    fibre = arrangement.fibres[piece.strip]
    return [Point(fibre.abscissa.x, fibre.points[piece.section + k].y).floats() for k in (0, 1)]


def _followed(branches: Branches, piece: Piece, tolerance: float) -> list[XY]:
    """One section of a strip, halved where it is bent."""
    box = branches.of.box
    width, height = float(box.x1 - box.x0), float(box.y1 - box.y0)
    ends = [branches.end(piece.strip, piece.section, right) for right in (False, True)]

    def at(t: float) -> XY:
        x, ys = branches.at(piece.strip, t)
        return x, ys[piece.section]

    def deviation(a: XY, b: XY, c: XY) -> float:
        """How far c is from the line through a and b, in units of the box."""
        (ux, uy), (vx, vy) = (((p[0] - a[0]) / width, (p[1] - a[1]) / height) for p in (b, c))
        length = math.hypot(ux, uy)
        return abs(ux * vy - uy * vx) / length if length > 1e-12 else math.hypot(vx, vy)

    def between(a: XY, b: XY, s: float, t: float, depth: int) -> list[XY]:
        """The points after a up to b."""
        middle = (s + t) / 2
        c = at(middle)
        if depth >= MOST_HALVINGS or (depth >= 2 and deviation(a, b, c) < tolerance):
            return [b] if deviation(a, b, c) < tolerance / 4 else [c, b]
        return [*between(a, c, s, middle, depth + 1), *between(c, b, middle, t, depth + 1)]

    run = [ends[0], *between(ends[0], ends[1], 0.0, math.pi, 0)]
    return run[::-1] if piece.backwards else run


@cache
def _weights(n: int) -> tuple[float, ...]:
    """Weights w_k of Clenshaw and Curtis, n even: the integral of f over [-1, 1] is about sum w_k f(-cos(pi k/n))."""
    weights = []
    for k in range(n + 1):
        total = 0.0
        for j in range(n // 2 + 1):
            term = 2 / (1 - 4 * j * j) * math.cos(2 * j * math.pi * k / n)
            total += term / 2 if j in (0, n // 2) else term
        weights.append(total * (2 / n) / (2 if k in (0, n) else 1))
    return tuple(weights)


def areas(arrangement: Arrangement, accuracy: float = 1e-7) -> tuple[tuple[float, float], ...]:
    """(area, estimate of its error) of every region: sections integrated over their strips.

    The error is estimated by comparing two quadratures; ``accuracy`` is a part of the box's area.
    """
    branches = Branches(arrangement)
    tolerance = accuracy * float(arrangement.box.area) / max(len(arrangement.columns), 1)
    total = [[0.0, 0.0] for _ in arrangement.regions]
    for strip, column in enumerate(arrangement.columns):
        heights, errors = _integrals(branches, strip, len(column.sections), tolerance)
        for cell in range(len(column.sections) - 1):
            region = total[arrangement.places.cells[strip, cell]]
            region[0] += heights[cell + 1] - heights[cell]
            region[1] += errors[cell + 1] + errors[cell]
    return tuple((area, error) for area, error in total)


def _integrals(branches: Branches, strip: int, count: int, tolerance: float) -> tuple[list[float], list[float]]:
    """The integrals of all sections over a strip, and estimates of their errors."""
    a, b = branches.bounds(strip)
    half = (b - a) / 2
    sides = [[branches.end(strip, k, right)[1] for k in range(count)] for right in (False, True)]

    def rule(n: int) -> list[float]:
        # dx = (b - a)/2 sin t dt, and the rule's [-1, 1] is mapped to 0 <= t <= pi.
        nodes = [math.pi / 2 * (1 - math.cos(math.pi * k / n)) for k in range(n + 1)]
        rows = [sides[0], *(branches.at(strip, t)[1] for t in nodes[1:-1]), sides[1]]
        return [
            half
            * math.pi
            / 2
            * sum(w * math.sin(t) * row[k] for w, t, row in zip(_weights(n), nodes, rows, strict=True))
            for k in range(count)
        ]

    n = FEWEST_NODES
    coarse = rule(n)
    while True:
        n *= 2
        fine = rule(n)
        errors = [abs(p - q) for p, q in zip(fine, coarse, strict=True)]
        if max(errors) <= tolerance or n >= MOST_NODES:
            return fine, errors
        coarse = fine


# Laws that every arrangement obeys, as a check of one: none of them uses how it was found.
#
# * Euler: V - E + F = 1 + C, with vertices V (corners, ends of the box, one for a closed arc), edges E (arcs and the
#   rim), faces F (regions and the outside) and components C of the graph, the rim and what hangs on it being one.
# * Across an arc the sign of a given polynomial changes if and only if one of its factors vanishes there with an odd
#   exponent; on the arc the polynomials named, and no others, are zero.
# * At a corner so many ends of arcs meet as it has branches, and the polynomials named, and no others, are zero.


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


def breaches(arrangement: Arrangement) -> tuple[Breach, ...]:
    """The laws that an arrangement breaks, and where: none, if it is right."""
    broken = [] if euler(arrangement) else [Breach(Law.EULER)]
    odd = [_odd(arrangement, k) for k in range(len(arrangement.factors))]
    for arc in arrangement.arcs:
        if _zeros(arrangement, arc.point) != arc.factors:
            broken.append(Breach(Law.ZEROS, arc=arc.id))
        elif not _sides(arrangement, arc, odd):
            broken.append(Breach(Law.SIDES, arc=arc.id))
    ends: dict[int, int] = {}
    for arc in arrangement.arcs:
        for corner in arc.corners:
            if corner is not None:
                ends[corner] = ends.get(corner, 0) + 1
    for corner_ in arrangement.corners:
        if _zeros(arrangement, corner_.point) != corner_.factors:
            broken.append(Breach(Law.ZEROS, corner=corner_.id))
        if ends.pop(corner_.id, 0) != corner_.branches:
            broken.append(Breach(Law.ENDS, corner=corner_.id))
    broken += [Breach(Law.ENDS, corner=k) for k in ends]
    return tuple(broken)


def _zeros(arrangement: Arrangement, point: Point) -> tuple[int, ...]:
    """The polynomials that vanish at a point, as far as balls of some 250 bits tell: no exact arithmetic takes part."""
    x, y = point.enclosures(BITS)
    with ctx.workprec(2 * BITS):
        return tuple(k for k, p in enumerate(arrangement.factors) if _ball(p, x, y).contains(0))


def _ball(p: Polynomial, x: Ball, y: Ball) -> Ball:
    total = arb(0)
    for c in reversed(coefficients(p, 1)):
        total = total * y + arb_poly(c)(x)
    return total


def _odd(arrangement: Arrangement, k: int) -> list[object]:
    """The irreducible factors of odd exponent of a given polynomial."""
    return [factor for factor, exponent in irreducible_factors(arrangement.factors[k])[1] if exponent % 2]


def _sides(arrangement: Arrangement, arc: Arc, odd: list[list[object]]) -> bool:
    """Whether the signs beside an arc are as they have to be; on the rim of the box there is one side only."""
    below, above = (None if k is None else arrangement.regions[k].signs for k in arc.regions)
    if below is None or above is None:
        return True
    for k, factors in enumerate(odd):
        crossed = k in arc.factors and sum(arc.point.sign(factor) == 0 for factor in factors) % 2 == 1
        if below[k] != (-above[k] if crossed else above[k]):
            return False
    return True


def euler(arrangement: Arrangement) -> bool:
    """Whether V - E + F = 1 + C."""
    box = arrangement.box
    at_ends = [x for corner in arrangement.corners if (x := corner.point).rational and x.x in (box.x0, box.x1)]
    on_rim = {corner.id for corner in arrangement.corners if is_on_rim(box, corner.point)}
    plain_ends = 4 - sum(point.y in (box.y0, box.y1) for point in at_ends)
    closed = sum(arc.corners == (None, None) for arc in arrangement.arcs)
    ends = (arc.corners for arc in arrangement.arcs if arc.corners != (None, None))
    joints: list[Collection[object]] = [{"rim", *on_rim}, *([corner.id] for corner in arrangement.corners), *ends]
    components = len(united(joints)) + closed
    vertices = len(arrangement.corners) + plain_ends + closed
    edges = len(arrangement.arcs) + len(on_rim) + plain_ends - sum(None in arc.regions for arc in arrangement.arcs)
    return vertices - edges + len(arrangement.regions) + 1 == 1 + components


def is_on_rim(box: Box, point: Point) -> bool:
    """Whether a point lies on the edge of the box."""
    return any(
        isinstance(value, fmpq) and value in edges
        for value, edges in ((point.x, (box.x0, box.x1)), (point.y, (box.y0, box.y1)))
    )
