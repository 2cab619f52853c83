"""Dense output as values: a step's solution by the terms of Hairer, Norsett & Wanner (``rows``), kept by itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mbsym.numerics.methods.interface import Piece


@dataclass(frozen=True)
class Nested:
    """x(s) = x + s (F0 + (1 - s) (F1 + s (F2 + ...))), s = (t - start) / length.

    ``before`` (x) and ``arrived``, what it is at ``reached``, the end of the step, have shape (2n, 1), ``terms`` shape
    (terms, 2n, 1); or there is a step for each time, with m columns instead of one.
    """

    start: Any
    length: Any
    reached: Any
    before: Any
    arrived: Any
    terms: Any

    def __call__(self, times: Any) -> Any:
        """The states (2n, m) at m times."""
        dtype = self.before.dtype
        share = ((np.asarray(times) - self.start) * (1 / self.length)).astype(dtype)
        rest = 1 - share
        total = np.zeros((len(self.before), len(share)), dtype)
        for place in reversed(range(len(self.terms))):
            total += self.terms[place]
            total *= share if place % 2 == 0 else rest
        total += self.before
        return np.where(times == self.reached, self.arrived, total)


def hermite(length: Any, change: Any, before: Any, after: Any) -> Any:
    """The terms (5, 2n, m) that fit q, q' and q'' at both ends of m steps, from x' = (q', q'') of shape (2n, m) there.

    ``change`` is x_new - x, in all the digits that are known.
    """
    n = len(change) // 2
    begin, end = length * before, length * after
    first, second = begin - change, 2 * change - (begin + end)
    third = np.empty_like(change)
    third[:n] = length * begin[n:] / 2 + first[:n] - second[:n]
    missing = change[:n] / length - before[:n] - change[n:] / 2 - first[n:] / 6 - second[n:] / 12
    third[n:] = 30 * missing
    fourth = np.zeros_like(change)
    fourth[:n] = length * end[n:] / 2 + first[:n] + 2 * second[:n] - third[:n]
    return np.array([change, first, second, third, fourth])


# Many pieces of a solution evaluated at once: where all are of a compiled method, in one go over arrays.


def states_on(pieces: Sequence[Callable[[Any], Any]], times: Sequence[Any]) -> Any:
    """The states (2n, m) of each piece at its own times, a piece after the other; not all have any.

    Times of pieces of a compiled method have to lie within them.
    """
    curves = [piece.curve for piece in pieces if isinstance(piece, Piece)]
    steps = [curve for curve in curves if isinstance(curve, Nested)]
    if len(steps) < len(pieces) or len({step.terms.shape for step in steps}) > 1:
        return np.hstack([piece(np.asarray(own)) for piece, own in zip(pieces, times, strict=True) if len(own)])
    counts = [len(own) for own in times]
    start, length, reached = (
        np.repeat([getattr(step, name) for step in steps], counts) for name in ("start", "length", "reached")
    )
    before, arrived = (
        np.repeat(np.hstack([getattr(step, name) for step in steps]), counts, axis=1) for name in ("before", "arrived")
    )
    terms = np.repeat(np.concatenate([step.terms for step in steps], axis=2), counts, axis=2)
    return Nested(start, length, reached, before, arrived, terms)(np.concatenate(times))
