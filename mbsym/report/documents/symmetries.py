"""What ``mbsym symmetries --json`` prints, and the symmetries of problem 9."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import field

from mbsym.report.documents.base import Format, From, Part, SystemName, Version, told_apart_by, version, words


class Symmetry(Part, frozen=True):
    field: Annotated[dict[str, str], "xi by coordinate or speed, where it is not zero", From("directions")]
    time: Annotated[str, "tau, the shift of time"]
    gauge: Annotated[str, "Gamma, whose time derivative the Lagrangian gains"]
    integral: Annotated[str, "sum xi p + tau H - Gamma, in Python syntax"]
    name: Annotated[
        str, "the integral of problem 7 of which it is a multiple, or of what it is a function; empty for others"
    ]
    new: Annotated[bool, "proved to be no function of those known without it", From("is_new")]
    told_apart: Annotated[
        str, words("proved", "verified numerically", "undecided"), "how it is known what it is", From("certainty")
    ]
    substituted: Annotated[
        str, words("proved", "verified numerically", "undecided"), "how dI/dt = 0 came out by substitution"
    ]


class SymmetryBasis(Part, frozen=True, kw_only=True):
    """symmetries (Noether) with fields of degree one in the positions, and their integrals; null where they outgrew a
    bound
    """

    directions: Annotated[
        Literal["coordinates", "speeds"],
        "what fields move",
        From("in_speeds", lambda in_speeds: "speeds" if in_speeds else "coordinates"),
    ]
    complete: Annotated[
        bool, "proved: every symmetry of this kind is a combination of those listed, for almost all parameters"
    ]
    symmetries: Annotated[list[Symmetry], "a basis, each an identity of the exact ring", told_apart_by("integral")]


class Symmetries(SymmetryBasis, frozen=True, kw_only=True):
    """Symmetries with fields of degree one in the positions and Gamma a polynomial of degree at most two in them, both
    free of the time, and their first integrals.
    """

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName
    values: Annotated[dict[str, str], "numbers that were put in for parameters"]
