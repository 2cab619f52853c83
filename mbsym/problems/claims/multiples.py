"""Multiples of a derived formula that a claimed one is, or comes closest to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, enumerated
from mbsym.formulas.formula import Formula
from mbsym.model.claims import Claim
from mbsym.problems.claims.forms import by_place, is_moving, split_off
from mbsym.problems.claims.result import Derived
from mbsym.problems.claims.signs_under_roots import decided

#: Multiples of a derived equation that a claimed one is compared with.
MOST_FACTORS = 12


@dataclass(frozen=True)
class Multiple:
    """``difference`` = claimed - factor*derived, whether it vanishes, and where the factor makes no sense."""

    factor: Formula
    difference: Polynomial
    verdict: tuple[str, str]
    remark: str


def closest_multiple(derived: Derived, claim: Claim, claimed: Polynomial, truth: Polynomial) -> Multiple | None:
    """claimed - factor*derived in the fewest products of velocities (powers of the variable).

    The candidates are 1 and the quotients of coefficients: of the coordinate's own acceleration (of the highest power)
    first, then of the others; the first of the best is taken.  For an equation the quotient of the whole is another, if
    there is one without accelerations.  None where 1 does best, or everything is too long.
    """
    ring = derived.ring
    if claimed.is_zero() or truth.is_zero():
        return None
    above, below = over_common_denominator(ring, claimed, truth)
    first, second = dict(by_place(ring, claim, above)), dict(by_place(ring, claim, below))
    keys = sorted(first.keys() & second.keys(), key=partial(_importance, ring, claim))
    best: tuple[int, tuple[Polynomial, Polynomial], Polynomial] | None = None
    candidates = [(ring.one, ring.one), *((first[key], second[key]) for key in keys[:MOST_FACTORS])]
    if not claim.variable:
        candidates.append((above, below))
        # Where the factor holds velocities, the coefficients of single products are no multiples.
        for k in (k for k, g in enumerate(ring.generators) if g.kind == "acceleration" and below.degrees()[k] == 1):
            if above.degrees()[k] == 1:
                candidates.append((above.derivative(k), below.derivative(k)))
    for top, bottom in candidates:
        try:
            common = ring.common_factor(top, bottom)
            shorter = ring.quotient(top, common), ring.quotient(bottom, common)
            if any(x is None or _accelerations(ring, x) for x in shorter):
                continue
            left = ring.reduce(ring.times(above, shorter[1]) - ring.times(below, shorter[0]))
        except NoClosedForm:
            continue
        cost = 0 if ring.is_zero(left) else len(list(by_place(ring, claim, left)))
        if best is None or cost < best[0]:
            best = (cost, (shorter[0], shorter[1]), left)
        if not cost:
            break
    if best is None or best[1][0] == best[1][1]:
        return None
    (top, bottom), left = best[1:]
    try:
        factor = ring.reduce(ring.times(top, ring.reciprocal(bottom)))
        difference = ring.reduce(claimed - ring.times(truth, factor))
    except Failure:
        return None
    return Multiple(Formula(ring, factor), difference, decided(derived, left), exceptions(derived, top, bottom))


def _accelerations(ring: Ring, x: Polynomial) -> bool:
    degrees = x.degrees()
    return any(degrees[k] > 0 for k, g in enumerate(ring.generators) if g.kind == "acceleration")


def over_common_denominator(ring: Ring, first: Polynomial, second: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Both times their denominators."""
    above, denominators = ring.fraction(first)
    below, others = ring.fraction(second)
    for factor, exponent in others:
        above = ring.times(above, ring.power(factor, exponent))
    for factor, exponent in denominators:
        below = ring.times(below, ring.power(factor, exponent))
    return above, below


def _importance(ring: Ring, claim: Claim, place: tuple[int, ...]) -> tuple[bool, bool, int, tuple[int, ...]]:
    """Sorts the coordinate's own acceleration first, then other accelerations, then high powers."""
    kinds = [ring.generators[k] for k, exponent in enumerate(place) if exponent]
    own = any(g.kind == "acceleration" and g.name == claim.of for g in kinds)
    accelerated_ = any(g.kind == "acceleration" for g in kinds)
    return not own, not accelerated_, -sum(place), place


def exceptions(derived: Derived, top: Polynomial, bottom: Polynomial) -> str:
    """ "where r and cos(theta) are not 0": what of top and bottom is not known to be different from zero."""
    ring = derived.ring
    doubtful: list[str] = []
    for x in (top, bottom):
        try:
            factors = [] if x.is_constant() else ring.factored(x)[1]
        except NoClosedForm:
            return "where the factor is neither 0 nor infinite"
        for factor, _ in factors:
            if not derived.signs.never_zero(factor):
                doubtful.append(str(Formula(ring, factor)))
    if not doubtful:
        return ""
    named = list(dict.fromkeys(doubtful))
    if len(named) == 1:
        return Message("where [[name]] is not 0", name=named[0])
    return Message("where [[names]] are not 0", names=enumerated(named))


def constant_factor(derived: Derived, claimed: Polynomial, truth: Polynomial) -> Formula | None:
    """claimed / derived, if that is a product of powers of parameters.

    Both are split into what varies with the state and what stands before it; then one of these quotients is the factor.
    """
    ring = derived.ring
    if claimed.is_zero() or truth.is_zero():
        return None
    above, below = over_common_denominator(ring, claimed, truth)
    constant = {k for k in range(len(ring.generators)) if not is_moving(derived, ring.context.gen(k))}
    first, second = dict(split_off(ring, above, constant)), dict(split_off(ring, below, constant))
    if first.keys() != second.keys():
        return None
    key = min(second, key=lambda one: len(first[one]) + len(second[one]))
    common = ring.common_factor(first[key], second[key])
    top, bottom = ring.quotient(first[key], common), ring.quotient(second[key], common)
    if top is None or bottom is None or len(top) > 1 or len(bottom) > 1:
        return None
    if not ring.is_zero(ring.times(claimed, bottom) - ring.times(truth, top)):
        return None
    return Formula(ring, ring.reduce(ring.times(top, ring.reciprocal(bottom))))
