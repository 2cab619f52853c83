"""Which keys may stand where in a description, and what their values may be: the reader's table by paths of keys."""

from __future__ import annotations

from collections.abc import Mapping

from mbsym.source.grammar import Either, Ends, Key, Kinds, Listed, Named, Record, Type
from mbsym.source.keys import ALIASES, DESCRIPTION


def keys_in(path: tuple[str, ...]) -> Mapping[str, Key]:
    """The keys that a mapping at this place may have; none where names are chosen freely."""
    return next((keys for one in _types(path) if (keys := _keys(one))), {})


def types_at(path: tuple[str, ...]) -> list[Type]:
    """What may stand at a place, item of a list or value of a key."""
    return [plain for one in _types(path) for plain in _flat(one)]


def _types(path: tuple[str, ...]) -> list[Type]:
    found: list[Type] = [DESCRIPTION]
    for key in path:
        found = [inner for one in found for inner in _inside(one, ALIASES.get(key, key))]
    return found


def _flat(one: Type) -> list[Type]:
    """What a value, or an item of it, is: without lists and choices."""
    match one:
        case Listed(item):
            return _flat(item)
        case Either(types):
            return [inner for each in types for inner in _flat(each)]
        case Ends(record):
            return [record]
    return [one]


def _keys(one: Type) -> Mapping[str, Key]:
    for inner in _flat(one):
        match inner:
            case Record(keys):
                return keys
            case Kinds(kinds):
                return kinds
    return {}


def _inside(one: Type, key: str) -> list[Type]:
    """What the value of a key may be."""
    found: list[Type] = []
    for inner in _flat(one):
        match inner:
            case Named(value):
                found.append(value)
            case Record() | Kinds():
                keys = _keys(inner)
                found += [keys[key].type] if key in keys else []
    return found
