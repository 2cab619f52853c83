"""YAML to the placed tree, over the event stream of PyYAML.

The events carry marks and keep scalars as text, and composing them here (instead of with ``yaml.compose``) bounds the
depth before any recursion and refuses anchors, aliases, tags and second documents where they stand: a description is a
plain tree, and what it says must not depend on YAML's finer points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

import yaml

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.safe import hides
from mbsym.source.keys import BODY, CONSTRAINTS, LOADS, SYSTEM
from mbsym.source.placed import MAX_DEPTH, NULL, Entry, Mapping, Node, Scalar, Sequence

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_Collection = TypeVar("_Collection", Sequence, Mapping)

#: More open brackets than this are refused before the scanner sees them: its work grows with their square.
_MAX_BRACKETS = 100


class _Refused(Exception):
    """Internal: the document cannot be composed; the complaint is recorded."""


@dataclass(frozen=True, slots=True)
class Extent:
    """Where a node stands as written: the characters ``start`` to ``end`` of the normalised text, quotes included.

    ``style``: of a scalar "" (plain), ', ", | or >; of a collection "flow" or "block".  What an indented scalar or
    collection ends with (blank lines, comments) may be counted in.
    """

    start: int
    end: int
    style: str


def read_yaml(text: str, complaints: Complaints, extents: dict[int, Extent] | None = None) -> Node | None:
    """The placed tree of a YAML text (already normalised), or None with complaints.

    ``extents`` is filled with where each node stands, by ``id(node)``.
    """
    if not _brackets_bounded(text, complaints):
        return None
    try:
        return (_Composer(text, complaints) if extents is None else _Marking(text, complaints, extents)).document()
    except _Refused:
        return None
    except yaml.MarkedYAMLError as error:
        span = _mark_span(text, error)
        tab = _tab(text, span)
        if tab is not None:
            complaints.error("syntax", "this is not YAML: a tab in the indentation", tab, "indent with blanks")
        else:
            key = _key_without_colon(text, error)
            complaints.error("syntax", _problem(error), span if key is None else key.span, _hint(error, key))
    except yaml.YAMLError as error:
        complaints.error("syntax", Message("this is not YAML: [[why]]", why=str(error).splitlines()[0]))
    return None


def _brackets_bounded(text: str, complaints: Complaints) -> bool:
    depth = 0
    for offset, character in enumerate(text):
        if character in "[{":
            depth += 1
            if depth > _MAX_BRACKETS:
                line_start = text.rfind("\n", 0, offset) + 1
                place = Span(text.count("\n", 0, offset) + 1, offset - line_start + 1)
                complaints.error("too-deep", "more than [[most]] brackets are open here", place, most=_MAX_BRACKETS)
                return False
        elif character in "]}":
            depth = max(0, depth - 1)
    return True


def _tab(text: str, span: Span | None) -> Span | None:
    """The tab that indents the line of an error, or the line above it."""
    lines = text.split("\n")
    for line in (span.line, span.line - 1) if span is not None else ():
        content = lines[line - 1] if line else ""
        column = content[: len(content) - len(content.lstrip(" \t"))].find("\t")
        if column >= 0:
            return Span(line, column + 1)
    return None


def _problem(error: yaml.MarkedYAMLError) -> str:
    problem = error.problem or error.context or "not YAML"
    return Message("this is not YAML: [[problem]]", problem=problem)


def _key_without_colon(text: str, error: yaml.MarkedYAMLError) -> Scalar | None:
    """What YAML took for a key and has no colon: it complains of the line below."""
    if "could not find expected ':'" not in (error.problem or "") or error.context_mark is None:
        return None
    line, column = _inside(text.split("\n"), error.context_mark)
    whole = text.split("\n")[line]
    return Scalar(whole, Span(line + 1, 1)).part(column, len(whole))


#: Keys of more than a word; other keys, and names, are one.
_KNOWN = [key for keys in (SYSTEM, BODY, LOADS, CONSTRAINTS) for key in keys if " " in key]


def _hint(error: yaml.MarkedYAMLError, key: Scalar | None) -> str | None:
    problem = error.problem or ""
    if key is not None:
        first = key.text.partition(" ")[0]
        name = max((known_key for known_key in _KNOWN if key.text.startswith(f"{known_key} ")), key=len, default=first)
        value = key.text[len(name) :].strip()
        text = "a key ends with a colon and a blank: write [[name]]: [[value]]"
        return Message(text, name=name, value=value) if value else Message("a key ends with a colon and a blank")
    if "expected '-' indicator" in problem:
        return Message(
            "items of a list begin with '- ', one below the other; their other lines begin below the first key"
        )
    if "cannot start any token" in problem:
        return Message("put values with special characters in quotes")
    if "mapping values are not allowed" in problem:
        return Message("is the line indented as its neighbours are? A value with ': ' in it needs quotes")
    if "expected ',' or" in problem or "did not find expected" in problem:
        return Message("look for a missing bracket, comma or quote here or above")
    return None


def _mark_span(text: str, error: yaml.MarkedYAMLError) -> Span | None:
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return None
    line, column = _inside(text.split("\n"), mark)
    return Span(line + 1, column + 1)


class _Composer:
    """Events to nodes, with an explicit depth."""

    def __init__(self, text: str, complaints: Complaints) -> None:
        self.lines = text.split("\n")
        self.complaints = complaints
        self.events = yaml.parse(text, Loader=_Loader)

    def document(self) -> Node | None:
        next(self.events)  # stream start
        event = next(self.events)
        if isinstance(event, yaml.StreamEndEvent):
            self.complaints.error("empty", "there is no description in this file")
            return None
        node = self.node(next(self.events), 0)
        next(self.events)  # document end
        event = next(self.events)
        if not isinstance(event, yaml.StreamEndEvent):
            message = "a description is one document; here a second one begins"
            self.complaints.error("several-documents", message, self.span(event))
            return None
        if isinstance(node, Scalar) and not node.text:
            self.complaints.error("empty", "there is no description in this file")
            return None
        return node

    def node(self, event: Any, depth: int) -> Node:
        self.refuse_fineries(event)
        if depth > MAX_DEPTH:
            self.complaints.error(
                "too-deep", "lists and mappings nest at most [[most]] deep", self.span(event), most=MAX_DEPTH
            )
            raise _Refused
        if isinstance(event, yaml.SequenceStartEvent):
            return self.sequence(event, depth)
        if isinstance(event, yaml.MappingStartEvent):
            return self.mapping(event, depth)
        return self.scalar(event)

    def value(self, event: Any, depth: int) -> Node:
        """The node of a value; YAML's words for none, without quotes, are no text."""
        if isinstance(event, yaml.ScalarEvent) and not event.style and event.value in NULL:
            event.value = ""
        return self.node(event, depth)

    def sequence(self, start: Any, depth: int) -> Sequence:
        items: list[Node] = []
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            items.append(self.value(event, depth + 1))
        return Sequence(tuple(items), self.collection_span(start, event, items[0].span if items else None))

    def mapping(self, start: Any, depth: int) -> Mapping:
        entries: list[Entry] = []
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            key = self.node(event, depth + 1)
            value = self.value(next(self.events), depth + 1)
            if isinstance(key, Scalar):
                entries.append(Entry(key, value))
            else:
                self.complaints.error("wrong-shape", "a key is a word, not a list or a mapping", key.span)
        first = entries[0].key.span if entries else None
        return Mapping(tuple(entries), self.collection_span(start, event, first))

    def scalar(self, event: Any) -> Scalar:
        """A scalar and whether its text stands in the file as it is (plain or simply quoted, on one line)."""
        line, start = _inside(self.lines, event.start_mark)
        last_line, end = _inside(self.lines, event.end_mark)
        quote = 1 if event.style in ("'", '"') else 0
        raw = self.lines[line][start + quote : end - quote] if line == last_line else None
        if raw == event.value:
            return Scalar(event.value, Span(line + 1, start + 1 + quote, max(1, len(event.value))))
        return Scalar(self.without_control(event), self.span(event), literal=False)

    def without_control(self, event: Any) -> str:
        """The text of a scalar, which escapes may have filled with what may not stand in the file itself."""
        text = str(event.value)
        hidden = [character for character in text if character != "\n" and hides(character)]
        if hidden:
            named = ", ".join([f"U+{ord(character):04X}" for character in dict.fromkeys(hidden)][:5])
            message = Message(
                "this text holds control characters ([[named]]), which may not stand in a description", named=named
            )
            self.complaints.error("control-character", message, self.span(event), "leave the escapes out")
        return "".join(character for character in text if character not in hidden) if hidden else text

    def refuse_fineries(self, event: Any) -> None:
        if isinstance(event, yaml.AliasEvent):
            message = Message("aliases are not used in descriptions: '*[[anchor]]'", anchor=event.anchor)
            self.complaints.error("alias", message, self.span(event), "write the value out, or quote the text")
            raise _Refused
        if event.anchor is not None:
            message = Message("anchors are not used in descriptions: '&[[anchor]]'", anchor=event.anchor)
            self.complaints.error("alias", message, self.span(event), "write the value out, or quote the text")
        if event.tag is not None:
            hint = "leave the tag out, or quote the text"
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            self.complaints.error(
                "tag", Message("tags are not used in descriptions: '[[tag]]'", tag=tag), self.span(event), hint
            )

    def span(self, event: Any) -> Span:
        """From the beginning of an event to its end, or to the end of its first line."""
        return self.between(event.start_mark, event.end_mark)

    def between(self, first: Any, last: Any) -> Span:
        line, start = _inside(self.lines, first)
        last_line, end = _inside(self.lines, last)
        stop = end if last_line == line else len(self.lines[line].rstrip())
        return Span(line + 1, start + 1, max(1, stop - start))

    def collection_span(self, start: Any, end: Any, first: Span | None) -> Span:
        """A collection in brackets is underlined from bracket to bracket, another one at its first word."""
        if not start.flow_style and first is not None:
            return first
        return self.between(start.start_mark, end.end_mark)


class _Marking(_Composer):
    """The same, and keeps where each node stands."""

    def __init__(self, text: str, complaints: Complaints, extents: dict[int, Extent]) -> None:
        super().__init__(text, complaints)
        self.extents = extents
        self.ended: Any = None

    def scalar(self, event: Any) -> Scalar:
        node = super().scalar(event)
        style = event.style or ""
        self.extents[id(node)] = Extent(event.start_mark.index, event.end_mark.index, style)
        return node

    def sequence(self, start: Any, depth: int) -> Sequence:
        return self.kept(super().sequence(start, depth), start)

    def mapping(self, start: Any, depth: int) -> Mapping:
        return self.kept(super().mapping(start, depth), start)

    def kept(self, node: _Collection, start: Any) -> _Collection:
        style = "flow" if start.flow_style else "block"
        self.extents[id(node)] = Extent(start.start_mark.index, self.ended.end_mark.index, style)
        return node

    def collection_span(self, start: Any, end: Any, first: Span | None) -> Span:
        self.ended = end  # the last that is asked of a collection, when what is in it has been read
        return super().collection_span(start, end, first)


def _inside(lines: list[str], mark: Any) -> tuple[int, int]:
    """Line and column of a mark, from 0; what the scanner places behind the end is brought back to the end."""
    if mark.line < len(lines):
        return mark.line, min(mark.column, len(lines[mark.line]))
    return len(lines) - 1, len(lines[-1])
