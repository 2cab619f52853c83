"""Edits of a text, and several of them one after another as one set of edits of the first text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, order=True)
class Edit:
    """The characters ``start`` to ``end`` of a text become ``insert``."""

    start: int
    end: int
    insert: str


def applied(text: str, edits: Iterable[Edit]) -> str:
    """The text after edits that do not overlap."""
    parts, position = [], 0
    for edit in sorted(edits, key=lambda one: (one.start, one.end)):
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
        behind = sorted(edits, key=lambda one: (one.start, one.end))
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
