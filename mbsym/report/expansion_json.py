"""A slow manifold as JSON: everything that the terminal shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from mbsym.algebra.quotients import Series
from mbsym.algebra.signs import Condition
from mbsym.analysis.expanding import Expansion
from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.small_parameter.result import Hurwitz, Outcome
from mbsym.report.schemas import version

#: The version of ``schemas/expansion.json`` that it follows.
FORMAT = 1


def expansion_json(system: System, values: Mapping[str, Fraction], found: Expansion) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    manifold = found.manifold
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        "small": manifold.field.small,
        "powers": dict(manifold.field.powers),
        "order": manifold.order,
        "provided_nonzero": [str(x) for x in found.provided],
        "manifold": [
            {"variable": name, "residual": left, "coefficients": _series(found, one)}
            for name, one, left in zip(manifold.fast, manifold.functions, manifold.residuals, strict=True)
        ],
        "flow": [
            {"variable": name, "coefficients": _series(found, one)}
            for name, one in zip(manifold.slow, manifold.flow, strict=True)
        ],
    }
    if manifold.steady is None:
        data["missing"] = found.missing
    else:
        data["steady"] = {
            "zeros": manifold.steady.zeros,
            "divided_up_to": manifold.steady.remainder - 1,
            "attracts": _hurwitz(found, manifold.steady.fast, *found.fast),
            "flow": _hurwitz(found, manifold.steady.slow, *found.slow),
        }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _series(found: Expansion, one: Series) -> list[dict[str, Any]]:
    return [{"order": k, "formula": str(found.formula(one.coefficients[k]))} for k in sorted(one.coefficients)]


def _hurwitz(found: Expansion, one: Hurwitz, outcome: Outcome, conditions: tuple[Condition, ...]) -> dict[str, Any]:
    ring = found.transfer.ring
    positive = [str(Formula(ring, c.polynomial)) for c in conditions if c.kind == "inequality"]
    nonzero = [str(Formula(ring, p)) for c in conditions for p in c.nonzero]
    polynomial = [_series(found, c) for c in one.polynomial]
    return {"outcome": outcome.value, "positive": positive, "nonzero": nonzero, "polynomial": polynomial}
