"""The text of a unit to its size and dimension.  pint knows the units; descriptions without any never load it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.model.units import ENERGY, FORCE, LENGTH, MASS, NONE, RATE, TIME, Declared, Dimension, dimension, times
from mbsym.source.placed import Node
from mbsym.source.reading import Reading, keys_of
from mbsym.source.scope import Allowed, closest

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
_WRITTEN = ("kg", "m", "s", "N", "J", "W", "Pa", "Hz", "rad", "deg", "mm", "cm", "km", "g", "min", "h", "A", "V", "K")


#: Products that would be taken for something else: Nm is a number of metres a gram.
_CONFUSED = {"Nm": "N*m", "Nms": "N*m*s", "kgm": "kg*m"}
_MILLISECONDS = re.compile(r"ms(?:\^|\*\*)?-([12])\Z")
_DIGIT = re.compile(r"\b([A-Za-z]+)([2-4])\b")


_POWER = times(ENERGY, TIME, -1)
_PRESSURE = times(FORCE, LENGTH, -2)

#: The units that mechanics is written in, so that descriptions with these alone need not load every unit there is:
#: name -> size in SI (kg, m, s) and dimension; ``tests/source/test_units.py`` holds it against pint.
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
    try:
        if _likely(text) is not None and not _DIGIT.search(text):
            return "a product is written with *"
        powers = product(text)
    except Wrong as wrong:
        return str(wrong)
    factor: Fraction | float = Fraction(1)
    base_powers: Dimension = ()
    for name, power in powers.items():
        named = _named(name)
        if isinstance(named, str):
            return named
        base_powers = times(base_powers, named.dimension, power)
        try:
            factor *= named.factor ** (int(power) if power.denominator == 1 else float(power))
        except OverflowError:
            return "it is too large or too small"
    if any(abs(value) > MAX_EXPONENT for _, value in base_powers):
        return Message("powers of units go to [[most]]", most=MAX_EXPONENT)
    if not 1e-300 < factor < 1e300:
        return "it is too large or too small"
    return Unit(factor, base_powers)


def _likely(text: str) -> str | None:
    """What was meant by ``Nm/rad``, ``ms^-2`` or ``m/s2``, if it is one of these."""
    if milliseconds := _MILLISECONDS.match(text):
        return "m/s" if milliseconds[1] == "1" else "m/s^2"
    made = re.sub(r"[A-Za-z_]\w*", lambda match: _CONFUSED.get(match[0], match[0]), text)
    made = _DIGIT.sub(r"\1^\2", made)
    return None if made == text else made


@cache
def _named(name: str) -> Unit | str:
    """One unit by its name, or why it is none."""
    if name in COMMON:
        return Unit(*COMMON[name])
    registry = _registry()
    try:
        parsed = registry.parse_units(name)
        exponents = {_BASES[base]: Fraction(value) for base, value in parsed.dimensionality.items()}
        factor, _ = registry.get_base_units(parsed)
    except KeyError:
        return "only units of length, mass, time, current, temperature, light and amount are known"
    except Exception:  # pint raises many kinds, those of its tokenizer included
        return Message("[[name]] is unknown", name=ascii_safe(name))
    if "[mass]" in parsed.dimensionality:
        factor = _in_kilograms(factor, exponents["kg"], registry)
    return Unit(Fraction(factor) if isinstance(factor, int) else factor, dimension(exponents))


def _in_kilograms(factor: Any, power: Fraction, registry: Any) -> Any:
    """pint's base unit of mass may be the gram or the kilogram: ours is the kilogram."""
    size, base = registry.get_base_units(registry.parse_units("kg"))
    return factor if str(base) == "kilogram" else factor / size ** int(power)


def read_units(node: Node | None, declared: Iterable[Declared], reading: Reading) -> tuple[Declared, ...]:
    """The units of ``units`` and those that records of parameters and prescribed motions have, each name once."""
    declared_by_name = {declaration.name: declaration for declaration in declared}
    allowed = Allowed("a unit's name", ("parameter", "coordinate", "prescribed", "table", "input"))
    entries = [] if node is None else list(reading.entries(node, "'units'", "write {x: m}"))
    for entry in entries:
        name = entry.key.text
        if not reading.scope.check_key(entry.key.span, name, keys_of(node), allowed):
            continue
        scalar = reading.scalar(entry.value, Message("the unit of [[name]]", name=ascii_safe(name)))
        if scalar is None:
            continue
        if name in declared_by_name:
            reading.error("repeated-key", Message("the unit of '[[name]]' is given twice", name=name), entry.key.span)
        declared_by_name[name] = Declared(name, scalar.text.strip(), scalar.span)
    for declaration in declared_by_name.values():
        reason = unit(declaration.text)
        if isinstance(reason, str):
            close = _likely(declaration.text)
            close = close if close and isinstance(unit(close), Unit) else closest(declaration.text, _WRITTEN)
            hint = (
                Message("did you mean '[[other]]'?", other=close)
                if close
                else "for example kg, m, s, N, kg*m^2, rad, m/s^2, or 1"
            )
            reading.error(
                "bad-unit",
                "[[what]] is no unit: [[reason]]",
                declaration.span,
                hint,
                what=ascii_safe(declaration.text),
                reason=reason,
            )
    return tuple(declared_by_name.values())


# The text of a unit as a product of names with powers, ``kg*m^2/s^2``: read without computing anything of it.


MAX_UNIT = 60
MAX_EXPONENT = 20

_FORM = "a unit is made of names, powers, * and /, such as kg*m^2/s^2"
_TOKEN = re.compile(r"\s*(?:([A-Za-z_][A-Za-z0-9_]*)|(\*\*|\^)|(\d{1,3}(?:\.\d{1,3})?)(?![\w.])|([*/().+-]))")
_MOST_NESTED = 20

#: The name of each unit and its exponent.
Powers = dict[str, Fraction]


class Wrong(ValueError):
    """Why a text is no product of units."""


def product(text: str) -> Powers:
    """The names of a product with their exponents; raises ``Wrong`` with the reason.

    A product is written with ``*``, ``.`` or a space, and ``1/s`` for what has no numerator.

    >>> {name: str(power) for name, power in product("kg m^2/s**(3/2)").items()}
    {'kg': '1', 'm': '2', 's': '-3/2'}
    """
    if len(text) > MAX_UNIT:
        raise Wrong(_FORM)
    return _Reader(text).whole()


class _Reader:
    """Recursive descent; every exponent is bounded as soon as it is formed."""

    def __init__(self, text: str) -> None:
        self.tokens: list[str] = []
        self.place = 0
        end = 0
        text = text.rstrip()
        while end < len(text):
            match = _TOKEN.match(text, end)
            if match is None:
                raise Wrong(_FORM)
            self.tokens.append("^" if match[2] else match[0].strip())
            end = match.end()

    def whole(self) -> Powers:
        powers = self.product(0)
        if self.place < len(self.tokens):
            raise Wrong(_FORM)
        return {name: power for name, power in powers.items() if power}

    def next(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self, token: str) -> bool:
        taken = self.next() == token
        self.place += taken
        return taken

    def product(self, depth: int) -> Powers:
        if depth > _MOST_NESTED:
            raise Wrong(_FORM)
        powers = self.factor(depth)
        while (token := self.next()) not in ("", ")"):
            if token in ("*", "/", "."):
                self.place += 1
            powers = _times(powers, self.factor(depth), -1 if token == "/" else 1)
        return powers

    def factor(self, depth: int) -> Powers:
        token = self.next()
        self.place += 1
        if token == "(":
            powers = self.product(depth + 1)
            if not self.take(")"):
                raise Wrong(_FORM)
        elif token == "1":
            powers = {}
        elif re.match("[A-Za-z_]", token):
            powers = {token: Fraction(1)}
        else:
            raise Wrong(_FORM)
        return _times({}, powers, self.exponent()) if self.take("^") else powers

    def exponent(self) -> Fraction:
        """``2``, ``-2``, ``0.5``, ``(1/2)``."""
        inside = self.take("(")
        sign = -1 if self.take("-") else 1
        value = sign * self.number()
        if inside:
            value = value / self.number() if self.take("/") else value
            if not self.take(")"):
                raise Wrong(_FORM)
        if self.next() == "^":
            raise Wrong(_FORM)
        return value

    def number(self) -> Fraction:
        token = self.next()
        self.place += 1
        if not token[:1].isdigit() or (self.tokens[self.place - 2] == "/" and not Fraction(token)):
            raise Wrong(_FORM)
        return Fraction(token)


def _times(powers: Powers, other: Powers, power: Fraction | int) -> Powers:
    made = dict(powers)
    for name, exponent in other.items():
        made[name] = made.get(name, Fraction(0)) + exponent * power
    if any(abs(exponent) > MAX_EXPONENT for exponent in made.values()):
        raise Wrong(Message("powers of units go to [[most]]", most=MAX_EXPONENT))
    return made
