"""From polynomials in x and y to the curves they are made of, and the abscissas at which the picture can change.

The input is factored: a factor in x alone is a vertical line, any other a curve f(x, y) = 0 with f irreducible.
Between two neighbouring roots of

    disc_y(f),   lc_y(f),   res_y(f, g),   f(x, y0),   f(x, y1),   vertical factors   (f, g: all curves; y0, y1: edges)

the roots of the curves in y are simple, distinct, as many as before, and within the box or without it (delineability,
Collins 1975).  These polynomials in x are factored in turn; their roots are real algebraic numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

from flint import fmpq, fmpq_poly

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane import numbers
from mbsym.algebra.terms import coefficients_in, univariate

Polynomial = Any  # a flint.fmpq_mpoly in two generators


@dataclass(frozen=True)
class Box:
    """x0 <= x <= x1, y0 <= y <= y1.  Raises ValueError where it is empty."""

    x0: numbers.Rational
    x1: numbers.Rational
    y0: numbers.Rational
    y1: numbers.Rational

    def __post_init__(self) -> None:
        for name in ("x0", "x1", "y0", "y1"):
            object.__setattr__(self, name, fmpq(getattr(self, name)))
        if not (self.x0 < self.x1 and self.y0 < self.y1):
            raise ValueError("an empty box")

    def __contains__(self, point: tuple[numbers.Rational, numbers.Rational]) -> bool:
        return bool(self.x0 <= point[0] <= self.x1 and self.y0 <= point[1] <= self.y1)

    @property
    def area(self) -> numbers.Rational:
        return (self.x1 - self.x0) * (self.y1 - self.y0)


@dataclass(frozen=True)
class Budget:
    """Bounds of the work: degree of a discriminant or resultant (bounded beforehand), abscissas, cells of stacks."""

    degree: int = 600
    abscissas: int = 3_000
    cells: int = 60_000


def nothing(_: str, done: int, whole: int) -> None:
    """Tells nobody how far the work is."""


Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Curve:
    """An irreducible polynomial in which y occurs; ``of`` are the positions of the given factors that it divides."""

    polynomial: Polynomial
    of: tuple[int, ...]

    @cached_property
    def in_y(self) -> tuple[numbers.Univariate, ...]:
        """The coefficients of 1, y, y^2, ... as polynomials in x."""
        return coefficients(self.polynomial, 1)

    @cached_property
    def slope(self) -> Polynomial:
        """The derivative by x."""
        return self.polynomial.derivative(0)

    @property
    def degree(self) -> int:
        return len(self.in_y) - 1

    def over(self, x: numbers.Rational) -> numbers.Univariate:
        """f(x, .)"""
        return fmpq_poly([c(x) for c in self.in_y])

    def along(self, y: numbers.Rational) -> numbers.Univariate:
        """f(., y)"""
        total = fmpq_poly([0])
        for c in reversed(self.in_y):
            total = total * y + c
        return total


@dataclass(frozen=True)
class Vertical:
    """An irreducible polynomial in x alone."""

    polynomial: numbers.Integer
    of: tuple[int, ...]


#: In place of the order of a zero: that of a leading coefficient.
LEADING = 1 << 20


@dataclass(frozen=True)
class Abscissa:
    """A critical value of x and what makes it one.

    ``degenerate``: curves whose discriminant vanishes there, with the order of that zero, or whose leading coefficient
    does (``LEADING``); ``meeting``: pairs of curves with the order of the zero of their resultant; ``vertical``: given
    factors that vanish on the whole line.
    """

    x: numbers.Number
    degenerate: Mapping[int, int]
    meeting: Mapping[frozenset[int], int]
    vertical: tuple[int, ...]

    @property
    def rational(self) -> bool:
        return isinstance(self.x, fmpq)


def coefficients(p: Polynomial, generator: int) -> tuple[numbers.Univariate, ...]:
    """Of 1, g, g^2, ... for a polynomial in two generators, as polynomials in the other one."""
    return tuple(univariate(c, 1 - generator) for c in coefficients_in(p, generator))


def parts(factors: Sequence[Polynomial]) -> tuple[tuple[Curve, ...], tuple[Vertical, ...]]:
    """The different irreducible factors of all polynomials.  Raises ValueError for a polynomial that is zero."""
    irreducible: dict[str, tuple[Polynomial, list[int]]] = {}
    for at, p in enumerate(factors):
        if p == 0:
            raise ValueError("a polynomial that is identically zero bounds nothing")
        for factor, _ in irreducible_factors(p)[1]:
            if not factor.is_constant():
                _, of = irreducible.setdefault(str(factor), (factor, []))
                of.append(at)
    curves, verticals = [], []
    for factor, of in irreducible.values():
        if factor.degrees()[1]:
            curves.append(Curve(factor, tuple(of)))
        else:
            verticals.append(Vertical(numbers.primitive(coefficients(factor, 1)[0]), tuple(of)))
    return tuple(curves), tuple(verticals)


def abscissas(
    curves: Sequence[Curve], verticals: Sequence[Vertical], box: Box, budget: Budget, progress: Progress = nothing
) -> list[Abscissa]:
    """The critical abscissas within the box, ascending, its edges included.

    Raises TooLargeError where a resultant's degree or the number of abscissas exceeds the budget.
    """
    _affordable(curves, budget)
    table = _Table(box)
    for vertical in verticals:
        table.add(fmpq_poly(vertical.polynomial), vertical=vertical.of)
    pairs = list(combinations(range(len(curves)), 2))
    whole = len(curves) + len(pairs)
    for k, curve in enumerate(curves):
        progress("projection", k, whole)
        table.add(curve.in_y[-1], degenerate=k, order=LEADING)
        if curve.degree > 1:
            table.add(_in_x(curve.polynomial.discriminant(1)), degenerate=k)
        for y in (box.y0, box.y1):
            along = curve.along(y)
            if along != 0:  # else the edge itself
                table.add(along)
    for at, (j, k) in enumerate(pairs):
        progress("projection", len(curves) + at, whole)
        table.add(_in_x(curves[j].polynomial.resultant(curves[k].polynomial, 1)), meeting=(j, k))
    progress("projection", whole, whole)
    critical = table.abscissas()
    if len(critical) > budget.abscissas:
        raise TooLargeError(
            "[[count]] abscissas at which the picture may change", count=len(critical), limit=Limit.WORK
        )
    return critical


def _affordable(curves: Sequence[Curve], budget: Budget) -> None:
    """Refuses resultants whose degree, bounded by those of the curves, is too large."""
    worst = 0
    for j, a in enumerate(curves):
        ax = int(a.polynomial.degrees()[0])
        worst = max(worst, 2 * ax * (a.degree - 1))
        for b in curves[j + 1 :]:
            worst = max(worst, ax * b.degree + int(b.polynomial.degrees()[0]) * a.degree)
    if worst > budget.degree:
        raise TooLargeError(
            "a resultant of degree up to [[worst]], more than [[most]]",
            worst=worst,
            most=budget.degree,
            limit=Limit.DEGREE,
        )


def _in_x(p: Polynomial) -> numbers.Univariate:
    return coefficients(p, 1)[0] if p != 0 else fmpq_poly([0])


class _Table:
    """Irreducible polynomials in x with what their roots are critical for."""

    def __init__(self, box: Box) -> None:
        self.box = box
        self.rows: dict[str, tuple[numbers.Integer, dict[int, int], dict[frozenset[int], int], set[int]]] = {}

    def add(
        self,
        p: numbers.Univariate,
        degenerate: int | None = None,
        meeting: tuple[int, int] | None = None,
        vertical: Sequence[int] = (),
        order: int = 1,
    ) -> None:
        """The irreducible factors of p, which is not zero; an exponent counts ``order`` times."""
        for factor, exponent in numbers.primitive(p).factor()[1]:
            if factor.degree() < 1:
                continue
            row = self.rows.setdefault(str(factor), (factor, {}, {}, set()))
            if degenerate is not None:
                row[1][degenerate] = row[1].get(degenerate, 0) + int(exponent) * order
            if meeting is not None:
                row[2][frozenset(meeting)] = int(exponent)
            row[3].update(vertical)

    def abscissas(self) -> list[Abscissa]:
        """The roots in the box, and its edges."""
        box = self.box
        entries: list[tuple[numbers.Number, Abscissa]] = []
        edges = [box.x0, box.x1]
        for factor, degenerate, meeting, vertical in self.rows.values():
            about = (degenerate, meeting, tuple(sorted(vertical)))
            if factor.degree() == 1:
                value = fmpq(-factor[0], factor[1])
                if value in edges:
                    edges.remove(value)
                if box.x0 <= value <= box.x1:
                    entries.append((value, Abscissa(value, *about)))
                continue
            for root in numbers.roots_between(factor, box.x0, box.x1):
                x = numbers.number(root)
                entries.append((x, Abscissa(x, *about)))
        entries += [(x, Abscissa(x, {}, {}, ())) for x in edges]
        by = {id(x): abscissa for x, abscissa in entries}
        return [by[id(x)] for x in numbers.ascending([x for x, _ in entries])]
