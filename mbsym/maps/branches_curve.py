"""The relative equilibria of a system over one parameter, as a curve: f(q, p) = 0 with the parameter p as an unknown.

In one set of angles (``mechanics.charts``) f is made of polynomials in sines, cosines, lengths and p.  Along the curve
the equilibria go on one by one, each a function of p, but for the places at which

    f(q, p) = 0,    det df/dq (q, p) = 0,

or at which an unknown goes to infinity, a square root to zero, or a denominator vanishes, or the constraints lose their
rank.  All of these are systems in (q, p) that are solved exactly (``algebra.polynomial_systems``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.characteristic import determinant
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.plane.numbers import Number, compare, number, primitive, roots_between
from mbsym.algebra.polynomial_systems import AlgebraicPoint, Family, Limits, minimal_polynomial, solve
from mbsym.algebra.ring import Polynomial
from mbsym.mechanics.charts import charts
from mbsym.mechanics.rest import at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.conditions import near
from mbsym.problems.relative_equilibria.equilibria import EXACT, _ChartSearch, searches_of
from mbsym.problems.relative_equilibria.place import PRECISION, Place, Unknowns
from mbsym.problems.relative_equilibria.verdict import VARIED

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.rows import Row

# Relative equilibria over parameters: f(q, p) = 0 in one set of angles, the parameters p among the unknowns.


#: The determinant of M is not formed for more coordinates.
MOST_COORDINATES = 6
#: The size of one interreduction under constraints: a few seconds of a four-bar.
REDUCTION = 400_000_000
#: Why something at the ends of the space is left open.
MASS_OPEN = "where the mass matrix is singular is not looked at"
INFINITY_OPEN = "whether branches go to infinity is not looked at: roots beside lengths"
INFINITY_UNDECIDED = "whether branches go to infinity is not decided"
CONTINUUM_OPEN = "whether infinitely many equilibria at one value are real"


class Varied:
    """The equations of rest with unknown parameters.

    Under constraints they are those of one case of their rank; near its positions  g = (L, phi) = 0  takes the place of
    f = 0, with the rows L of f in which the reactions are eliminated and the independent constraints phi.  Then dg/dq
    is singular where the stiffness on the displacements that are allowed is.

    Raises NoClosedForm where they are not of the kind needed.  ``empty``: they have no solutions.  ``regular``: the
    constraints have the rank that they have elsewhere.
    """

    def __init__(self, search: _ChartSearch) -> None:
        search._conditions()
        self.search, self.chart, self.limits = search, search.chart, search.limits
        self.rest, self.ring, self.label = self.chart.rest, self.chart.rest.ring, self.chart.label
        self.unknown = [self.ring.context.gen(self.ring.index("parameter", name)) for name in search.parameters]
        self.empty = search.impossible
        here, elsewhere = search.ranks
        self.regular = elsewhere is None or here == elsewhere
        #: Further constraints follow from those that are independent.
        self.redundant = here < len(self.rest.rows)
        if self.empty:
            self.names: tuple[str, ...] = ()
            return
        if search.reason:
            raise NoClosedForm(search.reason)
        used = [*search.equations, *self._rows]
        self.names = tuple(x for x in self.rest.constant if any(self.ring.depends_on(y, x) for y in used))
        many = self.regular and len([x for x in self._rows if not x.is_zero()]) > len(self.names)
        if many or search.remarks or search.doubts:
            raise NoClosedForm("the equations at rest are more than their unknowns, or vary in time")

    @cached_property
    def in_angles(self) -> tuple[str, ...]:
        """The parameters that stand in sines and cosines, which are unknowns beside them."""
        used = [self.ring.generators[k] for k in occurring(self.search.equations)]
        held = {g.name for g in used if g.kind in ("sine", "cosine")}
        return tuple(name for name in self.search.parameters if name in held)

    @cached_property
    def _independent(self) -> list[Row]:
        """The constraints that are independent near the case."""
        return [self.rest.rows[k] for k in near(self.rest, self.search.case)[1]]

    @cached_property
    def _rows(self) -> list[Polynomial]:
        left, _ = near(self.rest, self.search.case)
        held = [row.position for row in self._independent]
        if any(x is None for x in held):
            raise NoClosedForm(VARIED)
        return [self.ring.fraction(x)[0] for x in (*left, *held)]

    @cached_property
    def forcing(self) -> list[Polynomial]:
        """f, or g, times what its rows divide by, as many as unknowns: rows that vanish throughout are left out."""
        rows = sorted(self._rows, key=lambda x: x.is_zero())
        return rows[: len(self.names)]

    @cached_property
    def slopes(self) -> list[list[Polynomial]]:
        """df/dq of ``forcing``."""
        return [[self.ring.derivative(x, name) for name in self.names] for x in self.forcing]

    @cached_property
    def singular(self) -> Polynomial:
        """det df/dq."""
        return self.ring.reduce(determinant(self.slopes)) if self.names else self.ring.one

    def table(self, polynomials: Sequence[Polynomial] = ()) -> Unknowns:
        """The unknowns of the equations and of further polynomials."""
        return Unknowns(self.ring, [*self.search.equations, *polynomials, *self.search.singular_where, *self.unknown])

    # --- where solutions leave ---

    def undefined(self) -> list[Polynomial]:
        """What vanishes where a denominator or a square root does, but for singular angles."""
        angular = {str(x) for x in self.search.singular_where}
        beside = [x for x in self.search.nonzero[len(self.search.case.nonzero) :] if str(x) not in angular]
        used = occurring(self.search.equations)
        return [*beside, *(self.ring.context.gen(k) for k in used if self.ring.generators[k].kind == "root")]

    @cached_property
    def mass(self) -> Polynomial | None:
        """det M, and where that vanishes throughout det [[M, J^T], [J, 0]]; None of more than ``MOST_COORDINATES``."""
        matrix = self.rest.mass_matrix()
        if len(matrix) > MOST_COORDINATES:
            return None
        plain = self.ring.reduce(determinant(matrix))
        held = [row.partials for row in self._independent]
        if not plain.is_zero() or not held:
            return plain
        zeros = [self.ring.zero] * len(held)
        upper = [[*row, *(x[i] for x in held)] for i, row in enumerate(matrix)]
        return self.ring.reduce(determinant([*upper, *([*x, *zeros] for x in held)]))

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
                leading = {m: c for m, c in x.terms() if sum(int(m[i]) for i in places) == degree}
                tops.append(table.context.from_dict(leading))
            yield table, [*tops, table.context.gens()[at] - 1]


def searches_over(
    system: System, parameters: tuple[str, ...], values: Mapping[str, Fraction], limits: Limits, rank: int | None = None
) -> Iterator[list[_ChartSearch]]:
    """In each set of angles the cases of the rank of constraints, with numbers for all parameters but these.

    Raises KeyError for a missing number, NoClosedForm, SingularPoint.
    """
    free = tuple(replace(parameter, value=None) for parameter in system.parameters if parameter.name in parameters)
    numbers = {key: value for key, value in values.items() if key not in parameters}
    first = rest(replace(at_numbers(system, numbers), parameters=free))
    if first.rows and not limits.reduction:
        limits = replace(limits, reduction=REDUCTION)
    for chart in charts(first):
        yield list(searches_of(chart, limits, rank, parameters=parameters))


#: Values of coordinates (or of their sines and cosines) at which real points of a family are looked for.
_TRIED = (fmpq(3, 5), fmpq(-4, 5), fmpq(5, 13), fmpq(1, 10), fmpq(-1, 10), fmpq(0), fmpq(1))


@dataclass(frozen=True)
class CurvePoint:
    """A point (q, p) of the curve: ``place`` with p among its exact values, ``number`` is p itself.

    ``beyond``: a length of polar coordinates is negative there, and it is no state of the system meant.
    """

    place: Place
    number: Number
    features: tuple[Any, ...]
    curve: Curve
    beyond: bool = False

    def same(self, other: CurvePoint) -> bool:
        """Whether they are one configuration at one p: balls of features that are equal overlap."""
        return (
            len(self.features) == len(other.features)
            and compare(self.number, other.number) == 0
            and all(a.overlaps(b) for a, b in zip(self.features, other.features, strict=True))
        )


@dataclass(frozen=True)
class CurvePoints:
    """Isolated points with p in the range, numbers p over which there are infinitely many, and what was not done.

    ``throughout``: there are infinitely many on a set along which p varies.
    """

    points: tuple[CurvePoint, ...]
    continua: tuple[Number, ...]
    throughout: bool
    unfinished: tuple[str, ...]


class Curve(Varied):
    """The curve in one set of angles.  Raises NoClosedForm where the equations are not of the kind needed."""

    def __init__(self, search: _ChartSearch, low: Fraction, high: Fraction) -> None:
        super().__init__(search)
        (self.parameter,) = search.parameters
        self.index = self.ring.index("parameter", self.parameter)
        self.low, self.high = (rationals.exact(x) for x in (low, high))

    def along(self, x: Polynomial) -> Polynomial:
        """The derivative by the parameter.  Raises NoClosedForm where p stands in a root or a function."""
        for k in occurring([x]):
            g = self.ring.generators[k]
            if g.argument is not None and self.index in self.ring.held([g.argument]):
                raise NoClosedForm("[[name]] stands in a root or a function", name=self.parameter)
        return x.derivative(self.index)

    # --- places on the curve ---

    def where(self, further: Sequence[Polynomial], at: Number | None = None) -> CurvePoints:
        """The points of the curve, p within the range, at which ``further`` vanish, or at one number p."""
        numerators = [self.ring.fraction(x)[0] for x in further]
        table = self.table(numerators)
        equations = [table.polynomial(x) for x in (*self.search.equations, *numerators) if not x.is_zero()]
        if at is not None:
            equations.append(_of_number(at, table.context, table.indices.index(self.index)))
        return self._solved(table, [*equations, *table.relations()], at)

    def where_on_components(self, further: Sequence[Polynomial], limits_too: bool = False) -> CurvePoints:
        """As ``where``, component by component of the curve: longer polynomials are short on one.

        ``limits_too``: also where the curve only tends to, as something vanishes that must not.
        """
        numerators = [self.ring.fraction(x)[0] for x in further]
        table = self.table(numerators)
        equations = [table.polynomial(x) for x in self.search.equations] + table.relations()
        usable = [table.polynomial(x) for x in self.search.nonzero if table.holds(x)]
        whole = solve(equations, usable, table.bounded(), self.limits)
        points = [CurvePoints((), (), False, whole.unfinished)]
        conditions = [table.polynomial(x) for x in numerators]
        for family in whole.families:
            if any(part.dimension > 1 for part in whole.families):
                return CurvePoints((), (), True, ())
            points.append(self._solved(table, [*family.equations, *table.relations(), *conditions], None, limits_too))
        return joined(points)

    def _solved(
        self, table: Unknowns, equations: Sequence[Any], at: Number | None, limits_too: bool = False
    ) -> CurvePoints:
        usable = [] if limits_too else [table.polynomial(x) for x in self.search.nonzero if table.holds(x)]
        result = solve(equations, usable, table.bounded(), self.limits)
        points = []
        for point in result.points:
            if table.roots_agree(point) and (p := self._number(table, point, at)) is not None:
                points.append(self._point(table, point, p))
        continua: list[Number] = []
        throughout, unfinished = False, list(result.unfinished)
        for family in result.families:
            if not self._constant_on(table, family):
                throughout = throughout or table.roots_agree(family.sample)
                continue
            for p in self._conjugates(table, family):
                if at is None or compare(p, at) == 0:
                    shown = self._shown_at(table, family, p)
                    continua += [p] if shown else []
                    unfinished += [] if shown else [CONTINUUM_OPEN]
        return CurvePoints(tuple(points), tuple(continua), throughout, tuple(dict.fromkeys(unfinished)))

    def _conjugates(self, table: Unknowns, family: Family) -> list[Number]:
        """The numbers in the range that p may have on a family, as it has one of them at the sample."""
        k = table.indices.index(self.index)
        minimal = primitive(minimal_polynomial(family.sample.values[k], family.sample.modulus))
        ends = [x for x in (self.low, self.high) if minimal(x) == 0]
        return [*ends, *map(number, roots_between(minimal, self.low, self.high))]

    def _shown_at(self, table: Unknowns, family: Family, p: Number) -> bool:
        """Whether a real point of the family with this p is found."""
        gens = table.context.gens()
        for value in _TRIED:
            fixed = [gens[i] * int(value.q) - int(value.p) for i in family.free]
            for point in [family.sample, *solve([*family.equations, *fixed], (), table.bounded(), self.limits).points]:
                if table.roots_agree(point) and self._number(table, point, p) is not None:
                    return True
        return False

    def _number(self, table: Unknowns, point: AlgebraicPoint, at: Number | None) -> Number | None:
        """p there, if it lies in the range (and is ``at``)."""
        value = point.values[table.indices.index(self.index)]
        algebraic = _algebraic(value, point, self.low, self.high)
        return None if algebraic is None or (at is not None and compare(algebraic, at) != 0) else algebraic

    def _point(self, table: Unknowns, point: AlgebraicPoint, p: Number) -> CurvePoint:
        place = self.search._place(table, point)
        place.balls[self.parameter] = point.enclosure(point.values[table.indices.index(self.index)], PRECISION)
        candidate = self.search._candidate(place, EXACT)
        return CurvePoint(place, p, candidate.features, self, bool(candidate.beyond))

    def _constant_on(self, table: Unknowns, family: Family) -> bool:
        """Whether p has one value on a family, near its sample: fixed there it does not make the family smaller."""
        k = table.indices.index(self.index)
        minimal = primitive(minimal_polynomial(family.sample.values[k], family.sample.modulus))
        result = solve([*family.equations, _in_unknown(minimal, table.context, k)], (), table.bounded(), self.limits)
        return any(x.dimension >= family.dimension and x.contains(family.sample) for x in result.families)

    # --- places that are no points ---

    def borders(self) -> CurvePoints:
        """Where a square root vanishes, a denominator does, or a length goes to infinity."""
        parts = [self._without_conditions([x]) for x in self.undefined()]
        parts += [
            CurvePoints((), (), False, (INFINITY_OPEN,)) if system is None else self._gone(*system)
            for system in self.at_infinity()
        ]
        return joined([*parts, self._massless()])

    def _massless(self) -> CurvePoints:
        """Where det M = 0: the coordinates are singular, and what is found there is not counted.

        Where it vanishes all along a branch, other branches meet that one in singular points only.
        """
        if self.mass is None:
            return CurvePoints((), (), False, (MASS_OPEN,))
        if self.mass.is_constant():
            return CurvePoints((), (), False, ())
        return replace(self.where([self.mass]), throughout=False)

    def _without_conditions(self, further: Sequence[Polynomial]) -> CurvePoints:
        saved, self.search.nonzero = self.search.nonzero, list(self.search.singular_where)
        try:
            return self.where(further)
        finally:
            self.search.nonzero = saved

    def _gone(self, table: Unknowns, equations: Sequence[Any]) -> CurvePoints:
        """The values of p at which a length may go to infinity."""
        result = solve(equations, (), table.bounded(), self.limits)
        numbers = [self._number(table, point, None) for point in result.points]
        unfinished = list(result.unfinished)
        for family in result.families:
            if self._constant_on(table, family):
                numbers += self._conjugates(table, family)
            else:
                unfinished.append(INFINITY_UNDECIDED)
        return CurvePoints((), tuple(x for x in numbers if x is not None), False, tuple(dict.fromkeys(unfinished)))


def joined(parts: Sequence[CurvePoints]) -> CurvePoints:
    """What several searches found, together."""
    return CurvePoints(
        tuple(x for part in parts for x in part.points),
        tuple(x for part in parts for x in part.continua),
        any(part.throughout for part in parts),
        tuple(dict.fromkeys(x for part in parts for x in part.unfinished)),
    )


def curves(
    system: System,
    parameter: str,
    values: Mapping[str, Fraction],
    low: Fraction,
    high: Fraction,
    limits: Limits,
    rank: int | None = None,
) -> tuple[tuple[Curve, ...], CurvePoints]:
    """The curve in every set of angles and case of the rank of constraints that is needed; none without points.

    Besides, the rests in positions in which the constraints have another rank than ``rank``, and the places where the
    curve tends to such positions.
    """  # fmt: skip
    regular_curves, singular = [], []
    for searches in searches_over(system, (parameter,), values, limits, rank):
        cases = [Curve(search, low, high) for search in searches]
        regular = [curve for curve in cases if curve.regular and not curve.empty]
        for other in cases:
            if not other.regular:
                singular += [curve.where_on_components(other.search.case.zero, limits_too=True) for curve in regular]
                singular += [] if other.empty else [other.where([])]
        singular += [replace(curve.where([]), continua=(), throughout=False) for curve in regular if curve.redundant]
        regular_curves += regular
        if any(not curve.search.equations for curve in regular):
            break
    return tuple(regular_curves), joined(singular)


# --- numbers ----------------------------------------------------------------------------------------------------------


def _algebraic(value: Any, point: AlgebraicPoint, low: Any, high: Any) -> Number | None:
    """An element of the number field as a number in [low, high], None where it lies outside."""
    minimal = primitive(minimal_polynomial(value, point.modulus))
    if minimal.degree() == 1:
        exact = fmpq(-minimal[0], minimal[1])
        return exact if low <= exact <= high else None
    bound = 1 + fmpq(max(abs(c) for c in minimal.coeffs()), 1)
    roots, bits = roots_between(minimal, -bound, bound), 64
    while True:
        ball = point.enclosure(value, bits)
        near = [root for root in roots if root.enclosure(bits).overlaps(ball)]
        if len(near) == 1:
            algebraic = number(near[0])
            return algebraic if compare(algebraic, low) >= 0 and compare(algebraic, high) <= 0 else None
        bits *= 2


def _of_number(at: Number, context: Any, k: int) -> Any:
    """The minimal polynomial of a number, in the unknown k."""
    return _in_unknown([-at.p, at.q] if isinstance(at, fmpq) else at.polynomial.coeffs(), context, k)


def _in_unknown(coefficients: Any, context: Any, k: int) -> Any:
    n = context.nvars()
    return context.from_dict({tuple(e * (i == k) for i in range(n)): c for e, c in enumerate(coefficients) if c})
