"""Polynomial integrals as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from mbsym.analysis.polynomial import Setting
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals import PolynomialIntegrals
from mbsym.report.schemas import version

#: The version of ``schemas/integrals.json`` that it follows.
FORMAT = 1


def integrals_json(system: System, values: Mapping[str, Fraction], there: Setting, found: PolynomialIntegrals) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        **integrals_data(there, found),
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def integrals_data(there: Setting, found: PolynomialIntegrals) -> dict[str, Any]:
    """What is found, without what it belongs to."""
    return {
        "degree": found.degree,
        "weights": dict(zip(found.field.variables, found.grading.weights, strict=True)),
        "quasi_homogeneous": found.grading.homogeneous,
        "complete": found.complete,
        "independent": found.independent,
        "integrals": [
            {
                "weight": one.weight,
                "name": one.name,
                "new": one.is_new,
                "formula": str(there.formula(one.polynomial)),
                "independent": one.independent,
                "independence": one.sure.value,
            }
            for one in found.generators
        ],
        "counts": [
            {"weight": one.weight, "monomials": one.monomials, "at_most": one.most, "found": one.products}
            for one in found.counts
        ],
    }
