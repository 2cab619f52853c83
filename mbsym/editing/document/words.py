"""Where names stand in a description: in formulas, as keys, as names of bodies; and what renaming them means."""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Map
from dataclasses import dataclass
from typing import Literal

from mbsym.editing.document.pieces import Edit
from mbsym.editing.document.primitives import Primitive, Rekey, Replace
from mbsym.editing.document.spelling import scalar
from mbsym.editing.document.view import BODY_KEYS
from mbsym.editing.document.written import Path, Written, is_understood
from mbsym.model.claims import BODY, CLAIMS
from mbsym.source.keys import ALIASES, SIGNS, SMALL_PARAMETER
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence

Role = Literal["formula", "body", "new body"]

#: Sections whose keys are names, and whether their values are formulas.
_NAMED = {
    "parameters": True, "prescribed": True, "inputs": False, "outputs": True, "tables": False, "units": False,
    "relations": True, "motion": True, "notation": True, "values": True, "initial": True, "abbreviations": True,
    "limits": True, "latex": False,
}  # fmt: skip

#: Keys of records that hold no formulas.
_FREE = ("sign", "meaning", "unit", *SIGNS)
_CLAIM_FREE = ("claim", "component", "variable", "order", "as", "tolerance", "digits", "place")

_WORD = re.compile(r"[A-Za-z_]\w*")
_SPIN = re.compile(r"(omega\s*\[\s*)([^\]]*?)(\s*\])")


@dataclass(frozen=True, slots=True)
class Place:
    """A value, or a key (``is_key``), that may hold names."""

    path: Path
    node: Scalar
    role: Role
    is_key: bool = False


def places(found: Written) -> Iterator[Place]:
    """Every value and key of a description that names something of it."""
    tree = found.tree
    for entry in tree.entries if isinstance(tree, Mapping) else ():
        if not (found.editor and is_understood(entry)):
            yield from _section(ALIASES.get(entry.key.text, entry.key.text), entry, (entry.key.text,), found.editor)


def _section(name: str, entry: Entry, path: Path, editor: bool) -> Iterator[Place]:
    node = entry.value
    if name in _NAMED:
        yield from _named(node, path, _NAMED[name])
    elif name in ("order", "dependent", "dimensionless time", "assumptions"):
        yield from _formulas(node, path)
    elif name == "reactions":
        yield from _formulas(node, path, "body")
    elif name == "small parameter":
        for one, at, is_key in _leaves(node, path):
            if not (is_key and one.text in SMALL_PARAMETER):
                yield Place(at, one, "formula", is_key)
    elif name == "linear system" and isinstance(node, Mapping):
        for part in node.entries:
            if not isinstance(part.value, Mapping):
                yield from _formulas(part.value, (*path, part.key.text))
    elif name in _LISTS and isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            for place in _LISTS[name](item, (*path, index)):
                if not (editor and _goes_without_saying(item, place)):
                    yield place


def _goes_without_saying(item: Node, place: Place) -> bool:
    return isinstance(item, Mapping) and any(one.value is place.node and is_understood(one) for one in item.entries)


def _named(node: Node, path: Path, formulas: bool) -> Iterator[Place]:
    """A mapping whose keys are names, or a list of names."""
    if isinstance(node, Sequence):
        yield from _formulas(node, path)
    for entry in node.entries if isinstance(node, Mapping) else ():
        at = (*path, entry.key.text)
        yield Place(at, entry.key, "formula", True)
        if not formulas or (isinstance(entry.value, Scalar) and entry.value.text in SIGNS):
            continue
        if isinstance(entry.value, Mapping):
            for one in entry.value.entries:
                if one.key.text not in _FREE:
                    yield from _formulas(one.value, (*at, one.key.text))
        else:
            yield from _formulas(entry.value, at)


def _formulas(node: Node, path: Path, role: Role = "formula") -> Iterator[Place]:
    for one, at, is_key in _leaves(node, path):
        if not is_key:
            yield Place(at, one, role)


def _leaves(node: Node, path: Path) -> Iterator[tuple[Scalar, Path, bool]]:
    match node:
        case Scalar():
            yield node, path, False
        case Sequence(items):
            for index, item in enumerate(items):
                yield from _leaves(item, (*path, index))
        case Mapping(entries):
            for entry in entries:
                yield entry.key, (*path, entry.key.text), True
                yield from _leaves(entry.value, (*path, entry.key.text))


def _body(node: Node, path: Path) -> Iterator[Place]:
    for entry in node.entries if isinstance(node, Mapping) else ():
        key, at = ALIASES.get(entry.key.text, entry.key.text), (*path, entry.key.text)
        if key in ("name", "attached to"):
            yield from _formulas(entry.value, at, "new body" if key == "name" else "body")
        elif key in ("speeds", "orientation"):
            for one, place, is_key in _leaves(entry.value, at):
                if is_key or key == "speeds":
                    yield Place(place, one, "formula", is_key)
        elif key != "inertia about":
            yield from (one for one in _formulas(entry.value, at) if one.path[-1] != "accept")


def _tie(node: Node, path: Path) -> Iterator[Place]:
    """A load or a constraint."""
    for entry in node.entries if isinstance(node, Mapping) else ():
        kind, at = ALIASES.get(entry.key.text, entry.key.text), (*path, entry.key.text)
        if kind == "generalized force":
            yield from (Place(place, one, "formula", is_key) for one, place, is_key in _leaves(entry.value, at))
        else:
            yield from _data(entry.value, at)


def _data(node: Node, path: Path) -> Iterator[Place]:
    match node:
        case Scalar():
            role: Role = "body" if path[-1] in BODY_KEYS else "formula"
            if path[-1] != "order":
                yield Place(path, node, role)
        case Sequence(items):
            for index, item in enumerate(items):
                yield from _data(item, (*path, index))
        case Mapping(entries):
            for entry in entries:
                yield from _data(entry.value, (*path, entry.key.text))


def _claim(node: Node, path: Path) -> Iterator[Place]:
    entries = node.entries if isinstance(node, Mapping) else ()
    kinds = [entry.value.text for entry in entries if entry.key.text == "claim" and isinstance(entry.value, Scalar)]
    about_body = any(kind in CLAIMS and CLAIMS[kind].of == BODY for kind in kinds)
    for entry in entries:
        at = (*path, entry.key.text)
        if entry.key.text in _CLAIM_FREE:
            continue
        if entry.key.text == "of" and about_body:
            yield from _formulas(entry.value, at, "body")
        elif entry.key.text == "state":
            yield from (Place(place, one, "formula", is_key) for one, place, is_key in _leaves(entry.value, at))
        else:
            yield from _formulas(entry.value, at)


_LISTS = {"bodies": _body, "loads": _tie, "constraints": _tie, "claims": _claim}


# --- renaming ---------------------------------------------------------------------------------------------------------


def pattern(names: list[str]) -> re.Pattern[str]:
    """Any of some names as a word, its derivatives with respect to time included."""
    longest = sorted(names, key=len, reverse=True)
    return re.compile(rf"(?<![\w.])({'|'.join(map(re.escape, longest))})(?=(?:_d?dot)?(?![\w]))")


def words_of(found: Written) -> set[str]:
    """Every word of formulas and keys, those of velocities and accelerations by what they are derivatives of, too."""
    plain = {word for one in places(found) if one.role == "formula" for word in _WORD.findall(one.node.text)}
    return plain | {word.removesuffix(ending) for word in plain for ending in ("_dot", "_ddot")}


def uses(found: Written, name: str) -> bool:
    """Whether a name, or its velocity, stands anywhere."""
    word = pattern([name])
    return any(one.role == "formula" and word.search(one.node.text) for one in places(found))


def renamed(found: Written, names: dict[str, str]) -> tuple[list[Primitive], list[Edit]]:
    """Names to others wherever they stand in formulas and as keys: what becomes of the data, and of the text."""
    if not names:
        return [], []
    word = pattern(list(names))
    changed: list[Primitive] = []
    keys: list[Primitive] = []
    edits: list[Edit] = []
    for one in places(found):
        text = one.node.text
        turned = word.sub(lambda match: names[match[1]], text)
        if one.role != "formula" or turned == text:
            continue
        if one.is_key:
            keys.append(Rekey(one.path, turned))
        else:
            changed.append(Replace(one.path, turned))
        start, end = found.extent(one.node)
        for match in word.finditer(found.text[start:end]):
            edits.append(Edit(start + match.start(1), start + match.end(1), names[match[1]]))
    # Inner keys first, for paths hold the old ones.
    return [*changed, *sorted(keys, key=lambda one: -len(one.path))], edits


def body_renamed(found: Written, old: str, new: str) -> tuple[list[Primitive], list[Edit]]:
    """A body by another name wherever it is named."""
    changed: list[Primitive] = []
    edits: list[Edit] = []
    for one in places(found):
        text = one.node.text
        start, end = found.extent(one.node)
        if one.role == "formula":
            # omega[body][k] in a speed is the only formula that names bodies.
            spins = [match for match in _SPIN.finditer(found.text[start:end]) if match[2] == old]
            if spins:
                changed.append(Replace(one.path, _SPIN.sub(lambda match: _spin(match, old, new), text)))
                edits += [Edit(start + match.start(2), start + match.end(2), new) for match in spins]
        elif " ".join(text.split()) == old:
            changed.append(Replace(one.path, new))
            if not found.editor:
                flow = any(found.style(node) == "flow" for node in found.above(one.path))
                edits.append(Edit(start, end, scalar(new, flow)))
            elif one.role == "new body":
                edits.append(Edit(start, end, new))
    return changed, edits


def _spin(match: re.Match[str], old: str, new: str) -> str:
    return match[1] + (new if match[2] == old else match[2]) + match[3]


def spins_renamed(text: str, names: Map[str, str]) -> str:
    """A formula with bodies by other names in omega[body][k], the only formula that names bodies."""
    return _SPIN.sub(lambda match: match[1] + names.get(match[2], match[2]) + match[3], text)
