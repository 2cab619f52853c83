"""Three variables: all values of the third at which the arrangement in the plane of the first two may change.

Surfaces f(x, y, z) = 0 are projected along y (discriminants, leading coefficients, resultants, the box's edges), what
that gives along x: between two neighbouring roots of the polynomials in z that are left, the arrangements in the box
are deformed into each other, and so no topology is missed (McCallum 1988).  f must not vanish identically over a point
(x, z) away from these roots: unless one of its coefficients in y is a number, all of them are projected, not the
leading one alone.

The same holds for the projection along x, then y.  So near a value that only one of the two lists nothing changes,
and what is left are the roots that they share: most of those at which a projection folds over itself are gone.  Values
may still be listed at which nothing visible happens.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra.arrangements.arrangement import Arrangement
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.algebra.plane.line import Line, decompose_line
from mbsym.algebra.plane.numbers import Number, Rational
from mbsym.algebra.plane.projection import Box, Budget, Polynomial, Progress, nothing
from mbsym.algebra.terms import coefficients_in

# Whether two arrangements correspond: a bijection of their regions, arcs and corners that keeps what they adjoin.
#
# Parts correspond only where the polynomials that vanish on them, the signs of regions, the kinds of corners and
# whatever else a caller holds against them are the same.  The order of arcs around a corner is not compared.
#
# Colours are refined by those of the neighbours until nothing is told apart any more (Weisfeiler & Lehman 1968); where
# several parts are left with one colour, one of them is matched with each of the other arrangement's in turn.  A
# bijection is believed when its edges have been compared, not before.


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
        neighbours: list[list[int]] = [[] for _ in self.labels]
        for a, b in self.edges:
            neighbours[a].append(b)
            neighbours[b].append(a)
        return tuple(map(tuple, neighbours))


def nothing_else(_: str, number: int) -> object:
    """Labels that tell nothing apart."""
    return None


def alike(first: Arrangement, second: Arrangement, labels: Labels = nothing_else, other: Labels = nothing_else) -> bool:
    """Whether the arrangements correspond, ``one`` and ``other`` being the labels of their parts."""
    return corresponding(graph_of(first, labels), graph_of(second, other))


def corresponding(first: Graph, second: Graph) -> bool:
    """Whether there is a bijection of nodes that keeps labels and edges.

    True is proved by a bijection; False may be said, too, where none was found in ``MOST_TRIALS`` trials.
    """
    if len(first.labels) != len(second.labels):
        return False
    numbers: dict[object, int] = {}
    colours = [[numbers.setdefault(label, len(numbers)) for label in graph.labels] for graph in (first, second)]
    return _match((first, second), colours, [MOST_TRIALS])


def graph_of(arrangement: Arrangement, label: Labels = nothing_else) -> Graph:
    """Regions, arcs and corners with their labels; edges go from arcs to what they adjoin."""
    regions, arcs = len(arrangement.regions), len(arrangement.arcs)
    labels: list[object] = [("region", region.signs, label("region", region.id)) for region in arrangement.regions]
    edges = []
    for arc in arrangement.arcs:
        missing = (sum(k is None for k in arc.regions), sum(k is None for k in arc.corners))
        labels.append(("arc", arc.factors, missing, label("arc", arc.id)))
        edges += [(regions + arc.id, k) for k in arc.regions if k is not None]
        edges += [(regions + arc.id, regions + arcs + k) for k in arc.corners if k is not None]
    labels += [
        ("corner", corner.kind.value, corner.branches, corner.factors, label("corner", corner.id))
        for corner in arrangement.corners
    ]
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


_X, _Y, _Z = range(3)


def levels_of(line: Line) -> list[tuple[Number, bool]]:
    """The zeros and samples of a line in their order, with whether each is a zero."""
    levels: list[tuple[Number, bool]] = []
    for at, interval in enumerate(line.intervals):
        if interval.ends[0] is not None and at == 0:
            levels.append((line.zeros[interval.ends[0]].number, True))
        levels.append((interval.sample, False))
        if interval.ends[1] is not None:
            levels.append((line.zeros[interval.ends[1]].number, True))
    return levels


def flattened(p: Polynomial, z: Any, plane: Any) -> Polynomial:
    """p(x, y, z) in the context ``plane`` of the first two variables; z is a number or a polynomial of that context."""
    x, y = plane.gens()[:2]
    return p.compose(x, y, z if isinstance(z, type(x)) else plane.constant(z), ctx=plane)


def critical_levels(
    factors: Sequence[Polynomial],
    box: Box,
    low: Rational,
    high: Rational,
    budget: Budget | None = None,
    progress: Progress = nothing,
) -> Line:
    """The values of z in [low, high] at which the arrangement in the box may change, as zeros on a line."""
    budget = budget or Budget()
    for p in factors:
        if p == 0:
            raise ValueError("a polynomial that is identically zero bounds nothing")
    line = fmpq_mpoly_ctx.get(("z",))
    z, zero = line.gens()[0], line.constant(0)
    projections = [p.compose(zero, zero, z, ctx=line) for p in _shared(factors, box, budget, progress)]
    decomposition = decompose_line(projections, low, high)
    if len(decomposition.zeros) > budget.abscissas:
        raise TooLargeError(
            "[[count]] values at which the picture may change", count=len(decomposition.zeros), limit=Limit.WORK
        )
    return decomposition


def _shared(factors: Sequence[Polynomial], box: Box, budget: Budget, progress: Progress) -> list[Polynomial]:
    """Irreducible polynomials in z that both orders of projection give; those of one where the other is too large."""
    turned = []
    for p in factors:
        x, y, z = p.context().gens()
        turned.append(p.compose(y, x, z, ctx=p.context()))
    tables: list[dict[str, Polynomial]] = []
    refused: TooLargeError | None = None
    for polynomials, there in ((factors, box), (turned, Box(box.y0, box.y1, box.x0, box.x1))):
        try:
            every = _irreducible(_levels(polynomials, there, budget, progress))
        except TooLargeError as failure:
            refused = failure
            continue
        tables.append({str(p / p.leading_coefficient()): p for p in every})
    if refused is not None and not tables:
        raise refused
    return [p for key, p in tables[0].items() if key in tables[-1]]


def _levels(factors: Sequence[Polynomial], box: Box, budget: Budget, progress: Progress) -> list[Polynomial]:
    """Polynomials in z alone: what is left of a projection along y, then x."""
    surfaces, rest = _parted(factors, _Y)
    flat = [*rest, *_projected(surfaces, _Y, (box.y0, box.y1), budget, progress)]
    curves, levels = _parted(flat, _X)
    return levels + _projected(curves, _X, (box.x0, box.x1), budget, progress)


def _irreducible(polynomials: Iterable[Polynomial]) -> list[Polynomial]:
    """The different irreducible factors."""
    factors: dict[str, Polynomial] = {}
    for p in polynomials:
        for factor, _ in irreducible_factors(p)[1]:
            if not factor.is_constant():
                factors.setdefault(str(factor), factor)
    return list(factors.values())


def _parted(polynomials: Iterable[Polynomial], generator: int) -> tuple[list[Polynomial], list[Polynomial]]:
    """Irreducible factors that hold a generator, and others."""
    every = _irreducible(polynomials)
    return [p for p in every if p.degrees()[generator]], [p for p in every if not p.degrees()[generator]]


def _projected(
    polynomials: Sequence[Polynomial],
    generator: int,
    edges: tuple[Rational, Rational],
    budget: Budget,
    progress: Progress,
) -> list[Polynomial]:
    """Discriminants, coefficients, resultants and values at the edges, none of them zero."""
    _affordable(polynomials, generator, budget)
    projections: list[Polynomial] = []
    pairs = list(combinations(polynomials, 2))
    for at, p in enumerate(polynomials):
        progress("projection", at, len(polynomials) + len(pairs))
        projections += _coefficients(p, generator)
        if p.degrees()[generator] > 1:
            projections.append(p.discriminant(generator))
        projections += [x for edge in edges if (x := _at(p, generator, edge)) != 0]
    for at, (p, q) in enumerate(pairs):
        progress("projection", len(polynomials) + at, len(polynomials) + len(pairs))
        projections.append(p.resultant(q, generator))
    return _irreducible(projections)


def _coefficients(p: Polynomial, generator: int) -> list[Polynomial]:
    """The leading coefficient, and all others where none is a number."""
    every = [c for c in reversed(coefficients_in(p, generator)) if c != 0]
    return every[:1] if any(c.is_constant() for c in every) else every


def _at(p: Polynomial, generator: int, value: Rational) -> Polynomial:
    context = p.context()
    places = [context.constant(value) if k == generator else context.gen(k) for k in range(context.nvars())]
    return p.compose(*places, ctx=context)


def _affordable(polynomials: Sequence[Polynomial], generator: int, budget: Budget) -> None:
    """Refuses resultants whose degree in one of the variables, bounded by those of the polynomials, is too large."""
    worst = 0
    for j, p in enumerate(polynomials):
        own = [int(d) for d in p.degrees()]
        for q in polynomials[j:]:
            other = [int(d) for d in q.degrees()]
            for k in range(3):
                if k != generator:
                    worst = max(worst, own[k] * other[generator] + other[k] * own[generator])
    if worst > budget.degree:
        raise TooLargeError(
            "a resultant of degree up to [[worst]], more than [[most]]",
            worst=worst,
            most=budget.degree,
            limit=Limit.DEGREE,
        )
