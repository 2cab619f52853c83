"""Stacks: what lies above one value of x in the box, and how neighbouring stacks are connected.

Between two critical abscissas a *column* lists the curves' branches from below to above, the box's edges being the
first and the last.  Over a critical abscissa alpha a *fibre* lists the points.  Which point a branch ends in is decided
exactly: rational separators c between the points of the fibre, and rational l < alpha < r with f(x, c) != 0 for all
curves, separators and x in [l, r] (Descartes' rule proves it); so the branches that lie between two separators at l, or
at r, are those that end in the point between them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from flint import fmpq

from mbsym.algebra.failures import Defect, Limit, TooLargeError
from mbsym.algebra.plane import numbers
from mbsym.algebra.plane.fields import Extension, Over, OverField
from mbsym.algebra.plane.projection import LEADING, Abscissa, Box, Curve

#: In place of the number of a curve: the lower and the upper edge of the box.
BOTTOM, TOP = -1, -2

#: So often an interval is halved before numbers count as too close together.
MOST_HALVINGS = 4_000

Ordinate = Any  # a flint.fmpq, an AlgebraicNumber, or an Over


@dataclass(frozen=True)
class Section:
    """A branch of a curve over a strip, or an edge of the box; ``y`` is where it is over the strip's sample."""

    curve: int
    y: numbers.Root | numbers.Rational


@dataclass(frozen=True)
class Column:
    """What lies over the strip between two abscissas: sections from below to above, edges included."""

    x: numbers.Rational
    sections: tuple[Section, ...]

    def middle(self, cell: int) -> numbers.Rational:
        """A simple rational number between section ``cell`` and the one above it."""
        return numbers.between_simply(self.sections[cell].y, self.sections[cell + 1].y)


@dataclass(frozen=True)
class FibrePoint:
    """A point over a critical abscissa: the curves through it, how often each meets the vertical line there."""

    y: Ordinate
    curves: tuple[tuple[int, int], ...]  # (curve, multiplicity of the root; 1 or 2: at least 2)
    singular: bool | None = None  # whether the curve is, where there is one; None: not known yet


@dataclass(frozen=True)
class Fibre:
    """The points over a critical abscissa, the edges of the box included, from below to above.

    ``left[j]``, ``right[j]`` are the first section of the neighbouring column that ends in point j or above; one more
    entry at the end.  Empty at the edge of the box.
    """

    abscissa: Abscissa
    points: tuple[FibrePoint, ...]
    left: tuple[int, ...]
    right: tuple[int, ...]


def column(curves: Sequence[Curve], box: Box, x: numbers.Rational) -> Column:
    """The branches over a rational x that is not critical."""
    branches: list[tuple[numbers.Root, int]] = []
    for k, curve in enumerate(curves):
        p = curve.over(x)
        if p.degree() > 0:
            branches += [(root, k) for root in numbers.roots_between(numbers.primitive(p), box.y0, box.y1)]
    # Different numbers: curves meet over critical abscissas only.
    branches.sort(key=lambda pair: _Ordered(pair[0]))
    sections = [Section(BOTTOM, box.y0), *(Section(k, root) for root, k in branches), Section(TOP, box.y1)]
    return Column(x, tuple(sections))


def points_over(curves: Sequence[Curve], box: Box, at: Abscissa) -> list[FibrePoint]:
    """The points of the curves over a critical abscissa, in the box, with its edges."""
    fibre_points = _over_rational(curves, box, at.x) if at.rational else _over_algebraic(curves, box, at)
    ends = {BOTTOM: box.y0, TOP: box.y1}
    for y in ends.values():
        if not any(isinstance(p.y, fmpq) and p.y == y for p in fibre_points):
            fibre_points.append(FibrePoint(y, ()))
    return sorted(fibre_points, key=lambda point: _Ordered(point.y))


class _Ordered:
    """Sorts different numbers."""

    def __init__(self, y: Ordinate) -> None:
        self.y = y

    def __lt__(self, other: _Ordered) -> bool:
        return _order(self.y, other.y) < 0


def _order(a: Ordinate, b: Ordinate) -> int:
    """The order of two different numbers, or of one with itself."""
    if a is b:
        return 0
    for _ in range(MOST_HALVINGS):
        if not (numbers.high(a) >= numbers.low(b) and numbers.high(b) >= numbers.low(a)):
            break
        for x in (a, b):
            if not isinstance(x, fmpq):
                x.halve()
    else:
        raise TooLargeError("points of curves lie too close together", limit=Limit.DIGITS)
    return -1 if numbers.high(a) < numbers.low(b) else 1


def _over_rational(curves: Sequence[Curve], box: Box, x: numbers.Rational) -> list[FibrePoint]:
    """All polynomials f(x, .) are factored over the rationals."""
    through: dict[str, tuple[numbers.Integer, dict[int, int]]] = {}
    for k, curve in enumerate(curves):
        for factor, power in numbers.primitive(curve.over(x)).factor()[1]:
            if factor.degree() > 0:
                through.setdefault(str(factor), (factor, {}))[1][k] = int(power)
    fibre_points = []
    for factor, powers in through.values():
        roots = [numbers.number(root) for root in numbers.roots_between(factor, box.y0, box.y1)]
        roots += [y for y in (box.y0, box.y1) if factor(y) == 0]
        fibre_points += [FibrePoint(y, tuple(sorted(powers.items()))) for y in roots]
    return fibre_points


@dataclass(eq=False)
class _Node:
    """A root over a critical abscissa with the curves through it, and how often each meets the vertical line there."""

    root: Over
    through: dict[int, int]
    singular: bool | None = None  # as in FibrePoint


def _over_algebraic(curves: Sequence[Curve], box: Box, at: Abscissa) -> list[FibrePoint]:
    """The points over an algebraic abscissa, by what is known of it.

    The roots of every curve first, then which of them are common.  Where a discriminant or resultant vanishes there is
    a multiple or common root, and balls tell which; only where they may be several do exact divisors decide.
    """
    field = Extension(at.x)
    wholes = {k: p for k, curve in enumerate(curves) if len(p := field.trimmed(curve.in_y)) > 1}
    nodes = [node for k, whole in wholes.items() for node in _roots_of(field, k, whole, at.degenerate.get(k, 0))]
    for pair in at.meeting:
        if pair <= {*wholes}:
            _meet(field, at, wholes, nodes, *sorted(pair))
    points = []
    for node in nodes:
        on, root = tuple(sorted(node.through.items())), node.root
        inside = root.compare(box.y0), root.compare(box.y1)
        if inside[0] >= 0 >= inside[1]:
            points.append(FibrePoint(root if root.exact is None else root.exact, on, node.singular))
    return points


def _roots_of(field: Extension, k: int, whole: OverField, order: int) -> list[_Node]:
    """The real roots of curve k, whose discriminant has a zero of this order.

    Where the leading coefficient does not vanish, the order is the sum of mu + i - 1 over the points of the curve above
    alpha, complex ones included (Teissier 1973): mu is Milnor's number, 0 where the curve is smooth, i how often it
    meets the vertical line.  With one double root it is smooth if and only if the order is 1.
    """
    if order == 0 or (order >= LEADING and field.coprime(whole, field.derivative(whole))):
        return [_Node(root, {k: 1}) for root in field.roots(field.monic(whole))]
    splitting = field.double_roots(whole) if order < LEADING else None
    if splitting is None:
        pieces = _with_multiplicity(field, whole)
        return [_Node(root, {k: m}) for piece, m in pieces for root in field.roots(piece)]
    doubles, simple, count = splitting
    singular = False if order == count else True if count == 1 else None
    return [*(_Node(root, {k: 2}, singular) for root in doubles), *(_Node(root, {k: 1}) for root in simple)]


def _meet(field: Extension, at: Abscissa, wholes: Mapping[int, OverField], nodes: list[_Node], j: int, k: int) -> None:
    """Joins the nodes of two curves whose resultant vanishes."""
    orders = {i: at.degenerate.get(i, 0) for i in (j, k)}
    first, second = sorted((j, k), key=lambda i: orders[i])
    a, b = wholes[first], wholes[second]
    if min(orders.values()) >= LEADING and field.coprime(a, b):
        return  # both have a root at infinity
    common_part = field.common_roots(a, b) if orders[first] == 0 else None
    common = field.roots(field.squarefree(field.gcd(a, b))) if common_part is None else common_part[0]
    for root in common:
        _join(nodes, root, j, k)


def _join(nodes: list[_Node], common: Over, j: int, k: int) -> None:
    """Makes one of the nodes of two curves at a common root."""
    for _ in range(MOST_HALVINGS):
        hits = [[node for node in nodes if curve in node.through and _touch(node.root, common)] for curve in (j, k)]
        if not all(hits):
            raise Defect("curves that meet have no root in common")
        if len(hits[0]) == len(hits[1]) == 1:
            break
        for root in {id(x): x for x in (common, *(node.root for hit in hits for node in hit))}.values():
            root.halve()
    else:
        raise TooLargeError("points of curves lie too close together", limit=Limit.DIGITS)
    a, b = hits[0][0], hits[1][0]
    if a is not b:
        keep, drop = (a, b) if len(a.root.polynomial) <= len(b.root.polynomial) else (b, a)
        keep.through.update(drop.through)
        keep.root.shared += [drop.root.polynomial, *drop.root.shared]
        nodes.remove(drop)


def _touch(a: Over, b: Over) -> bool:
    return bool(a.low <= b.high and b.low <= a.high)


def _one(field: Extension) -> Any:
    return field.modulus * 0 + 1


def _with_multiplicity(field: Extension, p: OverField) -> list[tuple[OverField, int]]:
    """[(simple roots, 1), (multiple ones, 2)], without those that are empty."""
    p = field.monic(p)
    common = field.gcd(p, field.derivative(p)) if len(p) > 2 else [_one(field)]
    if len(common) == 1:
        return [(p, 1)]
    every = field.divided(p, common)[0]
    multiple = field.squarefree(common)
    simple = field.divided(every, multiple)[0]
    return [(q, m) for q, m in ((field.monic(simple), 1), (multiple, 2)) if len(q) > 1]


def connected(
    curves: Sequence[Curve],
    box: Box,
    at: Abscissa,
    points: Sequence[FibrePoint],
    columns: tuple[Column | None, Column | None],
) -> Fibre:
    """The fibre with the sections of the columns to its left and right that end in its points."""
    separators = [numbers.between_simply(a.y, b.y) for a, b in pairwise(points)]
    along = [(k, c, curve.along(c)) for k, curve in enumerate(curves) for c in separators]
    lines = [(k, c, numbers.primitive(p)) for k, c, p in along if p.degree() > 0]
    sides = []
    for column_, sense in zip(columns, (-1, 1), strict=True):
        sides.append(() if column_ is None else _attached(curves, box, at, separators, lines, column_, sense))
    return Fibre(at, tuple(points), sides[0], sides[1])


def _attached(
    curves: Sequence[Curve],
    box: Box,
    at: Abscissa,
    separators: Sequence[numbers.Rational],
    lines: Sequence[tuple[int, numbers.Rational, numbers.Integer]],
    beside: Column,
    sense: int,
) -> tuple[int, ...]:
    """The first section of a neighbouring column that ends in each point or above."""
    near = _near(at.x, beside.x, sense, [p for _, _, p in lines])
    # Sections below each separator at x = near; the bottom edge is one of them.
    below = [1] * len(separators)
    for curve in curves:
        p = curve.over(near)
        if p.degree() < 1:
            continue
        q = numbers.primitive(p)
        count = 0
        for j, (a, b) in enumerate(pairwise([box.y0, *separators])):
            count += _count(q, a, b)
            below[j] += count
    if separators and below[-1] > len(beside.sections) - 1:
        raise Defect("branches were lost between two stacks")
    return (0, *below, len(beside.sections))


def _count(p: numbers.Integer, a: numbers.Rational, b: numbers.Rational) -> int:
    """Roots of a square-free polynomial in (a, b)."""
    most: int = numbers.bound(p, a, b)
    return most if most < 2 else len(numbers.roots_between(p, a, b))


def _near(
    alpha: numbers.Number, sample: numbers.Rational, sense: int, lines: Sequence[numbers.Integer]
) -> numbers.Rational:
    """A rational x between alpha and the sample with no zero of any polynomial between alpha and x, ends included."""
    if isinstance(alpha, fmpq):
        near = sample
        for p in lines:
            while p(near) == 0 or numbers.bound(p, min(alpha, near), max(alpha, near)):
                near = (alpha + near) / 2
        return near
    while alpha.low <= sample <= alpha.high:
        alpha.halve()
    near = sample
    for p in lines:
        while True:
            a, b = (near, alpha.high) if sense < 0 else (alpha.low, near)
            if p(a) != 0 and p(b) != 0 and not numbers.bound(p, a, b):
                break
            alpha.halve()
            edge = alpha.low if sense < 0 else alpha.high
            near = (edge + near) / 2
    return near
