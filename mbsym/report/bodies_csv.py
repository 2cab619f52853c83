"""``bodies.csv``: what each body does along a trajectory, as plain CSV: a line of names, then numbers (``%.17g``).

Columns: ``t``; for each body NAME

    NAME.position_1 .. 3            its mass centre, from the origin of the inertial frame, in inertial axes
    NAME.velocity_1 .. 3            of the mass centre, in inertial axes
    NAME.acceleration_1 .. 3        of the mass centre, in inertial axes
    NAME.angular_velocity_1 .. 3    absolute, in the body's own axes; radians per unit of time
    NAME.kinetic_energy             1/2 m V.V + 1/2 omega.Theta_C omega

then ``kinetic_energy`` (their sum), ``force_function`` U, and ``energy``, their difference T - U.  Everything is in the
units of the description.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mbsym.numerics.body_motion import BodyMotions
from mbsym.report.trajectory_csv import written

_VECTORS = (
    ("position", "places"),
    ("velocity", "velocities"),
    ("acceleration", "accelerations"),
    ("angular_velocity", "angular_velocities"),
)


def bodies_csv(found: BodyMotions) -> str:
    """The file's text."""
    kinetic = found.kinetic.sum(axis=0)
    energies = {"kinetic_energy": kinetic, "force_function": found.force_function}
    table = {"t": found.times, **dict(_columns(found)), **energies, "energy": kinetic - found.force_function}
    return written([_cell(name) for name in table], list(table.values()))


def _columns(found: BodyMotions) -> Iterator[tuple[str, Any]]:
    for k, name in enumerate(found.names):
        for what, attribute in _VECTORS:
            for axis in range(3):
                yield f"{name}.{what}_{axis + 1}", getattr(found, attribute)[k, axis]
        yield f"{name}.kinetic_energy", found.kinetic[k]


def _cell(name: str) -> str:
    """Quoted where it has to be."""
    return '"' + name.replace('"', '""') + '"' if any(c in name for c in ',"\r\n') else name
