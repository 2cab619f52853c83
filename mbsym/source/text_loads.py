"""Loads in the editor's plain text: the lines below ``Load description (1)`` as {kind: data}."""

from __future__ import annotations

from collections.abc import Sequence as Items
from typing import TYPE_CHECKING

from mbsym.expressions.place import Span
from mbsym.source.keys import ALIASES
from mbsym.source.labels import BETWEEN, LOAD_BODIES, LOAD_EXPRESSION, LOAD_TYPE, LOAD_VECTORS
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.text_lines import key_of, word_of
from mbsym.source.text_values import items

if TYPE_CHECKING:
    from mbsym.source.text_reader import TextReader


def load(reader: TextReader, heading: Scalar, lines: Items[Scalar]) -> Mapping | None:
    """``{kind: data}`` from the lines below ``Load description (1)``."""
    found = [(label, value) for label, value in map(reader.load_line, lines) if label is not None]
    kinds = [value for label, value in found if word_of(label.text) == LOAD_TYPE]
    if len(kinds) != 1:
        how = "no 'Type of load'" if not kinds else "a second 'Type of load'"
        place = heading.span if not kinds else kinds[1].span
        reader.error("missing-key" if not kinds else "repeated-key", f"this load has {how}", place)
        return None
    data = [(label, value) for label, value in found if word_of(label.text) != LOAD_TYPE]
    if ALIASES.get(kinds[0].text, kinds[0].text) == "generalized force":
        value: Node = Mapping(tuple(Entry(label, value) for label, value in data), kinds[0].span)
    elif len(data) == 1 and word_of(data[0][0].text) == LOAD_EXPRESSION:
        value = data[0][1]
    else:
        value = _data(reader, data, kinds[0].span)
    return Mapping((Entry(kinds[0], value),), heading.span)


def _data(reader: TextReader, data: list[tuple[Scalar, Scalar]], span: Span) -> Mapping:
    """Labels to keys; the first and second points of a spring or damper become its ``between``."""
    entries: list[Entry] = []
    points: tuple[list[Entry], list[Entry]] = ([], [])
    for label, value in data:
        word = word_of(label.text)
        if word in BETWEEN:
            which, key = BETWEEN[word]
            points[which].append(Entry(key_of(label, key), _value(reader, word, value)))
        else:
            entries.append(Entry(key_of(label, word), _value(reader, word, value)))
    if any(points):
        pair = [Mapping(tuple(point), point[0].key.span if point else span) for point in points]
        entries.append(Entry(Scalar("between", span, literal=False), Sequence(tuple(pair), span)))
    return Mapping(tuple(entries), span)


def _value(reader: TextReader, word: str, value: Scalar) -> Node:
    if word in LOAD_BODIES:
        return reader.body_reference(value)
    return items(value) if word in LOAD_VECTORS else value
