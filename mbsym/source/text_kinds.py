"""Loads, constraints, claims in the editor's plain text: the lines below ``Load description (1)`` as {kind: data}."""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Map
from collections.abc import Sequence as Items
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.tree import FUNCTIONS
from mbsym.model.claims import BODY, CLAIMS
from mbsym.source.grammar import Ends, Kind, Named
from mbsym.source.keys import ALIASES
from mbsym.source.labels import ENDS, EXPRESSION, NUMBERED, VECTORS
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.text_lines import key_of, word_of

if TYPE_CHECKING:
    from mbsym.source.text_reader import TextReader


def of_kind(
    reader: TextReader, what: str, kinds: Map[str, Kind], heading: Scalar, lines: Items[Scalar]
) -> Mapping | None:
    """``{kind: data}`` from the lines of a block; None, with a complaint, where its kind is missing or given twice.

    ``what`` is load or constraint.
    """
    title = f"type of {what}"
    labelled = [(label, value) for label, value in map(reader.load_line, lines) if label is not None]
    named = [value for label, value in labelled if word_of(label.text) == title]
    if len(named) != 1:
        place = heading.span if not named else named[1].span
        text = "this [[what]] has a second '[[title]]'" if named else "this [[what]] has no '[[title]]'"
        message = Message(text, what=what, title=title.capitalize())
        reader.error("repeated-key" if named else "missing-key", message, place)
        return None
    data = [(label, value) for label, value in labelled if word_of(label.text) != title]
    kind = kinds.get(ALIASES.get(named[0].text, named[0].text))
    if kind is not None and isinstance(kind.type, Named):
        value: Node = Mapping(tuple(Entry(label, value) for label, value in data), named[0].span)
    elif len(data) == 1 and word_of(data[0][0].text) == EXPRESSION:
        value = data[0][1]
    else:
        value = _data(reader, data, named[0].span, kind is not None and isinstance(kind.type, Ends))
    return Mapping((Entry(named[0], value),), heading.span)


def _data(reader: TextReader, data: list[tuple[Scalar, Scalar]], span: Span, alone: bool) -> Node:
    """Labels to keys; two ends become ``between``, or are all there is (``alone``)."""
    entries: list[Entry] = []
    ends: tuple[list[Entry], list[Entry]] = ([], [])
    for label, value in data:
        word = word_of(label.text)
        which, key = ENDS.get(word, (None, word))
        entry = Entry(key_of(label, key), _value(reader, word, value))
        (entries if which is None else ends[which]).append(entry)
    pair = Sequence(tuple(Mapping(tuple(x), x[0].key.span if x else span) for x in ends), span)
    if any(ends) and alone and not entries:
        return pair
    if any(ends):
        entries.append(Entry(Scalar("between", span, literal=False), pair))
    return Mapping(tuple(entries), span)


def _value(reader: TextReader, word: str, value: Scalar) -> Node:
    if word in NUMBERED:
        return reader.body_reference(value)
    return items(value) if word in VECTORS else value


def claim(reader: TextReader, heading: Scalar, lines: Items[Scalar]) -> Mapping:
    """The keys of a claim, one a line; of a body the number, a state as ``theta = 0.1; theta_dot = 2``."""
    entries = []
    labelled = [(label, value) for label, value in map(reader.load_line, lines) if label is not None]
    kinds = [word_of(value.text) for label, value in labelled if word_of(label.text) == "claim"]
    about_body = any(kind in CLAIMS and CLAIMS[kind].of == BODY for kind in kinds)
    for label, value in labelled:
        word = word_of(label.text)
        node: Node = value
        if word == "of" and about_body:
            node = reader.body_reference(value)
        elif word == "entry":
            node = items(value)
        elif word == "state":
            node = reader.numbers(value)
        elif word == "place":
            node = reader.unquoted(value)
        entries.append(Entry(key_of(label, word), node))
    return Mapping(tuple(entries), heading.span)


# Values in the editor's plain text: lists in brackets, rows of a tensor, pieces between separators.


OPENING = {"(": ")", "{": "}", "[": "]"}


def items(value: Scalar) -> Node:
    """``(a, b, c)``, ``{a, b, c}`` or ``[a, b, c]``; three words without commas are three, too."""
    text = value.text
    if text[:1] not in OPENING or not encloses(text):
        return value
    inner = value.part(1, len(text) - 1)
    parts = tuple(split(inner, ",")) if inner.text else ()
    return Sequence(_three_words(inner) or parts if len(parts) == 1 else parts, value.span)


def filled(value: Scalar, vector: bool) -> Node:
    """A field of the form, where brackets may be left out: ``0, l/2, 0`` or ``0 l/2 0``, a list ``psi theta`` too."""
    read = items(value)
    if not isinstance(read, Scalar):
        return read
    parts = tuple(split(value, ",")) if value.text else ()
    if len(parts) == 1:
        words = [value.part(match.start(), match.end()) for match in re.finditer(r"\S+", value.text)]
        parts = _three_words(value) or (tuple(words) if all(x.text.isalnum() for x in words) else parts)
    return value if vector and len(parts) < 2 else Sequence(parts, value.span)


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
