"""The editor's plain text to the placed tree, in the shape that the YAML reader gives.

A file is lines: ``label: value`` or ``label = value``, headings without a value (``Body description (2)``,
``Parameters``), rows of a tensor below its label, comments after ``#``.  Labels are those of the paper's Figure 3,
in any case.  Vectors stand in ``( )``, ``{ }`` or ``[ ]``; records are ``positive; value = 2; meaning = length``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints, Span
from mbsym.source.keys import CONSTRAINTS, LOADS, VERSION
from mbsym.source.labels import ASSUMPTIONS, BODY, FREE, FREE_KEYS, HEADER, SECTIONS
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.scope import closest
from mbsym.source.text_kinds import claim, filled, items, of_kind, row, split
from mbsym.source.text_lines import HEADING, key_of, label_in, label_of, lines_of, spoken, word_of

#: What is meant for a heading; with a colon before its number it is a label (``Body: 3``).
_MEANT = re.compile(r"(body|load|claim|constraint)(?: description)?\s*[(#]?\s*([0-9]{1,6})\s*[):.]*\Z", re.IGNORECASE)

#: A label has no more words.
MOST_WORDS = 8
#: Fields of the form that may stay empty: zeros, no turn.
_LEFT_OUT = ("connection point", "mass centre", "relative velocity", "gyrostatic moment", "axes", "angles")


def read_text(text: str, complaints: Complaints) -> Node | None:
    """The placed tree of an editor text (already normalised), or None with complaints."""
    lines = list(lines_of(text))
    if not lines:
        complaints.error("empty", "there is no description in this file")
        return None
    return TextReader(complaints).document(lines)


@dataclass(slots=True)
class _Block:
    """A heading with the lines below it."""

    heading: Scalar
    lines: list[Scalar] = field(default_factory=list)


class TextReader:
    """Blocks to entries of the top-level mapping."""

    def __init__(self, complaints: Complaints) -> None:
        self.complaints = complaints
        self.names: dict[str, str] = {}  # of bodies, by number

    def document(self, lines: list[Scalar]) -> Mapping:
        header, blocks = self.blocks(lines)
        start = Span(lines[0].span.line, 1)
        entries = [Entry(Scalar("mbsym", start, literal=False), Scalar(VERSION, start, literal=False))]
        bodies = [block for block in blocks if self.kind(block) == "body"]
        self.names = {str(number): _name_in(block) or _unnamed(number) for number, block in enumerate(bodies, start=1)}
        entries += self.header(header)
        self.check_count(header, len(bodies))
        entries += [self.section(block) for block in blocks if self.kind(block) == "section"]
        readers: dict[str, tuple[str, Callable[[_Block], Mapping | None]]] = {
            "body": ("bodies", self.body_form),
            "load": ("loads", lambda block: of_kind(self, "load", LOADS, block.heading, block.lines)),
            "claim": ("claims", lambda block: claim(self, block.heading, block.lines)),
            "constraint": (
                "constraints",
                lambda block: of_kind(self, "constraint", CONSTRAINTS, block.heading, block.lines),
            ),
        }
        for kind, (key, read) in readers.items():
            matching = [block for block in blocks if self.kind(block) == kind]
            self.check_numbers(matching)
            entries += _list_entry(key, matching, read)
        return Mapping(tuple(entries), start)

    def blocks(self, lines: list[Scalar]) -> tuple[list[Scalar], list[_Block]]:
        header: list[Scalar] = []
        blocks: list[_Block] = []
        for line in lines:
            line = self.as_heading(line)
            if HEADING.match(line.text) or word_of(line.text.rstrip(":")) in (*SECTIONS, ASSUMPTIONS):
                blocks.append(_Block(line))
            elif blocks:
                blocks[-1].lines.append(line)
            else:
                header.append(line)
        return header, blocks

    def as_heading(self, line: Scalar) -> Scalar:
        """A line, or the heading that is meant by ``Body 1``, ``Body (1):``, which is complained about."""
        match = None if HEADING.match(line.text) else _MEANT.match(line.text)
        if match is None:
            return line
        title = f"{match[1].capitalize()} description ({match[2]})"
        message = Message("this is no heading: [[shown]]", shown=ascii_safe(line.text))
        self.error("unknown-key", message, line.span, Message("write [[usage]]", usage=title))
        return Scalar(title, line.span)

    def kind(self, block: _Block) -> str:
        match = HEADING.match(block.heading.text)
        return match.group(1).lower() if match else "section"

    def error(self, code: str, message: str, span: Span, hint: str | None = None, **gaps: object) -> None:
        self.complaints.error(code, message, span, hint, **gaps)

    def check_numbers(self, blocks: list[_Block]) -> None:
        """Blocks are numbered 1, 2, 3, ... in the order of the file."""
        for number, block in enumerate(blocks, start=1):
            match = HEADING.match(block.heading.text)
            if match is not None and int(match.group(2)) != number:
                span = block.heading.place(match.start(2), match.end(2))
                self.error(
                    "bad-number",
                    Message("this is description number [[number]]", number=number),
                    span,
                    "number them 1, 2, 3, ...",
                )

    def check_count(self, header: list[Scalar], count: int) -> None:
        for line in header:
            label, value = label_of(line)
            if label is not None and word_of(label.text) == "number of bodies" and value.text != str(count):
                self.error("body-count", Message("[[count]] bodies are described", count=count), value.span)

    def labelled(self, line: Scalar, known: Collection[str], what: str) -> tuple[Scalar, str, Scalar] | None:
        """A label out of a known set (or taken for what it resembles): its scalar, its normal form, the value."""
        label, value = label_of(line)
        word = word_of(label.text if label is not None else line.text)
        if label is not None and word in known:
            return label, word, value
        if (parts := spoken(line, known)) is not None:
            return parts
        if label is None:
            label, value = _leading_words(line, known)
        span = line.span if label is None else label.span
        shown = line.text if label is None else label.text
        guess = closest(word_of(shown), known)
        hint = (
            Message("did you mean '[[other]]'?", other=guess)
            if guess
            else Message("the labels are: [[known]]", known=", ".join(known))
        )
        self.error("unknown-key", "unknown label [[shown]] in [[what]]", span, hint, shown=ascii_safe(shown), what=what)
        return None if guess is None or label is None else (label, guess, value)

    # --- header and sections -----------------------------------------------------------------------------------------

    def header(self, lines: list[Scalar]) -> list[Entry]:
        entries = []
        for line in lines:
            parts = self.labelled(line, HEADER, "the header")
            if parts is None or parts[1] == "number of bodies":
                continue
            label, word, value = parts
            free = word in FREE
            read = (
                items(value) if word in ("order", "dependent", "reactions") else self.unquoted(value) if free else value
            )
            if word == "reactions" and isinstance(read, Sequence):  # bodies by their numbers
                named = (self.body_reference(x) if isinstance(x, Scalar) else x for x in read.items)
                read = Sequence(tuple(named), read.span)
            if word == "small parameter":
                entries.append(Entry(key_of(label, word), self.small(value)))
                continue
            entries.append(Entry(key_of(label, HEADER[word]), read))
        return entries

    def section(self, block: _Block) -> Entry:
        title = word_of(block.heading.text.rstrip(":"))
        if title == ASSUMPTIONS:
            return Entry(key_of(block.heading, "assumptions"), Sequence(tuple(block.lines), block.heading.span))
        key, first = SECTIONS[title]
        entries = []
        for line in block.lines:
            label, value = label_of(line)
            if label is None:
                self.error("syntax", "here 'name = value' is wanted", line.span)
                continue
            if key == "linear system":
                rows = self.record(value, "file") if "=" in value.text else self.nested(items(value))
                entries.append(Entry(label, rows))
                continue
            read = items(value) if key == "limits" else value if first is None else self.record(value, first)
            if key == "tables":
                read = self.table(read)
            entries.append(Entry(label, read))
        return Entry(key_of(block.heading, key), Mapping(tuple(entries), block.heading.span))

    def record(self, value: Scalar, first: str) -> Node:
        """``a; key = b``: a mapping; a single bare value stays what it is."""
        parts = list(split(value, ";"))
        if len(parts) == 1 and label_in(parts[0])[0] is None:
            return self.unquoted(parts[0]) if first in FREE_KEYS else parts[0]
        entries = []
        for index, part in enumerate(parts):
            label, rest = label_in(part)
            if label is None and index == 0:
                key = "value" if first == "sign" and part.text[:1].isdigit() else first
                read = self.unquoted(part) if key in FREE_KEYS else part
                entries.append(Entry(Scalar(key, part.span, literal=False), read))
            elif label is None:
                self.error("syntax", "here 'key = value' is wanted", part.span)
            else:
                word = word_of(label.text)
                entries.append(Entry(key_of(label, word), self.unquoted(rest) if word in FREE_KEYS else rest))
        return Mapping(tuple(entries), value.span)

    def table(self, read: Node) -> Node:
        """A record whose points ``((0, 0), (1, 2.5))`` are a list of lists; such a list alone is a record of it."""
        if isinstance(read, Scalar):
            read = Mapping((Entry(key_of(read, "points"), read),), read.span)
        assert isinstance(read, Mapping)
        return Mapping(tuple(map(self.table_entry, read.entries)), read.span)

    def table_entry(self, entry: Entry) -> Entry:
        value = entry.value
        if entry.key.text == "columns" and isinstance(value, Scalar):
            return Entry(entry.key, items(value))
        if entry.key.text != "points" or not isinstance(value, Scalar):
            return entry
        return Entry(entry.key, self.nested(items(value)))

    def small(self, value: Scalar) -> Node:
        """``eps``, or ``eps; powers = (e, 1, p2, -1); fast = (x, y)``: a mapping of the name to the rest."""
        read = self.record(value, "name")
        if not isinstance(read, Mapping):
            return read
        name = next((entry.value for entry in read.entries if entry.key.text == "name"), value)
        entries = []
        for entry in read.entries:
            if entry.key.text == "name" or not isinstance(entry.value, Scalar):
                continue
            if entry.key.text == "leading":
                entries.append(entry)
                continue
            listed = items(entry.value)
            if entry.key.text == "powers":
                flat = [x for x in listed.items if isinstance(x, Scalar)] if isinstance(listed, Sequence) else []
                if len(flat) % 2:
                    self.error("syntax", "here pairs of a parameter and its power are wanted", entry.value.span)
                pairs = zip(flat[::2], flat[1::2], strict=False)
                entries.append(Entry(entry.key, Mapping(tuple(Entry(a, b) for a, b in pairs), entry.value.span)))
            else:
                entries.append(Entry(entry.key, listed))
        if not isinstance(name, Scalar):
            return value
        return Mapping((Entry(name, Mapping(tuple(entries), value.span)),), value.span)

    def nested(self, read: Node) -> Node:
        """A list whose items may be lists."""
        if not isinstance(read, Sequence):
            return read
        return Sequence(tuple(items(x) if isinstance(x, Scalar) else x for x in read.items), read.span)

    def unquoted(self, value: Scalar) -> Scalar:
        """The text between double quotes, if there are any."""
        if not value.text.startswith('"'):
            return value
        match = re.match(r'"((?:[^"\\]|\\.)*)"\Z', value.text)
        if match is None:
            self.error("syntax", "this quote is not closed, or something follows it", value.span)
            return value
        return Scalar(re.sub(r"\\(.)", r"\1", match.group(1)), value.span, literal=False)

    # --- bodies ------------------------------------------------------------------------------------------------------

    def body_form(self, block: _Block) -> Mapping:
        """A body as the paper's Figure 3 has it: without a name it is "Body 2", and its tensor is about O_k."""
        read = self.body(block)
        entries = {entry.key.text: entry for entry in read.entries}
        more = []
        match = HEADING.match(block.heading.text)
        if "name" not in entries and match is not None:
            more.append(Entry(key_of(block.heading, "name"), key_of(block.heading, _unnamed(int(match.group(2))))))
        if "inertia" in entries and "inertia about" not in entries:
            tensor = entries["inertia"].key
            more.append(Entry(key_of(tensor, "inertia about"), key_of(tensor, "joint")))
        return Mapping((*read.entries, *more), read.span)

    def body(self, block: _Block) -> Mapping:
        """The entries of a body; axes and angles together are its rotation, rows follow their label.

        The tensor of inertia and that it is accepted are one entry, too.
        """
        entries: list[Entry] = []
        rotation: list[Entry] = []
        accept: list[Entry] = []
        shapes: list[tuple[Scalar, Node]] = []
        lines = block.lines
        position = 0
        while position < len(lines):
            parts = self.labelled(lines[position], BODY, block.heading.text)
            position += 1
            if parts is None:
                continue
            label, word, value = parts
            if not value.text and word != "tensor of inertia":
                if _goes_on(lines, position):
                    value = lines[position]
                    position += 1
                elif BODY[word] in _LEFT_OUT:
                    continue
            key = key_of(label, BODY[word])
            if word == "tensor of inertia" and not value.text:
                rows = _rows(lines, position)
                position += len(rows)
                entries.append(Entry(key, Sequence(tuple(row(scalar) for scalar in rows), label.span)))
            elif key.text in ("axes", "angles"):
                rotation.append(Entry(key, filled(value, vector=False)))
            elif key.text == "accept":
                accept.append(Entry(key, value))
            elif key.text == "shapes":
                shapes.append((key, self.shape(value)))
            else:
                entries.append(Entry(key, self.body_value(key.text, value)))
        if accept:
            entries = _with_accepted(entries, accept)
        if shapes:
            key = shapes[0][0]
            entries.append(Entry(key, Sequence(tuple(shape for _, shape in shapes), key.span)))
        if rotation:
            entries.append(Entry(key_of(rotation[0].key, "rotation"), Mapping(tuple(rotation), rotation[0].key.span)))
        return Mapping(tuple(entries), block.heading.span)

    def shape(self, value: Scalar) -> Node:
        """``box = (a, b, c); at = (x, y, z); axes = {3}; angles = {pi/2}`` as a mapping; axes and angles turn it."""
        entries: list[Entry] = []
        rotation: list[Entry] = []
        for part in split(value, ";"):
            label, rest = label_of(part)
            if label is None:
                self.error("syntax", "here 'kind = sizes' or 'at = (x, y, z)' is wanted", part.span)
                continue
            word = word_of(label.text)
            (rotation if word in ("axes", "angles") else entries).append(Entry(key_of(label, word), items(rest)))
        if rotation:
            entries.append(Entry(key_of(rotation[0].key, "rotation"), Mapping(tuple(rotation), rotation[0].key.span)))
        return Mapping(tuple(entries), value.span)

    def body_value(self, key: str, value: Scalar) -> Node:
        if key == "attached to":
            return self.body_reference(value)
        if key in ("name", "mass", "inertia about"):
            return value
        if key in ("speeds", "orientation"):
            return self.numbers(value)
        return filled(value, vector=key != "coordinates")

    def body_reference(self, value: Scalar) -> Scalar:
        """Bodies are referred to by number; the tree knows them by name."""
        name = self.names.get(value.text)
        return value if name is None else Scalar(name, value.span, literal=False)

    def numbers(self, value: Scalar) -> Node:
        """``theta = 0.1; theta_dot = 2`` as a mapping; a single word stays what it is."""
        parts = [label_of(part) for part in split(value, ";")]
        if len(parts) == 1 and parts[0][0] is None:
            return value
        for label, rest in parts:
            if label is None:
                self.error("syntax", "here 'name = number' is wanted", rest.span)
        return Mapping(tuple(Entry(label, rest) for label, rest in parts if label is not None), value.span)

    def load_line(self, line: Scalar) -> tuple[Scalar | None, Scalar]:
        label, value = label_of(line)
        if label is None:
            self.error("syntax", "here 'label: value' is wanted", line.span)
        return label, value


def _name_in(block: _Block) -> str:
    for line in block.lines:
        label, value = label_of(line)
        if label is not None and word_of(label.text) == "name":
            return " ".join(value.text.split())
    return ""


def _unnamed(number: int) -> str:
    """What a body is called that has only its number."""
    return f"Body {number}"


def _leading_words(line: Scalar, known: Iterable[str]) -> tuple[Scalar | None, Scalar]:
    """A line without a colon, cut behind the words that resemble a label most; uncut where none do."""
    from difflib import SequenceMatcher

    best, cut = 0.85, 0
    for match in list(re.finditer(r"\S+", line.text))[:MOST_WORDS]:
        words = word_of(line.text[: match.end()])
        alike = max(SequenceMatcher(None, words, label).ratio() for label in known)
        if alike > best:
            best, cut = alike, match.end()
    return (line.part(0, cut), line.part(cut, len(line.text))) if cut else (None, line)


def _goes_on(lines: list[Scalar], position: int) -> bool:
    """Whether the next line is the value of the label above it: no label itself."""
    if position >= len(lines):
        return False
    line = lines[position]
    return label_of(line)[0] is None and spoken(line, BODY) is None


def _list_entry(key: str, blocks: list[_Block], read: Callable[[_Block], Mapping | None]) -> list[Entry]:
    if not blocks:
        return []
    first = blocks[0].heading
    return [
        Entry(key_of(first, key), Sequence(tuple(item for item in map(read, blocks) if item is not None), first.span))
    ]


def _with_accepted(entries: list[Entry], accept: list[Entry]) -> list[Entry]:
    """The entries with ``{tensor: ..., accept: true}`` in place of the tensor of inertia."""
    tensors = [entry for entry in entries if entry.key.text == "inertia"]
    first = tensors[0].key if tensors else accept[0].key
    parts = [Entry(key_of(entry.key, "tensor"), entry.value) for entry in tensors]
    whole = Entry(key_of(first, "inertia"), Mapping((*parts, *accept), first.span))
    return [*(entry for entry in entries if entry.key.text != "inertia"), whole]


def _rows(lines: list[Scalar], position: int) -> list[Scalar]:
    rows = []
    for line in lines[position : position + 3]:
        if label_of(line)[0] is not None or spoken(line, BODY) is not None:
            break
        rows.append(line)
    return rows
