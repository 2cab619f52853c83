"""What an operation means, and setting a value with what is missing on the way there."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import dataclass, field
from typing import Any

from mbsym.editing.document.pieces import Edit
from mbsym.editing.document.primitives import Add, Primitive, Replace
from mbsym.editing.document.written import Data, Path, Refused, Written, child, data_of, spelled_path
from mbsym.source.keys import BODY, SIGNS, SYSTEM
from mbsym.source.labels import SECTIONS
from mbsym.source.placed import Mapping, Node, Scalar, Sequence

Json = Map[str, Any]

#: Longer paths lead nowhere.
_DEEPEST = 12


@dataclass(slots=True)
class Meant:
    """What an operation means: primitives one after another; or, of a renaming, all at once with their edits.

    ``select`` is the path to look at afterwards, ``taken`` what goes, or is copied, with it without being named,
    ``left`` what is not copied, ``names`` the names that become others.
    """

    primitives: list[Primitive]
    edits: list[Edit] | None = None
    select: Path = ()
    taken: list[Path] = field(default_factory=list)
    left: list[Path] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)
    bodies: dict[str, str] = field(default_factory=dict)


def path_of(found: Written, operation: Json, key: str = "path") -> Path:
    given = operation.get(key)
    steps = given if isinstance(given, list | tuple) else ()
    if not 0 < len(steps) <= _DEEPEST or not all(isinstance(one, str | int) for one in steps):
        raise Refused("bad-operation", f"'{key}' is a list of keys and numbers")
    return spelled_path(found.tree, tuple(steps))


def word_of(operation: Json, key: str) -> str:
    value = operation.get(key)
    if not isinstance(value, str):
        raise Refused("bad-operation", f"'{key}' is a text")
    return value


def setting(found: Written, path: Path, data: Data, source: str | None) -> Primitive:
    """The value at a path, with what is missing on the way there."""
    node = found.tree
    for count, step in enumerate(path):
        inner = None if node is None else child(node, step)
        if inner is not None:
            node = inner
            continue
        above, rest = path[:count], path[count:]
        for one in reversed(rest[1:]):
            if isinstance(one, int) and one:
                raise Refused("bad-path", f"there is no item {one} there")
            data, source = ({one: data} if isinstance(one, str) else [data]), None
        return _missing(node, above, rest[0], data, source)
    return Replace(path, data, source)


def _missing(holder: Node | None, above: Path, step: str | int, data: Data, source: str | None) -> Primitive:
    if isinstance(holder, Mapping) and isinstance(step, str):
        if not holder.entries and above:
            return Replace(above, {step: data})
        return Add((*above, step), data, source, _neighbour(holder, above, step))
    if isinstance(holder, Sequence) and isinstance(step, int) and 0 <= step <= len(holder.items):
        return Add((*above, step), data, source) if holder.items else Replace(above, [data])
    if isinstance(holder, Sequence) and isinstance(step, str) and above == ("parameters",):
        names: dict[str, Data] = {one.text: "real" for one in holder.items if isinstance(one, Scalar)}
        return Replace(above, {**names, step: data})
    if isinstance(holder, Scalar) and above:
        if not holder.text:
            return Replace(above, {step: data} if isinstance(step, str) else [data])
        if isinstance(step, str):
            return Replace(above, {**_in_full(above, holder.text), step: data})
    if isinstance(holder, Sequence) and isinstance(step, str) and above[-1:] == ("inertia",):
        return Replace(above, {"tensor": data_of(holder), step: data})
    raise Refused("bad-path", f"there is no place for {step!r} there")


def _in_full(path: Path, text: str) -> dict[str, Data]:
    """What a value alone is short for."""
    section = path[0] if len(path) == 2 else ""
    first = None if section in ("tables", "linear system") else dict(SECTIONS.values()).get(str(section))
    if section == "parameters" and text not in SIGNS:
        first = "value"
    if first is None:
        raise Refused("bad-path", f"a value stands there already: {text[:40]}", "change it in the text")
    return {first: text}


def _neighbour(holder: Mapping, above: Path, step: str) -> str | None:
    """The key that a new one comes behind, in the order in which people write them; None: the last."""
    known = list(SYSTEM) if not above else list(BODY) if len(above) == 2 and above[0] == "bodies" else []
    if step not in known:
        return None
    before = known[: known.index(step)]
    present = [entry.key.text for entry in holder.entries]
    earlier = [one for one in present if one in before]
    return max(earlier, key=before.index) if earlier else present[0]
