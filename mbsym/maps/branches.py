"""How many relative equilibria there are over one parameter, where they bifurcate, and how stable each branch is.

Critical values of the parameter p are solved exactly: the real solutions of  f(q, p) = 0, det df/dq = 0,  those with an
unknown at infinity, a root or denominator at zero, and those at which a verdict of problem 6 may change (the constant
term, the last but one Hurwitz minor or a discriminant of the characteristic polynomial vanishes).  Between two of them
the equilibria go on one by one (implicit functions on a compact set), so their number is that at one rational sample,
where they are listed exactly (``problems.equilibria``); at each critical value they are solved in its number field, and
what happens is named by derivatives (``branches_events``).  The events have to account for the difference of the counts
on both sides, which are found by another route.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import fmpq

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.plane.line import Interval, Line, divided
from mbsym.algebra.plane.numbers import Number, ascending, between_simply, compare, enclosure
from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.rationals import fraction
from mbsym.maps.boundaries import Boundaries
from mbsym.maps.branches_curve import Curve, CurvePoint, Found, curves, joined
from mbsym.maps.branches_events import named
from mbsym.maps.branches_linked import linked
from mbsym.maps.branches_result import Branches, Critical, Doubt, Meeting, Piece, Remark
from mbsym.maps.branches_stability import decided_throughout, is_undamped, stability_changes
from mbsym.maps.mapping import Watch, ends, lengths, unwatched
from mbsym.maps.result import Cell, Counted, Lack, Of, Shape
from mbsym.maps.section import Axis
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue, Equilibria, equilibria


def branches(
    system: System,
    axis: Axis,
    values: Mapping[str, Fraction],
    limits: Limits | None = None,
    watch: Watch = unwatched,
) -> Branches:
    """All branches of relative equilibria for the parameter ``axis.name`` in [axis.low, axis.high].

    ``values``: the numbers of the others.  Raises KeyError for a missing number, NoClosedForm where the equations are
    no polynomials in sines, cosines, lengths and the parameter, Constrained, SingularPoint.  KeyboardInterrupt while
    samples are solved ends the work: what was reached is kept, and says that it was interrupted.
    """
    refuse_constraints(system, "relative equilibria")
    bounds = limits or Limits()
    watch("critical values", 0, 1)
    parts = curves(system, axis.name, values, axis.low, axis.high, bounds)
    bifurcating = joined([one.where([one.singular]) for one in parts])
    leaving = joined([one.borders() for one in parts])
    changing = joined([stability_changes(one) for one in parts])
    remarks = _doubts(bifurcating, leaving, changing)
    of_all = (bifurcating, leaving, changing)
    numbers = _distinct([x for one in of_all for x in (*(y.number for y in one.points), *one.continua)])
    count_proved = not any(one.unfinished or one.throughout for one in (bifurcating, leaving))
    line = divided(*ends(axis), [(x, ()) for x in numbers])
    regions = [Cell(Shape.INTERVAL, one.id, one.sample, lack=Lack.NOT_REACHED) for one in line.intervals]
    corners = [Cell(Shape.ZERO, one.id, one.number, lack=Lack.NOT_REACHED) for one in line.zeros]
    names = tuple(dict.fromkeys(name for one in parts for name in one.names))
    related = {item.name for item in system.relations}
    given = {name: value for name, value in values.items() if name != axis.name and name not in related}

    def made(pieces: Sequence[Piece] = (), interrupted: bool = True) -> Branches:
        """As far as it was reached."""
        return Branches(
            Of.EQUILIBRIA, (axis,), given, line, Boundaries((), (), ()), tuple(regions), (), tuple(corners),
            lengths(line), interrupted=interrupted, coordinates=names, pieces=tuple(pieces),
            remarks=tuple(dict.fromkeys(remarks)),
        )  # fmt: skip

    try:
        for k, interval in enumerate(line.intervals):
            watch("samples", k, len(regions))
            sample = _sample(interval, line)
            found = equilibria(system, {**values, axis.name: fraction(sample)}, limits=bounds)
            remarks += _of_sample(found, fraction(sample))
            constant = count_proved and found.complete and not found.families
            surely = Certainty.PROVED if constant else Certainty.UNDECIDED
            regions[k] = Cell(Shape.INTERVAL, k, sample, Counted(found.equilibria), surely)
        for k, number in enumerate(numbers):
            watch("critical values", k, len(numbers))
            meetings, reason, singular = _meetings(parts, number)
            if meetings is not None and isinstance(number, fmpq):
                at = equilibria(system, {**values, axis.name: fraction(number)}, limits=bounds)
                meetings = _judged(meetings, at)
            if reason:
                remarks.append(Remark(Doubt.UNCOUNTED, f"{short(number)}: {reason}"))
            border = singular or _among(number, [*leaving.continua, *(x.number for x in leaving.points)])
            there = Critical(meetings, _among(number, bifurcating.continua), border)
            corners[k] = Cell(Shape.ZERO, k, number, there, Certainty.PROVED)
        watch("branches", 0, 1)
        without = made()
        for one in without.criticals:
            there = _balanced(without, one)
            corners[one.number] = replace(one, said=there)
            if there.balance is False:
                remarks.append(Remark(Doubt.MISMATCH, short(one.sample)))
        solved = not (changing.unfinished or changing.throughout)
        undamped = all(is_undamped(one.search) for one in parts)
        pieces = [
            replace(piece, throughout=decided_throughout(regions[piece.interval], piece.number, solved, undamped))
            for piece in linked(parts, made())
        ]
        return made(pieces, interrupted=False)
    except KeyboardInterrupt:
        return made()


def _doubts(bifurcating: Found, leaving: Found, changing: Found) -> list[Remark]:
    found = [Remark(Doubt.UNFINISHED, x) for one in (bifurcating, leaving) for x in one.unfinished]
    if bifurcating.throughout:
        found.append(Remark(Doubt.THROUGHOUT))
    found += [Remark(Doubt.STABILITY, x) for x in changing.unfinished]
    return found


def _of_sample(found: Equilibria, sample: Fraction) -> list[Remark]:
    told = []
    if not found.complete:
        told.append(Remark(Doubt.INCOMPLETE, str(sample)))
    if found.families:
        told.append(Remark(Doubt.FAMILIES, str(sample)))
    return told


def _distinct(numbers: Sequence[Number]) -> list[Number]:
    kept: list[Number] = []
    for x in numbers:
        if not _among(x, kept):
            kept.append(x)
    return ascending(kept)


def _among(x: Number, others: Sequence[Number]) -> bool:
    return any(compare(x, y) == 0 for y in others)


def _sample(interval: Interval, line: Line) -> Any:
    """A rational number in an interval, but 0: a parameter that vanishes may make the equations others."""
    if interval.sample != 0:
        return interval.sample
    last = interval.ends[1]
    return between_simply(fmpq(0), line.high if last is None else line.zeros[last].number)


def _meetings(parts: Sequence[Curve], number: Number) -> tuple[tuple[Meeting, ...] | None, str, bool]:
    """The equilibria at a critical value, each configuration once, and why there are none to tell.

    Last, whether there are solutions at which the coordinates are singular: they are not counted.
    """
    points: list[CurvePoint] = []
    for part in parts:
        try:
            found = part.where([], number)
        except Failure as reason:
            return None, str(reason), False
        if found.unfinished:
            return None, "; ".join(found.unfinished), False
        for x in found.points:
            if not x.beyond and not any(x.same(y) for y in points):
                points.append(x)
    told = []
    singular = False
    for x in points:
        verdict = x.curve.search.verdict(x.place)
        if verdict.coordinates_singular:
            singular = True
        else:
            told.append(Meeting(x.curve.search._values(x.place), x.curve.label, named(x), verdict))
    return tuple(told), "", singular


def _judged(meetings: Sequence[Meeting], found: Equilibria) -> tuple[Meeting, ...]:
    """With the verdicts of the list at that number, where more is known of signs than with a parameter."""
    told = []
    for one in meetings:
        same = [x for x in found.equilibria if x.coordinates_of == one.coordinates_of and _close(x.values, one.values)]
        told.append(replace(one, verdict=same[0].verdict) if len(same) == 1 else one)
    return tuple(told)


def _close(a: Sequence[CoordinateValue], b: Sequence[CoordinateValue]) -> bool:
    return len(a) == len(b) and all(
        x.name == y.name and abs(x.value - y.value) < 1e-9 for x, y in zip(a, b, strict=True)
    )


def _balanced(found: Branches, at: Cell) -> Critical:
    """Whether the events account for the counts on both sides."""
    one = found.critical(at)
    if one.meetings is None or one.continuum or one.border:
        return one
    named_ = [x.named for x in one.meetings]
    if any(x.below is None for x in named_):
        return one
    below, above = found.sides(at)
    holds: list[bool] = []
    if below is not None:
        holds.append(sum(x.below or 0 for x in named_) == len(found.equilibria(below)))
    if above is not None:
        holds.append(sum(x.above or 0 for x in named_) == len(found.equilibria(above)))
    return replace(one, balance=all(holds)) if holds else one


def short(x: Any) -> str:
    return str(x) if isinstance(x, fmpq) else f"{float(enclosure(x).mid()):.10g}"
