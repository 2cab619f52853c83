"""What an operation means, and setting a value with what is missing on the way there."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Mapping as Map
from dataclasses import dataclass, field
from typing import Any

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


def path_of(document: Written, operation: Json, key: str = "path") -> Path:
    value = operation.get(key)
    steps = value if isinstance(value, list | tuple) else ()
    if not 0 < len(steps) <= _DEEPEST or not all(isinstance(step, str | int) for step in steps):
        raise Refused("bad-operation", f"'{key}' is a list of keys and numbers")
    return spelled_path(document.tree, tuple(steps))


def word_of(operation: Json, key: str) -> str:
    value = operation.get(key)
    if not isinstance(value, str):
        raise Refused("bad-operation", f"'{key}' is a text")
    return value


def setting(document: Written, path: Path, data: Data, source: str | None) -> Primitive:
    """The value at a path, with what is missing on the way there."""
    node = document.tree
    for count, step in enumerate(path):
        inner = None if node is None else child(node, step)
        if inner is not None:
            node = inner
            continue
        above, rest = path[:count], path[count:]
        for key in reversed(rest[1:]):
            if isinstance(key, int) and key:
                raise Refused("bad-path", f"there is no item {key} there")
            data, source = ({key: data} if isinstance(key, str) else [data]), None
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
        names: dict[str, Data] = {item.text: "real" for item in holder.items if isinstance(item, Scalar)}
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
    earlier = [key for key in present if key in before]
    return max(earlier, key=before.index) if earlier else present[0]


# Edits of a text, and several of them one after another as one set of edits of the first text.


@dataclass(frozen=True, slots=True, order=True)
class Edit:
    """The characters ``start`` to ``end`` of a text become ``insert``."""

    start: int
    end: int
    insert: str


def applied(text: str, edits: Iterable[Edit]) -> str:
    """The text after edits that do not overlap."""
    parts, position = [], 0
    for edit in sorted(edits, key=lambda change: (change.start, change.end)):
        assert edit.start >= position, "edits overlap"
        parts += [text[position : edit.start], edit.insert]
        position = edit.end
    return "".join(parts) + text[position:]


@dataclass(frozen=True, slots=True)
class _Kept:
    """Characters of the first text."""

    start: int
    end: int

    def __len__(self) -> int:
        return self.end - self.start

    def cut(self, start: int, end: int) -> _Kept:
        return _Kept(self.start + start, self.start + end)


@dataclass(frozen=True, slots=True)
class _New:
    text: str

    def __len__(self) -> int:
        return len(self.text)

    def cut(self, start: int, end: int) -> _New:
        return _New(self.text[start:end])


class Pieces:
    """A text as pieces of the first one and what was written between them."""

    def __init__(self, text: str) -> None:
        self.length = len(text)
        self.pieces: list[_Kept | _New] = [_Kept(0, len(text))]

    def edit(self, edits: Iterable[Edit]) -> None:
        """Edits of the text as it now stands, none overlapping another."""
        # From behind; of several at one place the last first, so that they stand in their order.
        behind = sorted(edits, key=lambda change: (change.start, change.end))
        behind.reverse()
        for edit in behind:
            before, after, position = [], [], 0
            for piece in self.pieces:
                end = position + len(piece)
                if position < edit.start:
                    before.append(piece.cut(0, min(len(piece), edit.start - position)))
                if end > edit.end:
                    after.append(piece.cut(max(0, edit.end - position), len(piece)))
                position = end
            self.pieces = [*before, *([_New(edit.insert)] if edit.insert else []), *after]

    def edits(self) -> tuple[Edit, ...]:
        """What has become of the first text."""
        found, position, inserted = [], 0, ""
        for piece in [*self.pieces, _Kept(self.length, self.length)]:
            if isinstance(piece, _New):
                inserted += piece.text
                continue
            if inserted or piece.start > position:
                found.append(Edit(position, piece.start, inserted))
            position, inserted = piece.end, ""
        return tuple(found)
