"""Which keys may stand where in a description, and what their values may be: the reader's table by paths of keys."""

from __future__ import annotations

from collections.abc import Mapping

from mbsym.source.grammar import Key, Kinds, Named, Record, Type, plain
from mbsym.source.keys import ALIASES, DESCRIPTION


def keys_in(path: tuple[str, ...]) -> Mapping[str, Key]:
    """The keys that a mapping at this place may have; none where names are chosen freely."""
    return next((keys for one in _types(path) if (keys := _keys(one))), {})


def types_at(path: tuple[str, ...]) -> list[Type]:
    """What may stand at a place, item of a list or value of a key."""
    return [inner for one in _types(path) for inner in plain(one)]


def _types(path: tuple[str, ...]) -> list[Type]:
    found: list[Type] = [DESCRIPTION]
    for key in path:
        found = [inner for one in found for inner in _inside(one, ALIASES.get(key, key))]
    return found


def _keys(one: Type) -> Mapping[str, Key]:
    for inner in plain(one):
        match inner:
            case Record(keys):
                return keys
            case Kinds(kinds):
                return kinds
    return {}


def _inside(one: Type, key: str) -> list[Type]:
    """What the value of a key may be."""
    found: list[Type] = []
    for inner in plain(one):
        match inner:
            case Named(value):
                found.append(value)
            case Record() | Kinds():
                keys = _keys(inner)
                found += [keys[key].type] if key in keys else []
    return found
