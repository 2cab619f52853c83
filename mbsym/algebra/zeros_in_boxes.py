"""Zeros of a factor in several angles and coordinates: balls over boxes, changes of sign, critical points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Any

from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_systems import Limits, context, solve
from mbsym.algebra.ring import Polynomial

if TYPE_CHECKING:
    from mbsym.algebra.zero_sets import HalfAngles


class Several:
    """A factor in several variables: boxes, signs, critical points."""

    def __init__(
        self,
        half: HalfAngles,
        factor: Polynomial,
        plain: Polynomial,
        names: tuple[str, ...],
        ranges: Mapping[str, Fraction],
    ) -> None:
        self.half, self.factor, self.plain, self.names = half, factor, plain, names
        self.terms = [([int(x) for x in m], arb(c)) for m, c in factor.terms()]
        # Half angles from -1/2 to 1/2 turns cover the projective line; coordinates from -range to range.
        self.box = [
            (Fraction(0), Fraction(1, 2)) if name in half.angles else (Fraction(0), ranges.get(name, Fraction(10)))
            for name in names
        ]

    def value(self, point: Sequence[tuple[Fraction, Fraction]]) -> Any:
        """A ball over the box of midpoints and radii."""
        letters: dict[int, Any] = {}
        for name, (middle, radius) in zip(self.names, point, strict=True):
            ball = rationals.ball(middle)
            if radius:
                ball = ball + arb(0, rationals.ball(radius).upper())
            if name in self.half.angles:
                sine, cosine = (ball * arb.pi()).sin_cos()
                letters[self.half.place[name]], letters[self.half.place[name] + 1] = sine, cosine
            else:
                letters[self.half.place[name]] = ball
        total = arb(0)
        for monomial, coefficient in self.terms:
            term = coefficient
            for place, x in letters.items():
                if monomial[place]:
                    term *= x ** monomial[place]
            total += term
        return total

    def found(self) -> ZeroSet | None:
        with ctx.workprec(BITS):
            pending: list[Any] = [tuple(self.box)]
            signs: dict[bool, Any] = {}
            for _ in range(MOST_BOXES):
                if not pending:
                    return None
                box = pending.pop(0)
                if not self.value(box).contains(0):
                    continue
                middle = tuple((m, Fraction(0)) for m, _ in box)
                there = self.value(middle)
                if not there.contains(0):
                    signs.setdefault(bool(there > 0), middle)
                if len(signs) == 2:
                    return ZeroSet(self.plain, self.names, SIGNS, (), (self._between(signs[True], signs[False]),))
                pending += self._halves(box)
        return self._critical()

    def _halves(self, box: Sequence[tuple[Fraction, Fraction]]) -> list[Any]:
        """The box cut across its longest side."""
        widths = [radius / whole for (_, radius), (_, whole) in zip(box, self.box, strict=True)]
        k = widths.index(max(widths))
        middle, radius = box[k][0], box[k][1] / 2
        return [(*box[:k], (middle + sign * radius, radius), *box[k + 1 :]) for sign in (-1, 1)]

    def _between(self, above: Any, below: Any) -> dict[str, Any]:
        """A zero on the segment between points of opposite sign, by bisection: within 2^-200 of it."""
        with ctx.workprec(PRECISION):
            for _ in range(220):
                middle = tuple(((a + b) / 2, Fraction(0)) for (a, _), (b, _) in zip(above, below, strict=True))
                there = self.value(middle)
                if there.contains(0):
                    break
                if there > 0:
                    above = middle
                else:
                    below = middle
            return self._values([(a + b) / 2 for (a, _), (b, _) in zip(above, below, strict=True)])

    def _values(self, point: Sequence[Fraction]) -> dict[str, Any]:
        found = {}
        for name, x in zip(self.names, point, strict=True):
            ball = rationals.ball(x)
            found[name] = 2 * arb.pi() * self.half.angles[name] * ball if name in self.half.angles else ball
        return found

    def _critical(self) -> ZeroSet | None:
        """Where a factor that changes no sign touches 0: its gradient vanishes there, too.

        Chart by chart: each angle by S = t, C = 1, or S = 1, C = t.
        """
        points: list[Mapping[str, Any]] = []
        isolated = True
        angles = [name for name in self.names if name in self.half.angles]
        for chart in product((0, 1), repeat=len(angles)):
            where = context([f"x{k}" for k in range(len(self.names))])
            flat = self._flat(where, dict(zip(angles, chart, strict=True)))
            equations = [flat, *(flat.derivative(k) for k in range(len(self.names)))]
            try:
                solved = solve([e for e in equations if not e.is_zero()], limits=CRITICAL)
            except (NoClosedForm, ArithmeticError, ValueError):
                return ZeroSet(self.plain, self.names, UNDECIDED)
            if solved.unfinished:
                return ZeroSet(self.plain, self.names, UNDECIDED)
            isolated = isolated and not solved.families
            for point in (*solved.points, *(family.sample for family in solved.families)):
                points.append(self._placed(point.enclosures(PRECISION), dict(zip(angles, chart, strict=True))))
        distinct = _distinct(points)
        return ZeroSet(self.plain, self.names, EXACT, (), tuple(distinct), isolated) if distinct else None

    def _flat(self, where: Any, chart: Mapping[str, int]) -> Polynomial:
        bottom = 1
        for coefficient in self.factor.coeffs():
            bottom = bottom * int(coefficient.q) // _gcd(bottom, int(coefficient.q))
        terms: dict[tuple[int, ...], int] = {}
        for monomial, coefficient in self.factor.terms():
            powers = tuple(int(monomial[self.half.place[name] + chart.get(name, 0)]) for name in self.names)
            whole = coefficient * bottom
            terms[powers] = terms.get(powers, 0) + int(whole.p)
        return where.from_dict(terms)

    def _placed(self, balls: Sequence[Any], chart: Mapping[str, int]) -> dict[str, Any]:
        found = {}
        with ctx.workprec(PRECISION):
            for name, ball in zip(self.names, balls, strict=True):
                if name in chart:
                    half = ball.atan() if chart[name] == 0 else arb.pi() / 2 - ball.atan()
                    if half.mid() > (arb.pi() / 2).mid():
                        half = half - arb.pi()
                    ball = 2 * self.half.angles[name] * half
                found[name] = ball
        return found


def _gcd(a: int, b: int) -> int:
    while b:
        a, b = b, a % b
    return a


def _distinct(points: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Points that are told apart by their balls; one that two charts show is taken once."""
    kept: list[Mapping[str, Any]] = []
    for point in points:
        if not any(all(point[name].overlaps(other[name]) for name in point) for other in kept):
            kept.append(point)
    return kept


# What is known of the zeros of a polynomial: sets, values, and how each is known.


#: How a set is known: its zeros isolated exactly, or in number fields; a change of sign proved by balls; a search.
EXACT, SIGNS, UNDECIDED = "exact", "signs", "undecided"

#: Boxes that are looked at for one factor, and bits at which that is done.
MOST_BOXES, BITS = 6_000, 96

#: Zeros are known to so many bits.
PRECISION = 320

#: A factor in half angles is not formed beyond so many terms.
MOST_TERMS = 3_000

#: Critical points are sought with so much work.
CRITICAL = Limits(branches=60, elements=40, terms=200, solutions=40, work=400_000)


@dataclass(frozen=True)
class Zero:
    """A value of a variable: ``turns`` * pi where it is that exactly, else None; ``ball`` encloses it."""

    ball: Any
    turns: Fraction | None = None
    rational: Fraction | None = None


@dataclass(frozen=True)
class ZeroSet:
    """Where one irreducible ``factor`` vanishes.

    ``names`` are what it depends on.  With one name ``zeros`` lists all its values, an angle's in one period.  With
    several names ``point`` is a point of the set (exact, or proved to lie near a zero by signs), None where the search
    was undecided; ``nearest`` is then the point where the factor was smallest.  ``isolated``: the point is one of
    finitely many ``points``.
    """

    factor: Polynomial
    names: tuple[str, ...]
    known: str
    zeros: tuple[Zero, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()
    isolated: bool = False


@dataclass(frozen=True)
class Zeros:
    """All ``sets``; ``nowhere`` are the factors proved to have no zero; coordinates beyond ``range`` of several-name
    factors were not looked at (None: nothing depends on that)."""

    sets: tuple[ZeroSet, ...]
    nowhere: tuple[Polynomial, ...]
    bounded: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no others (coordinates within their ranges)."""
        return all(one.known != UNDECIDED for one in self.sets)
