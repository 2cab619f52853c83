"""Stretches of many steps in machine code, on which it is shown afterwards that nothing was passed.

    a block of about K steps of the length h of the last one, with K intervals of the length h
    at Chebyshev's points of each: states by the method's own dense output, and from these every g and u
    accepted where each g keeps its sign (|c_0| > sum |c_k|) and no u does anything narrow; else as if never tried

Steps are those that would be made one by one, and so are their ends; what is looked at is spread over the intervals as
it would be over the steps, for there are about as many of them.  A block that meets something is undone, and smaller
ones are tried behind it, or none for a while.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from mbsym.numerics.events.crossings import NODES, free_of_zeros, nodes, series
from mbsym.numerics.methods.interface import Breakdown, Piece
from mbsym.numerics.methods.narrow import harmless
from mbsym.numerics.methods.runge_kutta import CompiledRun

#: A block has so many steps at least and at most.
LEAST, MOST = 8, 256

#: A block keeps so many steps away from a time that steps have to end at: they are shortened before it.
AWAY = 4

#: Steps that are shorter than this part of the time are made one by one.
SHORT = 1e-10

#: There may be so many steps to an interval.
STEPS_TO_AN_INTERVAL = 1.5


@dataclass(frozen=True)
class Block:
    """The states (2n, m) at the rows that lie in it, where it ends, and how long its steps were."""

    rows: Any
    end: float
    length: float


class Blocks:
    """Blocks of a run: ``positive`` maps points (1 + 2n, m) to what keeps its sign, ``narrow`` to each u."""

    def __init__(
        self,
        positive: Callable[[Any], Any],
        looked_for: tuple[int, ...],
        narrow: Callable[[Any], Any],
        kinds: tuple[str, ...],
    ) -> None:
        self._positive, self._looked_for, self._narrow, self._kinds = positive, list(looked_for), narrow, kinds
        self._size, self._rest, self._waits = LEAST, 0, 0

    def begin(self) -> None:
        """Something was met: the next block is a small one."""
        self._size = LEAST

    def ahead(self, run: CompiledRun, length: float, bound: float, rows: Any) -> Block | None:
        """A block that ends well before ``bound``, or None: the run is then where it was.

        ``length`` is that of the last step; ``rows`` are times, of which those within are filled.
        """
        if self._rest > 0:
            self._rest -= 1
            return None
        start = float(run.time)
        if not length > SHORT * (1.0 + abs(start)):
            return None
        count = int(min(self._size, (bound - start) / length - AWAY))
        if count < LEAST:
            return None
        edges = start + length * np.arange(count + 1)
        probes = np.concatenate([nodes(a, b)[:-1] for a, b in pairwise(edges)] + [edges[-1:]])
        within = rows[: int(np.searchsorted(rows, edges[-1], side="right"))]
        times = np.union1d(probes[1:], within)
        rest: Piece | None = None
        saved, steps = run.saved(), run.work.steps
        known = np.array(run.state)[:, None]
        try:
            states = run.fill(times)
            if run.reached > run.time:
                rest = run.step()  # what is left of the last step
        except Breakdown:
            self._undone(run, saved)
            return None
        far_enough = bound - float(run.reached) > AWAY * length
        few = run.work.steps - steps <= STEPS_TO_AN_INTERVAL * count + 2
        at_probes = np.concatenate([known, states[:, np.searchsorted(times, probes[1:])]], axis=1)
        if not (far_enough and few and self._free(probes, at_probes) and self._free_on(rest)):
            self._undone(run, saved)
            return None
        self._size, self._waits = min(2 * self._size, MOST), 0
        length *= count / max(1, run.work.steps - steps)
        found = states[:, np.searchsorted(times, within)]
        if rest is not None:
            later = rows[len(within) : int(np.searchsorted(rows, rest.end, side="right"))]
            found = np.concatenate([found, rest(later)], axis=1) if len(later) else found
        return Block(found, float(run.time), length)

    def _undone(self, run: CompiledRun, saved: Any) -> None:
        run.undo(saved)
        if self._size == LEAST:  # what is near now is near for a while
            self._waits = min(2 * self._waits + LEAST, MOST)
            self._rest = self._waits
        self._size = max(self._size // 4, LEAST)

    def _free_on(self, piece: Piece | None) -> bool:
        if piece is None:
            return True
        times = nodes(float(piece.start), float(piece.end))
        return self._free(times, piece(times))

    def _free(self, probes: Any, states: Any) -> bool:
        """Whether nothing is met at the probes, NODES to an interval."""
        points = np.vstack([probes, np.asarray(states, dtype=float)])
        if self._looked_for:
            values = self._by_interval(self._positive(points)[self._looked_for])
            if not np.all(np.isfinite(values)) or not np.all(values[..., 0] > 0):
                return False
            if not np.all(free_of_zeros(series(values))):
                return False
        if self._kinds:
            values = self._by_interval(self._narrow(points))
            if not np.all(np.isfinite(values)):
                return False
            found = series(values)
            return all(np.all(harmless(kind, own)) for kind, own in zip(self._kinds, found, strict=True))
        return True

    @staticmethod
    def _by_interval(values: Any) -> Any:
        """(functions, intervals, NODES): the last point of an interval is the first one of the next."""
        count = (values.shape[1] - 1) // (NODES - 1)
        places = np.arange(count)[:, None] * (NODES - 1) + np.arange(NODES)
        return values[:, places]
