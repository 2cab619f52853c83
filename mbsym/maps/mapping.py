"""From an analysis to its map: boundaries, their exact arrangement, a proved verdict in every region, on every arc
and at every corner."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.arrangements import Arrangement, areas, decompose
from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import Box, Point
from mbsym.analysis import Analysis
from mbsym.maps.admissible import Admissibility, admissibility
from mbsym.maps.boundaries import Boundaries, Condition, Origin, boundaries
from mbsym.maps.check import Check, check
from mbsym.maps.constant_points import beside
from mbsym.maps.given import Complaint, Fault, Unfit
from mbsym.maps.on_curves import ExactVerdicts
from mbsym.maps.result import Of, PlaneMap, Shape, Standing, Stratum
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.soft_borders import Onset, SoftBorders, SoftOrHard, lost
from mbsym.maps.verdicts import Judged, matrix_at, verdict_at
from mbsym.problems.stability.exact import inertia

#: Tells what is being done: a word, how much of it is done, and how much there is.
Watch = Callable[[str, int, int], None]


def unwatched(_: str, done: int, whole: int) -> None:
    """Tells nobody."""


def plane_map(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
) -> PlaneMap:
    """The map of a description over two axes.

    Raises Unfit for axes or values that do not fit, Unavailable where there is no first approximation to judge,
    TooLargeError where the arrangement is beyond its budget.  KeyboardInterrupt while verdicts are found ends the work:
    what was not reached says so.
    """
    watch("first approximation", 0, 1)
    there = section(analysis, axes, settings)
    kept = admissibility(analysis, there)
    if kept.broken:
        raise Unfit([Complaint(Fault.OUTSIDE, "", one.condition.about) for one in kept.broken])
    watch("boundaries", 0, 1)
    found = boundaries(there, [*(one.condition for one in kept.demands), *asked(there)], kept.known)
    return with_borders(mapped(there, kept, found, of, watch), SoftBorders(analysis, there), watch)


def with_borders(found: PlaneMap, borders: SoftBorders, watch: Watch) -> PlaneMap:
    """The map with what terms of higher order say of arcs and corners where a pair of roots is imaginary.

    They say it where stability is lost: of the cells beside one has roots to the right, the other none.
    """
    if found.of is not Of.STABILITY or found.interrupted:
        return found
    arcs, corners = list(found.arcs), list(found.corners)
    interrupted = False
    try:
        for k, one in enumerate(arcs):
            if one.imaginary:
                watch("soft or hard", k, len(arcs))
                why = lost([None if x is None else x.right for x in found.beside(one)])
                made = found.arrangement
                told = SoftOrHard(Onset.NEITHER, why) if why else borders.along(made, made.arcs[one.number])
                arcs[k] = replace(one, soft=told)
        for k, one in enumerate(corners):
            if one.imaginary:
                why = lost(list(_about(found, one)))
                told = SoftOrHard(Onset.NEITHER, why) if why else borders.at(found.point_of(one))
                corners[k] = replace(one, soft=told)
    except KeyboardInterrupt:
        interrupted = True
    return replace(found, arcs=tuple(arcs), corners=tuple(corners), interrupted=interrupted, borders=borders)


def _about(found: PlaneMap, corner: Stratum) -> Iterator[int | None]:
    """Roots to the right in the regions around a corner."""
    around = [found.beside(found.arcs[k]) for k in found.arrangement.corners[corner.number].arcs]
    for one in dict.fromkeys(x if x is None else x.number for pair in around for x in pair):
        yield None if one is None else found.regions[one].right


def mapped(
    there: Section, kept: Admissibility, found: Boundaries, of: Of = Of.STABILITY, watch: Watch = unwatched
) -> PlaneMap:
    """The map of a section of two axes with these boundaries, judged and checked; fails as ``plane_map`` does."""
    if there.constant is not None:
        plane = fmpq_mpoly_ctx.get([axis.name for axis in there.axes], Ordering.lex)
        found = replace(found, factors=tuple(x.project_to_context(plane) for x in found.factors))
    made = decompose(found.factors, box_of(there.axes), progress=watch)
    judge = Judge(there, kept)
    places = _places(made)
    strata: list[Stratum] = []
    interrupted = False
    for done, (shape, number, point) in enumerate(places):
        if not interrupted:
            try:
                watch("verdicts", done, len(places))
                strata.append(judge(shape, number, point))
                continue
            except KeyboardInterrupt:
                interrupted = True
        strata.append(Stratum(shape, number, Standing.NOT_REACHED))
    split = len(made.regions), len(made.regions) + len(made.arcs)
    parts = strata[: split[0]], strata[split[0] : split[1]], strata[split[1] :]
    checked = None
    if not interrupted:
        try:
            cells, arcs, points = ([x.judged for x in part] for part in parts)
            checked = check(there, made, cells, arcs, points, progress=watch)
            parts = withdrawn(parts, checked)
        except KeyboardInterrupt:
            interrupted = True
    regions, curved, corners = (tuple(part) for part in parts)
    return PlaneMap(of, there, kept, found, made, regions, curved, corners, areas(made), interrupted, checked)


Strata = list[Stratum]


def withdrawn(parts: tuple[Strata, Strata, Strata], checked: Check) -> tuple[Strata, Strata, Strata]:
    """Regions, arcs and corners without the verdicts that the check does not confirm.

    What is wrong with the arrangement as a whole takes all verdicts with it.
    """
    if checked.holds:
        return parts
    places = [(one.region, one.arc, one.corner) for one in checked.findings if one.breach is None]
    lone = len(places) == len(checked.findings) and all(place != (None, None, None) for place in places)
    regions = {one.region for one in checked.findings}
    arcs = {one.arc for one in checked.findings}
    corners = {one.corner for one in checked.findings}

    def kept(stratum: Stratum, doubted: bool) -> Stratum:
        falls = stratum.judged is not None and (doubted or not lone)
        return replace(stratum, standing=Standing.WITHDRAWN, judged=None) if falls else stratum

    return (
        [kept(one, one.number in regions) for one in parts[0]],
        [kept(one, one.number in arcs) for one in parts[1]],
        [kept(one, one.number in corners) for one in parts[2]],
    )


def ends(axis: Axis) -> tuple[Any, Any]:
    """As numbers of flint."""
    return fmpq(axis.low.numerator, axis.low.denominator), fmpq(axis.high.numerator, axis.high.denominator)


def box_of(axes: Sequence[Axis]) -> Box:
    """The box of the first two axes."""
    across, up = axes[:2]
    return Box(*ends(across), *ends(up))


def asked(there: Section) -> list[Condition]:
    """The axes' own zeros, where the law of the energy may depend on their signs."""
    return [Condition(Origin.ENERGY, x, about=str(x)) for x in there.asked]


def _places(made: Arrangement) -> list[tuple[Shape, int, Point]]:
    regions = [(Shape.REGION, one.id, Point(*one.sample)) for one in made.regions]
    arcs = [(Shape.ARC, one.id, one.point) for one in made.arcs]
    return [*regions, *arcs, *((Shape.CORNER, one.id, one.point) for one in made.corners)]


class Judge:
    """Judges exact points of a section, one by one."""

    def __init__(self, there: Section, kept: Admissibility) -> None:
        self.section, self.kept = there, kept

    def __call__(self, shape: Shape, number: int, point: Point) -> Stratum:
        """What is proved at a point."""
        try:
            return self._at(shape, number, point)
        except TooLargeError:
            return Stratum(shape, number, Standing.TOO_LARGE)

    def _at(self, shape: Shape, number: int, point: Point) -> Stratum:
        place = beside(point, self.section.constant)
        broken = tuple(one for one in self.kept.demands if not one.kept(place.sign(one.condition.polynomial)))
        if broken:
            return Stratum(shape, number, Standing.OUTSIDE, None, broken)
        if any(place.sign(x) == 0 for x in self.section.undefined):
            return Stratum(shape, number, Standing.UNDEFINED)
        if not self.positive(point, place):
            return Stratum(shape, number, Standing.MASSLESS)
        return Stratum(shape, number, Standing.JUDGED, self.judged(shape, point, place))

    def judged(self, shape: Shape, point: Point, place: Any) -> Judged:
        """The verdict at a point, ``place`` being the same with the section's constant."""
        if shape is not Shape.REGION:
            return self._on_curves(place)
        if self.section.constant is None:
            return verdict_at(self.section, (point.x, point.y))
        return replace(self._on_curves(place), border=None)

    @cached_property
    def _on_curves(self) -> ExactVerdicts:
        return ExactVerdicts(self.section)

    def positive(self, point: Point, place: Any) -> bool:
        """Whether M of every part is positive definite: its leading minors are."""
        if point.rational and self.section.constant is None:
            place = (point.x, point.y)
            return all(
                inertia(matrix_at(m, place))[0] == len(m) for m in (x.kinetic for x in self.section.parts if x.kinetic)
            )
        return all(place.sign(minor) > 0 for minors in self._minors for minor in minors)

    @cached_property
    def _minors(self) -> list[tuple[Any, ...]]:
        return [leading_minors(part.kinetic) for part in self.section.parts if part.kinetic]
