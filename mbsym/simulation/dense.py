"""The solution between the rows, anywhere from 0 to where the run ended.

A run keeps its rows only: a million of them shall not bring the coefficients of all steps with them.  Whoever asks for
more has the run integrated again, with the same method, steps and arithmetic, and its steps kept, if they are not too
many; else every question costs an integration.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.numerics.methods.interface import Breakdown, Piece, Run

#: Steps are kept up to so many, a kilobyte or so each.
MOST_KEPT = 50_000


class Dense:
    """States (2n, m) at any times from ``begin`` to ``end``; ``start`` begins the run anew."""

    def __init__(self, start: Callable[[], Run], begin: float, end: float) -> None:
        self._start, self.begin, self.end = start, begin, end
        self._pieces: list[Piece] | None = None
        self._ends: Any = None
        self._too_many = False

    def __call__(self, times: Any) -> Any:
        """The states (2n, m) at m times in any order, or (2n,) at one.

        Raises ValueError for a time beyond the run, Breakdown where it cannot be repeated so far.
        """
        at = np.asarray(times, dtype=float)
        if not np.all((at >= self.begin) & (at <= self.end)):
            raise ValueError(f"the run goes from t = {self.begin:.9g} to {self.end:.9g}")
        if at.ndim > 1:
            raise ValueError(f"a time or an array of times, not one of shape {at.shape}")
        flat = np.atleast_1d(at)
        order = np.argsort(flat, kind="stable")
        found = self._ordered(flat[order])
        states = np.empty_like(found)
        states[:, order] = found
        return states if at.ndim else states[:, 0]

    def _ordered(self, times: Any) -> Any:
        """The states at increasing times."""
        run = self._start()
        if not len(times):
            return np.empty((len(run.state), 0), np.asarray(run.state).dtype)
        if self._pieces is None and not self._too_many:
            self._keep(run)
        if self._pieces is None:
            return self._start().fill(times)
        places = np.minimum(np.searchsorted(self._ends, times), len(self._pieces) - 1)
        cuts = np.flatnonzero(np.diff(places)) + 1
        parts = zip(np.split(places, cuts), np.split(times, cuts), strict=True)
        return np.hstack([self._pieces[place[0]].curve(part) for place, part in parts])

    def _keep(self, run: Run) -> None:
        """The steps of the run up to its end; nothing where they are too many."""
        pieces: list[Piece] = []
        try:
            while run.time < self.end:
                if len(pieces) == MOST_KEPT:
                    self._too_many = True
                    return
                pieces.append(run.step())
        except Breakdown as found:
            if not pieces or pieces[-1].end < self.end:
                raise found
        if not pieces:  # it ended where it began
            state = np.array(run.state)
            pieces.append(Piece(self.begin, self.end, lambda times: np.repeat(state[:, None], len(times), axis=1)))
        self._pieces, self._ends = pieces, np.array([float(piece.end) for piece in pieces])
