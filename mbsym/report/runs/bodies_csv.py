"""``bodies.csv``: what each body does along a trajectory, as plain CSV: a line of names, then numbers (``%.17g``).

Columns: ``t``; for each body NAME

    NAME.position_1 .. 3            its mass centre, from the origin of the inertial frame, in inertial axes
    NAME.velocity_1 .. 3            of the mass centre, in inertial axes
    NAME.acceleration_1 .. 3        of the mass centre, in inertial axes
    NAME.angular_velocity_1 .. 3    absolute, in the body's own axes; radians per unit of time
    NAME.kinetic_energy             1/2 m V.V + 1/2 omega.Theta_C omega

then ``kinetic_energy`` (their sum), ``force_function`` U, and ``energy``, their difference T - U.  Everything is in the
units of the description; where it declares them, they stand behind the names (``arm.velocity_1 [m/s]``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from mbsym.model.quantities import (
    acceleration_unit,
    angular_velocity_unit,
    energy_unit,
    length_unit,
    marked,
    speed_unit,
    time_unit,
)
from mbsym.model.system import System
from mbsym.numerics.body_motion import BodyMotions
from mbsym.report.runs.events_json import cell
from mbsym.report.runs.trajectory_csv import parts

_VECTORS = (
    ("position", "places"),
    ("velocity", "velocities"),
    ("acceleration", "accelerations"),
    ("angular_velocity", "angular_velocities"),
)


def bodies_parts(blocks: Iterable[BodyMotions], system: System | None = None) -> Iterator[str]:
    """The file's text in parts, of rows that come block by block, with the units of ``system``."""
    begun = False
    for found in blocks:
        text = parts(*_table(found, system))
        if begun:
            next(text)  # the line of names
        yield from text
        begun = True


def _table(found: BodyMotions, system: System | None) -> tuple[list[str], list[Any]]:
    kinetic = found.kinetic.sum(axis=0)
    energies = {"kinetic_energy": kinetic, "force_function": found.force_function}
    table = {"t": found.times, **dict(_columns(found)), **energies, "energy": kinetic - found.force_function}
    units = {} if system is None else _units(system)
    return [cell(marked(name, units.get(_quantity(name)))) for name in table], list(table.values())


def _units(system: System) -> dict[str, str | None]:
    """By what is measured."""
    energy = energy_unit(system)
    return {
        "t": time_unit(system),
        "position": length_unit(system),
        "velocity": speed_unit(system),
        "acceleration": acceleration_unit(system),
        "angular_velocity": angular_velocity_unit(system),
        "kinetic_energy": energy,
        "force_function": energy,
        "energy": energy,
    }


def _quantity(name: str) -> str:
    """``arm.angular_velocity_1`` is an angular velocity."""
    quantity = name.rpartition(".")[2]
    return quantity[:-2] if quantity[-2:-1] == "_" and quantity[-1:].isdigit() else quantity


def _columns(found: BodyMotions) -> Iterator[tuple[str, Any]]:
    for k, name in enumerate(found.names):
        for what, attribute in _VECTORS:
            for axis in range(3):
                yield f"{name}.{what}_{axis + 1}", getattr(found, attribute)[k, axis]
        yield f"{name}.kinetic_energy", found.kinetic[k]
