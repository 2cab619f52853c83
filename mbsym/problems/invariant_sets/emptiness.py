"""Branches that surely have no points: two of their equations have no common zero, for almost all parameters."""

from __future__ import annotations

from itertools import combinations

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.ring import Polynomial
from mbsym.problems.invariant_sets.branches import Place

#: Terms of two equations whose resultant is asked for, and degrees in what is eliminated.
MOST_TERMS, MOST_DEGREE = 24, 4


def why_empty(place: Place) -> tuple[Polynomial, ...] | None:
    """Polynomials in parameters alone: where none of them vanishes the branch has no points; None where that is open.

    The resultant of two polynomials lies in their ideal, so that it vanishes at every common zero.
    """
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
