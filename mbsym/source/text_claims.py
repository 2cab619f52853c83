"""Claims in the editor's plain text: the lines below ``Claim description (1)`` as the keys of a claim."""

from __future__ import annotations

from collections.abc import Sequence as Items
from typing import TYPE_CHECKING

from mbsym.model.claims import BODY, CLAIMS
from mbsym.source.placed import Entry, Mapping, Node, Scalar
from mbsym.source.text_lines import key_of, word_of
from mbsym.source.text_values import items

if TYPE_CHECKING:
    from mbsym.source.text_reader import TextReader


def claim(reader: TextReader, heading: Scalar, lines: Items[Scalar]) -> Mapping:
    """The keys of a claim, one a line; of a body the number, a state as ``theta = 0.1; theta_dot = 2``."""
    entries = []
    found = [(label, value) for label, value in map(reader.load_line, lines) if label is not None]
    kinds = [word_of(value.text) for label, value in found if word_of(label.text) == "claim"]
    about_body = any(kind in CLAIMS and CLAIMS[kind].of == BODY for kind in kinds)
    for label, value in found:
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
