"""Units of the quantities that results are made of, and how a name is written with its unit.

Every function gives None where a unit does not follow from the description, and "" for a pure number; ``marked`` adds
nothing for either, so that a description without units is told as it always was.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain

from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING
from mbsym.model.system import System
from mbsym.model.units import (
    ACCELERATION,
    ENERGY,
    FORCE,
    LENGTH,
    RATE,
    SPEED,
    TIME,
    Dimension,
    times,
)

#: Kinds of first integrals of the whole system, or of one body.
_MOMENTA = {
    "linear momentum": times(FORCE, TIME),
    "angular momentum": times(ENERGY, TIME),
    "angular momentum about an axis of symmetry": times(ENERGY, TIME),
    "angular momentum about a contact": times(ENERGY, TIME),
}


def marked(label: str, unit: str | None) -> str:
    """``theta [rad]``; the label alone for a pure number, and where the unit is not known."""
    return f"{label} [{unit}]" if unit else label


def with_unit(number: str, unit: str | None) -> str:
    """``0.5 m``; the number alone for a pure number, and where the unit is not known."""
    return f"{number} {unit}" if unit else number


def unit_of(system: System, name: str) -> str | None:
    """Of a coordinate, its rate (``theta_dot``), its acceleration (``theta_ddot``), a parameter, ``t`` ..."""
    if name in system.coordinates or name in system.parameter_names:
        return system.units.of(name)
    if name == "t":
        return time_unit(system)
    for end, order in ((VELOCITY_ENDING, 1), (ACCELERATION_ENDING, 2)):
        base = name.removesuffix(end)
        if base != name and base in system.coordinates:
            return system.units.rate_of(base, order)
    return system.units.of(name)


def time_unit(system: System) -> str | None:
    """Of the time t."""
    return system.units.text(TIME)


def rate_unit(system: System) -> str | None:
    """Of eigenvalues and frequencies in physical time."""
    return system.units.text(RATE)


def energy_unit(system: System) -> str | None:
    """Of energies and of the force function."""
    return system.units.text(ENERGY)


def length_unit(system: System) -> str | None:
    """Of places."""
    return system.units.text(LENGTH)


def speed_unit(system: System) -> str | None:
    """Of velocities of points."""
    return system.units.text(SPEED)


def acceleration_unit(system: System) -> str | None:
    """Of accelerations of points."""
    return system.units.text(ACCELERATION)


def angular_velocity_unit(system: System) -> str | None:
    """Of angular velocities of bodies: radians per unit of time."""
    rate = system.units.text(RATE)
    return None if rate is None else f"rad{rate.removeprefix('1')}"


def integral_unit(system: System, kind: str, of: str) -> str | None:
    """Of a first integral of problem 7: an energy, dT/dq' of the coordinate ``of``, a momentum of the whole system."""
    if kind in _MOMENTA:
        return system.units.text(_MOMENTA[kind])
    if kind != "cyclic momentum":
        energies = ("generalised energy", "energy with the potential of the forces", "energy of a part")
        return energy_unit(system) if kind in energies else None
    own = dimension_of(system, of)
    return None if own is None else system.units.text(times(times(ENERGY, TIME), own, -1))


def told_units(system: System) -> list[str]:
    """``t [s]``, ``theta [rad]``, ... of t, coordinates, rates and energies, as far as known; without pure numbers."""
    names = ("t", *system.coordinates, *system.velocities)
    units = [(name, unit_of(system, name)) for name in names] + [("energies", energy_unit(system))]
    return [marked(name, unit) for name, unit in units if unit]


def dimension_of(system: System, name: str) -> Dimension | None:
    """The dimension of a coordinate, a parameter, a prescribed motion or a symbol of the notation."""
    return dict(system.units.inferred).get(name)


def units_by_name(system: System, more: Iterable[tuple[str, str | None]] = ()) -> dict[str, str]:
    """The known units of t, coordinates, their rates, parameters, prescribed motions and ``more``, pure numbers as "1".

    A declared name keeps its unit where ``more`` has the same.  Empty for a description without units.
    """
    if not system.units:
        return {}
    names = ("t", *system.coordinates, *system.velocities, *system.parameter_names)
    names = (
        *names,
        *(item.name for item in system.prescribed),
        *system.input_names,
        *(output.name for output in system.outputs),
    )
    pairs = chain(((name, unit_of(system, name)) for name in names), more)
    units: dict[str, str] = {}
    for name, unit in pairs:
        if unit is not None:
            units.setdefault(name, unit or "1")
    return units
