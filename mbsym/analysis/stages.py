"""The machinery beneath the pipeline: results are derived once, on demand, or remembered as missing, with a reason."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from enum import Flag, auto
from importlib import import_module
from typing import Any, Generic, Self, TypeVar, overload

from mbsym.algebra.failures import Defect, Failure, Limit, NotInstalled, Severity, SingularPoint
from mbsym.expressions.guessing import GuessesNames
from mbsym.expressions.message import Message, worded
from mbsym.formulas.letters import letters_as

T = TypeVar("T")
Owner = TypeVar("Owner", bound="Stages")


@dataclass(frozen=True)
class NoResult:
    """Why a stage has no result: ``reason`` in a sentence, ``short`` in a word or two, ``hint`` what to try next.

    ``code`` names the kind of failure, ``limit`` the bound that was met, if any; ``error`` is the exception behind a
    defect.
    """

    reason: str
    hint: str = ""
    short: str = "no closed form"
    code: str = "no-closed-form"
    limit: Limit | None = None
    severity: Severity = Severity.ANSWER
    error: Exception | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "reason", worded(self.reason))
        object.__setattr__(self, "hint", worded(self.hint))

    @staticmethod
    def of(failure: Failure) -> NoResult:
        """The value of a failure that was raised."""
        if isinstance(failure, Unavailable):
            return failure.failure
        if isinstance(failure, SingularPoint):
            hint = "choose another motion or other coordinates"
            return NoResult(Message("singular: [[why]]", why=failure.reason), hint, "singular", failure.code)
        if isinstance(failure, Defect):
            cause = failure.__cause__
            short = "out of memory" if failure.limit is Limit.MEMORY else "internal error"
            error = cause if isinstance(cause, Exception) else failure
            return NoResult(failure.reason, failure.remedy, short, failure.code, failure.limit, failure.severity, error)
        short = _IN_SHORT.get(failure.code, "no result") if failure.limit is None else "no closed form"
        return NoResult(failure.reason, failure.remedy, short, failure.code, failure.limit, failure.severity)


#: In a word or two why there is no answer, where no bound was met: by the kind of failure.
_IN_SHORT = {"constraints": "constraints", NotInstalled.code: "not installed"}


class Unavailable(Failure):
    """Raised when a result is asked for that a stage could not produce; ``failure`` says why.

    Its words are the reason and what to do: names of stages are ours, and say nothing to who asked.
    """

    code = "unavailable"

    def __init__(self, stage: str, failure: NoResult) -> None:
        reason, hint = failure.reason, failure.hint
        sentence = Message("[[reason]] ([[hint]])", reason=reason, hint=hint) if hint else reason
        super().__init__(sentence, limit=failure.limit, remedy=failure.hint)
        self.stage = stage
        self.failure = failure

    @property
    def reason(self) -> Message:
        """Why, without what to do."""
        return worded(self.failure.reason)


@dataclass(frozen=True)
class Stage:
    """What a stage left behind: its value, or its failure, and its own seconds (needed stages not counted)."""

    name: str
    value: Any
    failure: NoResult | None
    seconds: float


class Stages(GuessesNames):
    """Remembers every stage by its name, and which of them are withdrawn because a check they stand on has failed.

    While a stage is being derived the others are taken as they are (a check compares what is derived, right or wrong);
    who asks from outside gets only what has not been withdrawn.
    """

    def __init__(self) -> None:
        self._stages: dict[str, Stage] = {}
        self._nested = 0.0
        self._depth = 0
        self._strict = False
        self._withdrawn: dict[str, NoResult] = {}
        #: Exceptions that nobody foresaw, each contained where it happened.
        self.defects: list[Exception] = []

    def run(self, name: str, compute: Callable[[], Any]) -> Stage:
        """The remembered stage, computed on first demand."""
        if name not in self._stages:
            outer, self._nested = self._nested, 0.0
            started = time.perf_counter()
            value, failure = None, None
            self._depth += 1
            try:
                with letters_as(None):  # what is remembered is in parameters, whoever asks first
                    value = compute()
            except Failure as reason:
                failure = NoResult.of(reason)
            except Exception as error:  # it costs this stage and what needs it, and is told
                failure = NoResult.of(self.contained(error))
            finally:
                self._depth -= 1
            whole = time.perf_counter() - started
            self._stages[name] = Stage(name, value, failure, whole - self._nested)
            self._nested = outer + whole
        return self._stages[name]

    def contained(self, error: Exception) -> Failure:
        """What to say of an exception that nobody foresaw; ``defects`` has it then."""
        failure = Defect.of(error)
        if failure.severity is Severity.DEFECT:
            self.defects.append(error)
        return failure

    def forget(self, stage: Stage) -> None:
        """As if the stage had not been asked for."""
        del self._stages[stage.name]

    def result(self, name: str, compute: Callable[[], Any]) -> Any:
        """The value of a stage.  Raises Unavailable where it has none."""
        stage = self.run(name, compute)
        if stage.failure is not None:
            raise Unavailable(name, stage.failure) from stage.failure.error
        return stage.value

    def stage_of(self, attribute: str) -> Stage:
        """The stage behind an attribute, derived now if it was not before; withdrawn ones have the reason only."""
        with suppress(Unavailable):
            getattr(self, attribute)
        stage = self._stages[attribute]
        withdrawn = self._withdrawn.get(attribute)
        if withdrawn is None or self._depth > 0:
            return stage
        return replace(stage, value=None, failure=withdrawn)

    # --- what stands on checks, and falls with them ---

    def broken(self, names: Sequence[str]) -> NoResult | None:
        """Why what stands on these checks is withdrawn, or None; a pipeline without checks withdraws nothing."""
        return None

    @contextmanager
    def strictly(self) -> Iterator[None]:
        """Whatever is asked for here is vouched for: nothing is taken whose check has failed, not even formulas."""
        depth, strict, self._depth, self._strict = self._depth, self._strict, 0, True
        try:
            yield
        finally:
            self._depth, self._strict = depth, strict

    @contextmanager
    def unvouched(self) -> Iterator[None]:
        """What is asked for here is derived but not yet vouched for, as within a stage; nothing may be said of it."""
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1

    def vouch(self, name: str, stands_on: Sequence[str]) -> None:
        """Raises Unavailable if a check has failed on which the stage of that name stands."""
        if name not in self._withdrawn:
            self._depth += 1
            try:
                broken = self.broken(stands_on)
            finally:
                self._depth -= 1
            if broken is None:  # another check may become possible later
                return
            self._withdrawn[name] = broken
        raise Unavailable(name, self._withdrawn[name])

    def asked_from_outside(self, says: bool) -> bool:
        """Whether a stage has to be vouched for now: one that is said in sentences, or any where it is strict."""
        return self._depth == 0 and (says or self._strict)

    def optional(self, attribute: str) -> Any:
        """A result, or None where there is none."""
        try:
            return getattr(self, attribute)
        except Unavailable:
            return None

    @property
    def derived(self) -> frozenset[str]:
        """The names of the stages that something has asked for so far."""
        return frozenset(self._stages)


def later(module: str, name: str) -> Callable[..., Any]:
    """A function of a module that is imported when it is first called."""

    def call(*arguments: Any) -> Any:
        return getattr(import_module(module), name)(*arguments)

    call.__doc__ = f"See ``{module}.{name}``."
    return call


class Knows(Flag):
    """Which systems a stage takes into account, besides those of bodies in coordinates without constraints.

    What does not know speeds is told in generalised velocities, even where the equations are in speeds.
    """

    COORDINATES = 0
    CONSTRAINTS, SPEEDS, MATRICES = auto(), auto(), auto()
    #: What the equations of motion decide.
    BODIES = CONSTRAINTS | SPEEDS
    ALL = BODIES | MATRICES
    #: What is said of a motion and its stability.
    MOTIONS = CONSTRAINTS | MATRICES


class Derived(Generic[Owner, T]):
    """An attribute of a pipeline that is derived when it is first asked for; its name is that of its stage.

    ``knows``: of which systems it may be asked for.  ``stands_on`` names the checks with which it falls.  What ``says``
    something (a verdict, that a motion is one, that a quantity is conserved) is withdrawn then; formulas stay to be
    looked at, beside the failed check.
    """

    def __init__(
        self,
        derive: Callable[[Owner], T],
        stands_on: Sequence[str] = (),
        says: bool = False,
        knows: Knows = Knows.BODIES,
    ) -> None:
        self.derive, self.knows = derive, knows
        self.stands_on, self.says = tuple(stands_on), says
        self.__doc__ = derive.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, pipeline: None, owner: type) -> Self: ...

    @overload
    def __get__(self, pipeline: Owner, owner: type) -> T: ...

    def __get__(self, pipeline: Owner | None, owner: type) -> Self | T:
        if pipeline is None:
            return self
        value: T = pipeline.result(self.name, lambda: self.derive(pipeline))
        if self.stands_on and pipeline.asked_from_outside(self.says):
            pipeline.vouch(self.name, self.stands_on)
        return value
