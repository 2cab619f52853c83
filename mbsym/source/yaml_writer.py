"""A System as YAML, in the order and the style in which people write it."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator

from mbsym.model.linear import MATRICES
from mbsym.model.system import System
from mbsym.source.keys import VERSION
from mbsym.source.shape import Shape, system_shape

_PLAIN = re.compile(r"[A-Za-z0-9(./-][A-Za-z0-9 _.()*/+'<>=!-]*\Z")
_DANGEROUS_STARTS = ("- ", "---", "...")


#: What stands in one line at the head of a file, and in one line further below.
_HEAD = ("name", "description", "source", "label", "language", "order")
_LINES = ("dependent", "reactions", "dimensionless time", "small parameter")


def to_yaml(system: System) -> str:
    """The description of a system; reading it again gives an equal system."""
    lines = [f"mbsym: {VERSION}"]
    for key, value in system_shape(system).items():
        lines += [f"{key}: {_flow(value)}"] if key in _HEAD else ["", *_part(key, value)]
    return "\n".join(lines) + "\n"


def _part(key: str, value: Shape) -> Iterator[str]:
    """The lines of a key with what it holds."""
    if key in _LINES:
        yield f"{key}: {_flow(value)}"
        return
    yield f"{key}:"
    if isinstance(value, dict):
        for name, one in value.items():
            if name in MATRICES and key == "linear system" and isinstance(one, list):  # each matrix with a row a line
                yield from (f"  {name}:", *(f"    - {_flow(row)}" for row in one))
            else:
                yield f"  {name}: {_flow(one)}"
        return
    for number, item in enumerate(value):
        if key == "bodies" and isinstance(item, dict):
            yield from [""] if number else []
            yield from (f"  {' ' if k else '-'} {name}: {_flow(one)}" for k, (name, one) in enumerate(item.items()))
        elif key in ("loads", "constraints") and isinstance(item, dict):
            yield from (f"  - {kind}: {_flow(one)}" for kind, one in item.items())
        else:
            yield f"  - {_flow(item)}"


def _flow(value: Shape) -> str:
    match value:
        case dict():
            return "{" + ", ".join(f"{_key(key)}: {_flow(item)}" for key, item in value.items()) + "}"
        case list():
            return "[" + ", ".join(_flow(item) for item in value) + "]"
    return scalar_text(value)


def _key(key: str) -> str:
    """YAML 1.1 readers take a bare ``on`` for true."""
    return '"on"' if key == "on" else key


def scalar_text(value: str) -> str:
    """Plain where every YAML reader agrees on it, else in double quotes."""
    if _PLAIN.match(value) and not value.startswith(_DANGEROUS_STARTS) and value == value.strip() and value != "-":
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


# What a description says, as a number: equal for the two spellings, for any order of keys, and for any comments.


def meaning(system: System) -> str:
    """SHA-256, in hexadecimal digits, of the description as ``mbsym convert`` writes it in YAML."""
    return hashlib.sha256(to_yaml(system).encode()).hexdigest()
