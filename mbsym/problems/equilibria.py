"""All relative equilibria of a system with numerical parameters.

A relative equilibrium is a motion on which every coordinate is constant, except those that the description lets turn
at a constant rate; prescribed quantities go on running.  With  M(q) q'' = f(q, q', t)  it solves

    f_i(q, rates, t) = 0,        i = 1..n,  identically in t

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

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, ctx, fmpq, fmpq_poly

from mbsym.algebra import krawczyk
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.generators import occurring
from mbsym.algebra.polynomial_systems import (
    AlgebraicPoint,
    Family,
    Limits,
    solve,
)
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.charts import Chart, charts, moments, with_cyclic_last_angles
from mbsym.mechanics.charts import features as direction_features
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.reflections import Reflection, reflections
from mbsym.mechanics.rest import Rest, at_numbers, rest
from mbsym.model.system import System
from mbsym.problems.rest_bounds import reach
from mbsym.problems.rest_candidates import Candidate, candidates, only_root
from mbsym.problems.rest_oriented import orientations
from mbsym.problems.rest_place import PRECISION, Place, angle_of, exact_rates
from mbsym.problems.rest_sampling import STARTS, from_many_points, turned
from mbsym.problems.rest_unknowns import Unknowns
from mbsym.problems.rest_verdict import LinearAtRest, linear_at_rest
from mbsym.problems.stability.reasons import Because, Reason
from mbsym.problems.stability.verdict import Verdict, undecided
from mbsym.problems.stability.word import Word

EXACT, CERTIFIED = "exact", "proved in a box"

#: Plain coordinates that no formula bounds are searched for in [-WITHIN, WITHIN], where no exact solution is possible.
WITHIN = 10.0
#: Farther out than this they are not searched for, even where it is proved that they are not farther out.
FARTHEST = 1_000.0
#: Boxes that a bisection looks at.
MOST_BOXES = 6_000
#: Other values of coordinates that may have any, where their verdicts are compared: t, or 2 atan(t) of angles.
ELSEWHERE = (fmpq(1, 3), fmpq(-2), fmpq(7, 5))
#: More unknowns than this are not searched for by bisection.
MOST_BISECTED = 3


@dataclass(frozen=True)
class CoordinateValue:
    """One coordinate at an equilibrium: ``text`` is exact if ``exact`` (``pi/2``, ``5/4``), else rounded.

    ``angle``: it occurs under sine and cosine only, so it is meant modulo a full turn.
    """

    name: str
    text: str
    value: float
    angle: bool
    exact: bool


@dataclass(frozen=True)
class RelativeEquilibrium:
    """One isolated relative equilibrium.

    ``proof``: exact (f vanishes in a number field), or proved in a box.  ``coordinates_of``: which joints have other
    angles than the description's, because those are singular here (empty: none).  ``free``: coordinates that do not
    occur in f, so that every value of them does.  ``described``: how many sets of coordinates mean this configuration.
    ``beyond``: the negative lengths of polar coordinates, behind their singularity.
    """

    values: tuple[CoordinateValue, ...]
    proof: str
    verdict: Verdict
    coordinates_of: str = ""
    free: tuple[str, ...] = ()
    described: int = 1
    beyond: tuple[str, ...] = ()


@dataclass(frozen=True)
class EquilibriumFamily:
    """Relative equilibria that are not isolated: a real set of ``dimension``, all solutions of ``equations`` = 0.

    ``sample`` is one of them, ``verdict`` the verdict there; ``free`` may be chosen near it.
    """

    dimension: int
    free: tuple[str, ...]
    equations: tuple[str, ...]
    sample: tuple[CoordinateValue, ...]
    verdict: Verdict
    coordinates_of: str = ""


@dataclass(frozen=True)
class Equilibria:
    """``complete``: nothing is missing; otherwise ``remarks`` say what was not done, and why.

    ``singular`` are solutions of f = 0 at which the mass matrix, and with it the coordinates, are singular: whether
    they are equilibria is undecided.  ``beyond`` are solutions in which a polar coordinate that is a length is negative
    and the forces are not those at the same places of the bodies with a positive length: no states of the system meant.
    ``turning`` are the coordinates that turn at the description's rates, ``charts`` how many sets of angles were used.
    """

    equilibria: tuple[RelativeEquilibrium, ...]
    families: tuple[EquilibriumFamily, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: tuple[tuple[str, float], ...] = ()
    charts: int = 1
    singular: tuple[RelativeEquilibrium, ...] = ()
    beyond: tuple[RelativeEquilibrium, ...] = ()


def equilibria(
    system: System, values: Mapping[str, Fraction], within: float = WITHIN, limits: Limits | None = None
) -> Equilibria:
    """All relative equilibria of a system at parameter values.

    Raises KeyError for a missing value, NoClosedForm where the equations outgrow their budget, SingularPoint,
    Constrained.
    """
    refuse_constraints(system, "relative equilibria")
    first = rest(at_numbers(system, values))
    found = _listed(first, first.system, within, limits or Limits())
    if found.complete or not found.families:
        return found
    symmetric, changed = with_cyclic_last_angles(first)
    if not changed:
        return found
    counted = _listed(symmetric, first.system, within, limits or Limits())
    if not counted.complete:
        return found
    turns = (f"counted up to turns of {body} about its axis {axis}, on which nothing depends" for body, axis in changed)
    return replace(counted, remarks=(*counted.remarks, *turns))


def _listed(first: Rest, described_by: System, within: float, limits: Limits) -> Equilibria:
    """The relative equilibria of a system at numbers, in sets of angles that begin with those of ``first``."""
    remarks: list[str] = []
    found: list[_Candidate] = []
    families: list[EquilibriumFamily] = []
    complete = True
    covering = charts(first, described_by)
    for chart in covering:
        search = _ChartSearch(chart, within, limits)
        search.run()
        if families and chart.restrictions:
            search.points = _off_families(search, within, limits)
        found += search.points
        families += search.families
        remarks += search.remarks
        complete = complete and search.complete
        if not search.equations and not search.impossible:  # everywhere: other angles have nothing to add
            break
    listed = [_described(group) for group in _groups(found)]
    listed.sort(key=lambda x: (_ORDER[x.verdict.word], x.coordinates_of, _sort_key(x)))
    singular = tuple(x for x in listed if x.verdict.coordinates_singular)
    beyond = tuple(x for x in listed if x.beyond and x not in singular)
    listed = [x for x in listed if x not in singular and x not in beyond]
    if singular or any(x.verdict.coordinates_singular for x in families):
        remarks.append(
            "where the mass matrix is singular so are the coordinates: such a solution need not be an equilibrium, "
            "which is to be seen in other coordinates"
        )
    if families and covering[0].joints:
        remarks.append("families are listed in coordinates: one set of configurations may be described more than once")
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


def _off_families(search: _ChartSearch, within: float, limits: Limits) -> list[_Candidate]:
    """The points of a chart that are not limits of families which run on outside its restrictions."""
    whole = _ChartSearch(replace(search.chart, restrictions=()), within, limits)
    whole.run()
    search.complete = search.complete and whole.complete
    return [
        point
        for point in search.points
        if not any(
            all((value := point.place.residue(x)) is not None and value == 0 for x in equations)
            for equations in whole.family_equations
        )
    ]


_ORDER = {word: k for k, word in enumerate(Word)}


def _sort_key(x: RelativeEquilibrium) -> tuple[tuple[float, float], ...]:
    return tuple((round(abs(item.value), 9), -item.value) for item in x.values)


# --- configurations ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Candidate:
    """A solution in one chart; ``features`` are numbers that belong to the configuration, whatever the coordinates."""

    values: tuple[CoordinateValue, ...]
    features: tuple[Any, ...]
    proof: str
    place: Place
    chart: _ChartSearch
    free: tuple[str, ...]
    beyond: tuple[str, ...] = ()


def _groups(found: Iterable[_Candidate]) -> list[list[_Candidate]]:
    """Candidates that mean one configuration: their features cannot be told apart at the working precision."""
    groups: list[list[_Candidate]] = []
    table: dict[tuple[float, ...], list[list[_Candidate]]] = {}
    for candidate in found:
        # Rounded features only say where to look; overlapping balls decide.
        key = tuple(round(float(x.mid()), 6) + 0.0 for x in candidate.features)
        for group in table.get(key, []):
            if all(a.overlaps(b) for a, b in zip(group[0].features, candidate.features, strict=True)):
                group.append(candidate)
                break
        else:
            groups.append([candidate])
            table.setdefault(key, []).append(groups[-1])
    return groups


def _described(group: Sequence[_Candidate]) -> RelativeEquilibrium:
    """The configuration in its simplest coordinates, judged there."""
    best = min(
        group, key=lambda c: (c.chart.chart.label, sum(abs(x.value) for x in c.values), [-x.value for x in c.values])
    )
    judged = best.chart.verdict(best.place)
    return RelativeEquilibrium(
        best.values, best.proof, judged, best.chart.chart.label, best.free, len(group), best.beyond
    )


# --- one chart -------------------------------------------------------------------------------------------------------


class _ChartSearch:
    """Conditions, solutions and verdicts in one set of coordinates."""

    def __init__(self, chart: Chart, within: float, limits: Limits) -> None:
        self.chart, self.found, self.within, self.limits = chart, chart.found, within, limits
        self.ring: Ring = chart.found.ring
        self.points: list[_Candidate] = []
        self.families: list[EquilibriumFamily] = []
        self.remarks: list[str] = []
        self.complete = True
        self.family_equations: list[list[Polynomial]] = []

    def run(self) -> None:
        self._conditions()
        if self.impossible:
            return
        if not self.equations:
            self._add_free_point()
            return
        if self.reason:
            self.remarks.append(f"not solved exactly: {self.reason}")
            self._search_numerically(bisect=True)
            return
        self._solve_exactly()

    # --- conditions ---

    def _conditions(self) -> None:
        found, ring = self.found, self.ring
        forcing = list(found.at_rest)
        for joint, other in zip(self.chart.joints, self.chart.replaced, strict=True):
            # Where the angles are regular these follow, and with them the exact solution is much faster.
            forcing += () if other else moments(found, joint)
        polynomials = [y for x in forcing for y in self._for_all_times(x)]
        self.equations: list[Polynomial] = []
        self.nonzero: list[Polynomial] = []
        self.impossible = False
        for x in (*polynomials, *self.chart.restrictions):
            numerator, denominators = ring.fraction(x)
            self.nonzero += [factor for factor, _ in denominators]
            if numerator.is_constant() and not numerator.is_zero():
                self.impossible = True
            elif not numerator.is_zero():
                self.equations.append(numerator)
        used = set(occurring(self.equations))
        self.occurring = tuple(name for name in found.constant if any(ring.depends_on(x, name) for x in self.equations))
        self.free = tuple(name for name in found.constant if name not in self.occurring)
        usual = [
            x for x in self.chart.nonzero if any(ring.generators[k].name in self.occurring for k in occurring([x]))
        ]
        self.nonzero += usual
        self.singular_where = usual
        self.reason = self._obstacle(used)

    def _for_all_times(self, x: Polynomial) -> Iterator[Polynomial]:
        """What must vanish so that x does at all times: its coefficients with respect to what moves."""
        ring = self.ring
        moving = [*self.found.turning, *(item.name for item in self.found.system.prescribed), "t"]
        present = ring.dependencies(x, moving)
        if not present:
            yield x
            return
        self.remarks.append(
            f"the equations vary with {', '.join(present)}: a relative equilibrium has to satisfy them at all times"
        )
        indices = [
            k
            for k, g in enumerate(ring.generators)
            if g.name in present
            and g.argument is None
            and g.kind in ("sine", "cosine", "coordinate", "prescribed", "time")
        ]
        parts: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
        for monomial, coefficient in x.terms():
            rest_of = list(monomial)
            for k in indices:
                rest_of[k] = 0
            parts.setdefault(tuple(monomial[k] for k in indices), {})[tuple(rest_of)] = coefficient
        if len(present) > 1:
            self._incomplete(
                f"the equations vary with {', '.join(present)}; only solutions for all values of each are listed"
            )
        for terms in parts.values():
            part = ring.context.from_dict(terms)
            if ring.dependencies(part, moving):
                raise NoClosedForm(f"the equations vary with {', '.join(present)} in a way that cannot be separated")
            yield part

    def _obstacle(self, used: set[int]) -> str:
        """Why the equations are not polynomials in sines, cosines and plain coordinates; empty if they are."""
        ring = self.ring
        pending, seen = list(used), set()
        kinds: dict[str, set[str]] = {}
        while pending:
            k = pending.pop()
            if k in seen:
                continue
            seen.add(k)
            g = ring.generators[k]
            if g.kind == "function" or (g.kind in ("sine", "cosine") and g.argument is not None):
                what = "a number" if ring.constant_value(g.argument) is not None else "something that is no angle"
                return f"{'sine and cosine' if g.kind != 'function' else g.name} of {what}"
            if g.argument is not None:
                pending += occurring([g.argument])
            elif g.kind in ("sine", "cosine", "coordinate"):
                kinds.setdefault(g.name, set()).add("plain" if g.kind == "coordinate" else "angle")
            else:
                return f"{g.name} is transcendental"
        mixed = [name for name, both in kinds.items() if len(both) > 1]
        return f"{', '.join(sorted(mixed))} occurs both as an angle and outside sine and cosine" if mixed else ""

    def _incomplete(self, remark: str) -> None:
        self.complete = False
        self.remarks.append(remark)

    # --- exactly ---

    def _solve_exactly(self) -> None:
        table = Unknowns(self.ring, [*self.equations, *self.singular_where])
        equations = [table.polynomial(x) for x in self.equations] + table.relations()
        usable = [x for x in self.nonzero if table.holds(x)]
        result = solve(equations, [table.polynomial(x) for x in usable], table.bounded(), self.limits)
        for point in result.points:
            if not table.roots_agree(point):
                continue
            self._add(self._place(table, point), EXACT)
        for family in result.families:
            if table.roots_agree(family.sample):
                self._add_family(table, family)
        if result.unfinished:
            if self._solve_in_direction_cosines():
                return
            reasons = "; ".join(result.unfinished)
            self._incomplete(
                f"the exact solution is not finished ({reasons}); the rest was searched for from {STARTS} points"
            )
            self._search_numerically(bisect=False)

    def _solve_in_direction_cosines(self) -> bool:
        """The second way to a complete list; False where it does not lead to one."""
        if self.families:
            return False
        found = orientations(self.chart, self.occurring, self.nonzero, self._for_all_times, self.limits)
        if found is None or any(not self._may_rest(place) for place in found.places):
            return False
        known = [x.place for x in self.points]
        for place in found.places:
            if not any(self._same(place, other) for other in known):
                self._add(place, EXACT)
        self.remarks.append(f"solved exactly in the direction cosines of {', '.join(found.joints)}")
        return True

    def _place(self, table: Unknowns, point: AlgebraicPoint) -> Place:
        ring = self.ring
        exact = dict(zip(table.indices, point.values, strict=True))
        balls = {}
        for name in self.occurring:
            if ring.has("sine", name) and ring.index("sine", name) in exact:
                s, c = (point.enclosure(exact[ring.index(kind, name)], PRECISION) for kind in ("sine", "cosine"))
                balls[name] = angle_of(s, c, ring.angles[name])
            else:
                balls[name] = point.enclosure(exact[ring.index("coordinate", name)], PRECISION)
        for name in self.free:  # any value does; 0 is one
            exact |= {ring.index("coordinate", name): fmpq_poly([0])}
            if name in ring.angles:
                exact |= {ring.index("sine", name): fmpq_poly([0]), ring.index("cosine", name): fmpq_poly([1])}
        return Place(self.found, balls, exact | exact_rates(self.found), point.modulus, point.enclosure)

    def _add_free_point(self) -> None:
        self._add(self._zero(), EXACT)
        self.remarks.append("every position is an equilibrium")

    def _add_family(self, table: Unknowns, family: Family) -> None:
        place = self._place(table, family.sample)
        free = [self.ring.generators[table.indices[k]] for k in family.free]
        names = [g.name if g.argument is None else table.names[k] for k, g in zip(family.free, free, strict=True)]
        texts = tuple(table.text(x) for x in family.equations if not table.is_relation(x))
        self.family_equations.append([table.back(x) for x in family.equations])
        self.families.append(
            EquilibriumFamily(
                family.dimension,
                tuple(dict.fromkeys(names)),
                texts,
                self._values(place),
                self.verdict(place),
                self.chart.label,
            )
        )

    # --- by enclosures ---

    def _search_numerically(self, bisect: bool) -> None:
        names, ring = self.occurring, self.ring
        n = len(names)
        independent = self._square_system()
        if independent is None or n == 0:
            self._incomplete("these equations cannot be searched numerically: they are not as many as their unknowns")
            return
        slopes = [[ring.derivative(x, name) for name in names] for x in independent]
        zero = dict.fromkeys(ring.names(), arb(0))

        def function(box: krawczyk.Box) -> list[Any]:
            at = zero | dict(zip(names, box, strict=True))
            return [ring.evaluate(x, at) for x in independent]

        def jacobian(box: krawczyk.Box) -> list[list[Any]]:
            at = zero | dict(zip(names, box, strict=True))
            return [[ring.evaluate(x, at) for x in row] for row in slopes]

        special = list(candidates(self.found, names, self.equations)) if not self.chart.restrictions else []
        special = [x for x in special if not any(x.vanishes(y) for y in self.nonzero)]
        for candidate in special:
            place = candidate.place(self.found, exact_rates(self.found))
            if not self._known([float(place.balls[name].mid()) for name in names], 1e-12):
                self._add(place, EXACT)
        limited = [name for name in names if not self._periodic(name)]
        held = {k: x for k, x in reach(ring, independent, limited).items() if x <= FARTHEST}
        bounds = [self._range(name, held.get(name)) for name in names]
        starts: list[list[float]] = []
        proved: tuple[krawczyk.Box, ...] = ()
        if bisect and n <= MOST_BISECTED:
            result = krawczyk.search(function, jacobian, bounds, MOST_BOXES)
            proved, left = result.roots, result.open_boxes
            if n == 1:
                left = self._unexplained(independent[0], left, special)
            if left:
                self._incomplete(f"{len(left)} boxes of the bisection are undecided: there may be more equilibria")
            starts += [[float(x.mid()) for x in box] for box in (*proved, *left[:200])]
        elif bisect:
            self._incomplete(f"searched for from {STARTS} points: there may be more equilibria")
        if not proved and (not starts or not bisect):
            starts += from_many_points(ring, independent, slopes, names, bounds)
        if bisect and limited:
            ranges = ", ".join(f"{name} within {_short(self._range(name, held.get(name))[1])}" for name in limited)
            if set(limited) <= held.keys():
                self.remarks.append(f"looked for with {ranges} of zero; the equations prove that none lies farther out")
            else:
                self._incomplete(f"looked for with {ranges} of zero only")
        for number, start in enumerate(starts):
            if not bisect and (self._known(start, 1e-6) or self._is_excluded(start)):
                continue
            box = krawczyk.certified(function, jacobian, start, PRECISION)
            closely = box is not None and (
                number >= len(proved) or all(x.overlaps(y) for x, y in zip(box, proved[number], strict=True))
            )
            if number < len(proved) and not closely:
                self._incomplete("an equilibrium that was proved to exist could not be enclosed closely")
            if box is not None and all(
                low - 1e-9 <= float(x.mid()) <= high + 1e-9 for x, (low, high) in zip(box, bounds, strict=True)
            ):
                self._add_certified(dict(zip(names, box, strict=True)))

    def _unexplained(
        self, equation: Polynomial, boxes: Sequence[krawczyk.Box], special: Sequence[Candidate]
    ) -> tuple[krawczyk.Box, ...]:
        """Open boxes of one unknown, without groups in which a known place is the only root, simple or multiple."""
        (name,) = self.occurring
        groups: list[list[krawczyk.Box]] = []
        for box in sorted(boxes, key=lambda x: float(x[0].mid())):
            if groups and groups[-1][-1][0].overlaps(box[0]):
                groups[-1].append(box)
            else:
                groups.append([box])
        left: list[krawczyk.Box] = []
        for group in groups:
            hull = group[0][0].union(group[-1][0])
            inside = [x for x in special if hull.contains(x.place(self.found, {}).balls[name])]
            if len(inside) != 1 or not only_root(self.ring, equation, name, inside[0], hull):
                left += group
        return tuple(left)

    def _is_excluded(self, start: Sequence[float]) -> bool:
        """Whether some polynomial that must not vanish is about zero there: no root of this chart will be found."""
        at = dict.fromkeys(self.ring.names(), arb(0)) | {
            name: arb(x) for name, x in zip(self.occurring, start, strict=True)
        }
        return any(abs(float(self.ring.evaluate(x, at).mid())) < 1e-5 for x in self.nonzero)

    def _zero(self) -> Place:
        """The place where every coordinate is 0, exactly."""
        ring, zero, one = self.ring, fmpq_poly([0]), fmpq_poly([1])
        exact = {}
        for name in self.found.constant:
            exact[ring.index("coordinate", name)] = zero
            if name in ring.angles:
                exact |= {ring.index("sine", name): zero, ring.index("cosine", name): one}
        return Place(self.found, {}, exact | exact_rates(self.found), fmpq_poly([0, 1]))

    def _square_system(self) -> list[Polynomial] | None:
        """As many of the equations at rest as unknowns: those of the occurring coordinates."""
        ring, found = self.ring, self.found
        chosen = [
            ring.fraction(x)[0]
            for name, x in zip(found.system.coordinates, found.at_rest, strict=True)
            if name in self.occurring
        ]
        varying = any(len(list(self._for_all_times(x))) != 1 for x in chosen)
        others = [
            x for name, x in zip(found.system.coordinates, found.at_rest, strict=True) if name not in self.occurring
        ]
        if (
            varying
            or any(not x.is_zero() for x in others)
            or self.chart.restrictions
            or any(x.is_zero() for x in chosen)
        ):
            return None
        return chosen

    def _add_certified(self, box: Mapping[str, Any]) -> None:
        place = Place(self.found, box, {}, None)
        with ctx.workprec(PRECISION):
            if any(self.ring.evaluate(x, place.balls).contains(0) for x in self.nonzero):
                return
        if not self._may_rest(place):
            return
        if not self._known([float(box[name].mid()) for name in self.occurring], 1e-12):
            self._add(place, CERTIFIED)

    def _may_rest(self, place: Place) -> bool:
        """Whether no equation is proved not to vanish there: the second route of every list in balls."""
        with ctx.workprec(PRECISION):
            return all(self.ring.evaluate(x, place.balls).contains(0) for x in self.equations)

    def _same(self, one: Place, other: Place) -> bool:
        """Whether two places have coordinates that balls of PRECISION bits cannot tell apart."""
        ring = self.ring
        compared = [
            ring.generator(kind, name)
            for name in self.occurring
            for kind in (("sine", "cosine") if self._periodic(name) else ("coordinate",))
        ]
        return all(one.ball(x).overlaps(other.ball(x)) for x in compared)

    def _known(self, place: Sequence[float], tolerance: float) -> bool:
        """Whether a solution is listed already, within ``tolerance``."""
        return any(
            all(
                abs(turned(x - item.value, self.ring.angles[item.name]) if item.angle else x - item.value) < tolerance
                for x, item in zip(place, other.values, strict=True)
            )
            for other in self.points
        )

    def _periodic(self, name: str) -> bool:
        """Whether it occurs as an angle only: not outside of its sine and cosine, nor in a function or another sine."""
        return self.ring.has("sine", name) and self.ring.index("coordinate", name) not in self._reached

    @cached_property
    def _reached(self) -> frozenset[int]:
        """The generators of the equations and, however deep, those that adjoined ones are made of."""
        reached: set[int] = set()
        pending = [*occurring(self.equations)]
        while pending:
            k = pending.pop()
            if k not in reached:
                reached.add(k)
                argument = self.ring.generators[k].argument
                pending += [] if argument is None else [*occurring([argument])]
        return frozenset(reached)

    def _range(self, name: str, held: float | None = None) -> tuple[float, float]:
        """Where ``name`` is looked for; ``held`` is a proved bound."""
        if self._periodic(name):
            # Slightly more than a turn, and not symmetric: no root on the border.
            turn = math.pi * self.ring.angles[name]
            return -turn - 0.0123, turn + 0.0171
        farthest = self.within if held is None else held
        return -farthest - 0.00123, farthest + 0.00171

    # --- candidates ---

    def _add(self, place: Place, proof: str) -> None:
        self.points.append(self._candidate(place, proof))

    def _candidate(self, place: Place, proof: str) -> _Candidate:
        beyond = []
        for reflection in self._reflections:
            if place.balls[reflection.length] < 0 and reflection.same_forces:
                place = place.reflected(reflection.length, reflection.angle)
            elif place.balls[reflection.length] < 0:
                beyond.append(reflection.length)
        return _Candidate(self._values(place), self._features(place), proof, place, self, self.free, tuple(beyond))

    @cached_property
    def _reflections(self) -> tuple[Reflection, ...]:
        """Polar coordinates; none for the search of a family's points."""
        return reflections(self.found)

    def _values(self, place: Place) -> tuple[CoordinateValue, ...]:
        return tuple(self._value(place, name) for name in self.occurring)

    def _value(self, place: Place, name: str) -> CoordinateValue:
        ring, ball = self.ring, place.balls[name]
        periodic = self._periodic(name)
        value = float(ball.mid())
        if not periodic:
            residue = place.residue(ring.generator("coordinate", name))
            if residue is not None and residue.degree() <= 0:
                exact = Fraction(int(residue[0].p), int(residue[0].q))
                text = str(exact)
                return CoordinateValue(name, text if len(text) <= 14 else _short(value), value, False, len(text) <= 14)
            return CoordinateValue(name, _short(value), value, False, False)
        if proof_of := self._twelfths(place, name, value):
            return CoordinateValue(name, proof_of, value, True, True)
        value = turned(value, ring.angles[name])
        return CoordinateValue(name, _short(value), value, True, False)

    def _twelfths(self, place: Place, name: str, value: float) -> str:
        """``k*pi/12`` if the angle is such a multiple, proved by (cos + i sin)^24 = 1 in the number field."""
        s, c = (place.residue(self.ring.generator(kind, name)) for kind in ("sine", "cosine"))
        if s is None or c is None or self.ring.angles[name] != 1:
            return ""
        real, imaginary = fmpq_poly([1]), fmpq_poly([0])
        for _ in range(24):
            real, imaginary = (real * c - imaginary * s) % place.modulus, (real * s + imaginary * c) % place.modulus
        if real != fmpq_poly([1]) or imaginary != fmpq_poly([0]):
            return ""
        part = Fraction(round(12 * value / math.pi), 12)
        if part == 0:
            return "0"
        top = {1: "pi", -1: "-pi"}.get(part.numerator, f"{part.numerator}*pi")
        return top if part.denominator == 1 else f"{top}/{part.denominator}"

    def _features(self, place: Place) -> tuple[Any, ...]:
        """Direction cosines of the joints that have other angles; sines, cosines or values of the other coordinates."""
        features, done = [], set(self.free)
        for joint in self.chart.joints:
            cyclic = joint.angles[:1] * joint.first_free + joint.angles[2:] * joint.last_free
            if set(joint.angles) & set(self.free) - set(cyclic):
                continue
            features += [place.ball(x) for x in direction_features(self.found, joint)]
            done |= set(joint.angles)
        for name in self.found.constant:
            if name in done:
                continue
            if self._periodic(name):
                features += [place.ball(self.ring.generator(kind, name)) for kind in ("sine", "cosine")]
            else:
                features.append(place.balls[name])
        return tuple(features)

    # --- stability ---

    @cached_property
    def _linear(self) -> LinearAtRest | str:
        """The matrices as formulas, or why there are none."""
        try:
            return linear_at_rest(self.found)
        except Failure as reason:
            return str(reason)

    def verdict(self, place: Place) -> Verdict:
        """The verdict of problem 6 at a place."""
        if isinstance(self._linear, str):
            return undecided(Because.NO_EQUATIONS, self._linear)
        found = self._linear.verdict(place)
        ring, free = self.ring, self.free
        every = (x for rows in self._linear.matrices for row in rows for x in row)
        varying = tuple(dict.fromkeys(name for x in every for name in ring.dependencies(x, free)))
        if not varying or found.word is Word.UNDECIDED:
            return found
        # Any value of these is an equilibrium, but not the same first approximation.
        words = {self._linear.verdict(place.elsewhere(varying, t)).word for t in ELSEWHERE}
        names = ", ".join(varying)
        if words != {found.word}:
            told = " or ".join(sorted(words - {found.word}))
            return undecided(Because.DIFFERS_ALONG, names, found.word, told)
        return replace(found, reasons=(*found.reasons, Reason(Because.ALSO_ELSEWHERE, (names,))))


def _short(value: float) -> str:
    return f"{value + 0.0:.10g}" if abs(value) > 1e-15 else "0"
