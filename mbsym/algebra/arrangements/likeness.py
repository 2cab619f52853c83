"""Whether two arrangements correspond: a bijection of their regions, arcs and corners that keeps what they adjoin.

Parts correspond only where the polynomials that vanish on them, the signs of regions, the kinds of corners and whatever
else a caller holds against them are the same.  The order of arcs around a corner is not compared.

Colours are refined by those of the neighbours until nothing is told apart any more (Weisfeiler & Lehman 1968); where
several parts are left with one colour, one of them is matched with each of the other arrangement's in turn.  A
bijection is believed when its edges have been compared, not before.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from mbsym.algebra.arrangements.arrangement import Arrangement

#: What else has to be the same of two parts: of regions, arcs and corners, by their numbers.
Labels = Callable[[str, int], object]

#: So many times colours are refined; graphs that are not told apart nor matched by then are said to differ.
MOST_TRIALS = 200


@dataclass(frozen=True)
class Graph:
    """Nodes with ``labels``, ``edges`` between them by number, as often as they are there."""

    labels: tuple[object, ...]
    edges: tuple[tuple[int, int], ...]

    @cached_property
    def beside(self) -> tuple[tuple[int, ...], ...]:
        """The neighbours of each node."""
        found: list[list[int]] = [[] for _ in self.labels]
        for a, b in self.edges:
            found[a].append(b)
            found[b].append(a)
        return tuple(map(tuple, found))


def nothing_else(_: str, number: int) -> object:
    """Labels that tell nothing apart."""
    return None


def alike(first: Arrangement, second: Arrangement, one: Labels = nothing_else, other: Labels = nothing_else) -> bool:
    """Whether the arrangements correspond, ``one`` and ``other`` being the labels of their parts."""
    return corresponding(graph_of(first, one), graph_of(second, other))


def corresponding(first: Graph, second: Graph) -> bool:
    """Whether there is a bijection of nodes that keeps labels and edges.

    True is proved by a bijection; False may be said, too, where none was found in ``MOST_TRIALS`` trials.
    """
    if len(first.labels) != len(second.labels):
        return False
    numbers: dict[object, int] = {}
    colours = [[numbers.setdefault(label, len(numbers)) for label in graph.labels] for graph in (first, second)]
    return _match((first, second), colours, [MOST_TRIALS])


def graph_of(found: Arrangement, label: Labels = nothing_else) -> Graph:
    """Regions, arcs and corners with their labels; edges go from arcs to what they adjoin."""
    regions, arcs = len(found.regions), len(found.arcs)
    labels: list[object] = [("region", one.signs, label("region", one.id)) for one in found.regions]
    edges = []
    for arc in found.arcs:
        missing = (sum(k is None for k in arc.regions), sum(k is None for k in arc.corners))
        labels.append(("arc", arc.factors, missing, label("arc", arc.id)))
        edges += [(regions + arc.id, k) for k in arc.regions if k is not None]
        edges += [(regions + arc.id, regions + arcs + k) for k in arc.corners if k is not None]
    labels += [("corner", one.kind.value, one.branches, one.factors, label("corner", one.id)) for one in found.corners]
    return Graph(tuple(labels), tuple(edges))


def _match(graphs: Sequence[Graph], colours: list[list[int]], left: list[int]) -> bool:
    """Whether a bijection keeps the colours and the edges."""
    left[0] -= 1
    if left[0] < 0:
        return False
    colours = _refined(graphs, colours)
    counts = [Counter(x) for x in colours]
    if counts[0] != counts[1]:
        return False
    several = [colour for colour, count in counts[0].items() if count > 1]
    if not several:
        return _keeps_edges(graphs, colours)
    colour = min(several, key=lambda c: (counts[0][c], c))
    new = 1 + max(counts[0])
    at = colours[0].index(colour)
    mine = [new if k == at else c for k, c in enumerate(colours[0])]
    for candidate, c in enumerate(colours[1]):
        if c == colour:
            theirs = [new if k == candidate else x for k, x in enumerate(colours[1])]
            if _match(graphs, [mine, theirs], left):
                return True
    return False


def _refined(graphs: Sequence[Graph], colours: list[list[int]]) -> list[list[int]]:
    count = len(set(colours[0]) | set(colours[1]))
    while True:
        numbers: dict[object, int] = {}
        colours = [
            [
                numbers.setdefault((c, tuple(sorted(own[j] for j in graph.beside[k]))), len(numbers))
                for k, c in enumerate(own)
            ]
            for graph, own in zip(graphs, colours, strict=True)
        ]
        if len(numbers) == count:
            return colours
        count = len(numbers)


def _keeps_edges(graphs: Sequence[Graph], colours: Sequence[Sequence[int]]) -> bool:
    """Whether the bijection of equal colours, all different, is one of edges, too."""
    tables = [
        {c: Counter(own[j] for j in graph.beside[k]) for k, c in enumerate(own)}
        for graph, own in zip(graphs, colours, strict=True)
    ]
    return tables[0] == tables[1]
