"""Constraints in the editor's plain text: the lines below ``Constraint description (1)`` as {kind: data}."""

from __future__ import annotations

from collections.abc import Sequence as Items
from typing import TYPE_CHECKING

from mbsym.source.labels import CONSTRAINT_BODIES, CONSTRAINT_TYPE, CONSTRAINT_VECTORS, ENDS, LOAD_EXPRESSION
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.text_lines import word_of
from mbsym.source.text_values import items

if TYPE_CHECKING:
    from mbsym.source.text_reader import TextReader


def constraint(reader: TextReader, heading: Scalar, lines: Items[Scalar]) -> Mapping | None:
    """One constraint; None, with a complaint, where its kind is missing or given twice."""
    found = [(label, value) for label, value in map(reader.load_line, lines) if label is not None]
    kinds = [value for label, value in found if word_of(label.text) == CONSTRAINT_TYPE]
    if len(kinds) != 1:
        how = "no 'Type of constraint'" if not kinds else "a second 'Type of constraint'"
        place = heading.span if not kinds else kinds[1].span
        reader.error("missing-key" if not kinds else "repeated-key", f"this constraint has {how}", place)
        return None
    data = [(label, value) for label, value in found if word_of(label.text) != CONSTRAINT_TYPE]
    return Mapping((Entry(kinds[0], _data(reader, kinds[0], data)),), heading.span)


def _data(reader: TextReader, kind: Scalar, data: list[tuple[Scalar, Scalar]]) -> Node:
    """An equation, a pair of ends, or a record that may hold a pair as its ``between``."""
    if len(data) == 1 and word_of(data[0][0].text) == LOAD_EXPRESSION:
        return data[0][1]
    entries: list[Entry] = []
    ends: tuple[list[Entry], list[Entry]] = ([], [])
    for label, value in data:
        word = word_of(label.text)
        node: Node = value
        if word in CONSTRAINT_BODIES:
            node = reader.body_reference(value)
        elif word in CONSTRAINT_VECTORS:
            node = items(value)
        which, key = ENDS.get(word, (None, word))
        entry = Entry(Scalar(key, label.span, literal=False), node)
        (entries if which is None else ends[which]).append(entry)
    pair = Sequence(tuple(Mapping(tuple(x), x[0].key.span if x else kind.span) for x in ends), kind.span)
    if any(ends) and not entries:
        return pair
    if any(ends):
        entries.append(Entry(Scalar("between", kind.span, literal=False), pair))
    return Mapping(tuple(entries), kind.span)
