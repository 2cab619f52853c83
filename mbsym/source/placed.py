"""The placed tree: what both spellings of a description are read into before anything is understood.

Three node types, each knowing where it stands.  Scalars stay text: ``no``, ``1e-3`` and ``1:30`` are the characters
that the file holds, and only the builder, which knows what a place wants, gives them a meaning.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.safe import hides

#: Bounds on a whole description.
MAX_TEXT = 256 * 1024
MAX_DEPTH = 16

#: What stands for no value in YAML, where it is not quoted.
NULL = ("~", "null")


@dataclass(frozen=True, slots=True)
class Scalar:
    """A piece of text.  ``literal`` says that its characters stand in the file one for one, from ``span`` on.

    ``columns``: where they stand, and where the text ends, if not one for one ("psi" for a Greek letter).
    """

    text: str
    span: Span
    literal: bool = True
    columns: tuple[int, ...] = ()

    def place(self, start: int, end: int) -> Span:
        """Where the characters ``start`` to ``end`` of the text stand in the file."""
        if not self.literal:
            return self.span
        if self.columns:
            first = self.columns[start]
            return Span(self.span.line, first, max(1, self.columns[max(start, end)] - first))
        return Span(self.span.line, self.span.column + start, max(1, end - start))

    def part(self, start: int, end: int) -> Scalar:
        """A piece of this scalar, without surrounding blanks, in its own place."""
        piece = self.text[start:end]
        start += len(piece) - len(piece.lstrip())
        stripped = piece.strip()
        end = start + len(stripped)
        return Scalar(stripped, self.place(start, end), self.literal, self.columns[start : end + 1])


@dataclass(frozen=True, slots=True)
class Sequence:
    items: tuple[Node, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Entry:
    key: Scalar
    value: Node


@dataclass(frozen=True, slots=True)
class Mapping:
    """Entries in the order of the file; repeated keys are still in it."""

    entries: tuple[Entry, ...]
    span: Span


Node = Scalar | Sequence | Mapping


def kind(node: Node) -> str:
    """What a message calls a node."""
    match node:
        case Mapping():
            return "a mapping"
        case Sequence():
            return "a list"
    return "a value"


class TooManyComplaints(Exception):
    """Internal to :mod:`mbsym.source`: the file is so wrong that reading on would only make noise."""


# Text as lines: the one notion of a line that readers and complaints share.


def normalised(text: str) -> str:
    """The text with ``\\n`` for every line end, and without a byte order mark."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def check_characters(text: str, complaints: Complaints) -> bool:
    """Whether a normalised text can be read at all: of sane size, not empty, and free of control characters."""
    if len(text) > MAX_TEXT:
        complaints.error(
            "too-large",
            "a description has at most [[most]] characters; this one has [[what]]",
            most=MAX_TEXT,
            what=len(text),
        )
        return False
    clean = True
    for number, line in enumerate(text.split("\n"), start=1):
        column = next((place for place, character in enumerate(line, start=1) if hides(character)), None)
        if column is not None:
            clean = False
            complaints.error(
                "control-character",
                Message(
                    "the control character U+[[code]] may not stand in a description",
                    code=f"{ord(line[column - 1]):04X}",
                ),
                Span(number, column),
            )
    return clean
