"""Lines of the editor's plain text: without comments, cut into label and value, labels in one spelling."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mbsym.expressions.place import Span
from mbsym.source.labels import SPELLINGS
from mbsym.source.placed import Scalar

#: What begins a numbered block.
HEADING = re.compile(r"(body|load|claim|constraint) description\s*\(\s*([0-9]{1,6})\s*\)\s*\Z", re.IGNORECASE)


def lines_of(text: str) -> Iterator[Scalar]:
    """Lines that say something, without comments and surrounding blanks, each in its place."""
    for number, line in enumerate(text.split("\n"), start=1):
        whole = Scalar(line, Span(number, 1, max(1, len(line))))
        content = whole.part(0, _comment_start(line))
        if content.text:
            yield content


def _comment_start(line: str) -> int:
    """Where the comment begins: at a ``#`` outside of quotes."""
    quoted, escaped = False, False
    for position, character in enumerate(line):
        if escaped:
            escaped = False
        elif character == "\\" and quoted:
            escaped = True
        elif character == '"':
            quoted = not quoted
        elif character == "#" and not quoted:
            return position
    return len(line)


def label_of(line: Scalar) -> tuple[Scalar | None, Scalar]:
    """``label: value`` cut at its first colon or equals sign; no label where there is neither."""
    match = re.search(r"[:=]", line.text)
    if match is None:
        return None, line
    return line.part(0, match.start()), line.part(match.end(), len(line.text))


def label_in(part: Scalar) -> tuple[Scalar | None, Scalar]:
    """``key = value`` within a record; what stands in quotes has no key, whatever it holds."""
    return (None, part) if part.text.startswith('"') or "=" not in part.text else label_of(part)


def word_of(text: str) -> str:
    word = " ".join(text.lower().split())
    return SPELLINGS.get(word, word)


def key_of(label: Scalar, key: str) -> Scalar:
    """A key in place of the label that stands for it."""
    return Scalar(key, label.span, literal=False)
