"""Exact trials at rational points: real points of a set, and points between sufficient and necessary conditions."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice, pairwise
from typing import Any

import numpy as np
from flint import arb, ctx, fmpq

from mbsym.algebra.ring import Polynomial
from mbsym.algebra.terms import coefficients_in
from mbsym.problems.invariant_sets.branches import Place, Rule
from mbsym.problems.invariant_sets.result import Definiteness, FirstApproximation, Gap, Relation, SecondVariation

#: Points that are tried, values of free multipliers at each of them, bits of balls.
POINTS, CHOICES, BITS = 60, 60, 128
#: Points of parameters among which those are looked for where what is necessary holds, and how many of these are looked
#: at: a gap may be narrow (of a satellite on a circular orbit Delp's region is a twentieth of what is necessary).
PARAMETERS, INSIDE = 3000, 400
#: A float is known to be negative beyond this part of the sum of sizes of its terms.
ROUNDING = 1e-9
#: Of the values of multipliers so many with each multiplier moved along a line.
LINES = 6
#: Of coordinates and multipliers, beside parameters: a set of small ones is found by the second.
SIZES = (fmpq(1, 2), fmpq(1, 16))
_VALUES = [fmpq(p, q) for p in range(1, 9) for q in (1, 2, 3)]

#: Polynomials whose terms are kept at a time.
MOST_KEPT = 1000

Point = dict[int, arb]
#: A coefficient, and the generators with their powers.
Term = tuple[Any, list[tuple[int, int]]]


def is_real(place: Place) -> bool:
    """Whether a real point of the set was found at parameters that the description allows."""
    with ctx.workprec(BITS):
        return any(next(_points(place, POINTS, size), None) is not None for size in SIZES)


def gap_between(place: Place, variation: SecondVariation | None, first: FirstApproximation | None) -> Gap:
    """Whether parameters were found at which what is necessary holds strictly and what is sufficient does not."""
    if variation is None or first is None or first.unstable or not first.complete:
        return Gap.UNTRIED
    if variation.outcome is not Definiteness.CONDITIONAL:
        return Gap.UNTRIED
    sieve = _Sieve(place, first.necessary)
    with ctx.workprec(BITS):
        points = _points(place, PARAMETERS if sieve.sharp else POINTS, sieve=sieve)
        inside = list(islice((point for point in points if _hold(first.necessary, point, strictly=True)), INSIDE))
        for point in inside:
            if not any(_definite(variation, choice) for choice in _choices(place, point, variation)):
                return Gap.FOUND
    return Gap.NONE_FOUND if inside else Gap.UNTRIED


class _Sieve:
    """Leaves out in floats, which is quick, what is no point of what is asked: where a polynomial is clearly negative.

    Looked at are what is assumed and those ``relations`` that parameters and free values decide by themselves;
    ``sharp`` where there are no others.
    """

    def __init__(self, place: Place, relations: Sequence[Relation]) -> None:
        known = {*place.arena.parameters, *place.free_multipliers, *place.free_variables}
        known -= {rule.generator for rule in place.rules}
        polynomials = [p for p, _ in place.arena.signs.assumptions] + [r.formula.polynomial for r in relations]
        terms = [
            [(float(c), [(g, int(power)) for g, power in enumerate(monomial) if power]) for monomial, c in p.terms()]
            for p in polynomials
        ]
        self._asked = [term for term in terms if {g for _, powers in term for g, _ in powers} <= known]
        self.sharp = len(self._asked) == len(polynomials)

    def __call__(self, point: Mapping[int, arb]) -> bool:
        values = {g: float(x) for g, x in point.items()}
        for terms in self._asked:
            total = size = 0.0
            for c, powers in terms:
                for g, power in powers:
                    c *= values[g] ** power
                total += c
                size += abs(c)
            if total < -ROUNDING * size:
                return False
        return True


def _definite(variation: SecondVariation, point: Mapping[int, arb]) -> bool:
    return any(side is not None and _hold(side, point) for side in (variation.positive, variation.negative))


def _hold(relations: Sequence[Relation], point: Mapping[int, arb], strictly: bool = False) -> bool:
    """Proved by balls."""
    for relation in relations:
        if any(_value(f.polynomial, point).contains(0) for f in relation.unless):
            return False
        value = _value(relation.formula.polynomial, point)
        if relation.relation == "=":  # which no ball can prove
            return False
        if relation.relation == "!=":
            if value.contains(0):
                return False
        elif not value > 0 and (strictly or relation.relation == ">" or not value >= 0):
            return False
    return True


class _Terms:
    """The terms of polynomials, each read once: one of many generators lists the exponents of all of them."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Polynomial, list[Term]]] = {}

    def __call__(self, p: Polynomial) -> list[Term]:
        known = self._known.get(id(p))  # which is its own as long as it is kept here
        if known is None:
            if len(self._known) >= MOST_KEPT:
                self._known.clear()
            known = self._known[id(p)] = (p, _terms_of(p))
        return known[1]


_terms = _Terms()


def _terms_of(p: Polynomial) -> list[Term]:
    return [(c, [(g, int(power)) for g, power in enumerate(monomial) if power]) for monomial, c in p.to_dict().items()]


def _value(p: Polynomial, point: Mapping[int, arb]) -> arb:
    return _sum(_terms(p), point)


def _sum(terms: Sequence[Term], point: Mapping[int, arb]) -> arb:
    total = arb(0)
    for c, powers in terms:
        term = arb(c)
        for g, power in powers:
            term *= point[g] if power == 1 else point[g] ** power
        total += term
    return total


def _choices(place: Place, point: Point, variation: SecondVariation) -> Iterator[Point]:
    """The same state and parameters with other values of the multipliers on which the state does not depend.

    None of the other integrals first; then all sizes, and, of one multiplier after another, a value in each interval
    between the places where conditions change their signs: of one multiplier alone these are all there is to try.
    """
    yield point
    free = [g for g in place.free_multipliers if not place.fixes(g)]
    if not free:
        return
    chance = random.Random(5)
    conditions = [
        relation.formula.polynomial for side in (variation.positive, variation.negative) for relation in side or ()
    ]
    for k in range(CHOICES):
        size = fmpq(1, 4 ** (k % 3)) if k else fmpq(0)
        changed = dict(point) | {g: arb(chance.choice(_VALUES) * chance.choice((1, -1)) * size) for g in free}
        if _solve(place, changed):
            yield changed
            if k < LINES:
                yield from _along(place, changed, free, conditions)


def _along(place: Place, point: Point, free: Sequence[int], conditions: Sequence[Polynomial]) -> Iterator[Point]:
    for g in free:
        ends = sorted({x for p in conditions for x in _real_zeros(p, g, point)})
        if ends:
            middle = [(a + b) / 2 for a, b in pairwise(ends)]
            for x in (ends[0] - 1, *middle, ends[-1] + 1):
                changed = dict(point) | {g: arb(x)}
                if _solve(place, changed):
                    yield changed


def _real_zeros(p: Polynomial, g: int, point: Mapping[int, arb]) -> list[float]:
    """Nearly, of p in one generator: they only say where to try."""
    numbers = [float(_sum(_terms_of(c), point).mid()) for c in reversed(coefficients_in(p, g))]
    return [float(x.real) for x in np.roots(numbers) if abs(x.imag) <= 1e-9 * (1 + abs(x))]


def _points(
    place: Place, count: int, size: fmpq = SIZES[0], sieve: Callable[[Point], bool] = lambda point: True
) -> Iterator[Point]:
    """Real points of the set at parameters that the description allows: rational but for roots, in balls.

    ``count`` of them are begun; of values that the ``sieve`` leaves out nothing is solved.
    """
    arena = place.arena
    chance = random.Random(11)
    unknown = (*place.free_multipliers, *place.free_variables)
    for _ in range(count):
        point: Point = {
            g: arb(chance.choice(_VALUES)) * _direction(arena.signs.words[g], chance) for g in arena.parameters
        }
        for g in unknown:
            point[g] = arb(chance.choice(_VALUES) * chance.choice((1, -1)) * size)
        if not sieve(point) or not _allowed(place, point):
            continue
        pending = list(place.rules)
        if _roots(pending, point, chance) and _solve(place, point):
            yield point


def _direction(word: str, chance: random.Random) -> int:
    return {"positive": 1, "nonnegative": 1, "negative": -1, "nonpositive": -1}.get(word) or chance.choice((1, -1))


def _allowed(place: Place, point: Mapping[int, arb]) -> bool:
    for p, relation in place.arena.signs.assumptions:
        value = _value(p, point)
        if (relation == ">" and not value > 0) or (relation == ">=" and not value >= 0) or value.contains(0):
            return False
    return True


def _roots(pending: list[Rule], point: Point, chance: random.Random) -> bool:
    """Real roots of what remains, one generator after another."""
    unset = {rule.generator for rule in pending}
    while pending:
        ready = next((r for r in pending if not any(r.equation.degrees()[g] for g in unset if g != r.generator)), None)
        if ready is None:
            return False
        root = _root(ready, point, chance)
        if root is None:
            return False
        point[ready.generator] = root
        unset.discard(ready.generator)
        pending.remove(ready)
    return True


def _root(rule: Rule, point: Point, chance: random.Random) -> arb | None:
    """A real root between two rational places where the equation has other signs, in a ball."""
    degree = rule.equation.degrees()[rule.generator]
    coefficients = [arb(0)] * (degree + 1)
    rest = dict(point) | {rule.generator: arb(1)}
    for power in range(degree + 1):
        part = rule.top(rule.equation, power)
        if part != 0:
            coefficients[power] = _sum(_terms_of(part), rest)

    def at(x: fmpq) -> arb:
        total = arb(0)
        for c in reversed(coefficients):
            total = total * arb(x) + c
        return total

    marks = [fmpq(k, 3) for k in range(-24, 25)]
    values = [at(x) for x in marks]
    exact = [x for x, value in zip(marks, values, strict=True) if value.is_zero()]
    if exact:
        return arb(chance.choice(exact))
    pairs = [
        (a, b)
        for (a, u), (b, v) in zip(
            zip(marks, values, strict=True), list(zip(marks, values, strict=True))[1:], strict=False
        )
        if (u > 0 and v < 0) or (u < 0 and v > 0)
    ]
    if not pairs:
        return None
    low, high = chance.choice(pairs)
    rising = bool(at(high) > 0)
    for _ in range(BITS - 32):
        middle = (low + high) / 2
        value = at(middle)
        if value.contains(0):
            break
        if bool(value > 0) == rising:
            high = middle
        else:
            low = middle
    return arb(low).union(arb(high))


def _solve(place: Place, point: Point) -> bool:
    """What the branch solved for; False where a denominator, or what must not vanish, may be zero."""
    for s in place.branch.solved:
        bottom = _value(s.denominator, point)
        if bottom.contains(0):
            return False
        point[s.unknown] = _value(s.numerator, point) / bottom
    return not any(_value(p, point).contains(0) for p in place.branch.nonzero)
