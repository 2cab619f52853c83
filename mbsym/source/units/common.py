"""The units that mechanics is written in, so that descriptions with these alone need not load every unit there is."""

from __future__ import annotations

from fractions import Fraction

from mbsym.model.units import (
    ENERGY,
    FORCE,
    LENGTH,
    MASS,
    NONE,
    RATE,
    TIME,
    Dimension,
    times,
)

_POWER = times(ENERGY, TIME, -1)
_PRESSURE = times(FORCE, LENGTH, -2)

#: Name -> size in SI (kg, m, s) and dimension; ``tests/source/test_units.py`` holds it against pint.
COMMON: dict[str, tuple[Fraction, Dimension]] = {
    name: (Fraction(size), dimension)
    for name, size, dimension in (
        ("kg", "1", MASS),
        ("g", "1/1000", MASS),
        ("t", "1000", MASS),
        ("m", "1", LENGTH),
        ("mm", "1/1000", LENGTH),
        ("cm", "1/100", LENGTH),
        ("km", "1000", LENGTH),
        ("s", "1", TIME),
        ("ms", "1/1000", TIME),
        ("min", "60", TIME),
        ("h", "3600", TIME),
        ("N", "1", FORCE),
        ("kN", "1000", FORCE),
        ("J", "1", ENERGY),
        ("kJ", "1000", ENERGY),
        ("W", "1", _POWER),
        ("kW", "1000", _POWER),
        ("Pa", "1", _PRESSURE),
        ("rad", "1", NONE),
        ("Hz", "1", RATE),
    )
}
