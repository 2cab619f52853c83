"""How a value is spelled in YAML: as a person typed it where that is YAML, quoted where it must be."""

from __future__ import annotations

import re

from mbsym.editing.document.written import Data, Refused, data_of
from mbsym.expressions.place import Complaints
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.yaml_reader import read_yaml

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
    lines = [f"{key(name)}: {_inner(value)}" for name, value in data.items()]
    return ("\n" + " " * indent).join(lines)


def _inner(data: Data) -> str:
    return scalar(data, flow=False) if isinstance(data, str) else flow(data)
