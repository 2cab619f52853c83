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
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.arrangements import Arrangement, areas, decompose
from mbsym.algebra.arrangements.arrangement import Branches as Drawn
from mbsym.algebra.arrangements.arrangement import Region
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.plane import Point
from mbsym.algebra.polynomial_systems import Limits, _Branch, _moved, _Solver
from mbsym.algebra.ring import Polynomial
from mbsym.maps.boundaries import Boundaries, Condition, Origin, factored
from mbsym.maps.branches_curve import INFINITY_OPEN, MASS_OPEN, Varied, searches_over
from mbsym.maps.branches_events import BY_INERTIA, is_undamped
from mbsym.maps.mapping import Watch, box_of, places
from mbsym.maps.result import Cell, Counted, Lack, Map, Of, Shape
from mbsym.maps.section import Axis
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import _ChartSearch, equilibria
from mbsym.problems.relative_equilibria.place import Unknowns

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
    boundaries, unfinished = _curves(parts)
    made = decompose(boundaries.factors, box_of(axes), progress=watch)
    undamped = all(is_undamped(part.search) for part in parts)
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
    fixed_values = {name: x for name, x in values.items() if name not in names and name not in related}
    return EquilibriaMap(
        Of.EQUILIBRIA, axes, fixed_values, made, boundaries, tuple(cells), arcs, corners, areas(made),
        interrupted=interrupted, unfinished=unfinished,
    )  # fmt: skip


def _curves(parts: Sequence[Surface]) -> tuple[Boundaries, tuple[str, ...]]:
    """Irreducible polynomials, each once, with where they come from; why some may be missing."""
    projections: list[tuple[Origin, Projected]] = []
    for part in parts:
        projections.append((Origin.SINGULAR, part.over([part.singular])))
        projections += [(Origin.LEAVING, border) for border in part.leaving()]
    unfinished: list[str] = []
    for origin, projected in projections:
        unfinished += projected.unfinished
        if projected.everywhere:
            cause = "equilibria are singular" if origin is Origin.SINGULAR else "solutions leave"
            unfinished.append(f"{cause} over a whole region, or that is not excluded")
    conditions = [Condition(origin, p) for origin, projected in projections for p in projected.polynomials]
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
        sampled = equilibria(system, {**values, names[0]: sample[0], names[1]: sample[1]})
    except Failure:
        return Cell(*place, lack=Lack.INCOMPLETE)
    if sampled.families:
        return Cell(*place, lack=Lack.FAMILIES)
    if not sampled.complete:
        return Cell(*place, Counted(sampled.equilibria), lack=Lack.INCOMPLETE)
    surely = Certainty.UNDECIDED if doubtful else Certainty.PROVED
    throughout = (
        not doubtful
        and undamped
        and all(state.verdict.theorem in BY_INERTIA for state in sampled.equilibria if state.verdict.stable)
    )
    other = inside(made, drawn, region, source)
    if other is None:
        return Cell(*place, Counted(sampled.equilibria, throughout), surely)
    there = {**values, names[0]: other[0], names[1]: other[1]}
    again = equilibria(system, there)
    confirmed = many_starts(system, there)
    wrong = confirmed > len(again.equilibria) or (
        not doubtful and again.complete and len(again.equilibria) != len(sampled.equilibria)
    )
    if wrong:
        return Cell(*place, Counted(sampled.equilibria, False, confirmed), lack=Lack.WITHDRAWN)
    return Cell(*place, Counted(sampled.equilibria, throughout, confirmed), surely)


def many_starts(system: System, values: Mapping[str, Fraction]) -> int:
    """How many equilibria Newton's method finds from many starting points, each proved in a box of its own."""
    sampled = equilibria(system, values, limits=_NOT_EXACTLY)
    return len(sampled.equilibria)


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


# Curves in a plane of two parameters over which equilibria are singular, or leave: unknowns eliminated exactly.
#
# A system in unknowns and two parameters is taken apart as for its solution (``algebra.polynomial_systems``), but
# nothing is solved: of every branch the polynomials in the parameters alone are sought in its ideal (lexicographic
# basis, with what does not vanish inverted where that is needed).  The real solutions lie over their zeros.  Branches
# of finitely many solutions lie over single points, which divide no open set.


@dataclass(frozen=True)
class Projected:
    """``polynomials`` in the two parameters; ``everywhere``: the equations have solutions over an open set.

    ``unfinished`` says what could not be eliminated, and why.
    """

    polynomials: tuple[Any, ...]
    everywhere: bool
    unfinished: tuple[str, ...]


class Surface(Varied):
    """Equilibria over two parameters, in one set of angles.  Raises NoClosedForm where equations are not polynomial."""

    def __init__(self, search: _ChartSearch) -> None:
        super().__init__(search)
        self.parameters = search.parameters
        self.plane = fmpq_mpoly_ctx.get(list(search.parameters), Ordering.lex)

    def over(self, further: Sequence[Polynomial], inside: bool = True) -> Projected:
        """The curves over which ``further`` vanish at equilibria; ``inside``: where nothing divides by zero."""
        numerators = [self.ring.fraction(x)[0] for x in further]
        table = self.table(numerators)
        equations = [table.polynomial(x) for x in (*self.search.equations, *numerators) if not x.is_zero()]
        nonzero = self.search.nonzero if inside else self.search.singular_where
        usable = [table.polynomial(x) for x in nonzero if table.holds(x)]
        return self._projected(table, [*equations, *table.relations()], usable)

    def _projected(self, table: Unknowns, equations: Sequence[Any], nonzero: Sequence[Any]) -> Projected:
        places = [table.indices.index(self.ring.index("parameter", name)) for name in self.parameters]
        if any(x.is_constant() and not x.is_zero() for x in equations):
            return Projected((), False, ())
        solver = _Eliminating(list(equations), list(nonzero), frozenset(table.bounded()), self.limits)
        solver.kept = places
        result = solver.run()
        terms = [{tuple(int(m[i]) for i in places): int(c) for m, c in x.terms()} for x in solver.projected]
        return Projected(tuple(map(self.plane.from_dict, terms)), solver.everywhere, result.unfinished)

    def leaving(self) -> list[Projected]:
        """Where a root or a denominator vanishes, or lengths go to infinity."""
        parts = [self.over([x], inside=False) for x in self.undefined()]
        if self.mass is None:
            parts.append(Projected((), False, (MASS_OPEN,)))
        elif not self.mass.is_constant():
            # all along a surface: other equilibria meet it where they are singular
            parts.append(replace(self.over([self.mass]), everywhere=False))
        for system in self.at_infinity():
            parts.append(Projected((), False, (INFINITY_OPEN,)) if system is None else self._projected(*system, ()))
        return parts


class _Eliminating(_Solver):
    """Takes a system apart, and keeps of every branch the polynomials in some unknowns alone."""

    kept: Sequence[int] = ()

    def __init__(self, *words: Any) -> None:
        super().__init__(*words)
        self.projected: list[Any] = []
        self.everywhere = False

    def _finite(self, basis: list[Any], standard: Any, branch: _Branch) -> None:
        """Single points divide no open set."""

    def _family(self, basis: list[Any], branch: _Branch) -> None:
        eliminants = self._alone(basis, ()) or self._alone(basis, branch.nonzero)
        if not eliminants:
            self.everywhere = True
        self.projected += eliminants[:1]

    def _alone(self, basis: Sequence[Any], nonzero: Sequence[Any]) -> list[Any]:
        """The elements of the ideal in the kept unknowns alone, short ones first."""
        known = [x for x in basis if self._is_alone(x)]
        if known:
            return sorted(known, key=len)
        order, where = self._with_last(self.kept)
        backs = self._saturated([_moved(x, order, where) for x in basis], nonzero, order, where)
        return sorted((x for x in backs if self._is_alone(x)), key=len)

    def _is_alone(self, x: Any) -> bool:
        return not x.is_constant() and all(d == 0 for k, d in enumerate(x.degrees()) if k not in self.kept)


def surfaces(
    system: System, parameters: tuple[str, str], values: Mapping[str, Fraction], limits: Limits
) -> tuple[Surface, ...]:
    """Equilibria over two parameters, in every set of angles that is needed.

    Raises KeyError for a missing number, NoClosedForm, SingularPoint.
    """
    tried = [Surface(search) for searches in searches_over(system, parameters, values, limits) for search in searches]
    if angles := [name for surface in tried for name in surface.in_angles]:
        raise NoClosedForm("[[name]] stands in a root or a function", name=angles[0])
    return tuple(surface for surface in tried if not surface.empty)
