"""A branch copied: its bodies under new names, and with them what acts on them, ties them, and where they begin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from mbsym.editing.document.branches import bodies_of, branch_of, index_of, own_names, vectors
from mbsym.editing.document.meaning import Json, Meant, word_of
from mbsym.editing.document.primitives import Add, Rekey, Remove, Replace, applied_to
from mbsym.editing.document.words import Place, pattern, places, spins_renamed, words_of
from mbsym.editing.document.written import Data, Path, Written, child, data_of, node_at
from mbsym.source.keys import ALIASES
from mbsym.source.placed import Mapping, Scalar, Sequence

#: Sections of one entry for each name, which a copy needs of its own.
_BY_NAME = ("motion", "initial", "limits", "units", "values")

#: Lists of coordinates, and of bodies, that a copy belongs to as the first does.
_LISTED = ("order", "reactions")

#: Keys under which a load says on what it acts; others only measure, or say in whose axes.
_ACTED_ON = ("body", "reaction on", "coordinate")


@dataclass(slots=True)
class _Copying:
    """Old names and new ones: of bodies, and of what stands in formulas; ``others`` are those of the other bodies."""

    written: Written
    bodies: dict[str, str] = field(default_factory=dict)
    symbols: dict[str, str] = field(default_factory=dict)
    others: set[str] = field(default_factory=set)
    #: What the branch hangs on.
    parent: str = "0"
    #: Speeds that the copy does without, and the bodies that have them.
    lost: set[str] = field(default_factory=set)
    slowed: set[int] = field(default_factory=set)
    #: What may name something, by section and item.
    places: dict[Path, list[Place]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for place in places(self.written):
            self.places.setdefault(place.path[:2], []).append(place)

    def turned(self, place: Place) -> str:
        text = place.node.text
        if place.role != "formula":
            return self.bodies.get(" ".join(text.split()), text)
        named = spins_renamed(text, self.bodies)
        return pattern(list(self.symbols)).sub(lambda match: self.symbols[match[1]], named) if self.symbols else named

    def names_own(self, place: Place) -> bool:
        return self.turned(place) != place.node.text

    def names_others(self, place: Place) -> bool:
        """Whether it names another body, or a coordinate of one; neither the fixed axes nor, as a body, the parent."""
        if place.role != "formula":
            name = " ".join(place.node.text.split())
            return name not in (*self.bodies, self.parent, "0", "ground")
        return bool(self.others and pattern(sorted(self.others)).search(place.node.text))

    def copy(self, path: Path) -> Data:
        """What stands at a path (a body, a load, an entry of a section), with the new names."""
        node = node_at(self.written.tree, path)
        assert node is not None
        data: Data = [data_of(node)]
        for place in sorted(
            self.places.get(path[:2], ()), key=lambda occurrence: (occurrence.is_key, -len(occurrence.path))
        ):
            inner = place.path[len(path) :]
            if place.path[: len(path)] != path or (place.is_key and not inner):
                continue
            turned = self.turned(place)
            if turned != place.node.text:
                at: Path = (0, *inner)
                data = applied_to(data, Rekey(at, turned) if place.is_key else Replace(at, turned))
        assert isinstance(data, list)
        return data[0]


def duplicate(document: Written, operation: Json) -> Meant:
    """The bodies of a branch again, behind it, under new names and with new coordinates, and what is theirs:

    loads on them (a spring between the branch and another body, too), constraints that tie nothing else (but the fixed
    axes and what the branch hangs on), their motion, initial state, limits, units, places in lists.  ``taken`` is what
    was copied so; ``left`` what names the branch and was not copied.
    """
    name = " ".join(word_of(operation, "body").split())
    first, tree = index_of(document, name), document.tree
    branch = branch_of(document, name)
    assert isinstance(tree, Mapping)
    copying = _names(document, tree, branch, bodies_of(document)[first][1])
    copies = {index: copying.copy(("bodies", index)) for index in branch}
    for index in copying.slowed:
        copies[index] = applied_to(copies[index], Remove(("speeds",)))
    root = copies[branch[0]]
    if isinstance(root, dict) and child(node_at(tree, ("bodies", branch[0])) or tree, "attached to") is None:
        # Only the first body need not say it.
        copies[branch[0]] = applied_to(root, Add(("attached to",), "0", after="name"))
    last, primitives = branch[-1] + 1, []
    for done, index in enumerate(branch):
        primitives.append(Add(("bodies", last + done), copies[index]))
    done_with = Meant([*primitives], select=("bodies", last))
    _with_items(copying, done_with, "loads", _load)
    _with_items(copying, done_with, "constraints", _constraint)
    _with_entries(copying, done_with)
    _left_over(copying, done_with)
    done_with.left += [("bodies", index, "speeds") for index in sorted(copying.slowed)]
    return done_with


# --- names ------------------------------------------------------------------------------------------------------------


def _names(document: Written, tree: Mapping, branch: list[int], parent: str) -> _Copying:
    bodies, taken = bodies_of(document), {body for body, _ in bodies_of(document)}
    words, copying = words_of(document), _Copying(document, parent=parent)
    every = [(own_names(document, tree, index), vectors(document, [index])) for index in range(len(bodies))]
    copying.lost, copying.slowed = _dependent_speeds(document, branch, [every[index][0] for index in branch])
    for names, turning in every:
        words |= {*names, *(component for vector in turning for component in _components(vector))}
    for index, (name, _) in enumerate(bodies):
        names, turning = every[index]
        if index not in branch:
            copying.others |= {*names, *(component for vector in turning for component in _components(vector))}
            continue
        copying.bodies[name] = free(name, taken.__contains__, " ")
        taken.add(copying.bodies[name])
        for own in names:
            if own in copying.lost:
                continue
            inner = own in turning  # a vector, with its components
            called = free(own, partial(_is_taken, words, inner), "")
            new = {own: called}
            if inner:
                new |= dict(zip(_components(own), _components(called), strict=True))
            copying.symbols |= new
            words |= set(new.values())
    return copying


def _dependent_speeds(document: Written, branch: list[int], names: list[list[str]]) -> tuple[set[str], set[int]]:
    """The speeds of a branch, and the bodies that have them, where there are more of them than coordinates: what the
    branch hangs on moves with them, so that those of a copy would follow from those of the first.  Else none.

    A branch with unit vectors keeps its speeds: they are what its vectors turn by.
    """
    speeds, having = set[str](), set[int]()
    for index in branch:
        body = node_at(document.tree, ("bodies", index))
        if body is None or child(body, "orientation") is not None:
            return set(), set()
        node = child(body, "speeds")
        if isinstance(node, Mapping) and node.entries:
            speeds |= {entry.key.text for entry in node.entries}
            having.add(index)
    coordinates = sum(name not in speeds for own in names for name in own)
    return (speeds, having) if len(speeds) > coordinates else (set(), set())


def _is_taken(words: set[str], inner: bool, name: str) -> bool:
    return not words.isdisjoint([name, *(_components(name) if inner else ())])


def _components(vector: str) -> list[str]:
    return [f"{vector}{k}" for k in range(4)]


def free(name: str, is_taken: Callable[[str], bool], between: str) -> str:
    stem = name.rstrip("0123456789").rstrip() or name
    return next(candidate for candidate in (f"{stem}{between}{k}" for k in range(2, 1000)) if not is_taken(candidate))


# --- loads and constraints --------------------------------------------------------------------------------------------


def _with_items(
    copying: _Copying, done: Meant, section: str, way: Callable[[_Copying, Path], tuple[Data | None, bool]]
) -> None:
    """Copies of items behind the last one: ``way`` answers the copy, or None, and whether something is left out."""
    nodes = node_at(copying.written.tree, (section,))
    count = len(nodes.items) if isinstance(nodes, Sequence) else 0
    added = 0
    for index in range(count):
        path: Path = (section, index)
        if not any(map(copying.names_own, copying.places.get(path, ()))):
            continue
        copy, in_part = way(copying, path)
        if copy is not None:
            done.primitives.append(Add((section, count + added), copy))
            done.taken.append(path)
            added += 1
        if copy is None or in_part:
            done.left.append(path)


def _load(copying: _Copying, path: Path) -> tuple[Data | None, bool]:
    node, here = node_at(copying.written.tree, path), copying.places.get(path, [])
    entry = node.entries[0] if isinstance(node, Mapping) and node.entries else None
    kind = "" if entry is None else ALIASES.get(entry.key.text, entry.key.text)
    if kind == "generalized force" and entry is not None:
        return _forces(copying, (*path, entry.key.text), entry.key.text)
    if kind == "newtonian gravity":  # acts on all bodies as it is
        return None, True
    if isinstance(node, Mapping) and entry is not None and isinstance(entry.value, Scalar):
        # A function of coordinates: its derivatives by those of other bodies are not to be counted twice.
        return (None, True) if any(map(copying.names_others, here)) else (copying.copy(path), False)
    acted = [place for place in here if place.path[-1] in _ACTED_ON]
    return (copying.copy(path), False) if any(map(copying.names_own, acted)) else (None, True)


def _forces(copying: _Copying, path: Path, kind: str) -> tuple[Data | None, bool]:
    """Of generalised forces those on the branch."""
    node = node_at(copying.written.tree, path)
    names = [entry.key.text for entry in node.entries] if isinstance(node, Mapping) else []
    own: dict[str, Data] = {
        copying.symbols[name]: copying.copy((*path, name)) for name in names if name in copying.symbols
    }
    rest = [
        place
        for place in copying.places.get(path[:2], ())
        if not place.is_key and place.path[-1] not in copying.symbols
    ]
    in_part = any(map(copying.names_own, rest))
    return ({kind: own} if own else None), in_part


def _constraint(copying: _Copying, path: Path) -> tuple[Data | None, bool]:
    if any(map(copying.names_others, copying.places.get(path, ()))):
        return None, True
    return copying.copy(path), False


# --- what is told of coordinates and bodies by name -------------------------------------------------------------------


def _with_entries(copying: _Copying, done: Meant) -> None:
    tree = copying.written.tree
    assert isinstance(tree, Mapping)
    tied = any(path[0] == "constraints" for path in done.taken)
    tied = tied and not any(path[0] == "constraints" for path in done.left)
    for entry in tree.entries:
        key, node = entry.key.text, entry.value
        section = ALIASES.get(key, key)
        if section in _BY_NAME and isinstance(node, Mapping):
            own = [inner_entry.key.text for inner_entry in node.entries if inner_entry.key.text in copying.symbols]
            after = own[-1] if own else None
            for name in own:
                new = copying.symbols[name]
                done.primitives.append(Add((key, new), copying.copy((key, name)), after=after))
                done.taken.append((key, name))
                after = new
        elif isinstance(node, Sequence) and (section in _LISTED or (section == "dependent" and tied)):
            _listed(copying, done, key, node)


def _listed(copying: _Copying, done: Meant, key: str, node: Sequence) -> None:
    added = 0
    for index in range(len(node.items)):
        if any(map(copying.names_own, copying.places.get((key, index), ()))):
            done.primitives.append(Add((key, len(node.items) + added), copying.copy((key, index))))
            done.taken.append((key, index))
            added += 1


def _left_over(copying: _Copying, done: Meant) -> None:
    """Claims, outputs, notation and the rest are about what was there before."""
    handled = {*done.taken, *done.left}
    for unit, here in copying.places.items():
        if unit[0] != "bodies" and unit not in handled and any(map(copying.names_own, here)):
            done.left.append(unit)
