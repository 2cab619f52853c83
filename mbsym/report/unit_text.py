"""How units are written for each kind of output: they are made of letters, digits, ``* / ^ ( ) . + -`` and spaces."""

from __future__ import annotations

import re

from mbsym.model.quantities import marked
from mbsym.model.system import System
from mbsym.model.units import NONE, RATE, Dimension, times

_POWER = re.compile(r"\s*(?:\^|\*\*)\s*(?:(-?\d+)|\((-?\d+(?:/\d+)?)\))")
_RAISED = str.maketrans("0123456789-", "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079\u207b")
_TOKEN = re.compile(r"[A-Za-z]+|\s*[*/]\s*|.")
_LATEX = {"*": r"\,", "": r"\,", "_": r"\_"}


def pretty(unit: str | None) -> str | None:
    """For people on screens and axes: ``kg\u00b7m\u00b2/s\u00b2``."""
    if not unit:
        return unit
    raised = _POWER.sub(lambda match: _raised(match[1] or match[2]), unit)
    return re.sub(r"\s*\*\s*", "\u00b7", raised)


def labelled(label: str, unit: str | None) -> str:
    """A label with its unit for people on screens and axes."""
    return marked(label, pretty(unit))


def _raised(power: str) -> str:
    return f"^({power})" if "/" in power else power.translate(_RAISED)


def latex(unit: str | None) -> str:
    r"""Mathematical LaTeX: ``\mathrm{kg}\,\mathrm{m}^{2}``; "" for a pure number, and where the unit is not known."""
    if not unit:
        return ""
    pieces = []
    place = 0
    while place < len(unit):
        power = _POWER.match(unit, place)
        if power:
            pieces.append(f"^{{{power[1] or power[2]}}}")
            place = power.end()
            continue
        token = _TOKEN.match(unit, place)
        assert token is not None
        pieces.append(
            f"\\mathrm{{{token[0]}}}" if token[0].isalpha() else _LATEX.get(token[0].strip(), token[0].strip())
        )
        place = token.end()
    return "".join(pieces)


def bracketed(unit: str | None, space: str = "") -> str:
    r"""Mathematical LaTeX: ``[\mathrm{m}]`` after a space; "" for a pure number, and where the unit is not known."""
    return f"{space}[{latex(unit)}]" if unit else ""


def modelica(unit: str | None) -> str:
    """In the syntax of Modelica, ``kg.m2/s2``; "" for a pure number, and for what Modelica cannot write.

    ``unit`` is made of base units, as ``mbsym.model.units.written`` writes them.
    """
    if not unit or "^(" in unit:
        return ""
    return re.sub(r"\bday\b", "d", unit.replace("*", ".").replace("^", ""))


def base_unit(system: System, name: str, order: int = 0) -> str | None:
    """The unit of a name, or of its derivative of that order, in base units (and radians), whatever was declared."""
    own = dict(system.units.inferred).get(name)
    return None if own is None else in_base_units(system, times(own, RATE, order), system.units.of(name) == "rad")


def in_base_units(system: System, dimension: Dimension, angle: bool = False) -> str | None:
    """A dimension in base units; an angle, or a rate of one, in radians."""
    text = system.units.text(dimension)
    if not angle or text is None:
        return text
    return f"rad{text.removeprefix('1')}" if dimension != NONE else "rad"
