"""All relative equilibria of a system with numerical parameters.

A relative equilibrium is a motion on which every coordinate is constant, except those that the description lets turn
at a constant rate; prescribed quantities go on running.  With  M(q) q'' = f(q, q', t)  it solves

    f_i(q, rates, t) = 0,        i = 1..n,  identically in t

Where the f_i are polynomials in sines, cosines and plain coordinates (roots and reciprocals included), the system with
s^2 + c^2 = 1 for every angle is solved exactly (``algebra.polynomial_systems``): a solution is a point of a number
field, every f_i is zero there exactly, and the list is complete.  Where they are not (an angle that also stands outside
sine and cosine, exponentials), or where the exact solution outgrows its limits, solutions are found by bisection or
from many starting points, each is proved to exist and to be unique in a box (Krawczyk), and the list **may be
incomplete**; the result says so.

Angles that are singular somewhere (a gimbal) are replaced there by others, so that no orientation is lost, and
coordinates that describe one configuration twice are counted once.

Each equilibrium is judged by the theorems of problem 6: at rational sines and cosines by exact counting, otherwise by
enclosures of the roots.  Solutions that are not isolated are families.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz

from mbsym.algebra import krawczyk
from mbsym.algebra.base import NoClosedForm, SingularPoint
from mbsym.algebra.polynomial_systems import (
    AlgebraicPoint,
    Family,
    Limits,
    context,
    inverse_modulo,
    solve,
)
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.python import python_text
from mbsym.mechanics.charts import Chart, charts, moments, rows
from mbsym.mechanics.rest import Rest, at_numbers, rest
from mbsym.model.system import System
from mbsym.problems import energy as energies
from mbsym.problems.enclosed_stability import MASS_SINGULAR, blocks, enclosed_verdict_with_cyclic
from mbsym.problems.stability import conserves_energy
from mbsym.problems.stability_theory import (
    ASYMPTOTIC,
    ASYMPTOTIC_BUT_CYCLIC,
    CRITICAL,
    GYROSCOPIC,
    STABLE,
    STABLE_BUT_CYCLIC,
    UNDECIDED,
    UNSTABLE,
    LinearSystem,
    Verdict,
    combine,
    verdict_at,
)

EXACT, CERTIFIED = "exact", "proved in a box"

#: Plain coordinates that no formula bounds are searched for in [-WITHIN, WITHIN], where no exact solution is possible.
WITHIN = 10.0
#: Working precision of enclosures, in bits.
PRECISION = 200
#: Boxes that a bisection looks at.
MOST_BOXES = 6_000
#: Starting points of a search from many points.
STARTS = 400
#: More unknowns than this are not searched for by bisection.
MOST_BISECTED = 3
_SEED = 1788


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
    """

    values: tuple[CoordinateValue, ...]
    proof: str
    verdict: Verdict
    coordinates_of: str = ""
    free: tuple[str, ...] = ()
    described: int = 1


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

    ``turning`` are the coordinates that turn at the description's rates, ``charts`` how many sets of angles were used.
    """

    equilibria: tuple[RelativeEquilibrium, ...]
    families: tuple[EquilibriumFamily, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: tuple[tuple[str, float], ...] = ()
    charts: int = 1


def equilibria(
    system: System, values: Mapping[str, Fraction], within: float = WITHIN, limits: Limits | None = None
) -> Equilibria:
    """All relative equilibria of a system at parameter values.

    Raises KeyError for a missing value, NoClosedForm where the equations outgrow their budget, SingularPoint.
    """
    first = rest(at_numbers(system, values))
    remarks: list[str] = []
    found: list[_Candidate] = []
    families: list[EquilibriumFamily] = []
    complete = True
    covering = charts(first)
    for chart in covering:
        search = _ChartSearch(chart, within, limits or Limits())
        search.run()
        if families and chart.restrictions:
            search.points = _off_families(search, within, limits or Limits())
        found += search.points
        families += search.families
        remarks += search.remarks
        complete = complete and search.complete
        if not search.equations and not search.impossible:  # everywhere: other angles have nothing to add
            break
    listed = [_described(group) for group in _groups(found)]
    listed.sort(key=lambda x: (_ORDER.get(x.verdict.word, 9), x.coordinates_of, _sort_key(x)))
    verdicts = [x.verdict for x in listed] + [x.verdict for x in families]
    if any(verdict.explanation == MASS_SINGULAR for verdict in verdicts):
        remarks.append(
            "where the mass matrix is singular so are the coordinates: such a solution need not be an equilibrium, "
            "and its stability is to be seen in other coordinates"
        )
    if families and covering[0].joints:
        remarks.append("families are listed in coordinates: one set of configurations may be described more than once")
    turning = tuple(
        (name, float(first.ring.evaluate(first.rates[first.ring.index("velocity", name)], {}).mid()))
        for name in first.turning
    )
    return Equilibria(tuple(listed), tuple(families), complete, tuple(dict.fromkeys(remarks)), turning, len(covering))


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


_ORDER = {
    word: k
    for k, word in enumerate(
        (ASYMPTOTIC, ASYMPTOTIC_BUT_CYCLIC, STABLE, STABLE_BUT_CYCLIC, GYROSCOPIC, CRITICAL, UNDECIDED, UNSTABLE)
    )
}


def _sort_key(x: RelativeEquilibrium) -> tuple[tuple[float, float], ...]:
    return tuple((round(abs(item.value), 9), -item.value) for item in x.values)


# --- places ----------------------------------------------------------------------------------------------------------


class _Place:
    """Where the matrices are evaluated: values of coordinates as balls, and exactly where they are algebraic."""

    def __init__(self, found: Rest, balls: Mapping[str, Any], exact: Mapping[int, Any], modulus: Any) -> None:
        self.ring = found.ring
        self.modulus = modulus
        self._exact = dict(exact)
        names = dict.fromkeys(found.ring.names(), arb(0))
        for entry in found.system.coordinates:
            names[entry + "_dot"] = found.ring.evaluate(found.rates[found.ring.index("velocity", entry)], names)
        self.balls = names | dict(balls)

    def ball(self, x: Polynomial) -> Any:
        """An enclosure; exactly 0 where the value is proved to vanish."""
        residue = self.residue(x)
        if residue is not None and residue.degree() <= 0:
            return arb(residue[0])
        keep, ctx.prec = ctx.prec, PRECISION
        try:
            return self.ring.evaluate(x, self.balls)
        finally:
            ctx.prec = keep

    def residue(self, x: Polynomial) -> Any:
        """The value in the number field, or None where it is not known to lie there."""
        if x.is_zero():
            return fmpq_poly([0])
        if self.modulus is None:
            return fmpq_poly([x.leading_coefficient()]) if x.is_constant() else None
        total = fmpq_poly([0])
        used = [k for k, degree in enumerate(x.degrees()) if degree > 0]
        generators = {k: self._generator(k) for k in used}
        if any(value is None for value in generators.values()):
            return None
        for monomial, coefficient in x.terms():
            term = fmpq_poly([coefficient])
            for k in used:
                for _ in range(int(monomial[k])):
                    term = term * generators[k] % self.modulus
            total += term
        return total % self.modulus

    def _generator(self, index: int) -> Any:
        if index not in self._exact:
            g = self.ring.generators[index]
            value = None
            if g.kind == "reciprocal":
                inner = self.residue(g.argument)
                value = None if inner is None or inner == 0 else inverse_modulo(inner, self.modulus)
            self._exact[index] = value
        return self._exact[index]


@dataclass(frozen=True)
class _Candidate:
    """A solution in one chart; ``features`` are numbers that belong to the configuration, whatever the coordinates."""

    values: tuple[CoordinateValue, ...]
    features: tuple[Any, ...]
    proof: str
    place: _Place
    chart: _ChartSearch
    free: tuple[str, ...]


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
    return RelativeEquilibrium(best.values, best.proof, judged, best.chart.chart.label, best.free, len(group))


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
        self.points_at_zero = False
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
        used = {k for x in self.equations for k, degree in enumerate(x.degrees()) if degree > 0}
        self.occurring = tuple(name for name in found.constant if any(ring.depends_on(x, name) for x in self.equations))
        self.free = tuple(name for name in found.constant if name not in self.occurring)
        usual = [
            x
            for x in self.chart.nonzero
            if any(d > 0 and ring.generators[k].name in self.occurring for k, d in enumerate(x.degrees()))
        ]
        self.nonzero += usual
        self.reason = self._obstacle(used)

    def _for_all_times(self, x: Polynomial) -> Iterator[Polynomial]:
        """What must vanish so that x does at all times: its coefficients with respect to what moves."""
        ring = self.ring
        moving = [*self.found.turning, *(item.name for item in self.found.system.prescribed), "t"]
        present = ring.dependencies(x, moving)
        if not present:
            yield x
            return
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
                return f"{'sine and cosine' if g.kind != 'function' else g.name} of something that is no angle"
            if g.argument is not None:
                pending += [i for i, degree in enumerate(g.argument.degrees()) if degree > 0]
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
        table = _Variables(self.ring, self.equations)
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
            reasons = "; ".join(result.unfinished)
            self._incomplete(
                f"the exact solution is not finished ({reasons}); the rest was searched for from {STARTS} points"
            )
            self._search_numerically(bisect=False)

    def _place(self, table: _Variables, point: AlgebraicPoint) -> _Place:
        ring = self.ring
        exact = dict(zip(table.indices, point.values, strict=True))
        balls = {}
        for name in self.occurring:
            if ring.has("sine", name) and ring.index("sine", name) in exact:
                s, c = (point.enclosure(exact[ring.index(kind, name)], PRECISION) for kind in ("sine", "cosine"))
                balls[name] = _angle(s, c) * ring.angles[name]
            else:
                balls[name] = point.enclosure(exact[ring.index("coordinate", name)], PRECISION)
        for name in self.free:  # any value does; 0 is one
            exact |= {ring.index("coordinate", name): fmpq_poly([0])}
            if name in ring.angles:
                exact |= {ring.index("sine", name): fmpq_poly([0]), ring.index("cosine", name): fmpq_poly([1])}
        return _Place(self.found, balls, exact | self._exact_rates(), point.modulus)

    def _exact_rates(self) -> dict[int, Any]:
        rates = {k: rate for k, rate in self.found.rates.items() if rate.is_constant()}
        return {k: fmpq_poly([rate.leading_coefficient() if rate else 0]) for k, rate in rates.items()}

    def _add_free_point(self) -> None:
        self._add(self._zero(), EXACT)
        self.remarks.append("every position is an equilibrium")

    def _add_family(self, table: _Variables, family: Family) -> None:
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

        bounds = [self._range(name) for name in names]
        starts: Iterable[Sequence[float]]
        if bisect and n <= MOST_BISECTED:
            result = krawczyk.search(function, jacobian, bounds, MOST_BOXES)
            starts = [[float(x.mid()) for x in box] for box in (*result.roots, *result.open_boxes[:200])]
            if result.open_boxes:
                self._incomplete(
                    f"{len(result.open_boxes)} boxes of the bisection are undecided: there may be more equilibria"
                )
        else:
            starts = _from_many_points(ring, independent, slopes, names, bounds)
            if bisect:
                self._incomplete(f"searched for from {STARTS} points: there may be more equilibria")
        limited = [name for name in names if not self._periodic(name)]
        if bisect and limited:
            ranges = ", ".join(f"{name} within {_short(self._range(name)[1])}" for name in limited)
            self._incomplete(f"looked for with {ranges} of zero only")
        for start in starts:
            if not bisect and (self._known(start, 1e-6) or self._is_excluded(start)):
                continue
            box = krawczyk.certified(function, jacobian, start, PRECISION)
            if box is not None and all(
                low - 1e-9 <= float(x.mid()) <= high + 1e-9 for x, (low, high) in zip(box, bounds, strict=True)
            ):
                self._add_certified(dict(zip(names, box, strict=True)))

    def _is_excluded(self, start: Sequence[float]) -> bool:
        """Whether some polynomial that must not vanish is about zero there: no root of this chart will be found."""
        at = dict.fromkeys(self.ring.names(), arb(0)) | {
            name: arb(x) for name, x in zip(self.occurring, start, strict=True)
        }
        return any(abs(float(self.ring.evaluate(x, at).mid())) < 1e-5 for x in self.nonzero)

    def _zero(self) -> _Place:
        """The place where every coordinate is 0, exactly."""
        ring, zero, one = self.ring, fmpq_poly([0]), fmpq_poly([1])
        exact = {}
        for name in self.found.constant:
            exact[ring.index("coordinate", name)] = zero
            if name in ring.angles:
                exact |= {ring.index("sine", name): zero, ring.index("cosine", name): one}
        return _Place(self.found, {}, exact | self._exact_rates(), fmpq_poly([0, 1]))

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
        if all(x.contains(0) for x in box.values()) and not self.points_at_zero:
            place = self._zero()
            if all((value := place.residue(x)) is not None and value == 0 for x in self.equations):
                self.points_at_zero = True
                if not self._known([0.0] * len(self.occurring), 1e-12):
                    self._add(place, EXACT)
                return
        place = _Place(self.found, box, {}, None)
        keep, ctx.prec = ctx.prec, PRECISION
        try:
            if any(self.ring.evaluate(x, place.balls).contains(0) for x in self.nonzero):
                return
            if any(not self.ring.evaluate(x, place.balls).contains(0) for x in self.equations):
                return
        finally:
            ctx.prec = keep
        if not self._known([float(box[name].mid()) for name in self.occurring], 1e-12):
            self._add(place, CERTIFIED)

    def _known(self, place: Sequence[float], tolerance: float) -> bool:
        """Whether a solution is listed already, within ``tolerance``."""
        return any(
            all(
                abs(_turned(x - item.value, self.ring.angles[item.name]) if item.angle else x - item.value) < tolerance
                for x, item in zip(place, other.values, strict=True)
            )
            for other in self.points
        )

    def _periodic(self, name: str) -> bool:
        used = {k for x in self.equations for k, degree in enumerate(x.degrees()) if degree > 0}
        return self.ring.has("sine", name) and self.ring.index("coordinate", name) not in used

    def _range(self, name: str) -> tuple[float, float]:
        if self._periodic(name):
            # Slightly more than a turn, and not symmetric: no root on the border.
            turn = math.pi * self.ring.angles[name]
            return -turn - 0.0123, turn + 0.0171
        return -self.within - 0.00123, self.within + 0.00171

    # --- candidates ---

    def _add(self, place: _Place, proof: str) -> None:
        self.points.append(self._candidate(place, proof))

    def _candidate(self, place: _Place, proof: str) -> _Candidate:
        return _Candidate(self._values(place), self._features(place), proof, place, self, self.free)

    def _values(self, place: _Place) -> tuple[CoordinateValue, ...]:
        return tuple(self._value(place, name) for name in self.occurring)

    def _value(self, place: _Place, name: str) -> CoordinateValue:
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
        value = _turned(value, ring.angles[name])
        return CoordinateValue(name, _short(value), value, True, False)

    def _twelfths(self, place: _Place, name: str, value: float) -> str:
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

    def _features(self, place: _Place) -> tuple[Any, ...]:
        """Direction cosines of the joints that have other angles; sines, cosines or values of the other coordinates."""
        features, done = [], set(self.free)
        for joint in self.chart.joints:
            if set(joint.angles) & set(self.free):
                continue
            matrix = rows(self.found, joint)
            wanted = (matrix[joint.axes[2] - 1],) if joint.direction_only else matrix
            features += [place.ball(x) for row in wanted for x in row]
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
    def _linear(self) -> _Linear | str:
        """The matrices as formulas, or why there are none."""
        try:
            return _linear(self.found)
        except (NoClosedForm, SingularPoint) as reason:
            return str(reason)

    def verdict(self, place: _Place) -> Verdict:
        """The verdict of problem 6 at a place."""
        if isinstance(self._linear, str):
            return Verdict(UNDECIDED, "", self._linear)
        return self._linear.verdict(place)


def _angle(s: Any, c: Any) -> Any:
    keep, ctx.prec = ctx.prec, PRECISION
    try:
        if c < 0 and s.contains(0):  # atan2 is cut here
            return arb.pi() - (s / -c).atan()
        return arb.atan2(s, c)
    finally:
        ctx.prec = keep


def _turned(value: float, denominator: int = 1) -> float:
    """The same angle in (-pi, pi]."""
    period = 2 * math.pi * denominator
    return value - period * math.ceil((value - period / 2) / period - 1e-12)


def _short(value: float) -> str:
    return f"{value + 0.0:.10g}" if abs(value) > 1e-15 else "0"


# --- polynomial variables --------------------------------------------------------------------------------------------


class _Variables:
    """Which generators of the ring are unknowns, and the way into integer polynomials in them."""

    def __init__(self, ring: Ring, equations: Sequence[Polynomial]) -> None:
        self.ring = ring
        used = {k for x in equations for k, degree in enumerate(x.degrees()) if degree > 0}
        pending = list(used)
        while pending:
            g = ring.generators[pending.pop()]
            more: set[int] = set()
            if g.argument is not None:
                more = {k for k, degree in enumerate(g.argument.degrees()) if degree > 0}
            elif g.kind in ("sine", "cosine"):
                more = {ring.index("sine", g.name), ring.index("cosine", g.name)}
            pending += more - used
            used |= more
        self.indices = sorted(used)
        letters = {"sine": "sin", "cosine": "cos"}
        self.names = []
        for k in self.indices:
            g = ring.generators[k]
            name = f"{g.name}/{g.denominator}" if g.denominator != 1 else g.name
            if g.argument is not None:
                written = python_text(ring, ring.context.gen(k))
                self.names.append(written if g.kind == "root" else f"({written})")
            else:
                self.names.append(f"{letters[g.kind]}({name})" if g.kind in letters else name)
        self.context = context([f"x{k}" for k in range(len(self.indices))])

    def holds(self, x: Polynomial) -> bool:
        return all(k in self.indices for k, degree in enumerate(x.degrees()) if degree > 0)

    def polynomial(self, x: Polynomial) -> Any:
        """x times a positive integer."""
        common = math.lcm(*(int(c.q) for c in x.coeffs()))
        terms = {tuple(m[k] for k in self.indices): fmpz(int((c * common).p)) for m, c in x.terms()}
        return self.context.from_dict(terms)

    def back(self, x: Any) -> Polynomial:
        """An integer polynomial in the unknowns, in the ring."""
        terms = {}
        for monomial, coefficient in x.terms():
            exponents = [0] * len(self.ring.generators)
            for k, e in zip(self.indices, monomial, strict=True):
                exponents[k] = int(e)
            terms[tuple(exponents)] = fmpq(coefficient)
        return self.ring.context.from_dict(terms)

    def relations(self) -> list[Any]:
        """s^2 + c^2 = 1 of every angle, root^2 = radicand, x * reciprocal = 1."""
        ring, found = self.ring, []
        for k in self.indices:
            g = ring.generators[k]
            one = ring.context.gen(k)
            if g.kind == "sine":
                found.append(one**2 + ring.generator("cosine", g.name) ** 2 - 1)
            elif g.kind == "root":
                found.append(one**2 - g.argument)
            elif g.kind == "reciprocal":
                found.append(one * g.argument - 1)
        return [self.polynomial(x) for x in found]

    def is_relation(self, x: Any) -> bool:
        return any(x == y or x == -y for y in self.relations())

    def bounded(self) -> list[int]:
        return [i for i, k in enumerate(self.indices) if self.ring.generators[k].kind in ("sine", "cosine")]

    def roots_agree(self, point: AlgebraicPoint) -> bool:
        """Whether every square root is not negative."""
        for i, k in enumerate(self.indices):
            is_root = self.ring.generators[k].kind == "root" and point.values[i] != 0
            if is_root and point.enclosure(point.values[i], PRECISION) < 0:
                return False
        return True

    def text(self, x: Any) -> str:
        """A polynomial as a reader writes it."""
        parts = []
        for monomial, coefficient in x.terms():
            factors = [name if e == 1 else f"{name}**{e}" for name, e in zip(self.names, monomial, strict=True) if e]
            number = int(coefficient)
            if not factors or abs(number) != 1:
                factors.insert(0, str(abs(number)))
            parts.append(("-" if number < 0 else "+", "*".join(factors)))
        first, *others = parts
        return ("-" if first[0] == "-" else "") + first[1] + "".join(f" {sign} {term}" for sign, term in others)


# --- many starting points --------------------------------------------------------------------------------------------


def _from_many_points(
    ring: Ring,
    equations: Sequence[Polynomial],
    slopes: Sequence[Sequence[Polynomial]],
    names: Sequence[str],
    bounds: Sequence[tuple[float, float]],
) -> list[list[float]]:
    """Where damped Newton iterations from random points end, without repetition; found, not proved."""
    import numpy as np

    source = np.random.default_rng(_SEED)
    n = len(names)
    q = np.array([source.uniform(low, high, STARTS) for low, high in bounds])
    value = _vectorised(ring, [*equations, *(x for row in slopes for x in row)], names)
    for _ in range(60):
        with np.errstate(all="ignore"):
            found = np.array(value(q))
        f, jacobian = found[:n], found[n:].reshape(n, n, -1)
        matrices = np.moveaxis(jacobian, 2, 0)
        usable = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(f).all(axis=0)
        change = np.zeros_like(q)
        damping = 1e-14 * np.eye(n)
        normal = np.einsum("kji,kjl->kil", matrices[usable], matrices[usable])
        scale = np.trace(normal, axis1=1, axis2=2)[:, None, None] + 1e-300
        right = np.einsum("kji,jk->ki", matrices[usable], f[:, usable])
        change[:, usable] = -np.linalg.solve(normal + scale * damping, right[..., None])[..., 0].T
        length = np.sqrt((change**2).sum(axis=0))
        q = q + change * np.minimum(1.0, 0.7 / np.maximum(length, 1e-300))
    ends: dict[tuple[float, ...], list[float]] = {}
    for k in range(STARTS):
        if usable[k] and length[k] < 1e-8:
            point = [float(x) for x in q[:, k]]
            for i, name in enumerate(names):
                if bounds[i][1] - bounds[i][0] > 2 * math.pi * ring.angles.get(name, 10**6):
                    point[i] = _turned(point[i], ring.angles[name])
            ends.setdefault(tuple(round(x, 6) for x in point), point)
    return [ends[key] for key in sorted(ends)]


def _vectorised(ring: Ring, polynomials: Sequence[Polynomial], names: Sequence[str]) -> Callable[[Any], list[Any]]:
    """Values of polynomials at many points at once."""
    import numpy as np

    tables = [
        [(float(Fraction(int(c.p), int(c.q))), [(k, int(e)) for k, e in enumerate(m) if e]) for m, c in x.terms()]
        for x in polynomials
    ]

    def generator(index: int, q: Any, known: dict[int, Any]) -> Any:
        if index in known:
            return known[index]
        g = ring.generators[index]
        if g.argument is not None:
            table = [
                (float(Fraction(int(c.p), int(c.q))), [(k, int(e)) for k, e in enumerate(m) if e])
                for m, c in g.argument.terms()
            ]
            inner = total(table, q, known)
            outer: dict[str, Callable[[Any], Any]] = {
                "sine": np.sin,
                "cosine": np.cos,
                "root": np.sqrt,
                "reciprocal": lambda x: 1 / x,
                "exp": np.exp,
                "log": np.log,
                "atan": np.arctan,
            }
            known[index] = outer[g.name if g.kind == "function" else g.kind](inner)
        elif g.name == "pi":
            known[index] = np.pi
        else:
            plain = q[names.index(g.name)] if g.name in names else np.zeros(q.shape[1])
            inner = plain / g.denominator
            known[index] = {"sine": np.sin, "cosine": np.cos}.get(g.kind, lambda x: x)(inner)
        return known[index]

    def total(table: Sequence[tuple[float, list[tuple[int, int]]]], q: Any, known: dict[int, Any]) -> Any:
        result = np.zeros(q.shape[1])
        for coefficient, powers in table:
            term: Any = coefficient
            for index, exponent in powers:
                base = generator(index, q, known)
                term = term * (base if exponent == 1 else base**exponent)
            result = result + term
        return result

    def values(q: Any) -> list[Any]:
        known: dict[int, Any] = {}
        return [total(table, q, known) for table in tables]

    return values


# --- linearisation ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Linear:
    """M, D, G, K, N as formulas in the coordinates, valid wherever f vanishes."""

    matrices: tuple[Sequence[Sequence[Polynomial]], ...]
    conservative: bool
    cyclic: tuple[int, ...]
    varying: tuple[str, ...]

    def verdict(self, place: _Place) -> Verdict:
        if self.varying:
            why = f"The first approximation varies with {', '.join(self.varying)}; nothing is claimed."
            return Verdict(UNDECIDED, "", why)
        values = [[[place.ball(x) for x in row] for row in rows_] for rows_ in self.matrices]
        exact = [[[place.residue(x) for x in row] for row in rows_] for rows_ in self.matrices]
        rational = all(x is not None and x.degree() <= 0 for rows_ in exact for row in rows_ for x in row)
        verdicts = []
        for indices in blocks(*values):
            cyclic = tuple(
                at
                for at, i in enumerate(indices)
                if i in self.cyclic and all(values[m][i][j] == 0 for m in (3, 4) for j in indices)
            )
            if rational:
                parts = [[[exact[m][i][j][0] for j in indices] for i in indices] for m in range(5)]
                verdicts.append(_rational_verdict(parts, self.conservative, cyclic))
            else:
                parts = [[[values[m][i][j] for j in indices] for i in indices] for m in range(5)]
                verdicts.append(enclosed_verdict_with_cyclic(parts, self.conservative, cyclic, PRECISION))
        # Singular coordinates make every other part of the linear equations meaningless.
        return next((v for v in verdicts if v.explanation == MASS_SINGULAR), None) or combine(verdicts)


def _linear(found: Rest) -> _Linear:
    """M = mass matrix, D + G = -df/dq', K + N = -df/dq, on the steady motions."""
    ring, names = found.ring, found.system.coordinates
    rates = dict(found.rates)
    half = ring.number(Fraction(1, 2))
    n = range(len(names))
    mass = found.mass_matrix()
    velocity = [
        [-ring.substitute(ring.velocity_derivative(f, name), dict(rates)) for name in names] for f in found.forcing
    ]
    position = [[-ring.derivative(f, name) for name in names] for f in found.at_rest]
    moving = [*found.turning, *(item.name for item in found.system.prescribed), "t"]
    every = (x for rows_ in (mass, velocity, position) for row in rows_ for x in row)
    varying = tuple(dict.fromkeys(name for x in every for name in ring.dependencies(x, moving)))
    scene = found.scene
    try:
        known = energies.energy(scene)
    except (NoClosedForm, SingularPoint):
        known = None
    cyclic = tuple(i for i, name in enumerate(names) if known is not None and name in known.cyclic)
    parts = (
        mass,
        [[ring.reduce(half * (velocity[i][j] + velocity[j][i])) for j in n] for i in n],
        [[ring.reduce(half * (velocity[i][j] - velocity[j][i])) for j in n] for i in n],
        [[ring.reduce(half * (position[i][j] + position[j][i])) for j in n] for i in n],
        [[ring.reduce(half * (position[i][j] - position[j][i])) for j in n] for i in n],
    )
    return _Linear(parts, conserves_energy(scene, known), cyclic, varying)


_CONSTANTS = fmpq_mpoly_ctx.get(["unused"])


def _rational_verdict(
    parts: Sequence[Sequence[Sequence[fmpq]]], conservative: bool, cyclic: tuple[int, ...]
) -> Verdict:
    """By exact counting of roots."""
    made = [tuple(tuple(_CONSTANTS.constant(x) for x in row) for row in rows_) for rows_ in parts]
    found = verdict_at(LinearSystem(made[0], made[1], made[2], made[3], made[4], conservative, cyclic), {}).verdict
    return replace(found, explanation=MASS_SINGULAR) if found.explanation == "The mass matrix is singular." else found
