"""A map as a value: its regions, arcs and corners, each with what was proved there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

from mbsym.algebra.arrangements import Arrangement
from mbsym.algebra.plane import Point
from mbsym.algebra.plane.line import Line
from mbsym.maps.admissible import Admissibility, Demand
from mbsym.maps.boundaries import Boundaries
from mbsym.maps.check import Check
from mbsym.maps.section import Section
from mbsym.maps.soft_borders import SoftBorders, SoftOrHard
from mbsym.maps.verdicts import Border, Judged
from mbsym.problems.stability.word import Word


class Of(StrEnum):
    """What a map is coloured by."""

    STABILITY = "stability"
    SIGNATURE = "signature"


class Shape(StrEnum):
    """What a place of a map is."""

    REGION = "region"
    ARC = "arc"
    CORNER = "corner"
    #: Of a line.
    INTERVAL = "interval"
    ZERO = "point"
    #: Of a plane without an arrangement.
    BOX = "box"


class Standing(StrEnum):
    """Whether there is a verdict at a place, and if not, why."""

    JUDGED = "judged"
    OUTSIDE = "outside of the assumptions"
    MASSLESS = "the mass matrix is not positive definite"
    UNDEFINED = "formulas divide by zero"
    TOO_LARGE = "too large to be decided"
    WITHDRAWN = "withdrawn: the map's own check failed"
    NOT_REACHED = "not reached"


@dataclass(frozen=True)
class Stratum:
    """A region, an arc of a curve, or a corner: ``number`` is its place in the arrangement's list.

    ``judged`` is None but where ``standing`` is JUDGED; ``broken``: the demands that are not kept there.
    ``soft``: of arcs, corners and zeros at which one pair of roots is imaginary and none to the right; None elsewhere.
    """

    shape: Shape
    number: int
    standing: Standing
    judged: Judged | None = None
    broken: tuple[Demand, ...] = ()
    soft: SoftOrHard | None = None

    @property
    def right(self) -> int | None:
        """How many roots are to the right; None where that is not known."""
        return None if self.judged is None else self.judged.right

    @property
    def imaginary(self) -> bool:
        """Whether a pair of roots is imaginary there and none to the right: a border of flutter if it is lost there."""
        return self.judged is not None and self.judged.border is Border.IMAGINARY and self.judged.right == 0

    @property
    def word(self) -> Word | None:
        return None if self.judged is None else self.judged.verdict.word

    @property
    def kind(self) -> tuple[object, ...]:
        """What strata have in common that look alike in every respect that a map shows."""
        if self.judged is None:
            return (self.standing,)
        found = self.judged
        return (found.verdict.word, found.verdict.theorems, found.right, found.real_right, found.degree)


class Shown:
    """What maps of planes and of lines have in common."""

    of: Of

    @property
    def partial(self) -> bool:
        """Whether Ctrl-C ended the work."""
        return bool(getattr(self, "interrupted", False))

    def look(self, stratum: Stratum) -> tuple[object, ...]:
        """What a picture tells apart."""
        found = stratum.judged
        if found is None:
            return (stratum.standing,)
        if self.of is Of.SIGNATURE:
            return (found.degree, found.null)
        return (found.verdict.word, found.right, found.real_right)


def _together(count: int, alike: Iterable[tuple[int, int]]) -> tuple[int, ...]:
    """For each of so many regions the first one that it is joined with, over pairs that nothing separates."""
    first = list(range(count))

    def of(k: int) -> int:
        while first[k] != k:
            k = first[k]
        return k

    for a, b in alike:
        low, high = sorted((of(a), of(b)))
        first[high] = low
    return tuple(of(k) for k in range(count))


@dataclass(frozen=True)
class LineMap(Shown):
    """A map over one axis: ``regions`` are the intervals of ``line``, ``corners`` its zeros, ``areas`` lengths."""

    of: Of
    section: Section
    admissibility: Admissibility
    boundaries: Boundaries
    line: Line
    regions: tuple[Stratum, ...]
    corners: tuple[Stratum, ...]
    areas: tuple[tuple[float, float], ...]
    interrupted: bool = False
    check: Check | None = None
    arcs: tuple[Stratum, ...] = ()
    borders: SoftBorders | None = field(default=None, repr=False, compare=False)

    @property
    def strata(self) -> Iterator[Stratum]:
        yield from self.regions
        yield from self.corners

    @property
    def whole(self) -> float:
        """The length of the interval."""
        return float(self.line.high - self.line.low)

    @property
    def together(self) -> tuple[int, ...]:
        """For each interval the first of those that it makes one with: no zero between them changes what is shown."""
        pairs: list[tuple[int, int]] = []
        for one in self.corners:
            beside = [x.id for x in self.line.intervals if one.number in x.ends]
            if {self.look(self.regions[k]) for k in beside} == {self.look(one)}:
                pairs += pairwise(beside)
        return _together(len(self.regions), pairs)

    def changes(self, corner: Stratum) -> bool:
        """Whether what is shown differs at a zero from one of its sides."""
        beside = [x for x in self.line.intervals if corner.number in x.ends]
        looks = {self.look(self.regions[x.id]) for x in beside}
        undecided = corner.standing in (Standing.TOO_LARGE, Standing.WITHDRAWN, Standing.NOT_REACHED)
        return len(looks) > 1 or (not undecided and len(beside) > 1 and self.look(corner) not in looks)


@dataclass(frozen=True)
class PlaneMap(Shown):
    """``regions``, ``arcs`` and ``corners`` in the order of ``arrangement``; ``interrupted``: some were not reached.

    ``areas``: of the regions, with estimates of their errors.  ``check``: more points in every cell and on every arc,
    judged by a route without the boundary polynomials; None where it was not carried out.  ``borders`` tells of further
    points whether they are soft or hard; None where that was not asked.
    """

    of: Of
    section: Section
    admissibility: Admissibility
    boundaries: Boundaries
    arrangement: Arrangement
    regions: tuple[Stratum, ...]
    arcs: tuple[Stratum, ...]
    corners: tuple[Stratum, ...]
    areas: tuple[tuple[float, float], ...]
    interrupted: bool = False
    check: Check | None = None
    borders: SoftBorders | None = field(default=None, repr=False, compare=False)

    @property
    def strata(self) -> Iterator[Stratum]:
        yield from self.regions
        yield from self.arcs
        yield from self.corners

    def beside(self, arc: Stratum) -> tuple[Stratum | None, Stratum | None]:
        """The regions below and above an arc (left and right of a vertical one); None is outside of the box."""
        below, above = self.arrangement.arcs[arc.number].regions
        return None if below is None else self.regions[below], None if above is None else self.regions[above]

    @property
    def together(self) -> tuple[int, ...]:
        """For each region the first of those that it makes one with, as no arc between them changes what is shown."""
        pairs = []
        for arc in self.arcs:
            a, b = self.beside(arc)
            if a is not None and b is not None and self.look(a) == self.look(arc) == self.look(b):
                pairs.append((a.number, b.number))
        return _together(len(self.regions), pairs)

    def separates(self, arc: Stratum) -> bool:
        """Whether what is shown differs between the two sides of an arc."""
        below, above = self.beside(arc)
        return below is not None and above is not None and self.look(below) != self.look(above)

    def singles_out(self, arc: Stratum) -> bool:
        """Whether what is shown on an arc differs from both of its sides, which are alike."""
        sides = {self.look(x) for x in self.beside(arc) if x is not None}
        undecided = arc.standing in (Standing.TOO_LARGE, Standing.WITHDRAWN, Standing.NOT_REACHED)
        return not undecided and not self.separates(arc) and bool(sides) and self.look(arc) not in sides

    @property
    def whole(self) -> float:
        """The area of the plane."""
        return float(self.arrangement.box.area)

    def point_of(self, stratum: Stratum) -> Point:
        """The exact point at which a stratum was judged."""
        if stratum.shape is Shape.REGION:
            return Point(*self.arrangement.regions[stratum.number].sample)
        if stratum.shape is Shape.ARC:
            return self.arrangement.arcs[stratum.number].point
        return self.arrangement.corners[stratum.number].point
