"""Problem 12, small parameters: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.analysis.small import SmallParameters
from mbsym.model.system import System
from mbsym.report.content import Block, Definitions, Display, Heading, Paragraph, Said, ragged
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import small_parameters as doc
from mbsym.report.expansion_json import expansion_data, measured_data
from mbsym.report.oscillation_json import oscillation_data
from mbsym.report.words import oscillation_words
from mbsym.report.words.expansion_measured import JudgedAverage, averages, flow_measured, oscillation_measured
from mbsym.report.words.expansion_words import (
    Sums,
    coefficients,
    of_averaging,
    of_measured,
    of_none,
    opening,
    sentences,
    summed,
)

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.formulas.formula import Formula
    from mbsym.report.results import Results
    from mbsym.simulation.expanded import Measured
    from mbsym.simulation.oscillating import MeasuredOrders


def data(found: SmallParameters, system: System, write: Write) -> doc.SmallParameters:
    """The section of results.json."""
    slow, wave = found.slow, found.oscillation
    return doc.SmallParameters.from_result(
        found,
        small=found.small or None,
        slow_manifold=None if slow is None else expansion_data(slow, write),
        no_slow_manifold=found.no_slow,
        measured=None if slow is None else measured_data(flow_measured(found, system)),
        oscillation=None if wave is None else oscillation_data(wave, oscillation_measured(found, system)),
        averaged=[_averaging(average, write) for average in averages(found, system)],
    )


def _averaging(judged: JudgedAverage, write: Write) -> doc.Averaged:
    averaging, averaged = judged.one, judged.one.found
    if averaged is None:
        return doc.Averaged(phase=", ".join(averaging.phases), reason=averaging.failure)
    taken: dict[str, Any] = {
        "phase": ", ".join(averaging.phases),
        "rate": ", ".join(averaged.rates),
        "small": list(averaged.small),
        "orders": {**dict.fromkeys(averaged.rates, -1), **dict(averaged.orders)},
        "measured": measured_data(judged.measured),
    }
    if judged.withdrawn:
        return doc.Averaged(**taken, reason="withdrawn: the measured distance does not shrink as it should")
    assert averaging.analysis is not None
    verdict = averaging.analysis.optional("stability")
    word = None if verdict is None or verdict.numerical is None else verdict.numerical.word.value
    return doc.Averaged(
        **taken,
        vibrational=write(averaged.vibrational),
        potential=write(averaged.potential),
        averaged_motion_at_values=word,
    )


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("small-parameters", Said("Problem 12. Small parameters"))
    yield from results.missing(12)
    if 12 in results.found:
        yield from told(results.found[12], results.system)


def told(found: SmallParameters, system: System) -> Iterator[Paragraph | Display | Definitions]:
    """Sentences, and coefficients where they stand between them."""
    yield from map(ragged, of_none(found))
    if found.slow is not None:
        yield from of_slow(found.slow, flow_measured(found, system))
    if found.oscillation is not None:
        yield from of_wave(found.oscillation, oscillation_measured(found, system))
    elif found.small:
        yield from map(ragged, oscillation_words.of_no_oscillation(found.small, found.no_oscillation))
    for average in averages(found, system):
        yield from map(ragged, of_averaging(average))


def of_slow(found: Expansion, measured: Measured | str) -> Iterator[Paragraph | Display]:
    """The slow manifold, the flow on it, and its error."""
    yield from map(ragged, opening(found))
    yield from (Display(x.equation) for x in coefficients(found))
    yield from map(ragged, sentences(found))
    yield from map(ragged, of_measured(found.manifold.field.small, measured))


def of_wave(found: Oscillating, measured: MeasuredOrders | str) -> Iterator[Paragraph | Display | Definitions]:
    """The periodic solution, variables that follow from it, and its error."""
    yield from map(ragged, oscillation_words.opening(found))
    solution, drifts = tuple(oscillation_words.collected(found)), tuple(oscillation_words.drifting(found))
    yield from map(Display, solution)
    letters = oscillation_words.denominators(found, (*solution, *drifts))
    if letters is not None:
        yield letters
    if drifts:
        yield ragged(Said(oscillation_words.DRIFTS))
        yield from map(Display, drifts)
    yield from map(ragged, oscillation_words.sentences(found))
    yield from map(ragged, oscillation_words.measured_sentences(found, measured))


def formulas(found: SmallParameters, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    if found.slow is not None:
        for coefficient in coefficients(found.slow):
            yield f"{coefficient.variable}{chr(39) * coefficient.rate}, order {coefficient.order}", coefficient.formula
    if found.oscillation is not None:
        for one in oscillation_words.coefficients(found.oscillation):
            yield f"periodic solution: {one.variable}{chr(39) * one.rate}, order {one.order}", one.formula
    for each in averages(found, system):
        if each.found is not None:
            over = f"averaged over {', '.join(each.found.phases)} ({each.found.scaling})"
            yield f"effective potential, {over}", each.found.potential
            yield f"what the fast phase adds, {over}", each.found.vibrational


def functions(found: SmallParameters) -> Iterator[Sums]:
    """The series as functions: of the slow variables, of the time."""
    if found.slow is not None:
        field, listed = found.slow.manifold.field, list(coefficients(found.slow))
        for name, flow in (("slow_manifold", False), ("slow_flow", True)):
            yield summed(name, field.small, (x for x in listed if x.flow is flow))
    if found.oscillation is not None:
        yield oscillation_words.as_function(found.oscillation)
