"""A periodic solution in powers of a small parameter as JSON: everything that the terminal shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from msgspec import UNSET, UnsetType

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Harmonics, Phase, multiples
from mbsym.report.documents import oscillations as doc
from mbsym.report.documents.base import file_of, finite
from mbsym.report.words.expansion_words import sum_of_powers
from mbsym.report.words.oscillation_words import numerator

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.simulation.oscillating import MeasuredOrders


def oscillations_json(
    system: System, values: Mapping[str, Fraction], solution: Oscillating, measured: MeasuredOrders | str
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    return file_of(doc.Oscillations, system, oscillation_data(solution, measured), values=values)


def oscillation_data(solution: Oscillating, measured: MeasuredOrders | str) -> doc.Oscillation:
    """A periodic solution; formulas in Python syntax."""
    oscillation = solution.oscillation

    def text(x: Any) -> str:
        return str(solution.formula(x))

    # The ring grows as formulas are made, and their shape with it: in the order of the file.
    return doc.Oscillation.from_result(
        oscillation,
        phase=solution.phase,
        amplitude=_amplitude(solution),
        exponent=_exponent(solution),
        constants=[(name, text(x)) for name, x in oscillation.constants],
        **_turning(solution, oscillation.phases[0]),
        further_phases=[
            doc.FurtherPhase(
                phase=name, leading=phase.leading, amplitude=text(phase.amplitude), **_turning(solution, phase)
            )
            for name, phase in zip(solution.phases[1:], oscillation.phases[1:], strict=True)
        ]
        or UNSET,
        solution=[
            doc.Solution(
                variable=name,
                residual=left,
                function=_function(solution, name, series),
                coefficients=_series(solution, series),
            )
            for name, series, left in zip(oscillation.names, oscillation.series, oscillation.residuals, strict=False)
        ],
        drifts=[
            (drift.variable, list(map(text, drift.rates)), _series(solution, drift.waves))
            for drift in oscillation.drifts
        ],
        resonances=[
            doc.Resonance.from_result(
                divisor,
                harmonic=_multiples(divisor.harmonic, len(solution.phases)),
                vanishes=str(numerator(solution, divisor.value)),
                vanishes_too=UNSET if divisor.damping is None else str(numerator(solution, divisor.damping)),
            )
            for divisor in oscillation.divisors
        ],
        left_out=[(names, text(x)) for names, x in oscillation.others],
        taylor=solution.taylor,
        conditions=[str(x) for x in _positive(solution)],
        measured=measured_data(measured),
    )


def _turning(solution: Oscillating, phase: Phase) -> dict[str, Any]:
    """The frequency, its corrections, and the rate that they make."""
    rates = [phase.frequency * x for x in (solution.oscillation.tower.one, *phase.corrections)]
    texts = [(n, str(solution.formula(x))) for n, x in enumerate(rates) if not x.is_zero()]
    return {
        "frequency": str(solution.formula(phase.frequency)),
        "corrections": [str(solution.formula(x)) for x in phase.corrections],
        "phase_rate": sum_of_powers(texts, solution.oscillation.small, "**"),
    }


def _multiples(k: int, phases: int) -> int | list[int]:
    """One number of one phase."""
    return k if phases == 1 else list(multiples(k, phases))


def _amplitude(solution: Oscillating) -> doc.AmplitudeValue:
    oscillation, others = solution.oscillation, solution.oscillation.other_amplitudes
    value = str(solution.formula(oscillation.amplitude))
    return doc.AmplitudeValue(oscillation.kind, value, UNSET if others is None else str(solution.formula(others)))


def _exponent(solution: Oscillating) -> doc.CycleExponent | UnsetType:
    if solution.oscillation.exponent is None:
        return UNSET
    power, x = solution.oscillation.exponent
    return doc.CycleExponent(power, str(solution.formula(x)), UNSET if solution.attracts is None else solution.attracts)


def _positive(solution: Oscillating) -> Iterator[Formula]:
    """Squares that have to be positive for frequency and amplitude to be real, and are not known to be."""
    oscillation = solution.oscillation
    for phase in oscillation.phases:
        if not solution.real:
            yield solution.formula(phase.frequency * phase.frequency)
    if not solution.real_amplitude:
        yield solution.formula(oscillation.amplitude * oscillation.amplitude)


def measured_data(measured: MeasuredOrders | str) -> doc.Measured:
    """A measurement in two digits, so that it is the same wherever it is made; ``reason``: why there is none."""
    if isinstance(measured, str):
        return doc.Measured(reason=measured)
    return doc.Measured(
        small=measured.small,
        time=float(f"{measured.time:.4g}"),
        parts=[str(x) for x in measured.parts],
        relative=[_two_digits(x) for x in measured.relative],
        errors=[
            doc.Error(
                variable=name, errors=[_two_digits(x) for x in errors], order=None if order is None else round(order, 2)
            )
            for name, errors, order in zip(measured.names, measured.errors, measured.orders, strict=True)
        ],
    )


def _two_digits(error: float) -> float | None:
    return finite(float(f"{error:.2g}"))


def _function(solution: Oscillating, name: str, series: Sequence[Harmonics]) -> str:
    """The variable itself, which the series stand for without its power of the small parameter."""
    shift = dict(solution.oscillation.powers).get(name, 0)
    parts = [(n + shift, solution.written(harmonics)) for n, harmonics in enumerate(series) if not harmonics.is_zero]
    return sum_of_powers(parts, solution.oscillation.small, "**") or "0"


def _series(solution: Oscillating, series: Sequence[Harmonics]) -> list[doc.WaveCoefficient]:
    return [
        doc.WaveCoefficient(order=n, formula=solution.written(harmonics))
        for n, harmonics in enumerate(series)
        if not harmonics.is_zero
    ]
