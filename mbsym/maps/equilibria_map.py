"""How many relative equilibria there are over a plane of two parameters, and how many of them are stable.

The curves on which the number may change are eliminated exactly (``equilibria_projection``): where an equilibrium is
singular, at infinity or at a border.  In each region between them the number is one and the same; it is that of the
exact list (``problems.equilibria``) at a rational point.  At a second point of each region they are listed once more,
and looked for by another route: Newton's method from many starting points, each solution proved to exist in a box.
Another number in the list, or more solutions than listed, and what is said of the region is withdrawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random
from typing import Any

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arrangement, areas, decompose
from mbsym.algebra.arrangements.arrangement import Region
from mbsym.algebra.arrangements.drawing import Branches as Drawn
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.plane import Point
from mbsym.algebra.polynomial_systems import Limits
from mbsym.maps.boundaries import Boundaries, Condition, Origin, factored
from mbsym.maps.branches_stability import BY_INERTIA, is_undamped
from mbsym.maps.equilibria_projection import Projected, Surface, surfaces
from mbsym.maps.mapping import Watch, box_of, places
from mbsym.maps.result import Cell, Counted, Lack, Map, Of, Shape
from mbsym.maps.section import Axis
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import equilibria

#: So many random points are tried until one lies in a region.
TRIED = 60
#: Newton's method alone: nothing is solved exactly.
_NOT_EXACTLY = Limits(branches=0)


@dataclass(frozen=True, kw_only=True)
class EquilibriaMap(Map):
    """``unfinished``: why curves may be missing (then nothing is proved between samples)."""

    unfinished: tuple[str, ...]


def equilibria_map(
    system: System, axes: tuple[Axis, Axis], values: Mapping[str, Fraction], watch: Watch
) -> EquilibriaMap:
    """The map over two parameters; ``values``: the numbers of the others.

    Raises KeyError for a missing number, NoClosedForm where equations are not polynomial, TooLargeError where the
    arrangement is beyond its budget.  KeyboardInterrupt while regions are solved ends the work.
    """
    refuse_constraints(system, "relative equilibria")
    watch("curves", 0, 1)
    names = axes[0].name, axes[1].name
    limits = Limits()
    parts = surfaces(system, names, values, limits)
    found, unfinished = _curves(parts)
    made = decompose(found.factors, box_of(axes), progress=watch)
    undamped = all(is_undamped(one.search) for one in parts)
    source = Random(20261123)
    drawn = Drawn(made)
    cells: list[Cell] = []
    interrupted = False
    for k, region in enumerate(made.regions):
        try:
            watch("regions", k, len(made.regions))
            if not interrupted:
                cells.append(_cell(system, names, values, made, drawn, region, bool(unfinished), undamped, source))
                continue
        except KeyboardInterrupt:
            interrupted = True
        cells.append(Cell(Shape.REGION, region.id, Point(*region.sample), lack=Lack.NOT_REACHED))
    others = [Cell(*place, lack=Lack.UNCOUNTED) for place in places(made)]
    arcs, corners = (tuple(x for x in others if x.shape is shape) for shape in (Shape.ARC, Shape.CORNER))
    related = {item.name for item in system.relations}
    given = {name: x for name, x in values.items() if name not in names and name not in related}
    return EquilibriaMap(
        Of.EQUILIBRIA, axes, given, made, found, tuple(cells), arcs, corners, areas(made),
        interrupted=interrupted, unfinished=unfinished,
    )  # fmt: skip


def _curves(parts: Sequence[Surface]) -> tuple[Boundaries, tuple[str, ...]]:
    """Irreducible polynomials, each once, with where they come from; why some may be missing."""
    found: list[tuple[Origin, Projected]] = []
    for part in parts:
        found.append((Origin.SINGULAR, part.over([part.singular])))
        found += [(Origin.LEAVING, one) for one in part.leaving()]
    unfinished: list[str] = []
    for origin, projected in found:
        unfinished += projected.unfinished
        if projected.everywhere:
            told = "equilibria are singular" if origin is Origin.SINGULAR else "solutions leave"
            unfinished.append(f"{told} over a whole region, or that is not excluded")
    conditions = [Condition(origin, p) for origin, projected in found for p in projected.polynomials]
    return factored(conditions), tuple(dict.fromkeys(unfinished))


def _cell(
    system: System,
    names: tuple[str, str],
    values: Mapping[str, Fraction],
    made: Arrangement,
    drawn: Drawn,
    region: Region,
    doubtful: bool,
    undamped: bool,
    source: Random,
) -> Cell:
    sample = _fractions(region.sample)
    if 0 in sample:  # a parameter that vanishes may make the equations others
        sample = inside(made, drawn, region, source) or sample
    place = Shape.REGION, region.id, Point(*(rationals.exact(x) for x in sample))
    try:
        found = equilibria(system, {**values, names[0]: sample[0], names[1]: sample[1]})
    except Failure:
        return Cell(*place, lack=Lack.INCOMPLETE)
    if found.families:
        return Cell(*place, lack=Lack.FAMILIES)
    if not found.complete:
        return Cell(*place, Counted(found.equilibria), lack=Lack.INCOMPLETE)
    surely = Certainty.UNDECIDED if doubtful else Certainty.PROVED
    throughout = (
        not doubtful
        and undamped
        and all(one.verdict.theorem in BY_INERTIA for one in found.equilibria if one.verdict.stable)
    )
    other = inside(made, drawn, region, source)
    if other is None:
        return Cell(*place, Counted(found.equilibria, throughout), surely)
    there = {**values, names[0]: other[0], names[1]: other[1]}
    again = equilibria(system, there)
    confirmed = many_starts(system, there)
    wrong = confirmed > len(again.equilibria) or (
        not doubtful and again.complete and len(again.equilibria) != len(found.equilibria)
    )
    if wrong:
        return Cell(*place, Counted(found.equilibria, False, confirmed), lack=Lack.WITHDRAWN)
    return Cell(*place, Counted(found.equilibria, throughout, confirmed), surely)


def many_starts(system: System, values: Mapping[str, Fraction]) -> int:
    """How many equilibria Newton's method finds from many starting points, each proved in a box of its own."""
    found = equilibria(system, values, limits=_NOT_EXACTLY)
    return len(found.equilibria)


def inside(made: Arrangement, drawn: Drawn, region: Region, source: Random) -> tuple[Fraction, Fraction] | None:
    """A random rational point without zeros in a region, proved to lie there; None where none is hit."""
    for _ in range(TRIED):
        strip, cell = region.cells[source.randrange(len(region.cells))]
        x, ys = drawn.at(strip, source.uniform(0.2, 0.8) * math.pi)
        y = ys[cell] + source.uniform(0.2, 0.8) * (ys[cell + 1] - ys[cell])
        point = tuple(Fraction(z).limit_denominator(10_000) for z in (x, y))
        if 0 in point:
            continue
        try:
            place = made.locate(*(rationals.exact(z) for z in point))
        except ValueError:
            continue
        if isinstance(place, Region) and place.id == region.id:
            return point[0], point[1]
    return None


def _fractions(point: Sequence[Any]) -> tuple[Fraction, Fraction]:
    x, y = (rationals.fraction(z) for z in point)
    return x, y
