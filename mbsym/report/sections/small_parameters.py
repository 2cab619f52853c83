"""Problem 12, small parameters: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.analysis.small import SmallParameters
from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.report.documents.results import small_parameters as doc
from mbsym.report.expansion_json import expansion_data, measured_data
from mbsym.report.oscillation_json import oscillation_data
from mbsym.report.plain import LONGEST, Write
from mbsym.report.words import oscillation_words
from mbsym.report.words.expansion_measured import JudgedAverage, averages, flow_measured, oscillation_measured
from mbsym.report.words.expansion_words import (
    Medium,
    coefficients,
    of_averaging,
    of_measured,
    of_none,
    opening,
    sentences,
)
from mbsym.report.words.said import Said, filled

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: SmallParameters, system: System, write: Write) -> doc.SmallParameters:
    """The section of results.json."""
    slow, wave = found.slow, found.oscillation
    return doc.SmallParameters(
        small=found.small or None,
        powers=dict(found.powers),
        slow_manifold=None if slow is None else expansion_data(slow, write),
        no_slow_manifold=found.no_slow,
        measured=None if slow is None else measured_data(flow_measured(found, system)),
        oscillation=None if wave is None else oscillation_data(wave, oscillation_measured(found, system)),
        no_oscillation=found.no_oscillation,
        averaged=[_averaging(one, write) for one in averages(found, system)],
    )


def _averaging(judged: JudgedAverage, write: Write) -> doc.Averaged:
    one, found = judged.one, judged.one.found
    if found is None:
        return doc.Averaged(phase=one.phase, reason=one.failure)
    taken: dict[str, Any] = {
        "phase": one.phase,
        "rate": found.rate,
        "small": list(found.small),
        "orders": {found.rate: -1, **dict(found.orders)},
        "measured": measured_data(judged.measured),
    }
    if judged.withdrawn:
        return doc.Averaged(**taken, reason="withdrawn: the measured distance does not shrink as it should")
    assert one.analysis is not None
    verdict = one.analysis.optional("stability")
    word = None if verdict is None or verdict.numerical is None else verdict.numerical.word.value
    return doc.Averaged(
        **taken,
        vibrational=write(found.vibrational),
        potential=write(found.potential),
        averaged_motion_at_values=word,
    )


def told(found: SmallParameters, system: System, write: Medium) -> Iterator[Said | list[Any]]:
    """Sentences, and lists of coefficients where they stand between them."""
    yield from of_none(found, write)
    if found.slow is not None:
        yield from opening(found.slow, write)
        yield list(coefficients(found.slow))
        yield from sentences(found.slow, write)
        yield from of_measured(found.small, flow_measured(found, system), write)
    yield from _wave(found, system, write)
    for one in averages(found, system):
        yield from of_averaging(one, write)


def _wave(found: SmallParameters, system: System, write: Medium) -> Iterator[Said | list[Any]]:
    """The periodic solution."""
    told = found.oscillation
    if told is not None:
        yield from oscillation_words.opening(told, write)
        yield list(oscillation_words.coefficients(told))
        yield from oscillation_words.sentences(told, write)
        yield from oscillation_words.measured_sentences(told, oscillation_measured(found, system), write)
    elif found.small:
        yield from oscillation_words.of_no_oscillation(found.small, found.no_oscillation, write)


def lines(found: SmallParameters, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    for one in told(found, analysis.system, SHORT):
        if isinstance(one, list):
            yield from (f"  {x.variable}{mark(x.rate)}({x.order}) = {short(x.formula)}" for x in one)
        else:
            yield filled(one)


def mark(rate: bool) -> str:
    """What a rate has behind the name of its variable."""
    return "'" if rate else ""


def short(x: Formula) -> str:
    text = str(x)
    return text if len(text) <= LONGEST else f"({x.terms} terms; see the reports)"


SHORT = Medium(names=", ".join, formula=short, condition=lambda x, relation: f"{short(x)} {relation} 0", word=str)
#: The same, nothing shortened.
PLAIN = Medium(names=", ".join, formula=str, condition=lambda x, relation: f"{x} {relation} 0", word=str)
