"""A description as written: its placed tree with the characters of the text that each node takes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path as Folder

from mbsym.expressions.place import Complaints, Span
from mbsym.model.system import System
from mbsym.source.document import read_placed
from mbsym.source.keys import ALIASES
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence, normalised
from mbsym.source.yaml_reader import Extent, read_yaml

Path = tuple[str | int, ...]

#: What a description says, without places: texts, lists and mappings.
Data = str | list["Data"] | dict[str, "Data"]


class Refused(Exception):
    """An operation that is not done; nothing is changed.  ``code`` and ``hint`` as of a complaint."""

    def __init__(self, code: str, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.code, self.message, self.hint = code, message, hint


@dataclass(slots=True)
class Written:
    """A text (normalised), what it says, and where each node of it stands.

    ``system`` is None where the text has errors, ``tree`` where it cannot be read at all.
    """

    text: str
    name: str
    tree: Node | None
    editor: bool
    system: System | None
    complaints: Complaints
    extents: dict[int, Extent]
    line_starts: list[int] = field(default_factory=list)
    folder: Folder | None = None

    def offset(self, span: Span) -> int:
        """Where a span begins, within the text."""
        line = min(span.line, len(self.line_starts)) - 1
        return min(self.line_starts[line] + span.column - 1, len(self.text))

    def line_end(self, offset: int) -> int:
        """Where the line of a character ends, before its line end."""
        end = self.text.find("\n", offset)
        return len(self.text) if end < 0 else end

    def line_start(self, offset: int) -> int:
        return self.text.rfind("\n", 0, offset) + 1

    def key(self, entry: Entry) -> tuple[int, int]:
        """The characters of a key as written."""
        extent = self.extents.get(id(entry.key))
        if extent is not None:
            return extent.start, extent.end
        start = self.offset(entry.key.span)
        return start, start + entry.key.span.length

    def extent(self, node: Node) -> tuple[int, int]:
        """The characters of a node as written, without what follows an indented one."""
        found = self.extents.get(id(node))
        if found is None:
            return self._from_spans(node)
        start, end = found.start, found.end
        if isinstance(node, Scalar):
            if found.style in ("|", ">"):
                end = start + len(self.text[start:end].rstrip())
        elif found.style == "block":
            children = list(_children(node))
            end = self.extent(children[-1])[1] if children else start
        return start, max(start, end)

    def _from_spans(self, node: Node) -> tuple[int, int]:
        """Editor text: a value stands in its line, a block from its heading to its last value."""
        start = self.offset(node.span)
        if isinstance(node, Scalar):
            return start, start + (len(node.text) if node.literal else node.span.length)
        end = start + node.span.length
        entries = node.entries if isinstance(node, Mapping) else ()
        for value in _children(node):
            if not any(entry.value is value and is_understood(entry) for entry in entries):
                first, last = self.extent(value)
                start, end = min(start, first), max(end, last)
        return start, end

    def style(self, node: Node) -> str:
        extent = self.extents.get(id(node))
        return extent.style if extent is not None else ""

    def above(self, path: Path) -> list[Node]:
        """What a path goes through, the whole first, what it leads to left out."""
        nodes = (node_at(self.tree, path[:count]) for count in range(len(path)))
        return [node for node in nodes if node is not None]

    def source(self, node: Scalar) -> str:
        """A value as it is spelled; of several lines, what they say."""
        start, end = self.extent(node)
        spelled = self.text[start:end]
        if self.editor and not node.literal and not spelled.startswith('"'):
            return node.text  # the number of a body: its name is told
        return node.text if "\n" in spelled or self.style(node) in ("|", ">") else spelled


def is_understood(entry: Entry) -> bool:
    """Whether an entry of editor text is not written, but goes without saying."""
    value = entry.value
    return isinstance(value, Scalar) and not value.literal and value.span == entry.key.span and not entry.key.literal


def _children(node: Node) -> tuple[Node, ...]:
    if isinstance(node, Sequence):
        return node.items
    return tuple(entry.value for entry in node.entries) if isinstance(node, Mapping) else ()


def written(text: str, name: str, understand: bool = True, folder: Folder | None = None) -> Written:
    """What a text says and where; with ``understand`` its system and all complaints, too.

    Files that it names are looked for in ``folder``.
    """
    extents: dict[int, Extent] = {}
    parsed = read_placed(text, name, folder, extents, understand)
    plain = normalised(text)
    starts, position = [0], plain.find("\n")
    while position >= 0:
        starts.append(position + 1)
        position = plain.find("\n", position + 1)
    return Written(plain, name, parsed.tree, parsed.editor, parsed.system, parsed.complaints, extents, starts, folder)


def original_offsets(text: str) -> list[int] | None:
    """Where each character of the normalised text stands in the text itself; None where they are the same."""
    if "\r" not in text and not text.startswith("\ufeff"):
        return None
    offsets, position = [], 1 if text.startswith("\ufeff") else 0
    while position < len(text):
        offsets.append(position)
        position += 2 if text.startswith("\r\n", position) else 1
    return [*offsets, len(text)]


# --- data -------------------------------------------------------------------------------------------------------------


def data_of(node: Node) -> Data:
    """What a node says.  Refused where a key stands twice: a path would mean two places."""
    match node:
        case Scalar(text):
            return text
        case Sequence(items):
            return [data_of(item) for item in items]
    datas: dict[str, Data] = {}
    for entry in node.entries:
        if entry.key.text in datas:
            message = f"the key '{entry.key.text}' stands twice in line {entry.key.span.line}"
            raise Refused("repeated-key", message, "take one of them out, in the text")
        datas[entry.key.text] = data_of(entry.value)
    return datas


def child(node: Node, step: str | int) -> Node | None:
    """What a step of a path leads to; a key also by its other spellings."""
    if isinstance(node, Sequence):
        return node.items[step] if isinstance(step, int) and 0 <= step < len(node.items) else None
    entry = entry_of(node, step)
    return None if entry is None else entry.value


def entry_of(node: Node, step: str | int) -> Entry | None:
    if not isinstance(node, Mapping) or not isinstance(step, str):
        return None
    for entry in node.entries:
        if entry.key.text == step:
            return entry
    return next((entry for entry in node.entries if ALIASES.get(entry.key.text, entry.key.text) == step), None)


def node_at(tree: Node | None, path: Path) -> Node | None:
    for step in path:
        if tree is None:
            return None
        tree = child(tree, step)
    return tree


def spelled_path(tree: Node | None, path: Path) -> Path:
    """A path with its keys as the text spells them."""
    found: list[str | int] = []
    for step in path:
        entry = None if tree is None else entry_of(tree, step)
        found.append(step if entry is None else entry.key.text)
        tree = None if tree is None else child(tree, step)
    return tuple(found)


# How a value is spelled in YAML: as a person typed it where that is YAML, quoted where it must be.


_SAFE = re.compile(r"[A-Za-z0-9(./-][A-Za-z0-9 _.()*/+'<>=!-]*\Z")
_DANGEROUS = ("- ", "---", "...")

#: In block style these are whole words to other readers of YAML.
_WORDS = frozenset(("on", "off", "yes", "no", "y", "n"))


def parsed(source: str) -> Node | None:
    """What a source in flow style says, or None where it is not YAML."""
    complaints = Complaints()
    node = read_yaml(f"[{source}\n]" if source.strip() else "[]", complaints)
    if complaints or not isinstance(node, Sequence):
        return None
    return node.items[0] if len(node.items) == 1 else None


def value_of(source: str) -> Data:
    """What a person means who types a value: a list or mapping in brackets, a quoted text, or the words as they stand.

    Refused where a bracket does not close.
    """
    typed = source.strip()
    if typed[:1] in ("[", "{"):
        node = parsed(typed)
        if node is None or isinstance(node, Scalar):
            message = "this list or mapping cannot be read"
            raise Refused("syntax", message, "look for a missing bracket, comma or quote: [a, b, c], {name: value}")
        return data_of(node)
    if len(typed) > 1 and typed[0] == typed[-1] and typed[0] in "\"'":
        node = parsed(typed)
        if isinstance(node, Scalar):
            return node.text
    return typed


def spelled(source: str, flow: bool = True) -> str:
    """A source as it stands in YAML; ``flow``: between brackets."""
    typed = source.strip()
    value = value_of(typed)
    if not isinstance(value, str):
        return typed
    return typed if typed[:1] in ('"', "'") and value != typed else scalar(value, flow)


def scalar(value: str, flow: bool = True) -> str:
    """A text as YAML: plain where every reader takes it so, else in double quotes."""
    plain = _SAFE.match(value) and not value.startswith(_DANGEROUS) and value == value.strip() and value != "-"
    if plain:
        return value
    if not flow and value and value == value.strip() and _reads_plain(value):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'


def _reads_plain(value: str) -> bool:
    """Whether it is itself in YAML as the value of a key, in a line of its own."""
    if "\n" in value or value[0] in "\"'[{|>&*!%@`#?,]}" or ": " in value or " #" in value or value.endswith(":"):
        return False
    node = read_yaml(f"key: {value}\n", Complaints())
    entry = node.entries[0] if isinstance(node, Mapping) and len(node.entries) == 1 else None
    return entry is not None and isinstance(entry.value, Scalar) and entry.value.text == value


def key(name: str) -> str:
    """A key; YAML 1.1 readers take a bare ``on`` for true."""
    return f'"{name}"' if name in _WORDS else scalar(name)


def flow(data: Data) -> str:
    """Data in one line."""
    match data:
        case dict():
            return "{" + ", ".join(f"{key(name)}: {flow(value)}" for name, value in data.items()) + "}"
        case list():
            return "[" + ", ".join(map(flow, data)) + "]"
    return scalar(data)


def block(data: Data, indent: int) -> str:
    """A mapping with an entry a line, from the second line on indented; anything else in one line."""
    if not isinstance(data, dict) or not data:
        return flow(data)
    lines = [f"{key(k)}: {scalar(x, flow=False) if isinstance(x, str) else flow(x)}" for k, x in data.items()]
    return ("\n" + " " * indent).join(lines)
