"""What an integration method is to the rest: something that starts runs, which advance in time.

``Method`` describes itself (order, fixed step or tolerance, which arithmetic) and starts a ``Run``; a run advances to
the times that it is asked for, or step by step, and counts its work.  A step is a ``Piece`` of the solution, known
everywhere between its ends.  What goes wrong is a ``Breakdown`` with time and state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from mbsym.numerics.dynamics import Dynamics

#: Where a step vanishes, rates beyond this mean a blow-up.
LARGEST = 1e12


class Breakdown(Exception):
    """An integration that cannot go on: ``kind`` says why, at ``time`` in ``state`` (q, q').

    ``filled`` holds the states (2n, j) at the first j of the times that ``Run.fill`` was asked for.
    """

    def __init__(self, kind: str, message: str, time: float, state: Any, filled: Any = None) -> None:
        super().__init__(f"{kind} at t = {time:.9g}: {message}")
        self.kind, self.message, self.time, self.state, self.filled = kind, message, time, state, filled


BLOW_UP, SINGULAR, STEP_LIMIT, STUCK = "blow-up", "singular mass matrix", "step limit", "step size too small"

#: The rows of constraints lose their rank: a mechanism in a singular position.
SINGULAR_CONSTRAINTS = "singular constraints"

#: No mistake: an event asked for it.
STOPPED = "stopped by an event"

#: A root or a logarithm of a negative number: the model says nothing about such states.
UNDEFINED = "no real value"


@dataclass(frozen=True)
class Setting:
    """How finely: a ``tolerance`` (relative and absolute, per step) or a ``step``; at most ``step_limit`` steps.

    No step that a tolerance chooses is longer than ``longest``, where that is given (Taylor series take no notice).
    """

    tolerance: float | None = None
    step: float | None = None
    step_limit: int = 10_000_000
    longest: float | None = None


@dataclass(frozen=True)
class Change:
    """From ``time`` on a run goes by another method, named as in the table; ``why`` in words."""

    time: float
    method: str
    why: str


#: What a ``Work`` counts.
COUNTS = ("evaluations", "jacobians", "steps", "rejected")


@dataclass
class Work:
    """What a run has cost so far, and which ``changes`` of the method it made on its way.

    ``singular`` are times of singular positions of constraints through which the motion was continued.
    ``compiling`` are seconds that went into machine code after the run was started.
    """

    evaluations: int = 0
    jacobians: int = 0
    steps: int = 0
    rejected: int = 0
    changes: list[Change] = field(default_factory=list)
    singular: list[float] = field(default_factory=list)
    compiling: float = 0.0


@dataclass(frozen=True)
class Traits:
    """What a method says of itself.

    ``order`` is its nominal order (None: variable); ``fixed`` means that it takes a step instead of a tolerance;
    ``scalars`` the arithmetic it runs in; ``conservative`` that it needs forces with a force function;
    ``extra`` the optional package that it needs.
    """

    name: str
    title: str
    order: int | None
    fixed: bool
    scalars: tuple[str, ...] = ("float64",)
    implicit: bool = False
    conservative: bool = False
    extra: str | None = None


@dataclass(frozen=True)
class Piece:
    """The solution from ``start`` to ``end``: one step, or a part of one.

    ``curve`` gives the states (2n, m) at an array of m times.  It keeps what it needs: a piece stays what it is while
    its run goes on.
    """

    start: float
    end: float
    curve: Callable[[Any], Any]

    def __call__(self, times: Any) -> Any:
        """The states (2n, m) at m times, or (2n,) at one.  Raises ValueError where one is beyond the ends."""
        at = np.asarray(times)
        slack = 1e-12 * (abs(self.start) + abs(self.end))
        if at.size and not (self.start - slack <= at.min() and at.max() <= self.end + slack):
            raise ValueError(f"a time beyond the piece from {self.start:.9g} to {self.end:.9g}")
        return self.curve(at) if at.ndim else self.curve(at[None])[:, 0]

    def part(self, start: float, end: float) -> Piece:
        """The same solution between narrower ends."""
        return replace(self, start=start, end=end)


class Run(Protocol):
    """One integration under way; ``state`` belongs to ``time``.

    Whichever of ``advance``, ``fill`` and ``step`` is used, and however often, the steps are the same; what lies
    between their ends comes from the method's dense output.  Only ``step(until)`` shortens a step.
    """

    time: float
    state: Any
    work: Work

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``, an array of 2n numbers; raises Breakdown."""

    def step(self, until: float | None = None) -> Piece:
        """The solution from ``time`` to the end of the step, where the run is then.

        With ``until`` (later than ``time``) it ends there at the latest, and a step that begins here looks at nothing
        beyond it: so is a place passed where the right-hand side is not smooth.  Raises Breakdown.
        """

    def fill(self, times: Any) -> Any:
        """The states (2n, m) at m increasing times, none before ``time``; the run is then at the last of them.

        Raises Breakdown, with the states that there are.
        """

    def restart(self, time: float, state: Any) -> None:
        """Go on from another state, at any time; what was compiled and the work so far are kept."""


class Method(Protocol):
    """A way to integrate x' = rhs(t, x)."""

    @property
    def traits(self) -> Traits:
        """What it says of itself."""

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> Run:
        """A run from ``initial`` (2n numbers; the scenario's initial state by default) at t = ``at``.

        Compiling happens here, not in ``advance``.
        """


class Unusable(Exception):
    """A method that does not apply here; the message says why and what to use instead."""

    def __init__(self, reason: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
