"""Symmetries as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from mbsym.model.system import System
from mbsym.problems.symmetries import Symmetries, Symmetry
from mbsym.report.schemas import version

#: The version of ``schemas/symmetries.json`` that it follows.
FORMAT = 1


def symmetries_json(system: System, values: Mapping[str, Fraction], found: Symmetries) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        "directions": "speeds" if found.in_speeds else "coordinates",
        "complete": found.complete,
        "symmetries": [_one(one) for one in found.symmetries],
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _one(one: Symmetry) -> dict[str, Any]:
    return {
        "field": {name: str(xi) for name, xi in one.directions},
        "time": str(one.time),
        "gauge": str(one.gauge),
        "integral": str(one.integral),
        "name": one.name,
        "new": one.is_new,
        "told_apart": one.sure.value,
        "substituted": one.substituted.value,
    }
