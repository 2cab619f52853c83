"""Polynomial integrals as JSON: everything that the table shows, as codes and formulas."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from mbsym.analysis.invariant_relations import InvariantRelations
from mbsym.analysis.polynomial import Setting
from mbsym.model.system import System
from mbsym.problems.polynomial_integrals import (
    Along,
    Cases,
    DarbouxAlong,
    DarbouxPolynomials,
    OnLevel,
    OtherLevels,
    PolynomialIntegrals,
    Relations,
    Special,
    ZeroLevels,
)
from mbsym.report.documents.writer import version

#: The version of ``schemas/integrals.json`` that it follows.
FORMAT = 1


def integrals_json(
    system: System,
    values: Mapping[str, Fraction],
    there: Setting,
    found: PolynomialIntegrals,
    line: Along | None = None,
    special: Cases | None = None,
    invariant: InvariantRelations | None = None,
    at: DarbouxAlong | None = None,
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "values": {name: str(value) for name, value in values.items()},
        **integrals_data(there, found),
        "along": None if line is None else _along(there, line),
        "cases": None if special is None else _cases(there, special),
        "relations": None if invariant is None else _relations(there, invariant.linear),
        "darboux": None if invariant is None else _darboux(there, invariant.darboux),
        "darboux_along": None if at is None else _darboux_along(there, at),
        "zero_levels": None if invariant is None else _levels(there, invariant.levels),
        "other_levels": None if invariant is None else _others(there, invariant.others),
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
        "not_contained": list(found.aside),
        "integrals": [
            {
                "weight": one.weight,
                "name": one.name,
                "new": one.is_new,
                "formula": str(there.formula(one.polynomial)),
                "independent": one.independent,
                "independence": one.certainty.value,
            }
            for one in found.generators
        ],
        "counts": [
            {"weight": one.weight, "monomials": one.monomials, "at_most": one.most, "found": one.products}
            for one in found.counts
        ],
    }


def _along(there: Setting, line: Along) -> dict[str, Any]:
    return {
        "parameter": line.name,
        "low": str(line.low),
        "high": str(line.high),
        "values": [{"value": str(one.value), **_special(there, one)} for one in line.values],
        "undecided_at": [str(one) for one in line.undecided],
        "undecided_at_zeros_of": [[str(c) for c in p.coeffs()] for p in line.irrational],
        "weights": None if line.weights is None else dict(zip(there.field.variables, line.weights, strict=True)),
        "no_others": line.whole,
        "no_other_rational": line.usual,
    }


def _cases(there: Setting, special: Cases) -> dict[str, Any]:
    return {
        "families": special.families,
        "families_left": special.left,
        "conditions_not_found": special.unread,
        "cases": [
            {"vanishing": [str(there.formula(p)) for p in case.conditions], **_special(there, case.special)}
            for case in special.cases
        ],
    }


def _relations(there: Setting, linear: Relations) -> dict[str, Any]:
    def write(polynomials: Iterable[Any]) -> list[str]:
        return [str(there.formula(p)) for p in polynomials]

    return {
        "complete": linear.complete,
        "relations": [
            {
                "formula": str(there.formula(one.polynomial)),
                "vanishing": write(one.conditions),
                "nonzero": write(one.nonzero),
            }
            for one in linear.relations
        ],
    }


def _darboux(there: Setting, found: DarbouxPolynomials) -> dict[str, Any]:
    def factor(p: Any) -> str:
        return str(there.quotient(p, there.field.denominator))

    return {
        "degree": found.degree,
        "weights": dict(zip(there.field.variables, found.weights, strict=True)),
        "complete": found.complete,
        "obstacle": None if found.obstacle is None else found.obstacle.value,
        "polynomials": [
            {
                "weight": one.weight,
                "formula": str(there.formula(one.polynomial)),
                "cofactor": factor(one.cofactor),
                "defined": one.defined,
            }
            for one in found.polynomials
        ],
        "not_found": [
            {"weight": one.weight, "cofactor": factor(one.cofactor), "at_most": one.most - one.products}
            for one in found.counts
            if not one.complete
        ],
    }


def _darboux_along(there: Setting, found: DarbouxAlong) -> dict[str, Any]:
    return {
        "parameter": found.name,
        "low": str(found.low),
        "high": str(found.high),
        "values": [
            {
                "value": str(one.value),
                "polynomials": [
                    {
                        "weight": f.weight,
                        "formula": str(there.formula(f.polynomial)),
                        "cofactor": str(there.quotient_over(one.field, f.cofactor)),
                        "defined": f.defined,
                    }
                    for f in one.polynomials
                ],
                "complete": one.complete,
            }
            for one in found.values
        ],
        "undecided_at": [str(one) for one in found.undecided],
        "undecided_at_zeros_of": [[str(c) for c in p.coeffs()] for p in found.irrational],
        "undecided_where_square": [str(there.formula(p)) for p in found.square],
        "cofactors_left": found.left,
        "all_followed": found.followed,
        "no_other_rational": found.complete,
    }


def _levels(there: Setting, found: ZeroLevels | None) -> list[dict[str, Any]] | None:
    if found is None:
        return None
    return [{**_level(there, one), "complete": one.complete} for one in found.levels]


def _others(there: Setting, found: OtherLevels | None) -> list[dict[str, Any]] | None:
    if found is None:
        return None
    return [
        {
            "integral": one.level.name,
            "power": one.power,
            "values": [
                {
                    "value": str(at.value),
                    "integrals": [{"weight": w, "formula": str(there.formula(f))} for w, f in at.integrals],
                    "complete": at.complete,
                }
                for at in one.values
            ],
            "undecided_at": [str(value) for value in one.undecided],
            "undecided_at_zeros_of": [[str(c) for c in p.coeffs()] for p in one.irrational],
            "looked": one.looked,
            "complete": one.looked and one.complete and not one.drops and not one.undecided,
            "at_any_value": one.looked and one.complete and one.whole,
            "known": "proved" if not (one.by_rank and there.field.parameters) else "verified",
        }
        for one in found.levels
    ]


def _level(there: Setting, level: OnLevel) -> dict[str, Any]:
    return {
        "zero": level.level.name,
        "integrals": [{"weight": weight, "formula": str(there.formula(f))} for weight, f in level.integrals],
    }


def _special(there: Setting, one: Special) -> dict[str, Any]:
    return {
        "integrals": [{"weight": weight, "formula": str(there.formula(f))} for weight, f in one.integrals],
        "on_levels": [_level(there, level) for level in one.levels],
        "complete": one.complete,
    }
