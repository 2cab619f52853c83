"""Where names stand in a description: in formulas, as keys, as names of bodies; and what renaming them means."""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Map
from dataclasses import dataclass
from typing import Literal

from mbsym.editing.document.meaning import Edit
from mbsym.editing.document.primitives import Primitive, Rekey, Replace
from mbsym.editing.document.written import Path, Written, is_understood, scalar
from mbsym.model.claims import BODY, CLAIMS
from mbsym.source.grammar import (
    About,
    BodyName,
    Either,
    Ends,
    Equation,
    Formula,
    Index,
    Key,
    Kinds,
    Listed,
    Name,
    Named,
    Record,
    Type,
    Vector,
    Word,
)
from mbsym.source.keys import ALIASES, SYSTEM
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence

Role = Literal["formula", "body", "new body"]

_WORD = re.compile(r"[A-Za-z_]\w*")
_SPIN = re.compile(r"(omega\s*\[\s*)([^\]]*?)(\s*\])")


@dataclass(frozen=True, slots=True)
class Place:
    """A value, or a key (``is_key``), that may hold names."""

    path: Path
    node: Scalar
    role: Role
    is_key: bool = False


def places(document: Written) -> Iterator[Place]:
    """Every value and key of a description that names something of it."""
    tree = document.tree
    for entry in tree.entries if isinstance(tree, Mapping) else ():
        key = SYSTEM.get(ALIASES.get(entry.key.text, entry.key.text))
        if key is None or (document.editor and is_understood(entry)):
            continue
        for place in _places(key.type, entry.value, (entry.key.text,)):
            if not (document.editor and _goes_without_saying(entry.value, place)):
                yield place


def _goes_without_saying(section: Node, place: Place) -> bool:
    """Whether it is an entry of an item of a list that is not written."""
    items = section.items if isinstance(section, Sequence) else ()
    entries = (entry for item in items if isinstance(item, Mapping) for entry in item.entries)
    return any(entry.value is place.node and is_understood(entry) for entry in entries)


def _places(of: Type, node: Node, path: Path) -> Iterator[Place]:
    """What names something in a value of a type; where a value is of another shape, it is taken for a formula."""
    match of, node:
        case Either(types), _:
            fitting = (candidate for candidate in types if _fits(candidate, node))
            yield from _places(next(fitting, Formula()), node, path)
        case ((Record() | Kinds()), Mapping(entries)):
            for entry in entries:
                yield from _places(_type_of(of, node, entry), entry.value, (*path, entry.key.text))
        case Named(value), Mapping(entries):
            for entry in entries:
                yield Place((*path, entry.key.text), entry.key, "formula", True)
                yield from _places(value, entry.value, (*path, entry.key.text))
        case ((Listed(item) | Ends(item)), Sequence(items)):
            for index, inner_node in enumerate(items):
                yield from _places(item, inner_node, (*path, index))
        case BodyName(new), _:
            yield from _leaves(node, path, "new body" if new else "body")
        case Name(own=True), _:
            pass
        case ((Formula() | Vector() | Equation() | Index() | Name() | About()), _):
            yield from _leaves(node, path, "formula")
        case ((Record() | Kinds() | Named() | Listed() | Ends()), _):
            yield from _leaves(node, path, "formula")


def _type_of(holder: Record | Kinds, node: Mapping, entry: Entry) -> Type:
    """The type of an entry; what is unknown is taken for a formula, an unknown kind for one with the keys of all."""
    known: Map[str, Key] = holder.keys if isinstance(holder, Record) else holder.kinds
    key = known.get(ALIASES.get(entry.key.text, entry.key.text))
    if key is not None and isinstance(key.type, About):
        kinds = [
            item.value.text for item in node.entries if item.key.text == "claim" and isinstance(item.value, Scalar)
        ]
        return BodyName() if any(kind in CLAIMS and CLAIMS[kind].of == BODY for kind in kinds) else Formula()
    if key is None and isinstance(holder, Kinds):
        return Record({name: kind_key for kind in holder.kinds.values() for name, kind_key in kind.keys.items()})
    return Formula() if key is None else key.type


def _fits(value_type: Type, node: Node) -> bool:
    match value_type:
        case Record() | Named():
            return isinstance(node, Mapping)
        case Listed() | Vector():
            return isinstance(node, Sequence)
        case Word(choices):
            return isinstance(node, Scalar) and node.text in map(str, choices)
    return isinstance(node, Scalar)


def _leaves(node: Node, path: Path, role: Role) -> Iterator[Place]:
    match node:
        case Scalar():
            yield Place(path, node, role)
        case Sequence(items):
            for index, item in enumerate(items):
                yield from _leaves(item, (*path, index), role)
        case Mapping(entries):
            for entry in entries:
                yield from _leaves(entry.value, (*path, entry.key.text), role)


# --- renaming ---------------------------------------------------------------------------------------------------------


def pattern(names: list[str]) -> re.Pattern[str]:
    """Any of some names as a word, its derivatives with respect to time included."""
    longest = sorted(names, key=len, reverse=True)
    return re.compile(rf"(?<![\w.])({'|'.join(map(re.escape, longest))})(?=(?:_d?dot)?(?![\w]))")


def words_of(document: Written) -> set[str]:
    """Every word of formulas and keys, those of velocities and accelerations by what they are derivatives of, too."""
    plain = {word for place in places(document) if place.role == "formula" for word in _WORD.findall(place.node.text)}
    return plain | {word.removesuffix(ending) for word in plain for ending in ("_dot", "_ddot")}


def uses(document: Written, name: str) -> bool:
    """Whether a name, or its velocity, stands anywhere."""
    word = pattern([name])
    return any(place.role == "formula" and word.search(place.node.text) for place in places(document))


def renamed(document: Written, names: dict[str, str]) -> tuple[list[Primitive], list[Edit]]:
    """Names to others wherever they stand in formulas and as keys: what becomes of the data, and of the text."""
    if not names:
        return [], []
    word = pattern(list(names))
    changed: list[Primitive] = []
    keys: list[Primitive] = []
    edits: list[Edit] = []
    for place in places(document):
        text = place.node.text
        turned = word.sub(lambda match: names[match[1]], text)
        if place.role != "formula" or turned == text:
            continue
        if place.is_key:
            keys.append(Rekey(place.path, turned))
        else:
            changed.append(Replace(place.path, turned))
        start, end = document.extent(place.node)
        for match in word.finditer(document.text[start:end]):
            edits.append(Edit(start + match.start(1), start + match.end(1), names[match[1]]))
    # Inner keys first, for paths hold the old ones.
    return [*changed, *sorted(keys, key=lambda primitive: -len(primitive.path))], edits


def body_renamed(document: Written, old: str, new: str) -> tuple[list[Primitive], list[Edit]]:
    """A body by another name wherever it is named."""
    changed: list[Primitive] = []
    edits: list[Edit] = []
    for place in places(document):
        text = place.node.text
        start, end = document.extent(place.node)
        if place.role == "formula":
            # omega[body][k] in a speed is the only formula that names bodies.
            spins = [match for match in _SPIN.finditer(document.text[start:end]) if match[2] == old]
            if spins:
                changed.append(Replace(place.path, _SPIN.sub(lambda match: _spin(match, old, new), text)))
                edits += [Edit(start + match.start(2), start + match.end(2), new) for match in spins]
        elif " ".join(text.split()) == old:
            changed.append(Replace(place.path, new))
            if not document.editor:
                flow = any(document.style(node) == "flow" for node in document.above(place.path))
                edits.append(Edit(start, end, scalar(new, flow)))
            elif place.role == "new body":
                edits.append(Edit(start, end, new))
    return changed, edits


def _spin(match: re.Match[str], old: str, new: str) -> str:
    return match[1] + (new if match[2] == old else match[2]) + match[3]


def spins_renamed(text: str, names: Map[str, str]) -> str:
    """A formula with bodies by other names in omega[body][k], the only formula that names bodies."""
    return _SPIN.sub(lambda match: match[1] + names.get(match[2], match[2]) + match[3], text)
