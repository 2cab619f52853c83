"""The labels of the editor's plain text, from the table of keys: the paper's Figure 3, and what we need besides.

A text has a header, sections of ``name = value`` lines, and numbered blocks for what is listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mbsym.source import keys
from mbsym.source.grammar import BodyName, Either, Ends, Key, Kind, Kinds, Listed, Named, Record, Type, Vector, plain

ASSUMPTIONS = "assumptions"


def _labelled(table: Mapping[str, Key]) -> dict[str, str]:
    return {key.label or name: name for name, key in table.items()}


def _first(value_type: Type) -> Type:
    return value_type.types[0] if isinstance(value_type, Either) else value_type


def _is_section(value_type: Type) -> bool:
    first = _first(value_type)
    return isinstance(first, Record) or (isinstance(first, Named) and not first.one)


def _alone(section: Type) -> str | None:
    """The key of a bare first value of the lines of a section; None: the value is one expression."""
    first = _first(section)
    keyed = first.keys.values() if isinstance(first, Record) else ()
    values = [first.value] if isinstance(first, Named) else [key.type for key in keyed]
    return next((one.alone for value in values for one in plain(value) if isinstance(one, Record) and one.alone), None)


_REST = {name: key for name, key in keys.SYSTEM.items() if name not in ("mbsym", ASSUMPTIONS)}

#: What is listed in numbered blocks.
_BLOCKS = {
    name for name, key in _REST.items() if isinstance(key.type, Listed) and isinstance(key.type.item, Record | Kinds)
}

#: Sections and the key of a bare first value.
SECTIONS: dict[str, tuple[str, str | None]] = {
    label: (name, _alone(_REST[name].type)) for label, name in _labelled(_REST).items() if _is_section(_REST[name].type)
}

HEADER = {
    **{label: name for label, name in _labelled(_REST).items() if label not in SECTIONS and name not in _BLOCKS},
    "number of bodies": "number of bodies",
}

#: Of a body, those of its rotation among them.
BODY = {
    **_labelled({name: key for name, key in keys.BODY.items() if name != "rotation"}),
    **_labelled({**keys.ROTATION, "accept": keys.INERTIA["accept"]}),
}

EXPRESSION = "expression"

#: What is said in words of any language.
FREE = ("mechanical system", "description", "source", "label", "name")

#: Keys of records of which the same is true, or which name files.
FREE_KEYS = ("meaning", "file")


def _inside(kinds: Mapping[str, Kind]) -> Iterator[tuple[str, Type]]:
    """The keys of all kinds with their types; of two ends with the labels of both."""
    for kind in kinds.values():
        for name, value_type in {"": kind.type, **{name: key.type for name, key in kind.keys.items()}}.items():
            if isinstance(value_type, Ends):
                for which in ("first", "second"):
                    yield from ((f"{which} {inner}", key.type) for inner, key in value_type.record.keys.items())
            else:
                yield name, value_type


_KINDS = [*_inside(keys.LOADS), *_inside(keys.CONSTRAINTS)]

#: Labels of loads and constraints whose values may be numbers of bodies, and those whose values are vectors.
NUMBERED = {label for label, one in _KINDS if isinstance(one, BodyName)}
VECTORS = {label for label, one in _KINDS if isinstance(one, Vector)}

#: The two ends of a load or constraint: label -> (which end, its key).
ENDS = {
    label: (("first", "second").index(which), key)
    for label in sorted(NUMBERED | VECTORS)
    for which, _, key in [label.partition(" ")]
    if which in ("first", "second")
}

SPELLINGS = {
    "radius vector of mass centre": "radius vector of mass center",
    "generalised coordinates": "generalized coordinates",
    "center": "centre",
    "system": "mechanical system",
}
