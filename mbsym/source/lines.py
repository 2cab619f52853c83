"""Text as lines: the one notion of a line that readers and complaints share."""

from __future__ import annotations

from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.safe import hides
from mbsym.source.placed import MAX_TEXT


def normalised(text: str) -> str:
    """The text with ``\\n`` for every line end, and without a byte order mark."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def check_characters(text: str, complaints: Complaints) -> bool:
    """Whether a normalised text can be read at all: of sane size, not empty, and free of control characters."""
    if len(text) > MAX_TEXT:
        complaints.error("too-large", f"a description has at most {MAX_TEXT} characters; this one has {len(text)}")
        return False
    clean = True
    for number, line in enumerate(text.split("\n"), start=1):
        column = next((place for place, character in enumerate(line, start=1) if hides(character)), None)
        if column is not None:
            clean = False
            complaints.error(
                "control-character",
                f"the control character U+{ord(line[column - 1]):04X} may not stand in a description",
                Span(number, column),
            )
    return clean
