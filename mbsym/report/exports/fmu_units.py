"""The units of the variables of an FMU, with what they are in SI."""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.model.system import System
from mbsym.model.units import ENERGY, MULTIPLES, NONE, RATE, TIME, Dimension, times
from mbsym.report.unit_text import in_base_units


@dataclass(frozen=True)
class Unit:
    """``name`` as variables have it; ``base`` the exponents of SI base units and of rad, ``factor`` its size in SI."""

    name: str
    base: tuple[tuple[str, int], ...]
    factor: float


def time_and_energy(system: System) -> tuple[Unit | None, Unit | None]:
    """The units of the time and of energies; None where they do not follow."""
    return _unit(system, TIME), _unit(system, ENERGY)


def variable_unit(system: System, name: str, order: int = 0) -> Unit | None:
    """The unit of a name or of its derivative of an order; None where it is not known, and for a pure number."""
    own = dict(system.units.inferred).get(name)
    return None if own is None else _unit(system, times(own, RATE, order), system.units.of(name) == "rad")


def _unit(system: System, dimension: Dimension, angle: bool = False) -> Unit | None:
    name = in_base_units(system, dimension, angle)
    if not name or any(exponent.denominator != 1 for _, exponent in dimension):
        return None
    base = [(unit, int(exponent)) for unit, exponent in dimension] + ([("rad", 1)] if angle else [])
    factor = 1.0
    if dimension != NONE:
        called = dict(system.units.base)
        for unit, exponent in dimension:
            sizes = {known: size for size, known in MULTIPLES.get(unit, {}).items()}
            factor *= sizes.get(called[unit], 1.0) ** int(exponent)
    return Unit(name, tuple(base), factor)
