"""Narrow smooth features of a step: where a function of u(t) peaks or turns, and within which time.

    exp(u)     at a greatest u, width sqrt(2/|u''|); a wall where u rises from far below 0, width WALL/|u'|
    tanh(u)    where u = 0, width 1/|u'|; likewise atan, sinh, cosh
    1/u        at a least |u|, width sqrt(2 |u/u''|); likewise sqrt(u)

u along a step is a smooth function however narrow the feature is: it is taken by interpolation at Chebyshev's points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mbsym.numerics.events.crossings import NODES, Sign, nodes, passages, resolved, series
from mbsym.numerics.events.features import DIP, PEAK, TURN
from mbsym.numerics.methods.interface import Piece

#: A feature whose width is a smaller part of the step than this is narrow; it is followed so many widths to each side
#: by steps of at most one width.
NARROW, BESIDE = 1 / 6, 8.0

#: exp(-SMALL) does nothing, beside numbers of the size of 1 and their rounding; a wall exp(u) is met from there by
#: steps in which u rises by WALL.
SMALL, WALL = 36.0, 4.0

#: A dip of 1/u within a step goes to less than this part of |u| at its ends.
SHALLOW = 0.3

#: A piece is halved so often to resolve a u.
DEPTH = 4

#: Of sums over k of |c_k|, what bounds u - c_0, u' and u''.
_ORDERS = np.arange(NODES, dtype=float)
_BOUNDS = np.array([_ORDERS > 0, _ORDERS**2, _ORDERS**2 * (_ORDERS**2 - 1) / 3])


def met(kinds: Sequence[str], values: Callable[[Any], Any], piece: Piece) -> list[tuple[float, float, int]]:
    """(time, width, place among the kinds) of the features that are narrow for a piece, in their order.

    ``values`` maps points (1 + 2n, m) to the u, of shape (kinds, m).
    """
    if not kinds or not piece.end > piece.start:  # short floats: a step may end where it began
        return []
    found, most = [], NARROW * (piece.end - piece.start)
    whole = along(values, piece, piece.start, piece.end)
    for k, kind in enumerate(kinds):
        for start, end, known in _resolved(k, values, piece, (piece.start, piece.end), whole[k], DEPTH):
            if np.all(np.isfinite(known)) and not _is_plain(kind, series(known), 2.0 * most / (end - start)):
                found += [(time, width, k) for time, width in _places(kind, start, end, known)]
    return sorted(one for one in found if one[1] < most)


def along(values: Callable[[Any], Any], piece: Piece, start: float, end: float) -> Any:
    """The values at Chebyshev's points of a part of a piece, shape (functions, NODES)."""
    times = nodes(start, end)
    return values(np.vstack([times, np.asarray(piece(times), dtype=float)]))


def _resolved(
    k: int, values: Callable[[Any], Any], piece: Piece, span: tuple[float, float], known: Any, depth: int
) -> list[tuple[float, float, Any]]:
    """(start, end, u at the points) of parts in which u is its interpolant."""
    start, end = span
    if depth == 0 or not np.all(np.isfinite(known)) or resolved(series(known)):
        return [(start, end, known)]
    middle = 0.5 * (start + end)
    found = []
    for part in ((start, middle), (middle, end)):
        found += _resolved(k, values, piece, part, along(values, piece, *part)[k], depth - 1)
    return found


def _places(kind: str, start: float, end: float, values: Any) -> list[tuple[float, float]]:
    """(time, width) of what a function of u does narrowly, u given at Chebyshev's points from start to end."""
    polynomial = np.polynomial.chebyshev.Chebyshev(series(values))
    per = 2.0 / (end - start)  # ds/dt
    slope, bend = polynomial.deriv(), polynomial.deriv(2)
    if kind == TURN:
        passed, _, _ = passages(polynomial.coef, Sign(), 1e-14 * float(np.max(np.abs(values))))
        zeros = [one.place for one in passed if one.turn]
        widths = [1.0 / max(abs(float(slope(s))) * per, 1e-300) for s in zeros]
        return [(float(start + 0.5 * (s + 1) * (end - start)), w) for s, w in zip(zeros, widths, strict=True)]
    found = []
    roots = slope.roots() if np.any(slope.coef) else np.empty(0)
    at = np.clip(roots.real[(np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) < 1 + 1e-6)], -1, 1)
    for s in at:
        # A place at an end of the step is compared with the other end.
        u, curvature = float(polynomial(s)), float(bend(s)) * per * per
        time = start + 0.5 * (float(s) + 1) * (end - start)
        if kind == PEAK and curvature < 0 and u > -SMALL and u - max(_others(values, s)) > 1:
            found.append((time, (2.0 / -curvature) ** 0.5))
        if kind == DIP and u * curvature > 0 and abs(u) < SHALLOW * min(map(abs, _others(values, s))):
            found.append((time, (2.0 * u / curvature) ** 0.5))
    if kind == PEAK and not found and values[0] < -SMALL:  # a wall
        passed, _, _ = passages(series(values + SMALL), Sign(), 1e-14)
        for one in passed[:1]:
            if one.turn > 0:
                width = WALL / max(abs(float(slope(one.place))) * per, 1e-300)
                found.append((start + 0.5 * (one.place + 1) * (end - start) + BESIDE * width, width))
    return [(float(time), float(width)) for time, width in found]


def _is_plain(kind: str, coefficients: Any, most: float) -> bool:
    """Whether u(s) = sum_k c_k T_k(s), -1 <= s <= 1, does nothing within a width, in s, of less than ``most``.

    By |T_k| <= 1, |T_k'| <= k^2, |T_k''| <= k^2 (k^2 - 1)/3.  Nearly every step is plain, and these bounds cost a
    hundredth of what the turning points of a polynomial do.
    """
    rest, slope, bend = (float(x) * (1 + 1e-9) for x in _BOUNDS @ np.abs(coefficients))  # and rounding
    middle = float(coefficients[0])
    if kind == PEAK:
        return middle + rest < -SMALL or (bend * most**2 < 2.0 and slope * most < WALL)
    if kind == TURN:
        return abs(middle) > rest or slope * most < 1.0
    least = abs(middle) - rest
    return least > SHALLOW * (abs(middle) + rest) or 2.0 * least > bend * most**2


def harmless(kind: str, found: Any) -> Any:
    """Whether functions of u with the series ``found`` (..., NODES) do nothing narrow for sure, for each series.

    Besides what is far: a peak rises by more than 1 above the ends of a step, |u - c_0| <= sum |c_k|; a turn is narrow
    where |du/ds| > 1/(2 NARROW), and |du/ds| <= sum k^2 |c_k|.
    """
    sizes = np.abs(found[..., 1:])
    middle, most = found[..., 0], np.sum(sizes, axis=-1) * (1 + 1e-9)
    if kind == PEAK:
        return (middle + most < -SMALL) | ((2 * most < 1) & (middle - most > -SMALL))
    if kind == TURN:
        return (np.abs(middle) > most) | (sizes @ np.arange(1, NODES) ** 2 < 0.5 / NARROW)
    return np.abs(middle) - most > SHALLOW * (np.abs(middle) + most)


def _others(values: Any, s: float) -> list[float]:
    """The values at the ends of a step, but at the one where s is."""
    return [float(x) for x, edge in ((values[0], s <= -1 + 1e-6), (values[-1], s >= 1 - 1e-6)) if not edge]
