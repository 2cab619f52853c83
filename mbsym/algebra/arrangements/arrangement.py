"""The arrangement of algebraic curves in a box: its regions, arcs and corners as values, and where a point lies."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Any

from flint import fmpq

from mbsym.algebra.arrangements.stacks import Column, Fibre
from mbsym.algebra.plane.numbers import Rational, Root, compare, primitive, roots_between, sign
from mbsym.algebra.plane.points import Point
from mbsym.algebra.plane.projection import Box, Curve, Polynomial


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
        found = []
        for at, column in enumerate(self.columns):
            table: dict[tuple[int, ...], list[int]] = {}
            for cell in range(len(column.sections) - 1):
                y = column.middle(cell)
                signs = tuple(sign(curve.polynomial(column.x, y)) for curve in self.curves)
                table.setdefault(signs, []).append(cell)
            found.append(table)
            assert at < len(self.columns)
        return tuple(found)


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
