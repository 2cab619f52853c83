"""Integration in fewer coordinates: what provably rests is taken out, and put back into every state that is shown.

Coordinates S with q_S'' = 0 while they rest (``planning.reduction``) are constants of the motion: the free ones
are integrated in the system in which q_S is held, and a whole state is

    q_F(t), q_F'(t) as integrated,      q_S(t) = q_S(0),      q_S'(t) = 0.

Energy, pivots of the mass matrix and states at a breakdown are those of the whole system.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.mechanics.states import SEED
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Method, Passed, Piece, Run, Setting, met_by
from mbsym.numerics.methods.kept import compiled_kernel
from mbsym.numerics.methods.tableaux import exact_number
from mbsym.numerics.planning.reduction import Reduction, resting

#: A coordinate that is accelerated by more than this part of the greatest acceleration is pushed.
PUSHED = 1e-7

#: Random states at which accelerations are looked at before anything is proved.
STATES = 4


@dataclass(frozen=True)
class Reduced:
    """Coordinates of ``whole`` that rest, and the ``dynamics`` without them."""

    whole: Dynamics
    reduction: Reduction
    dynamics: Dynamics

    @property
    def names(self) -> tuple[str, ...]:
        """The coordinates that rest."""
        return tuple(self.reduction.values)

    @property
    def proved(self) -> bool:
        """Whether it is a theorem that they rest; only then may they be taken out."""
        return self.reduction.how is Certainty.PROVED

    @property
    def operations(self) -> tuple[int, int]:
        """What one right-hand side costs: of the whole system, and without the coordinates that rest."""
        return self.whole.right_hand_side.operations, self.dynamics.right_hand_side.operations

    def method(self, inner: Method) -> Method:
        """A method that integrates the free coordinates and shows whole states."""
        return _Completing(inner, self)


def reduced(dynamics: Dynamics) -> Reduced | None:
    """The largest set of coordinates that rest in this scenario taken out; None where all may move.

    Accelerations at some states tell first what is pushed, so that nothing is proved where nothing rests.
    """
    if all(dynamics.scenario.velocities) or dynamics.size < 2 or dynamics.constraints is not None or dynamics.in_states:
        return None
    try:
        unpushed = _unpushed(dynamics)
        found = resting(dynamics.scenario, among=unpushed) if unpushed else None
        if found is None:
            return None
        smaller = Reduced(dynamics, found, Dynamics(found.scenario))
        # Where what is left moves no mass, the whole system says when and where.
        assert smaller.dynamics.right_hand_side is not None
        return smaller
    except Failure:
        return None


def _unpushed(dynamics: Dynamics) -> Collection[str]:
    """Coordinates that start without velocity and are not accelerated at random states in which they all rest.

    A set that rests identically is never lost: with its members held their accelerations vanish at every state.
    """
    n, scenario = dynamics.size, dynamics.scenario
    rhs = compiled_kernel(dynamics, "right_hand_side")
    start = np.array([float(x) for x in scenario.state])
    source = np.random.default_rng(SEED)
    moved = source.uniform(-1, 1, (2 * n, STATES)) * (0.5 + np.abs(start[:, None]))
    moved[:, 0] = 0.0
    times = np.concatenate(([0.0], source.uniform(0, 1, STATES - 1)))
    resting_now = np.array([velocity == 0 for velocity in scenario.velocities])
    while np.any(resting_now):
        held = np.concatenate((resting_now, resting_now))
        states = start[:, None] + np.where(held[:, None], 0.0, moved)
        with np.errstate(all="ignore"):
            accelerations = np.abs(rhs(np.vstack([times, states]))[n:])
        finite = accelerations[:, np.all(np.isfinite(accelerations), axis=0)]
        pushed = np.max(finite, axis=1, initial=0.0) > PUSHED * np.max(finite, initial=0.0)
        if not np.any(pushed & resting_now):
            break
        resting_now &= ~pushed
    return [name for name, rests in zip(scenario.system.coordinates, resting_now, strict=True) if rests]


class _Completing:
    """A method over the free coordinates that shows whole states."""

    def __init__(self, inner: Method, taken: Reduced) -> None:
        self.traits = inner.traits
        self._inner, self._taken = inner, taken

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> Run:
        """Raises ValueError where ``initial`` moves what rests."""
        if dynamics is not self._taken.whole:
            raise ValueError("this method was made for the dynamics of another scenario")
        inner = self._inner.start(self._taken.dynamics, setting, scalar)
        found = _Whole(inner, self._taken)
        if initial is not None or at:
            found.restart(at, found.state if initial is None else initial)
        return found


@dataclass(frozen=True)
class _Completion:
    """Whole states (q, q'): the free ones at ``places``, the others as at the ``start``."""

    places: tuple[int, ...]
    start: Any

    def __call__(self, free: Any) -> Any:
        """One state, or states in columns."""
        found = np.empty((len(self.start), *np.shape(free)[1:]), self.start.dtype)
        found[...] = self.start.reshape(-1, *[1] * (found.ndim - 1))
        found[list(self.places)] = free
        return found


class _Whole:
    """A run whose states are completed, in the arithmetic of the run."""

    def __init__(self, inner: Run, taken: Reduced) -> None:
        self._inner = inner
        self.work = inner.work
        places, start = taken.reduction.expanded(taken.whole.scenario)
        dtype = np.asarray(inner.state).dtype
        self._completed = _Completion(places, np.array([exact_number(x, dtype.type) for x in start], dtype))
        self._show()

    def _show(self) -> None:
        self.time, self.state = self._inner.time, self._completed(self._inner.state)

    @property
    def passed(self) -> Passed | None:
        """What the run has met on its way."""
        found = met_by(self._inner)
        if found is None:
            return None
        narrow = [replace(one, place=None) for one in found.narrow]
        inside = [(time, self._completed(state)) for time, state in found.inside]
        return Passed(found.switches, narrow, found.unresolved, inside)

    def advance(self, until: float) -> Any:
        self._guarded(lambda: self._inner.advance(until))
        self._show()
        return self.state

    def step(self, until: float | None = None) -> Piece:
        piece: Piece = self._guarded(lambda: self._inner.step(until))
        self._show()
        curve, completed = piece.curve, self._completed
        return Piece(piece.start, piece.end, lambda times: completed(curve(times)))

    def fill(self, times: Any) -> Any:
        found = self._guarded(lambda: self._inner.fill(times))
        self._show()
        return self._completed(found)

    def restart(self, time: float, state: Any) -> None:
        """Raises ValueError where a state moves what rests."""
        given, places = np.asarray(state), list(self._completed.places)
        if not np.array_equal(self._completed(given[places]), given.astype(self.state.dtype)):
            raise ValueError("a state that moves what was taken out of the integration because it rests")
        self._inner.restart(time, given[places])
        self._show()

    def _guarded(self, action: Callable[[], Any]) -> Any:
        """Breakdowns show whole states."""
        try:
            return action()
        except Breakdown as found:
            state = self._completed(found.state).astype(float)
            filled = None if found.filled is None else self._completed(found.filled)
            raise Breakdown(found.kind, found.message, found.time, state, filled) from None
