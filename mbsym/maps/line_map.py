"""A map over one parameter: intervals between exact numbers, each with its verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import AlgebraicNumber
from mbsym.algebra.plane.line import Line, decompose_line, univariate
from mbsym.algebra.plane.numbers import sign
from mbsym.analysis import Analysis
from mbsym.maps.admissible import Admissibility, admissibility
from mbsym.maps.boundaries import boundaries
from mbsym.maps.check import check
from mbsym.maps.constant_points import beside
from mbsym.maps.given import Complaint, Fault, Unfit
from mbsym.maps.mapping import Watch, asked, ends, unwatched
from mbsym.maps.on_curves import ExactVerdicts
from mbsym.maps.result import LineMap, Of, Shape, Standing, Stratum
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.soft_borders import Onset, SoftBorders, SoftOrHard, lost


def line_map(
    analysis: Analysis,
    axis: Axis,
    settings: Mapping[str, Fraction],
    of: Of = Of.STABILITY,
    watch: Watch = unwatched,
) -> LineMap:
    """The map of a description over one axis; failures as those of ``plane_map``."""
    watch("first approximation", 0, 1)
    there = section(analysis, [axis], settings)
    kept = admissibility(analysis, there)
    if kept.broken:
        raise Unfit([Complaint(Fault.OUTSIDE, "", one.condition.about) for one in kept.broken])
    watch("boundaries", 0, 1)
    found = boundaries(there, [*(one.condition for one in kept.demands), *asked(there)], kept.known)
    context = fmpq_mpoly_ctx.get((axis.name,), Ordering.lex)
    factors = [x if there.constant is None else x.project_to_context(context) for x in found.factors]
    line = decompose_line(factors, *ends(axis))
    judge = LineJudge(there, kept)
    places: list[tuple[Shape, int, Any]] = [(Shape.INTERVAL, one.id, one.sample) for one in line.intervals]
    places += [(Shape.ZERO, one.id, one.number) for one in line.zeros]
    strata: list[Stratum] = []
    interrupted = False
    for done, (shape, number, at) in enumerate(places):
        try:
            watch("verdicts", done, len(places))
            if not interrupted:
                strata.append(judge(shape, number, at))
        except KeyboardInterrupt:
            interrupted = True
        if interrupted:
            strata.append(Stratum(shape, number, Standing.NOT_REACHED))
    regions, zeros = strata[: len(line.intervals)], strata[len(line.intervals) :]
    checked = None
    if not interrupted:
        intervals, points = ([one.judged for one in part] for part in (regions, zeros))
        checked = check(there, line, intervals, corners=points, progress=watch)
        wrong = {one.region for one in checked.findings}
        regions = [
            replace(one, standing=Standing.WITHDRAWN, judged=None) if one.judged and one.number in wrong else one
            for one in regions
        ]
        doubted = {one.corner for one in checked.findings}
        zeros = [
            replace(one, standing=Standing.WITHDRAWN, judged=None) if one.judged and one.number in doubted else one
            for one in zeros
        ]
    borders = None
    if of is Of.STABILITY and not interrupted:
        borders = SoftBorders(analysis, there)
        zeros = [replace(one, soft=_soft(borders, line, regions, one)) if one.imaginary else one for one in zeros]
    return LineMap(
        of, there, kept, replace(found, factors=tuple(factors)), line, tuple(regions), tuple(zeros), lengths(line),
        interrupted, checked, borders=borders,
    )  # fmt: skip


def _soft(borders: SoftBorders, line: Line, regions: list[Stratum], zero: Stratum) -> SoftOrHard:
    """Of a zero at which a pair of roots is imaginary."""
    sides = [regions[one.id].right for one in line.intervals if zero.number in one.ends]
    why = lost([*sides, None][:2])
    return SoftOrHard(Onset.NEITHER, why) if why else borders.at(line.zeros[zero.number].number)


def lengths(line: Line) -> tuple[tuple[float, float], ...]:
    """Of the intervals, and their errors, which are those of rounding."""
    marks = [line.low if x is None else line.zeros[x].number for one in line.intervals for x in one.ends[:1]]
    last = [line.high if x is None else line.zeros[x].number for one in line.intervals for x in one.ends[1:]]
    return tuple((_float(b) - _float(a), 1e-15 * abs(_float(b))) for a, b in zip(marks, last, strict=True))


def _float(x: Any) -> float:
    return float(x.p) / float(x.q) if isinstance(x, fmpq) else float(x)


class LineJudge:
    """Judges exact points of a section with one axis."""

    def __init__(self, there: Section, kept: Admissibility) -> None:
        self.section, self.kept = there, kept
        self.verdicts = ExactVerdicts(there)

    def __call__(self, shape: Shape, number: int, at: Any) -> Stratum:
        """What is proved at a rational or algebraic number."""
        broken = tuple(one for one in self.kept.demands if not one.kept(self.sign(one.condition.polynomial, at)))
        if broken:
            return Stratum(shape, number, Standing.OUTSIDE, None, broken)
        if any(self.sign(x, at) == 0 for x in self.section.undefined):
            return Stratum(shape, number, Standing.UNDEFINED)
        if not all(self.sign(minor, at) > 0 for minors in self._minors for minor in minors):
            return Stratum(shape, number, Standing.MASSLESS)
        try:
            judged = self.verdicts(beside(at, self.section.constant))
        except TooLargeError:
            return Stratum(shape, number, Standing.TOO_LARGE)
        return Stratum(shape, number, Standing.JUDGED, judged)

    def sign(self, p: Any, at: Any) -> int:
        """The sign of a polynomial of the section's context there."""
        if self.section.constant is not None:
            return self.section.constant.beside(at).sign(p)
        return at.sign(univariate(p)) if isinstance(at, AlgebraicNumber) else sign(fmpq(p(at)))

    @cached_property
    def _minors(self) -> list[tuple[Any, ...]]:
        return [leading_minors(part.kinetic) for part in self.section.parts if part.kinetic]
