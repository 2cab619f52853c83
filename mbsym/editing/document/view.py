"""What form and graph show of a description: bodies with their fields, loads, constraints, the tree as written."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from collections.abc import Sequence as Items
from typing import Any

from mbsym.editing.document.written import (
    Refused,
    Written,
    child,
    data_of,
    entry_of,
    flow,
    is_understood,
    node_at,
    original_offsets,
    written,
)
from mbsym.expressions.angles import angle_name
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaint, Complaints
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import ONE, Derivation, Expression, Name, names, text
from mbsym.formulas.mathml import MathNames, row, table
from mbsym.report.html.description import expression
from mbsym.source.keys import ALIASES, BODY
from mbsym.source.labels import NUMBERED
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence

Json = dict[str, Any]

#: Keys of a body whose values are no formulas.
_NO_FORMULAS = ("name", "attached to", "rotation", "inertia about", "coordinates", "shapes", "speeds", "orientation")

#: So often what cannot be read is looked past.
_TRIES = 4


def look(text: str, name: str) -> Json:
    """What can be had of a text, which may be half typed: bodies, loads, constraints, the tree, all complaints.

    Offsets (``from``, ``to``) count the characters of ``text``.  Where a section cannot be read the others are shown;
    the complaints are always those of the whole text.
    """
    document = written(text, name)
    shown = document if document.tree is not None else _what_can_be_had(document)
    tree = shown.tree if isinstance(shown.tree, Mapping) else None
    bodies = [] if tree is None else list(_bodies(shown, tree))
    view: Json = {
        "name": _text(tree, "name"),
        "format": "text" if shown.editor else "yaml",
        "tree": None if tree is None else _node(shown, tree, []),
        "bodies": bodies,
        "constraints": [] if tree is None else list(ties(shown, tree, "constraints")),
        "loads": [] if tree is None else list(ties(shown, tree, "loads", _moved_by(bodies))),
        "complaints": [complaint_view(document, complaint) for complaint in document.complaints],
    }
    offsets = original_offsets(text)
    return view if offsets is None else moved(view, offsets.__getitem__)


# --- what cannot be read ----------------------------------------------------------------------------------------------


def _what_can_be_had(document: Written) -> Written:
    """The text with the section in which it cannot be read left out (as blanks: all places stay)."""
    text, complaints = document.text, document.complaints
    for _ in range(_TRIES):
        place = next((error.span for error in complaints.errors if error.span is not None), None)
        if place is None:
            break
        lines = text.split("\n")
        wrong = min(place.line, len(lines)) - 1
        first = next((k for k in range(wrong, -1, -1) if _begins(lines[k])), None)
        if first is None:
            break
        last = next((k for k in range(max(wrong, first + 1), len(lines)) if _begins(lines[k])), len(lines))
        if last <= wrong:
            last = wrong + 1
        text = "\n".join([*lines[:first], *(" " * len(line) for line in lines[first:last]), *lines[last:]])
        again = written(text, document.name, understand=False)
        if again.tree is not None:
            return again
        complaints = again.complaints
    return document


def _begins(line: str) -> bool:
    return bool(re.match(r"[A-Za-z\"']", line))


# --- bodies -----------------------------------------------------------------------------------------------------------


def _bodies(document: Written, tree: Mapping) -> Iterator[Json]:
    bodies, rates = child(tree, "bodies"), rates_of(document, tree)
    for index, node in enumerate(bodies.items if isinstance(bodies, Sequence) else ()):
        start, end = document.extent(node)
        name = _text(node, "name")
        parent = " ".join(_text(node, "attached to").split())
        yield {
            "name": " ".join(name.split()),
            "path": ["bodies", index],
            "parent": None if parent in ("", "0") else parent,
            "from": start,
            "to": end,
            "fields": _fields(document, tree, node, index, rates),
        }


def _fields(document: Written, tree: Mapping, body: Node, index: int, rates: dict[str, Expression]) -> Json:
    fields: Json = {}
    derived = understood(document, tree, body, index, rates)
    for key in BODY:
        entry = entry_of(body, key)
        path = ["bodies", index, key if entry is None else entry.key.text]
        if entry is None or (document.editor and is_understood(entry)):
            fields[key] = {"path": path, "source": None, "from": None, "to": None, "mathml": None}
        else:
            start, end = document.extent(entry.value)
            source = source_of(document, entry.value)
            math = None if key in _NO_FORMULAS else mathml_of(entry.value)
            fields[key] = {"path": path, "source": source, "from": start, "to": end, "mathml": math}
        fields[key]["derived"] = derived.get(key) if fields[key]["source"] is None else None
    return fields


def source_of(document: Written, node: Node) -> str:
    """A node as it is spelled, in one line."""
    if isinstance(node, Scalar):
        return document.source(node)
    start, end = document.extent(node)
    spelled = document.text[start:end]
    if "\n" not in spelled and spelled[:1] in ("[", "{", "("):
        return spelled
    try:
        return flow(data_of(node))
    except Refused:  # a key twice
        return spelled


# --- loads, constraints -----------------------------------------------------------------------------------------------


def _moved_by(bodies: list[Json]) -> dict[str, str]:
    """Coordinates, each with the body that introduces it."""
    owners: dict[str, str] = {}
    for body in bodies:
        field = body["fields"]["coordinates"]
        source = field["source"] or (field["derived"] or {}).get("source") or ""
        for name in re.findall(r"[A-Za-z]\w*", source):
            owners.setdefault(name, body["name"])
    return owners


def ties(document: Written, tree: Mapping, section: str, owners: dict[str, str] | None = None) -> Iterator[Json]:
    """Loads or constraints: their kinds and the bodies that they name; what acts on a coordinate acts on the body that
    introduces it (``owners``)."""
    nodes = child(tree, section)
    for index, node in enumerate(nodes.items if isinstance(nodes, Sequence) else ()):
        start, end = document.extent(node)
        entry = node.entries[0] if isinstance(node, Mapping) and node.entries else None
        kind = "" if entry is None else ALIASES.get(entry.key.text, entry.key.text)
        bodies = [] if entry is None else list(dict.fromkeys(named_bodies(kind, entry.value)))
        if entry is not None and owners and not bodies:
            named = (owners.get(coordinate) for coordinate in _coordinates_in(kind, entry.value))
            bodies = list(dict.fromkeys(one for one in named if one is not None))
        path = [section, index]
        yield {"name": f"{kind} {index + 1}", "kind": kind, "path": path, "bodies": bodies, "from": start, "to": end}


def _coordinates_in(kind: str, node: Node) -> list[str]:
    """Those that a load acts on by name."""
    if kind == "generalized force" and isinstance(node, Mapping):
        return [entry.key.text for entry in node.entries]
    value = child(node, "coordinate") if isinstance(node, Mapping) else None
    return [value.text] if isinstance(value, Scalar) else []


def named_bodies(kind: str, node: Node) -> Iterator[str]:
    """The bodies that a load or constraint names, the inertial frame not counted."""
    if kind == "generalized force" or isinstance(node, Scalar):
        return
    if isinstance(node, Sequence):
        for item in node.items:
            yield from named_bodies(kind, item)
        return
    for entry in node.entries:
        value = entry.value
        if entry.key.text == "between":
            yield from named_bodies(kind, value)
        elif ALIASES.get(entry.key.text, entry.key.text) in NUMBERED and isinstance(value, Scalar):
            name = " ".join(value.text.split())
            if name not in ("0", "ground", ""):
                yield name


# --- the tree ---------------------------------------------------------------------------------------------------------


def _node(document: Written, node: Node, path: list[str | int], entry: Entry | None = None) -> Json:
    start, end = document.extent(node)
    shown: Json = {"path": path, "from": start, "to": end}
    if entry is not None:
        first, last = document.key(entry)
        shown["key"] = {"from": first, "to": last}
    match node:
        case Scalar():
            return shown | {"kind": "scalar", "source": document.source(node)}
        case Sequence(items):
            children = [_node(document, item, [*path, index]) for index, item in enumerate(items)]
            return shown | {"kind": "sequence", "children": children}
    children = [
        _node(document, inner_entry.value, [*path, inner_entry.key.text], inner_entry)
        for inner_entry in node.entries
        if not (document.editor and is_understood(inner_entry))
    ]
    return shown | {"kind": "mapping", "children": children}


def _text(node: Node | None, key: str) -> str:
    value = node_at(node, (key,))
    return value.text if isinstance(value, Scalar) else ""


# --- complaints -------------------------------------------------------------------------------------------------------


def complaint_view(document: Written, complaint: Complaint) -> Json:
    """A complaint with its place; what concerns the whole text stands at its beginning."""
    if complaint.span is None:
        return told(complaint, 0, 0)
    start = document.offset(complaint.span)
    return told(
        complaint,
        start,
        min(len(document.text), start + complaint.span.length),
        complaint.span.line,
        complaint.span.column,
    )


def told(fault: Complaint, start: int, end: int, line: int = 1, column: int = 1) -> Json:
    """A complaint as the page has it."""
    fields = {"severity": fault.severity, "code": fault.code, "message": fault.message, "hint": fault.hint}
    return fields | {"from": start, "to": end, "line": line, "column": column}


def moved(value: Any, place: Callable[[int], int]) -> Any:
    """A JSON value with ``place`` of its places: of the whole numbers under the keys ``from`` and ``to``."""
    if isinstance(value, list | tuple):
        return [moved(item, place) for item in value]
    if not isinstance(value, dict):
        return value
    return {
        key: place(item) if key in ("from", "to") and type(item) is int else moved(item, place)
        for key, item in value.items()
    }


# Formulas of a description as MathML, as they are written.


def content(tree: Expression) -> str:
    """What stands in a ``<math>``."""
    return str(expression(tree, MathNames(sorted(names(tree)))))


def math(inner: str) -> str:
    return f"<math>{inner}</math>"


def vector(trees: Items[Expression]) -> str:
    return math(row([content(tree) for tree in trees]))


def mathml_of(node: Node) -> str | None:
    """A formula, a vector or a matrix of formulas; None where something of it is none."""
    if isinstance(node, Mapping):
        node = child(node, "tensor") or node
    if isinstance(node, Scalar):
        cell = _cell(node)
        return None if cell is None else math(cell)
    if not isinstance(node, Sequence) or not node.items:
        return None
    if all(isinstance(item, Sequence) for item in node.items):
        rows = [_cells(item) for item in node.items]
        return None if any(row is None for row in rows) else math(table([row for row in rows if row is not None]))
    cells = _cells(node)
    return None if cells is None else math(row(cells))


def _cells(node: Node) -> list[str] | None:
    cells = [_cell(item) for item in node.items] if isinstance(node, Sequence) else []
    formulas = [cell for cell in cells if cell is not None]
    return formulas if cells and len(formulas) == len(cells) else None


def _cell(node: Node) -> str | None:
    if not isinstance(node, Scalar) or not node.text.strip():
        return None
    tree = parse_expression(node.text, Complaints(), node.place)
    return None if tree is None else content(tree)


# What is understood of a body where its description says nothing, so that a form can show it.


_ZEROS = "[0, 0, 0]"

#: A derived velocity with more characters in a component is not shown.
_LONGEST = 2_000


def understood(
    document: Written, tree: Mapping, body: Node, index: int, rates: dict[str, Expression]
) -> dict[str, Any]:
    """By key, ``{"source", "mathml"}`` of what goes without saying.

    The relative velocity is the derivative of the connection point, term by term: d/dt f = sum_q (df/dq) q' + df/dt, of
    prescribed quantities with their rates.
    """
    shown = {key: _shown(_ZEROS) for key in ("connection point", "mass centre", "gyrostatic moment")}
    if index == 0:
        shown["attached to"] = _shown("0")
    listed = coordinates_of(document, tree, body, index)
    shown["coordinates"] = _shown(f"[{', '.join(listed)}]")
    velocity = _velocity(body, rates)
    if velocity is not None:
        shown["relative velocity"] = velocity
    return shown


def _shown(source: str, mathml: str | None = None) -> dict[str, Any]:
    return {"source": source, "mathml": mathml}


def coordinates_of(document: Written, tree: Mapping, body: Node, index: int) -> list[str]:
    """Of the system where there is one; else those listed, or names that stand alone as angles and are no others'."""
    if document.system is not None and index < len(document.system.bodies):
        return [*document.system.bodies[index].coordinates]
    node = child(body, "coordinates")
    if isinstance(node, Sequence):
        return [item.text for item in node.items if isinstance(item, Scalar)]
    if isinstance(node, Scalar) and node.text:
        return [node.text]
    rotation = child(body, "rotation")
    angles = child(rotation, "angles") if rotation is not None else None
    declared = {name for key in ("parameters", "prescribed", "given", "inputs") for name in _names_in(child(tree, key))}
    alone = (angle_name(tree) for tree in _trees(angles) if tree is not None)
    return list(dict.fromkeys(name for name in alone if name is not None and name not in declared))


def _names_in(node: Node | None) -> Iterator[str]:
    if isinstance(node, Mapping):
        yield from (entry.key.text for entry in node.entries)
    elif isinstance(node, Sequence):
        yield from (item.text for item in node.items if isinstance(item, Scalar))


def _trees(node: Node | None) -> list[Expression | None]:
    items = node.items if isinstance(node, Sequence) else ()
    return [_tree(item) for item in items]


def _tree(node: Node) -> Expression | None:
    return parse_expression(node.text, Complaints(), node.place) if isinstance(node, Scalar) and node.text else None


def _velocity(body: Node, rates: dict[str, Expression]) -> dict[str, Any] | None:
    node = child(body, "connection point")
    if node is None:
        return _shown(_ZEROS)
    radius = [tree for tree in _trees(node) if tree is not None]
    if len(radius) != 3:
        return None

    try:
        derived = [Derivation(rates)(component) for component in radius]
    except ValueError:  # of a function that jumps
        return None
    sources = [text(component) for component in derived]
    if any(len(source) > _LONGEST for source in sources):
        return None
    return _shown(f"[{', '.join(sources)}]", vector(derived))


def rates_of(document: Written, tree: Mapping) -> dict[str, Expression]:
    """Name -> its derivative: coordinates, prescribed quantities, the time."""
    rates: dict[str, Expression] = {"t": ONE}
    prescribed = child(tree, "prescribed")
    for entry in prescribed.entries if isinstance(prescribed, Mapping) else ():
        node = child(entry.value, "rate") if isinstance(entry.value, Mapping) else entry.value
        rate = None if node is None else _tree(node)
        if rate is not None:
            rates[entry.key.text] = rate
    rates |= {name: Name(velocity_name(name)) for name in _names_in(child(tree, "given"))}
    bodies = child(tree, "bodies")
    for index, body in enumerate(bodies.items if isinstance(bodies, Sequence) else ()):
        for name in coordinates_of(document, tree, body, index):
            rates[name] = Name(velocity_name(name))
    return rates
