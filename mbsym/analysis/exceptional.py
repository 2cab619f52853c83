"""Problem 11 along one parameter, from an analysis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.failures import NOT_THERE
from mbsym.analysis.higher import ignorable
from mbsym.analysis.judge import Judge
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.expressions.message import Message
from mbsym.problems.stability.word import Word

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.normal_forms.along import Along, Special


def exceptional(
    analysis: Analysis, name: str, interval: tuple[Fraction, Fraction], values: Mapping[str, Fraction]
) -> Along:
    """All exceptional values of a parameter between two numbers, the others at ``values``.

    Raises Unavailable where the system has constraints, is given by matrices or has no motion; NotAlong and what
    expansions raise.
    """
    from mbsym.problems.normal_forms.along import along

    if analysis.system.speeds:
        return exceptional(analysis.in_coordinates, name, interval, values)
    if analysis.system.constraints or analysis.system.linear is not None:
        reason = "it has constraints, or is given by its matrices: normal forms are of neither"
        raise Unavailable("system", NoResult(reason, "", "not supported", "not-supported"))
    with analysis.strictly():
        found = analysis.equilibrium
        analysis.judgeable  # noqa: B018  raises where no theorem applies
    if len(found.conditions) > len(found.solved):
        reason = "the motion exists under conditions that were not solved: parameters are not independent then"
        raise Unavailable("conditions", NoResult(reason, "see problem 4", "conditions", "unsolved-conditions"))
    solved = {one for one, _ in found.solved}
    if name in solved:
        reason = Message("the motion needs one value of [[name]], which the other parameters give", name=name)
        raise Unavailable("conditions", NoResult(reason, "vary another one", "conditions", "solved"))
    conservative, cyclic = ignorable(analysis)
    numbers = {key: value for key, value in values.items() if key != name and key not in solved}
    listed = along(analysis.parameters_scene, analysis.system, found, name, interval, numbers, conservative, cyclic)
    return replace(listed, specials=tuple(_judged(analysis, numbers, name, one) for one in listed.specials))


def _judged(analysis: Analysis, values: Mapping[str, Fraction], name: str, special: Special) -> Special:
    """With what problem 6 says at a rational value that terms of higher order leave open: an energy may decide it."""
    if special.exactly is None or special.judged.outcome.value != Word.UNDECIDED.value:
        return special
    there = {**values, name: special.exactly}
    try:
        verdict = Judge(analysis)(there)
    except NOT_THERE:
        return special
    return special if verdict.word.open else replace(special, verdict=verdict)
