"""A slow manifold as JSON: everything that the terminal shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mbsym.algebra.quotients import Series
from mbsym.algebra.signs import Condition
from mbsym.analysis.expanding import Expansion
from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Hurwitz, Outcome
from mbsym.report.documents.writer import version
from mbsym.report.plain import Write

if TYPE_CHECKING:
    from mbsym.simulation.averaged import Measured as MeasuredAverage
    from mbsym.simulation.expanded import Measured

#: The version of ``schemas/expansion.json`` that it follows.
FORMAT = 1


def expansion_json(
    system: System, values: Mapping[str, Fraction], found: Expansion, measured: Measured | str = ""
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        **expansion_data(found, str),
        "measured": measured_data(measured),
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def expansion_data(found: Expansion, write: Write) -> dict[str, Any]:
    """A slow manifold; ``write`` turns formulas into text."""
    manifold = found.manifold
    data: dict[str, Any] = {
        "small": manifold.field.small,
        "powers": dict(manifold.field.powers),
        "order": manifold.order,
        "provided_nonzero": [write(x) for x in found.provided],
        "manifold": [
            {"variable": name, "residual": left, "coefficients": _series(found, one, write)}
            for name, one, left in zip(manifold.fast, manifold.functions, manifold.residuals, strict=True)
        ],
        "flow": [
            {"variable": name, "coefficients": _series(found, one, write)}
            for name, one in zip(manifold.slow, manifold.flow, strict=True)
        ],
    }
    if manifold.steady is None:
        data["missing"] = found.missing
    else:
        data["steady"] = {
            "zeros": manifold.steady.zeros,
            "divided_up_to": manifold.steady.remainder - 1,
            "attracts": _hurwitz(found, manifold.steady.fast, *found.fast, write),
            "flow": _hurwitz(found, manifold.steady.slow, *found.slow, write),
        }
    return data


def measured_data(told: Measured | MeasuredAverage | str) -> dict[str, Any]:
    """A measurement in two digits, so that it is the same wherever it is made; ``reason``: why there is none."""
    if isinstance(told, str):
        return {"reason": told}
    return {
        "time": float(f"{told.time:.4g}"),
        "parts": [str(part) for part in told.parts],
        "distances": [float(f"{x:.2g}") for x in told.distances],
        "orders": [round(x, 1) for x in told.orders],
        "expected": told.expected,
    }


def _series(found: Expansion, one: Series, write: Write) -> list[dict[str, Any]]:
    return [{"order": k, "formula": write(found.formula(one.coefficients[k]))} for k in sorted(one.coefficients)]


def _hurwitz(
    found: Expansion, one: Hurwitz, outcome: Outcome, conditions: tuple[Condition, ...], write: Write
) -> dict[str, Any]:
    ring = found.transfer.ring
    positive = [write(Formula(ring, c.polynomial)) for c in conditions if c.kind == "inequality"]
    nonzero = [write(Formula(ring, p)) for c in conditions for p in c.nonzero]
    polynomial = [_series(found, c, write) for c in one.polynomial]
    return {"outcome": outcome.value, "positive": positive, "nonzero": nonzero, "polynomial": polynomial}
