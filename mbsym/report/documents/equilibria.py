"""What ``mbsym equilibria --json`` prints."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import From, Head, Part
from mbsym.report.documents.parts import AnglesOf, Coordinates, CoordinateValue, Verdict


class Equilibrium(Part, frozen=True):
    """a relative equilibrium"""

    coordinates: Coordinates
    angles_of: AnglesOf
    arbitrary: Annotated[list[str], "coordinates that may have any value", From("free")]
    descriptions: Annotated[int, "how many sets of coordinates describe the same equilibrium", From("described")]
    proof: Annotated[str, "exact, or how it is proved to exist"]
    stability: Annotated[Verdict, From("verdict")]


class Beyond(Equilibrium, frozen=True):
    """one outside of the declared signs"""

    negative: Annotated[list[str], "what is negative there", From("beyond")]


class Family(Part, frozen=True):
    """a family of equilibria"""

    dimension: Annotated[int, "its dimension"]
    equations: Annotated[list[str], "equations that it obeys"]
    free: Annotated[list[str], "coordinates that are free"]
    angles_of: AnglesOf
    sample: Annotated[list[CoordinateValue], "one member"]
    stability_of_the_sample: Annotated[Verdict, From("verdict")]


class RotationEquation(Part, frozen=True):
    """one component"""

    constant: Annotated[str, "what acts at rest"]
    linear: Annotated[str, "the factor of the rate"]
    quadratic: Annotated[str, "the factor of its square"]


class PermanentRotations(Part, frozen=True):
    """axes and rates at which a single body may keep turning about a fixed direction, whatever rate the description
    gives; g1, g2, g3 are the unit vector of that direction in the axes of the body; null where there is no such
    direction
    """

    body: Annotated[str, "the body"]
    angle: Annotated[str, "the angle about the fixed direction"]
    axes: Annotated[
        list[Annotated[str, "a homogeneous polynomial in g1, g2, g3"]],
        "factors of the polynomial that has to vanish at these axes; none where it vanishes at every axis or where "
        "there is none",
    ]
    everywhere: Annotated[
        bool,
        "whether every axis satisfies the condition on axes, so that axes form a two-parameter family where the rate "
        "is real",
    ]
    one_parameter_family: Annotated[
        bool, "whether it is proved that these axes, with real rates, are curves of the sphere", From("family")
    ]
    one_direction_of_each_line: Annotated[
        bool,
        "whether exactly one of g and -g carries a rotation where axes vanishes, and neither constant nor quadratic "
        "does",
        From("either"),
    ]
    equations: Annotated[
        list[RotationEquation],
        "constant + rate linear + rate**2 quadratic = 0, three components in the axes of the body: necessary and "
        "sufficient with |g| = 1",
        From("components"),
    ]


class Equilibria(Head, frozen=True, kw_only=True):
    """All relative equilibria of a description at numbers."""

    units: Annotated[
        dict[str, Annotated[str, "its unit"]] | UnsetType,
        "where the description declares units: those of t, coordinates, rates, parameters and prescribed motions, by "
        "name; 1 for a pure number, nothing where a unit does not follow",
    ] = UNSET
    values: Annotated[dict[str, str], "parameters and their exact values"]
    turning: Annotated[dict[str, str | float], "coordinates that turn steadily, with their rates"]
    complete: Annotated[bool, "whether the list is proved to be complete"]
    remarks: Annotated[list[str], "what else there is to say, in sentences"]
    equilibria: Annotated[list[Equilibrium], "relative equilibria"]
    singular: Annotated[
        list[Annotated[Equilibrium, "one where the mass matrix is singular"]], "where the mass matrix is singular"
    ]
    beyond: Annotated[list[Beyond], "outside of the declared signs"]
    families: Annotated[list[Family], "families"]
    permanent_rotations: PermanentRotations | None
