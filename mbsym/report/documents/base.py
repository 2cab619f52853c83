"""What every JSON file is made of: parts with documented fields.

A field says what it is in its annotation, ``length: Annotated[float, "in metres"]``; where it says nothing, the
docstring of its type stands for it.  A field of a type with ``UnsetType`` is left out of the file where nothing is
given.  A name that is a word of Python has ``_`` behind it, which the file has not.

Other remarks in annotations: bounds and patterns (``msgspec.Meta``), ``words`` that are the only ones, ``Named`` for a
type that has a name in the schema, and those for ``mbsym.diff``: ``told_apart_by``, ``BY_COORDINATE``,
``counted_from``, ``ASIDE``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from enum import Enum
from fractions import Fraction
from functools import cache
from math import isfinite
from typing import Annotated, Any, Literal, Self, SupportsFloat, TypeVar, get_args, get_origin

from msgspec import Meta, Struct, field, to_builtins
from msgspec.structs import fields

# Documents written as text.


T = TypeVar("T")

#: With these a file begins.
_HEAD = ("format", "version", "system", "description_sha256", "values")


def version() -> str:
    """The version of mbsym that writes."""
    from mbsym import __version__

    return __version__


def headed(found: Mapping[str, T]) -> dict[str, T]:
    """The same with the head of a file before all else: what is derived from a part of another file has it last."""
    first = _HEAD if "format" in found and next(iter(found)) != "format" else ()
    return {key: found[key] for key in first if key in found} | dict(found)


def plain(value: object) -> Any:
    """A document, or a part of one, as dictionaries, lists, numbers and texts of Python's own."""
    return to_builtins(value, enc_hook=_plain)


def written(document: Struct, indent: int = 1, sort_keys: bool = False) -> str:
    """The text of a file: keys in a fixed order, the same text for the same document."""
    content = headed(plain(document))
    return json.dumps(content, indent=indent, sort_keys=sort_keys, ensure_ascii=False) + "\n"


def finite(value: SupportsFloat) -> float | None:
    """A number of a file; null in place of one that is infinite or none."""
    return float(value) if isfinite(float(value)) else None


@cache
def _required(of: type[Struct]) -> dict[str, bool]:
    """The fields without a default, and whether each is a mapping."""
    return {
        one.name: any(get_origin(x) is dict for x in (one.type, *get_args(one.type)))
        for one in fields(of)
        if one.required
    }


def _listed(value: object) -> object:
    """With lists and dictionaries for whatever is like these, and the text of rational numbers."""
    if isinstance(value, tuple):
        return [_listed(one) for one in value]
    if isinstance(value, Mapping):
        return {name: _listed(one) for name, one in value.items()}
    return str(value) if isinstance(value, Fraction) else value


def _plain(value: object) -> object:
    """Numbers of NumPy and texts of types of their own as Python's."""
    for kind in (float, int, str):
        if isinstance(value, kind):
            return kind(value)
    raise TypeError(type(value))


class Part(Struct, frozen=True, forbid_unknown_fields=True, rename=lambda name: name.rstrip("_")):
    """An object within a JSON file."""

    @classmethod
    def from_result(cls, source: object, /, **given: Any) -> Self:
        """The part with what is ``given``, its other fields from the attributes of ``source`` that have their names.

        Fields with a default keep it where they are not given.
        """
        found = given | {
            name: dict(value) if mapping and isinstance(value, tuple) else value
            for name, mapping in _required(cls).items()
            if name not in given
            for value in [getattr(source, name)]
        }
        return cls(**{name: _listed(x) for name, x in found.items()})


#: The items of a list belong to the coordinates, one each.
BY_COORDINATE = Meta(extra_json_schema={"x-indices": "coordinates"})
#: It is no result: versions, measured seconds, sentences beside codes.
ASIDE = Meta(extra_json_schema={"x-aside": True})
#: 256 bits in hexadecimal digits.
SHA256 = Meta(pattern="^[0-9a-f]{64}$")

#: The version of every format, and of the program that wrote it.
Format = Annotated[Literal[1], "version of this format"]
Version = Annotated[str, "version of mbsym that wrote it", ASIDE]
SystemName = Annotated[str, "name of the description"]


class Head(Part, frozen=True, kw_only=True):
    """What most files begin with."""

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName


class Hashed(Head, frozen=True, kw_only=True):
    """What files begin with that belong to what a description means."""

    description_sha256: Annotated[str, "SHA-256 of the description as 'mbsym convert' writes it in YAML", SHA256]


class Named(str):
    """The name of a type in the schema."""


def words(*of: type[Enum] | str | int) -> Meta:
    """It is one of these; of an enumeration, one of its names in small letters."""
    found = [word for one in of for word in ([x.name.lower() for x in one] if isinstance(one, type) else [one])]
    return Meta(extra_json_schema={"enum": list(dict.fromkeys(found))})


def told_apart_by(*properties: str) -> Meta:
    """The items of a list are told apart by these properties."""
    return Meta(extra_json_schema={"x-tell-apart": list(properties)})


def counted_from(number: int) -> Meta:
    """The items of a list are counted from this number."""
    return Meta(extra_json_schema={"x-first": number})
