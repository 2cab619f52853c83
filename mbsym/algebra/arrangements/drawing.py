"""Arcs as polylines and regions' areas, in floats: branches are followed by isolating their roots, never on a grid.

Over a strip a < x < b the branches are smooth, with vertical tangents, cusps and the like at its ends only, so that

    x = (a + b)/2 - (b - a)/2 cos t,    0 < t < pi

makes y(t) smooth where a branch is like a square root of the distance to an end.  At every x that is used the roots of
f(x, .) are isolated exactly, and are then as many and in the same order as in the whole strip.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache

from flint import fmpq

from mbsym.algebra.arrangements.arrangement import Arc, Arrangement, Piece
from mbsym.algebra.plane.numbers import Rational, Root, high, low, primitive, roots_between
from mbsym.algebra.plane.points import Point

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
        found = []
        for k in {section.curve for section in sections if section.curve >= 0}:
            p = self.of.curves[k].over(x)
            if p.degree() == 1:
                found.append(float(-p[0] / p[1]))
            else:
                found += [_number(root) for root in roots_between(primitive(p), box.y0, box.y1)]
        return (float(box.y0), *sorted(found), float(box.y1))

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


def polyline(found: Arrangement, arc: Arc, tolerance: float = 1e-3) -> list[XY]:
    """Points along an arc, from its first corner to its last, that deviate from it by about ``tolerance`` at most.

    The tolerance is a part of the box's width and height.
    """
    branches = Branches(found)
    points: list[XY] = []
    for piece in arc.pieces:
        run = _vertical(found, piece) if piece.vertical else _followed(branches, piece, tolerance)
        points += run if not points else run[1:]
    return points


def _vertical(found: Arrangement, piece: Piece) -> list[XY]:
    fibre = found.fibres[piece.strip]
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


def areas(found: Arrangement, accuracy: float = 1e-7) -> tuple[tuple[float, float], ...]:
    """(area, estimate of its error) of every region: sections integrated over their strips.

    The error is estimated by comparing two quadratures; ``accuracy`` is a part of the box's area.
    """
    branches = Branches(found)
    wanted = accuracy * float(found.box.area) / max(len(found.columns), 1)
    total = [[0.0, 0.0] for _ in found.regions]
    for strip, column in enumerate(found.columns):
        heights, errors = _integrals(branches, strip, len(column.sections), wanted)
        for cell in range(len(column.sections) - 1):
            region = total[found.places.cells[strip, cell]]
            region[0] += heights[cell + 1] - heights[cell]
            region[1] += errors[cell + 1] + errors[cell]
    return tuple((area, error) for area, error in total)


def _integrals(branches: Branches, strip: int, count: int, wanted: float) -> tuple[list[float], list[float]]:
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
        if max(errors) <= wanted or n >= MOST_NODES:
            return fine, errors
        coarse = fine
