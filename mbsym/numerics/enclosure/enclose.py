"""Enclosures over a stretch of time, with as many bits as the width asked for needs.

The solution from exact initial numbers is enclosed with few bits first; where its widest component is wider than asked
for, or no further step can be proved, as many bits more are taken as that needs, and it begins again: the width of a
solution from a point grows by a factor that belongs to the motion, whatever the bits.  Components are reckoned as parts
of their sizes, so that nothing of this depends on units.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import inf, isfinite, log2
from time import perf_counter
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from mbsym.algebra import rationals
from mbsym.numerics.enclosure.field import LARGER, TINY, Field, Model, Ring, cap, model, upper
from mbsym.numerics.kernels.interface import Code

# One step of an enclosure: where a set of states is after a while, and everywhere in between.
#
# A set is  {m + A r : r in a box about 0}  with an exact point m and an exact matrix A (Lohner 1987).  After a step h
#
#     x(h; m + A r)  is in  x(h; m) + S A r,     S containing dx(h)/dx0 for every state of the set (mean values),
#
# x(h; m) by its Taylor series with the tail of ``disc``; S by that of the variational equation V' = J V, whose tail is
# bounded by  |V_ij,k| <= exp(R B)_ij / R^k,  B_ij >= |J_ij|_R, on a disc of thrice the step.  The new A is orthogonal,
# along the longest axes of S A first, so that boxes turn with the motion and are not wrapped again and again.


#: Steps are this part of the radius of the disc: each coefficient then gains 2 bits.
PART = 0.25

#: The derivative S needs few digits, for it multiplies what is small already.
TERMS_OF_DERIVATIVE = 18

#: The disc on which the derivative is bounded is so much larger than the step.
WIDER = 3.0


@dataclass(frozen=True)
class Bundle:
    """The states  centre + axes * box  at ``time``: exact numbers but for the box, n balls about 0.

    In parts of the sizes of a ``Field``.
    """

    time: arb
    centre: tuple[arb, ...]
    axes: arb_mat
    box: arb_mat

    @property
    def hull(self) -> list[arb]:
        """A ball for every component."""
        spread = self.axes * self.box
        return [value + spread[i, 0] for i, value in enumerate(self.centre)]


@dataclass(frozen=True)
class Segment:
    """Solutions from ``start`` to ``end``: x_i(start + s) is within ``spread_i`` of  sum_k coefficients_i,k s^k.

    ``last`` are balls of every component at the end, where the set is known best.  All in the units of the equations.
    """

    start: arb
    end: arb
    coefficients: tuple[tuple[arb, ...], ...]
    spread: tuple[arb, ...]
    last: tuple[arb, ...]

    @property
    def radii(self) -> list[float]:
        """How far, at most, the balls of ``at`` reach from their middles at any time of the segment."""
        return [
            float(max(spread, upper(x - x.mid()), key=float)) for spread, x in zip(self.spread, self.last, strict=True)
        ]

    def at(self, t: arb) -> list[arb]:
        """Balls that contain every component at ``t`` (a point or an interval of times within the segment)."""
        if t == self.end:
            return list(self.last)
        rows = zip(self.coefficients, self.spread, strict=True)
        return [_horner(row, t - self.start) + arb(0, spread) for row, spread in rows]


class CannotStep(Exception):
    """No disc of times was found in which the solutions are proved to exist.

    ``blurred``: the coefficients of the set are known too badly for one, and with more bits they would not be.
    """

    def __init__(self, blurred: bool) -> None:
        super().__init__()
        self.blurred = blurred


def unit(n: int) -> arb_mat:
    """The unit matrix."""
    return arb_mat(n, n, [1 if i == j else 0 for i in range(n) for j in range(n)])


def bundle(time: arb, state: Sequence[arb]) -> Bundle:
    """The set of states within balls."""
    n = len(state)
    box = arb_mat(n, 1, [value - value.mid() for value in state])
    return Bundle(time, tuple(value.mid() for value in state), unit(n), box)


def advanced(field: Field, now: Bundle, bits: int, guess: float, end: arb) -> tuple[Segment, Bundle, Disc]:
    """The set a step later, not beyond ``end``, with what lies between; ``guess`` is a radius to try first.

    Raises CannotStep where the solutions are not proved to go on.
    """
    solutions = field.solution(now.time, now.hull, TERMS_OF_DERIVATIVE - 1)
    circle = disc(field, now.time, solutions, guess)
    if circle is None:
        raise CannotStep(_blurred(solutions))
    longest = arb(circle.radius * PART)
    left = end - now.time
    last = bool(left <= longest)
    after = end if last else (now.time + longest).mid()
    step = after - now.time
    terms = max(TERMS_OF_DERIVATIVE, int(bits / float(-(step / circle.radius).log() / arb.const_log2())) + 2)
    coefficients = field.solution(now.time, now.centre, terms - 1)
    tail = circle.tail(float(step), terms)
    reached = [_horner(row, step) + arb(0, left_out) for row, left_out in zip(coefficients, tail, strict=True)]
    derivative, bound = _derivative(field, now.time, solutions, circle, step)
    grown = bound * (_absolute(now.axes) * _absolute(now.box))
    between = tuple(upper(grown[i, 0] + tail[i]) for i in range(field.size))
    later = _carried(after, reached, derivative * now.axes, now.box, arb(2) ** (-bits - GUARD // 2))
    series = tuple(tuple(value * size for value in row) for row, size in zip(coefficients, field.sizes, strict=True))
    spread = tuple(upper(value) for value in field.whole(between))
    return Segment(now.time, after, series, spread, tuple(field.whole(later.hull))), later, circle


def _blurred(coefficients: Sequence[Sequence[arb]]) -> bool:
    """Whether a coefficient is known to no digit, although it is there."""
    return any(not bool(abs(row[-1].rad()) < abs(row[-1].mid())) and row[-1].rad() > 0 for row in coefficients)


def _derivative(
    field: Field, t: arb, solutions: Sequence[Sequence[arb]], circle: Disc, step: arb
) -> tuple[arb_mat, arb_mat]:
    """S after the step, and a bound of |dx(s)/dx0| for all s up to it."""
    n, terms = field.size, TERMS_OF_DERIVATIVE
    radius = min(circle.radius, WIDER * float(step))
    sizes = arb_mat(n, n, [arb(size) for size in field.jacobian_sizes(t, circle.within(radius))])
    gradients = field.gradients(t, solutions, terms)
    powers = [unit(n)]
    slopes = [arb_mat([[gradients[i][j][k] for j in range(n)] for i in range(n)]) for k in range(terms)]
    total, scale = powers[0], arb(1)
    for k in range(terms - 1):
        product = slopes[0] * powers[k]
        for earlier in range(1, k + 1):
            product = product + slopes[earlier] * powers[k - earlier]
        powers.append(product / (k + 1))
        scale = scale * step
        total = total + powers[-1] * scale
    part = step / arb(radius)
    left = part**terms / (1 - part)
    growth = (sizes * radius).exp()
    tail = arb_mat(n, n, [arb(0, upper(growth[i, j] * left)) for i in range(n) for j in range(n)])
    return total + tail, (sizes * step).exp()


def _carried(time: arb, reached: Sequence[arb], moved: arb_mat, box: arb_mat, least: arb) -> Bundle:
    """The set  reached + moved * box  in new axes; sides are told apart beyond ``least``."""
    n = len(reached)
    centre = tuple(value.mid() for value in reached)
    rest = arb_mat(n, 1, [value - middle for value, middle in zip(reached, centre, strict=True)])
    axes = _orthogonal(moved, box, least)
    turned = axes.solve(moved) * box + axes.solve(rest)
    return Bundle(time, centre, axes, turned)


def _orthogonal(moved: arb_mat, box: arb_mat, least: arb) -> arb_mat:
    """Nearly orthogonal columns, the first along the longest side of the set; any exact regular matrix would do.

    Sides shorter than ``least``, which roundings made, count as so long: they would turn the axes otherwise in every
    unit.
    """
    n = moved.nrows()
    widths = [max(upper(box[j, 0]), least, key=float) for j in range(n)]
    largest = max(widths, key=float)
    columns = np.eye(n)
    sides = [[moved[i, j].mid() * (widths[j] / largest) for j in range(n)] for i in range(n)]
    tried = np.array([[float(value.mid()) for value in row] for row in sides])
    if np.all(np.isfinite(tried)):
        order = np.argsort(-np.linalg.norm(tried, axis=0), kind="stable")
        columns = np.linalg.qr(tried[:, order])[0]
    return arb_mat(n, n, [float(x) for x in columns.ravel()])


def _horner(row: Sequence[arb], s: arb) -> arb:
    value = row[-1]
    for coefficient in row[-2::-1]:
        value = value * s + coefficient
    return value


def _absolute(matrix: arb_mat) -> arb_mat:
    rows, columns = matrix.nrows(), matrix.ncols()
    return arb_mat(rows, columns, [upper(matrix[i, j]) for i in range(rows) for j in range(columns)])


# Where solutions are analytic in time: Picard's operator on functions of complex time.
#
# Let p_i(s) be the Taylor polynomials of degree d of the solutions that start in a box H at t0, and x = p + r with
# series r_i of terms of higher degree only, |r_i|_R <= e_i (the norm of ``model``).  Picard's operator leaves the
# terms up to degree d what they are, and those beyond it are
#
#     integral_0^s (terms of f(t0 + s', x(s')) of degree d and more),      |s^k integrated|_R = R |s^k|_R / (k + 1).
#
# If their norm is at most e, all iterates stay there, and with them the solutions: they are analytic for |s| < R, and
# what their series leave out after K > d terms at s = h is at most  e q^K,  q = h/R.


#: How many radii are tried, each so much of the last, and how often e is made larger for each, and by how much.
TRIALS, SHORTER, WIDENED, ROOM = 60, 0.8, 3, 2.0


@dataclass(frozen=True)
class Disc:
    """A radius R, the solutions as models on it, whose rests are the e_i."""

    radius: float
    solutions: tuple[Model, ...]

    def tail(self, step: float, terms: int) -> list[arb]:
        """A bound of what the first ``terms`` > d coefficients leave out at ``step`` < R, for each component."""
        part = arb(step) / arb(self.radius)
        return [(arb(solution.rest) * part**terms).abs_upper() for solution in self.solutions]

    def within(self, radius: float) -> tuple[Model, ...]:
        """The solutions as models on a smaller disc: of the rests, all of degree d + 1 or more, less is left."""
        ring = Ring(self.solutions[0].ring.degree, radius)
        part = (radius / self.radius) ** (ring.degree + 1) * LARGER
        return tuple(Model(ring, solution.poly, solution.rest * part + TINY) for solution in self.solutions)


def disc(field: Field, t: arb, coefficients: Sequence[Sequence[arb]], guess: float) -> Disc | None:
    """A disc about ``t`` for all solutions whose Taylor coefficients (of s^0 to s^d, n lists of balls) are these.

    Its radius is ``guess`` or less; None where none is found.
    """
    degree = len(coefficients[0]) - 1
    radius = guess
    with cap(degree + 1):
        for _ in range(TRIALS):
            ring = Ring(degree, radius)
            rests = [0.0] * field.size
            for _ in range(WIDENED):
                needed = _picard(field, ring, t, coefficients, rests)
                if not all(map(isfinite, needed)):
                    break
                if all(new <= old for new, old in zip(needed, rests, strict=True)):
                    pairs = zip(coefficients, rests, strict=True)
                    return Disc(radius, tuple(model(ring, row, rest) for row, rest in pairs))
                rests = [max(old, ROOM * new) for new, old in zip(needed, rests, strict=True)]
            radius *= SHORTER
    return None


def _picard(
    field: Field, ring: Ring, t: arb, coefficients: Sequence[Sequence[arb]], rests: Sequence[float]
) -> list[float]:
    """The rests of Picard's operator applied to  p + r,  |r_i| <= rests_i, r of higher degree than d."""
    states = [model(ring, row, rest) for row, rest in zip(coefficients, rests, strict=True)]
    try:
        slopes: list[Any] = field.rates(model(ring, [t, arb(1)]), states)
    except (ValueError, ZeroDivisionError):  # a quotient by a ball that contains zero
        return [inf] * len(rests)
    d, remainders = ring.degree, []
    for slope in slopes:
        rate = slope if isinstance(slope, Model) else model(ring, [slope])
        missed = float(rate.sizes[-1]) * ring.radius / (d + 1) + rate.rest * ring.radius / (d + 2)
        remainders.append(missed * LARGER + TINY)
    return remainders


#: Bits of the first try, beyond those that the width itself has; of the arithmetic beyond those of the series; at most.
FIRST, GUARD, MOST = 24, 24, 2_000

#: The first guess of the disc's radius, as a part of the whole time, and how it grows from step to step.
FIRST_GUESS, GROWTH = 0.02, 1.3

#: A disc smaller than this part of the whole time means that the enclosure cannot go on.
LEAST = 1e-7

#: A set that is wider than this part of a quantity's size, or so many times what was wanted, is given up.
WIDE, MUCH_WIDER = 1e-3, 1e3

#: After this part of its time an enclosure that would need so many times as much as it has is given up.
FIRST_LOOK, HOPELESS = 0.1, 10.0

#: Why an enclosure ends before the time asked for.
NO_STEP, TOO_WIDE, OUT_OF_TIME, INTERRUPTED = "no step proved", "too wide", "out of time", "interrupted"
TOO_DEAR = "too dear"
CUT = (OUT_OF_TIME, TOO_DEAR, INTERRUPTED)

#: What a step costs, an operation of rates and Jacobian and as many for all else, times the square of the bits: about
#: seconds of a usual machine (``mbsym.numerics.planning.prices``).
STEP, BESIDES = 6e-8, 15


@dataclass(frozen=True)
class Enclosure:
    """Segments that follow each other from 0 to ``reached``; ``ended`` says why that is not the end ("": it is).

    ``end`` is the time asked for; ``bits`` of the series; ``seconds`` is what the segments took; every component of the
    exact solution is within ``at(t)`` for t up to ``reached``.  ``cut`` says why no try with more bits, to make it
    narrower, came as far ("": none was cut).
    """

    segments: tuple[Segment, ...]
    bits: int
    reached: float
    ended: str
    seconds: float
    end: float = inf
    cut: str = ""

    @property
    def whole_seconds(self) -> float:
        """How long the whole would take at this pace: an estimate."""
        return self.seconds * self.end / self.reached if self.reached > 0 else inf

    def at(self, t: float) -> list[arb]:
        """Balls that contain the solution at t, n numbers; raises ValueError beyond ``reached``."""
        return self.within(t, t)

    def within(self, first: float, last: float) -> list[arb]:
        """Balls that contain the solution for all times from ``first`` to ``last``."""
        with ctx.workprec(self.bits + GUARD):
            begin, end = arb(first), arb(last)
            if first < 0 or last > self.reached or not self.segments:
                raise ValueError(f"enclosed from 0 to {self.reached:g} only")
            hull: list[arb] | None = None
            place = max(0, bisect_left(self._starts, first) - 1)
            for segment in self.segments[place:]:
                if segment.start > end:
                    break
                low = begin if begin > segment.start else segment.start
                high = end if end < segment.end else segment.end
                value = segment.at(low if first == last else low.union(high))
                hull = value if hull is None else [a.union(b) for a, b in zip(hull, value, strict=True)]
            assert hull is not None
            return hull

    @cached_property
    def _starts(self) -> list[float]:
        return [float(segment.start) for segment in self.segments]


def enclosed(
    rates: Code,
    jacobian: Code,
    state: Sequence[Fraction | arb],
    end: float,
    width: float,
    scales: Sequence[float],
    seconds: float = inf,
    watch: Callable[[float], None] = lambda t: None,
    limit: float = inf,
) -> Enclosure:
    """The solution of x' = rates(t, x) from ``state`` (exact numbers, or balls) at 0 to ``end``.

    ``width`` is the radius wanted of every component, as a part of its ``scale``.  The enclosure that comes
    furthest within ``seconds``, and for a cost of ``limit`` (counted work), is given; its ``ended`` says what was
    missing.  Raises NotAnalytic where the equations have no power series.
    """
    began, spent = perf_counter(), 0.0
    bits = FIRST + max(8, int(-log2(width)))
    exact = all(not isinstance(value, arb) or value.is_exact() for value in state)
    best: Enclosure | None = None
    while True:
        left = seconds - (perf_counter() - began)
        enclosure = _once(rates, jacobian, state, end, bits, left, width, scales, watch, limit - spent)
        spent += _price(rates, jacobian, bits) * len(enclosure.segments)
        if best is None or (enclosure.reached, not enclosure.ended) >= (best.reached, not best.ended):
            best = enclosure
        missing = _missing(enclosure, width, scales) if exact else 0
        finished = not missing or enclosure.ended in CUT or bits >= MOST
        if finished:
            # A try with more bits that was cut short is why there is no more, however far an earlier one came.
            cut = enclosure.ended if enclosure.ended in CUT else ""
            ended = cut if best.ended and cut else best.ended
            return replace(best, ended=ended, cut=cut)
        bits = min(MOST, bits + missing)


def _missing(enclosure: Enclosure, width: float, scales: Sequence[float]) -> int:
    """How many bits more would make it as narrow as wanted; 0 where it is, or more bits would not help."""
    if enclosure.ended == "":
        radii = [max(component) for component in zip(*(segment.radii for segment in enclosure.segments), strict=True)]
        widest = max(radius / scale for radius, scale in zip(radii, scales, strict=True))
        # Twice: what the series of a segment are rounded by comes on top of that.
        return 0 if 2 * widest <= width else 8 + int(log2(2 * widest / width))
    # Too wide on the way: as many bits as that part of the way has cost, for the rest of it, with some to spare.
    return max(32, enclosure.bits) if enclosure.ended == TOO_WIDE else 0


def _once(
    rates: Code,
    jacobian: Code,
    state: Sequence[Fraction | arb],
    end: float,
    bits: int,
    seconds: float,
    width: float,
    scales: Sequence[float],
    watch: Callable[[float], None],
    limit: float,
) -> Enclosure:
    began, price = perf_counter(), _price(rates, jacobian, bits)
    segments: list[Segment] = []
    guess, ended = FIRST_GUESS * end, ""
    with ctx.workprec(bits + GUARD):
        field = Field(rates, jacobian, bits + GUARD, scales)
        now = bundle(arb(0), [_ball(value) / size for value, size in zip(state, field.sizes, strict=True)])
        goal = arb(end)
        try:
            while now.time < goal:
                segment, now, circle = advanced(field, now, bits, guess, goal)
                segments.append(segment)
                guess = min(circle.radius * GROWTH, end)
                widest = max(_radius(value) / scale for value, scale in zip(segment.last, scales, strict=True))
                if not widest <= max(MUCH_WIDER * width, WIDE):
                    ended = TOO_WIDE
                elif circle.radius < LEAST * end:
                    ended = NO_STEP
                elif _late(perf_counter() - began, seconds, float(now.time) / end):
                    ended = OUT_OF_TIME if now.time < goal else ""
                elif _late(price * len(segments), limit, float(now.time) / end):
                    ended = TOO_DEAR if now.time < goal else ""
                if ended:
                    break
                watch(float(now.time))
        except CannotStep as reason:
            ended = TOO_WIDE if reason.blurred else NO_STEP
        except KeyboardInterrupt:
            ended = INTERRUPTED
        reached = float(segments[-1].end) if segments else 0.0
    return Enclosure(tuple(segments), bits, reached, ended, perf_counter() - began, end)


def _price(rates: Code, jacobian: Code, bits: int) -> float:
    """What a step costs."""
    return STEP * (rates.operations + jacobian.operations + BESIDES) * bits**2


def _late(taken: float, allowed: float, part: float) -> bool:
    """Whether seconds, or what it may cost, are over, or a tenth of that has shown that it is far too little."""
    return taken > allowed or (taken > FIRST_LOOK * allowed and taken > HOPELESS * allowed * part)


def _ball(value: Fraction | arb) -> arb:
    return value if isinstance(value, arb) else rationals.ball(value)


def _radius(value: arb) -> float:
    return float(upper(value - value.mid()))
