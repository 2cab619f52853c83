"""Branches of equilibria as JSON: every interval with its equilibria, every critical value with what happens there."""

from __future__ import annotations

import json
from typing import Any

from flint import fmpq

from mbsym.algebra.plane import AlgebraicNumber
from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.branches_result import Branches, Critical, Meeting, Piece
from mbsym.model.system import System
from mbsym.problems.equilibria import CoordinateValue
from mbsym.report.documents.writer import version
from mbsym.report.sections.stability import verdict_data
from mbsym.source.meaning import meaning

#: The version of ``schemas/branches.json`` that it follows.
FORMAT = 1
#: Digits of numbers that are followed in floating point.
DIGITS = 10


def branches_json(system: System, found: Branches) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data = {
        "format": FORMAT,
        "version": version(),
        "system": system.name,
        "description_sha256": meaning(system),
        "parameter": {"name": found.axis.name, "low": str(found.axis.low), "high": str(found.axis.high)},
        "values": {name: str(value) for name, value in sorted(found.given.items())},
        "coordinates": list(found.coordinates),
        "proved": found.proved,
        "interrupted": found.interrupted,
        "remarks": [{"doubt": one.doubt.value, "about": one.about} for one in found.remarks],
        "intervals": [
            {
                "low": number_data(one.low),
                "high": number_data(one.high),
                "sample": str(one.sample),
                "count": len(one.equilibria),
                "stable": one.stable,
                "constant": one.constant,
                "equilibria": [
                    {
                        "coordinates": [_coordinate(x) for x in there.values],
                        "angles_of": there.coordinates_of or None,
                        "stability": verdict_data(there.verdict),
                    }
                    for there in one.equilibria
                ],
            }
            for one in found.intervals
        ],
        "critical_values": [_critical(found, one) for one in found.criticals],
        "branches": [_piece(one) for one in found.pieces],
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _critical(found: Branches, one: Critical) -> dict[str, Any]:
    below, above = found.sides(one)
    return {
        "value": number_data(one.number),
        "intervals": [below, above],
        "events": [event.value for event in one.events],
        "verdict_changes": found.verdict_changes(one),
        "continuum": one.continuum,
        "border": one.border,
        "counts_agree": one.balance,
        "equilibria": None if one.meetings is None else [_meeting(x) for x in one.meetings],
    }


def _meeting(one: Meeting) -> dict[str, Any]:
    return {
        "coordinates": [_coordinate(x) for x in one.values],
        "angles_of": one.coordinates_of or None,
        "event": one.named.event.value,
        "below": one.named.below,
        "above": one.named.above,
        "derivatives": dict(one.named.derivatives),
        "stability": None if one.verdict is None else verdict_data(one.verdict),
    }


def _piece(one: Piece) -> dict[str, Any]:
    return {
        "interval": one.interval,
        "equilibrium": one.number,
        "throughout": one.throughout,
        "start": one.start,
        "end": one.end,
        "parameter": [_rounded(x) for x in one.parameter],
        "points": [[_rounded(x) for x in q] for q in one.values],
    }


def _rounded(x: float) -> float:
    return float(f"{x:.{DIGITS}g}")


def _coordinate(item: CoordinateValue) -> dict[str, Any]:
    return {"name": item.name, "value": item.text, "exact": item.exact, "number": item.value}


def number_data(x: Any) -> dict[str, Any]:
    """A rational number as text, an algebraic one by its minimal polynomial and an interval with no other root."""
    if isinstance(x, fmpq):
        return {"exact": str(x), "polynomial": None, "between": None, "number": float(enclosure(x).mid())}
    ball = x.enclosure(64)
    polynomial = [str(c) for c in x.polynomial.coeffs()] if isinstance(x, AlgebraicNumber) else None
    return {"exact": None, "polynomial": polynomial, "between": [str(x.low), str(x.high)], "number": float(ball.mid())}
