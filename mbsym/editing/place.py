"""Where in a YAML description a cursor stands: the keys above it, and whether a key or a value is being written.

The text is being typed, so it need not be YAML yet: lines, indentation and brackets are looked at, nothing is parsed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

_LINE = re.compile(r"(?P<indent> *)(?P<dash>(?:- +)*)(?P<rest>.*)")
_KEY = re.compile(r"\s*(?P<key>[^\s:#,\[\]{}][^:#,\[\]{}]*?)\s*:(?:\s|$)")
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

#: So many lines above the cursor are looked at.
_MOST = 5_000


@dataclass(frozen=True, slots=True)
class Where:
    """``path`` are the keys around the cursor from the outside, ``beside`` the keys next to it.

    ``is_value``: what stands at the cursor is the value of the last key of the path; ``word`` what is written of it
    so far.
    """

    path: tuple[str, ...]
    is_value: bool
    word: str
    beside: tuple[str, ...] = ()


def where(lines: list[str], line: int, column: int) -> Where:
    """The place of a cursor; line and column count from 0."""
    written = _uncommented(lines[line][:column]) if line < len(lines) else ""
    match = _LINE.match(written)
    assert match is not None
    rest = match["rest"]
    indent = len(match["indent"]) + len(match["dash"])
    inner, tail, flow = _inside_brackets(rest)
    outside = _KEY.match(rest)
    path = list(_above(lines, line, indent if rest or match["dash"] else column))
    word = (_WORD.findall(tail) or [""])[-1] if tail and (tail[-1].isalnum() or tail[-1] == "_") else ""
    if flow:
        path += inner
        key = _KEY.match(tail)
        return Where((*path, key["key"]) if key else tuple(path), key is not None or flow == "[", word)
    if outside is not None:
        return Where((*path, outside["key"]), True, word)
    return Where(tuple(path), False, rest.strip(), _siblings(lines, line, indent))


def _uncommented(text: str) -> str:
    match = re.search(r"(?:^|\s)#", text)
    return text if match is None else text[: match.start()]


def _inside_brackets(rest: str) -> tuple[list[str], str, str]:
    """The keys whose brackets are open at the end of a line, what follows the last comma, and the last bracket."""
    opened: list[tuple[str, list[str]]] = []
    start = 0
    for position, character in enumerate(rest):
        if character in "{[":
            key = _KEY.match(rest[start:position] + " ")
            opened.append((character, [key["key"]] if key else []))
            start = position + 1
        elif character in "}]" and opened:
            opened.pop()
            start = position + 1
        elif character == ",":
            start = position + 1
    if not opened:
        return [], rest[rest.find(":") + 1 :] if _KEY.match(rest) else rest, ""
    return [key for _, keys in opened for key in keys], rest[start:].lstrip(), opened[-1][0]


def _above(lines: list[str], line: int, indent: int) -> tuple[str, ...]:
    """The keys of the lines above that are indented less and less."""
    path: list[str] = []
    least = indent
    for number in range(line - 1, max(-1, line - _MOST), -1):
        text = _uncommented(lines[number])
        if not text.strip():
            continue
        match = _LINE.match(text)
        assert match is not None
        own = len(match["indent"])
        key = _KEY.match(match["rest"])
        inside = own + len(match["dash"])
        if key is not None and inside < least:
            path.append(key["key"])
            least = own
        elif own < least and match["dash"]:
            least = own + 1  # an item without a key on its first line: its list is further out
        if least == 0:
            break
    return tuple(reversed(path))


def _siblings(lines: list[str], line: int, indent: int) -> tuple[str, ...]:
    """The keys of the same mapping."""
    siblings: list[str] = []
    for step in (-1, 1):
        number = line + step
        while 0 <= number < len(lines) and abs(number - line) < _MOST:
            text = _uncommented(lines[number])
            match = _LINE.match(text)
            assert match is not None
            if text.strip():
                inside = len(match["indent"]) + len(match["dash"])
                if inside < indent or (step == 1 and match["dash"] and inside == indent):
                    break
                key = _KEY.match(match["rest"])
                if inside == indent and key is not None:
                    siblings.append(key["key"])
                if step == -1 and match["dash"] and inside == indent:
                    break
            number += step
    return tuple(siblings)


def word_at(text: str, column: int) -> tuple[str, int, int]:
    """The word around a column of a line, and where it begins and ends; empty where there is none."""
    for match in _WORD.finditer(text):
        if match.start() <= column <= match.end():
            return match[0], match.start(), match.end()
    return "", column, column


def key_at(text: str, column: int) -> str:
    """The key around a column of a line, several words long perhaps; empty where the column is at no key."""
    for match in re.finditer(r"(?:^|[{,]|- )\s*([^\s:#,\[\]{}-][^:#,\[\]{}]*?)\s*:(?:\s|$)", text):
        if match.start(1) <= column <= match.end(1):
            return match[1]
    return ""
