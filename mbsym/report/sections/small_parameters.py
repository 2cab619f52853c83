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


def data(small_parameters: SmallParameters, system: System, write: Write) -> doc.SmallParameters:
    """The section of results.json."""
    slow, wave = small_parameters.slow, small_parameters.oscillation
    return doc.SmallParameters.from_result(
        small_parameters,
        small=small_parameters.small or None,
        slow_manifold=None if slow is None else expansion_data(slow, write),
        no_slow_manifold=small_parameters.no_slow,
        measured=None if slow is None else measured_data(flow_measured(small_parameters, system)),
        oscillation=None if wave is None else oscillation_data(wave, oscillation_measured(small_parameters, system)),
        averaged=[_averaging(average, write) for average in averages(small_parameters, system)],
    )


def _averaging(judged: JudgedAverage, write: Write) -> doc.Averaged:
    averaging, averaged = judged.averaging, judged.averaging.averaged
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
    return doc.Averaged(
        **taken,
        vibrational=write(averaged.vibrational),
        potential=write(averaged.potential),
        averaged_motion_at_values=averaging.word_at_values,
    )


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("small-parameters", Said("Problem 12. Small parameters"))
    yield from results.missing(12)
    if 12 in results.by_problem:
        yield from told(results.by_problem[12], results.system)


def told(small_parameters: SmallParameters, system: System) -> Iterator[Paragraph | Display | Definitions]:
    """Sentences, and coefficients where they stand between them."""
    yield from map(ragged, of_none(small_parameters))
    if small_parameters.slow is not None:
        yield from of_slow(small_parameters.slow, flow_measured(small_parameters, system))
    if small_parameters.oscillation is not None:
        yield from of_wave(small_parameters.oscillation, oscillation_measured(small_parameters, system))
    elif small_parameters.small:
        yield from map(
            ragged, oscillation_words.of_no_oscillation(small_parameters.small, small_parameters.no_oscillation)
        )
    for average in averages(small_parameters, system):
        yield from map(ragged, of_averaging(average))


def of_slow(expansion: Expansion, measured: Measured | str) -> Iterator[Paragraph | Display]:
    """The slow manifold, the flow on it, and its error."""
    yield from map(ragged, opening(expansion))
    yield from (Display(x.equation) for x in coefficients(expansion))
    yield from map(ragged, sentences(expansion))
    yield from map(ragged, of_measured(expansion.manifold.field.small, measured))


def of_wave(wave: Oscillating, measured: MeasuredOrders | str) -> Iterator[Paragraph | Display | Definitions]:
    """The periodic solution, variables that follow from it, and its error."""
    yield from map(ragged, oscillation_words.opening(wave))
    solution, drifts = tuple(oscillation_words.collected(wave)), tuple(oscillation_words.drifting(wave))
    yield from map(Display, solution)
    letters = oscillation_words.denominators(wave, (*solution, *drifts))
    if letters is not None:
        yield letters
    if drifts:
        yield ragged(Said(oscillation_words.DRIFTS))
        yield from map(Display, drifts)
    yield from map(ragged, oscillation_words.sentences(wave))
    yield from map(ragged, oscillation_words.measured_sentences(wave, measured))


def formulas(small_parameters: SmallParameters, system: System) -> Iterator[tuple[str, Formula]]:
    """What each formula is, and the formula: those that model.py has."""
    if small_parameters.slow is not None:
        for coefficient in coefficients(small_parameters.slow):
            yield f"{coefficient.variable}{chr(39) * coefficient.rate}, order {coefficient.order}", coefficient.formula
    if small_parameters.oscillation is not None:
        for wave in oscillation_words.coefficients(small_parameters.oscillation):
            yield f"periodic solution: {wave.variable}{chr(39) * wave.rate}, order {wave.order}", wave.formula
    for each in averages(small_parameters, system):
        if each.averaged is not None:
            over = f"averaged over {', '.join(each.averaged.phases)} ({each.averaged.scaling})"
            yield f"effective potential, {over}", each.averaged.potential
            yield f"what the fast phase adds, {over}", each.averaged.vibrational


def functions(small_parameters: SmallParameters) -> Iterator[Sums]:
    """The series as functions: of the slow variables, of the time."""
    if small_parameters.slow is not None:
        field, listed = small_parameters.slow.manifold.field, list(coefficients(small_parameters.slow))
        for name, flow in (("slow_manifold", False), ("slow_flow", True)):
            yield summed(name, field.small, (x for x in listed if x.flow is flow))
    if small_parameters.oscillation is not None:
        yield oscillation_words.as_function(small_parameters.oscillation)
