"""What a run meets on its way that is not smooth, or narrow."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from mbsym.numerics.methods.interface import Run

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
    found: Passed | None = getattr(run, "passed", None)
    return found


def up_to(passed: Passed | None, end: float) -> Passed | None:
    """What was met until ``end``: the last step of a run may go beyond."""
    if passed is None:
        return None
    return Passed(
        [time for time in passed.switches if time <= end],
        [one for one in passed.narrow if one.time - one.width <= end],
        [time for time in passed.unresolved if time <= end],
        [one for one in passed.inside if one[0] <= end],
    )


def together(runs: Iterable[Run], whole: Iterable[Callable[[Any], Any]]) -> Passed | None:
    """What runs of parts of a system have met; ``whole`` makes of the state of each that of the system."""
    runs = list(runs)
    found = [one for run in runs if (one := met_by(run)) is not None]
    if not found:
        return None
    return Passed(
        sorted({time for one in found for time in one.switches}),
        sorted((replace(x, place=None) for one in found for x in one.narrow), key=lambda x: x.time),
        sorted(time for one in found for time in one.unresolved),
        [
            (time, complete(state))
            for run, complete in zip(runs, whole, strict=True)
            for time, state in getattr(met_by(run), "inside", ())
        ],
    )
