"""Problem 10 on a polynomial vector field with known integrals: families, their stationary sets, what moves there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.splitting import Branch, Solved, Split, SplitLimits, exchanged, split
from mbsym.formulas.formula import Formula
from mbsym.problems.invariant_sets import result, second_variation
from mbsym.problems.invariant_sets.branches import Arena, Place
from mbsym.problems.invariant_sets.trials import gap_between, is_real

#: Sets of one family that are looked at closely.
MOST_SETS = 40
#: Equations in sines and cosines are longer: fewer branches are followed.
IN_ANGLES = SplitLimits(branches=150, terms=120, pairs=4, long=24)
#: Of what is asked with some multipliers zero.
FEWER = SplitLimits(branches=300, terms=120)

#: Terms of two equations whose resultant is asked for, and degrees in what is eliminated.
MOST_TERMS, MOST_DEGREE = 24, 4


def invariant_sets(arena: Arena) -> result.InvariantSets:
    """The stationary sets of K = V_0 + sum lambda_k V_k, of V_1 + sum lambda_k V_k, ..., each family for itself.

    The last one has one integral alone, unless it is of the geometry: gradients of relations are independent.
    """
    families = []
    generic: list[Polynomial] = []
    for first in range(max(1, len(arena.integrals) - len(arena.relations))):
        names = arena.names[first:]
        multipliers = arena.multipliers[: len(names) - 1]
        whole = arena.integrals[first]
        for g, integral in zip(multipliers, arena.integrals[first + 1 :], strict=True):
            whole = whole + arena.ring.context.gen(g) * integral
        held, beside = arena.integrals[first:], arena.integrals[:first]
        own = replace(arena, multipliers=multipliers, integrals=held, names=names, beside=beside)
        family, taken = _family(own, whole)
        families.append(family)
        generic += [p for p in taken if p not in generic]
    integrals = tuple((name, arena.formula(p)) for name, p in zip(arena.names, arena.integrals, strict=True))
    relations = tuple(arena.formula(p) for p in arena.relations)
    return result.InvariantSets(
        integrals=integrals,
        relations=relations,
        families=tuple(families),
        generic=tuple(arena.formula(p) for p in generic),
        in_angles=arena.floating > 0,
        variables=tuple(arena.name(g) for g in arena.variables),
    )


def _family(arena: Arena, whole: Polynomial) -> tuple[result.Family, tuple[Polynomial, ...]]:
    equations = in_angles(arena, whole) if arena.floating else [whole.derivative(g) for g in arena.variables]
    limits = IN_ANGLES if arena.floating else SplitLimits()
    splitting = split(equations, (*arena.variables, *arena.constant), arena.signs.never_zero, limits=limits)
    branches, generic = list(splitting.branches), list(splitting.generic)
    if splitting.unfinished:  # what fewer of the integrals make stationary is quickly found by itself
        for part in _without_some(arena, equations):
            branches += part.branches
            generic += [p for p in part.generic if p not in generic]
    places = [place for branch in branches if (place := _on_relations(arena, branch, generic)) is not None]
    places = [place for place in places if not _is_empty(place, generic)]
    places = [with_lagrangian(place, whole) for place in places] if arena.floating else places
    kept_places = _largest([_by_variables(place) if _is_steady(place) else place for place in _largest(places)])
    singular = sum(1 for place in kept_places if place.vanishes(arena.denominator) is True)
    kept_places = [place for place in kept_places if place.vanishes(arena.denominator) is not True]
    looked = [_set(place, whole) for place in kept_places[:MOST_SETS]]
    sets = [stationary_set for stationary_set in looked if stationary_set is not None]
    # A piece of a larger set may be cut off it by what was divided by; alone it need not be invariant.  The whole is,
    # where K is an integral; where it is seen to be none a set that is not invariant stays, and is told as a defect.
    failed = [stationary_set for stationary_set in sets if stationary_set.invariant is False]
    conserved = bool(arena.floating or not failed) or _conserved(arena)
    parts = failed if conserved else []
    sets = [stationary_set for stationary_set in sets if conserved is False or stationary_set not in failed]
    # A branch on which no point was found modulo a prime may be empty, or may not: nothing is said of it.
    unfinished = splitting.unfinished + max(0, len(kept_places) - MOST_SETS) + looked.count(None)
    unfinished += len(failed) if conserved is None else 0  # whether it is a piece is open: nothing is said of it, too
    sets.sort(key=lambda stationary_set: (stationary_set.dimension, stationary_set.union))
    names = tuple(arena.name(g) for g in arena.multipliers)
    return result.Family(arena.names, names, tuple(sets), unfinished, singular, len(parts)), tuple(generic)


def _without_some(arena: Arena, equations: Sequence[Polynomial]) -> Iterator[Split]:
    """The equations with some of the multipliers zero, the fewest integrals first; all of which are taken apart."""
    free = arena.constant
    gens = arena.ring.context.gens()
    for count in reversed(range(1, len(free) + 1)):
        for some in combinations(free, count):
            fixed = [gens[g] for g in some]
            splitting = split(
                [*fixed, *equations], (*arena.variables, *arena.constant), arena.signs.never_zero, limits=FEWER
            )
            if not splitting.unfinished:
                yield splitting


def _is_empty(place: Place, generic: list[Polynomial]) -> bool:
    """Whether it has no points where nothing in ``generic`` vanishes, to which is added what that needs."""
    provided = why_empty(place)
    if provided is not None:
        generic += [p for p in provided if p not in generic]
    return provided is not None


def _conserved(arena: Arena) -> bool | None:
    """Whether d/dt of every integral vanishes where the relations between the variables hold; None: not decided."""
    place = _on_relations(arena, Branch(()), [])
    found = {None} if place is None else {place.vanishes(arena.derivative(p)) for p in arena.integrals}
    return False if False in found else None if None in found else True


def _angles(arena: Arena, whole: Polynomial) -> tuple[list[tuple[int, int]], Polynomial]:
    """Sines and cosines by relation, and K without the terms of the relations."""
    pairs = [tuple(g for g in arena.variables if relation.degrees()[g] > 0) for relation in arena.relations]
    floating = arena.multipliers[len(arena.constant) :]
    images = [whole.context().constant(0) if k in floating else g for k, g in enumerate(whole.context().gens())]
    return [(a, b) for a, b in pairs], whole.compose(*images, ctx=whole.context())


def in_angles(arena: Arena, whole: Polynomial) -> list[Polynomial]:
    """The equations of stationarity in rates, positions and angles: cos dK/dsin - sin dK/dcos = 0 for each of these.

    So the multipliers of  sin^2 + cos^2 = 1  are eliminated.
    """
    pairs, plain = _angles(arena, whole)
    gens, turned = whole.context().gens(), {g for pair in pairs for g in pair}
    return [
        *(plain.derivative(g) for g in arena.variables if g not in turned),
        *(gens[b] * plain.derivative(a) - gens[a] * plain.derivative(b) for a, b in pairs),
    ]


def with_lagrangian(place: Place, whole: Polynomial) -> Place:
    """With the multiplier mu of every sin^2 + cos^2 = 1:  2 mu = -(sin dK/dsin + cos dK/dcos)."""
    arena, branch = place.arena, place.branch
    pairs, plain = _angles(arena, whole)
    gens, added = whole.context().gens(), []
    for (a, b), g in zip(pairs, arena.multipliers[len(arena.constant) :], strict=True):
        top, bottom = place.fraction(-gens[a] * plain.derivative(a) - gens[b] * plain.derivative(b))
        added.append(Solved(g, top, bottom * 2))
    return replace(place, branch=replace(branch, solved=(*branch.solved, *added)))


def _on_relations(arena: Arena, branch: Branch, generic: list[Polynomial]) -> Place | None:
    """With the relations between the variables among what remains; None where they contradict the branch.

    What is taken to be nonzero in parameters alone is added to ``generic``.
    """
    place = Place(arena, branch)
    for relation in arena.relations:
        top = place.shortened(place.branch.numerator(relation))
        if top == 0:
            continue
        factors = [f for f, _ in irreducible_factors(top)[1]]
        open_factors = [f for f in factors if f not in branch.nonzero and not _is_parameter(arena, f)]
        open_factors = [f for f in open_factors if not arena.signs.never_zero(f)]  # it has no real zeros
        assumed = [f for f in factors if _is_parameter(arena, f) and not arena.signs.never_zero(f)]
        generic += [f for f in assumed if f not in generic]
        if not open_factors:
            return None
        product = arena.ring.one
        for f in open_factors:
            product = product * f
        branch = replace(place.branch, remaining=(*place.branch.remaining, product))
        place = Place(arena, branch, (*place.geometric, product))
    return place


def _is_steady(place: Place) -> bool:
    return all(place.vanishes(slope) is True for slope in place.arena.numerators)


def _by_variables(place: Place) -> Place:
    """Of steady motions: multipliers in terms of the variables wherever that is possible without losing a motion."""
    arena = place.arena
    again = True
    while again:
        again = False
        for s in place.branch.solved:
            if s.unknown not in arena.variables:
                continue
            p = s.denominator * arena.ring.context.gen(s.unknown) - s.numerator
            degrees = p.degrees()
            for g in place.free_multipliers:
                if degrees[g] != 1 or any(rule.equation.degrees()[g] > 0 for rule in place.rules):
                    continue
                slope = place.shortened(p.derivative(g))
                square = place.shortened(slope * slope)
                if square == 0 or not _is_parameter(arena, square):
                    continue
                branch = exchanged(place.branch, s, g, (slope, square))
                if branch is not None:
                    place, again = Place(arena, branch, place.geometric), True
                    break
            if again:
                break
    return place


def _is_parameter(arena: Arena, p: Polynomial) -> bool:
    degrees = p.degrees()
    return all(degrees[g] == 0 for g in (*arena.variables, *arena.multipliers))


def _largest(places: Sequence[Place]) -> list[Place]:
    """Without those that lie in the closure of another."""
    kept_places: list[Place] = []
    for place in sorted(places, key=lambda candidate: len(candidate.branch.solved) + len(candidate.branch.remaining)):
        if not any(_holds(other, place) for other in kept_places):
            kept_places.append(place)
    return kept_places


def _holds(outer: Place, inner: Place) -> bool:
    """Whether the equations of ``outer`` hold on ``inner``, and its denominators do not vanish there."""
    for s in outer.branch.solved:
        if inner.vanishes(s.denominator) is not False:
            return False
        generator = s.numerator.context().gen(s.unknown)
        if inner.vanishes(s.denominator * generator - s.numerator) is not True:
            return False
    return all(inner.vanishes(p) is True for p in outer.branch.remaining)


def _set(place: Place, whole: Polynomial) -> result.StationarySet | None:
    arena, dimensions = place.arena, place.dimensions
    if dimensions is None or place.vanishes(arena.denominator) is not False:
        return None  # no point was found over a finite field, or rates are perhaps not given there: nothing is said
    steady = _is_steady(place)
    motion = []
    for g, slope in zip(arena.variables, arena.numerators, strict=True):
        if g in place.free_variables:
            top, bottom = place.fraction(slope)
            low, high = place.fraction(arena.denominator)
            motion.append((arena.name(g), top * high, bottom * low))
    kind = result.Kind.STEADY if steady else result.Kind.MANIFOLD
    first, gap = None, result.Gap.UNTRIED
    variation = _variation(place, whole, steady)
    if steady:
        try:
            first = second_variation.first_approximation(place)
        except Failure:
            first = None
        gap = gap_between(place, variation, first)
    return result.StationarySet(
        kind=kind,
        solved=tuple((arena.name(g), _value(place, g)) for g in arena.variables if g in place.solved),
        relations=tuple(arena.formula(p) for p in place.branch.remaining),
        nonzero=tuple(arena.formula(p) for p in place.divided_by),
        free=tuple(arena.name(g) for g in place.free_variables),
        multipliers=tuple(
            (arena.name(g), _value(place, g) if g in place.solved else None)
            for g in (arena.multipliers if steady else arena.constant)
        ),
        dimension=dimensions[0],
        union=dimensions[1],
        motion=() if steady else tuple((name, arena.formula(*_lowest(top, bottom))) for name, top, bottom in motion),
        invariant=_invariant(place),
        variation=variation,
        first=first,
        gap=gap,
        real=is_real(place),
    )


def _variation(place: Place, whole: Polynomial, steady: bool) -> result.SecondVariation:
    """On the level of the integrals, or across the manifold; left out where it has equations that were not solved."""
    variables = place.arena.variables
    further = [p for p in place.branch.remaining if p not in place.geometric]
    try:
        if steady:
            return second_variation.on_level(place, whole)
        if place.arena.floating or any(p.degrees()[g] > 0 for p in further for g in variables):
            return result.SecondVariation(result.Definiteness.LEFT_OUT, 0)
        # For fixed multipliers that a branch has in terms of variables the set is smaller: these equations are its own.
        fixed = [s for s in place.branch.solved if s.unknown in place.arena.multipliers]
        if any(p.degrees()[g] > 0 for s in fixed for p in (s.numerator, s.denominator) for g in variables):
            return result.SecondVariation(result.Definiteness.VARYING, 0)
        return second_variation.across(place, whole)
    except Failure:
        pass
    return result.SecondVariation(result.Definiteness.LEFT_OUT, 0)


def _value(place: Place, g: int) -> Formula:
    s = place.solved[g]
    return place.arena.formula(*_lowest(place.shortened(s.numerator), place.shortened(s.denominator)))


def _lowest(top: Polynomial, bottom: Polynomial) -> tuple[Polynomial, Polynomial]:
    if top == 0:
        return top, bottom * 0 + 1
    common = top.gcd(bottom)
    return top / common, bottom / common


def _invariant(place: Place) -> bool | None:
    """d/dt of every equation of the set, for constant multipliers, vanishes on it by the equations of motion."""
    arena = place.arena
    context = arena.ring.context
    floating = arena.multipliers[len(arena.constant) :]
    equations = list(place.branch.remaining)
    equations += [
        s.denominator * context.gen(s.unknown) - s.numerator for s in place.branch.solved if s.unknown not in floating
    ]
    if not _is_steady(place) and any(p.degrees()[g] > 0 for p in equations for g in floating):
        return None  # their rates are not known
    answers = [place.vanishes(arena.derivative(p)) for p in equations]
    return False if False in answers else None if None in answers else True


def why_empty(place: Place) -> tuple[Polynomial, ...] | None:
    """Polynomials in parameters alone: where none of them vanishes the branch has no points; None where that is open.

    An equation may have no real solution, as k x^2 + 1 = 0.  The resultant of two polynomials lies in their ideal, so
    that it vanishes at every common zero.
    """
    for p in place.branch.remaining:
        provided = _nonzero(place, p)
        if provided is not None:
            return provided
    unknown = (*place.arena.multipliers, *place.arena.variables)
    for p, q in combinations(place.branch.remaining, 2):
        if len(p) * len(q) > MOST_TERMS**2:
            continue
        for g in unknown:
            degrees = p.degrees()[g], q.degrees()[g]
            if min(degrees) > 0 and max(degrees) <= MOST_DEGREE:
                provided = _nonzero(place, p.resultant(q, g))
                if provided is not None:
                    return provided
    return None


def _nonzero(place: Place, p: Polynomial) -> tuple[Polynomial, ...] | None:
    """What has to be nonzero, in parameters alone, for p to be nonzero on the branch; None where that is open."""
    if p == 0:
        return None
    never, needed = place.arena.signs.never_zero, []
    for factor, _ in irreducible_factors(p)[1]:
        if factor in place.branch.nonzero or never(factor):
            continue
        degrees = factor.degrees()
        if any(degrees[g] for g in (*place.arena.multipliers, *place.arena.variables)):
            return None
        needed.append(factor)
    return tuple(needed)
