"""Units of a description: what a person declared, and what follows for every other name.

A *dimension* is a tuple of (base, exponent) over kg, m, s, A, K, cd, mol, without zero exponents, in that order: an
energy is (("kg", 1), ("m", 2), ("s", -2)).  Numbers belong to one coherent system of units, whatever it is; ``base``
says what its mass, length, time, ... are called (mm, ms, ...).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from mbsym.expressions.place import Span

Dimension = tuple[tuple[str, Fraction], ...]

#: Base units in the order in which they are written.
BASES = ("kg", "m", "s", "A", "K", "cd", "mol")

#: What multiples of base units are called.
MULTIPLES: dict[str, dict[float, str]] = {
    "kg": {1: "kg", 1e-3: "g", 1e3: "t", 1e-6: "mg"},
    "m": {1: "m", 1e-3: "mm", 1e-2: "cm", 1e3: "km", 1e-6: "um"},
    "s": {1: "s", 1e-3: "ms", 60: "min", 3600: "h", 86400: "day", 1e-6: "us"},
}

NONE: Dimension = ()


def dimension(exponents: Mapping[str, Fraction | int]) -> Dimension:
    """The dimension with these exponents of base units."""
    return tuple((base, Fraction(exponents[base])) for base in BASES if exponents.get(base))


def times(left: Dimension, right: Dimension, power: Fraction | int = 1) -> Dimension:
    """left * right**power."""
    exponents = dict(left)
    for base, exponent in right:
        exponents[base] = exponents.get(base, Fraction(0)) + exponent * power
    return dimension(exponents)


MASS, LENGTH, TIME = (dimension({base: 1}) for base in ("kg", "m", "s"))
RATE = times(NONE, TIME, -1)
SPEED = times(LENGTH, TIME, -1)
ACCELERATION = times(SPEED, TIME, -1)
FORCE = times(MASS, ACCELERATION)
ENERGY = times(FORCE, LENGTH)
INERTIA = times(MASS, LENGTH, 2)


@dataclass(frozen=True, slots=True)
class Declared:
    """A unit as somebody wrote it: ``name`` is a parameter, coordinate or prescribed motion."""

    name: str
    text: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Units:
    """The units of a system.

    ``declared`` is what the description says; ``inferred`` the dimensions of all names for which they follow;
    ``base`` the names of the base units of the system that the declared ones belong to.
    """

    declared: tuple[Declared, ...] = ()
    inferred: tuple[tuple[str, Dimension], ...] = field(default=(), compare=False)
    base: tuple[tuple[str, str], ...] = field(default=(), compare=False)

    def __bool__(self) -> bool:
        return bool(self.declared)

    def of(self, name: str) -> str | None:
        """The unit of a name as declared, else in base units; None where it does not follow.  1 is no unit: ""."""
        for declaration in self.declared:
            if declaration.name == name:
                return "" if declaration.text == "1" else declaration.text
        exponents = dict(self.inferred).get(name)
        return None if exponents is None else self.text(exponents)

    def rate_of(self, name: str, order: int = 1) -> str | None:
        """The unit of the derivative of that order with respect to time; None where it does not follow."""
        exponents = dict(self.inferred).get(name)
        radians = self.of(name) == "rad"
        if exponents is None:
            return None
        text = self.text(times(exponents, TIME, -order))
        return None if text is None else f"rad{text.removeprefix('1')}" if radians else text

    def text(self, of: Dimension) -> str | None:
        """A dimension in base units, ``kg*m^2/s^2``; "" for a pure number; None where a base unit does not follow."""
        names = dict(self.base)
        if any(base not in names for base, _ in of):
            return None
        return written(tuple((names[base], exponent) for base, exponent in of))


def written(of: Dimension) -> str:
    """``kg*m^2/s^2``, ``1/s``, "" for a pure number."""
    above = [_power(base, exponent) for base, exponent in of if exponent > 0]
    below = [_power(base, -exponent) for base, exponent in of if exponent < 0]
    if not below:
        return "*".join(above)
    under = below[0] if len(below) == 1 else f"({'*'.join(below)})"
    return f"{'*'.join(above) or '1'}/{under}"


def _power(base: str, exponent: Fraction) -> str:
    if exponent == 1:
        return base
    return f"{base}^{exponent}" if exponent.denominator == 1 else f"{base}^({exponent})"
