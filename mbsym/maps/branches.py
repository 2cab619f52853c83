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

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import chain, pairwise
from typing import Any

import numpy as np
from flint import arb, fmpq

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Constrained, Failure
from mbsym.algebra.plane.line import Interval, Line, divided
from mbsym.algebra.plane.numbers import Number, ascending, between_simply, compare, enclosure, in_square_roots
from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.rationals import fraction
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.analysis.resting import judged
from mbsym.expressions.message import Message
from mbsym.maps.boundaries import Boundaries
from mbsym.maps.branches_curve import Curve, CurvePoint, CurvePoints, curves, joined
from mbsym.maps.branches_events import decided_throughout, is_bounded, is_undamped, named, stability_changes
from mbsym.maps.branches_result import Branches, Critical, Doubt, Meeting, Piece, Remark
from mbsym.maps.mapping import Watch, ends, float_of, lengths, unwatched
from mbsym.maps.result import Cell, Counted, Lack, Of, Shape
from mbsym.maps.section import Axis
from mbsym.mechanics.rest import at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import (
    CoordinateValue,
    Equilibria,
    RelativeEquilibrium,
    equilibria,
    rank_of,
)
from mbsym.problems.relative_equilibria.place import Place
from mbsym.problems.stability.words import Because

#: Parts of a range at which a parameter is tried, where nothing special happens.
_TRIED = tuple(Fraction(k, 97) for k in (48, 21, 77, 5, 92))


def branches(
    system: System, axis: Axis, values: Mapping[str, Fraction], limits: Limits | None = None, watch: Watch = unwatched
) -> Branches:
    """All branches of relative equilibria for the parameter ``axis.name`` in [axis.low, axis.high].

    ``values``: the numbers of the others.  Raises KeyError for a missing number, NoClosedForm where the equations are
    no polynomials in sines, cosines, lengths and the parameter, Constrained, SingularPoint.  KeyboardInterrupt while
    samples are solved ends the work: what was reached is kept, and says that it was interrupted.
    """
    bounds = limits or Limits()
    watch("critical values", 0, 1)
    rank = _rank(system, axis, values)
    parts, lost = curves(system, axis.name, values, axis.low, axis.high, bounds, rank)
    bifurcating = joined([part.where([part.singular]) for part in parts])
    leaving = joined([*(part.borders() for part in parts), lost])
    changing = joined([stability_changes(part) for part in parts])
    remarks = _doubts(bifurcating, leaving, changing)
    if any(
        curve.in_angles for curve in parts
    ):  # where something happens is not found: all of the curve seems to be there
        text = Message("[[name]] stands in a root or a function", name=axis.name)
        remarks = [Remark(Doubt.UNFINISHED, text) if x.doubt is Doubt.THROUGHOUT else x for x in remarks]
    of_all = (bifurcating, leaving, changing)
    numbers = _distinct([x for points in of_all for x in (*(y.number for y in points.points), *points.continua)])
    count_proved = not any(points.unfinished or points.throughout for points in (bifurcating, leaving))

    def listed(p: fmpq) -> Equilibria:
        return equilibria(system, {**values, axis.name: fraction(p)}, limits=bounds, rank=rank)

    def judged_at(p: fmpq) -> Equilibria:
        return judged(system, {**values, axis.name: fraction(p)}, listed(p))

    def judged_there(p: Number) -> Equilibria | None:
        """Critical values may be irrational; None where that is no square root, or nothing is listed."""
        told = in_square_roots(p)
        if told is None:
            return None
        try:
            there = {**values, axis.name: told}
            return judged(system, there, equilibria(system, there, limits=bounds, rank=rank))
        except (Failure, *NOT_THERE):
            return None

    tried = [] if count_proved else _changes(listed, *ends(axis), numbers)
    numbers = ascending([*numbers, *tried])
    line = divided(*ends(axis), [(x, ()) for x in numbers])
    regions = [Cell(Shape.INTERVAL, span.id, span.sample, lack=Lack.NOT_REACHED) for span in line.intervals]
    corners = [Cell(Shape.ZERO, zero.id, zero.number, lack=Lack.NOT_REACHED) for zero in line.zeros]
    names = tuple(dict.fromkeys(name for part in parts for name in part.names))
    related = {item.name for item in system.relations}
    fixed_values = {name: value for name, value in values.items() if name != axis.name and name not in related}

    def made(pieces: Sequence[Piece] = (), interrupted: bool = True) -> Branches:
        """As far as it was reached."""
        return Branches(
            Of.EQUILIBRIA, (axis,), fixed_values, line, Boundaries((), (), ()), tuple(regions), (), tuple(corners),
            lengths(line), interrupted=interrupted, coordinates=names, pieces=tuple(pieces),
            remarks=tuple(dict.fromkeys(remarks)),
        )  # fmt: skip

    try:
        for k, interval in enumerate(line.intervals):
            watch("samples", k, len(regions))
            sample = _sample(interval, line)
            sampled = judged_at(sample)
            remarks += _of_sample(sampled, fraction(sample))
            at_lost = any(x.verdict.because(Because.RANK_LOST) for x in sampled.equilibria)
            constant = count_proved and sampled.complete and not sampled.families and not at_lost
            surely = Certainty.PROVED if constant else Certainty.UNDECIDED
            regions[k] = Cell(Shape.INTERVAL, k, sample, Counted(sampled.equilibria), surely)
        for k, number in enumerate(numbers):
            watch("critical values", k, len(numbers))
            if any(number is x for x in tried):
                near = Critical(None, False, False, tried=True)
                corners[k] = Cell(Shape.ZERO, k, number, near, Certainty.UNDECIDED)
                continue
            meetings, reason, singular = _meetings(parts, number)
            if meetings is not None and (there_judged := judged_there(number)) is not None:
                meetings = _judged(meetings, there_judged)
            if reason:
                remarks.append(Remark(Doubt.UNCOUNTED, f"{short(number)}: {reason}"))
            border = singular or _among(number, [*leaving.continua, *(x.number for x in leaving.points)])
            at_lost = _among(number, [*lost.continua, *(x.number for x in lost.points)])
            there = Critical(meetings, _among(number, bifurcating.continua), border, rank_lost=at_lost)
            corners[k] = Cell(Shape.ZERO, k, number, there, Certainty.PROVED)
        watch("branches", 0, 1)
        without = made()
        for critical in without.criticals:
            there = _balanced(without, critical)
            corners[critical.number] = replace(critical, said=there)
            if there.balance is False:
                remarks.append(Remark(Doubt.MISMATCH, short(critical.sample)))
        solved = not (changing.unfinished or changing.throughout)
        along = [all(known(part.search) for part in parts) for known in (is_undamped, is_bounded)]
        pieces = [
            replace(piece, throughout=decided_throughout(regions[piece.interval], piece.number, solved, *along))
            for piece in linked(parts, made())
        ]
        return made(pieces, interrupted=False)
    except KeyboardInterrupt:
        return made()


#: So many values are tried where critical ones may be missing; between two of them the interval is halved so often.
_TRIALS, _HALVINGS = 32, 5


def _changes(listed: Callable[[fmpq], Equilibria], low: fmpq, high: fmpq, numbers: Sequence[Number]) -> list[fmpq]:
    """Values near which the number of equilibria is seen to change, but for those between which a critical one lies."""

    def count(p: fmpq) -> int | None:
        with suppress(Failure):
            return len(listed(p).equilibria)
        return None

    tried = [low + (high - low) * k / _TRIALS for k in range(_TRIALS + 1)]
    tried = [p + (high - low) / (97 * _TRIALS) if p == 0 else p for p in tried]  # 0 may make the equations others
    changes = []
    for (a, left), (b, right) in pairwise((p, count(p)) for p in tried):
        if left is None or right is None or left == right or any(compare(a, x) <= 0 <= compare(b, x) for x in numbers):
            continue
        below, above = a, b
        for _ in range(_HALVINGS):
            middle = (below + above) / 2
            below, above = (middle, above) if count(middle) == left else (below, middle)
        changes.append(between_simply(below, above))
    return changes


def _rank(system: System, axis: Axis, values: Mapping[str, Fraction]) -> int | None:
    """The rank of the constraints, at the first of some values of the parameter at which positions keep them."""
    if not system.constraints:
        return None
    width = axis.high - axis.low
    *others, last = (axis.low + width * part for part in _TRIED)
    for p in others:
        with suppress(Constrained):
            return rank_of(rest(at_numbers(system, {**values, axis.name: p})))
    return rank_of(rest(at_numbers(system, {**values, axis.name: last})))


def _doubts(bifurcating: CurvePoints, leaving: CurvePoints, changing: CurvePoints) -> list[Remark]:
    doubts = [Remark(Doubt.UNFINISHED, x) for points in (bifurcating, leaving) for x in points.unfinished]
    if bifurcating.throughout:
        doubts.append(Remark(Doubt.THROUGHOUT))
    doubts += [Remark(Doubt.STABILITY, x) for x in changing.unfinished]
    return doubts


def _of_sample(sampled: Equilibria, sample: Fraction) -> list[Remark]:
    remarks = []
    if not sampled.complete:
        remarks.append(Remark(Doubt.INCOMPLETE, str(sample)))
    if sampled.families:
        remarks.append(Remark(Doubt.FAMILIES, str(sample)))
    return remarks


def _distinct(numbers: Sequence[Number]) -> list[Number]:
    kept_numbers: list[Number] = []
    for x in numbers:
        if not _among(x, kept_numbers):
            kept_numbers.append(x)
    return ascending(kept_numbers)


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
            curve_points = part.where([], number)
        except Failure as reason:
            return None, str(reason), False
        if curve_points.unfinished:
            return None, "; ".join(curve_points.unfinished), False
        for x in curve_points.points:
            if not x.beyond and not any(x.same(y) for y in points):
                points.append(x)
    meetings = []
    singular = False
    for x in points:
        verdict = x.curve.search.verdict(x.place)
        if verdict.coordinates_singular:
            singular = True
        else:
            meetings.append(Meeting(x.curve.search._values(x.place), x.curve.label, named(x), verdict))
    return tuple(meetings), "", singular


def _judged(meetings: Sequence[Meeting], sampled: Equilibria) -> tuple[Meeting, ...]:
    """With the verdicts of the list at that number, where more is known of signs than with a parameter."""
    judged = []
    for meeting in meetings:
        same = [
            x
            for x in sampled.equilibria
            if x.coordinates_of == meeting.coordinates_of and _close(x.values, meeting.values)
        ]
        judged.append(replace(meeting, verdict=same[0].verdict) if len(same) == 1 else meeting)
    return tuple(judged)


def _close(a: Sequence[CoordinateValue], b: Sequence[CoordinateValue]) -> bool:
    return len(a) == len(b) and all(
        x.name == y.name and abs(x.value - y.value) < 1e-9 for x, y in zip(a, b, strict=True)
    )


def _balanced(diagram: Branches, at: Cell) -> Critical:
    """Whether the events account for the counts on both sides."""
    critical = diagram.critical(at)
    if critical.meetings is None or critical.continuum or critical.border:
        return critical
    named_ = [x.named for x in critical.meetings]
    if any(x.below is None for x in named_):
        return critical
    below, above = diagram.sides(at)
    holds: list[bool] = []
    if below is not None:
        holds.append(sum(x.below or 0 for x in named_) == len(diagram.equilibria(below)))
    if above is not None:
        holds.append(sum(x.above or 0 for x in named_) == len(diagram.equilibria(above)))
    return replace(critical, balance=all(holds)) if holds else critical


def short(x: Any) -> str:
    return str(x) if isinstance(x, fmpq) else f"{float(enclosure(x).mid()):.10g}"


# Which branch tends to which equilibrium at a critical value: followed in floating point, then held against counts.


#: Farther than this (in direction cosines, sines, cosines, lengths) a branch does not tend to an equilibrium.
FAR = 0.05
#: Below this what must not vanish in a case of the rank may be zero.
_ZERO = 1e-9


def linked(parts: Sequence[Curve], diagram: Branches) -> list[Piece]:
    """The branches over all intervals, with the meetings they start from and end in."""
    usable = [part for part in parts if uses_only_known(part.ring, [*part.forcing, *chain(*part.slopes)])]
    pieces: list[Piece] = []
    for interval in diagram.intervals:
        made: list[Piece] = []
        arrivals: list[tuple[tuple[float, ...] | None, tuple[float, ...] | None]] = []
        for number, equilibrium in enumerate(diagram.equilibria(interval)):
            curve = _curve_of(usable, equilibrium, float_of(interval.sample))
            piece, where = _followed(curve, equilibrium, diagram, interval, number)
            made.append(piece)
            arrivals.append(where)
        starts, stops = (
            _assigned(diagram, critical, [x[side] for x in arrivals], usable, below=side == 1)
            for side, critical in enumerate(diagram.between(interval))
        )
        pieces += [replace(branch, start=a, end=b) for branch, a, b in zip(made, starts, stops, strict=True)]
    return pieces


def _curve_of(usable: Sequence[Curve], equilibrium: RelativeEquilibrium | Meeting, p: float) -> Curve | None:
    """The curve that an equilibrium lies on: of the cases of the rank of constraints the nearest one."""
    values = {x.name: x.value for x in equilibrium.values}
    near: list[tuple[float, Curve]] = []
    for curve in usable:
        if curve.label != equilibrium.coordinates_of or set(curve.names) != set(values):
            continue
        numbers, at = Floats(curve.ring, curve.parameter), {**values, curve.parameter: p}
        if all(abs(numbers(x, at)) > _ZERO for x in curve.search.case.nonzero):
            near.append((max((abs(numbers(x, at)) for x in curve.search.case.zero), default=0.0), curve))
    return min(near, key=lambda x: x[0])[1] if near else None


def _followed(
    curve: Curve | None, equilibrium: RelativeEquilibrium, diagram: Branches, interval: Cell, number: int
) -> tuple[Piece, tuple[tuple[float, ...] | None, tuple[float, ...] | None]]:
    sample, k = float_of(interval.sample), interval.number
    values = {x.name: x.value for x in equilibrium.values}
    if curve is None:
        start = tuple(x.value for x in equilibrium.values)
        return Piece(k, number, False, None, None, (sample,), (start,)), (None, None)
    low, high = (float(enclosure(x).mid()) for x in diagram.ends(interval))
    start = tuple(values[name] for name in curve.names)
    ps, qs, at_low, at_high = followed(curve, start, sample, low, high)
    piece = Piece(k, number, False, None, None, tuple(ps), tuple(qs))
    ends = (_features(curve, ps[0], qs[0]) if at_low else None, _features(curve, ps[-1], qs[-1]) if at_high else None)
    return piece, ends


def _features(curve: Curve, p: float, q: Sequence[float]) -> tuple[float, ...]:
    balls = {name: arb(x) for name, x in zip(curve.names, q, strict=True)} | {curve.parameter: arb(p)}
    place = Place(curve.rest, balls, {}, None)
    return tuple(float(x.mid()) for x in curve.search._features(place))


def _assigned(
    diagram: Branches,
    at: Cell | None,
    arrivals: Sequence[tuple[float, ...] | None],
    usable: Sequence[Curve],
    below: bool,
) -> list[int | None]:
    """For every branch the number of the nearest meeting; nothing where the numbers that events demand do not come out.

    ``below``: the branches lie at smaller values of the parameter than the critical one.
    """
    nobody: list[int | None] = [None] * len(arrivals)
    meetings = None if at is None else diagram.critical(at).meetings
    if at is None or meetings is None:
        return nobody
    p = float(enclosure(at.sample).mid())
    places = [_features_at(meeting, usable, p) for meeting in meetings]
    chosen: list[int | None] = []
    for where in arrivals:
        distances = [
            (math.dist(where, x), k) for k, x in enumerate(places) if where is not None and x is not None
            and len(x) == len(where)
        ]  # fmt: skip
        nearest = min(distances, default=(math.inf, -1))
        chosen.append(nearest[1] if nearest[0] < FAR else None)
    required = [meeting.named.below if below else meeting.named.above for meeting in meetings]
    return [
        k if k is not None and (required[k] is None or chosen.count(k) == required[k]) else None for k in chosen
    ]  # fmt: skip


def _features_at(meeting: Meeting, usable: Sequence[Curve], p: float) -> tuple[float, ...] | None:
    curve = _curve_of(usable, meeting, p)
    if curve is None:
        return None
    values = {x.name: x.value for x in meeting.values}
    return _features(curve, p, [values[name] for name in curve.names])


# Branches followed in floating point, for pictures and for which equilibrium a branch tends to.
#
# Newton's method in the coordinates, from the sample outwards; nothing that is proved rests on it.


Array = Any  # numpy.ndarray of floats

#: Points of a branch over an interval, on either side of its sample.
POINTS = 40
#: The last of them is so near to the end, as a part of the interval.
NEAR = 1e-7
#: Steps of Newton's method at one value of the parameter, and when they are small enough.
MOST_STEPS, SMALL = 12, 1e-11


class Floats:
    """Polynomials of a ring at floating-point numbers of coordinates and one parameter."""

    def __init__(self, ring: Ring, parameter: str) -> None:
        self.ring, self.parameter = ring, parameter
        self._tables: dict[int, tuple[Any, list[tuple[float, tuple[tuple[int, int], ...]]]]] = {}

    def __call__(self, x: Polynomial, values: Mapping[str, float], known: dict[int, float] | None = None) -> float:
        """``known``: generators at these values, to which those are added that are met."""
        return self._total(x, values, {} if known is None else known)

    def _total(self, x: Polynomial, values: Mapping[str, float], known: dict[int, float]) -> float:
        if id(x) not in self._tables:
            terms = [
                (float(int(c.p)) / float(int(c.q)), tuple((k, int(e)) for k, e in enumerate(m) if e))
                for m, c in x.terms()
            ]
            self._tables[id(x)] = x, terms
        total = 0.0
        for coefficient, powers in self._tables[id(x)][1]:
            for k, e in powers:
                if k not in known:
                    known[k] = self._generator(k, values, known)
                coefficient *= known[k] ** e
            total += coefficient
        return total

    def _generator(self, k: int, values: Mapping[str, float], known: dict[int, float]) -> float:
        g = self.ring.generators[k]
        if g.kind in ("sine", "cosine") and g.argument is None:
            angle = values[g.name] / g.denominator
            return math.sin(angle) if g.kind == "sine" else math.cos(angle)
        if g.kind == "root":
            return math.sqrt(self._total(g.argument, values, known))
        if g.kind == "reciprocal":
            return 1 / self._total(g.argument, values, known)
        if g.kind in ("coordinate", "parameter"):
            return math.pi if g.name == "pi" else values[g.name]
        raise KeyError(g.name)


def followed(
    curve: Curve, start: Sequence[float], sample: float, low: float, high: float
) -> tuple[list[float], list[tuple[float, ...]], bool, bool]:
    """(values of the parameter, coordinates there, whether the lower end was reached, and the upper one)."""
    numbers = Floats(curve.ring, curve.parameter)
    below, reached_low = _outwards(curve, numbers, start, sample, low)
    above, reached_high = _outwards(curve, numbers, start, sample, high)
    whole = [*reversed(below), (sample, tuple(start)), *above]
    return [p for p, _ in whole], [q for _, q in whole], reached_low, reached_high


def _outwards(
    curve: Curve, numbers: Floats, start: Sequence[float], sample: float, end: float
) -> tuple[list[tuple[float, tuple[float, ...]]], bool]:
    points: list[tuple[float, tuple[float, ...]]] = []
    q = np.array(start, dtype=float)
    before: tuple[float, Array] | None = None
    at = sample
    for k in range(1, POINTS + 1):
        # evenly at first, then dense towards the end, where branches meet like square roots
        half = 2 * k / POINTS
        p = end + (sample - end) * (1 - 0.9 * half if half <= 1 else 0.1 * (10 * NEAR) ** (half - 1))
        guess = q if before is None else q + (q - before[1]) * ((p - at) / (at - before[0]))
        corrected = _newton(curve, numbers, guess, p)
        if corrected is None or np.max(np.abs(corrected - q)) > 0.6:
            corrected = _newton(curve, numbers, q, p)
        if corrected is None or np.max(np.abs(corrected - q)) > 0.6:
            return points, False
        before, q, at = (at, q), corrected, p
        points.append((p, tuple(float(x) for x in q)))
    return points, True


def _newton(curve: Curve, numbers: Floats, guess: Array, p: float) -> Array | None:
    q = np.array(guess, dtype=float)
    for _ in range(MOST_STEPS):
        values = {**dict(zip(curve.names, q.tolist(), strict=True)), curve.parameter: p}
        try:
            known: dict[int, float] = {}
            f = np.array([numbers(x, values, known) for x in curve.forcing])
            slopes = np.array([[numbers(x, values, known) for x in row] for row in curve.slopes])
            step = np.linalg.solve(slopes, f)
        except (ValueError, ArithmeticError, KeyError, np.linalg.LinAlgError):
            return None
        q = q - step
        if not np.all(np.isfinite(q)):
            return None
        if np.max(np.abs(step)) <= SMALL * max(np.max(np.abs(q)), np.max(np.abs(guess))):
            return q
    return None


def uses_only_known(ring: Ring, polynomials: Sequence[Polynomial]) -> bool:
    """Whether all generators are of a kind that ``Floats`` evaluates."""
    known = ("sine", "cosine", "root", "reciprocal", "coordinate", "parameter")
    return all(ring.generators[k].kind in known for k in ring.held(polynomials))
