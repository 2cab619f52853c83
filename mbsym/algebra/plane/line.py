"""The zeros of polynomials in one variable on an interval, and the open intervals between them; exact."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import fmpq

from mbsym.algebra.plane.numbers import (
    Integer,
    Number,
    Rational,
    ascending,
    between_simply,
    compare,
    number,
    primitive,
    roots_between,
    sign,
)
from mbsym.algebra.plane.projection import Polynomial
from mbsym.algebra.terms import univariate


@dataclass(frozen=True)
class Interval:
    """An open interval in which no polynomial vanishes; ``ends`` are zeros by number, None an end of the whole."""

    id: int
    sample: Rational
    signs: tuple[int, ...]
    ends: tuple[int | None, int | None]


@dataclass(frozen=True)
class Zero:
    """A point at which the polynomials ``factors`` vanish; it may be an end of the whole interval."""

    id: int
    number: Number
    factors: tuple[int, ...]


@dataclass(frozen=True)
class Line:
    """What ``decompose_line`` finds on [low, high]."""

    low: Rational
    high: Rational
    factors: tuple[Polynomial, ...]
    intervals: tuple[Interval, ...]
    zeros: tuple[Zero, ...]

    def locate(self, x: Rational) -> Interval | Zero:
        """The zero or interval that x belongs to; an end that is no zero belongs to the interval beside it.

        Raises ValueError outside of the whole interval.
        """
        x = fmpq(x)
        if not self.low <= x <= self.high:
            raise ValueError("a point outside of the interval")
        at = bisect_left(range(len(self.zeros)), 0, key=lambda k: compare(self.zeros[k].number, x))
        if at < len(self.zeros) and compare(self.zeros[at].number, x) == 0:
            return self.zeros[at]
        first = bool(self.zeros) and compare(self.zeros[0].number, self.low) == 0
        return self.intervals[at - first]


def decompose_line(factors: Sequence[Polynomial], low: Rational, high: Rational) -> Line:
    """The zeros of polynomials in one variable on [low, high] and the intervals between them.

    Raises ValueError for a polynomial that is zero, and for an empty interval.
    """
    low, high = fmpq(low), fmpq(high)
    if low >= high:
        raise ValueError("an empty interval")
    through: dict[str, tuple[Integer, list[int]]] = {}
    for at, p in enumerate(factors):
        if p == 0:
            raise ValueError("a polynomial that is identically zero bounds nothing")
        for factor, _ in primitive(univariate(p)).factor()[1]:
            if factor.degree() > 0:
                through.setdefault(str(factor), (factor, []))[1].append(at)
    zeros: list[tuple[Number, tuple[int, ...]]] = []
    for factor, of in through.values():
        ends = [fmpq(x) for x in (low, high) if factor(x) == 0]
        zeros += [(x, tuple(of)) for x in (*ends, *map(number, roots_between(factor, low, high)))]
    return divided(low, high, zeros, factors)


def divided(
    low: Rational, high: Rational, points: Sequence[tuple[Number, tuple[int, ...]]], factors: Sequence[Polynomial] = ()
) -> Line:
    """[low, high] divided at different exact points, each with the numbers of those ``factors`` that vanish there."""
    by = {id(x): of for x, of in points}
    zeros = tuple(Zero(k, x, by[id(x)]) for k, x in enumerate(ascending([x for x, _ in points])))
    marks: list[tuple[Number, int | None]] = [(zero.number, zero.id) for zero in zeros]
    if not zeros or compare(zeros[0].number, low) != 0:
        marks.insert(0, (low, None))
    if not zeros or compare(zeros[-1].number, high) != 0:
        marks.append((high, None))
    intervals: list[Interval] = []
    for (a, first), (b, last) in pairwise(marks):
        sample = between_simply(a, b)
        intervals.append(Interval(len(intervals), sample, tuple(sign(p(sample)) for p in factors), (first, last)))
    return Line(low, high, tuple(factors), tuple(intervals), zeros)
