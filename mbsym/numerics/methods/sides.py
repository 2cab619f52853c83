"""On which side of its switches, and on which piece of its tables, a motion goes on.

    a sign or modulus of g   side -1 or 1; 0 where both sides lead back to g = 0 and the motion stays there
    a table at x             piece 1, ..., n + 1 between its n knots, and outside; the next one follows on each

Tables of the time alone have their knots where the clock says: nobody has to look for them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

import numpy as np

from mbsym.algebra.lookup import numbers_of
from mbsym.expressions.message import Message, joined
from mbsym.expressions.table import Curve
from mbsym.numerics.dynamics import Dynamics, Frozen
from mbsym.numerics.events.crossings import NODES, Sign, free_of_zeros, nodes, passages, resolved, series
from mbsym.numerics.events.features import DIP, PEAK, SLIDING, TURN
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import MOST_KEPT, Breakdown, Passed, Piece, compiled_kernel, once
from mbsym.numerics.methods.magnitudes import about

# Narrow smooth features of a step: where a function of u(t) peaks or turns, and within which time.
#
#     exp(u)     at a greatest u, width sqrt(2/|u''|); a wall where u rises from far below 0, width WALL/|u'|
#     tanh(u)    where u = 0, width 1/|u'|; likewise atan, sinh, cosh
#     1/u        at a least |u|, width sqrt(2 |u/u''|); likewise sqrt(u)
#
# u along a step is a smooth function however narrow the feature is: it is taken by interpolation at Chebyshev's points.


#: A feature whose width is a smaller part of the step than this is narrow; it is followed so many widths to each side
#: by steps of at most one width.
NARROW, BESIDE = 1 / 6, 8.0

#: exp(-SMALL) does nothing, beside numbers of the size of 1 and their rounding; a wall exp(u) is met from there by
#: steps in which u rises by WALL.
SMALL, WALL = 36.0, 4.0

#: A dip of 1/u within a step goes to less than this part of |u| at its ends.
SHALLOW = 0.3

#: A piece is halved so often to resolve a u.
HALVINGS = 4

#: Of sums over k of |c_k|, what bounds u - c_0, u' and u''.
_ORDERS = np.arange(NODES, dtype=float)
_BOUNDS = np.array([_ORDERS > 0, _ORDERS**2, _ORDERS**2 * (_ORDERS**2 - 1) / 3])


def met(kinds: Sequence[str], values: Callable[[Any], Any], piece: Piece) -> list[tuple[float, float, int]]:
    """(time, width, place among the kinds) of the features that are narrow for a piece, in their order.

    ``values`` maps points (1 + 2n, m) to the u, of shape (kinds, m).
    """
    if not kinds or not piece.end > piece.start:  # short floats: a step may end where it began
        return []
    narrow, most = [], NARROW * (piece.end - piece.start)
    whole = along(values, piece, piece.start, piece.end)
    for k, kind in enumerate(kinds):
        for start, end, known in _resolved(k, values, piece, (piece.start, piece.end), whole[k], HALVINGS):
            if np.all(np.isfinite(known)) and not _is_plain(kind, series(known), 2.0 * most / (end - start)):
                narrow += [(time, width, k) for time, width in _places(kind, start, end, known)]
    return sorted(feature for feature in narrow if feature[1] < most)


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
    parts = []
    for part in ((start, middle), (middle, end)):
        parts += _resolved(k, values, piece, part, along(values, piece, *part)[k], depth - 1)
    return parts


def _places(kind: str, start: float, end: float, values: Any) -> list[tuple[float, float]]:
    """(time, width) of what a function of u does narrowly, u given at Chebyshev's points from start to end."""
    polynomial = np.polynomial.chebyshev.Chebyshev(series(values))
    per = 2.0 / (end - start)  # ds/dt
    slope, bend = polynomial.deriv(), polynomial.deriv(2)
    if kind == TURN:
        passed, _, _ = passages(polynomial.coef, Sign(), 1e-14 * float(np.max(np.abs(values))))
        zeros = [crossing.place for crossing in passed if crossing.turn]
        widths = [1.0 / max(abs(float(slope(s))) * per, 1e-300) for s in zeros]
        return [(float(start + 0.5 * (s + 1) * (end - start)), w) for s, w in zip(zeros, widths, strict=True)]
    narrow = []
    roots = slope.roots() if np.any(slope.coef) else np.empty(0)
    at = np.clip(roots.real[(np.abs(roots.imag) < 1e-6) & (np.abs(roots.real) < 1 + 1e-6)], -1, 1)
    for s in at:
        # A place at an end of the step is compared with the other end.
        u, curvature = float(polynomial(s)), float(bend(s)) * per * per
        time = start + 0.5 * (float(s) + 1) * (end - start)
        if kind == PEAK and curvature < 0 and u > -SMALL and u - max(_others(values, s)) > 1:
            narrow.append((time, (2.0 / -curvature) ** 0.5))
        if kind == DIP and u * curvature > 0 and abs(u) < SHALLOW * min(map(abs, _others(values, s))):
            narrow.append((time, (2.0 * u / curvature) ** 0.5))
    if kind == PEAK and not narrow and values[0] < -SMALL:  # a wall
        passed, _, _ = passages(series(values + SMALL), Sign(), 1e-14)
        for passage in passed[:1]:
            if passage.turn > 0:
                width = WALL / max(abs(float(slope(passage.place))) * per, 1e-300)
                narrow.append((start + 0.5 * (passage.place + 1) * (end - start) + BESIDE * width, width))
    return [(float(time), float(width)) for time, width in narrow]


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


#: Why a run cannot go on at a switch, and beyond the points of a table.
SWITCHING = "switching without end"
OUTSIDE = "outside of a table"

#: Values of g below this part of its size are 0: they are what roundings leave of a step that ends at g = 0.
BLUR = 1e-13

#: Switches so close to each other, relative to the time, that nothing moves between them.
TOGETHER = 1e-12

#: A g that has moved by less, in a short step from a switch, stands still.
STANDS = 4e-15


class Sides:
    """The switches of a dynamics; ``count`` of them, one side each.

    ``sizes`` are those of their g in this scene and ``time`` is its time, so that units do not count (``measure``).
    """

    def __init__(self, dynamics: Dynamics) -> None:
        self._dynamics, features = dynamics, dynamics.features
        self.curves: tuple[Curve | None, ...] = features.curves
        self.count = len(self.curves)
        self._knots = [None if curve is None else numbers_of(curve, np.float64)[0] for curve in self.curves]
        program, outputs = features.switches.program, features.switches.outputs
        clock = [program.instructions[node.number].payload == "t" for node in outputs]
        self.by_clock = tuple(k for k, knots in enumerate(self._knots) if clock[k] and knots is not None)
        self.looked_for = tuple(k for k in range(self.count) if k not in self.by_clock)
        self.values = feature_kernel(dynamics, "switches")
        self.sizes, self.time = np.ones(self.count), 1.0

    def measure(self, time: float, state: Any) -> None:
        """Finds by how much each g changes where one component of a state, or the time, does by its own size."""
        if not self.count:
            return
        state = np.asarray(state, dtype=float)
        values = self.at(time, state)
        sides = tuple(self._piece(k, float(v)) or (1 if v >= 0 else -1) for k, v in enumerate(values))
        scene = about(self._dynamics.on_sides(sides), time, state)
        self.time = float(scene.times[0])
        steps = np.diag(np.append(self.time, scene.sizes[:, 0]))
        point = np.append(time, state)[:, None]
        changes = np.abs(self.values(np.hstack([point + steps, point - steps])) - values[:, None])
        largest = np.max(np.where(np.isfinite(changes), changes, 0.0), axis=1, initial=0.0)
        self.sizes = np.where(largest > 0, largest, 1.0)

    def sizes_on(self, sides: tuple[int, ...]) -> Any:
        """The sizes of what is positive on these sides, shape (count,): that of g, of what holds a sliding one 1."""
        return np.where(np.array(sides) == SLIDING, 1.0, self.sizes)

    def at(self, time: float, state: Any) -> Any:
        """All g and x in a state."""
        return self.values(np.concatenate(([float(time)], np.asarray(state, dtype=float))))

    def together(self, time: float) -> float:
        """Switches so close to each other at a time are at once."""
        return TOGETHER * max(self.time, abs(float(time)))

    def next_knot(self, sides: tuple[int, ...]) -> float:
        """When the first table of the time comes to its next knot."""
        return min((self._ends(k, sides[k])[1] for k in self.by_clock), default=inf)

    def reached(self, time: float, sides: tuple[int, ...]) -> tuple[int, ...]:
        """The tables of the time that have come to their next knot."""
        return tuple(k for k in self.by_clock if self._ends(k, sides[k])[1] <= time)

    def leaving(self, points: Any, sides: tuple[int, ...]) -> Any:
        """For every switch what is positive on its side, shape (count, m): g s, of a sliding one 1 - s^2,

        (x - a)(b - x)/(b - a)   of a table between two knots, x_0 - x and x - x_n outside; 1 for the time's.
        """
        values = np.array(self.values(points))
        for k, side in enumerate(sides):
            if self._knots[k] is None:
                values[k] *= side
                continue
            below, above = self._ends(k, side)
            if k in self.by_clock:
                values[k] = 1.0
            elif below == -inf:
                values[k] = above - values[k]
            elif above == inf:
                values[k] -= below
            else:
                values[k] = (values[k] - below) * (above - values[k]) / (above - below)
        if SLIDING in sides:
            values[sides.index(SLIDING)] = 1.0 - self.holding(self._dynamics.on_sides(sides), points)[0] ** 2
        return values

    def _ends(self, k: int, side: int) -> tuple[float, float]:
        """The knots around a piece."""
        knots = self._knots[k]
        assert knots is not None
        return (
            float(knots[side - 2]) if side > 1 else -inf,
            float(knots[side - 1]) if side <= len(knots) else inf,
        )

    # --- choosing ---

    def choose(self, time: float, state: Any, before: tuple[int, ...], turned: tuple[int, ...]) -> tuple[int, ...]:
        """The sides from here on: of those ``before``, the ones in ``turned`` change; all are looked for without any.

        Raises Breakdown where the motion can go nowhere.
        """
        values = self.at(time, state)
        sides = list(before) if before else [self._plainly(k, float(v)) for k, v in enumerate(values)]
        open_ = list(turned) if before else [k for k, v in enumerate(values) if self._at_border(k, float(v))]
        for k in open_:
            if before and sides[k] == SLIDING:  # it leaves where the sign that held it has become that of a side
                frozen = self._dynamics.on_sides(before)
                sides[k] = 1 if self._sign_there(frozen, time, state)[0] > 0 else -1
                continue
            for side, way in self._ways(k, sides[k], float(values[k])):
                sides[k] = side
                if k in self.by_clock or self._stays(time, state, tuple(sides), k, way):
                    break
            else:
                if self.curves[k] is not None:
                    raise endless("a force that jumps at a knot leads back to it from both sides", time, state)
                sides[k] = SLIDING
                self._check_sliding(time, state, tuple(sides))
        return tuple(sides)

    def _piece(self, k: int, value: float) -> int:
        """That of a table; 0 of what is none."""
        knots = self._knots[k]
        return 0 if knots is None else 1 + int(np.searchsorted(knots, value, side="right"))

    def _plainly(self, k: int, value: float) -> int:
        return self._piece(k, value) or (0 if self._at_border(k, value) else int(np.sign(value)))

    def _at_border(self, k: int, value: float) -> bool:
        knots, blur = self._knots[k], BLUR * (self.sizes[k] + abs(value))
        if knots is None:
            return abs(value) <= blur
        return k not in self.by_clock and float(np.min(np.abs(knots - value))) <= blur

    def _ways(self, k: int, was: int, value: float) -> tuple[tuple[int, int], ...]:
        """The sides that there are, the likelier first, and in which direction g or x would move there."""
        knots = self._knots[k]
        if knots is None:
            first = -was if was else 1
            return (first, first), (-first, -first)
        if k in self.by_clock:
            return ((was + 1, 1),)
        border = int(np.argmin(np.abs(knots - value)))
        left, right = (border + 1, -1), (border + 2, 1)
        return (left, right) if was == right[0] else (right, left)

    def _stays(self, time: float, state: Any, sides: tuple[int, ...], k: int, way: int) -> bool:
        """Whether a motion that begins at a border goes that way, or stays: by two short steps."""
        state = np.asarray(state, dtype=float)
        frozen = self._dynamics.on_sides(tuple(side or 1 for side in sides) if sides.count(0) > 1 else sides)
        rates = compiled_kernel(frozen, "right_hand_side")(np.concatenate(([time], state)))
        begun, reach = self.at(time, state)[k], 1e-6 * self.time
        scale = abs(begun) + self.sizes[k] * (1.0 + abs(time) / self.time)  # the time is rounded, too
        # A Taylor step of third order: g may begin to move by its second derivative only.
        for length in (reach, 1e3 * reach):
            later = state + length * rates
            middle = compiled_kernel(frozen, "right_hand_side")(np.concatenate(([time + length], later)))
            later = state + 0.5 * length * (rates + middle)
            moved = self.at(time + length, later)[k] - begun
            if abs(moved) > STANDS * scale:
                return bool(moved * way > 0)
        return True

    def _check_sliding(self, time: float, state: Any, sides: tuple[int, ...]) -> None:
        if sides.count(SLIDING) > 1:
            raise endless("two of its switches would have to hold at once", time, state)
        sign, curved = self._sign_there(self._dynamics.on_sides(sides), time, state)
        if not abs(sign) <= 1 + 1e-9 or not abs(curved) <= 1e-9:
            raise endless("no force between the two sides holds it there", time, state)

    @staticmethod
    def holding(frozen: Frozen, points: Any) -> Any:
        """The sign that holds a sliding switch, and 0 where it does, at points (1 + 2n, m)."""
        return once(frozen, "holding", lambda: kernel(frozen.holding))(points)

    def _sign_there(self, frozen: Frozen, time: float, state: Any) -> Any:
        point = np.concatenate(([float(time)], np.asarray(state, float)))[:, None]
        return self.holding(frozen, point)[:, 0]

    def require_inside(self, time: float, state: Any, sides: tuple[int, ...]) -> None:
        """Raises Breakdown where a table is left that says nothing outside of its points."""
        for k, (side, curve) in enumerate(zip(sides, self.curves, strict=True)):
            if curve is not None and curve.bounded and side in (1, len(curve.knots) + 1):
                value = float(self.at(time, state)[k])
                end = float(curve.knots[0] if side == 1 else curve.knots[-1])
                text = "the table [[name]] begins at [[end]]" if side == 1 else "the table [[name]] ends at [[end]]"
                message = Message(text, name=curve.table.name, end=f"{end:.9g}")
                if abs(value - end) > 1e-9 * (self.sizes[k] + abs(end)):
                    argument = Message("its argument is [[value]]", value=f"{value:.9g}")
                    message = joined([message, argument], ", ")
                raise Breakdown(OUTSIDE, message, time, state)


def feature_kernel(dynamics: Dynamics, name: str) -> Callable[[Any], Any]:
    """The ``switches`` or the ``narrow`` of a dynamics, compiled once."""
    code = getattr(dynamics.features, name)
    return once(dynamics, ("features", name), lambda: kernel(code)) if code.outputs else lambda points: np.empty((0,))


def endless(why: str, time: float, state: Any) -> Breakdown:
    """A run that cannot go on at a switch."""
    return Breakdown(SWITCHING, why, time, state)


# Where a step leaves the sides that it was made for: the first place, on its dense output.


#: A piece is halved so often to resolve a g.
DEPTH = 12


class Leaving:
    """``values`` maps points (1 + 2n, m) to what is positive on the sides of a step, shape (switches, m).

    Of the ``switches`` those that are looked for may turn; what cannot be resolved is noted in ``passed``.
    """

    def __init__(self, values: Callable[[Any], Any], switches: Sides, tolerance: float, passed: Passed) -> None:
        self._values, self._switches, self._tolerance, self._passed = values, switches, tolerance, passed
        self._looked_for = switches.looked_for

    def first(self, piece: Piece, sides: tuple[int, ...]) -> tuple[float, tuple[int, ...]]:
        """The first time at which switches leave their sides in a piece, and which do so then; (end, ()) if none."""
        if not self._looked_for or piece.end - piece.start <= self._switches.together(piece.end):
            return piece.end, ()
        leaving: list[tuple[float, int]] = []
        whole, sizes = along(self._values, piece, piece.start, piece.end), self._switches.sizes_on(sides)
        for k in self._looked_for:
            beside = min(float(whole[k][0]), 0.0)  # a step to a switch ends beside it, by its own error
            place = self._left(k, piece, (piece.start, piece.end), whole[k], beside, float(sizes[k]), DEPTH)
            if place is not None:
                leaving.append((place, k))
        if not leaving:
            return piece.end, ()
        first = min(place for place, _ in leaving)
        together = self._switches.together(first)
        return first, tuple(k for place, k in leaving if place <= first + together)

    def _left(
        self, k: int, piece: Piece, span: tuple[float, float], values: Any, beside: float, usual: float, depth: int
    ) -> float | None:
        """Where a function of a ``usual`` size becomes negative that begins positive, or 0 but for ``beside``."""
        if not np.all(np.isfinite(values)):
            return None
        start, end = span
        size = float(np.max(np.abs(values)))
        begins = start == piece.start
        shifted = values - beside
        known = series(shifted)
        if free_of_zeros(known) and shifted[0] > 0:
            return None
        # Of a step that is hardly longer than the rounding of its times no more can be resolved than these leave.
        rounding = 1e-14 * size + np.ptp(values) * np.spacing(abs(end)) / (end - start)
        if not resolved(known, rounding) and depth > 0:
            middle = 0.5 * (start + end)
            for half in ((start, middle), (middle, end)):
                place = self._left(k, piece, half, along(self._values, piece, *half)[k], beside, usual, depth - 1)
                if place is not None:
                    return place
            return None
        if not resolved(known, rounding) and len(self._passed.unresolved) < MOST_KEPT:
            self._passed.unresolved.append(start)
        # Beside a switch that was just passed, what is within the tolerance of it is at it.
        near = 0.1 * self._tolerance * usual if begins and abs(values[0]) < 1e-6 * (usual + size) else 0.0
        passed, _, _ = passages(known, Sign(1, begins), max(BLUR * size, near))
        down = [passage.place for passage in passed if passage.turn < 0]
        if not down:
            return None
        return self._polished(k, piece, start + 0.5 * (down[0] + 1) * (end - start), start, end)

    def _polished(self, k: int, piece: Piece, guess: float, start: float, end: float) -> float:
        """The zero of g itself on the dense output, beside that of its interpolant; by bisection."""

        def value(time: float) -> float:
            return float(self._values(np.vstack([[[time]], np.asarray(piece(np.array([time])), float)]))[k, 0])

        reach = 1e-12 * (end - start)
        while reach < end - start:
            left, right = max(start, guess - reach), min(end, guess + reach)
            if value(left) > 0 >= value(right):
                for _ in range(80):
                    middle = 0.5 * (left + right)
                    if middle in (left, right):
                        break
                    left, right = (middle, right) if value(middle) > 0 else (left, middle)
                return right
            reach *= 16
        return guess
