"""Where a step leaves the sides that it was made for: the first place, on its dense output."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.numerics.events.crossings import Sign, free_of_zeros, passages, resolved, series
from mbsym.numerics.methods.interface import Piece
from mbsym.numerics.methods.narrow import along
from mbsym.numerics.methods.passed import MOST_KEPT, Passed
from mbsym.numerics.methods.sides import BLUR

#: A piece is halved so often to resolve a g.
DEPTH = 12

#: Switches so close to each other, relative to the time, that nothing moves between them.
TOGETHER = 1e-12


class Leaving:
    """``values`` maps points (1 + 2n, m) to what is positive on the sides of a step, shape (switches, m).

    Of the switches those ``looked_for`` may turn; what cannot be resolved is noted in ``passed``.
    """

    def __init__(
        self, values: Callable[[Any], Any], looked_for: tuple[int, ...], tolerance: float, passed: Passed
    ) -> None:
        self._values, self._looked_for, self._tolerance, self._passed = values, looked_for, tolerance, passed

    def first(self, piece: Piece) -> tuple[float, tuple[int, ...]]:
        """The first time at which switches leave their sides in a piece, and which do so then; (end, ()) if none."""
        if not self._looked_for or piece.end - piece.start <= TOGETHER * max(1.0, abs(float(piece.end))):
            return piece.end, ()
        found: list[tuple[float, int]] = []
        whole = along(self._values, piece, piece.start, piece.end)
        for k in self._looked_for:
            place = self._left(k, piece, piece.start, piece.end, whole[k], DEPTH)
            if place is not None:
                found.append((place, k))
        if not found:
            return piece.end, ()
        first = min(place for place, _ in found)
        together = TOGETHER * max(1.0, abs(first))
        return first, tuple(k for place, k in found if place <= first + together)

    def _left(self, k: int, piece: Piece, start: float, end: float, values: Any, depth: int) -> float | None:
        """Where a function that begins positive, or at 0, becomes negative."""
        if not np.all(np.isfinite(values)):
            return None
        size = float(np.max(np.abs(values)))
        begins = start == piece.start
        shifted = values - min(values[0], 0.0) if begins else values
        known = series(shifted)
        if free_of_zeros(known) and shifted[0] > 0:
            return None
        if not resolved(known, 1e-14 * size) and depth > 0:
            middle = 0.5 * (start + end)
            for a, b in ((start, middle), (middle, end)):
                place = self._left(k, piece, a, b, along(self._values, piece, a, b)[k], depth - 1)
                if place is not None:
                    return place
            return None
        if not resolved(known, 1e-14 * size) and len(self._passed.unresolved) < MOST_KEPT:
            self._passed.unresolved.append(start)
        # Beside a switch that was just passed, what is within the tolerance of it is at it.
        near = 0.1 * self._tolerance if begins and abs(values[0]) < 1e-6 * (1 + size) else 0.0
        passed, _, _ = passages(known, Sign(1, begins), max(BLUR * size, near))
        down = [one.place for one in passed if one.turn < 0]
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
