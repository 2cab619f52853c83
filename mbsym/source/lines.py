"""Text as lines: the one notion of a line that readers and complaints share."""

from __future__ import annotations

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.safe import hides
from mbsym.source.placed import MAX_TEXT


def normalised(text: str) -> str:
    """The text with ``\\n`` for every line end, and without a byte order mark."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def check_characters(text: str, complaints: Complaints) -> bool:
    """Whether a normalised text can be read at all: of sane size, not empty, and free of control characters."""
    if len(text) > MAX_TEXT:
        complaints.error(
            "too-large",
            Message(
                "a description has at most [[most]] characters; this one has [[what]]",
                most=MAX_TEXT,
                what=len(text),
            ),
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
