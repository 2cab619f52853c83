"""Symmetries as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from mbsym.formulas.formula import Formula
from mbsym.model.system import System
from mbsym.problems.symmetries import Symmetries, Symmetry
from mbsym.report.documents.writer import version

#: The version of ``schemas/symmetries.json`` that it follows.
FORMAT = 1


def symmetries_json(system: System, values: Mapping[str, Fraction], found: Symmetries) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        **symmetries_data(found, str),
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def symmetries_data(found: Symmetries, write: Callable[[Formula], Any]) -> dict[str, Any]:
    """What is found, without what it belongs to."""
    return {
        "directions": "speeds" if found.in_speeds else "coordinates",
        "complete": found.complete,
        "symmetries": [_one(one, write) for one in found.symmetries],
    }


def _one(one: Symmetry, write: Callable[[Formula], Any]) -> dict[str, Any]:
    return {
        "field": {name: write(xi) for name, xi in one.directions},
        "time": write(one.time),
        "gauge": write(one.gauge),
        "integral": write(one.integral),
        "name": one.name,
        "new": one.is_new,
        "told_apart": one.certainty.value,
        "substituted": one.substituted.value,
    }
