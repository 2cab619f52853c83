"""A tabulated input: points (x_k, y_k), and a piecewise polynomial through them.

    f(x) = y_k + u (a_k + u (b_k + u c_k)),   u = x - x_k,   x_k <= x <= x_(k+1)

linear: b = c = 0.  cubic: the natural spline, f and f' continuous and f'' = 0 at both ends; its slopes at the points
are the rational numbers to ``SLOPE_DIGITS`` decimals, in units of the largest chord, so that f'' is continuous to as
many (de Boor, A Practical Guide to Splines, 1978, chapter 4).  Outside of the points f holds its first or last value,
or is zero, with a jump where that value is not 0: there it is half of it, as a step is.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from mbsym.expressions.place import Span

#: Between the points, and outside of them.
LINEAR, CUBIC = "linear", "cubic"
HOLD, OUTSIDE_ZERO = "hold", "zero"

SLOPE_DIGITS = 40


@dataclass(frozen=True, slots=True)
class Table:
    """``points`` are (x, y) with increasing x, two or more, exact."""

    name: str
    points: tuple[tuple[Fraction, Fraction], ...]
    between: str = LINEAR
    outside: str = HOLD
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def jumps(self) -> bool:
        """Whether f itself jumps, at an end."""
        return self.outside == OUTSIDE_ZERO and bool(self.points[0][1] or self.points[-1][1])


def pieces(table: Table) -> list[tuple[Fraction, Fraction, Fraction]]:
    """(a_k, b_k, c_k) between each point and the next."""
    chords = [(later[1] - one[1]) / (later[0] - one[0]) for one, later in pairwise(table.points)]
    if table.between == LINEAR:
        return [(chord, Fraction(0), Fraction(0)) for chord in chords]
    lengths = [later[0] - one[0] for one, later in pairwise(table.points)]
    slopes = _natural_slopes(lengths, chords)
    found = []
    for k, (length, chord) in enumerate(zip(lengths, chords, strict=True)):
        first, last = slopes[k], slopes[k + 1]
        found.append((first, (3 * chord - 2 * first - last) / length, (first + last - 2 * chord) / length**2))
    return found


def _natural_slopes(lengths: list[Fraction], chords: list[Fraction]) -> list[Fraction]:
    """m_k with m_(k-1)/h_(k-1) + 2 m_k (1/h_(k-1) + 1/h_k) + m_(k+1)/h_k = 3 (d_(k-1)/h_(k-1) + d_k/h_k), and
    2 m_0 + m_1 = 3 d_0 and likewise at the last point: elimination, rounded as it goes."""
    count = len(chords) + 1
    unit = max(map(abs, chords)) or Fraction(1)
    inverse = [1 / length for length in lengths]
    above, right = [Fraction(0)] * count, [Fraction(0)] * count
    for k in range(count):
        before, after = (inverse[k - 1] if k else Fraction(0)), (inverse[k] if k < count - 1 else Fraction(0))
        wanted = 3 * ((before * chords[k - 1] if k else 0) + (after * chords[k] if k < count - 1 else 0))
        pivot = 2 * (before + after) - (before * above[k - 1] if k else 0)
        above[k] = round(after / pivot, SLOPE_DIGITS)
        right[k] = unit * round((wanted - (before * right[k - 1] if k else 0)) / (pivot * unit), SLOPE_DIGITS)
    slopes = [right[-1]] * count
    for k in range(count - 2, -1, -1):
        slopes[k] = unit * round((right[k] - above[k] * slopes[k + 1]) / unit, SLOPE_DIGITS)
    return slopes
