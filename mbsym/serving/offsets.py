"""Places in a text: characters, as Python counts them, and units of UTF-16, as JavaScript does."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from mbsym.expressions.place import Span


class Offsets:
    """Of one text.  Characters beyond the basic plane are two units each; a place amid the two is that of the first."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._wide = [] if text.isascii() else [place for place, x in enumerate(text) if ord(x) > 0xFFFF]
        self._wide_units = [place + k for k, place in enumerate(self._wide)]
        self._lines: list[int] | None = None

    def units(self, characters: int) -> int:
        """How many units come before a place in characters."""
        inside = min(max(characters, 0), len(self.text))
        return inside + bisect_right(self._wide, inside - 1)

    def characters(self, units: int) -> int:
        """The inverse of ``units``."""
        before = bisect_right(self._wide_units, units - 1)
        if before and self._wide_units[before - 1] == units - 1:  # amid a pair
            units -= 1
            before -= 1
        return min(max(units - before, 0), len(self.text))

    def line_start(self, line: int) -> int:
        """In characters; lines count from 1 and end at ``\\n``.  What is behind the last is the end."""
        if self._lines is None:
            self._lines = [0, *(place + 1 for place, x in enumerate(self.text) if x == "\n")]
        return self._lines[line - 1] if 0 < line <= len(self._lines) else len(self.text)

    def of_span(self, span: Span | None) -> tuple[int, int]:
        """From and to, in units; the beginning for what is about the whole."""
        if span is None:
            return 0, 0
        start = self.line_start(span.line) + span.column - 1
        return self.units(start), self.units(start + span.length)

    def in_units(self, value: Any) -> Any:
        """A JSON value whose places (keys ``from`` and ``to`` with whole numbers) are in characters, with units."""
        if self.text.isascii() or not self._wide:
            return value
        if isinstance(value, dict):
            return {
                key: self.units(x) if key in ("from", "to") and type(x) is int else self.in_units(x)
                for key, x in value.items()
            }
        return [self.in_units(x) for x in value] if isinstance(value, (list, tuple)) else value
