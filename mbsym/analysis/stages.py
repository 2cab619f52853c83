"""The machinery beneath the pipeline: results are derived once, on demand, or remembered as missing, with a reason."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Generic, Self, TypeVar, overload

from mbsym.algebra.failures import Failure, Limit, Severity, SingularPoint

T = TypeVar("T")
Owner = TypeVar("Owner", bound="Stages")


@dataclass(frozen=True)
class NoResult:
    """Why a stage has no result: ``reason`` in a sentence, ``short`` in a word or two, ``hint`` what to try next.

    ``code`` names the kind of failure, ``limit`` the bound that was met, if any.
    """

    reason: str
    hint: str = ""
    short: str = "no closed form"
    code: str = "no-closed-form"
    limit: Limit | None = None
    severity: Severity = Severity.ANSWER

    @staticmethod
    def of(failure: Failure) -> NoResult:
        """The value of a failure that was raised."""
        if isinstance(failure, Unavailable):
            return failure.failure
        if isinstance(failure, SingularPoint):
            hint = "choose another motion or other coordinates"
            return NoResult(f"singular: {failure}", hint, "singular", failure.code)
        return NoResult(
            failure.reason, failure.remedy, code=failure.code, limit=failure.limit, severity=failure.severity
        )


class Unavailable(Failure):
    """Raised when a result is asked for that a stage could not produce; ``failure`` says why."""

    code = "unavailable"

    def __init__(self, stage: str, failure: NoResult) -> None:
        sentence = f"{stage}: {failure.reason}" + (f" ({failure.hint})" if failure.hint else "")
        super().__init__(sentence, limit=failure.limit, remedy=failure.hint)
        self.failure = failure


@dataclass(frozen=True)
class Stage:
    """What a stage left behind: its value, or its failure, and its own seconds (needed stages not counted)."""

    name: str
    value: Any
    failure: NoResult | None
    seconds: float


class Stages:
    """Remembers every stage by its name."""

    def __init__(self) -> None:
        self._stages: dict[str, Stage] = {}
        self._nested = 0.0

    def run(self, name: str, compute: Callable[[], Any]) -> Stage:
        """The remembered stage, computed on first demand."""
        if name not in self._stages:
            outer, self._nested = self._nested, 0.0
            started = time.perf_counter()
            value, failure = None, None
            try:
                value = compute()
            except Failure as reason:
                failure = NoResult.of(reason)
            whole = time.perf_counter() - started
            self._stages[name] = Stage(name, value, failure, whole - self._nested)
            self._nested = outer + whole
        return self._stages[name]

    def result(self, name: str, compute: Callable[[], Any]) -> Any:
        """The value of a stage.  Raises Unavailable where it has none."""
        stage = self.run(name, compute)
        if stage.failure is not None:
            raise Unavailable(name, stage.failure)
        return stage.value

    def stage_of(self, attribute: str) -> Stage:
        """The stage behind an attribute, derived now if it was not before."""
        with suppress(Unavailable):
            getattr(self, attribute)
        return self._stages[attribute]

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


class Derived(Generic[Owner, T]):
    """An attribute of a pipeline that is derived when it is first asked for; its name is that of its stage."""

    def __init__(self, derive: Callable[[Owner], T]) -> None:
        self.derive = derive
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
        found: T = pipeline.result(self.name, lambda: self.derive(pipeline))
        return found
