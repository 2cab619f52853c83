"""What a request holds, taken out of JSON that anybody may have written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

T = TypeVar("T")


class Wrong(Exception):
    """A request that is not of the form that was agreed upon; with words."""


def text_of(body: Mapping[str, Any], name: str = "text") -> str:
    """Raises Wrong where it is no text, here and below."""
    found = body.get(name)
    if not isinstance(found, str):
        raise Wrong(f"{name} is a text")
    return found


def flag(body: Mapping[str, Any], name: str) -> bool:
    """False where it is left out."""
    found = body.get(name, False)
    if not isinstance(found, bool):
        raise Wrong(f"{name} is true or false")
    return found


def whole(body: Mapping[str, Any], name: str) -> int:
    """A number from 0 on."""
    found = body.get(name)
    if type(found) is not int or found < 0:
        raise Wrong(f"{name} is a whole number from 0 on")
    return found


def listed(body: Mapping[str, Any], name: str, kind: type[T]) -> list[T]:
    """Of at most a thousand of a kind."""
    found = body.get(name)
    if not isinstance(found, list) or len(found) > 1000 or any(type(x) is not kind for x in found):
        raise Wrong(f"{name} is a list")
    return found


def mapping(body: Mapping[str, Any], name: str) -> dict[str, str]:
    """Names with short texts; numbers become texts.  Empty where it is left out."""
    found = body.get(name)
    if found is None:
        return {}
    kinds = (str, int, float)
    if not isinstance(found, dict) or len(found) > 1000 or any(type(x) not in kinds for x in found.values()):
        raise Wrong(f"{name} has names with numbers")
    return {key: str(value)[:200] for key, value in found.items()}
