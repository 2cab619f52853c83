"""What a picture of a map shows, as a graph: areas of one look, the lines drawn between them, points where they meet.

Curves at which nothing changes are no part of it: regions on their two sides are one area where they look alike, and
lines are one where only such a curve crosses them.
"""

from __future__ import annotations

from mbsym.algebra.arrangements.arrangement import CornerKind
from mbsym.algebra.arrangements.likeness import Graph
from mbsym.maps.result import Cell, Joined, Map


def seen(found: Map) -> Graph:
    """Areas, lines and points with their looks; lines have edges to the areas beside them and to their end points."""
    there = found.arrangement
    areas, lines = Joined(len(there.regions)), Joined(len(there.arcs))
    shown = [found.drawn(arc) for arc in found.arcs]
    for arc, kept in zip(there.arcs, shown, strict=True):
        below, above = arc.regions
        if not kept and below is not None and above is not None:
            areas.join(below, above)
    told = [_line(found, arc) for arc in found.arcs]
    points: list[tuple[object, list[int]]] = []
    for corner, cell in zip(there.corners, found.corners, strict=True):
        ends = [k for k in corner.arcs if shown[k] for end in there.arcs[k].corners if end == corner.id]
        differs = stands_out(found, cell)
        plain = not differs and corner.kind is not CornerKind.SINGULAR
        if plain and len(ends) == 2 and told[ends[0]] == told[ends[1]]:
            lines.join(*ends)
        elif ends or differs:
            points.append((("point", corner.kind is CornerKind.EDGE, found.look(cell) if differs else None), ends))
    return _graph(found, areas, lines, [k for k, kept in enumerate(shown) if kept], told, points)


def stands_out(found: Map, corner: Cell) -> bool:
    """Whether an isolated point has another verdict than the region around it."""
    if corner.judged is None or found.place(corner).kind is not CornerKind.ISOLATED:
        return False
    return any(x is not None and x.judged is not None and found.look(x) != found.look(corner)
               for x in found.around(corner))  # fmt: skip


def _line(found: Map, arc: Cell) -> object:
    """How an arc is drawn."""
    alone = not found.separates(arc)
    return found.place(arc).factors, found.look(arc) if alone else None


def _graph(
    found: Map,
    areas: Joined,
    lines: Joined,
    kept: list[int],
    told: list[object],
    points: list[tuple[object, list[int]]],
) -> Graph:
    labels: list[object] = []
    nodes: dict[tuple[str, int], int] = {}
    for k, cell in enumerate(found.regions):
        if areas(k) == k:
            nodes["area", k] = len(labels)
            labels.append(("area", found.look(cell)))
    beside: dict[int, set[int]] = {}
    for k in kept:
        if lines(k) not in beside:
            nodes["line", lines(k)] = len(labels)
            labels.append(("line", told[lines(k)]))
        sides = beside.setdefault(lines(k), set())
        sides |= {areas(x.number) for x in found.beside(found.arcs[k]) if x is not None}
    edges = [(nodes["line", k], nodes["area", r]) for k, sides in beside.items() for r in sorted(sides)]
    for label, ends in points:
        edges += [(nodes["line", lines(k)], len(labels)) for k in ends]
        labels.append(label)
    return Graph(tuple(labels), tuple(edges))
