"""Operations of the page on a description, as primitives: what to set, add, take out, rename."""

from __future__ import annotations

from collections.abc import Callable

from mbsym.editing.document.branches import add_body, delete_branch, reattach, rename_body
from mbsym.editing.document.copies import duplicate
from mbsym.editing.document.meaning import Json, Meant, path_of, setting, word_of
from mbsym.editing.document.primitives import Add, Primitive, Remove, Shift
from mbsym.editing.document.words import pattern, places, renamed, uses
from mbsym.editing.document.written import (
    Data,
    Path,
    Refused,
    Written,
    child,
    data_of,
    entry_of,
    is_understood,
    node_at,
    value_of,
)
from mbsym.model.momenta import momentum_names
from mbsym.model.oscillation_names import names_in, oscillating_variables, oscillation_names
from mbsym.model.system import velocity_name
from mbsym.source.placed import Node, Scalar, Sequence
from mbsym.source.scope import why_no_name


def meant(document: Written, operation: Json) -> Meant:
    """What one operation means for a text.  Refused where it means nothing."""
    kind = operation.get("op")
    if not isinstance(kind, str) or kind not in _KINDS:
        raise Refused("bad-operation", f"there is no operation {str(kind)[:40]!r}")
    return _KINDS[kind](document, operation)


# --- values -----------------------------------------------------------------------------------------------------------


def _set(document: Written, operation: Json) -> Meant:
    path, source = path_of(document, operation), word_of(operation, "source")
    node = node_at(document.tree, path)
    if not source.strip():
        return Meant([] if node is None else _gone(document, path), select=path[:-1])
    data = _typed(document, node, source)
    if document.editor and path[-1] in ("inertia", "tensor"):
        data = _rows(data)
    return Meant([setting(document, path, data, source)], select=path)


def _rows(data: Data) -> Data:
    """Principal moments as the rows that editor text has."""
    if not isinstance(data, list) or len(data) != 3 or not all(isinstance(moment, str) for moment in data):
        return data
    zero: Data = "0"
    return [[data[row] if column == row else zero for column in range(3)] for row in range(3)]


def _gone(document: Written, path: Path) -> list[Primitive]:
    """What is taken out; of a tensor of inertia its point goes with it."""
    removed: list[Primitive] = [Remove(path)]
    if len(path) == 3 and path[0] == "bodies" and path[2] == "inertia":
        body = node_at(document.tree, path[:2])
        entry = None if body is None else entry_of(body, "inertia about")
        if entry is not None and not (document.editor and is_understood(entry)):
            removed.append(Remove((*path[:2], entry.key.text)))
    return removed


def _typed(document: Written, node: Node | None, source: str) -> Data:
    """What is meant by a source; in editor text lists may stand in any brackets."""
    typed = source.strip()
    if document.editor and typed[0] in "({" and typed[-1] in ")}" and ":" not in typed and "=" not in typed:
        from mbsym.expressions.place import Span
        from mbsym.source.text_kinds import items

        listed = items(Scalar(typed, Span(1, 1, len(typed))))
        if isinstance(node, Sequence) or (isinstance(listed, Sequence) and len(listed.items) > 1):
            return data_of(listed)
    return value_of(source)


def _insert(document: Written, operation: Json) -> Meant:
    path, source = path_of(document, operation), word_of(operation, "source")
    data = _typed(document, None, source) if source.strip() else ""
    if isinstance(path[-1], str) and node_at(document.tree, path) is not None:
        raise Refused("repeated-key", f"'{path[-1]}' is there already")
    holder = node_at(document.tree, path[:-1])
    if isinstance(holder, Sequence) and isinstance(path[-1], int):
        path = (*path[:-1], min(max(0, path[-1]), len(holder.items)))
        if holder.items:
            return Meant([Add(path, data, source)], select=path)
    elif holder is None and isinstance(path[-1], int):
        path = (*path[:-1], 0)
    return Meant([setting(document, path, data, source)], select=path)


def _delete(document: Written, operation: Json) -> Meant:
    path = path_of(document, operation)
    if node_at(document.tree, path) is None:
        raise Refused("bad-path", "that is not there")
    return Meant(_gone(document, path), select=path[:-1])


def _move(document: Written, operation: Json) -> Meant:
    path = path_of(document, operation)
    target = operation.get("before")
    before = None if target is None else path_of(document, operation, "before")
    if before is not None and before[:-1] != path[:-1]:
        raise Refused("bad-operation", "something is moved within its own list only")
    return Meant([Shift(path, None if before is None else before[-1])], select=path[:-1])


# --- names ------------------------------------------------------------------------------------------------------------


def _rename(document: Written, operation: Json) -> Meant:
    kind, old, new = (word_of(operation, key) for key in ("kind", "name", "to"))
    new = new.strip()
    if kind in ("load", "constraint"):
        raise Refused("no-name", f"a {kind} has no name of its own")
    if old == new:
        return Meant([])
    if not any(place.role == "formula" and pattern([old]).fullmatch(place.node.text) for place in places(document)):
        raise Refused("unknown-name", f"there is no {kind[:20]} {old[:40]!r}")
    why = why_no_name(new)
    if why is not None:
        raise Refused("bad-name", f"nothing can be called {new[:40]!r}: {why[0]}", why[1])
    if uses(document, new) or new in _variables(document):
        raise Refused("repeated-name", f"{new!r} is there already")
    names = {old: new}
    if document.system is not None and old in document.system.coordinates and not document.system.speeds:
        momentum = momentum_names(document.system)[old]
        if momentum == f"p_{old}" and not uses(document, f"p_{new}"):
            names[momentum] = f"p_{new}"
    names |= _symbols(document, old, new)
    primitives, edits = renamed(document, names)
    return Meant(primitives, edits, names=names)


def _symbols(document: Written, old: str, new: str) -> dict[str, str]:
    """What claims about oscillations call the value of a variable at the phase 0."""
    if document.system is None:
        return {}
    starts = oscillation_names(oscillating_variables(document.system), names_in(document.system)).starts
    renamed_ = {old: new, velocity_name(old): velocity_name(new)}
    symbols = {starts[name]: f"{other}_0" for name, other in renamed_.items() if name in starts}
    return {symbol: other for symbol, other in symbols.items() if uses(document, symbol) and not uses(document, other)}


def _variables(document: Written) -> set[str]:
    """The letters of characteristic polynomials."""
    claims = node_at(document.tree, ("claims",))
    nodes = (child(claim, "variable") for claim in (claims.items if isinstance(claims, Sequence) else ()))
    return {node.text for node in nodes if isinstance(node, Scalar)}


_KINDS: dict[str, Callable[[Written, Json], Meant]] = {
    "set": _set,
    "insert": _insert,
    "delete": _delete,
    "move": _move,
    "add body": add_body,
    "rename body": rename_body,
    "reattach": reattach,
    "duplicate branch": duplicate,
    "delete branch": delete_branch,
    "rename": _rename,
}
