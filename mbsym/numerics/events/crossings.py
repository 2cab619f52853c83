"""Where a smooth function of time changes sign within an interval, or touches zero: all places, not the first one.

The function is interpolated at Chebyshev's points of the interval (``NODES`` of them, the ends among them),

    g(s) = sum_k c_k T_k(s),    -1 <= s <= 1,

and has no zero where |c_0| > sum_{k>0} |c_k|.  Elsewhere the zeros of g' (eigenvalues of the colleague matrix; Good,
Quart. J. Math. 12 (1961) 61) cut the interval into parts in which g is monotone: each has one zero or none.

What is guaranteed: no sign change of the interpolant is missed.  The interpolant is g to ``RESOLVED`` of its size where
its last coefficients are that small (``resolved``); where they are not, the caller cuts the interval.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

#: Points of an interval; polynomials of degree NODES - 1 are met exactly.
NODES = 17

#: The last coefficients of a series that is good enough, by the largest value of the function.
RESOLVED, LAST = 1e-9, 3

#: Zeros of g' so far off the real axis are none; those of a pair that is nearly double come with such imaginary parts.
IMAGINARY = 1e-6

#: Steps of the search for a zero in a part where g is monotone.
MOST_STEPS = 100

_PLACES = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
_PLACES[NODES // 2] = 0.0


@cache
def _to_series() -> Any:
    return np.linalg.inv(np.polynomial.chebyshev.chebvander(_PLACES, NODES - 1)).T


@dataclass(frozen=True)
class Passage:
    """g is zero at ``place`` and goes on to positive (``turn`` 1) or negative (-1) values, or turns back (0)."""

    place: float
    turn: int


def nodes(start: float, end: float) -> Any:
    """Chebyshev's points from ``start`` to ``end``, both included."""
    points = 0.5 * (start + end) + 0.5 * (end - start) * _PLACES
    points[0], points[-1] = start, end
    return points


def series(values: Any) -> Any:
    """c_k of the functions whose values at the nodes are given, shape (..., NODES)."""
    return values @ _to_series()


def free_of_zeros(found: Any) -> Any:
    """Whether a series (..., NODES) has no zero for certain, were it the function; its last terms count four times."""
    rest = np.sum(np.abs(found[..., 1:]), axis=-1) + 3 * np.sum(np.abs(found[..., -LAST:]), axis=-1)
    return np.abs(found[..., 0]) > rest


def resolved(found: Any, blur: float = 0.0) -> bool:
    """Whether a series is the function, to ``RESOLVED`` of its size or to ``blur``."""
    return bool(np.sum(np.abs(found[-LAST:])) <= max(RESOLVED * np.sum(np.abs(found)), blur))


@dataclass(frozen=True)
class Sign:
    """The sign of g up to some time: ``last`` is that of its last value outside the blur, 0 where there was none yet.

    ``near`` says whether g has been within the blur since then.
    """

    last: int = 0
    near: bool = False


def passages(found: Any, sign: Sign, blur: float) -> tuple[list[Passage], Sign, float]:
    """What happens in an interval: its passages in order, the sign afterwards, the place nearest to zero near its end.

    A value within ``blur`` has no sign of its own.  So g passes when it has left the blur on the other side, and
    touches zero where it comes back from it; that happened before this interval where the place is -1 and g was near.
    """
    places = np.concatenate(([-1.0], _turning_points(found), [1.0]))
    values = np.polynomial.chebyshev.chebval(places, found)
    signs = np.where(np.abs(values) <= blur, 0, np.sign(values)).astype(int)
    met: list[Passage] = []
    first = 0  # where the stretch begins in which the sign is not known
    for at in range(len(places)):
        if signs[at] == 0:
            sign = Sign(sign.last, True)
            continue
        if sign == Sign():
            pass  # it begins away from zero
        elif sign.last != signs[at]:
            met.append(Passage(_zero(found, places[first : at + 1], values[first : at + 1]), int(signs[at])))
        elif sign.near:
            met.append(Passage(_nearest(places[first : at + 1], values[first : at + 1]), 0))
        sign, first = Sign(int(signs[at]), False), at
    return met, sign, _nearest(places[first:], values[first:])


def _nearest(places: Any, values: Any) -> float:
    """Where g is nearest to zero."""
    return float(places[int(np.argmin(np.abs(values)))])


def _turning_points(found: Any) -> Any:
    """The zeros of g' within the interval, in order."""
    slope = np.polynomial.chebyshev.chebder(found)
    size = np.max(np.abs(slope), initial=0.0)
    significant = np.flatnonzero(np.abs(slope) > 1e-15 * size)
    if not size or significant[-1] < 1 or np.abs(slope[0]) > np.sum(np.abs(slope[1:])):
        return np.empty(0)
    roots = np.polynomial.chebyshev.chebroots(slope[: significant[-1] + 1])
    return np.sort(roots.real[(np.abs(roots.imag) < IMAGINARY) & (np.abs(roots.real) < 1)])


def _zero(found: Any, places: Any, values: Any) -> float:
    """The first sign change of g itself between some places; the end nearest to zero where there is none.

    Bisection and the secant of Illinois (Dowell & Jarratt, BIT 11 (1971) 168).
    """
    for left, right, g_left, g_right in zip(places[:-1], places[1:], values[:-1], values[1:], strict=True):
        if g_left == 0:
            return float(left)
        if g_left * g_right < 0:
            return _illinois(found, (float(left), float(g_left)), (float(right), float(g_right)))
    return _nearest(places, values)


def _illinois(found: Any, left: tuple[float, float], right: tuple[float, float]) -> float:
    """The zero between two places (s, g) with g of opposite signs."""
    (a, ga), (b, gb), side = left, right, 0
    for step in range(MOST_STEPS):
        middle = 0.5 * (a + b) if step % 8 == 7 else (ga * b - gb * a) / (ga - gb)
        if not a < middle < b:
            middle = 0.5 * (a + b)
        if middle in (a, b):
            break
        value = float(np.polynomial.chebyshev.chebval(middle, found))
        if value == 0 or b - a < 1e-16:
            return middle
        if value * gb > 0:
            b, gb, ga, side = middle, value, 0.5 * ga if side > 0 else ga, 1
        else:
            a, ga, gb, side = middle, value, 0.5 * gb if side < 0 else gb, -1
    return a if abs(ga) < abs(gb) else b
