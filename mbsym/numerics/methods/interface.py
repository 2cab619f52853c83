"""What an integration method is to the rest: something that starts runs, which advance in time.

``Method`` describes itself (order, fixed step or tolerance, which arithmetic) and starts a ``Run``; a run advances to
the times that it is asked for, or step by step, and counts its work.  A step is a ``Piece`` of the solution, known
everywhere between its ends.  What goes wrong is a ``Breakdown`` with time and state.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any, Protocol, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from mbsym.expressions.message import Message, worded
from mbsym.numerics.compensation import compensated_code
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code, Kernel
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.scenario import Scenario

#: The finest tolerances that compiled methods take: some roundings.
FINEST = {FLOAT32: 5e-7, FLOAT64: 1e-15, EXTENDED: 5e-19}

#: Whatever the unit, no value is followed beyond this: what energies and deviations square is no number soon after.
BOUND = 1e150

#: No error: a value that grew beyond the bound.
BEYOND = Message("a coordinate or velocity is beyond [[bound]]", bound=f"{BOUND:g}")


def within_bound(states: Any) -> Any:
    """Which states (d, ...) are within the bound, shape (...); numbers they are then, too."""
    with np.errstate(invalid="ignore", over="ignore"):  # of single precision all that is finite is within
        return np.all(np.abs(states) < BOUND, axis=0)


class Cause(StrEnum):
    """Why an integration cannot go on."""

    BLOW_UP = "blow-up"
    SINGULAR = "singular mass matrix"
    STEP_LIMIT = "step limit"
    STUCK = "step size too small"
    SINGULAR_SPEEDS = "dependent speeds"  # they do not determine the velocities; coordinates may pass
    SINGULAR_CONSTRAINTS = "singular constraints"  # their rows lose their rank: a mechanism in a singular position
    OUT_OF_REACH = "out of reach"  # constraints that move leave no position: a mechanism stretched out, or blocked
    NOT_SMOOTH = "no finite derivatives"  # the rates are finite: methods that need their derivatives cannot go on
    STOPPED = "stopped by an event"  # no mistake: it was asked for
    UNDEFINED = "no real value"  # a root or a logarithm of a negative number: the model says nothing of such states


class Breakdown(Exception):
    """An integration that cannot go on: ``kind`` says why, at ``time`` in ``state`` (q, q').

    ``told`` is all of it in words; ``filled`` holds the states (2n, j) at the first j of the times that ``Run.fill``
    was asked for.
    """

    def __init__(self, kind: str, message: str, time: Any, state: Any = (), filled: Any = None) -> None:
        self.kind, self.message, self.filled = kind, worded(message), filled
        self.time, self.state = float(time), np.array(state, dtype=float)
        text = "[[kind]] at t = [[time]]: [[message]]"
        self.told = Message(text, kind=Message(kind), time=f"{self.time:.9g}", message=self.message)
        super().__init__(str(self.told))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.message, self.time, self.state, self.filled)


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

    def add(self, now: Work, before: Work) -> None:
        """What another run has done between two looks at its work."""
        for name in COUNTS:
            setattr(self, name, getattr(self, name) + getattr(now, name) - getattr(before, name))

    def too_many(self, time: Any, state: Any) -> Breakdown:
        """The limit of steps is reached."""
        return Breakdown(Cause.STEP_LIMIT, Message("[[count]] steps", count=self.steps), time, state)


@dataclass(frozen=True)
class Traits:
    """What a method says of itself.

    ``order`` is its nominal order (None: variable); ``fixed`` means that it takes a step instead of a tolerance;
    ``scalars`` the arithmetic it runs in; ``conservative`` that it needs forces with a force function;
    ``extra`` the optional package that it needs; ``led`` that between its steps states can be led back to constraints,
    and quaternions and unit vectors to their lengths.  ``interpreted``: about the seconds of an evaluation with its
    share of the linear algebra, of a method outside machine code; ``least`` the finest tolerance that such a one takes.
    """

    name: str
    title: str
    order: int | None
    fixed: bool
    scalars: tuple[str, ...] = ("float64",)
    implicit: bool = False
    conservative: bool = False
    extra: str | None = None
    led: bool = True
    interpreted: float = 0.0
    least: float = 0.0

    @property
    def compiled(self) -> bool:
        """Whether its loop over steps runs in machine code."""
        return not self.interpreted

    def finest(self, scalar: str) -> float:
        """The least tolerance that is not silently taken for a larger one."""
        return max(FINEST[scalar], self.least)


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
    """A method that does not apply here; the message says why and what to use instead.

    ``reason`` is that without the ``method``: it may be one for several.
    """

    def __init__(self, reason: str = "", method: str = "") -> None:
        self.reason = worded(reason)
        super().__init__(Message("[[what]]: [[why]]", what=method, why=self.reason) if method else reason)


# What a run meets on its way that is not smooth, or narrow.


#: So many passages and features are kept one by one, and states inside steps.
MOST_KEPT, MOST_INSIDE = 10_000, 64


@dataclass(frozen=True)
class Narrow:
    """A narrow feature at ``time``, of this ``width``; ``step`` is the length of the step that passed it.

    ``place`` is that of its u among ``Features.narrow``; None where a part of the system was integrated by itself.
    """

    time: float
    width: float
    step: float
    place: int | None

    @property
    def followed(self) -> bool:
        """Whether steps were short beside it."""
        return self.step <= 2 * self.width


@dataclass
class Passed:
    """What a run has met so far: times of switches, narrow features, steps in which switches may have been missed.

    ``inside``: (t, (q, q')) in the middle of a step on each side of the switches that the run has been on, however
    shortly; nan of a coordinate that was integrated by itself.
    """

    switches: list[float] = field(default_factory=list)
    narrow: list[Narrow] = field(default_factory=list)
    unresolved: list[float] = field(default_factory=list)
    inside: list[tuple[float, Any]] = field(default_factory=list)


def met_by(run: Run | None) -> Passed | None:
    """What a run has met; None of a run over what is smooth, and has nothing narrow."""
    passed: Passed | None = getattr(run, "passed", None)
    return passed


def up_to(passed: Passed | None, end: float) -> Passed | None:
    """What was met until ``end``: the last step of a run may go beyond."""
    if passed is None:
        return None
    return Passed(
        [time for time in passed.switches if time <= end],
        [feature for feature in passed.narrow if feature.time - feature.width <= end],
        [time for time in passed.unresolved if time <= end],
        [point for point in passed.inside if point[0] <= end],
    )


def together(runs: Iterable[Run], whole: Iterable[Callable[[Any], Any]]) -> Passed | None:
    """What runs of parts of a system have met; ``whole`` makes of the state of each that of the system."""
    runs = list(runs)
    passages = [met for run in runs if (met := met_by(run)) is not None]
    if not passages:
        return None
    return Passed(
        sorted({time for passed in passages for time in passed.switches}),
        sorted((replace(x, place=None) for passed in passages for x in passed.narrow), key=lambda x: x.time),
        sorted(time for passed in passages for time in passed.unresolved),
        [
            (time, complete(state))
            for run, complete in zip(runs, whole, strict=True)
            for time, state in getattr(met_by(run), "inside", ())
        ],
    )


# What is compiled for a scenario is compiled once, and lives as long as the scenario's dynamics.


#: The codes that are looked at, and which of n coordinates' outputs count.
COMPENSATED = ("right_hand_side", "pivots")


Made = TypeVar("Made")


_KEPT: WeakKeyDictionary[Dynamics, dict[Hashable, Any]] = WeakKeyDictionary()


def machine_code(dynamics: Any, name: str, scalar: str = FLOAT64) -> Code:
    """One of the codes of a Dynamics as the kernels of a scalar take it.

    In float64 what a scene makes sensitive (ratios of masses) is compensated where that is measured to keep digits
    (``mbsym.numerics.compensation``); other arithmetics, other codes, and dynamics without a scenario take the code as
    it is.
    """
    code: Code = getattr(dynamics, name)
    scenario = getattr(dynamics, "scenario", None)
    if scalar != FLOAT64 or name not in COMPENSATED or not isinstance(scenario, Scenario):
        return code
    judged = range(len(code.outputs) // 2 if name == "right_hand_side" else 0, len(code.outputs))
    instructions = [code.program.instructions[number] for number in code.program.live(code.outputs)]
    read = {str(instruction.payload) for instruction in instructions if instruction.operation == "input"} - set(
        code.inputs
    )
    compensation = compensated_code(scenario, replace(code, inputs=(*code.inputs, *sorted(read))), judged)
    return code if compensation is None else replace(compensation.code, inputs=code.inputs)


def once(dynamics: Dynamics, key: Hashable, make: Callable[[], Made]) -> Made:
    """``make()``, or what it made before for the same dynamics and key; it must not hold on to the dynamics."""
    memo = _KEPT.setdefault(dynamics, {})
    if key not in memo:
        memo[key] = make()
    made: Made = memo[key]
    return made


def code_of(dynamics: Dynamics, name: str, scalar: str = FLOAT64) -> Code:
    """A code of a Dynamics as it is compiled, with sensitive operations in pairs; made once."""
    return once(dynamics, ("machine code", name, scalar), lambda: machine_code(dynamics, name, scalar))


def compiled_kernel(dynamics: Dynamics, name: str, scalar: str = FLOAT64) -> Kernel:
    """The kernel of one of the codes of a Dynamics (``right_hand_side``, ``jacobian``, ...)."""

    def make() -> Kernel:
        return kernel(code_of(dynamics, name, scalar), scalar)

    return once(dynamics, ("kernel", name, scalar), make)
