"""Documents written as text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from msgspec import Struct

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


def written(document: Struct, indent: int = 1, sort_keys: bool = False) -> str:
    """The text of a file: the same text for the same document."""
    from msgspec import to_builtins

    return json.dumps(headed(to_builtins(document)), indent=indent, sort_keys=sort_keys, ensure_ascii=False) + "\n"
