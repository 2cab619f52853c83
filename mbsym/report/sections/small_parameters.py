"""Problem 12, small parameters: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.analysis.small import SmallParameters
from mbsym.model.system import System
from mbsym.report.content import Block, Display, Heading, Paragraph, Said, ragged
from mbsym.report.documents.results import small_parameters as doc
from mbsym.report.expansion_json import expansion_data, measured_data
from mbsym.report.oscillation_json import oscillation_data
from mbsym.report.plain import Write
from mbsym.report.words import oscillation_words
from mbsym.report.words.expansion_measured import JudgedAverage, averages, flow_measured, oscillation_measured
from mbsym.report.words.expansion_words import coefficients, of_averaging, of_measured, of_none, opening, sentences

if TYPE_CHECKING:
    from mbsym.report.results import Results


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


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("small-parameters", Said("Problem 12. Small parameters"))
    yield from results.missing(12)
    if 12 in results.found:
        yield from told(results.found[12], results.system)


def told(found: SmallParameters, system: System) -> Iterator[Paragraph | Display]:
    """Sentences, and coefficients where they stand between them."""
    yield from map(ragged, of_none(found))
    if found.slow is not None:
        yield from map(ragged, opening(found.slow))
        yield from (Display(x.equation) for x in coefficients(found.slow))
        yield from map(ragged, sentences(found.slow))
        yield from map(ragged, of_measured(found.small, flow_measured(found, system)))
    yield from _wave(found, system)
    for one in averages(found, system):
        yield from map(ragged, of_averaging(one))


def _wave(found: SmallParameters, system: System) -> Iterator[Paragraph | Display]:
    """The periodic solution."""
    told = found.oscillation
    if told is not None:
        yield from map(ragged, oscillation_words.opening(told))
        yield from (Display(x.equation) for x in oscillation_words.coefficients(told))
        yield from map(ragged, oscillation_words.sentences(told))
        yield from map(ragged, oscillation_words.measured_sentences(told, oscillation_measured(found, system)))
    elif found.small:
        yield from map(ragged, oscillation_words.of_no_oscillation(found.small, found.no_oscillation))
