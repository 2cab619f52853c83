"""A trajectory as plain CSV: one line of names, then numbers that read back exactly; no comments.

Columns: ``t``, the coordinates, ``<name>_dot``, ``energy`` (T - U), where something is prescribed
``generalized_energy`` (h = T2 - T0 - U, else the same), ``relative_drift`` ((h - h(0)) over the largest kinetic
energy), then whatever else was asked for.  A trajectory that ends early is told by its file's name and
by ``simulation.json``, not by anything in the table: whoever reads it with default options gets numbers only.

Of a description with units the names have theirs, ``theta [rad]``, ``t [s]``; a name without is a pure number, or its
unit does not follow from the description.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import StringIO
from typing import Any

import numpy as np
from msgspec.json import encode

from mbsym.model.quantities import (
    acceleration_unit,
    angular_velocity_unit,
    energy_unit,
    length_unit,
    marked,
    speed_unit,
    time_unit,
    unit_of,
)
from mbsym.model.system import System
from mbsym.numerics.body_motion import BodyMotions
from mbsym.numerics.columns import columns
from mbsym.numerics.simulate import Trajectory

#: Rows turned into text at a time: numbers of Python take more room than those of an array.
BLOCK = 10_000


def trajectory_parts(
    trajectory: Trajectory, more: Mapping[str, Any] | None = None, units: Mapping[str, str | None] | None = None
) -> Iterator[str]:
    """The file's text in parts, of which only one is held at a time.

    ``more`` maps names of further columns to their values, of shape (m,), ``units`` to theirs.
    """
    further, natural = dict(more or {}), trajectory.generalized_energy is trajectory.energy
    known = column_units(trajectory.system, natural) | dict(units or {})
    names = [marked(name, known.get(name)) for name in (*columns(trajectory.system, natural), *further)]
    if trajectory.table is not None:
        own = ("energy",) if natural else ("energy", "generalized_energy")
        yield header(names)
        for points, values in trajectory.table.blocks():
            yield rows([*points, *(values[name] for name in (*own, "relative_drift", *further))])
        return
    energies = [trajectory.energy] if natural else [trajectory.energy, trajectory.generalized_energy]
    table = [trajectory.times, *trajectory.states, *energies, trajectory.drift, *further.values()]
    yield from parts(names, table)


def column_units(system: System, natural: bool = True) -> dict[str, str | None]:
    """The units of the columns of ``mbsym.numerics.columns``; "" for the relative drift."""
    own = ["t", *system.coordinates, *system.velocities]
    energies = [energy_unit(system)] * (1 if natural else 2)
    return dict(zip(columns(system, natural), [*(unit_of(system, name) for name in own), *energies, ""], strict=True))


def written(names: Sequence[str], table: Sequence[Any]) -> str:
    """A header and the columns of a table, a block of rows after the other."""
    return "".join(parts(names, table))


def parts(names: Sequence[str], table: Sequence[Any]) -> Iterator[str]:
    """The same block by block."""
    yield header(names)
    for start in range(0, len(table[0]), BLOCK):
        yield rows([column[start : start + BLOCK] for column in table])


def text_table(names: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table with words among its cells, in quotes where one holds a comma, a quote or a line break."""
    stream = StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)
    return stream.getvalue()


def header(names: Sequence[str]) -> str:
    """The line of names."""
    return text_table(names, ())


def rows(table: Sequence[Any]) -> str:
    """The rows of a table, given as columns: each number in the fewest digits that read back exactly."""
    block = np.array(table, dtype=float).T
    if np.all(np.isfinite(block)):
        lines = encode(block.tolist())[2:-2].decode().replace("],[", "\n") + "\n"
    else:  # JSON has no such numbers
        lines = "".join(",".join(map(repr, row)) + "\n" for row in block.tolist())
    return lines.replace(".0,", ",").replace(".0\n", "\n")


def shortest(value: Any) -> str:
    """A number in the fewest digits that read back exactly."""
    return repr(float(value)).removesuffix(".0")


# ``bodies.csv``: what each body does along a trajectory, as plain CSV: a line of names, then numbers.
#
# Columns: ``t``; for each body NAME
#
#     NAME.position_1 .. 3            its mass centre, from the origin of the inertial frame, in inertial axes
#     NAME.velocity_1 .. 3            of the mass centre, in inertial axes
#     NAME.acceleration_1 .. 3        of the mass centre, in inertial axes
#     NAME.angular_velocity_1 .. 3    absolute, in the body's own axes; radians per unit of time
#     NAME.kinetic_energy             1/2 m V.V + 1/2 omega.Theta_C omega
#
# then ``kinetic_energy`` (their sum), ``force_function`` U, and ``energy``, their difference T - U.  Everything is in
# the units of the description; where it declares them, they stand behind the names (``arm.velocity_1 [m/s]``).


_VECTORS = (
    ("position", "places"),
    ("velocity", "velocities"),
    ("acceleration", "accelerations"),
    ("angular_velocity", "angular_velocities"),
)


def bodies_parts(blocks: Iterable[BodyMotions], system: System | None = None) -> Iterator[str]:
    """The file's text in parts, of rows that come block by block, with the units of ``system``."""
    begun = False
    for block in blocks:
        text = parts(*_table(block, system))
        if begun:
            next(text)  # the line of names
        yield from text
        begun = True


def _table(motions: BodyMotions, system: System | None) -> tuple[list[str], list[Any]]:
    kinetic = motions.kinetic.sum(axis=0)
    energies = {"kinetic_energy": kinetic, "force_function": motions.force_function}
    table = {"t": motions.times, **dict(_columns(motions)), **energies, "energy": kinetic - motions.force_function}
    units = {} if system is None else _units(system)
    return [marked(name, units.get(_quantity(name))) for name in table], list(table.values())


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


def _columns(motions: BodyMotions) -> Iterator[tuple[str, Any]]:
    for k, name in enumerate(motions.names):
        for what, attribute in _VECTORS:
            for axis in range(3):
                yield f"{name}.{what}_{axis + 1}", getattr(motions, attribute)[k, axis]
        yield f"{name}.kinetic_energy", motions.kinetic[k]
