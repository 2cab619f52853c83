"""Where a run cannot begin, and what its end is called: bounds, singular mass matrices, rates that do not exist."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.expressions.message import Message
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import (
    BLOW_UP,
    LARGEST,
    SINGULAR,
    SINGULAR_CONSTRAINTS,
    STUCK,
    UNDEFINED,
    Breakdown,
)
from mbsym.numerics.methods.kept import compiled_kernel

if TYPE_CHECKING:
    from mbsym.numerics.simulate import Trajectory

#: No initial state is beyond this: the world measures 1e27 metres.
LARGEST_START = 1e30

#: A pivot of M that has become so much smaller than it was means that M is singular for practical purposes.
SINGULAR_PIVOT = 1e-11

#: The same for an initial state beside its neighbours: sin(x)**2 where x is zero but for rounding.
SINGULAR_AT_ONCE = 1e-24

#: How far ahead, as parts of the state's size, rates that are no numbers explain why a run could not go on.
AHEAD = (1e-12, 1e-9, 1e-6, 1e-3, 3e-2)


def bound_of(initial: Any) -> float:
    """Where a run is ended: sizes of 1e12, and as many times those of the initial state (orbits in metres)."""
    return LARGEST * max(1.0, float(np.max(np.abs(initial), initial=0.0)))


def wrong_at_once(dynamics: Dynamics, initial: Any, begin: float = 0.0) -> Breakdown | None:
    """What is wrong with the initial state itself: there the right-hand side must exist."""
    if not np.all(np.abs(initial) < LARGEST_START):
        beyond = Message("the initial state itself is beyond [[bound]]", bound=f"{LARGEST_START:g}")
        return Breakdown(BLOW_UP, beyond, begin, initial)
    lost = _lost_rank(dynamics, initial) if begin == 0 else ""
    if lost:
        return Breakdown(SINGULAR_CONSTRAINTS, lost, begin, initial)
    point = np.concatenate(([begin], initial))
    with np.errstate(all="ignore"):
        rates = compiled_kernel(dynamics, "right_hand_side")(point)
    singular = _vanishing(dynamics, begin, initial, _neighbours(initial, begin), SINGULAR_AT_ONCE)
    if singular:
        return Breakdown(SINGULAR, singular, begin, initial)
    if np.all(np.isfinite(rates)):
        return None
    if np.any(np.isnan(rates)):
        return Breakdown(UNDEFINED, "the accelerations at the initial state are no numbers", begin, initial)
    return Breakdown(BLOW_UP, "the accelerations at the initial state are not finite", begin, initial)


def _lost_rank(dynamics: Dynamics, initial: Any) -> str:
    """What is said of an initial position in which constraints depend on each other that do not beside it.

    Or where nothing is beside it that all of them allow (links at full stretch between two points).
    """
    known = dynamics.constraints
    if known is None:
        return ""
    rank, usual = len(known.independent(0.0, initial)), len(known.kept)
    if rank == usual:
        text = (
            "what the constraint rows allow at this position to first order (their rank is [[rank]]) they stop at "
            "second order"
        )
        return Message(text, rank=rank) if known.obstructed(initial) else ""
    text = "of [[usual]] constraint rows that are independent beside this position, [[rank]] are independent in it"
    return Message(text, usual=usual, rank=rank)


def _neighbours(state: Any, time: float) -> Any:
    """(t, q, q') in columns: some states not far from a state, the same ones every time."""
    n = len(state)
    moved = np.sin(np.outer(np.arange(1, n + 1), np.arange(1, 5)))  # any numbers between -1 and 1
    return np.vstack([np.full(4, time), state[:, None] + 0.1 * moved * (1 + np.abs(state[:, None]))])


def diagnosed(dynamics: Dynamics, found: Breakdown, past: Any) -> Breakdown:
    """A vanishing step at a blow-up, and either of them where the mass matrix is singular, are called what they are.

    ``past`` holds earlier (t, q, q') in columns: a pivot is small compared with what it was, whatever its units.
    """
    if found.kind not in (BLOW_UP, STUCK):
        return found
    state = np.asarray(found.state, dtype=float)
    message = _vanishing(dynamics, found.time, state, past, SINGULAR_PIVOT)
    if message:
        return Breakdown(SINGULAR, message, found.time, found.state)
    if _undefined(dynamics, found.time, state):
        message = "the equations have no real value beyond this state: a root or a logarithm leaves its domain"
        return Breakdown(UNDEFINED, message, found.time, found.state)
    bound = bound_of(past[1:, 0])
    if not np.all(np.abs(state) < bound):
        message = Message("a coordinate or velocity is beyond [[bound]]", bound=f"{bound:.0e}")
        return Breakdown(BLOW_UP, message, found.time, found.state)
    return found


def _undefined(dynamics: Dynamics, t: float, state: Any) -> bool:
    """Whether the rates are no numbers (infinite ones are) in a state, or a little ahead of it."""
    if not np.all(np.isfinite(state)):
        return False
    rhs = compiled_kernel(dynamics, "right_hand_side")
    with np.errstate(all="ignore"):
        rates = rhs(np.concatenate(([t], state)))
        if np.any(np.isnan(rates)):
            return True
        speed = float(np.max(np.abs(rates), initial=0.0))
        if not 0 < speed < LARGEST:
            return False
        steps = np.array(AHEAD) * (1 + float(np.max(np.abs(state)))) / speed
        return bool(np.any(np.isnan(rhs(np.vstack([t + steps, state[:, None] + np.outer(rates, steps)])))))


def _vanishing(dynamics: Dynamics, t: float, state: Any, others: Any, least: float) -> str:
    """Which pivot of M vanishes at a state, beside its values at other states, as a sentence; empty where none does."""
    if not np.all(np.isfinite(state)):
        return ""
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(np.concatenate(([t], state))))
        if not np.all(np.isfinite(pivots)):
            return "M cannot be factorised"
        elsewhere = np.abs(compiled_kernel(dynamics, "pivots")(others))
        usual = np.median(np.where(np.isfinite(elsewhere), elsewhere, 0.0), axis=1)
        ratios = np.where(usual > 0, pivots / usual, np.where(pivots > 0, np.inf, 0.0))
    ratio = float(np.min(ratios))
    if not ratio < least:
        return ""
    if dynamics.constraints is not None:
        text = "a pivot of M or of J M^-1 J^T (constraints) is [[ratio]] of its usual size"
        return Message(text, ratio=f"{ratio:.1e}")
    return Message("a pivot of M is [[ratio]] of its usual size", ratio=f"{ratio:.1e}")


def least_pivot(dynamics: Dynamics, found: Trajectory) -> tuple[float, float]:
    """(ratio, t): how far a pivot of M fell below what it was at the start, and when.

    M loses about -log10(ratio) digits there; 1e-8 and less means that the motion passes by a singularity of the chosen
    coordinates (or of the model).
    """
    lowest = fallen(dynamics, np.vstack([found.times, found.states.astype(float)]))
    place = int(np.argmin(lowest))
    return float(lowest[place]), float(found.times[place])


def fallen(dynamics: Dynamics, points: Any, first: Any = None) -> Any:
    """What of a pivot of M is left at (t, q, q') in columns, of the pivot that fell most, shape (m,).

    Parts of what they were at the point ``first``, shape (1 + 2n,); without it, at the first of the columns.
    """
    with np.errstate(all="ignore"):
        pivots = np.abs(compiled_kernel(dynamics, "pivots")(points))
        start = pivots[:, 0] if first is None else np.abs(compiled_kernel(dynamics, "pivots")(first))
        ratios = pivots / start[:, None]
    return np.min(np.where(np.isfinite(ratios), ratios, 0.0), axis=0)
