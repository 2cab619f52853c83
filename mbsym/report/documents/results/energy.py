"""Problem 2."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import BY_COORDINATE, Part
from mbsym.report.documents.parts import Formula


class Energy(Part, frozen=True):
    """problem 2: T = 1/2 A2_ij q'_i q'_j + A1_i q'_i + A0; with speeds u of their own in these"""

    kinetic_energy: Annotated[Formula, "T"]
    A2: Annotated[
        list[Annotated[list[Formula], BY_COORDINATE]], "second degree in the velocities, symmetric", BY_COORDINATE
    ]
    A1: Annotated[list[Formula], "first degree", BY_COORDINATE]
    A0: Annotated[Formula, "of no degree"]
    force_function: Annotated[Formula, "U = -potential energy"]
    cyclic: Annotated[list[str], "coordinates and prescribed quantities that L does not contain"]
    speeds: Annotated[list[str] | UnsetType, "the speeds u, in the order of A2 and A1, where they are not q'"] = UNSET
