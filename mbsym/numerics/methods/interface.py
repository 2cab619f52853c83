"""What an integration method is to the rest: something that starts runs, which advance in time.

``Method`` describes itself (order, fixed step or tolerance, which arithmetic) and starts a ``Run``; a run advances to
the times that it is asked for and counts its work.  What goes wrong is a ``Breakdown`` with time and state.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from mbsym.numerics.dynamics import Dynamics

#: Where a step vanishes, rates beyond this mean a blow-up.
LARGEST = 1e12


class Breakdown(Exception):
    """An integration that cannot go on: ``kind`` says why, at ``time`` in ``state`` (q, q')."""

    def __init__(self, kind: str, message: str, time: float, state: Any) -> None:
        super().__init__(f"{kind} at t = {time:.9g}: {message}")
        self.kind, self.message, self.time, self.state = kind, message, time, state


BLOW_UP, SINGULAR, STEP_LIMIT, STUCK = "blow-up", "singular mass matrix", "step limit", "step size too small"

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


@dataclass
class Work:
    """What a run has cost so far."""

    evaluations: int = 0
    jacobians: int = 0
    steps: int = 0
    rejected: int = 0


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


class Run(Protocol):
    """One integration under way; ``state`` belongs to ``time``."""

    time: float
    state: Any
    work: Work

    def advance(self, until: float) -> Any:
        """The state (q, q') at ``until``, an array of 2n numbers; raises Breakdown."""


class Method(Protocol):
    """A way to integrate x' = rhs(t, x)."""

    @property
    def traits(self) -> Traits:
        """What it says of itself."""

    def start(self, dynamics: Dynamics, setting: Setting, scalar: str = "float64") -> Run:
        """A run from the scenario's initial state at t = 0.  Compiling happens here, not in ``advance``."""


class Unusable(Exception):
    """A method that does not apply here; the message says why and what to use instead."""

    def __init__(self, reason: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
