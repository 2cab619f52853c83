"""A periodic solution in powers of a small parameter as JSON: everything that the terminal shows."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.harmonics import Harmonics
from mbsym.report.documents.writer import version
from mbsym.report.oscillation_words import numerator

if TYPE_CHECKING:
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.simulation.oscillating import MeasuredOrders

#: The version of ``schemas/oscillations.json`` that it follows.
FORMAT = 1


def oscillations_json(
    system: System, values: Mapping[str, Fraction], told: Oscillating, measured: MeasuredOrders | str
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        **oscillation_data(told),
        "measured": measured_data(measured),
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def oscillation_data(told: Oscillating) -> dict[str, Any]:
    """A periodic solution; formulas in Python syntax."""
    found = told.found
    return {
        "small": found.small,
        "powers": dict(found.powers),
        "order": found.order,
        "leading": found.leading,
        "phase": told.phase,
        "amplitude": _amplitude(told),
        "constants": [{"variable": name, "value": str(told.formula(x))} for name, x in found.constants],
        "frequency": str(told.formula(found.frequency)),
        "corrections": [str(told.formula(x)) for x in found.corrections],
        "solution": [
            {"variable": name, "residual": left, "coefficients": _series(told, one)}
            for name, one, left in zip(found.names, found.series, found.residuals, strict=False)
        ],
        "drifts": [
            {
                "variable": one.variable,
                "rates": [str(told.formula(x)) for x in one.rates],
                "coefficients": _series(told, one.waves),
            }
            for one in found.drifts
        ],
        "resonances": [
            {
                "variables": list(one.variables),
                "harmonic": one.harmonic,
                "order": one.order,
                "vanishes": str(numerator(told, one.value)),
                **({} if one.damping is None else {"vanishes_too": str(numerator(told, one.damping))}),
            }
            for one in found.divisors
        ],
        "left_out": [{"variables": list(names), "square": str(told.formula(x))} for names, x in found.others],
        "forced": [list(names) for names in found.damped],
        "with_root_zero": [list(names) for names in found.with_zero],
        "roots_not_found": [list(names) for names in found.not_known],
        "taylor": told.taylor,
        "conditions": [str(x) for x in _positive(told)],
    }


def _amplitude(told: Oscillating) -> dict[str, str]:
    found, others = told.found, told.found.other_amplitudes
    data = {"kind": found.kind.value, "value": str(told.formula(found.amplitude))}
    return data if others is None else data | {"others": str(told.formula(others))}


def _positive(told: Oscillating) -> Iterator[Formula]:
    """Squares that have to be positive for frequency and amplitude to be real, and are not known to be."""
    found = told.found
    if not told.real:
        yield told.formula(found.frequency * found.frequency)
    if not told.real_amplitude:
        yield told.formula(found.amplitude * found.amplitude)


def measured_data(measured: MeasuredOrders | str) -> dict[str, Any]:
    """A measurement in two digits, so that it is the same wherever it is made; ``reason``: why there is none."""
    if isinstance(measured, str):
        return {"reason": measured}
    return {
        "small": measured.small,
        "time": float(f"{measured.time:.4g}"),
        "parts": [str(x) for x in measured.parts],
        "errors": [
            {
                "variable": name,
                "errors": [float(f"{x:.2g}") for x in errors],
                "order": None if order is None else round(order, 2),
            }
            for name, errors, order in zip(measured.names, measured.errors, measured.orders, strict=True)
        ],
    }


def _series(told: Oscillating, series: Sequence[Harmonics]) -> list[dict[str, Any]]:
    return [{"order": n, "formula": told.written(one)} for n, one in enumerate(series) if not one.is_zero]
