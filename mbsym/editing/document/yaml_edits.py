"""Primitives as edits of a YAML text: lines and values that are not touched stay byte for byte."""

from __future__ import annotations

import re

from mbsym.editing.document.meaning import Edit
from mbsym.editing.document.primitives import Add, Primitive, Rekey, Remove, Replace, Shift, applied_to
from mbsym.editing.document.written import (
    Data,
    Path,
    Refused,
    Written,
    block,
    data_of,
    entry_of,
    flow,
    key,
    node_at,
    scalar,
    spelled,
)
from mbsym.source.placed import Entry, Mapping, Node, Sequence

#: Sections that mean something when they are empty.
_KEPT_EMPTY = ("bodies", "motion")


def yaml_edits(document: Written, primitive: Primitive) -> list[Edit]:
    """The edits of the text that one primitive is.  Refused where there is no place for it."""
    match primitive:
        case Replace(path, data, source):
            return [_replaced(document, path, data, source)]
        case Add(path, data, source, after):
            return [_added(document, path, data, source, after)]
        case Remove(path):
            return [_removed(document, path)]
        case Rekey(path, new):
            return [Edit(*document.key(_entry(document, path)), key(new))]
        case Shift(path, before):
            return _shifted(document, path, before)


def emptied(document: Written, path: Path) -> Primitive:
    """To remove the last of a section is to remove the section, or to leave it empty where that says something."""
    holder = node_at(document.tree, path[:-1])
    if len(path) < 2 or holder is None or len(_parts(holder)) > 1:
        return Remove(path)
    if len(path) == 2 and (path[0] not in _KEPT_EMPTY or (document.editor and path[0] == "bodies")):
        return Remove(path[:1])
    return Replace(path[:-1], {} if isinstance(holder, Mapping) else [])


def _parts(node: Node) -> tuple[Entry, ...] | tuple[Node, ...]:
    return node.entries if isinstance(node, Mapping) else node.items if isinstance(node, Sequence) else ()


def _entry(document: Written, path: Path) -> Entry:
    holder = node_at(document.tree, path[:-1])
    entry = None if holder is None else entry_of(holder, path[-1])
    if entry is None:
        raise Refused("bad-path", f"there is no {path[-1]!r} there")
    return entry


def _node(document: Written, path: Path) -> Node:
    node = node_at(document.tree, path)
    if node is None:
        raise Refused("bad-path", f"there is no {path[-1] if path else ''!r} there")
    return node


def _in_flow(document: Written, path: Path) -> bool:
    """Whether what stands at a path stands between brackets."""
    return any(document.style(_node(document, path[:k])) == "flow" for k in range(len(path)))


# --- values -----------------------------------------------------------------------------------------------------------


def _replaced(document: Written, path: Path, data: Data, source: str | None) -> Edit:
    node, in_flow = _node(document, path), _in_flow(document, path)
    value = spelled(source, in_flow) if source is not None else _value(data, in_flow)
    start, end = document.extent(node)
    if len(path) == 1 and data and not isinstance(data, str) and source is None and not in_flow:
        return Edit(_colon(document, _entry(document, path)), end, _section(document, str(path[0]), data))
    if isinstance(path[-1], str):
        entry = _entry(document, path)
        last = document.key(entry)[1]
        if start == end:
            return _into_empty(document, last, value, in_flow)
        if document.style(node) == "block":
            return Edit(_colon(document, entry), end, f" {value}")
    return Edit(start, end, value)


def _into_empty(document: Written, after: int, value: str, in_flow: bool) -> Edit:
    """Behind a key without a value."""
    match = re.compile(r"[ \t]*:").match(document.text, after)
    if match is None:
        if not in_flow:
            raise Refused("bad-path", "no colon follows the key")
        return Edit(after, after, f": {value}")
    end = match.end()
    blank = document.text[end : end + 1] == " "
    return Edit(end + blank, end + blank, value if blank else f" {value}")


def _colon(document: Written, entry: Entry) -> int:
    """Behind the colon of a key."""
    match = re.compile(r"[ \t]*:").match(document.text, document.key(entry)[1])
    if match is None:
        raise Refused("bad-path", f"no colon follows '{entry.key.text}'")
    return match.end()


def _value(data: Data, in_flow: bool) -> str:
    return scalar(data, in_flow) if isinstance(data, str) else flow(data)


# --- new --------------------------------------------------------------------------------------------------------------


def _added(document: Written, path: Path, data: Data, source: str | None, after: str | None) -> Edit:
    holder = _node(document, path[:-1])
    if document.style(holder) == "flow" or _in_flow(document, path[:-1]):
        return _added_in_flow(document, holder, path, data, source, after)
    if isinstance(holder, Sequence):
        return _added_item(document, holder, path, data)
    if not isinstance(holder, Mapping) or not holder.entries:
        raise Refused("bad-path", "there is no mapping to add to")
    entries = holder.entries
    before = next((entry for entry in entries if entry.key.text == after), entries[-1])
    start = document.key(entries[0])[0]
    indent = start - document.line_start(start)
    position = document.line_end(max(document.extent(before.value)[1], document.key(before)[1]))
    name = key(str(path[-1]))
    if len(path) == 1 and data and not isinstance(data, str):
        return Edit(position, position, f"\n\n{name}:{_section(document, str(path[0]), data)}")
    value = spelled(source, False) if source is not None else _value(data, False)
    return Edit(position, position, f"\n{' ' * indent}{name}: {value}")


def _added_in_flow(
    document: Written, holder: Node, path: Path, data: Data, source: str | None, after: str | None
) -> Edit:
    value = spelled(source) if source is not None else _value(data, True)
    start, _ = document.extent(holder)
    if isinstance(holder, Mapping):
        entries = holder.entries
        value = f"{key(str(path[-1]))}: {value}"
        before = next((entry for entry in entries if entry.key.text == after), entries[-1] if entries else None)
        end = 0 if before is None else max(document.extent(before.value)[1], document.key(before)[1])
    else:
        items = holder.items if isinstance(holder, Sequence) else ()
        index = path[-1]
        assert isinstance(index, int)
        if items and index == 0:
            first = document.extent(items[0])[0]
            return Edit(first, first, f"{value}, ")
        end = document.extent(items[index - 1])[1] if items else 0
    if end:
        return Edit(end, end, f", {value}")
    return Edit(start + 1, start + 1, value)


def _added_item(document: Written, holder: Sequence, path: Path, data: Data) -> Edit:
    index, section = path[-1], str(path[0])
    assert isinstance(index, int)
    if not holder.items:
        raise Refused("bad-path", "there is no list to add to")
    dashes = [_dash(document, item) for item in holder.items]
    indent = dashes[0] - document.line_start(dashes[0])
    text = _item(section, data, indent + 2) if len(path) == 2 else _item("", data, indent + 2)
    apart = len(dashes) > 1 and "\n\n" in document.text[document.extent(holder.items[0])[1] : dashes[1]]
    apart = apart or (len(dashes) == 1 and section == "bodies" and len(path) == 2)
    if index == 0:
        start = document.line_start(dashes[0])
        return Edit(start, start, f"{' ' * indent}- {text}\n" + ("\n" if apart else ""))
    position = document.line_end(document.extent(holder.items[index - 1])[1])
    return Edit(position, position, ("\n" if apart else "") + f"\n{' ' * indent}- {text}")


def _item(section: str, data: Data, indent: int) -> str:
    """An item of a list as people write it: bodies line by line, loads by their kind, the rest between brackets."""
    if section == "bodies":
        return block(data, indent)
    if section in ("loads", "constraints") and isinstance(data, dict) and len(data) == 1:
        return block(data, indent)
    return scalar(data, False) if isinstance(data, str) else flow(data)


def _section(document: Written, name: str, data: Data) -> str:
    """What stands behind the colon of a section, from the next line on."""
    indent = " " * _indentation(document)
    if isinstance(data, list):
        apart = "\n\n" if name == "bodies" else "\n"
        return "\n" + apart.join(f"{indent}- {_item(name, entry, len(indent) + 2)}" for entry in data)
    assert isinstance(data, dict)
    return "".join(f"\n{indent}{key(entry_name)}: {_value(value, False)}" for entry_name, value in data.items())


def _indentation(document: Written) -> int:
    """By how much sections are indented in this text."""
    tree = document.tree
    for entry in tree.entries if isinstance(tree, Mapping) else ():
        if document.style(entry.value) == "block" and isinstance(entry.value, Mapping):
            start = document.key(entry.value.entries[0])[0]
            return start - document.line_start(start)
    return 2


def _dash(document: Written, item: Node) -> int:
    """Where the dash of an item stands, first in its line."""
    place = document.extent(item)[0] - 1
    while place >= 0 and document.text[place] in " \t\n":
        place -= 1
    if place < 0 or document.text[place] != "-" or document.text[document.line_start(place) : place].strip():
        raise Refused("bad-path", "this list is written in a way that is not changed here", "change it in the text")
    return place


# --- gone and moved ---------------------------------------------------------------------------------------------------


def _removed(document: Written, path: Path) -> Edit:
    holder = _node(document, path[:-1])
    parts = _parts(holder)
    index = _index(holder, path[-1])
    if document.style(holder) == "flow":
        return _removed_in_flow(document, holder, index)
    if len(parts) == 1:
        raise Refused("bad-path", "the last of a mapping or list is not taken out of it")
    start, end = _lines(document, holder, index)
    if start is None:
        following = parts[index + 1] if index + 1 < len(parts) else None
        if not isinstance(following, Entry):
            raise Refused("bad-path", "this is written in a way that is not changed here", "change it in the text")
        part = parts[index]
        assert isinstance(part, Entry)
        return Edit(document.key(part)[0], document.key(following)[0], "")
    if document.text[:start].endswith("\n\n") and document.text[end : end + 1] in ("\n", ""):
        return Edit(start - 1, end, "")
    if end == len(document.text) and not document.text.endswith("\n"):
        return Edit(max(0, start - 1), end, "")
    return Edit(start, end, "")


def _index(holder: Node, step: str | int) -> int:
    if isinstance(holder, Mapping):
        entry = entry_of(holder, step)
        if entry is not None:
            return holder.entries.index(entry)
    elif isinstance(holder, Sequence) and isinstance(step, int) and 0 <= step < len(holder.items):
        return step
    raise Refused("bad-path", f"there is no {step!r} there")


def _lines(document: Written, holder: Node, index: int) -> tuple[int | None, int]:
    """The whole lines of a part of a block, their line end with them; no beginning where a line begins with more."""
    if isinstance(holder, Mapping):
        entry = holder.entries[index]
        start, last = document.key(entry)[0], max(document.extent(entry.value)[1], document.key(entry)[1])
    else:
        assert isinstance(holder, Sequence)
        item = holder.items[index]
        start, last = _dash(document, item), document.extent(item)[1]
    end = min(len(document.text), document.line_end(last) + 1)
    first = document.line_start(start)
    return (None if document.text[first:start].strip() else first), end


def _bounds(document: Written, part: Entry | Node) -> tuple[int, int]:
    if isinstance(part, Entry):
        start, end = document.key(part)
        return start, max(end, document.extent(part.value)[1])
    return document.extent(part)


def _removed_in_flow(document: Written, holder: Node, index: int) -> Edit:
    parts = _parts(holder)
    start, end = _bounds(document, parts[index])
    if index + 1 < len(parts):
        return Edit(start, _bounds(document, parts[index + 1])[0], "")
    return Edit(_bounds(document, parts[index - 1])[1] if index else start, end, "")


def _shifted(document: Written, path: Path, before: str | int | None) -> list[Edit]:
    holder = _node(document, path[:-1])
    parts = _parts(holder)
    index = _index(holder, path[-1])
    target = len(parts) if before is None else _index(holder, before)
    if target in (index, index + 1):
        return []
    if document.style(holder) == "flow":
        data = applied_to({"x": data_of(holder)}, Shift(("x", path[-1]), before))
        assert isinstance(data, dict)
        return [Edit(*document.extent(holder), flow(data["x"]))]
    start, end = _lines(document, holder, index)
    goal = _lines(document, holder, target)[0] if target < len(parts) else _lines(document, holder, len(parts) - 1)[1]
    if start is None or goal is None:
        raise Refused("bad-path", "this is written in a way that is not moved here", "move it in the text")
    text = document.text
    moved = text[start:end] if text[start:end].endswith("\n") else text[start:end] + "\n"
    if text[:start].endswith("\n\n"):
        start, apart = start - 1, True
    else:
        apart = text[end : end + 1] == "\n"
        end += apart
    if target < len(parts):
        moved = moved + "\n" if apart else moved
    else:
        moved = "\n" + moved if apart else moved
        if not text[:goal].endswith("\n"):
            moved = "\n" + moved.removesuffix("\n")
    if end == len(text) and not text.endswith("\n"):
        start -= text[:start].endswith("\n")
    return [Edit(start, end, ""), Edit(goal, goal, moved)]
