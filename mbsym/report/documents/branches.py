"""``branches.json`` of ``mbsym equilibria --vary``, ``equilibria-map.json`` of ``mbsym map --of equilibria``."""

from __future__ import annotations

from typing import Annotated, Any

from mbsym.maps.boundaries import OF_EQUILIBRIA
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Doubt
from mbsym.maps.result import Lack
from mbsym.report.documents.base import ASIDE, From, Hashed, Part, words
from mbsym.report.documents.parts import AnglesOf, Axis, Coordinates, Number, Verdict


class Remark(Part, frozen=True):
    """a doubt"""

    doubt: Annotated[Doubt, "which"]
    about: Annotated[str, "a reason, or a value of the parameter"]


class Equilibrium(Part, frozen=True):
    """a relative equilibrium"""

    coordinates: Coordinates
    angles_of: AnglesOf
    stability: Annotated[Verdict, From("verdict")]


class Interval(Part, frozen=True):
    """an interval"""

    low: Annotated[Number, "its lower end"]
    high: Annotated[Number, "its upper end"]
    sample: Annotated[str, "the rational value at which the equilibria were solved"]
    count: Annotated[int, "how many equilibria there are at the sample"]
    stable: Annotated[int, "how many of them are stable there"]
    constant: Annotated[bool, "whether the count is proved for the whole open interval"]
    equilibria: Annotated[list[Equilibrium], "those at the sample"]


class CriticalValueEquilibrium(Part, frozen=True):
    """an equilibrium"""

    coordinates: Coordinates
    angles_of: AnglesOf
    event: Annotated[Event, "what it is on the curve of equilibria", From("named.event")]
    below: Annotated[
        int | None, "equilibria near it at smaller values; null where it is not known", From("named.below")
    ]
    above: Annotated[int | None, "equilibria near it at larger values", From("named.above")]
    derivatives: Annotated[
        dict[str, float],
        "of the reduced equation g(y, p) = 0, rounded; their signs and zeros are exact",
        From("named.derivatives"),
    ]
    stability: Annotated[
        Verdict | None, "its stability at the critical value; null where it was not sought", From("verdict")
    ]


class CriticalValue(Part, frozen=True):
    """a critical value"""

    value: Annotated[Number, "exact, unless it is tried"]
    intervals: Annotated[list[int | None], "the intervals below and above, by number from 0; null beyond an end"]
    events: Annotated[
        list[
            Annotated[
                str,
                words(
                    "fold",
                    "vertical tangent",
                    "transcritical",
                    "isolated point",
                    "pitchfork",
                    "continuum",
                    "degenerate, not named",
                ),
            ]
        ],
        "what happens, each as often as it does",
    ]
    verdict_changes: Annotated[bool, "whether a verdict differs on the two sides"]
    continuum: Annotated[bool, "whether some equilibria there are not isolated"]
    tried: Annotated[bool, "whether it is not solved: numbers of equilibria at values tried near it differ"]
    border: Annotated[
        bool,
        "whether on some solution an unknown is at infinity, a root or denominator zero, or the mass matrix or the "
        "constraints singular",
    ]
    counts_agree: Annotated[
        bool | None,
        "whether the events account for the counts on both sides; null where there is nothing to compare",
        From("balance"),
    ]
    equilibria: Annotated[
        list[CriticalValueEquilibrium] | None,
        "the isolated equilibria there; null where they are not all solved",
        From("meetings"),
    ]


#: Digits of numbers that are followed in floating point.
DIGITS = 10


def _rounded(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else [_rounded(x) for x in value]


class Branch(Part, frozen=True):
    """a piece"""

    interval: Annotated[int, "the interval, from 0"]
    equilibrium: Annotated[int, "which of the equilibria at its sample, from 0", From("number")]
    throughout: Annotated[bool, "whether the verdict at the sample is proved for the whole open interval"]
    start: Annotated[
        int | None,
        "the equilibrium at the lower critical value that it tends to, from 0, as followed in floating point; null "
        "where it is not told",
    ]
    end: Annotated[int | None, "the same at the upper one"]
    parameter: Annotated[list[float], "values of the parameter, rounded", ASIDE, From(by=_rounded)]
    points: Annotated[
        list[list[float]],
        "coordinates there, in the order of the equilibrium's, rounded",
        ASIDE,
        From("values", _rounded),
    ]


class Branches(Hashed, frozen=True, kw_only=True):
    """All relative equilibria over an interval of one parameter: how many, where they bifurcate, how stable they
    are.
    """

    parameter: Annotated[Axis, "the parameter that is varied, and its closed interval"]
    values: Annotated[dict[str, str], "the other parameters and their exact values"]
    coordinates: Annotated[list[str], "the coordinates in the order of the points of branches"]
    proved: Annotated[bool, "whether the number of equilibria is proved in all open intervals"]
    interrupted: Annotated[bool, "whether Ctrl-C ended the work early"]
    remarks: Annotated[list[Remark], "what is not proved"]
    intervals: Annotated[list[Interval], "the open intervals between critical values, ascending"]
    critical_values: Annotated[
        list[CriticalValue], "values at which equilibria bifurcate or stability may change, ascending"
    ]
    branches: Annotated[list[Branch], "pieces of branches over one interval each", From("pieces")]


#: Where a curve comes from.
ORIGINS = tuple(x.value for x in OF_EQUILIBRIA)
#: What is known of the number of equilibria in a region.
PROVED, SAMPLE = "proved", "at the sample only"
STANDINGS = (PROVED, SAMPLE, Lack.INCOMPLETE, Lack.FAMILIES, Lack.WITHDRAWN, Lack.NOT_REACHED)


class Curve(Part, frozen=True):
    """a curve"""

    number: Annotated[int, "its number, from 0"]
    polynomial: Annotated[str, "in the two parameters"]
    origins: Annotated[list[Annotated[str, words(*ORIGINS)]], "where it comes from"]


class Region(Part, frozen=True):
    """a region"""

    number: Annotated[int, "its number, from 0"]
    sample: Annotated[list[str], "the rational point at which the equilibria were solved"]
    standing: Annotated[str, words(*STANDINGS), "what is known of their number"]
    count: Annotated[int | None, "how many there are; null where they are not counted"]
    stable: Annotated[int | None, "how many of them are stable at the sample"]
    stable_throughout: Annotated[bool, "whether those are proved to be stable in the whole region", From("throughout")]
    found_by_newton_elsewhere: Annotated[
        int | None,
        "how many Newton's method found and proved at another point of the region; null where it was not asked",
        From("confirmed"),
    ]
    area: Annotated[float, "its area, rounded"]
    equilibria: Annotated[list[Equilibrium], "those at the sample"]


class EquilibriaMap(Hashed, frozen=True, kw_only=True):
    """How many relative equilibria there are over a plane of two parameters, and how many of them are stable."""

    axes: Annotated[list[Annotated[Axis, "a parameter and its interval"]], "to the right, and upwards"]
    values: Annotated[dict[str, str], "the other parameters and their exact values"]
    interrupted: Annotated[bool, "whether Ctrl-C ended the work early"]
    unfinished: Annotated[
        list[str], "why curves may be missing; empty where the number of equilibria is proved in every region"
    ]
    curves: Annotated[list[Curve], "irreducible polynomials on whose zeros the number may change"]
    regions: Annotated[list[Region], "the open regions between the curves"]
