"""What may be written at a place: keys with their meanings, names of the description, words of a fixed set."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from mbsym.editing.place import Where, where
from mbsym.expressions.tree import FUNCTIONS
from mbsym.model.oscillation_names import names_in, oscillating_variables, oscillation_names
from mbsym.model.system import System, velocity_name
from mbsym.source.grammar import (
    About,
    BodyName,
    Equation,
    Formula,
    Index,
    Key,
    Kinds,
    Name,
    Named,
    Record,
    Type,
    Vector,
    Word,
    plain,
)
from mbsym.source.keys import ALIASES, DESCRIPTION, SIGNS

_DECLARED = re.compile(r"^\s+([A-Za-z][A-Za-z0-9_]*)\s*:", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Suggestion:
    """``kind`` is key, name, body, function or word; ``insert`` what is written, a key with its colon."""

    label: str
    kind: str
    meaning: str = ""
    insert: str = ""


def suggestions(text: str, line: int, column: int, system: System | None = None) -> list[Suggestion]:
    """What may stand at a place (from 0), in the order in which people want it.

    ``system`` is the last one that could be read of the description, for its names; without one those that the text
    declares as parameters are found by their look.
    """
    lines = text.split("\n")
    place = where(lines, line, column)
    if place.is_value and not place.path:
        return []
    if place.is_value:
        return list(_values(place, text, system))
    known = keys_in(place.path)
    keys = [Suggestion(key, "key", rule.meaning, f"{key}: ") for key, rule in known.items() if key not in place.beside]
    if keys or not any(isinstance(value_type, Named) and value_type.of for value_type in types_at(place.path)):
        return keys
    return [Suggestion(name, "name", "a coordinate", f"{name}: ") for name in _coordinates(system)]


def _values(place: Where, text: str, system: System | None) -> Iterator[Suggestion]:
    types = types_at(place.path)
    if place.path == ("parameters",):
        yield from (Suggestion(sign, "word", "its sign", sign) for sign in SIGNS)
    elif words := [str(word) for value_type in types if isinstance(value_type, Word) for word in value_type.choices]:
        yield from (Suggestion(word, "word", insert=word) for word in words)
    elif any(isinstance(value_type, BodyName) and not value_type.new for value_type in types):
        yield Suggestion("0", "body", "the inertial frame", "0")
        yield from (Suggestion(body.name, "body", "a body", body.name) for body in (system.bodies if system else ()))
    elif any(isinstance(value_type, Name) for value_type in types):
        yield from (Suggestion(name, "name", "a coordinate", name) for name in _coordinates(system))
    elif not types or any(isinstance(value_type, Formula | Vector | Equation | Index | About) for value_type in types):
        yield from _names(text, system, "loads" in place.path or "claims" in place.path)
        if system is not None and system.small is not None and place.path[0] in ("claims", "abbreviations"):
            symbols = oscillation_names(oscillating_variables(system), names_in(system)).all
            yield from (Suggestion(name, "name", "a symbol of an oscillation", name) for name in symbols)


def _coordinates(system: System | None) -> Iterable[str]:
    return system.coordinates if system else ()


def _names(text: str, system: System | None, velocities: bool) -> Iterator[Suggestion]:
    """Every name that an expression may hold."""
    if system is None:
        section = re.search(r"^parameters:\s*\n((?:[ \t]+.*\n|\s*\n)*)", text, re.MULTILINE)
        names = _DECLARED.findall(section[1]) if section else []
        yield from (Suggestion(name, "name", "a parameter", name) for name in names)
    else:
        named = [
            *((x.name, x.meaning or "a parameter") for x in system.parameters),
            *((name, "a coordinate") for name in system.coordinates),
            *((velocity_name(name), "a velocity") for name in system.coordinates if velocities),
            *((x.name, x.meaning or "prescribed") for x in system.of_constant_rate),
            *((x.name, x.meaning or "a function of time") for x in system.given),
            *((x.name, x.meaning or "an input") for x in system.inputs),
            *((x.name, "a notation") for x in system.notation),
        ]
        yield from (Suggestion(name, "name", meaning, name) for name, meaning in named)
        yield from (Suggestion(table.name, "function", "a table", f"{table.name}(") for table in system.tables)
    yield from (Suggestion(name, "function", "", f"{name}(") for name in FUNCTIONS)
    yield Suggestion("pi", "word", "3.14159...", "pi")


# Which keys may stand where in a description, and what their values may be: the reader's table by paths of keys.


def keys_in(path: tuple[str, ...]) -> Mapping[str, Key]:
    """The keys that a mapping at this place may have; none where names are chosen freely."""
    return next((keys for value_type in _types(path) if (keys := _keys(value_type))), {})


def types_at(path: tuple[str, ...]) -> list[Type]:
    """What may stand at a place, item of a list or value of a key."""
    return [inner for value_type in _types(path) for inner in plain(value_type)]


def _types(path: tuple[str, ...]) -> list[Type]:
    types: list[Type] = [DESCRIPTION]
    for key in path:
        types = [inner for value_type in types for inner in _inside(value_type, ALIASES.get(key, key))]
    return types


def _keys(value_type: Type) -> Mapping[str, Key]:
    for inner in plain(value_type):
        match inner:
            case Record(keys):
                return keys
            case Kinds(kinds):
                return kinds
    return {}


def _inside(value_type: Type, key: str) -> list[Type]:
    """What the value of a key may be."""
    types: list[Type] = []
    for inner in plain(value_type):
        match inner:
            case Named(value):
                types.append(value)
            case Record() | Kinds():
                keys = _keys(inner)
                types += [keys[key].type] if key in keys else []
    return types
