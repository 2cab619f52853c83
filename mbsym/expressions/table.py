"""A tabulated input: points (x_k, y_k), and a piecewise polynomial through them.

    f(x) = y_k + u (a_k + u (b_k + u c_k)),   u = x - x_k,   x_k <= x <= x_(k+1)

linear: b = c = 0.  cubic: the natural spline, f and f' continuous and f'' = 0 at both ends; its slopes at the points
are the rational numbers to ``SLOPE_DIGITS`` decimals, in units of the largest chord, so that f'' is continuous to as
many (de Boor, A Practical Guide to Splines, 1978, chapter 4).  Outside of the points f holds its first or last value;
or is zero, with a jump where that value is not 0, and half of it there, as a step is; or goes on as its first and last
piece do; or is nothing: a motion ends there.

``Curve`` is what algebras compute with, a piecewise polynomial and the number of times it is differentiated; they know
it by its name (``Tabulated``).  Its cost grows with the number of points in memory only.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import factorial, perm
from typing import Any

from mbsym.expressions.place import Span

#: Between the points, and outside of them.
LINEAR, CUBIC = "linear", "cubic"
HOLD, OUTSIDE_ZERO, EXTRAPOLATE, ENDS = "hold", "zero", "extrapolate", "error"

SLOPE_DIGITS = 40

Points = tuple[tuple[Fraction, Fraction], ...]


@dataclass(frozen=True)
class Table:
    """``points`` are (x, y) with increasing x, two or more, exact; ``source`` is the file that they are from."""

    name: str
    points: Points
    between: str = LINEAR
    outside: str = HOLD
    span: Span | None = field(default=None, compare=False, repr=False)
    source: Source | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return Table, (self.name, self.points, self.between, self.outside, self.span, self.source)

    def __hash__(self) -> int:
        return hash((self.name, len(self.points), self.points[0], self.points[-1], self.between, self.outside))

    @property
    def jumps(self) -> bool:
        """Whether f itself jumps, at an end."""
        return self.outside == OUTSIDE_ZERO and bool(self.points[0][1] or self.points[-1][1])

    @property
    def held(self) -> str:
        """What formulas call ``curve`` where f jumps: it keeps the end values that f has not outside."""
        return f"{self.name}_held"

    @property
    def smooth(self) -> bool:
        """Whether f'' is continuous wherever there is f: a motion may follow it, its acceleration has no jump."""
        return self.between == CUBIC and self.outside in (EXTRAPOLATE, ENDS)

    @cached_property
    def curve(self) -> Curve:
        """f between the points, and outside as far as it does not jump there."""
        return Curve(self)

    @cached_property
    def called(self) -> Tabulated:
        """The name of ``curve`` in algebras."""
        return Tabulated(self.curve)


@dataclass(frozen=True)
class Source:
    """The file of the points, relative to the description, and its columns of x and y as they were named."""

    file: str
    columns: tuple[str, str] = ("1", "2")
    digest: str = field(default="", compare=False)


class Curve:
    """The ``order``-th derivative of a table's f as polynomials of u = x - base, for each of the n + 1 pieces

        (-oo, x_0], [x_0, x_1], ..., [x_(n-1), oo)        n points, bases x_0, x_0, x_1, ..., x_(n-1)

    At a knot where two pieces do not meet it is their mean, as the sign of 0 is 0.
    """

    def __init__(self, table: Table, order: int = 0) -> None:
        self.table, self.order = table, order
        self.knots: tuple[Fraction, ...] = tuple(x for x, _ in table.points)
        self.bases = (self.knots[0], *self.knots)

    @cached_property
    def polynomials(self) -> tuple[tuple[Fraction, ...], ...]:
        """Coefficients by rising powers, of every piece, as many for each."""
        if self.order:
            whole = self.table.curve.polynomials
            return tuple(
                tuple(c * perm(k, self.order) for k, c in enumerate(coefficients) if k >= self.order) or (Fraction(0),)
                for coefficients in whole
            )
        degree = 1 if self.table.between == LINEAR else 3
        inner = [
            (y, *polynomial[:degree]) for (_, y), polynomial in zip(self.table.points, pieces(self.table), strict=False)
        ]
        flat = (Fraction(0),) * degree
        first, last = (self.table.points[0][1], *flat), (self.table.points[-1][1], *flat)
        if self.table.outside in (EXTRAPOLATE, ENDS):
            first, last = inner[0], _moved(inner[-1], self.knots[-1] - self.knots[-2])
        return (first, *inner, last)

    @property
    def smoothness(self) -> int:
        """So many derivatives of this one are continuous; -1 where it jumps itself, off which it has all of them."""
        whole = 0 if self.table.between == LINEAR or self.table.outside in (HOLD, OUTSIDE_ZERO) else 2
        return max(whole - self.order, -1)

    @cached_property
    def polynomial(self) -> tuple[Fraction, ...] | None:
        """The polynomial of u = x - x_0 that all pieces are, if they are one and nothing ends."""
        first = self.polynomials[0]
        if self.bounded and self.order == 0:
            return None
        if self.order == 0 and self.table.between == LINEAR and self.table.outside in (HOLD, OUTSIDE_ZERO):
            return first if all(y == self.table.points[0][1] for _, y in self.table.points) else None
        same = all(
            _moved(first, base - self.bases[0]) == own for base, own in zip(self.bases, self.polynomials, strict=True)
        )
        return first if same else None

    @property
    def constant(self) -> Fraction | None:
        """The number that it is everywhere, if it is one."""
        coefficients = self.polynomial
        return None if coefficients is None or any(coefficients[1:]) else coefficients[0]

    @cached_property
    def derivative(self) -> Curve:
        """The slope, off the knots where it jumps."""
        return Curve(self.table, self.order + 1)

    @cached_property
    def bounded(self) -> bool:
        """Whether a motion ends where x leaves the points."""
        return self.table.outside == ENDS

    def pieces_at(self, x: Fraction) -> tuple[int, ...]:
        """The pieces that hold x: one, or two at a knot."""
        left, right = bisect_left(self.knots, x), bisect_right(self.knots, x)
        return (left,) if left == right else (left, right)

    def on(self, piece: int, x: Any) -> Any:
        """The polynomial of a piece, by Horner's scheme over numbers that have arithmetic with fractions."""
        u, total = x - self.bases[piece], Fraction(0)
        for coefficient in reversed(self.polynomials[piece]):
            total = total * u + coefficient
        return total

    def __call__(self, x: Fraction) -> Fraction:
        """The exact value."""
        values = [self.on(piece, x) for piece in self.pieces_at(x)]
        return Fraction(sum(values)) / len(values)

    def kinked_at(self, x: Fraction) -> bool:
        """Whether a derivative of this one, of any order, jumps at x: it has no series there."""
        around = self.pieces_at(x)
        if len(around) == 1:
            return False
        (a, b), (polynomial, other) = around, (self.polynomials[k] for k in around)
        return _moved(polynomial, self.bases[b] - self.bases[a]) != other


class Tabulated(str):
    """The name by which algebras and programs know a curve, ``table push'``; the curve is with it.

    No function has a blank in its name, and no two tables of a system have one name.
    """

    curve: Curve

    def __new__(cls, curve: Curve) -> Tabulated:
        tabulated = super().__new__(cls, f"table {curve.table.name}{chr(39) * curve.order}")
        tabulated.curve = curve
        return tabulated

    def __reduce__(self) -> tuple[Any, ...]:
        return curve_name, (self.curve.table, self.curve.order)

    @property
    def table(self) -> Table:
        return self.curve.table

    @property
    def written(self) -> str:
        """What formulas call the curve, primes of derivatives apart."""
        return self.table.held if self.table.jumps and not self.curve.order else self.table.name

    @property
    def slope(self) -> Tabulated:
        """The name of the derivative."""
        return Tabulated(self.curve.derivative)


def curve_name(table: Table, order: int = 0) -> Tabulated:
    """The name in algebras of a derivative of what a table is."""
    tabulated = table.called
    for _ in range(order):
        tabulated = tabulated.slope
    return tabulated


def _moved(polynomial: tuple[Fraction, ...], by: Fraction) -> tuple[Fraction, ...]:
    """The coefficients of p(u + by)."""
    degree = len(polynomial)
    return tuple(
        sum((c * perm(j, k) / factorial(k) * by ** (j - k) for j, c in enumerate(polynomial) if j >= k), Fraction(0))
        for k in range(degree)
    )


def pieces(table: Table) -> list[tuple[Fraction, Fraction, Fraction]]:
    """(a_k, b_k, c_k) between each point and the next."""
    chords = [(later[1] - earlier[1]) / (later[0] - earlier[0]) for earlier, later in pairwise(table.points)]
    if table.between == LINEAR:
        return [(chord, Fraction(0), Fraction(0)) for chord in chords]
    lengths = [later[0] - earlier[0] for earlier, later in pairwise(table.points)]
    slopes = _natural_slopes(lengths, chords)
    coefficients = []
    for k, (length, chord) in enumerate(zip(lengths, chords, strict=True)):
        first, last = slopes[k], slopes[k + 1]
        coefficients.append((first, (3 * chord - 2 * first - last) / length, (first + last - 2 * chord) / length**2))
    return coefficients


def _natural_slopes(lengths: list[Fraction], chords: list[Fraction]) -> list[Fraction]:
    """m_k with m_(k-1)/h_(k-1) + 2 m_k (1/h_(k-1) + 1/h_k) + m_(k+1)/h_k = 3 (d_(k-1)/h_(k-1) + d_k/h_k), and
    2 m_0 + m_1 = 3 d_0 and likewise at the last point: elimination, rounded as it goes."""
    count = len(chords) + 1
    unit = max(map(abs, chords)) or Fraction(1)
    inverse = [1 / length for length in lengths]
    above, right = [Fraction(0)] * count, [Fraction(0)] * count
    for k in range(count):
        before, after = (inverse[k - 1] if k else Fraction(0)), (inverse[k] if k < count - 1 else Fraction(0))
        right_side = 3 * ((before * chords[k - 1] if k else 0) + (after * chords[k] if k < count - 1 else 0))
        pivot = 2 * (before + after) - (before * above[k - 1] if k else 0)
        above[k] = round(after / pivot, SLOPE_DIGITS)
        right[k] = unit * round((right_side - (before * right[k - 1] if k else 0)) / (pivot * unit), SLOPE_DIGITS)
    slopes = [right[-1]] * count
    for k in range(count - 2, -1, -1):
        slopes[k] = unit * round((right[k] - above[k] * slopes[k + 1]) / unit, SLOPE_DIGITS)
    return slopes
