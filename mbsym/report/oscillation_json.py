"""A periodic solution in powers of a small parameter as JSON: everything that the terminal shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from msgspec import UNSET, UnsetType

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Harmonics
from mbsym.report.documents import oscillations as doc
from mbsym.report.documents.base import finite, written
from mbsym.report.words.expansion_words import sum_of_powers
from mbsym.report.words.oscillation_words import numerator

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.simulation.oscillating import MeasuredOrders


def oscillations_json(
    system: System, values: Mapping[str, Fraction], told: Oscillating, measured: MeasuredOrders | str
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    return written(doc.Oscillations.from_result(oscillation_data(told, measured), system=system.name, values=values))


def oscillation_data(told: Oscillating, measured: MeasuredOrders | str) -> doc.Oscillation:
    """A periodic solution; formulas in Python syntax."""
    oscillation = told.found

    def text(x: Any) -> str:
        return str(told.formula(x))

    # The ring grows as formulas are made, and their shape with it: in the order of the file.
    return doc.Oscillation.from_result(
        oscillation,
        phase=told.phase,
        amplitude=_amplitude(told),
        exponent=_exponent(told),
        constants=[(name, text(x)) for name, x in oscillation.constants],
        frequency=text(oscillation.frequency),
        corrections=list(map(text, oscillation.corrections)),
        phase_rate=sum_of_powers(
            (
                (n, text(oscillation.frequency * x))
                for n, x in enumerate((oscillation.tower.one, *oscillation.corrections))
                if not x.is_zero()
            ),
            oscillation.small,
            "**",
        ),
        solution=[
            doc.Solution(
                variable=name, residual=left, function=_function(told, name, one), coefficients=_series(told, one)
            )
            for name, one, left in zip(oscillation.names, oscillation.series, oscillation.residuals, strict=False)
        ],
        drifts=[(one.variable, list(map(text, one.rates)), _series(told, one.waves)) for one in oscillation.drifts],
        resonances=[
            doc.Resonance.from_result(
                divisor,
                vanishes=str(numerator(told, divisor.value)),
                vanishes_too=UNSET if divisor.damping is None else str(numerator(told, divisor.damping)),
            )
            for divisor in oscillation.divisors
        ],
        left_out=[(names, text(x)) for names, x in oscillation.others],
        taylor=told.taylor,
        conditions=[str(x) for x in _positive(told)],
        measured=measured_data(measured),
    )


def _amplitude(told: Oscillating) -> doc.AmplitudeValue:
    oscillation, others = told.found, told.found.other_amplitudes
    value = str(told.formula(oscillation.amplitude))
    return doc.AmplitudeValue(oscillation.kind, value, UNSET if others is None else str(told.formula(others)))


def _exponent(told: Oscillating) -> doc.CycleExponent | UnsetType:
    if told.found.exponent is None:
        return UNSET
    power, x = told.found.exponent
    return doc.CycleExponent(power, str(told.formula(x)), UNSET if told.attracts is None else told.attracts)


def _positive(told: Oscillating) -> Iterator[Formula]:
    """Squares that have to be positive for frequency and amplitude to be real, and are not known to be."""
    oscillation = told.found
    if not told.real:
        yield told.formula(oscillation.frequency * oscillation.frequency)
    if not told.real_amplitude:
        yield told.formula(oscillation.amplitude * oscillation.amplitude)


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
                variable=name,
                errors=[_two_digits(x) for x in errors],
                order=None if order is None else round(order, 2),
            )
            for name, errors, order in zip(measured.names, measured.errors, measured.orders, strict=True)
        ],
    )


def _two_digits(error: float) -> float | None:
    return finite(float(f"{error:.2g}"))


def _function(told: Oscillating, name: str, series: Sequence[Harmonics]) -> str:
    """The variable itself, which the series stand for without its power of the small parameter."""
    shift = dict(told.found.powers).get(name, 0)
    parts = [(n + shift, told.written(harmonics)) for n, harmonics in enumerate(series) if not harmonics.is_zero]
    return sum_of_powers(parts, told.found.small, "**") or "0"


def _series(told: Oscillating, series: Sequence[Harmonics]) -> list[doc.WaveCoefficient]:
    return [doc.WaveCoefficient(order=n, formula=told.written(one)) for n, one in enumerate(series) if not one.is_zero]
