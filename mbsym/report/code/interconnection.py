"""The structure of interconnection of the bodies, laid out as a tree: places, joints and loads between bodies.

This is a value without words or drawing: ``report.tex`` makes a TikZ picture of it, ``report.html`` an SVG.  The root
is the inertial frame, row 0; what is attached to a body stands one row below it, side by side in the order of the
description, and a body stands above the middle of what it carries.

A tree that is too deep or too wide for a page is cut into strips.  A strip begins with a body that was drawn before, as
a node marked ``repeated``, and goes on from there; so no line is long and none cross.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import ceil

from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.model.system import INERTIAL, System

#: A page holds so many rows and columns of nodes.
MOST_ROWS, MOST_COLUMNS = 12, 12


class Kind(StrEnum):
    INERTIAL = "inertial frame"
    #: Neither mass nor inertia.
    FRAME = "massless frame"
    BODY = "body"


@dataclass(frozen=True)
class Node:
    """Body ``number`` (0: the inertial frame) at (``column``, ``row``), in units of the distance of neighbours.

    Columns count to the right from 0, rows downwards from 0.  ``repeated``: it was drawn before, and its strip goes on
    from here.
    """

    number: int
    name: str
    kind: Kind
    column: float
    row: int
    repeated: bool = False


@dataclass(frozen=True)
class Joint:
    """The line between two nodes (indices into ``Interconnection.nodes``): body ``after`` is attached to ``before``.

    ``turns``: (axis, angle) in the order of turning; ``coordinates`` are those that the joint introduces; ``slides``:
    the connection point moves in the axes of ``before``.
    """

    before: int
    after: int
    turns: tuple[tuple[int, Expression], ...]
    coordinates: tuple[str, ...]
    slides: bool

    @property
    def others(self) -> tuple[str, ...]:
        """The coordinates that no angle holds."""
        turning = {name for _, angle in self.turns for name in names(angle)}
        return tuple(name for name in self.coordinates if name not in turning)


@dataclass(frozen=True)
class Interaction:
    """A load between two bodies (indices of nodes): ``kind`` is its key in a description."""

    first: int
    second: int
    kind: str


@dataclass(frozen=True)
class Interconnection:
    """``columns`` and ``rows``: the size of the whole, all nodes lie in [0, columns - 1] x [0, rows - 1]."""

    nodes: tuple[Node, ...]
    joints: tuple[Joint, ...]
    interactions: tuple[Interaction, ...]
    columns: float
    rows: int


@dataclass(frozen=True)
class _Strip:
    """A tree that is drawn in one piece: ``children`` of each of its bodies that are in it, too."""

    root: int
    children: dict[int, list[int]]


def interconnection(system: System, most_rows: int = MOST_ROWS, most_columns: int = MOST_COLUMNS) -> Interconnection:
    """The bodies of a system in strips of at most ``most_rows`` rows and ``most_columns`` columns of nodes."""
    numbers = {INERTIAL: 0} | {body.name: k for k, body in enumerate(system.bodies, start=1)}
    parents = [0] + [numbers[body.attached_to] for body in system.bodies]
    nodes: list[Node] = []
    lines: list[tuple[int, int]] = []
    left, top, shelf, widest = 0.0, 0, 0, 0.0
    for strip in _strips(parents, most_rows, most_columns):
        places = _places(strip)
        width, height = max(x for x, _ in places.values()) + 1, max(y for _, y in places.values()) + 1
        if left and left + width > most_columns:
            left, top, shelf = 0.0, top + shelf, 0
        index = {}
        for number, (column, row) in places.items():
            repeated = number == strip.root and number > 0 and bool(nodes)
            index[number] = len(nodes)
            nodes.append(_node(system, number, left + column, top + row, repeated or (number == 0 and bool(nodes))))
        lines += [(index[parent], index[child]) for parent, below in strip.children.items() for child in below]
        left, shelf = left + width, max(shelf, height)
        widest = max(widest, left)
    first = {node.number: k for k, node in reversed(list(enumerate(nodes)))}
    joints = tuple(_joint(system, nodes, before, after) for before, after in lines)
    between = tuple(
        Interaction(first[numbers[a]], first[numbers[b]], kind)
        for a, b, kind in (load.link for load in system.loads if load.link is not None)
        if a != b
    )
    return Interconnection(tuple(nodes), joints, between, widest, top + shelf)


def _node(system: System, number: int, column: float, row: int, repeated: bool) -> Node:
    if number == 0:
        return Node(0, INERTIAL, Kind.INERTIAL, column, row, repeated)
    body = system.bodies[number - 1]
    kind = Kind.FRAME if body.mass == ZERO and body.inertia is None else Kind.BODY
    return Node(number, body.name, kind, column, row, repeated)


def _joint(system: System, nodes: Sequence[Node], before: int, after: int) -> Joint:
    body = system.bodies[nodes[after].number - 1]
    moving = set(system.coordinates) | {item.name for item in system.prescribed} | {"t"}
    slides = any(names(component) & moving for component in body.connection_point)
    return Joint(before, after, tuple(body.rotation.turns()), body.coordinates, slides)


# --- strips -----------------------------------------------------------------------------------------------------------


def _strips(parents: Sequence[int], most_rows: int, most_columns: int) -> list[_Strip]:
    """The tree in pieces, from its root on; bodies come after those that carry them."""
    count = len(parents)
    depth = [0] * count
    for k in range(1, count):
        depth[k] = depth[parents[k]] + 1
    # Rows below the first of a strip: as many for each as there must be, so that the last one is no stump.
    pieces = max(1, ceil(max(depth) / (most_rows - 1)))
    rows = max(1, ceil(max(depth) / pieces))
    children: list[list[int]] = [[] for _ in range(count)]
    for k in range(1, count):
        children[parents[k]].append(k)
    width = [1] * count
    # What is cut off from body k: groups of its children, each with k repeated above it.
    kept: list[list[int]] = [[] for _ in range(count)]
    cut: list[list[list[int]]] = [[] for _ in range(count)]
    for k in reversed(range(count)):
        groups = _groups(children[k], width, most_columns)
        if k and depth[k] % rows == 0:
            kept[k], cut[k] = [], groups
        else:
            kept[k], cut[k] = (groups[0], groups[1:]) if groups else ([], [])
        width[k] = max(1, sum(width[child] for child in kept[k]))
    strips = []
    waiting = [(0, kept[0])]
    waiting += [(0, group) for group in cut[0]]
    for root, first in waiting:
        strip = _Strip(root, {})
        strips.append(strip)
        inside = [(root, first)]
        for k, below in inside:
            strip.children[k] = list(below)
            inside += [(child, kept[child]) for child in below]
        members = sorted(k for k, _ in inside[1:])
        waiting += [(k, group) for k in members for group in cut[k]]
    return strips


def _groups(children: Sequence[int], width: Sequence[int], most: int) -> list[list[int]]:
    """Neighbours together, as far as they fit side by side."""
    groups: list[list[int]] = []
    room = 0
    for child in children:
        if width[child] > room:
            groups.append([])
            room = most
        groups[-1].append(child)
        room -= width[child]
    return groups


def _places(strip: _Strip) -> dict[int, tuple[float, int]]:
    """(column, row) in a strip: leaves side by side, a body above the middle of its first and last child."""
    rows = {strip.root: 0}
    order = [strip.root]
    for k in order:
        for child in strip.children[k]:
            rows[child] = rows[k] + 1
            order.append(child)
    columns: dict[int, float] = {}
    stack = [strip.root]
    leaves = 0
    while stack:  # leaves from left to right
        k = stack.pop()
        if not strip.children[k]:
            columns[k] = float(leaves)
            leaves += 1
        stack += reversed(strip.children[k])
    for k in reversed(order):
        if below := strip.children[k]:
            columns[k] = (columns[below[0]] + columns[below[-1]]) / 2
    return {k: (columns[k], rows[k]) for k in order}
