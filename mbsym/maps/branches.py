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

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import fmpq

from mbsym.algebra.failures import Failure
from mbsym.algebra.plane.numbers import Number, ascending, between_simply, compare, enclosure
from mbsym.algebra.polynomial_systems import Limits
from mbsym.maps.branches_curve import Curve, CurvePoint, Found, curves, joined
from mbsym.maps.branches_events import named
from mbsym.maps.branches_linked import linked
from mbsym.maps.branches_result import Branches, Critical, Doubt, Interval, Meeting, Piece, Remark
from mbsym.maps.branches_stability import decided_throughout, is_undamped, stability_changes
from mbsym.maps.section import Axis
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue, Equilibria, equilibria

#: Tells what is being done: a word, how much of it is done, and how much there is.
Watch = Callable[[str, int, int], None]


def unwatched(_: str, done: int, whole: int) -> None:
    """Tells nobody."""


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
    intervals: list[Interval] = []
    pieces: list[Piece] = []
    criticals: list[Critical] = []
    interrupted = False
    try:
        for k, (low, high) in enumerate(_gaps(numbers, axis)):
            watch("samples", k, len(numbers) + 1)
            sample = _sample(low, high)
            found = equilibria(system, {**values, axis.name: sample}, limits=bounds)
            remarks += _of_sample(found, sample)
            constant = count_proved and found.complete and not found.families
            intervals.append(Interval(low, high, sample, found.equilibria, constant))
        for k, number in enumerate(numbers):
            watch("critical values", k, len(numbers))
            meetings, reason, singular = _meetings(parts, number)
            if meetings is not None and isinstance(number, fmpq):
                at = Fraction(int(number.p), int(number.q))
                meetings = _judged(meetings, equilibria(system, {**values, axis.name: at}, limits=bounds))
            if reason:
                remarks.append(Remark(Doubt.UNCOUNTED, f"{short(number)}: {reason}"))
            criticals.append(
                Critical(
                    number,
                    meetings,
                    _among(number, bifurcating.continua),
                    singular or _among(number, [*leaving.continua, *(x.number for x in leaving.points)]),
                    None,
                )
            )
        watch("branches", 0, 1)
        criticals = [_balanced(one, intervals, axis) for one in criticals]
        remarks += [Remark(Doubt.MISMATCH, short(one.number)) for one in criticals if one.balance is False]
        solved = not (changing.unfinished or changing.throughout)
        undamped = all(is_undamped(one.search) for one in parts)
        for piece in linked(parts, axis, intervals, criticals):
            throughout = decided_throughout(intervals[piece.interval], piece.number, solved, undamped)
            pieces.append(replace(piece, throughout=throughout))
    except KeyboardInterrupt:
        interrupted = True
    names = tuple(dict.fromkeys(name for one in parts for name in one.names))
    related = {item.name for item in system.relations}
    given = {name: value for name, value in values.items() if name != axis.name and name not in related}
    told = tuple(dict.fromkeys(remarks))
    return Branches(axis, given, names, tuple(criticals), tuple(intervals), tuple(pieces), told, interrupted)


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


def _gaps(numbers: Sequence[Number], axis: Axis) -> list[tuple[Number, Number]]:
    """The open intervals that are left; ends that are critical belong to none."""
    low, high = (fmpq(x.numerator, x.denominator) for x in (axis.low, axis.high))
    inner = [x for x in numbers if compare(x, low) > 0 and compare(x, high) < 0]
    marks = [low, *inner, high]
    return list(pairwise(marks))


def _sample(low: Number, high: Number) -> Fraction:
    """A rational number between, but 0: a parameter that vanishes may make the equations others."""
    found = between_simply(low, high)
    if found == 0:
        found = between_simply(fmpq(0), high)
    return Fraction(int(found.p), int(found.q))


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


def _balanced(one: Critical, intervals: Sequence[Interval], axis: Axis) -> Critical:
    """Whether the events account for the counts on both sides."""
    if one.meetings is None or one.continuum or one.border:
        return one
    named_ = [x.named for x in one.meetings]
    if any(x.below is None for x in named_):
        return one
    holds: list[bool] = []
    for k, interval in enumerate(intervals):
        if compare(interval.high, one.number) == 0:
            holds.append(sum(x.below or 0 for x in named_) == len(intervals[k].equilibria))
        if compare(interval.low, one.number) == 0:
            holds.append(sum(x.above or 0 for x in named_) == len(intervals[k].equilibria))
    return replace(one, balance=all(holds)) if holds else one


def short(x: Any) -> str:
    return str(x) if isinstance(x, fmpq) else f"{float(enclosure(x).mid()):.10g}"
