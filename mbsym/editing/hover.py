"""What a word of a description means: a key by the reader's own tables, a name by what was declared and derived."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from mbsym.editing.completion import keys_in
from mbsym.editing.place import key_at, where, word_at
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import text as written
from mbsym.model.claims import CLAIMS
from mbsym.source.keys import ALIASES

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.formulas.formula import Column, Formula

#: A derived formula with more terms is counted.
MOST_TERMS = 40


_PUNCTUATION = re.compile(r"([\\`*_\[\]<>&~|!#$])")


def explanation(text: str, line: int, column: int, analysis: Analysis | None = None) -> str | None:
    """Markdown about the word at a place (from 0), or None where there is nothing to say.

    ``analysis`` is that of the last text that could be read: what is derived comes from it.
    """
    lines = text.split("\n")
    if line >= len(lines):
        return None
    key = key_at(lines[line], column)
    place = where(lines, line, len(lines[line][:column]) if not key else lines[line].index(key))
    if key:
        known = keys_in(place.path if not place.is_value else place.path[:-1])
        definition = known.get(ALIASES.get(key, key))
        if definition is not None:
            return f"**{plain(key)}**: {definition.meaning}"
    value = lines[line][lines[line].find(":") + 1 :].strip(" {}[],")
    if value in CLAIMS:
        return f"**{value}**: {CLAIMS[value].meaning}"
    if analysis is None:
        return None
    word, _, _ = word_at(lines[line], column)
    return _name(word, analysis) or _body(value, analysis) or _body(word, analysis)


def _name(word: str, analysis: Analysis) -> str | None:
    """A parameter, coordinate, velocity, prescribed motion, notation."""
    system = analysis.system
    unit = system.units.of(word)
    unit_text = f" {plain(f'[{unit}]')}" if unit else ""
    for parameter in system.parameters:
        if parameter.name == word:
            value = "" if parameter.value is None else f" = {code(written(parameter.value))}"
            meaning = f": {plain(parameter.meaning)}" if parameter.meaning else ""
            return f"**{plain(word)}**{value}{unit_text}, {parameter.sign}{meaning}"
    name = without_velocity(word)
    if name in system.coordinates:
        body = next(body.name for body in system.bodies if name in body.coordinates)
        parts = [f"**{plain(word)}**{unit_text}: {'velocity of ' if name != word else ''}a coordinate of {plain(body)}"]
        energy = _or_none(lambda: analysis.energy)
        if energy is not None and name in energy.cyclic:
            parts.append("cyclic: T and U do not hold it")
        return "; ".join(parts)
    steady = system.of_constant_rate
    others = {x.name: f"{unit_text}: prescribed, {plain(x.name)}' = {code(written(x.rate))}" for x in steady}
    for what, records in (("a function of time", system.given), ("an input", system.inputs)):
        others |= {x.name: f"{unit_text}: {what}" + (f", {plain(x.meaning)}" if x.meaning else "") for x in records}
    others |= {x.name: f" = {code(written(x.value))}" for x in system.notation}
    return f"**{plain(word)}**{others[word]}" if word in others else None


def _body(word: str, analysis: Analysis) -> str | None:
    """A body with its angular velocity and the velocity of its mass centre, in its own axes."""
    if not any(body.name == word for body in analysis.system.bodies):
        return None
    kinematics = _or_none(lambda: analysis.kinematics)
    if kinematics is None:
        return f"**{plain(word)}**: a body"
    motion = kinematics.body(word)
    return "\n\n".join(
        [
            f"**{plain(word)}**, in its own axes",
            f"angular velocity: {_vector(motion.angular_velocity)}",
            f"velocity of the mass centre: {_vector(motion.velocity_mass_centre)}",
        ]
    )


def _vector(column: Column) -> str:
    return code("[" + ", ".join(map(_shown, column)) + "]")


def _shown(formula: Formula) -> str:
    return str(formula) if formula.terms <= MOST_TERMS else f"({formula.terms} terms)"


def _or_none(derive):  # type: ignore[no-untyped-def]
    from mbsym.algebra.failures import Failure
    from mbsym.analysis.stages import Unavailable

    try:
        return derive()
    except (Unavailable, Failure):
        return None


def plain(text: str) -> str:
    r"""Text as it is; what could mean more is escaped.

    >>> plain("a*b ![x](y)")
    'a\\*b \\!\\[x\\](y)'
    """
    shown = "".join(character if character.isprintable() else " " for character in text)
    return _PUNCTUATION.sub(r"\\\1", shown)


def code(text: str) -> str:
    """A formula as code; formulas hold no backticks."""
    return f"`{text.replace('`', ' ')}`"
