"""What every JSON file is made of: parts with documented fields.

A field says what it is in its annotation, ``length: Annotated[float, "in metres"]``; where it says nothing, the
docstring of its type stands for it.  A field of a type with ``UnsetType`` is left out of the file where nothing is
given.  A name that is a word of Python has ``_`` behind it, which the file has not.

A part fills itself from a result: a field is found there under its own name, or ``From`` says where, and its type says
what is made of it (``Part.from_result``).

Other remarks in annotations: bounds and patterns (``msgspec.Meta``), ``words`` that are the only ones, ``Named`` for a
type that has a name in the schema, and those for ``mbsym.diff``: ``told_apart_by``, ``BY_COORDINATE``,
``counted_from``, ``ASIDE``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cache
from math import isfinite
from numbers import Real
from operator import attrgetter
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, SupportsFloat, TypeVar, Union, get_args, get_origin

from msgspec import UNSET, Meta, Struct, UnsetType, field, to_builtins
from msgspec.structs import FieldInfo, fields

if TYPE_CHECKING:
    from mbsym.model.system import System

# Documents written as text.


T = TypeVar("T")

#: With these a file begins.
_HEAD = ("format", "version", "system", "description_sha256", "values")


def version() -> str:
    """The version of mbsym that writes."""
    from mbsym import __version__

    return __version__


def headed(document: Mapping[str, T]) -> dict[str, T]:
    """The same with the head of a file before all else: what is derived from a part of another file has it last."""
    first = _HEAD if "format" in document and next(iter(document)) != "format" else ()
    return {key: document[key] for key in first if key in document} | dict(document)


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


@dataclass(frozen=True)
class From:
    """Where a field is found in a result, if not under its own name: a path of attributes, ``demanded.count``.

    ``by`` says what is made of it.
    """

    path: str = ""
    by: Callable[[Any], Any] | None = None


Write = Callable[[Any], Any]
Maker = Callable[[Any, Write], Any]


@cache
def _sources(of: type[Struct]) -> dict[str, tuple[Callable[[object], Any] | None, Maker]]:
    """How each field is found in a result, None for those that have to be given, and what is made of it."""
    return {item.name: (_finder(item), _maker(item.type)) for item in fields(of)}


def _finder(item: FieldInfo) -> Callable[[object], Any] | None:
    remarks = get_args(item.type)[1:] if get_origin(item.type) is Annotated else ()
    source = next((remark for remark in remarks if isinstance(remark, From)), None)
    if source is None:
        return attrgetter(item.name) if item.required else None
    path, by = (source.path or item.name).split("."), source.by
    may_be_left_out = UnsetType in get_args(get_args(item.type)[0])

    def find(result: object) -> Any:
        for name in path:
            result = None if result is None else getattr(result, name)
        if by is not None and result is not None:
            result = by(result)
        empty = result is None or (isinstance(result, (str, tuple, list, dict)) and not result)
        return UNSET if empty and may_be_left_out else result

    return find


def _maker(hint: Any, names: Sequence[str] = ()) -> Maker:
    """What makes of a value what a field of this type has.

    Parts of results become parts, whatever is like a list or a mapping that, numbers of NumPy stay; what else has to be
    text is written.  Of an enumeration ``names`` may be the words that stand in the file.
    """
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        listed = [x.extra_json_schema.get("enum", ()) for x in inner[1:] if isinstance(x, Meta) and x.extra_json_schema]
        return _maker(inner[0], listed[0] if listed else names)
    if origin in (Union, UnionType):
        kinds = [x for x in inner if x not in (NoneType, UnsetType)]
        if len(kinds) == 1:
            make = _maker(kinds[0], names)
            if kinds[0] is float and NoneType in inner:
                return lambda value, write: None if value is None else finite(value)
            return lambda value, write: value if value is None or value is UNSET else make(value, write)
        return _leaf(names, str in kinds or any(str in get_args(x) for x in kinds))
    if origin is list:
        make = _maker(inner[0])
        return lambda values, write: [make(x, write) for x in values]
    if origin is dict:
        make = _maker(inner[1])
        return lambda values, write: {
            name: make(x, write) for name, x in (values.items() if isinstance(values, Mapping) else values)
        }
    if isinstance(origin or hint, type) and issubclass(origin or hint, Part):
        return lambda value, write: value if isinstance(value, Struct) else (origin or hint).from_result(value, write)
    if hint is float:
        return lambda value, write: (
            value if isinstance(value, Real) and not isinstance(value, Fraction) else float(value)
        )
    return _leaf(names, hint is str or isinstance(hint, TypeVar))


def _is_number(value: object) -> bool:
    """Of JSON: fractions are text."""
    return isinstance(value, Real) and not isinstance(value, Fraction)


def _leaf(names: Sequence[str], text: bool) -> Maker:
    def make(value: Any, write: Write) -> Any:
        if isinstance(value, Enum) and names:
            return value.value if value.value in names else value.name.lower()
        stays = not text or value is None or isinstance(value, (str, Enum, Struct)) or _is_number(value)
        return value if stays else write(value)

    return make


def _plain(value: object) -> object:
    """Numbers of NumPy and texts of types of their own as Python's."""
    for kind in (float, int, str):
        if isinstance(value, kind):
            return kind(value)
    raise TypeError(type(value))


def or_null(value: Any) -> Any:
    """Null in place of what is empty."""
    return value or None


class Part(Struct, frozen=True, forbid_unknown_fields=True, rename=lambda name: name.rstrip("_")):
    """An object within a JSON file."""

    @classmethod
    def from_result(cls, source: object, write: Write = str, /, **given: Any) -> Self:
        """The part with what is ``given``, its other fields from the attributes of ``source`` that have their names.

        Whatever becomes text, formulas above all, is what ``write`` makes of it.  A field with a default keeps it where
        it is neither given nor found by ``From``.  A plain tuple has the fields in their order.
        """
        sources = _sources(cls)
        if type(source) is tuple:
            given = dict(zip(sources, source, strict=len(source) > len(sources))) | given
        left = [name for name in sources if name not in given]
        if isinstance(source, Struct):  # a part of another file has them already
            values = given | {name: getattr(source, name) for name in left if hasattr(source, name)}
        else:
            values = given | {name: find(source) for name in left if (find := sources[name][0]) is not None}
        return cls(**{name: sources[name][1](x, write) for name, x in values.items()})


def file_of(kind: type[Part], system: System, source: object, write: Write = str, /, **given: Any) -> str:
    """The text of a file of this kind, which tells a result of the system: ``Part.from_result``, and its head."""
    if "description_sha256" in kind.__struct_fields__:
        from mbsym.source.yaml_writer import meaning

        given = {"description_sha256": meaning(system)} | given
    return written(kind.from_result(source, write, system=system.name, **given))


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
    listed = [
        word for choice in of for word in ([x.name.lower() for x in choice] if isinstance(choice, type) else [choice])
    ]
    return Meta(extra_json_schema={"enum": list(dict.fromkeys(listed))})


def told_apart_by(*properties: str) -> Meta:
    """The items of a list are told apart by these properties."""
    return Meta(extra_json_schema={"x-tell-apart": list(properties)})


def counted_from(number: int) -> Meta:
    """The items of a list are counted from this number."""
    return Meta(extra_json_schema={"x-first": number})
