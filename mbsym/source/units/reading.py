"""The text of a unit to its size and dimension.  pint knows the units; descriptions without any never load it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

from mbsym.expressions.parser import ascii_safe
from mbsym.model.units import Declared, Dimension, dimension
from mbsym.source.placed import Node
from mbsym.source.reading import Reading, keys_of
from mbsym.source.scope import Allowed, closest

MAX_UNIT = 60
MAX_EXPONENT = 20

_TEXT = re.compile(r"[A-Za-z0-9_ .*/^()+-]+\Z")

#: Names of our base units in pint's dimensions.
_BASES = {
    "[mass]": "kg",
    "[length]": "m",
    "[time]": "s",
    "[current]": "A",
    "[temperature]": "K",
    "[luminosity]": "cd",
    "[substance]": "mol",
}

#: What people write, for guesses at slips.
_COMMON = ("kg", "m", "s", "N", "J", "W", "Pa", "Hz", "rad", "deg", "mm", "cm", "km", "g", "min", "h", "A", "V", "K")


#: Products that would be taken for something else: Nm is a nautical mile.
_CONFUSED = {"Nm": "N*m", "Nms": "N*m*s", "kgm": "kg*m", "ms^-1": "m/s", "ms^-2": "m/s^2"}


@dataclass(frozen=True, slots=True)
class Unit:
    """``factor`` units of SI (kg, m, s, ...), of a dimension."""

    factor: Fraction | float
    dimension: Dimension


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Fraction, cache_folder=None)


@cache
def unit(text: str) -> Unit | str:
    """The unit that a text means, or why it means none.

    >>> unit("kg*m^2").dimension
    (('kg', Fraction(1, 1)), ('m', Fraction(2, 1)))
    >>> unit("bananas")
    "'bananas' is unknown"
    """
    if text.strip() == "1":
        return Unit(Fraction(1), ())
    if text in _CONFUSED:
        return "a product is written with *"
    if len(text) > MAX_UNIT or not _TEXT.match(text):
        return "a unit is made of names, powers, * and /, such as kg*m^2/s^2"
    registry = _registry()
    try:
        parsed = registry.parse_units(text)
        exponents = {_BASES[name]: Fraction(value) for name, value in parsed.dimensionality.items()}
        if any(abs(value) > MAX_EXPONENT for value in exponents.values()):
            return f"powers of units go to {MAX_EXPONENT}"
        factor, _ = registry.get_base_units(parsed)
    except KeyError:
        return "only units of length, mass, time, current, temperature, light and amount are known"
    except Exception as error:  # pint raises many kinds, those of its tokenizer included
        names = getattr(error, "unit_names", None)
        missing = [names] if isinstance(names, str) else list(names or ())
        if missing:
            return f"{ascii_safe(str(missing[0]))} is unknown"
        return "a unit is made of names, powers, * and /, such as kg*m^2/s^2"
    if "[mass]" in parsed.dimensionality:
        factor = _in_kilograms(factor, exponents["kg"], registry)
    return Unit(factor, dimension(exponents))


def _in_kilograms(factor: Any, power: Fraction, registry: Any) -> Any:
    """pint's base unit of mass may be the gram or the kilogram: ours is the kilogram."""
    size, base = registry.get_base_units(registry.parse_units("kg"))
    return factor if str(base) == "kilogram" else factor / size ** int(power)


def read_units(node: Node | None, given: Iterable[Declared], reading: Reading) -> tuple[Declared, ...]:
    """The units of ``units`` and those that records of parameters and prescribed motions have, each name once."""
    found = {one.name: one for one in given}
    allowed = Allowed("a unit's name", ("parameter", "coordinate", "prescribed"))
    entries = [] if node is None else list(reading.entries(node, "'units'", "write {x: m}"))
    for entry in entries:
        name = entry.key.text
        if not reading.scope.check_key(entry.key.span, name, keys_of(node), allowed):
            continue
        scalar = reading.scalar(entry.value, f"the unit of {ascii_safe(name)}")
        if scalar is None:
            continue
        if name in found:
            reading.error("repeated-key", f"the unit of '{name}' is given twice", entry.key.span)
        found[name] = Declared(name, scalar.text.strip(), scalar.span)
    for one in found.values():
        reason = unit(one.text)
        if isinstance(reason, str):
            close = _CONFUSED.get(one.text) or closest(one.text, _COMMON)
            hint = f"did you mean '{close}'?" if close else "for example kg, m, s, N, kg*m^2, rad, m/s^2, or 1"
            reading.error("bad-unit", f"{ascii_safe(one.text)} is no unit: {reason}", one.span, hint)
    return tuple(found.values())
