"""Problem 1, kinematics: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.problems.kinematics import Kinematics
from mbsym.report.documents.results import kinematics as doc
from mbsym.report.plain import Write, column_text, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: Kinematics, system: System, write: Write) -> doc.Kinematics:
    """The section of results.json."""
    return doc.Kinematics(
        bodies=[
            doc.Body(
                name=body.name,
                rotation=matrix_text(body.rotation, write),
                angular_velocity=column_text(body.angular_velocity, write),
                velocity_origin=column_text(body.velocity_origin, write),
                velocity_mass_centre=column_text(body.velocity_mass_centre, write),
            )
            for body in found.bodies
        ]
    )


def lines(found: Kinematics, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    yield counted(len(found.bodies), "body", "bodies")
