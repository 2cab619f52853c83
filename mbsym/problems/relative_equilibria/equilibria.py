"""All relative equilibria of a system with numerical parameters.

A relative equilibrium is a motion on which every coordinate is constant, except those that the description lets turn
at a constant rate; prescribed quantities go on running.  With  M(q) q'' = f(q, q', t)  it solves

    f_i(q, rates, t) = 0,        i = 1..n,  identically in t

and under constraints, with multipliers that are eliminated case by case (``multipliers``),

    f + J^T lambda = 0,    phi(q, t) = 0,    J q' + j = 0

Where the f_i are polynomials in sines, cosines and plain coordinates (roots and reciprocals included), the system with
s^2 + c^2 = 1 for every angle is solved exactly (``algebra.polynomial_systems``): a solution is a point of a number
field, every f_i is zero there exactly, and the list is complete.  Where that outgrows its limits, direction cosines in
place of angles may do (``problems.rest_oriented``).  Where the f_i are no such polynomials (an angle that also stands
outside sine and cosine, exponentials), or where the exact solution outgrows its limits, solutions are found by
bisection or from many starting points, and each is proved to exist and to be unique in a box (Krawczyk), or put to the
test exactly where it can be guessed (zero, springs at rest).  The list is complete where the bisection is and the
equations bound every coordinate; otherwise it **may be incomplete**, and the result says so.

Angles that are singular somewhere (a gimbal) are replaced there by others, so that no orientation is lost, and
coordinates that describe one configuration twice are counted once.  Where the equations do not know an angle (the whole
may be turned about an axis) they are counted up to that angle, whose value is any.  Negative lengths of polar
coordinates are the same places again, or no states of the system meant (``mechanics.reflections``).

Each equilibrium is judged by the theorems of problem 6: at rational sines and cosines by exact counting, otherwise by
enclosures of the roots.  Solutions that are not isolated are families.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Constrained
from mbsym.algebra.krawczyk import certified
from mbsym.algebra.polynomial_systems import AlgebraicPoint, Family, Limits, Solutions, solve
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.message import Counted, Message, joined
from mbsym.mechanics.charts import Chart, charts, joints, with_cyclic_last_angles
from mbsym.mechanics.kinematics import over_ring
from mbsym.mechanics.rest import Rest, Value, at_numbers, rest
from mbsym.model.system import System, velocity_name
from mbsym.problems.relative_equilibria.conditions import Case, Polynomials, cases
from mbsym.problems.relative_equilibria.listing import (
    CERTIFIED,
    ELSEWHERE,
    EXACT,
    STARTS,
    CoordinateValue,
    Equilibria,
    EquilibriumFamily,
    RelativeEquilibrium,
    Solution,
    groups,
)
from mbsym.problems.relative_equilibria.orbits import Orbits, orbits
from mbsym.problems.relative_equilibria.oriented import orientations
from mbsym.problems.relative_equilibria.place import (
    PRECISION,
    Place,
    Unknowns,
    at_zero,
    ball_at,
    candidate_at,
    described_place,
    exact_rates,
)
from mbsym.problems.relative_equilibria.search import WITHIN, SearchInBoxes
from mbsym.problems.stability.words import Because, Word

if TYPE_CHECKING:
    from mbsym.problems.constraints.result import Constraints

__all__ = [
    "CERTIFIED",
    "EXACT",
    "WITHIN",
    "CoordinateValue",
    "Equilibria",
    "EquilibriumFamily",
    "RelativeEquilibrium",
    "_ChartSearch",
    "equilibria",
]


#: Where nothing acts at rest, the positions that are tied.
EVERYWHERE = Message(
    "every position that the constraints allow is an equilibrium: nothing acts at rest ('mbsym run' judges one)"
)
#: The size of one interreduction under constraints (four-bars: 600,000): above this one alone may take minutes.
REDUCTION = 4_000_000
#: With multipliers among the unknowns (a five-bar has 48 complex rests, 54 elements of a basis, 800 bits, and takes
#: interreductions of 6e7; one of 7e8 takes minutes).
WITH_MULTIPLIERS = Limits(elements=120, pairs=1_000, bits=3_000, work=2_000_000, reduction=200_000_000)
#: Of longer equations of steady motions along symmetries the multipliers are not eliminated, but looked for, too.
MOST_ELIMINATED = 150


def equilibria(
    system: System,
    values: Mapping[str, Value],
    within: float = WITHIN,
    limits: Limits | None = None,
    rank: int | None = None,
) -> Equilibria:
    """All relative equilibria of a system at parameter values.

    ``rank``: of the constraints near positions that keep them, where it is known.  Raises KeyError for a missing value,
    NoClosedForm where the equations outgrow their budget, SingularPoint, Constrained where no position keeps the
    constraints, they contradict one another, or tie what moves and no symmetries carry it (``orbits``).
    """
    first = rest(at_numbers(system, values))
    if first.rows and first.tied_in_motion:
        carried = _carried(first)
        return _by_rates(carried, _listed(carried, first.system, within, limits or Limits(), len(carried.rows)))
    rank = rank_of(first) if rank is None else rank
    tied = not all(x.is_zero() for x in first.kept)
    if tied and not first.turning and all(x.is_zero() for x in first.at_rest):
        return Equilibria((), (), False, (EVERYWHERE,), everywhere=True)
    listed = _listed(first, first.system, within, limits or Limits(), rank, described_place(system, first, values))
    if not listed.families:
        return listed
    symmetric, changed = with_cyclic_last_angles(first)
    if not changed:
        return listed
    counted = _listed(symmetric, first.system, within, limits or Limits(), rank)
    special = any(x.special for x in listed.families)  # such a sample tells little of the others
    if not counted.complete or (listed.complete and not (special and not counted.families)):
        return listed
    turns = (
        Message(
            "counted up to turns of [[body]] about its axis [[axis]], on which nothing depends", body=body, axis=axis
        )
        for body, axis in changed
    )
    return replace(counted, remarks=(*counted.remarks, *turns))


def _listed(
    first: Rest,
    described_by: System,
    within: float,
    limits: Limits,
    rank: int | None,
    described: Mapping[str, LinearForm] | None = None,
) -> Equilibria:
    """The relative equilibria of a system at numbers, in sets of angles that begin with those of ``first``.

    ``described``: the place of the unperturbed motion, which no search may find if it is no simple root.
    """
    remarks: list[str] = []
    solutions: list[Solution] = []
    families: list[EquilibriumFamily] = []
    complete = True
    uncounted: list[bool] = []
    if isinstance(first, Orbits) and (turns := joints(first.system, first.turning)):
        text = (
            "angles of [[bodies]] that are singular somewhere were not replaced by others: steady motions there may be "
            "missing, and one may be listed more than once"
        )
        remarks.append(Message(text, bodies=", ".join(joint.body for joint in turns)))
        complete = False
    covering = (Chart(first, (), (), (), ()),) if isinstance(first, Orbits) else charts(first, described_by)
    limits = replace(limits, reduction=REDUCTION) if first.rows and not limits.reduction else limits
    for chart in covering:
        searches = list(searches_of(chart, limits, rank, within))
        for search in searches:
            search.run()
            if families and chart.restrictions:
                search.points = _off_families(search, within, limits)
        if first.rows and not all(x.complete for x in searches):
            _search_whole(searches)
        if described and chart is covering[0] and not all(x.complete for x in searches):
            any(x.add_described(described) for x in searches)
        _counted_once(searches)
        uncounted += [x.is_real for x in searches if rank is not None and x.case.rank < rank and x.leaves_none]
        for search in searches:
            solutions += search.points
            families += search.families
            remarks += [*search.remarks, *search.doubts]
            complete = complete and search.complete
        if any(not x.equations and not x.impossible for x in searches):  # everywhere: other angles add nothing
            break
    listed = [_described(group) for group in groups(solutions)]
    listed.sort(key=lambda x: (_ORDER[x.verdict.word], x.coordinates_of, _sort_key(x)))
    singular = tuple(x for x in listed if x.verdict.coordinates_singular)
    beyond = tuple(x for x in listed if x.beyond and x not in singular)
    listed = [x for x in listed if x not in singular and x not in beyond]
    if singular or any(x.verdict.coordinates_singular for x in families):
        remarks.append(
            Message(
                "where the mass matrix is singular so are the coordinates: such a solution need not be an equilibrium, "
                "which is to be seen in other coordinates"
            )
        )
    if other := [x for x in listed if x.verdict.because(Because.OTHER_BRANCH)]:
        text = (
            "[[count]]: on other branches of the constraints, where more of them are independent, and nothing is said "
            "of stability"
        )
        remarks.append(Message(text, count=Counted(len(other), "relative equilibrium", "relative equilibria")))
    if lost := [x for x in listed if x.verdict.because(Because.RANK_LOST)]:
        text = (
            "[[count]]: there the constraints are singular (links in line, branches of motion that meet), and nothing "
            "is said of stability; a rest that only unbounded reactions would hold is none"
        )
        remarks.append(Message(text, count=Counted(len(lost), "relative equilibrium", "relative equilibria")))
    elif uncounted:
        text = (
            "there are positions in which the constraints are singular (a cusp, links in line, branches of motion that "
            "meet): a rest there that only unbounded reactions would hold is not counted"
        )
        if not any(uncounted):
            text = (
                "there may be positions in which the constraints are singular, but no real one was found (a cusp, "
                "links in line, branches of motion that meet): a rest there that only unbounded reactions would hold "
                "is not counted"
            )
        remarks.append(Message(text))
    if families and covering[0].joints:
        remarks.append(
            Message("families are listed in coordinates: one set of configurations may be described more than once")
        )
    turning = tuple(
        (name, float(first.ring.evaluate(first.rates[first.ring.index("velocity", name)], {}).mid()))
        for name in first.turning
    )
    return Equilibria(
        tuple(listed),
        tuple(families),
        complete,
        tuple(dict.fromkeys(remarks)),
        turning,
        len(covering),
        singular,
        beyond,
    )


def _carried(first: Rest) -> Orbits:
    """The steady motions along symmetries of a system whose constraints tie what moves.

    Raises Constrained where symmetries do not carry all that moves.
    """
    carried = orbits(first, _constraints(first))
    if carried is None:
        raise Constrained(
            "relative equilibria: constraints tie what moves ([[names]]), and no symmetries of the system that are "
            "shifts, turns in a plane or turns about an axis carry all of it",
            names=", ".join(first.tied_in_motion),
            remedy="'mbsym run' judges such a motion where the description gives it",
        )
    return carried


def _by_rates(carried: Orbits, listed: Equilibria) -> Equilibria:
    """With the names of rates that follow from the constraints, in place of the letters that stood for them."""
    rates = {name: velocity_name(name) for name in carried.following}

    def called(values: Iterable[CoordinateValue]) -> tuple[CoordinateValue, ...]:
        return tuple(replace(x, name=rates.get(x.name, x.name)) for x in values)

    def written(text: str) -> str:
        return re.sub(r"\w+", lambda word: rates.get(word[0], word[0]), text)

    def named(equilibria: Iterable[RelativeEquilibrium]) -> tuple[RelativeEquilibrium, ...]:
        return tuple(
            replace(x, values=called(x.values), enclosures={rates.get(k, k): y for k, y in x.enclosures.items()})
            for x in equilibria
        )

    families = tuple(
        replace(
            x, sample=called(x.sample), free=tuple(map(written, x.free)), equations=tuple(map(written, x.equations))
        )
        for x in listed.families
    )
    remarks = listed.remarks
    if turned := sorted({carried.system.coordinates[c.place] for c in carried.symmetries if c.slopes}):
        text = "rates are those at the moment when [[names]] is 0; the motion goes on alike in the frame that it turns"
        remarks = (*remarks, Message(text, names=", ".join(turned)))
    return replace(
        listed,
        equilibria=named(listed.equilibria),
        singular=named(listed.singular),
        families=families,
        remarks=remarks,
    )


def rank_of(first: Rest) -> int | None:
    """How many constraints are independent near positions that keep them; None where there are none.

    Raises Constrained where no such position is found, they contradict one another, or tie what moves.
    """
    if not first.rows:
        return None
    if first.tied_in_motion:
        raise Constrained(
            "branches of equilibria: constraints tie what moves ([[names]]), and which velocities go with it is not "
            "followed over a parameter",
            names=", ".join(first.tied_in_motion),
            remedy="'mbsym equilibria' without --vary lists the steady motions at numbers",
        )
    return _constraints(first).velocity_rank


def _constraints(first: Rest) -> Constraints:
    from mbsym.problems.constraints.analysis import constraints  # most systems have none

    plain = first.system.without_speeds
    return constraints(over_ring(plain, first.ring))


def searches_of(
    chart: Chart, limits: Limits, rank: int | None, within: float = WITHIN, parameters: tuple[str, ...] = ()
) -> Iterator[_ChartSearch]:
    """One search for each case of the rank of constraints; ``parameters`` are unknowns, too."""
    left_out, real = [], list[tuple[Polynomials, Polynomials]]()

    def possible(zero: Polynomials, nonzero: Polynomials) -> bool:
        probe = _ChartSearch(chart, within, limits, Case((), zero, nonzero), parameters=parameters)
        there = probe.exists()
        if probe.is_real:
            real.append((zero, nonzero))
        if there and probe.reason:  # of equations that are not algebraic only the case of all others is searched
            left_out.append(probe)
            return False
        return there

    if isinstance(chart.rest, Orbits) and sum(map(len, chart.rest.at_rest)) > MOST_ELIMINATED:
        yield _ChartSearch(chart, within, limits, Case(tuple(chart.rest.balanced), whole=True), rank, parameters)
        return
    for case in list(cases(chart.rest, possible)):  # all, as what is left out concerns the first, too
        search = _ChartSearch(chart, within, limits, case, rank, parameters)
        search.is_real = (case.zero, case.nonzero) in real
        if left_out:
            search.leaves_out_singular()
        yield search


def _search_whole(searches: Sequence[_ChartSearch]) -> None:
    """The positions of all cases in which the constraints have their rank, at once: by bisection, else exactly.

    Where nothing is left open, the list is complete whatever the single cases left out.
    """
    left_open = searches[0].search_whole()
    if left_open and searches[0].solves_with_multipliers():
        for search in searches:
            search.doubts, search.unfinished, search.remarks = [], False, search.remarks[: search.told]
            if search is not searches[0] and search.case.rank == searches[0].case.rank:
                search.points = []
        return
    for search in searches:
        search.doubts, search.unfinished = search.doubts * bool(left_open), False
    searches[0].doubts += left_open
    if not left_open:
        text = "bisection went through all positions that the constraints allow and left none undecided"
        searches[0].remarks.append(Message(text))


def _counted_once(searches: Sequence[_ChartSearch]) -> None:
    """What in one case of the rank is only the limit of a larger set of another is left out."""
    closures = [closure for search in searches for closure in search.closures()]
    for search in searches:
        if len(searches) == 1 or not search.case.zero:
            continue
        search.points = [x for x in search.points if not _on_any(x.place, [y for _, y in closures])]
        keeps = [
            not _on_any(place, [y for dimension, y in closures if dimension > x.dimension])
            for x, place in zip(search.families, search.family_places, strict=True)
        ]
        for name in ("families", "family_places", "family_equations"):
            setattr(search, name, [x for x, keep in zip(getattr(search, name), keeps, strict=True) if keep])


def _on_any(place: Place, closures: Sequence[Sequence[Polynomial]]) -> bool:
    """Whether a place is on the closure of a family, told by equations."""
    return any(all((value := place.residue(x)) is not None and value == 0 for x in equations) for equations in closures)


def _off_families(search: _ChartSearch, within: float, limits: Limits) -> list[Solution]:
    """The points of a chart that are not limits of families which run on outside its restrictions."""
    whole = _ChartSearch(replace(search.chart, restrictions=()), within, limits, search.case)
    whole.run()
    search.doubts += whole.doubts
    return [point for point in search.points if not _on_any(point.place, whole.family_equations)]


_ORDER = {word: k for k, word in enumerate(Word)}


def _sort_key(x: RelativeEquilibrium) -> tuple[tuple[float, float], ...]:
    return tuple((round(abs(item.value), 9), -item.value) for item in x.values)


def _described(group: Sequence[Solution]) -> RelativeEquilibrium:
    """The configuration in its simplest coordinates, judged there."""
    best = min(
        group,
        key=lambda c: (
            c.chart.chart.label,
            c.proof != EXACT,
            sum(abs(x.value) for x in c.values),
            [-x.value for x in c.values],
        ),
    )
    judged = best.chart.verdict(best.place)
    return RelativeEquilibrium(
        best.values,
        best.proof,
        judged,
        best.chart.chart.label,
        best.free,
        len(group),
        best.beyond,
        {x.name: best.place.balls[x.name] for x in best.values},
        best.chart.rest.system,
    )


class _ChartSearch(SearchInBoxes):
    """Conditions, solutions and verdicts in one set of coordinates.

    ``is_real``: positions of its case are known, by exact real solutions; else such that exist may all be complex.
    """

    is_real = False
    #: So many remarks are there before it is said what was not finished.
    told = 0

    def run(self) -> None:
        self._conditions()
        if self.impossible:
            return
        if not self.equations:
            self._add_free_point()
            return
        if self.case.whole:
            self.reason = Message("the equations are too long for their multipliers to be eliminated")
        self.told = len(self.remarks)
        if self.reason:
            self.remarks.append(Message("no exact solution: [[why]]", why=self.reason))
            self.unfinished = bool(self.rest.rows)  # all cases are searched at once
            if not self.unfinished:
                self._search_numerically(bisect=True)
            return
        self._solve_exactly()

    def add_described(self, forms: Mapping[str, LinearForm]) -> bool:
        """Whether the place with these coordinates is one of rest of this case, which then is listed."""
        candidate, names = candidate_at(self.rest, forms), self.occurring
        if self.impossible or not {*names} <= {*forms} or not all(map(candidate.vanishes, self.equations)):
            return False
        if any(map(candidate.vanishes, self.nonzero)):
            return False
        place = candidate.place(self.rest, exact_rates(self.rest))
        if not any(self._same(place, x.place) for x in self.points):
            self._add(place, EXACT)
        return True

    @property
    def leaves_none(self) -> bool:
        """Whether positions of its case, which ``cases`` found, are none of them told to be at rest."""
        return not self.points and not self.families

    def closures(self) -> list[tuple[int, list[Polynomial]]]:
        """Dimensions and equations of sets that other cases touch: of families, and where coordinates are any."""
        found = [(x.dimension, y) for x, y in zip(self.families, self.family_equations, strict=True)]
        open_ = any(self.ring.dependencies(x, self.free) for x in self.case.nonzero)
        return [*found, *([(len(self.free), self.equations)] if open_ and not self.impossible else [])]

    def leaves_out_singular(self) -> None:
        """Says that positions in which the constraints may be singular are not searched."""
        self._incomplete("positions in which the constraints may be singular were not searched")

    def _vanishes(self, x: Polynomial, place: Place) -> bool:
        """Whether x is zero there whatever the coordinates that may have any value."""
        varying = self.ring.dependencies(x, self.free)
        places = [place.elsewhere(varying, t) for t in ELSEWHERE] if varying else [place]
        return all((value := place.residue(x)) is not None and value == 0 for place in places)

    def exists(self) -> bool:
        """Whether there may be a solution: False is proved."""
        self._conditions()
        if self.impossible or not self.equations or self.reason:
            self.is_real = not self.impossible and not self.reason
            return not self.impossible
        table, result = self._solutions()
        self.is_real = any(map(table.roots_agree, (*result.points, *(x.sample for x in result.families))))
        return bool(result.points or result.families or result.unfinished)

    def _solutions(self) -> tuple[Unknowns, Solutions]:
        table = Unknowns(self.ring, [*self.equations, *self.singular_where])
        equations = [table.polynomial(x) for x in self.equations] + table.relations()
        usable = [x for x in self.nonzero if table.holds(x)]
        return table, solve(equations, [table.polynomial(x) for x in usable], table.bounded(), self.limits)

    def solves_with_multipliers(self) -> bool:
        """Whether all rests where J has its rank are found exactly, with multipliers among the unknowns.

        Shorter equations than those without: no two are multiplied.  At a rest where J has not its rank multipliers are
        any of a line, a family of solutions; with one nothing is said here.  Each rest is listed as a box: in number
        fields of such degrees (48) verdicts would take minutes.
        """
        square = None if self.reason or self.impossible else self._with_multipliers()
        if square is None or isinstance(self.rest, Orbits):
            return False
        table = Unknowns(self.ring, [*square.equations, *self.singular_where], by_angle=True)
        held = [x for x in self.nonzero[len(self.case.nonzero) :] if table.holds(x)]
        told = [*map(table.polynomial, (*square.equations, *held)), *table.relations()]
        told, changes = table.in_sums_of_angles(told)
        places = range(len(square.equations), len(square.equations) + len(held))
        nonzero, equations = [told[k] for k in places], [x for k, x in enumerate(told) if k not in places]
        found = solve(equations, nonzero, table.bounded(), WITH_MULTIPLIERS)
        if found.unfinished or found.families:
            return False
        boxes = []
        names, functions = (*square.coordinates, *square.multipliers), square.functions(self.ring)
        for point in filter(table.roots_agree, found.points):
            point = table.of_angles(point, changes)
            exact = dict(zip(table.indices, point.values, strict=True))
            balls = self._place(table, point).balls | {
                name: point.enclosure(exact[self.ring.index("prescribed", name)]) for name in square.multipliers
            }
            box = certified(*functions, [float(balls[name].mid()) for name in names], PRECISION)
            if box is None:
                return False
            boxes.append(dict(zip(square.coordinates, box, strict=False)))
        self.points = []
        for place in boxes:
            self._add(Place(self.rest, place, {}, None), CERTIFIED)
        return True

    def _solve_exactly(self) -> None:
        table, result = self._solutions()
        for point in result.points:
            if not table.roots_agree(point):
                continue
            place = self._place(table, point)
            if not any(self._vanishes(x, place) for x in self.case.nonzero):
                self._add(place, EXACT)
        for family in result.families:
            if table.roots_agree(family.sample):
                self._add_family(table, family)
        if result.unfinished:
            if self._solve_in_direction_cosines():
                return
            reasons = joined(result.unfinished, "; ")
            if self.rest.rows:
                self.unfinished = True
                self.remarks.append(Message("the exact solution is not finished ([[reasons]])", reasons=reasons))
                return
            self._incomplete(
                Message(
                    "the exact solution is not finished ([[reasons]]); the rest was searched for from [[count]] points",
                    reasons=reasons,
                    count=STARTS,
                )
            )
            self._search_numerically(bisect=False)

    def _solve_in_direction_cosines(self) -> bool:
        """The second way to a complete list; False where it does not lead to one."""
        if self.families or self.rest.rows:
            return False
        solved = orientations(self.chart, self.occurring, self.nonzero, self._for_all_times, self.limits)
        if solved is None or any(not self._may_rest(place) for place in solved.places):
            return False
        known = [x.place for x in self.points]
        for place in solved.places:
            if not any(self._same(place, other) for other in known):
                self._add(place, EXACT)
        self.remarks.append(
            Message("solved exactly in the direction cosines of [[joints]]", joints=", ".join(solved.joints))
        )
        return True

    def _place(self, table: Unknowns, point: AlgebraicPoint) -> Place:
        ring = self.ring
        exact = dict(zip(table.indices, point.values, strict=True))
        balls = {name: ball_at(ring, name, exact, point) for name in self.occurring}
        exact |= at_zero(ring, self.free)  # any value does; 0 is one
        return Place(self.rest, balls, exact | exact_rates(self.rest), point.modulus, point.enclosure)

    def _add_free_point(self) -> None:
        self._add(self._zero(), EXACT)
        moves = isinstance(self.rest, Orbits) and any(not x.is_zero() for x in self.rest.speeds.values())
        every = "through every position one steady motion leads" if moves else "every position is an equilibrium"
        self.remarks.append(Message(every))

    def _add_family(self, table: Unknowns, family: Family) -> None:
        place = self._place(table, family.sample)
        free = [self.ring.generators[table.indices[k]] for k in family.free]
        names = [g.name if g.argument is None else table.names[k] for k, g in zip(family.free, free, strict=True)]
        texts = tuple(table.text(x) for x in family.equations if not table.is_relation(x))
        self.family_places.append(place)
        self.family_equations.append([table.back(x) for x in family.equations])
        self.families.append(
            EquilibriumFamily(
                family.dimension,
                tuple(dict.fromkeys(names)),
                texts,
                self._values(place),
                self.verdict(place),
                self.chart.label,
                {name: place.balls[name] for name in self.occurring},
                self.rest.system,
                family.special,
            )
        )
