"""A periodic solution in powers of a small parameter as JSON: everything that the terminal shows."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from mbsym.analysis.oscillating import Oscillating
from mbsym.model.system import System
from mbsym.problems.small_parameter.harmonics import Harmonics
from mbsym.report.oscillation_words import numerator
from mbsym.report.schemas import version
from mbsym.simulation.oscillating import MeasuredOrders

#: The version of ``schemas/oscillations.json`` that it follows.
FORMAT = 1


def oscillations_json(
    system: System, values: Mapping[str, Fraction], told: Oscillating, measured: MeasuredOrders | None, missing: str
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    found = told.found
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        "small": found.small,
        "powers": dict(found.powers),
        "order": found.order,
        "leading": found.leading,
        "phase": told.phase,
        "amplitude": {"kind": found.kind.value, "value": str(told.formula(found.amplitude))},
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
            }
            for one in found.divisors
        ],
        "left_out": [{"variables": list(names), "square": str(told.formula(x))} for names, x in found.others],
        "forced": [list(names) for names in found.damped],
        "taylor": told.taylor,
    }
    if measured is None:
        data["not_measured"] = missing
    else:
        data["measured"] = {
            "small": measured.small,
            "time": measured.time,
            "parts": [str(x) for x in measured.parts],
            "errors": [
                {"variable": name, "errors": list(errors), "order": order}
                for name, errors, order in zip(measured.names, measured.errors, measured.orders, strict=True)
            ],
        }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _series(told: Oscillating, series: Sequence[Harmonics]) -> list[dict[str, Any]]:
    return [{"order": n, "formula": told.written(one)} for n, one in enumerate(series) if not one.is_zero]
