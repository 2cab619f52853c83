"""What is understood of a body where its description says nothing, so that a form can show it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mbsym.editing.document.written import Written, child
from mbsym.expressions.angles import angle_name
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import ONE, Derivation, Expression, Name, text
from mbsym.source.placed import Mapping, Node, Scalar, Sequence

_ZEROS = "[0, 0, 0]"

#: A derived velocity with more characters in a component is not shown.
_LONGEST = 2_000


def understood(found: Written, tree: Mapping, body: Node, index: int, rates: dict[str, Expression]) -> dict[str, Any]:
    """By key, ``{"source", "mathml"}`` of what goes without saying.

    The relative velocity is the derivative of the connection point, term by term: d/dt f = sum_q (df/dq) q' + df/dt, of
    prescribed quantities with their rates.
    """
    shown = {key: _shown(_ZEROS) for key in ("connection point", "mass centre", "gyrostatic moment")}
    if index == 0:
        shown["attached to"] = _shown("0")
    listed = coordinates_of(found, tree, body, index)
    shown["coordinates"] = _shown(f"[{', '.join(listed)}]")
    velocity = _velocity(body, rates)
    if velocity is not None:
        shown["relative velocity"] = velocity
    return shown


def _shown(source: str, mathml: str | None = None) -> dict[str, Any]:
    return {"source": source, "mathml": mathml}


def coordinates_of(found: Written, tree: Mapping, body: Node, index: int) -> list[str]:
    """Of the system where there is one; else those listed, or names that stand alone as angles and are no others'."""
    if found.system is not None and index < len(found.system.bodies):
        return [*found.system.bodies[index].coordinates]
    node = child(body, "coordinates")
    if isinstance(node, Sequence):
        return [item.text for item in node.items if isinstance(item, Scalar)]
    if isinstance(node, Scalar) and node.text:
        return [node.text]
    rotation = child(body, "rotation")
    angles = child(rotation, "angles") if rotation is not None else None
    declared = {name for key in ("parameters", "prescribed", "inputs") for name in _names_in(child(tree, key))}
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
    radius = [one for one in _trees(node) if one is not None]
    if len(radius) != 3:
        return None
    from mbsym.editing.document.view import vector

    try:
        derived = [Derivation(rates)(one) for one in radius]
    except ValueError:  # of a function that jumps
        return None
    sources = [text(one) for one in derived]
    if any(len(one) > _LONGEST for one in sources):
        return None
    return _shown(f"[{', '.join(sources)}]", vector(derived))


def rates_of(found: Written, tree: Mapping) -> dict[str, Expression]:
    """Name -> its derivative: coordinates, prescribed quantities, the time."""
    rates: dict[str, Expression] = {"t": ONE}
    prescribed = child(tree, "prescribed")
    for entry in prescribed.entries if isinstance(prescribed, Mapping) else ():
        node = child(entry.value, "rate") if isinstance(entry.value, Mapping) else entry.value
        rate = None if node is None else _tree(node)
        if rate is not None:
            rates[entry.key.text] = rate
    bodies = child(tree, "bodies")
    for index, body in enumerate(bodies.items if isinstance(bodies, Sequence) else ()):
        for name in coordinates_of(found, tree, body, index):
            rates[name] = Name(velocity_name(name))
    return rates
