"""Operations on bodies: added, renamed, hung elsewhere, taken out with what hangs on them (copied: ``copies``)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from mbsym.editing.document import view
from mbsym.editing.document.meaning import Edit, Json, Meant, setting, word_of
from mbsym.editing.document.primitives import Primitive, Remove, Replace, Shift
from mbsym.editing.document.words import Place, body_renamed, pattern, places, words_of
from mbsym.editing.document.written import Data, Path, Refused, Written, child, node_at, spelled_path
from mbsym.source.bodies import is_body_name
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.starter import JOINTS, NewBody, NewParameter, coordinates_of, initial_of, on_its_joint, parameters_of


def bodies_of(document: Written) -> list[tuple[str, str]]:
    """(name, name of the previous body) of each body; "0" is the inertial frame."""
    bodies = node_at(document.tree, ("bodies",))
    pairs = []
    for body in bodies.items if isinstance(bodies, Sequence) else ():
        name, parent = child(body, "name"), child(body, "attached to")
        pairs.append((_flat(name), _flat(parent) or "0"))
    return pairs


def _flat(node: Node | None) -> str:
    return " ".join(node.text.split()) if isinstance(node, Scalar) else ""


def index_of(document: Written, name: str) -> int:
    for index, (body, _) in enumerate(bodies_of(document)):
        if body == name:
            return index
    raise Refused("unknown-body", f"there is no body {name[:80]!r}")


def _new_name(document: Written, name: str) -> str:
    name = " ".join(name.split())
    if not is_body_name(name) or name == "ground":
        hint = "letters, digits, blanks and . / _ -, beginning with a letter"
        raise Refused("bad-name", f"a body cannot be called {name[:80]!r}", hint)
    if any(body == name for body, _ in bodies_of(document)):
        raise Refused("repeated-name", f"there is a body {name!r} already")
    return name


def _parent(document: Written, operation: Json) -> str:
    to = operation.get("to")
    if to is None or to == "0":
        return "0"
    name = word_of(operation, "to")
    index_of(document, name)
    return name


def add_body(document: Written, operation: Json) -> Meant:
    """A new body; with a ``joint`` (of ``starter.JOINTS``; its ``axis``) its coordinates, mass and moments, in symbols.

    Its parameters are positive, with the values of ``starter``, and have names that nothing else has.
    """
    name, parent = _new_name(document, word_of(operation, "name")), _parent(document, operation)
    data: dict[str, Data] = {"name": name, "attached to": parent}
    path = ("bodies", len(bodies_of(document)))
    if "joint" not in operation:
        return Meant([setting(document, path, {**data, "mass": "0"}, None)], select=path)
    joint, axis = word_of(operation, "joint"), operation.get("axis")
    if joint not in JOINTS or axis not in (None, 1, 2, 3):
        raise Refused("bad-operation", f"a joint is one of {', '.join(JOINTS)}, its axis 1, 2 or 3")
    body, known = NewBody(name, parent, joint, axis), words_of(document)
    if isinstance(document.tree, Mapping):
        for index, _ in enumerate(bodies_of(document)):
            known |= set(own_names(document, document.tree, index))
    number = next(k for k in count(path[1] + 1) if known.isdisjoint(_names(k, body)))
    carried = _turns(document, parent)
    turns = bool(body.axes) or carried
    parameters = parameters_of(number, body, turns)
    below = f"d{number}" if carried else "0"
    if carried:
        parameters[below] = NewParameter(f"distance from the joint of {parent} to that of {name}", "1")
    data |= on_its_joint(number, body, below, turns)
    moved = initial_of(number, body)
    begun = (
        [setting(document, ("initial", coordinate), value, None) for coordinate, value in moved.items()]
        if _begins(document)
        else []
    )
    return Meant([*_declared(document, parameters), setting(document, path, data, None), *begun], select=path)


def _begins(document: Written) -> bool:
    """Whether coordinates of an initial state are listed one by one."""
    return isinstance(node_at(document.tree, ("initial",)), Mapping)


def _turns(document: Written, name: str) -> bool:
    """Whether a body has a rotation, or one of those that carry it."""
    parents = dict(bodies_of(document))
    while name in parents:
        path = ("bodies", index_of(document, name))
        if any(node_at(document.tree, (*path, key)) is not None for key in ("rotation", "orientation")):
            return True
        name = parents.pop(name)
    return False


def _names(number: int, body: NewBody) -> set[str]:
    return {*parameters_of(number, body), *coordinates_of(number, body), f"d{number}"}


def _declared(document: Written, parameters: dict[str, NewParameter]) -> list[Primitive]:
    """These parameters, positive."""
    new: dict[str, Data] = {
        name: {"sign": "positive", "value": x.value, "meaning": x.meaning} for name, x in parameters.items()
    }
    node = None if document.tree is None else child(document.tree, "parameters")
    if isinstance(node, Mapping) and node.entries:
        return [setting(document, ("parameters", name), entry, None) for name, entry in new.items()]
    plain = node.items if isinstance(node, Sequence) else ()
    known: dict[str, Data] = {scalar.text: "real" for scalar in plain if isinstance(scalar, Scalar)}
    return [setting(document, ("parameters",), {**known, **new}, None)]


def rename_body(document: Written, operation: Json) -> Meant:
    old, new_name = " ".join(word_of(operation, "body").split()), word_of(operation, "name")
    index = index_of(document, old)
    if " ".join(new_name.split()) == old:
        return Meant([])
    new = _new_name(document, new_name)
    primitives, edits = body_renamed(document, old, new)
    bodies = {old: new}
    for place, meaning, edit in _meanings_renamed(document, old, new):
        primitives.append(Replace(place.path, meaning))
        edits.append(edit)
        bodies[place.node.text] = meaning
    return Meant(primitives, edits, ("bodies", index), bodies=bodies)


def _meanings_renamed(document: Written, old: str, new: str) -> Iterator[tuple[Place, str, Edit]]:
    """Of parameters that came with the body, "mass of body": where they stand, and what they become."""
    parameters = node_at(document.tree, ("parameters",))
    around = [x.meaning.split("\0") for x in parameters_of(1, NewBody("\0")).values()]
    for entry in parameters.entries if isinstance(parameters, Mapping) else ():
        node = child(entry.value, "meaning")
        if not isinstance(node, Scalar):
            continue
        for before, after in around:
            start = document.text.find(f"{before}{old}{after}", *document.extent(node)) + len(before)
            if node.text == f"{before}{old}{after}" and start >= len(before):
                path = spelled_path(document.tree, ("parameters", entry.key.text, "meaning"))
                yield Place(path, node, "body"), f"{before}{new}{after}", Edit(start, start + len(old), new)


def branch_of(document: Written, name: str) -> list[int]:
    """A body and what hangs on it."""
    inside, indices = {name}, []
    for index, (body, parent) in enumerate(bodies_of(document)):
        if body == name or parent in inside:
            inside.add(body)
            indices.append(index)
    return indices


def reattach(document: Written, operation: Json) -> Meant:
    """The body hangs on another one; what it hangs on stands before it, so the branch may move behind it."""
    name = " ".join(word_of(operation, "body").split())
    index, parent = index_of(document, name), _parent(document, operation)
    branch = branch_of(document, name)
    if parent != "0" and index_of(document, parent) in branch:
        raise Refused("cyclic-bodies", f"{parent} hangs on {name} itself", "a body hangs on one outside its own branch")
    path = spelled_path(document.tree, ("bodies", index, "attached to"))
    primitives: list[Primitive] = [setting(document, path, parent, None)]
    place = -1 if parent == "0" else index_of(document, parent)
    if place > index:
        count = len(bodies_of(document))
        target = place + 1 if place + 1 < count else None
        moved = [position for position in branch if position < place]
        for done, position in enumerate(moved):
            primitives.append(Shift(("bodies", position - done), target))
        index = place + 1 - len(moved)
    return Meant(primitives, select=("bodies", index))


def own_names(document: Written, tree: Mapping, index: int) -> list[str]:
    """Coordinates, speeds and vectors that a body declares."""
    body = node_at(tree, ("bodies", index))
    own = [] if body is None else view.coordinates_of(document, tree, body, index)
    for key in ("speeds", "orientation"):
        node = None if body is None else child(body, key)
        own += [entry.key.text for entry in node.entries] if isinstance(node, Mapping) else []
    return own


def delete_branch(document: Written, operation: Json) -> Meant:
    """A branch with everything that names its bodies or their coordinates."""
    name = " ".join(word_of(operation, "body").split())
    index_of(document, name)
    branch, tree = branch_of(document, name), document.tree
    assert isinstance(tree, Mapping)
    gone = {bodies_of(document)[index][0] for index in branch}
    names = {own_name for index in branch for own_name in own_names(document, tree, index)}
    names |= {f"{vector}{k}" for vector in vectors(document, branch) for k in range(4)}
    taken: dict[Path, None] = {}
    while True:
        word = pattern(sorted(names)) if names else None
        before = len(taken)
        for place in places(document):
            if place.path[0] == "bodies":
                continue
            named = place.role == "body" and " ".join(place.node.text.split()) in gone
            if named or (place.role == "formula" and word is not None and word.search(place.node.text)):
                unit = place.path[:2]
                taken[unit] = None
                if unit[0] in ("abbreviations", "outputs") and isinstance(unit[1], str):
                    names.add(unit[1])
        if len(taken) == before:
            break
    _check_outside(document, branch, names)
    units = [*taken, *(("bodies", index) for index in branch)]
    ordered = sorted(
        units, key=lambda path: (str(path[0]), path[1] if isinstance(path[1:2] and path[1], int) else -1), reverse=True
    )
    return Meant([Remove(path) for path in ordered], select=("bodies",), taken=list(taken))


def _check_outside(document: Written, branch: list[int], names: set[str]) -> None:
    """Other bodies may not use the coordinates of a branch that goes."""
    word = pattern(sorted(names)) if names else None
    for place in places(document):
        if place.path[0] != "bodies" or place.path[1] in branch or place.role != "formula" or word is None:
            continue
        if word.search(place.node.text):
            where = _flat(node_at(document.tree, (*place.path[:2], "name")))
            message = f"body {where} uses a coordinate of this branch: {place.node.text[:60]}"
            raise Refused("used-elsewhere", message, "change that body first")


def vectors(document: Written, branch: list[int]) -> list[str]:
    nodes = (node_at(document.tree, ("bodies", index, "orientation")) for index in branch)
    return [entry.key.text for node in nodes if isinstance(node, Mapping) for entry in node.entries]
