"""What runs of all methods share: steps of the method's own, of which the last one may end ahead of the run's time.

A method says how it makes one step, where that ends, and what lies between; ``advance``, ``step`` and ``fill`` follow.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from mbsym.numerics.methods.interface import Breakdown, Cause, Piece, Work


class Stepping(ABC):
    """A run by its steps; ``state`` belongs to ``time``, which is nowhere later than ``reached``."""

    time: float
    state: Any
    work: Work

    @property
    @abstractmethod
    def reached(self) -> float:
        """The end of the last step, or where the run began."""

    @property
    @abstractmethod
    def end(self) -> Any:
        """The state at ``reached``."""

    @abstractmethod
    def one(self, until: float | None = None) -> None:
        """One more step, shortened if it would end beyond ``until``; raises Breakdown."""

    @abstractmethod
    def curve(self) -> Callable[[Any], Any]:
        """The dense output of the last step: times (m,) -> states (2n, m); it must not change with further steps."""

    @abstractmethod
    def restart(self, time: float, state: Any) -> None:
        """Go on from another state."""

    def far(self, until: float) -> None:
        """Steps until ``until`` is reached or passed."""
        while self.reached < until:
            self.one()

    def states(self, times: Any) -> Any:
        """The states (2n, m) at times of the last step."""
        if np.all(times == self.reached):
            return np.repeat(np.array(self.end)[:, None], len(times), axis=1)
        found = self.curve()(times)
        exact = times == self.reached
        return np.where(exact, np.asarray(self.end)[:, None], found) if np.any(exact) else found

    def first(self, at: Any) -> Any:
        """The states (2n, k) at the first k >= 1 of some increasing times: those up to the end of a step; Breakdown."""
        self.far(at[0])
        return self.states(at[: max(1, int(np.searchsorted(at, self.reached, side="right")))])

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``; raises Breakdown."""
        self.far(until)
        self.state = np.array(self.states(np.array([until]))[:, 0])
        self.time = until
        return self.state

    def step(self, until: float | None = None) -> Piece:
        """The solution from ``time`` to the end of the step, or to ``until``; raises Breakdown."""
        start = self.time
        if until is not None and not until > start:
            raise ValueError(f"a step to {until:.9g} from {start:.9g}")
        if not self.reached > start:
            self.one(until)
            if not self.reached > start:  # where a step is wanted that short floats cannot tell from none
                raise Breakdown(
                    Cause.STUCK, "this arithmetic has too few digits for the next step", float(start), self.state
                )
        end = self.reached if until is None else min(until, self.reached)
        piece = Piece(start, end, self.curve())
        self.state = np.array(self.end) if end == self.reached else piece(end)
        self.time = end
        return piece

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times; raises Breakdown with those that there are."""
        at = np.asarray(times)
        states = np.empty((len(self.state), len(at)), np.asarray(self.state).dtype)
        done = 0
        try:
            while done < len(at):
                found = self.first(at[done:])
                states[:, done : done + found.shape[1]] = found
                done += found.shape[1]
        except Breakdown as trouble:
            trouble.filled = states[:, :done]
            raise
        if done:
            self.time, self.state = at[-1], states[:, -1].copy()
        return states
