"""Operations on bodies: added, renamed, hung elsewhere, taken out with what hangs on them (copied: ``copies``)."""

from __future__ import annotations

from itertools import count

from mbsym.editing.document import view
from mbsym.editing.document.meaning import Json, Meant, setting, word_of
from mbsym.editing.document.primitives import Primitive, Remove, Shift
from mbsym.editing.document.words import body_renamed, pattern, places, words_of
from mbsym.editing.document.written import Data, Path, Refused, Written, child, node_at, spelled_path
from mbsym.source.bodies import is_body_name
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
from mbsym.source.starter import JOINTS, NewBody, NewParameter, coordinates_of, initial_of, on_its_joint, parameters_of


def bodies_of(found: Written) -> list[tuple[str, str]]:
    """(name, name of the previous body) of each body; "0" is the inertial frame."""
    bodies = node_at(found.tree, ("bodies",))
    pairs = []
    for body in bodies.items if isinstance(bodies, Sequence) else ():
        name, parent = child(body, "name"), child(body, "attached to")
        pairs.append((_flat(name), _flat(parent) or "0"))
    return pairs


def _flat(node: Node | None) -> str:
    return " ".join(node.text.split()) if isinstance(node, Scalar) else ""


def index_of(found: Written, name: str) -> int:
    for index, (one, _) in enumerate(bodies_of(found)):
        if one == name:
            return index
    raise Refused("unknown-body", f"there is no body {name[:80]!r}")


def _new_name(found: Written, name: str) -> str:
    name = " ".join(name.split())
    if not is_body_name(name) or name == "ground":
        hint = "letters, digits, blanks and . / _ -, beginning with a letter"
        raise Refused("bad-name", f"a body cannot be called {name[:80]!r}", hint)
    if any(one == name for one, _ in bodies_of(found)):
        raise Refused("repeated-name", f"there is a body {name!r} already")
    return name


def _parent(found: Written, operation: Json) -> str:
    to = operation.get("to")
    if to is None or to == "0":
        return "0"
    name = word_of(operation, "to")
    index_of(found, name)
    return name


def add_body(found: Written, operation: Json) -> Meant:
    """A new body; with a ``joint`` (of ``starter.JOINTS``; its ``axis``) its coordinates, mass and moments, in symbols.

    Its parameters are positive, with the values of ``starter``, and have names that nothing else has.
    """
    name, parent = _new_name(found, word_of(operation, "name")), _parent(found, operation)
    data: dict[str, Data] = {"name": name, "attached to": parent}
    path = ("bodies", len(bodies_of(found)))
    if "joint" not in operation:
        return Meant([setting(found, path, {**data, "mass": "0"}, None)], select=path)
    joint, axis = word_of(operation, "joint"), operation.get("axis")
    if joint not in JOINTS or axis not in (None, 1, 2, 3):
        raise Refused("bad-operation", f"a joint is one of {', '.join(JOINTS)}, its axis 1, 2 or 3")
    body, known = NewBody(name, parent, joint, axis), words_of(found)
    if isinstance(found.tree, Mapping):
        for index, _ in enumerate(bodies_of(found)):
            known |= set(own_names(found, found.tree, index))
    number = next(k for k in count(path[1] + 1) if known.isdisjoint(_names(k, body)))
    carried = _turns(found, parent)
    turns = bool(body.axes) or carried
    parameters = parameters_of(number, body, turns)
    below = f"d{number}" if carried else "0"
    if carried:
        parameters[below] = NewParameter(f"distance from the joint of {parent} to that of {name}", "1")
    data |= on_its_joint(number, body, below, turns)
    moved = initial_of(number, body)
    begun = [setting(found, ("initial", one), value, None) for one, value in moved.items()] if _begins(found) else []
    return Meant([*_declared(found, parameters), setting(found, path, data, None), *begun], select=path)


def _begins(found: Written) -> bool:
    """Whether coordinates of an initial state are listed one by one."""
    return isinstance(node_at(found.tree, ("initial",)), Mapping)


def _turns(found: Written, name: str) -> bool:
    """Whether a body has a rotation, or one of those that carry it."""
    parents = dict(bodies_of(found))
    while name in parents:
        path = ("bodies", index_of(found, name))
        if any(node_at(found.tree, (*path, key)) is not None for key in ("rotation", "orientation")):
            return True
        name = parents.pop(name)
    return False


def _names(number: int, body: NewBody) -> set[str]:
    return {*parameters_of(number, body), *coordinates_of(number, body), f"d{number}"}


def _declared(found: Written, parameters: dict[str, NewParameter]) -> list[Primitive]:
    """These parameters, positive."""
    new: dict[str, Data] = {
        name: {"sign": "positive", "value": one.value, "meaning": one.meaning} for name, one in parameters.items()
    }
    node = None if found.tree is None else child(found.tree, "parameters")
    if isinstance(node, Mapping) and node.entries:
        return [setting(found, ("parameters", name), one, None) for name, one in new.items()]
    plain = node.items if isinstance(node, Sequence) else ()
    known: dict[str, Data] = {one.text: "real" for one in plain if isinstance(one, Scalar)}
    return [setting(found, ("parameters",), {**known, **new}, None)]


def rename_body(found: Written, operation: Json) -> Meant:
    old, given = " ".join(word_of(operation, "body").split()), word_of(operation, "name")
    index = index_of(found, old)
    if " ".join(given.split()) == old:
        return Meant([])
    new = _new_name(found, given)
    primitives, edits = body_renamed(found, old, new)
    return Meant(primitives, edits, ("bodies", index), bodies={old: new})


def branch_of(found: Written, name: str) -> list[int]:
    """A body and what hangs on it."""
    inside, indices = {name}, []
    for index, (one, parent) in enumerate(bodies_of(found)):
        if one == name or parent in inside:
            inside.add(one)
            indices.append(index)
    return indices


def reattach(found: Written, operation: Json) -> Meant:
    """The body hangs on another one; what it hangs on stands before it, so the branch may move behind it."""
    name = " ".join(word_of(operation, "body").split())
    index, parent = index_of(found, name), _parent(found, operation)
    branch = branch_of(found, name)
    if parent != "0" and index_of(found, parent) in branch:
        raise Refused("cyclic-bodies", f"{parent} hangs on {name} itself", "a body hangs on one outside its own branch")
    path = spelled_path(found.tree, ("bodies", index, "attached to"))
    primitives: list[Primitive] = [setting(found, path, parent, None)]
    place = -1 if parent == "0" else index_of(found, parent)
    if place > index:
        count = len(bodies_of(found))
        target = place + 1 if place + 1 < count else None
        moved = [one for one in branch if one < place]
        for done, one in enumerate(moved):
            primitives.append(Shift(("bodies", one - done), target))
        index = place + 1 - len(moved)
    return Meant(primitives, select=("bodies", index))


def own_names(found: Written, tree: Mapping, index: int) -> list[str]:
    """Coordinates, speeds and vectors that a body declares."""
    body = node_at(tree, ("bodies", index))
    own = [] if body is None else view.coordinates_of(found, tree, body, index)
    for key in ("speeds", "orientation"):
        node = None if body is None else child(body, key)
        own += [entry.key.text for entry in node.entries] if isinstance(node, Mapping) else []
    return own


def delete_branch(found: Written, operation: Json) -> Meant:
    """A branch with everything that names its bodies or their coordinates."""
    name = " ".join(word_of(operation, "body").split())
    index_of(found, name)
    branch, tree = branch_of(found, name), found.tree
    assert isinstance(tree, Mapping)
    gone = {bodies_of(found)[index][0] for index in branch}
    names = {own_name for index in branch for own_name in own_names(found, tree, index)}
    names |= {f"{vector}{k}" for vector in vectors(found, branch) for k in range(4)}
    taken: dict[Path, None] = {}
    while True:
        word = pattern(sorted(names)) if names else None
        before = len(taken)
        for place in places(found):
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
    _check_outside(found, branch, names)
    units = [*taken, *(("bodies", index) for index in branch)]
    ordered = sorted(
        units, key=lambda path: (str(path[0]), path[1] if isinstance(path[1:2] and path[1], int) else -1), reverse=True
    )
    return Meant([Remove(path) for path in ordered], select=("bodies",), taken=list(taken))


def _check_outside(found: Written, branch: list[int], names: set[str]) -> None:
    """Other bodies may not use the coordinates of a branch that goes."""
    word = pattern(sorted(names)) if names else None
    for place in places(found):
        if place.path[0] != "bodies" or place.path[1] in branch or place.role != "formula" or word is None:
            continue
        if word.search(place.node.text):
            where = _flat(node_at(found.tree, (*place.path[:2], "name")))
            message = f"body {where} uses a coordinate of this branch: {place.node.text[:60]}"
            raise Refused("used-elsewhere", message, "change that body first")


def vectors(found: Written, branch: list[int]) -> list[str]:
    nodes = (node_at(found.tree, ("bodies", index, "orientation")) for index in branch)
    return [entry.key.text for node in nodes if isinstance(node, Mapping) for entry in node.entries]
