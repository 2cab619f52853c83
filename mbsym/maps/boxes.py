"""The map where no exact arrangement can be had, or where none is asked for: boxes with one proved verdict each.

What is proved holds at every point of a box, its edges included.  A box of which nothing is proved is white: that is no
statement about it, and the share of the area is told.  ``Method`` says how: by the boundary polynomials where these
can be had, by enclosures of the matrices where they are too large.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from random import Random
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import Box, Point
from mbsym.algebra.plane.numbers import Rational
from mbsym.analysis import Analysis
from mbsym.maps.admissible import Admissibility, admissibility
from mbsym.maps.boundaries import Boundaries, boundaries
from mbsym.maps.check import Check, check_boxes
from mbsym.maps.given import Complaint, Fault, Unfit
from mbsym.maps.irrational import IrrationalSection, irrational, told
from mbsym.maps.mapping import Judge, Watch, asked, box_of, unwatched
from mbsym.maps.result import Of, Shape, Shown, Standing, Stratum
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.subdivision import ByBoundaries, ByEnclosures, End, Subdivision, Tile, about_centre, subdivide
from mbsym.maps.verdicts import Judged
from mbsym.problems.stability.word import Word

#: Boxes are halved so often at most, and there are so many of them at most.
DEPTH, MOST = 12, 20_000
#: So many proved boxes are tried at a second point.
TRIED = 200


class Method(StrEnum):
    """How boxes are proved."""

    BOUNDARIES = "no boundary polynomial vanishes in a box"
    ENCLOSURES = "theorems that hold for enclosures of the matrices"


@dataclass(frozen=True)
class BoxMap(Shown):
    """``tiles`` fill the plane; what is proved of one is a stratum, None where it is white.

    ``because``: why there is no exact arrangement; empty where boxes were asked for.  ``check``: a second point in
    proved boxes, judged by itself.
    """

    of: Of
    section: Section
    admissibility: Admissibility
    boundaries: Boundaries
    subdivision: Subdivision[Stratum]
    method: Method
    because: str
    check: Check | None

    @property
    def interrupted(self) -> bool:
        return self.subdivision.end is End.INTERRUPTED or self.check is None

    @property
    def tiles(self) -> tuple[Tile[Stratum], ...]:
        return self.subdivision.tiles

    @property
    def strata(self) -> Iterator[Stratum]:
        """Of the boxes that are not white."""
        for tile in self.tiles:
            if tile.proved is not None:
                yield tile.proved


def box_map(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
    because: str = "",
    depth: int = DEPTH,
    most: int = MOST,
) -> BoxMap:
    """The plane of two axes in boxes: halved down to 2^-depth of its area, ``most`` boxes.

    Where matrices are no fractions of polynomials (``irrational``) enclosures prove them.

    Raises Unfit and Unavailable as ``plane_map`` does; TooLargeError where boundaries are too large and the matrices
    hold an irrational constant or no signature is asked of them.  KeyboardInterrupt ends the halving: what is proved
    is kept.
    """
    watch("first approximation", 0, 1)
    functions: IrrationalSection | None = None
    try:
        there = section(analysis, axes, settings)
    except Unfit as unfit:
        if not irrational(unfit) or of is not Of.STABILITY:
            raise
        functions, because = IrrationalSection(analysis, axes, settings, unfit.complaints), because or told(unfit)
        there = functions.plain
    kept = admissibility(analysis, there)
    if kept.broken:
        raise Unfit([Complaint(Fault.OUTSIDE, "", one.condition.about) for one in kept.broken])
    watch("boundaries", 0, 1)
    prove: Any
    found, method = Boundaries((), (), ()), Method.ENCLOSURES
    try:
        if functions is None:
            found = boundaries(there, [*(one.condition for one in kept.demands), *asked(there)], kept.known)
            method = Method.BOUNDARIES
    except TooLargeError as error:
        if there.constant is not None or of is not Of.STABILITY:
            raise
        because = because or str(error)
    if method is Method.BOUNDARIES:
        prove = _bounded(there, kept, found)
    else:
        prove = _Enclosed(there, kept, functions or ByEnclosures(there))
    made = subdivide(box_of(there.axes), prove, depth, most, watch)
    made = replace(made, tiles=tuple(_numbered(made.tiles)))
    checked = None
    if made.end is not End.INTERRUPTED:
        try:
            judge = None if functions is None else functions.at
            checked = check_boxes(there, _tried(made), judge, progress=watch)
        except KeyboardInterrupt:
            checked = None
    if checked is not None and not checked.holds:
        made = replace(made, tiles=tuple(_withdrawn(made.tiles)))
    return BoxMap(of, there, kept, found, made, method, because, checked)


def _numbered(tiles: Sequence[Tile[Stratum]]) -> Iterator[Tile[Stratum]]:
    for k, tile in enumerate(tiles):
        yield tile if tile.proved is None else Tile(tile.box, replace(tile.proved, number=k))


def _withdrawn(tiles: Sequence[Tile[Stratum]]) -> Iterator[Tile[Stratum]]:
    """A route that is wrong in one box is trusted in none."""
    for tile in tiles:
        if tile.proved is not None and tile.proved.judged is not None:
            yield Tile(tile.box, replace(tile.proved, standing=Standing.WITHDRAWN, judged=None))
        else:
            yield tile


def _tried(made: Subdivision[Stratum]) -> list[tuple[int, Judged, tuple[Rational, Rational]]]:
    """(number, verdict, a random point) of some proved boxes, those of the largest area first."""
    source = Random(20261123)
    judged = [tile for tile in made.tiles if tile.proved is not None and tile.proved.judged is not None]
    judged.sort(key=lambda tile: -tile.box.area)
    found = []
    chosen = [*judged[: TRIED // 2], *source.sample(judged, min(TRIED // 2, len(judged)))]
    for tile in chosen * (TRIED // len(chosen) if chosen else 0):  # where boxes are few, several points in each
        box, shares = tile.box, [fmpq(source.randint(0, 996), 996) for _ in range(2)]
        at = (box.x0 + (box.x1 - box.x0) * shares[0], box.y0 + (box.y1 - box.y0) * shares[1])
        if tile.proved is not None and tile.proved.judged is not None:
            found.append((tile.proved.number, tile.proved.judged, at))
    return found


def _bounded(there: Section, kept: Admissibility, found: Boundaries) -> ByBoundaries[Stratum]:
    """Judged at the centre, exactly."""
    factors = found.factors
    if there.constant is not None:
        plane = fmpq_mpoly_ctx.get([axis.name for axis in there.axes], Ordering.lex)
        factors = tuple(x.project_to_context(plane) for x in factors)
    judge = Judge(there, kept)

    def at(x: Rational, y: Rational) -> Any:
        found = judge(Shape.REGION, 0, Point(x, y))
        return None if found.standing is Standing.TOO_LARGE else replace(found, shape=Shape.BOX)

    return ByBoundaries(factors, at)


class _Enclosed:
    """By enclosures, where what parameters have to keep is seen to be kept, or to be broken, in the whole box."""

    def __init__(self, there: Section, kept: Admissibility, verdicts: ByEnclosures | IrrationalSection) -> None:
        self._section, self._kept, self._verdicts = there, kept, verdicts
        self._minors = [minor for part in there.parts for minor in leading_minors(part.kinetic)]

    def __call__(self, box: Box, hint: Any) -> tuple[Stratum | None, Any]:
        return self._proved(box), None

    def _proved(self, box: Box) -> Stratum | None:
        broken = []
        for demand in self._kept.demands:
            sign = _sign(demand.condition.polynomial, box)
            if not sign:
                return None
            if not demand.kept(sign):
                broken.append(demand)
        if broken:
            return Stratum(Shape.BOX, 0, Standing.OUTSIDE, None, tuple(broken))
        if not all(_sign(p, box) for p in self._section.undefined) or any(_sign(p, box) != 1 for p in self._minors):
            return None
        verdict = self._verdicts.verdict(box)
        if verdict.word is Word.UNDECIDED:
            return None
        return Stratum(Shape.BOX, 0, Standing.JUDGED, Judged(verdict, None, None, None, None))


def _sign(p: Any, box: Box) -> int:
    """1 or -1 where p has that sign in the whole box, 0 where that is not seen."""
    middle, radius = about_centre(p, box)
    return int(middle > radius) - int(-middle > radius)
