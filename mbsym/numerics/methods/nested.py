"""Dense output as values: a step's solution by the terms of Hairer, Norsett & Wanner (``rows``), kept by itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


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
