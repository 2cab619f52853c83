"""Relative equilibria over parameters: f(q, p) = 0 in one set of angles, the parameters p among the unknowns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from mbsym.algebra.characteristic import determinant
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.ring import Polynomial
from mbsym.mechanics.charts import Chart, charts
from mbsym.mechanics.rest import at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import WITHIN, _ChartSearch
from mbsym.problems.relative_equilibria.unknowns import Unknowns

#: The determinant of M is not formed for more coordinates.
MOST_COORDINATES = 6
#: Why something at the ends of the space is left open.
MASS_OPEN = "where the mass matrix is singular is not looked at"
INFINITY_OPEN = "whether branches go to infinity is not looked at: roots beside lengths"


class _Search(_ChartSearch):
    """The conditions of rest with parameters that are unknowns, too."""

    parameters: tuple[str, ...] = ()

    def _obstacle(self, used: set[int]) -> str:
        found = super()._obstacle(used - {self.ring.index("parameter", name) for name in self.parameters})
        if any(found == f"{name} is transcendental" for name in self.parameters):
            return f"{found.split()[0]} stands in a root or a function"
        return found


class Varied:
    """The equations of rest with unknown parameters.

    Raises NoClosedForm where they are not of the kind needed.  ``empty``: they have no solutions.
    """

    def __init__(self, chart: Chart, parameters: Sequence[str], limits: Limits) -> None:
        self.chart, self.limits, self.label = chart, limits, chart.label
        search = _Search(chart, WITHIN, limits)
        search.parameters = tuple(parameters)
        search._conditions()
        self.search, self.found, self.ring = search, chart.found, chart.found.ring
        self.unknown = [self.ring.context.gen(self.ring.index("parameter", name)) for name in parameters]
        self.empty = search.impossible
        self.names = () if self.empty else search.occurring
        if self.empty:
            return
        if search.reason:
            raise NoClosedForm(search.reason)
        others = [x for name, x in self._rows.items() if name not in self.names and not x.is_zero()]
        if others or search.remarks:
            raise NoClosedForm("the equations at rest are more than their unknowns, or vary in time")

    @cached_property
    def _rows(self) -> dict[str, Polynomial]:
        found = self.found
        return {name: self.ring.fraction(x)[0] for name, x in zip(found.system.coordinates, found.at_rest, strict=True)}

    @cached_property
    def forcing(self) -> list[Polynomial]:
        """f, times what its rows divide by, for the coordinates that occur: the rows vanish with those of f."""
        return [self._rows[name] for name in self.names]

    @cached_property
    def slopes(self) -> list[list[Polynomial]]:
        """df/dq of ``forcing``."""
        return [[self.ring.derivative(x, name) for name in self.names] for x in self.forcing]

    @cached_property
    def singular(self) -> Polynomial:
        """det df/dq."""
        return self.ring.reduce(determinant(self.slopes)) if self.names else self.ring.one

    def table(self, given: Sequence[Polynomial] = ()) -> Unknowns:
        """The unknowns of the equations and of further polynomials."""
        return Unknowns(self.ring, [*self.search.equations, *given, *self.search.singular_where, *self.unknown])

    # --- where solutions leave ---

    def undefined(self) -> list[Polynomial]:
        """What vanishes where a denominator or a square root does, but for singular angles."""
        angular = {str(x) for x in self.search.singular_where}
        beside = [x for x in self.search.nonzero if str(x) not in angular]
        used = occurring(self.search.equations)
        return [*beside, *(self.ring.context.gen(k) for k in used if self.ring.generators[k].kind == "root")]

    @cached_property
    def mass(self) -> Polynomial | None:
        """det M; None of more than ``MOST_COORDINATES``."""
        matrix = self.found.mass_matrix()
        return None if len(matrix) > MOST_COORDINATES else self.ring.reduce(determinant(matrix))

    def at_infinity(self) -> Iterator[tuple[Unknowns, list[Any]] | None]:
        """For each length the equations of what goes to infinity, none faster; None where that is not looked at.

        Lengths are z/u with one z_j = 1; at u = 0 the forms of highest degree in z are left of the equations.
        """
        ring = self.ring
        lengths = [name for name in self.names if not self.search._periodic(name)]
        if not lengths:
            return
        kinds = {ring.generators[k].kind for k in occurring(self.search.equations)}
        if kinds - {"sine", "cosine", "coordinate", "parameter"}:
            yield None
            return
        table = Unknowns(ring, [*self.search.equations, *self.unknown])
        equations = [table.polynomial(x) for x in self.search.equations] + table.relations()
        places = [table.indices.index(ring.index("coordinate", name)) for name in lengths]
        for at in places:
            tops = []
            for x in equations:
                degree = max(sum(int(m[i]) for i in places) for m in x.monoms())
                kept = {m: c for m, c in x.terms() if sum(int(m[i]) for i in places) == degree}
                tops.append(table.context.from_dict(kept))
            yield table, [*tops, table.context.gens()[at] - 1]


def charts_over(system: System, parameters: Sequence[str], values: Mapping[str, Fraction]) -> list[Chart]:
    """The sets of angles of a system with numbers for all parameters but these.

    Raises KeyError for a missing number, NoClosedForm, SingularPoint.
    """
    kept = tuple(replace(one, value=None) for one in system.parameters if one.name in parameters)
    numbers = {key: value for key, value in values.items() if key not in parameters}
    return list(charts(rest(replace(at_numbers(system, numbers), parameters=kept))))
