"""One step of an enclosure: where a set of states is after a while, and everywhere in between.

A set is  {m + A r : r in a box about 0}  with an exact point m and an exact matrix A (Lohner 1987).  After a step h

    x(h; m + A r)  is in  x(h; m) + S A r,     S containing dx(h)/dx0 for every state of the set (mean values),

x(h; m) by its Taylor series with the tail of ``disc``; S by that of the variational equation V' = J V, whose tail is
bounded by  |V_ij,k| <= exp(R B)_ij / R^k,  B_ij >= |J_ij|_R, on a disc of thrice the step.  The new A is orthogonal,
along the longest axes of S A first, so that boxes turn with the motion and are not wrapped again and again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

import numpy as np
from flint import arb, arb_mat

from mbsym.numerics.enclosure.field import Field, cap, upper
from mbsym.numerics.enclosure.model import LARGER, TINY, Model, Ring, model

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
        s = t - self.start
        found = []
        for row, spread in zip(self.coefficients, self.spread, strict=True):
            value = row[-1]
            for coefficient in row[-2::-1]:
                value = value * s + coefficient
            found.append(value + arb(0, spread))
        return found


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
    found = disc(field, now.time, solutions, guess)
    if found is None:
        raise CannotStep(_blurred(solutions))
    longest = arb(found.radius * PART)
    left = end - now.time
    last = bool(left <= longest)
    after = end if last else (now.time + longest).mid()
    step = after - now.time
    terms = max(TERMS_OF_DERIVATIVE, int(bits / float(-(step / found.radius).log() / arb.const_log2())) + 2)
    coefficients = field.solution(now.time, now.centre, terms - 1)
    tail = found.tail(float(step), terms)
    reached = [_horner(row, step) + arb(0, left_out) for row, left_out in zip(coefficients, tail, strict=True)]
    derivative, bound = _derivative(field, now.time, solutions, found, step)
    grown = bound * (_absolute(now.axes) * _absolute(now.box))
    between = tuple(upper(grown[i, 0] + tail[i]) for i in range(field.size))
    later = _carried(after, reached, derivative * now.axes, now.box)
    series = tuple(tuple(value * size for value in row) for row, size in zip(coefficients, field.sizes, strict=True))
    spread = tuple(upper(value) for value in field.whole(between))
    return Segment(now.time, after, series, spread, tuple(field.whole(later.hull))), later, found


def _blurred(coefficients: Sequence[Sequence[arb]]) -> bool:
    """Whether a coefficient is known to no digit, although it is there."""
    return any(not bool(abs(row[-1].rad()) < abs(row[-1].mid())) and row[-1].rad() > 0 for row in coefficients)


def _derivative(
    field: Field, t: arb, solutions: Sequence[Sequence[arb]], found: Disc, step: arb
) -> tuple[arb_mat, arb_mat]:
    """S after the step, and a bound of |dx(s)/dx0| for all s up to it."""
    n, terms = field.size, TERMS_OF_DERIVATIVE
    radius = min(found.radius, WIDER * float(step))
    sizes = arb_mat(n, n, [arb(size) for size in field.jacobian_sizes(t, found.within(radius))])
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


def _carried(time: arb, reached: Sequence[arb], moved: arb_mat, box: arb_mat) -> Bundle:
    """The set  reached + moved * box  in new axes."""
    n = len(reached)
    centre = tuple(value.mid() for value in reached)
    rest = arb_mat(n, 1, [value - middle for value, middle in zip(reached, centre, strict=True)])
    axes = _orthogonal(moved, box)
    turned = axes.solve(moved) * box + axes.solve(rest)
    return Bundle(time, centre, axes, turned)


def _orthogonal(moved: arb_mat, box: arb_mat) -> arb_mat:
    """Nearly orthogonal columns, the first along the longest side of the set; any exact regular matrix would do."""
    n = moved.nrows()
    widths = [upper(box[j, 0]) for j in range(n)]
    largest = max(widths, key=float)
    columns = np.eye(n)
    if largest > 0:
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
        return [(arb(found.rest) * part**terms).abs_upper() for found in self.solutions]

    def within(self, radius: float) -> tuple[Model, ...]:
        """The solutions as models on a smaller disc: of the rests, all of degree d + 1 or more, less is left."""
        ring = Ring(self.solutions[0].ring.degree, radius)
        part = (radius / self.radius) ** (ring.degree + 1) * LARGER
        return tuple(Model(ring, found.poly, found.rest * part + TINY) for found in self.solutions)


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
                    found = zip(coefficients, rests, strict=True)
                    return Disc(radius, tuple(model(ring, row, rest) for row, rest in found))
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
    d, found = ring.degree, []
    for slope in slopes:
        rate = slope if isinstance(slope, Model) else model(ring, [slope])
        missed = float(rate.sizes[-1]) * ring.radius / (d + 1) + rate.rest * ring.radius / (d + 2)
        found.append(missed * LARGER + TINY)
    return found
