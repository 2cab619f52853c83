"""Rests by bisection or from many starting points, each proved to exist and to be unique in a box (Krawczyk)."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra import krawczyk, rationals
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import enclosed
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.mechanics.rest import FARNESS
from mbsym.problems.relative_equilibria.listing import CERTIFIED, EXACT, STARTS, Listing, from_many_points, short
from mbsym.problems.relative_equilibria.orbits import Orbits
from mbsym.problems.relative_equilibria.place import PRECISION, Candidate, Place, candidates, exact_rates, only_root

#: Plain coordinates that no formula bounds are searched for in [-WITHIN, WITHIN], where no exact solution is possible.
WITHIN = 10.0
#: Farther out than this they are not searched for, even where it is proved that they are not farther out.
FARTHEST = 1_000.0
#: Boxes that a bisection looks at.
MOST_BOXES = 6_000
#: The same where constraints tie the unknowns, so that most of these boxes are soon done.
MOST_BOXES_TIED = 20_000
#: The same where it is asked whether anything is at rest far away: yes, where these do not do.
MOST_BOXES_FAR = 3_000
#: More unknowns than this are not searched for by bisection.
MOST_BISECTED = 3
#: Coordinates that constraints tie are searched for by bisection up to this many.
MOST_BISECTED_TIED = 8


@dataclass(frozen=True)
class Square:
    """As many equations as unknowns: coordinates, and multipliers of constraints, in which they are linear."""

    equations: tuple[Polynomial, ...]
    coordinates: tuple[str, ...]
    multipliers: tuple[str, ...] = ()
    #: How many of the equations, the last ones, are without multipliers.
    without: int = 0

    @property
    def tied(self) -> Square | None:
        """The equations without multipliers; None where there are no others."""
        return Square(self.equations[-self.without :], self.coordinates) if self.without else None

    def far(self, ring: Ring, name: str) -> Square | None:
        """What rests at large values of one coordinate q obey, with u = 1/q by its name and what bounds q elsewhere.

        The forces times u^d, multipliers times u^d are the unknowns.  None where q stands plainly in a constraint, in
        what adjoined generators are made of, or beside multipliers.
        """
        k, u = ring.index("coordinate", name), ring.index("prescribed", FARNESS)
        held = [ring.index("prescribed", x) for x in self.multipliers]
        forces = self.equations[: -self.without]
        degree = max(int(x.degrees()[k]) for x in forces)
        made_of = [g.argument for g in ring.generators if g.argument is not None]
        if degree <= 0 or any(x.degrees()[k] > 0 for x in (*self.equations[-self.without :], *made_of)):
            return None
        changed = []
        for x in forces:
            terms: dict[tuple[int, ...], Any] = {}
            for monomial, coefficient in x.terms():
                powers = [int(e) for e in monomial]
                if not any(powers[i] for i in held):
                    powers[u] = degree - powers[k]
                elif powers[k]:
                    return None
                powers[k] = 0
                terms[tuple(powers)] = coefficient
            changed.append(ring.context.from_dict(terms))
        return replace(self, equations=(*changed, *self.equations[-self.without :]))

    def functions(
        self, ring: Ring, fixed: Mapping[str, Any] | None = None
    ) -> tuple[krawczyk.Function, krawczyk.Jacobian]:
        """The equations and their derivatives over boxes, as straight-line programs.

        ``fixed``: balls for other names.
        """
        unknowns = (*self.coordinates, *self.multipliers)
        program = Program()
        carry = Carrier(ring, program, {name: program.input(name) for name in (*ring.names(), "pi")})
        values = [carry(x) for x in self.equations]
        slopes = [[carry(ring.derivative(x, name)) for name in unknowns] for x in self.equations]
        at_values = _over_boxes(program, values, unknowns, fixed or {})
        at_slopes = _over_boxes(program, [x for row in slopes for x in row], unknowns, fixed or {})
        n = len(unknowns)

        def jacobian(box: krawczyk.Box) -> list[list[Any]]:
            entries = list(at_slopes(box))
            return [entries[k : k + n] for k in range(0, len(entries), n)]

        return at_values, jacobian


_OPERATIONS: Mapping[str, Callable[..., Any]] = {
    "multiply": operator.mul,
    "add": operator.add,
    "subtract": operator.sub,
    "divide": operator.truediv,
    "negative": operator.neg,
}


def _over_boxes(
    program: Program, outputs: Sequence[Node], unknowns: Sequence[str], fixed: Mapping[str, Any]
) -> krawczyk.Function:
    """The outputs as a function of boxes; names that are neither unknowns nor ``fixed`` are 0.

    What each instruction does is looked up once.
    """
    places: dict[int, int] = {}
    known: list[Any] = []
    steps: list[tuple[int, Callable[..., Any], int, int]] = []
    inputs: list[tuple[int, int]] = []
    for place, number in enumerate(program.live(outputs)):
        places[number] = place
        operation, operands, payload = program.instructions[number]
        known.append(arb(0))
        if operands:
            does = _OPERATIONS.get(operation) or partial(enclosed, operation)
            first, second = places[operands[0]], places[operands[1]] if len(operands) > 1 else -1
            steps.append((place, does, first, second))
        elif operation == "constant":
            assert isinstance(payload, Fraction)
            with ctx.workprec(PRECISION):
                known[place] = rationals.ball(payload)
        elif payload in unknowns:
            inputs.append((place, unknowns.index(str(payload))))
        else:
            with ctx.workprec(PRECISION):
                known[place] = arb.pi() if payload == "pi" else fixed.get(str(payload), arb(0))
    output_places = [places[node.number] for node in outputs]

    def function(box: krawczyk.Box) -> list[Any]:
        values = known[:]
        for place, k in inputs:
            values[place] = box[k]
        for place, does, first, second in steps:
            values[place] = does(values[first]) if second < 0 else does(values[first], values[second])
        return [values[k] for k in output_places]

    return function


class SearchInBoxes(Listing):
    """The search where there is no exact solution, or beside an unfinished one."""

    def _search_numerically(self, bisect: bool) -> None:
        square = self._square_system()
        if square is None or not square.coordinates:
            self._incomplete("these equations cannot be searched numerically: they are not as many as their unknowns")
            return
        self._search_square(square, bisect)

    def search_whole(self) -> list[str]:
        """Rests wherever the constraints have their rank, of this case or another; what was left open."""
        known, self.doubts = self.doubts, []
        square = self._with_multipliers() if self.case.nonzero or self.case.whole else self._square_system()
        if square is not None and square.coordinates:
            self._search_square(square, bisect=not self.case.whole)
            if self.case.whole:
                self._found_from_points()
        else:
            self._search_numerically(bisect=False)
            if not self.doubts:
                self._found_from_points()
        left_open, self.doubts = self.doubts, known
        return left_open

    def _search_square(self, square: Square, bisect: bool) -> None:
        names, ring, independent = square.coordinates, self.ring, square.equations
        n, linear = len(names), len(square.multipliers)
        function, jacobian = square.functions(ring)
        nonzero = self.nonzero[len(self.case.nonzero) * bool(linear) :]  # with multipliers no pivot is assumed
        special = list(candidates(self.rest, names, self.equations)) if not self.chart.restrictions else []
        special = [x for x in special if not any(x.vanishes(y) for y in self.nonzero)]
        for candidate in special:
            place = candidate.place(self.rest, exact_rates(self.rest))
            if not self._known([float(place.balls[name].mid()) for name in names], 1e-12):
                self._add(place, EXACT)
        limited = [name for name in names if not self._periodic(name)]
        held = {k: x for k, x in reach(ring, independent, limited).items() if x <= FARTHEST}
        if bisect and linear:
            held |= self._reach_by_bisection(square, [name for name in limited if name not in held], held)
        bounds = [self._range(name, held.get(name)) for name in names]
        starts: list[list[float]] = []
        proved: tuple[krawczyk.Box, ...] = ()
        if bisect and n - linear <= MOST_BISECTED and n <= MOST_BISECTED_TIED:
            tied = None if square.tied is None else square.tied.functions(ring)
            most = MOST_BOXES_TIED if tied else MOST_BOXES
            result = krawczyk.search(function, jacobian, bounds, most, linear, tied)
            proved, left = result.roots, result.open_boxes
            if n == 1:
                left = self._unexplained(independent[0], left, special)
            if left:
                self._incomplete(
                    Message(
                        "[[count]] boxes of the bisection are undecided: there may be more equilibria", count=len(left)
                    )
                )
            starts += [[float(x.mid()) for x in box] for box in (*proved, *(() if linear else left[:200]))]
        elif bisect:
            self._found_from_points()
        if not self.complete or not bisect:
            following = self.rest.following if isinstance(self.rest, Orbits) else ()
            starts += from_many_points(ring, independent, names, bounds, square.multipliers, following)
        if bisect and limited:
            reached = ((name, short(self._range(name, held.get(name))[1])) for name in limited)
            ranges = joined((Message("[[name]] within [[range]]", name=name, range=far) for name, far in reached), ", ")
            if set(limited) <= held.keys():
                self.remarks.append(
                    Message(
                        "looked for with [[ranges]] of zero; the equations prove that none lies farther out",
                        ranges=ranges,
                    )
                )
            else:
                self._incomplete(Message("looked for with [[ranges]] of zero only", ranges=ranges))
        for number, start in enumerate(starts):
            if not bisect and (self._known(start[:n], 1e-6) or self._is_excluded(start[:n])):
                continue
            box = krawczyk.certified(function, jacobian, start, PRECISION)
            closely = box is not None and (
                number >= len(proved) or all(x.overlaps(y) for x, y in zip(box, proved[number], strict=True))
            )
            if number < len(proved) and not closely:
                self._incomplete("an equilibrium that was proved to exist could not be enclosed closely")
            if box is not None and all(
                low - 1e-9 <= float(x.mid()) <= high + 1e-9 for x, (low, high) in zip(box, bounds, strict=False)
            ):
                self._add_certified(dict(zip(names, box, strict=False)), nonzero)

    def _reach_by_bisection(
        self, square: Square, unbounded: Sequence[str], held: Mapping[str, float]
    ) -> dict[str, float]:
        """How far one coordinate that nothing else bounds can be from zero at rest, as an angle of any turn."""
        if len(unbounded) != 1 or self.ring.angles.get(unbounded[0]) is None:
            return {}
        (name,) = unbounded
        far = square.far(self.ring, name)
        if far is None or far.tied is None:
            return {}
        turn = math.pi * self.ring.angles[name]
        bounds = [(-turn, turn) if x == name else self._range(x, held.get(x)) for x in square.coordinates]
        reached = 2 * self.within
        functions = far.functions(self.ring, {FARNESS: arb(0, 1 / arb(reached))})
        tied = far.tied.functions(self.ring)
        result = krawczyk.search(*functions, bounds, MOST_BOXES_FAR, len(far.multipliers), tied)
        return {} if result.roots or result.open_boxes else {name: reached}

    def _found_from_points(self) -> None:
        self._incomplete(Message("searched for from [[count]] points: there may be more equilibria", count=STARTS))

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
            inside = [x for x in special if hull.contains(x.place(self.rest, {}).balls[name])]
            if len(inside) != 1 or not only_root(self.ring, equation, name, inside[0], hull):
                left += group
        return tuple(left)

    def _is_excluded(self, start: Sequence[float]) -> bool:
        """Whether some polynomial that must not vanish is about zero there: no root of this chart will be found."""
        at = dict.fromkeys(self.ring.names(), arb(0)) | {
            name: arb(x) for name, x in zip(self.occurring, start, strict=True)
        }
        return any(abs(float(self.ring.evaluate(x, at).mid())) < 1e-5 for x in self.nonzero)

    def _square_system(self) -> Square | None:
        """As many of the equations at rest as unknowns: those of the occurring coordinates."""
        ring, rest = self.ring, self.rest
        if rest.rows:
            square = len(self.equations) == len(self.occurring) and not self.case.zero and not self.chart.restrictions
            constraint_count = sum(not x.is_zero() for x in rest.kept)
            return (
                Square(
                    (*self.equations[constraint_count:], *self.equations[:constraint_count]),
                    self.occurring,
                    (),
                    constraint_count,
                )
                if square
                else None
            )
        chosen = [
            ring.fraction(x)[0]
            for name, x in zip(rest.system.coordinates, rest.at_rest, strict=True)
            if name in self.occurring
        ]
        varying = any(len(list(self._for_all_times(x))) != 1 for x in chosen)
        others = [
            x for name, x in zip(rest.system.coordinates, rest.at_rest, strict=True) if name not in self.occurring
        ]
        if (
            varying
            or any(not x.is_zero() for x in others)
            or self.chart.restrictions
            or any(x.is_zero() for x in chosen)
        ):
            return None
        return Square(tuple(chosen), self.occurring)

    def _with_multipliers(self) -> Square | None:
        """f + J^T lambda = 0, phi = 0: no pivot is assumed, so these are all positions in which J has its rank.

        None where some rows follow from others, so that nothing determines their multipliers.
        """
        ring, rest = self.ring, self.rest
        moving = [*rest.turning, *(item.name for item in rest.system.prescribed), "t"]
        redundant = self.ranks[1] is not None and self.ranks[1] < len(rest.rows)
        if (
            self.chart.restrictions
            or redundant
            or any(ring.dependencies(x, moving) for x in (*rest.balanced, *rest.kept))
        ):
            return None
        implied = rest.implied if isinstance(rest, Orbits) else None
        balanced = [x for i, x in enumerate(rest.balanced) if i != implied]
        forces, constraints = (
            [x for y in of if not (x := ring.fraction(y)[0]).is_zero()] for of in (balanced, rest.kept)
        )
        equations = [*forces, *constraints]
        coordinates, multipliers = (
            tuple(name for name in names if any(ring.depends_on(x, name) for x in equations))
            for names in (rest.constant, rest.multipliers)
        )
        square = len(equations) == len(coordinates) + len(multipliers) and coordinates == self.occurring
        return Square(tuple(equations), coordinates, multipliers, len(constraints)) if square else None

    def _add_certified(self, box: Mapping[str, Any], nonzero: Sequence[Polynomial]) -> None:
        place = Place(self.rest, box, {}, None)
        with ctx.workprec(PRECISION):
            if any(self.ring.evaluate(x, place.balls).contains(0) for x in nonzero):
                return
        if not self._may_rest(place):
            return
        if not self._known([float(box[name].mid()) for name in self.occurring], 1e-12):
            self._add(place, CERTIFIED)

    def _range(self, name: str, held: float | None = None) -> tuple[float, float]:
        """Where ``name`` is looked for; ``held`` is a proved bound."""
        if self._periodic(name):
            # Slightly more than a turn, and not symmetric: no root on the border.
            turn = math.pi * self.ring.angles[name]
            return -turn - 0.0123, turn + 0.0171
        farthest = self.within if held is None else held
        if held is None and isinstance(self.rest, Orbits) and name in self.rest.following:
            farthest = self.rest.fastest(self.within)
        return -farthest - 0.00123, farthest + 0.00171


# How far from zero coordinates can be at rest: bounds that the equations themselves prove.
#
# A torsional spring's moment k (q - q0) grows beyond everything that sines and cosines can set against it.  In an
# equation with the terms  a q^n  and others  c q^j y,  j < n, |y| <= 1 or bounded before,  every root has
#
#     |q| <= max(1, sum |c| bound(y) / |a|),      without the 1 where n = 1


#: Of the balls in which bounds are sought.
BITS = 128
#: Generators whose values lie in [-1, 1].
_BOUNDED_FUNCTIONS = ("tanh",)

#: A sum of terms: powers of the generators (pi is a number) and their coefficients in balls.
_Terms = dict[tuple[int, ...], Any]


def reach(ring: Ring, equations: Sequence[Polynomial], plain: Sequence[str]) -> dict[str, float]:
    """{q: b} such that |q| <= b at every common root of ``equations``, for those of ``plain`` that are bounded.

    ``plain`` are coordinates that occur outside sine and cosine.  Coordinates that are coupled linearly are taken
    apart first: with f = L q + (the rest), the equations L^-1 f are looked at, too.
    """
    at = {name: ring.index("coordinate", name) for name in plain}
    with ctx.workprec(BITS):
        sums = [_terms(ring, x) for x in equations]
        candidates = [*sums, *_decoupled(sums, list(at.values()))]
        known: dict[int, Any] = {}
        growing = True
        while growing:
            growing = False
            for k in at.values():
                if k in known:
                    continue
                bounds = [b for x in candidates if (b := _bound(ring, x, k, known)) is not None]
                if bounds:
                    known[k], growing = min(bounds, key=float), True
        return {name: float(known[k].upper()) * (1 + 1e-12) for name, k in at.items() if k in known}


def _terms(ring: Ring, x: Polynomial) -> _Terms:
    terms: _Terms = {}
    for monomial, coefficient in x.terms():
        powers, value = list(monomial), arb(coefficient)
        for k, e in enumerate(powers):
            if e and ring.generators[k].kind == "parameter" and ring.generators[k].name == "pi":
                value, powers[k] = value * arb.pi() ** int(e), 0
        key = tuple(int(e) for e in powers)
        terms[key] = terms.get(key, arb(0)) + value
    return terms


def _decoupled(sums: Sequence[_Terms], unknowns: Sequence[int]) -> list[_Terms]:
    """L^-1 f for as many equations f as unknowns whose linear parts L can be inverted; else nothing."""
    if not sums or not unknowns:
        return []
    size = len(next(iter(sums[0])))
    units = [tuple(int(i == k) for i in range(size)) for k in unknowns]
    rows = [x for x in sums if any(unit in x for unit in units)]
    if len(rows) != len(unknowns):
        return []
    try:
        inverse = arb_mat([[x.get(unit, arb(0)) for unit in units] for x in rows]).inv()
    except ZeroDivisionError:
        return []
    decoupled = []
    for i in range(len(rows)):
        total: _Terms = {}
        for j, x in enumerate(rows):
            for key, value in x.items():
                total[key] = total.get(key, arb(0)) + inverse[i, j] * value
        for j, unit in enumerate(units):
            total[unit] = arb(int(i == j))
        decoupled.append({key: value for key, value in total.items() if not value.is_zero()})
    return decoupled


def _bound(ring: Ring, x: _Terms, unknown: int, known: Mapping[int, Any]) -> Any:
    """The bound that one equation proves for one coordinate, as a ball; None where it proves none."""
    degree = max(key[unknown] for key in x)
    top = [key for key in x if key[unknown] == degree]
    if degree == 0 or len(top) != 1 or sum(top[0]) != degree or not abs(x[top[0]]) > 0:
        return None
    total = arb(0)
    for key, value in x.items():
        if key == top[0] or (degree % 2 == 0 and _never_against(key, value, x[top[0]])):
            continue
        size = abs(value)
        for k, e in enumerate(key):
            if e and k != unknown:
                largest = known.get(k) or _largest(ring, k)
                if largest is None:
                    return None
                size = size * largest**e
        total = total + size
    ratio = arb((total / abs(x[top[0]])).upper())
    return ratio if degree == 1 else ratio.max(arb(1))


def _never_against(key: tuple[int, ...], value: Any, other: Any) -> bool:
    """Whether a term has only even powers and the sign of another coefficient: beside that it makes no root larger."""
    return all(e % 2 == 0 for e in key) and bool(value * other > 0)


def _largest(ring: Ring, index: int) -> Any:
    g = ring.generators[index]
    if (value := ring.constant_value(ring.context.gen(index))) is not None:
        return abs(value)
    if g.kind in ("sine", "cosine") or (g.kind == "function" and g.name in _BOUNDED_FUNCTIONS):
        return arb(1)
    return None
