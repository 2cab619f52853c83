"""From polynomials to their arrangement: stacks over all abscissas, joined to regions, arcs and corners.

Cells of neighbouring strips belong to one region where an open interval of the fibre between them touches both and no
vertical line runs there; a component of the box without the curves is the union of such cells.  Branches are joined at
points of fibres where one curve alone is smooth; everything else there is a corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import fmpq

from mbsym.algebra.arrangements.arrangement import (
    Arc,
    Arrangement,
    Corner,
    CornerKind,
    Piece,
    Places,
    Region,
    sample_of,
    signs_of,
)
from mbsym.algebra.arrangements.stacks import BOTTOM, TOP, Column, Fibre, column, connected, points_over
from mbsym.algebra.failures import Defect, Limit, TooLargeError
from mbsym.algebra.plane.fields import Point
from mbsym.algebra.plane.numbers import between_simply
from mbsym.algebra.plane.projection import Box, Budget, Curve, Polynomial, Progress, abscissas, nothing, parts

Key = tuple[int, int]
End = tuple[int, int, int]  # (strip, section, 0: its left end, 1: its right end)


def decompose(
    factors: Sequence[Polynomial], box: Box, budget: Budget | None = None, progress: Progress = nothing
) -> Arrangement:
    """The arrangement of the real curves factor(x, y) = 0 in the box, exactly.

    Raises ValueError for a polynomial that is zero, TooLargeError where the budget does not suffice.
    """
    budget = budget or Budget()
    curves, verticals = parts(factors)
    critical = abscissas(curves, verticals, box, budget, progress)
    columns = []
    cells = 0
    for at, (a, b) in enumerate(pairwise(critical)):
        progress("strips", at, len(critical) - 1)
        columns.append(column(curves, box, between_simply(a.x, b.x)))
        cells += len(columns[-1].sections)
        if cells > budget.cells:
            raise TooLargeError("more than [[cells]] cells of stacks", cells=budget.cells, limit=Limit.WORK)
    fibres = []
    for at, abscissa in enumerate(critical):
        progress("fibres", at, len(critical))
        beside = (columns[at - 1] if at else None, columns[at] if at < len(columns) else None)
        fibres.append(connected(curves, box, abscissa, points_over(curves, box, abscissa), beside))
    progress("fibres", len(critical), len(critical))
    return _Assembly(tuple(factors), box, curves, tuple(columns), tuple(fibres)).arrangement()


@dataclass
class _Assembly:
    factors: tuple[Polynomial, ...]
    box: Box
    curves: tuple[Curve, ...]
    columns: tuple[Column, ...]
    fibres: tuple[Fibre, ...]

    def arrangement(self) -> Arrangement:
        self.edges = {BOTTOM: self._edge(self.box.y0), TOP: self._edge(self.box.y1)}
        cells = self._cells()
        intervals = self._intervals(cells)
        corners = {key: k for k, key in enumerate(self._corners())}
        self.corner_at = corners
        arcs, sections, smooth, verticals = self._arcs(cells, intervals)
        at_region: dict[int, list[int]] = {}
        at_corner: dict[int, list[int]] = {}
        for arc in arcs:
            for region in sorted({r for r in arc.regions if r is not None}):
                at_region.setdefault(region, []).append(arc.id)
            for corner in sorted({c for c in arc.corners if c is not None}):
                at_corner.setdefault(corner, []).append(arc.id)
        regions = self._regions(cells, at_region)
        made = tuple(self._corner(k, key, tuple(at_corner.get(k, ()))) for key, k in corners.items())
        places = Places(cells, sections, corners, smooth, verticals, intervals)
        return Arrangement(
            self.box, self.factors, regions, tuple(arcs), made, self.curves, self.columns, self.fibres, places
        )

    def _edge(self, y: fmpq) -> tuple[int, ...]:
        """The curves that are this edge of the box: at most one."""
        return tuple(k for k, curve in enumerate(self.curves) if curve.along(y) == 0)

    def _given(self, curves: Sequence[int], vertical: Sequence[int] = ()) -> tuple[int, ...]:
        """The given factors that vanish where these curves do."""
        return tuple(sorted({*vertical}.union(*(self.curves[k].of for k in curves))))

    # regions

    def _cells(self) -> dict[Key, int]:
        """The region of every cell of a column."""
        above: dict[Key, Key] = {}

        def top(key: Key) -> Key:
            while above.get(key, key) != key:
                above[key] = above.get(above[key], above[key])
                key = above[key]
            return key

        keys = [(s, c) for s, col in enumerate(self.columns) for c in range(len(col.sections) - 1)]
        for at, fibre in enumerate(self.fibres):
            if not (0 < at < len(self.columns)) or fibre.abscissa.vertical:
                continue
            for j in range(len(fibre.points) - 1):
                a, b = top((at - 1, fibre.left[j + 1] - 1)), top((at, fibre.right[j + 1] - 1))
                above[max(a, b)] = min(a, b)
        numbers: dict[Key, int] = {}
        return {key: numbers.setdefault(top(key), len(numbers)) for key in keys}

    def _intervals(self, cells: dict[Key, int]) -> dict[Key, int]:
        intervals = {}
        for at, fibre in enumerate(self.fibres):
            if fibre.abscissa.vertical:
                continue
            for j in range(len(fibre.points) - 1):
                key = (at, fibre.right[j + 1] - 1) if at < len(self.columns) else (at - 1, fibre.left[j + 1] - 1)
                intervals[at, j] = cells[key]
        return intervals

    def _regions(self, cells: dict[Key, int], arcs: dict[int, list[int]]) -> tuple[Region, ...]:
        members: dict[int, list[Key]] = {}
        for key, region in cells.items():
            members.setdefault(region, []).append(key)
        return tuple(self._region(k, tuple(keys), tuple(arcs.get(k, ()))) for k, keys in members.items())

    def _region(self, k: int, keys: tuple[Key, ...], arcs: tuple[int, ...]) -> Region:
        strip, cell = max(keys, key=self._size)
        sample = (self.columns[strip].x, self.columns[strip].middle(cell))
        return Region(k, sample, signs_of(self.factors, *sample), arcs, keys)

    def _size(self, key: Key) -> float:
        """About the area of a cell."""
        strip, cell = key
        left, right = (float(self.fibres[strip + k].abscissa.x) for k in (0, 1))
        below, above = (float(self.columns[strip].sections[cell + k].y) for k in (0, 1))
        return (right - left) * (above - below)

    # corners

    def _corners(self) -> list[Key]:
        return [
            (at, j) for at, fibre in enumerate(self.fibres) for j in range(len(fibre.points)) if self._is_corner(at, j)
        ]

    def _is_corner(self, at: int, j: int) -> bool:
        fibre = self.fibres[at]
        curves = fibre.points[j].curves
        if fibre.abscissa.vertical:
            return True
        if not curves:
            return False
        if at in (0, len(self.columns)):
            return True
        edge = BOTTOM if j == 0 else TOP if j == len(fibre.points) - 1 else None
        if edge is not None:
            return tuple(k for k, _ in curves) != self.edges[edge]
        if len(curves) > 1:
            return True
        (curve, multiplicity) = curves[0]
        if multiplicity == 1 or fibre.points[j].singular is not None:
            return bool(fibre.points[j].singular)
        # A smooth point has two branches; a cusp does, too.
        return len(self._branches(at, j)) != 2 or self._point(at, j).sign(self.curves[curve].slope) == 0

    def _point(self, at: int, j: int) -> Point:
        y = self.fibres[at].points[j].y
        return Point(self.fibres[at].abscissa.x, y if isinstance(y, fmpq) or y.exact is None else y.exact)

    def _branches(self, at: int, j: int) -> list[End]:
        """The ends of sections, curves only, that meet at a point."""
        fibre, ends = self.fibres[at], []
        if at:
            ends += [(at - 1, k, 1) for k in range(fibre.left[j], fibre.left[j + 1])]
        if at < len(self.columns):
            ends += [(at, k, 0) for k in range(fibre.right[j], fibre.right[j + 1])]
        return [end for end in ends if self._curves_of(end[0], end[1])]

    def _curves_of(self, strip: int, section: int) -> tuple[int, ...]:
        curve = self.columns[strip].sections[section].curve
        return self.edges[curve] if curve < 0 else (curve,)

    def _corner(self, k: int, key: Key, arcs: tuple[int, ...]) -> Corner:
        at, j = key
        fibre = self.fibres[at]
        curves = [c for c, _ in fibre.points[j].curves]
        factors = self._given(curves, fibre.abscissa.vertical)
        branches = len(self._branches(at, j))
        if fibre.abscissa.vertical:
            branches += (j > 0) + (j < len(fibre.points) - 1)
        if at in (0, len(self.columns)) or j in (0, len(fibre.points) - 1):
            kind = CornerKind.EDGE
        elif branches == 0:
            kind = CornerKind.ISOLATED
        else:
            several = len(curves) + bool(fibre.abscissa.vertical) > 1
            kind = CornerKind.CROSSING if several else CornerKind.SINGULAR
        return Corner(k, factors, self._point(at, j), kind, branches, arcs, key)

    # arcs

    def _arcs(
        self, cells: dict[Key, int], intervals: dict[Key, int]
    ) -> tuple[list[Arc], dict[Key, int], dict[Key, int], dict[Key, int]]:
        arcs: list[Arc] = []
        sections: dict[Key, int] = {}
        smooth: dict[Key, int] = {}
        verticals: dict[Key, int] = {}
        pieces = [
            (s, k) for s, col in enumerate(self.columns) for k in range(len(col.sections)) if self._curves_of(s, k)
        ]
        starts = [(*piece, end) for piece in pieces for end in (0, 1) if self._meeting(*piece, end) in self.corner_at]
        for start in [*starts, *((*piece, 0) for piece in pieces)]:
            if start[:2] in sections:
                continue
            run, through, corners = self._traced(start)
            number = len(arcs)
            sections.update(dict.fromkeys(((p.strip, p.section) for p in run), number))
            smooth.update(dict.fromkeys(through, number))
            arcs.append(self._arc(number, run, corners, cells))
        for at, fibre in enumerate(self.fibres):
            if not fibre.abscissa.vertical:
                continue
            for j in range(len(fibre.points) - 1):
                verticals[at, j] = len(arcs)
                arcs.append(self._vertical(len(arcs), at, j, cells))
        return arcs, sections, smooth, verticals

    def _meeting(self, strip: int, section: int, end: int) -> Key:
        """The point of a fibre where a section ends."""
        at = strip + end
        firsts = self.fibres[at].left if end else self.fibres[at].right
        j = next(j for j in range(len(firsts) - 1) if firsts[j] <= section < firsts[j + 1])
        return at, j

    def _traced(self, start: End) -> tuple[list[Piece], list[Key], tuple[int | None, int | None]]:
        """The pieces of the arc that starts at an end of a section, the points between them, and its corners."""
        first = self.corner_at.get(self._meeting(*start))
        run: list[Piece] = []
        through: list[Key] = []
        strip, section, end = start
        while True:
            run.append(Piece(strip, section, backwards=end == 1))
            key = self._meeting(strip, section, 1 - end)
            if key in self.corner_at:
                return run, through, (first, self.corner_at[key])
            ends = self._branches(*key)
            if len(ends) != 2 or (strip, section, 1 - end) not in ends:
                raise Defect("a smooth point of a curve has two branches")
            through.append(key)
            strip, section, end = next(x for x in ends if x != (strip, section, 1 - end))
            if (strip, section, end) == start:
                return run, through, (None, None)

    def _arc(self, number: int, run: list[Piece], corners: tuple[int | None, int | None], cells: dict[Key, int]) -> Arc:
        widest = max(
            run, key=lambda p: float(self.fibres[p.strip + 1].abscissa.x) - float(self.fibres[p.strip].abscissa.x)
        )
        strip, section = widest.strip, widest.section
        col = self.columns[strip]
        point = Point(col.x, sample_of(col.sections[section].y))
        sides = (cells.get((strip, section - 1)), cells.get((strip, section)))
        return Arc(number, self._given(self._curves_of(strip, section)), point, sides, corners, tuple(run))

    def _vertical(self, number: int, at: int, j: int, cells: dict[Key, int]) -> Arc:
        fibre = self.fibres[at]
        y = between_simply(fibre.points[j].y, fibre.points[j + 1].y)
        left = cells[at - 1, fibre.left[j + 1] - 1] if at else None
        right = cells[at, fibre.right[j + 1] - 1] if at < len(self.columns) else None
        corners = (self.corner_at[at, j], self.corner_at[at, j + 1])
        piece = Piece(at, j, vertical=True)
        return Arc(number, fibre.abscissa.vertical, Point(fibre.abscissa.x, y), (left, right), corners, (piece,))
