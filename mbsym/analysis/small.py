"""Problem 12 in the pipeline: what is expanded of a description, each part with its result or why there is none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure, NoClosedForm, message_of
from mbsym.analysis.averaged import averaged_system, averaging_of, fast_phases
from mbsym.expressions.message import joined
from mbsym.formulas.formula import Shown
from mbsym.model.system import System
from mbsym.problems.small_parameter.averaging import Averaged
from mbsym.problems.small_parameter.result import Outcome

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.analysis.pipeline import Analysis

#: Slow manifolds are expanded to the first of these orders at which the roots of the flow on it are judged.
ORDERS = (2, 3)
#: Periodic solutions are expanded to this order.
OSCILLATION_ORDER = 2


@dataclass(frozen=True, repr=False)
class Averaging(Shown):
    """The effective potential for fast phases, before it is measured; ``failure``: why there is none.

    ``analysis`` is that of the averaged description, for problem 6.
    """

    phases: tuple[str, ...]
    averaged: Averaged | None = None
    analysis: Analysis | None = None
    failure: str = ""

    @property
    def word_at_values(self) -> str | None:
        """The verdict of problem 6 on the averaged motion at the given values, None where there is none."""
        verdict = None if self.analysis is None else self.analysis.optional("stability")
        return None if verdict is None or verdict.numerical is None else verdict.numerical.word.value


@dataclass(frozen=True, eq=False, repr=False)
class SmallParameters(Shown):
    """``small``: the small parameter, "" where none is named; ``slow`` its slow manifold, or ``no_slow`` why not.

    ``oscillation``: the periodic solution that is led by the variable which the description names as leading, or, where
    there is no slow manifold, by the only one that oscillates where the small parameter is zero; ``no_oscillation``:
    why there is none, with what can be done ("": none was asked for).
    ``averaged``: one for each prescribed quantity whose rate is a parameter, as it is for a fast phase, and one for all
    of them where they are several.
    """

    small: str = ""
    powers: tuple[tuple[str, int], ...] = ()
    slow: Expansion | None = None
    no_slow: str = ""
    averaged: tuple[Averaging, ...] = ()
    oscillation: Oscillating | None = None
    no_oscillation: str = ""

    @property
    def nothing(self) -> bool:
        """Whether the description has nothing to expand in."""
        return not self.small and not self.averaged


def small_parameters_of(analysis: Analysis) -> SmallParameters:
    """Of constraints relations that give coordinates are put in; others stay where a rest is expanded."""
    analysis = analysis.in_free_coordinates
    system = analysis.system
    phases = fast_phases(system)
    if system.small is None and not phases:
        return SmallParameters()
    averaged = tuple(
        _averaging(analysis, combination)
        for combination in dict.fromkeys((*((x,) for x in phases), phases))
        if combination
    )
    if system.small is None:
        return SmallParameters(averaged=averaged)
    slow, missing = _slow(analysis)
    wave, none = _oscillation(analysis) if slow is None or system.small.leading else (None, "")
    return SmallParameters(system.small.name, system.small.powers, slow, missing, averaged, wave, none)


def _oscillation(analysis: Analysis) -> tuple[Oscillating | None, str]:
    from mbsym.analysis.oscillating import oscillating

    try:
        return oscillating(analysis, OSCILLATION_ORDER), ""
    except Failure as reason:
        return None, _with_remedy(reason)
    except ZeroDivisionError as reason:
        return None, message_of(reason)


def _with_remedy(failure: Failure) -> str:
    return joined((failure.reason, failure.remedy), "; ") if failure.remedy else failure.reason


def _slow(analysis: Analysis) -> tuple[Expansion | None, str]:
    from mbsym.analysis.expanding import expansion

    accepted = None
    for order in ORDERS:
        try:
            further = expansion(analysis, order)
        except (Failure, ZeroDivisionError) as reason:
            return (accepted, "") if accepted is not None else (None, message_of(reason))
        decided = further.manifold.steady is None or further.slow[0] is not Outcome.UNDECIDED
        if accepted is None or decided:
            accepted = further
        if decided:
            break
    return accepted, ""


def _averaging(analysis: Analysis, phases: tuple[str, ...]) -> Averaging:
    from mbsym.analysis.pipeline import Analysis as Whole

    try:
        average = averaging_of(analysis, phases)
        broken = analysis.broken(("energy",))
        if broken is not None:
            raise NoClosedForm(broken.reason)
    except Failure as reason:
        return Averaging(phases, failure=_with_remedy(reason))
    averaged: System = averaged_system(analysis.system, average)
    return Averaging(phases, average, Whole(averaged, (6,)))
