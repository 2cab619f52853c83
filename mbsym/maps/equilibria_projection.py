"""Curves in a plane of two parameters over which equilibria are singular, or leave: unknowns eliminated exactly.

A system in unknowns and two parameters is taken apart as for its solution (``algebra.polynomial_systems``), but nothing
is solved: of every branch the polynomials in the parameters alone are sought in its ideal (lexicographic
basis, with what does not vanish inverted where that is needed).  The real solutions lie over their zeros.  Branches of
finitely many solutions lie over single points, which divide no open set.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.characteristic import determinant
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.generators import occurring
from mbsym.algebra.polynomial_systems import Limits, _Branch, _moved, _moved_back, _Solver, context
from mbsym.algebra.ring import Polynomial
from mbsym.maps.branches_curve import MOST_COORDINATES
from mbsym.mechanics.charts import Chart, charts
from mbsym.mechanics.rest import at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import WITHIN, _ChartSearch
from mbsym.problems.relative_equilibria.unknowns import Unknowns


@dataclass(frozen=True)
class Projected:
    """``polynomials`` in the two parameters; ``everywhere``: the equations have solutions over an open set.

    ``unfinished`` says what could not be eliminated, and why.
    """

    polynomials: tuple[Any, ...]
    everywhere: bool
    unfinished: tuple[str, ...]


class _Search(_ChartSearch):
    """The conditions of rest with parameters that are unknowns, too."""

    parameters: tuple[str, ...] = ()

    def _obstacle(self, used: set[int]) -> str:
        found = super()._obstacle(used - {self.ring.index("parameter", name) for name in self.parameters})
        if any(found == f"{name} is transcendental" for name in self.parameters):
            return f"{found.split()[0]} stands in a root or a function"
        return found


class Surface:
    """Equilibria over two parameters, in one set of angles.  Raises NoClosedForm where equations are not polynomial."""

    def __init__(self, chart: Chart, parameters: tuple[str, str], limits: Limits) -> None:
        self.chart, self.parameters, self.limits = chart, parameters, limits
        search = _Search(chart, WITHIN, limits)
        search.parameters = parameters
        search._conditions()
        self.search, self.ring = search, chart.found.ring
        self.empty = search.impossible
        self.names = () if self.empty else search.occurring
        self.plane = fmpq_mpoly_ctx.get(list(parameters), Ordering.lex)
        if self.empty:
            return
        if search.reason:
            raise NoClosedForm(search.reason)
        others = [x for name, x in self._rows.items() if name not in self.names and not x.is_zero()]
        if others or search.remarks:
            raise NoClosedForm("the equations at rest are more than their unknowns, or vary in time")

    @cached_property
    def _rows(self) -> dict[str, Polynomial]:
        found = self.chart.found
        return {name: self.ring.fraction(x)[0] for name, x in zip(found.system.coordinates, found.at_rest, strict=True)}

    @cached_property
    def singular(self) -> Polynomial:
        """det df/dq."""
        rows = [[self.ring.derivative(self._rows[name], other) for other in self.names] for name in self.names]
        return self.ring.reduce(determinant(rows)) if self.names else self.ring.one

    def over(self, further: Sequence[Polynomial], inside: bool = True) -> Projected:
        """The curves over which ``further`` vanish at equilibria; ``inside``: where nothing divides by zero."""
        gens = [self.ring.context.gen(self.ring.index("parameter", name)) for name in self.parameters]
        given = [self.ring.fraction(x)[0] for x in further]
        table = Unknowns(self.ring, [*self.search.equations, *given, *self.search.singular_where, *gens])
        equations = [table.polynomial(x) for x in (*self.search.equations, *given) if not x.is_zero()]
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
        ring = self.ring
        angular = {str(x) for x in self.search.singular_where}
        beside = [x for x in self.search.nonzero if str(x) not in angular]
        used = occurring(self.search.equations)
        roots = [ring.context.gen(k) for k in used if ring.generators[k].kind == "root"]
        found = [self.over([x], inside=False) for x in (*beside, *roots)]
        mass = self.chart.found.mass_matrix()
        if len(mass) > MOST_COORDINATES:
            found.append(Projected((), False, ("where the mass matrix is singular is not looked at",)))
        elif not (det := ring.reduce(determinant(mass))).is_constant():
            # all along a surface: other equilibria meet it where they are singular
            found.append(replace(self.over([det]), everywhere=False))
        lengths = [name for name in self.names if not self.search._periodic(name)]
        if not lengths:
            return found
        if {ring.generators[k].kind for k in used} - {"sine", "cosine", "coordinate", "parameter"}:
            told = "whether branches go to infinity is not looked at: roots beside lengths"
            return [*found, Projected((), False, (told,))]
        gens = [ring.context.gen(ring.index("parameter", name)) for name in self.parameters]
        table = Unknowns(ring, [*self.search.equations, *gens])
        equations = [table.polynomial(x) for x in self.search.equations] + table.relations()
        places = [table.indices.index(ring.index("coordinate", name)) for name in lengths]
        for at in places:
            tops = []
            for x in equations:
                degree = max(sum(int(m[i]) for i in places) for m in x.monoms())
                kept = {m: c for m, c in x.terms() if sum(int(m[i]) for i in places) == degree}
                tops.append(table.context.from_dict(kept))
            found.append(self._projected(table, [*tops, table.context.gens()[at] - 1], ()))
        return found


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
        found = self._alone(basis, ()) or self._alone(basis, branch.nonzero)
        if not found:
            self.everywhere = True
        self.projected += found[:1]

    def _alone(self, basis: Sequence[Any], nonzero: Sequence[Any]) -> list[Any]:
        """The elements of the ideal in the kept unknowns alone, short ones first."""
        known = [x for x in basis if self._is_alone(x)]
        if known:
            return sorted(known, key=len)
        order = [k for k in range(self.nvars) if k not in self.kept] + list(self.kept)
        names = self.context.names()
        lexicographic = context(["#inverse", *(names[k] for k in order)], lexicographic=True)
        generators = [_moved(x, order, lexicographic) for x in basis]
        if nonzero:
            inverse = lexicographic.gens()[0]
            for x in nonzero:
                inverse = inverse * _moved(x, order, lexicographic)
            generators.append(inverse - 1)
        found = self._bounded_basis(generators, lexicographic)
        backs = [_moved_back(x, order, self.context) for x in found if x.degrees()[0] <= 0]
        return sorted((x for x in backs if self._is_alone(x)), key=len)

    def _is_alone(self, x: Any) -> bool:
        return not x.is_constant() and all(d == 0 for k, d in enumerate(x.degrees()) if k not in self.kept)


def surfaces(
    system: System, parameters: tuple[str, str], values: Mapping[str, Fraction], limits: Limits
) -> tuple[Surface, ...]:
    """Equilibria over two parameters, in every set of angles that is needed.

    Raises KeyError for a missing number, NoClosedForm, SingularPoint.
    """
    kept = tuple(replace(one, value=None) for one in system.parameters if one.name in parameters)
    numbers = {key: value for key, value in values.items() if key not in parameters}
    found = []
    for chart in charts(rest(replace(at_numbers(system, numbers), parameters=kept))):
        one = Surface(chart, parameters, limits)
        if not one.empty:
            found.append(one)
    return tuple(found)
