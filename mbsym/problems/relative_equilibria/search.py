"""Rests by bisection or from many starting points, each proved to exist and to be unique in a box (Krawczyk)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra import krawczyk
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.problems.relative_equilibria.listing import CERTIFIED, EXACT, STARTS, Listing, from_many_points, short
from mbsym.problems.relative_equilibria.place import PRECISION, Candidate, Place, candidates, exact_rates, only_root

#: Plain coordinates that no formula bounds are searched for in [-WITHIN, WITHIN], where no exact solution is possible.
WITHIN = 10.0
#: Farther out than this they are not searched for, even where it is proved that they are not farther out.
FARTHEST = 1_000.0
#: Boxes that a bisection looks at.
MOST_BOXES = 6_000
#: More unknowns than this are not searched for by bisection.
MOST_BISECTED = 3


class SearchInBoxes(Listing):
    """The search where there is no exact solution, or beside an unfinished one."""

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
                self._incomplete(
                    Message(
                        "[[count]] boxes of the bisection are undecided: there may be more equilibria", count=len(left)
                    )
                )
            starts += [[float(x.mid()) for x in box] for box in (*proved, *left[:200])]
        elif bisect:
            self._incomplete(Message("searched for from [[count]] points: there may be more equilibria", count=STARTS))
        if not proved and (not starts or not bisect):
            starts += from_many_points(ring, independent, slopes, names, bounds)
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

    def _square_system(self) -> list[Polynomial] | None:
        """As many of the equations at rest as unknowns: those of the occurring coordinates."""
        ring, found = self.ring, self.found
        if found.rows:
            square = len(self.equations) == len(self.occurring) and not self.case.zero and not self.chart.restrictions
            return list(self.equations) if square else None
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

    def _range(self, name: str, held: float | None = None) -> tuple[float, float]:
        """Where ``name`` is looked for; ``held`` is a proved bound."""
        if self._periodic(name):
            # Slightly more than a turn, and not symmetric: no root on the border.
            turn = math.pi * self.ring.angles[name]
            return -turn - 0.0123, turn + 0.0171
        farthest = self.within if held is None else held
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
    found: _Terms = {}
    for monomial, coefficient in x.terms():
        powers, value = list(monomial), arb(coefficient)
        for k, e in enumerate(powers):
            if e and ring.generators[k].kind == "parameter" and ring.generators[k].name == "pi":
                value, powers[k] = value * arb.pi() ** int(e), 0
        key = tuple(int(e) for e in powers)
        found[key] = found.get(key, arb(0)) + value
    return found


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
    found = []
    for i in range(len(rows)):
        total: _Terms = {}
        for j, x in enumerate(rows):
            for key, value in x.items():
                total[key] = total.get(key, arb(0)) + inverse[i, j] * value
        for j, unit in enumerate(units):
            total[unit] = arb(int(i == j))
        found.append({key: value for key, value in total.items() if not value.is_zero()})
    return found


def _bound(ring: Ring, x: _Terms, unknown: int, known: Mapping[int, Any]) -> Any:
    """The bound that one equation proves for one coordinate, as a ball; None where it proves none."""
    degree = max(key[unknown] for key in x)
    top = [key for key in x if key[unknown] == degree]
    if degree == 0 or len(top) != 1 or sum(top[0]) != degree or not abs(x[top[0]]) > 0:
        return None
    total = arb(0)
    for key, value in x.items():
        if key == top[0]:
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


def _largest(ring: Ring, index: int) -> Any:
    g = ring.generators[index]
    if g.kind in ("sine", "cosine") or (g.kind == "function" and g.name in _BOUNDED_FUNCTIONS):
        return arb(1)
    return None
