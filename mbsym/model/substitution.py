"""Expressions put in for names, everywhere in a description or a part of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, names, substitute

_EXPRESSIONS = (Number, Name, Negative, Operation, Call)


def put(part: Any, images: Mapping[str, Expression]) -> Any:
    """A part of a system with names replaced in every expression; what does not change is the same object."""
    if isinstance(part, _EXPRESSIONS):
        return substitute(part, images) if names(part) & images.keys() else part
    if isinstance(part, tuple):
        return tuple(put(item, images) for item in part)
    if is_dataclass(part) and not isinstance(part, type):
        inner = {item.name: getattr(part, item.name) for item in fields(part) if item.name != "span"}
        changed = {name: new for name, old in inner.items() if (new := put(old, images)) is not old}
        return replace(part, **changed) if changed else part
    return part
