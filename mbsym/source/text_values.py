"""Values in the editor's plain text: lists in brackets, rows of a tensor, pieces between separators."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mbsym.expressions.tree import FUNCTIONS
from mbsym.source.placed import Node, Scalar, Sequence

OPENING = {"(": ")", "{": "}", "[": "]"}


def items(value: Scalar) -> Node:
    """``(a, b, c)``, ``{a, b, c}`` or ``[a, b, c]``; three words without commas are three, too."""
    text = value.text
    if text[:1] not in OPENING or not encloses(text):
        return value
    inner = value.part(1, len(text) - 1)
    parts = tuple(split(inner, ",")) if inner.text else ()
    return Sequence(_three_words(inner) or parts if len(parts) == 1 else parts, value.span)


def _three_words(line: Scalar) -> tuple[Scalar, ...]:
    """``0 l/2 0``: each of them an expression by itself; none where they are not three."""
    words = [line.part(match.start(), match.end()) for match in re.finditer(r"\S+", line.text)]
    bare = any(x.text in ("+", "-", "*", "/", "**") or x.text in FUNCTIONS or x.text[-1] in "+-*/" for x in words)
    return tuple(words) if len(words) == 3 and not bare else ()


def row(line: Scalar) -> Node:
    """A row of a tensor: ``a, b, c``, ``(a, b, c)``, or three words without commas."""
    if line.text[:1] in OPENING and line.text[-1:] == OPENING[line.text[0]] and encloses(line.text):
        return items(line)
    parts = list(split(line, ","))
    if len(parts) == 1 and line.text.startswith("|") and line.text.endswith("|") and len(line.text) > 1:
        parts = list(split(line.part(1, len(line.text) - 1), "|"))
    return Sequence(_three_words(line) or tuple(parts) if len(parts) == 1 else tuple(parts), line.span)


def encloses(text: str) -> bool:
    """Whether the bracket that opens a text closes at its very end."""
    depth = 0
    for position, character in enumerate(text):
        if character in OPENING:
            depth += 1
        elif character in OPENING.values():
            depth -= 1
            if depth == 0:
                return position == len(text) - 1
    return False


def split(value: Scalar, separator: str) -> Iterator[Scalar]:
    """Pieces between separators that stand outside of brackets and quotes."""
    depth, start, quoted, escaped = 0, 0, False, False
    for position, character in enumerate(value.text):
        if escaped:
            escaped = False
        elif character == "\\" and quoted:
            escaped = True
        elif character == '"':
            quoted = not quoted
        elif quoted:
            continue
        elif character in OPENING:
            depth += 1
        elif character in OPENING.values():
            depth -= 1
        elif character == separator and depth == 0:
            yield value.part(start, position)
            start = position + 1
    yield value.part(start, len(value.text))
