"""``equilibria-map.json`` of ``mbsym map --of equilibria``."""

from __future__ import annotations

from typing import Annotated

from mbsym.maps.boundaries import OF_EQUILIBRIA
from mbsym.maps.result import Lack
from mbsym.report.documents.base import Hashed, Part, words
from mbsym.report.documents.branches import Equilibrium
from mbsym.report.documents.parts import Axis

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
    stable_throughout: Annotated[bool, "whether those are proved to be stable in the whole region"]
    found_by_newton_elsewhere: Annotated[
        int | None,
        "how many Newton's method found and proved at another point of the region; null where it was not asked",
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
