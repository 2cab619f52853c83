"""Documents written as text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, TypeVar

from msgspec import Struct, to_builtins

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


def _plain(value: object) -> object:
    """Numbers of NumPy and texts of types of their own as Python's."""
    for kind in (float, int, str):
        if isinstance(value, kind):
            return kind(value)
    raise TypeError(type(value))
