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
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.polynomial_systems import Limits, _Branch, _moved, _moved_back, _Solver, context
from mbsym.algebra.ring import Polynomial
from mbsym.maps.varied import INFINITY_OPEN, MASS_OPEN, Varied, charts_over
from mbsym.mechanics.charts import Chart
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.unknowns import Unknowns


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

    def __init__(self, chart: Chart, parameters: tuple[str, str], limits: Limits) -> None:
        super().__init__(chart, parameters, limits)
        self.parameters, self.plane = parameters, fmpq_mpoly_ctx.get(list(parameters), Ordering.lex)

    def over(self, further: Sequence[Polynomial], inside: bool = True) -> Projected:
        """The curves over which ``further`` vanish at equilibria; ``inside``: where nothing divides by zero."""
        given = [self.ring.fraction(x)[0] for x in further]
        table = self.table(given)
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
        found = [self.over([x], inside=False) for x in self.undefined()]
        if self.mass is None:
            found.append(Projected((), False, (MASS_OPEN,)))
        elif not self.mass.is_constant():
            # all along a surface: other equilibria meet it where they are singular
            found.append(replace(self.over([self.mass]), everywhere=False))
        for one in self.at_infinity():
            found.append(Projected((), False, (INFINITY_OPEN,)) if one is None else self._projected(*one, ()))
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
    found = [Surface(chart, parameters, limits) for chart in charts_over(system, parameters, values)]
    return tuple(one for one in found if not one.empty)
