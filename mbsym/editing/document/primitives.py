"""The few things that every operation comes down to, and what they do to the data of a description.

Each is done twice: to the data here, and to the text by ``yaml_edits`` or ``text_edits``; the text that comes
out has to say the data that come out.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

from mbsym.editing.document.written import Data, Path, Refused


@dataclass(frozen=True, slots=True)
class Replace:
    """The value at a path becomes ``data``, spelled as ``source`` where that is given."""

    path: Path
    data: Data
    source: str | None = None


@dataclass(frozen=True, slots=True)
class Add:
    """A new entry of a mapping, behind the entry ``after`` (None: the last), or item of a list, at its index."""

    path: Path
    data: Data
    source: str | None = None
    after: str | None = None


@dataclass(frozen=True, slots=True)
class Remove:
    path: Path


@dataclass(frozen=True, slots=True)
class Rekey:
    """The key at the end of a path becomes another."""

    path: Path
    key: str


@dataclass(frozen=True, slots=True)
class Shift:
    """An item, or entry, comes before another of the same list or mapping (``before``), or last (None)."""

    path: Path
    before: str | int | None


Primitive = Replace | Add | Remove | Rekey | Shift


def applied_to(data: Data, primitive: Primitive) -> Data:
    """The data after a primitive; those given are left alone."""
    if not primitive.path:
        raise Refused("bad-path", "the whole description is no part of itself")
    changed = deepcopy(data)
    holder = changed
    for step in primitive.path[:-1]:
        holder = _step(holder, step)
    _do(holder, primitive.path[-1], primitive)
    return changed


def _step(data: Data, step: str | int) -> Data:
    if isinstance(data, dict) and isinstance(step, str) and step in data:
        return data[step]
    if isinstance(data, list) and isinstance(step, int) and 0 <= step < len(data):
        return data[step]
    raise Refused("bad-path", f"there is no {step!r} there")


def _do(holder: Data, last: str | int, primitive: Primitive) -> None:
    if isinstance(holder, dict) and isinstance(last, str):
        _in_mapping(holder, last, primitive)
    elif isinstance(holder, list) and isinstance(last, int):
        _in_list(holder, last, primitive)
    else:
        raise Refused("bad-path", f"there is no {last!r} there")


def _in_mapping(holder: dict[str, Data], key: str, primitive: Primitive) -> None:
    if not isinstance(primitive, Add) and key not in holder:
        raise Refused("bad-path", f"there is no '{key}' there")
    match primitive:
        case Replace(data=data):
            holder[key] = data
        case Remove():
            del holder[key]
        case Add(data=data, after=after):
            items = list(holder.items())
            place = next((k + 1 for k, (name, _) in enumerate(items) if name == after), len(items))
            _refill(holder, [*items[:place], (key, data), *items[place:]])
        case Rekey(key=new):
            if new in holder:
                raise Refused("repeated-key", f"'{new}' is there already")
            _refill(holder, [(new if name == key else name, value) for name, value in holder.items()])
        case Shift(before=before):
            rest = [(name, value) for name, value in holder.items() if name != key]
            place = next((k for k, (name, _) in enumerate(rest) if name == before), len(rest))
            _refill(holder, [*rest[:place], (key, holder[key]), *rest[place:]])


def _refill(holder: dict[str, Data], items: list[tuple[str, Data]]) -> None:
    holder.clear()
    holder.update(items)


def _in_list(holder: list[Data], index: int, primitive: Primitive) -> None:
    if not 0 <= index < len(holder) + isinstance(primitive, Add):
        raise Refused("bad-path", f"there is no item {index} there")
    match primitive:
        case Replace(data=data):
            holder[index] = data
        case Remove():
            del holder[index]
        case Add(data=data):
            holder.insert(index, data)
        case Shift(before=before):
            item = holder.pop(index)
            place = len(holder) if not isinstance(before, int) else before - (before > index)
            holder.insert(place, item)
        case Rekey():
            raise Refused("bad-path", "an item of a list has no key")
