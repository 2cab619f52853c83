"""Relative equilibria as positions to click through, each with its verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mbsym.algebra.failures import NoValue
from mbsym.analysis.resting import relative_equilibria
from mbsym.analysis.stages import Unavailable
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.model.system import System
from mbsym.picture.encode import number
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue
from mbsym.problems.stability.verdict import Verdict
from mbsym.report.documents.base import plain
from mbsym.report.sections.stability import verdict_data


@dataclass(frozen=True)
class Resting:
    """``values`` of the coordinates that it fixes, ``free`` those that may have any value.

    ``texts`` are the values as they are told, exact where they are.  ``other_angles`` names the joints whose values are
    in other angles than the description's, because these are singular there: no slider shows it.  ``family``: one of a
    continuum, ``sample`` of it.
    """

    values: Mapping[str, float]
    texts: Mapping[str, str]
    free: tuple[str, ...]
    verdict: Verdict
    proof: str
    other_angles: str = ""
    family: bool = False


@dataclass(frozen=True)
class AtRest:
    """``complete``: it is proved that there are no others but those of the families."""

    listed: tuple[Resting, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: Mapping[str, float]


def at_rest(system: System, overrides: Mapping[str, Fraction] | None = None) -> AtRest:
    """All relative equilibria at exact values.  Raises NoValue for one that is missing, and what the search raises."""
    values = given_values(system, overrides or {})
    for name in missing_values(system, values):
        raise NoValue(name)
    try:
        found = relative_equilibria(system, values)
    except Unavailable as withdrawn:
        return AtRest((), False, (withdrawn.failure.reason,), {})
    listed = [_resting(x.values, x.free, x.verdict, x.proof, x.coordinates_of) for x in found.equilibria]
    listed += [_resting(x.sample, x.free, x.verdict, "", x.coordinates_of, True) for x in found.families]
    return AtRest(tuple(listed), found.complete, found.remarks, dict(found.turning))


def _resting(
    values: Iterable[CoordinateValue],
    free: tuple[str, ...],
    verdict: Verdict,
    proof: str,
    other: str,
    family: bool = False,
) -> Resting:
    listed = list(values)
    return Resting(
        {x.name: x.value for x in listed}, {x.name: x.text for x in listed}, free, verdict, proof, other, family
    )


def at_rest_json(found: AtRest) -> dict[str, Any]:
    """What a page reads."""
    return {
        "equilibria": [
            {
                "values": {name: number(value) for name, value in x.values.items()},
                "texts": dict(x.texts),
                "free": list(x.free),
                "verdict": plain(verdict_data(x.verdict)),
                "proof": x.proof,
                "otherAngles": x.other_angles,
                "family": x.family,
            }
            for x in found.listed
        ],
        "complete": found.complete,
        "remarks": list(found.remarks),
        "turning": {name: number(value) for name, value in found.turning.items()},
    }
