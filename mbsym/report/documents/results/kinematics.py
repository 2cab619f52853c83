"""Problem 1."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import Part, told_apart_by
from mbsym.report.documents.parts import Formula


class Body(Part, frozen=True):
    """a body; components in its own axes"""

    name: Annotated[str, "its name"]
    rotation: Annotated[list[list[Formula]], "direction cosines, axes of the body in the rows"]
    angular_velocity: Annotated[list[Formula], "angular velocity"]
    velocity_origin: Annotated[list[Formula], "velocity of its joint"]
    velocity_mass_centre: Annotated[list[Formula], "velocity of its mass centre"]


class Kinematics(Part, frozen=True):
    """problem 1"""

    bodies: Annotated[list[Body], "the bodies", told_apart_by("name")]
