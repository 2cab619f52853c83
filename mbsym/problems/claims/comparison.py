"""A claimed formula against the derived one: equal, on the relations, up to a factor, or different by exactly this."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from flint import fmpq

from mbsym.algebra.factors import rational_ratio
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, enumerated
from mbsym.expressions.tree import Expression, Name, differentiate, names
from mbsym.formulas.formula import Formula
from mbsym.model.claims import CLAIMS, SUMS, Claim
from mbsym.problems.claims.result import (
    ClaimResult,
    Derived,
    Outcome,
    Part,
    by_motion,
    by_place,
    in_parameters,
    is_moving,
    on_relations,
    scene_of_claims,
    split_off,
)
from mbsym.problems.claims.signs_under_roots import decided
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.integrals import total_rate


def examined_formula(
    derived: Derived, claim: Claim, about: str, symbols: Symbols, claimed: Polynomial, truth: Polynomial
) -> ClaimResult:
    ring = derived.ring
    result = ClaimResult(claim, about, Outcome.EXACT, Formula(ring, truth))
    homogeneous = CLAIMS[claim.kind].homogeneous
    if ring.is_zero(claimed - truth):  # in the description's own symbols, if both are written in them
        return result
    if homogeneous:
        multiple = closest_multiple(derived, claim, claimed, truth)
        if multiple is not None and multiple.verdict == (Outcome.EXACT, ""):
            return replace(result, outcome=Outcome.FACTOR, factor=multiple.factor, remark=multiple.remark)
    own = ring.reduce(claimed - truth)
    claimed, truth = in_parameters(derived, claimed), in_parameters(derived, truth)
    difference = ring.reduce(claimed - truth)
    if ring.is_zero(difference):
        return result
    exact = Outcome.EXACT
    related = on_relations(derived, claim, difference)
    if related != difference:
        claimed, truth = on_relations(derived, claim, claimed), on_relations(derived, claim, truth)
        difference, exact = related, Outcome.RELATIONS
    outcome, where = decided(derived, difference)
    if outcome == Outcome.EXACT:
        return replace(result, outcome=exact, where=where)
    if outcome in (Outcome.NUMERICAL, Outcome.UNDECIDED):
        return replace(result, outcome=outcome, where=where, difference=Formula(ring, difference))
    if homogeneous:
        return _up_to_multiple(derived, result, symbols, claimed, truth, min(difference, own, key=len))
    factor = constant_factor(derived, claimed, truth)
    if factor is not None:
        return replace(result, outcome=Outcome.SCALED, factor=factor)
    if claim.kind in SUMS and _same_equations(derived, difference):
        remark = "it differs by a constant"
        if is_moving(derived, difference):
            remark = "the equations of motion are the same"
        if _allows(derived, claim, difference):
            return replace(result, outcome=Outcome.EQUIVALENT, difference=Formula(ring, difference), remark=remark)
        remark = remark.replace("it differs by a constant", "by a constant")
        return replace(differing(derived, result, symbols, min(difference, own, key=len)), remark=remark)
    return differing(derived, result, symbols, min(difference, own, key=len))


def _allows(derived: Derived, claim: Claim, difference: Polynomial) -> bool:
    """Whether the quantity is determined only up to such a difference dF(q, t)/dt.

    The Lagrangian is; a force function up to a function of the time; the kinetic energy is a definite quantity.
    """
    if claim.kind == "kinetic energy":
        return False
    state = [*derived.system.coordinates, *derived.system.velocities]
    return claim.kind == "lagrangian" or not derived.ring.dependencies(difference, state)


def _up_to_multiple(
    derived: Derived, result: ClaimResult, symbols: Symbols, claimed: Polynomial, truth: Polynomial, own: Polynomial
) -> ClaimResult:
    """What has only to vanish, against the multiple of the derived one that comes closest; ``own`` is for 1 times."""
    multiple = closest_multiple(derived, result.claim, claimed, truth)
    if multiple is None:
        return differing(derived, result, symbols, own)
    claim_result = replace(result, factor=multiple.factor, remark=multiple.remark)
    outcome, where = multiple.verdict
    if outcome == Outcome.EXACT:
        return replace(claim_result, outcome=Outcome.FACTOR, where=where)
    if outcome in (Outcome.NUMERICAL, Outcome.UNDECIDED):
        difference = Formula(derived.ring, multiple.difference)
        return replace(claim_result, outcome=outcome, where=where, difference=difference)
    return differing(derived, replace(claim_result, remark=""), symbols, multiple.difference)


def _same_equations(derived: Derived, difference: Polynomial) -> bool:
    """Whether d/dt dD/dq'_i - dD/dq_i vanishes identically for every coordinate: D = dF(q, t)/dt."""
    ring, scene = derived.ring, derived.parameters_scene
    for name in derived.system.coordinates:
        momentum = ring.velocity_derivative(difference, name)
        if ring.is_zero(total_rate(scene, momentum) - ring.derivative(difference, name)) is not True:
            return False
    return True


# A difference taken apart by products of velocities, and the abbreviations that explain it.


#: Differences of more products of velocities than this are not taken apart.
MOST_PARTS = 60


def differing(derived: Derived, result: ClaimResult, symbols: Symbols, difference: Polynomial) -> ClaimResult:
    """The result with its difference, taken apart."""
    parts = _parts(derived, result.claim, symbols, difference)
    if result.claim.variable:  # the generator of the time stands for the variable: only the parts can be shown
        return replace(result, derived=None, outcome=Outcome.DIFFERS, parts=parts)
    return replace(result, outcome=Outcome.DIFFERS, difference=Formula(derived.ring, difference), parts=parts)


def _parts(derived: Derived, claim: Claim, symbols: Symbols, difference: Polynomial) -> tuple[Part, ...]:
    """The difference by products of velocities (a characteristic polynomial by powers), equal ones together."""
    ring = derived.ring
    if claim.variable:
        formula, time = Formula(ring, ring.one), ring.index("time", "t")
        powers = {place[time]: coefficient for place, coefficient in by_place(ring, claim, difference)}
        return tuple(Part(formula, Formula(ring, powers[power]), power) for power in sorted(powers, reverse=True))
    split = list(by_motion(ring, difference))
    if len(split) > MOST_PARTS:
        return ()
    values = _values(derived, symbols, [claim.equals])
    groups: list[tuple[Polynomial, Polynomial]] = []  # (combination of products, difference)
    for exponents, coefficient in split:
        product = ring.context.from_dict({exponents: fmpq(1)})
        for place, (combined, known) in enumerate(groups):
            ratio = rational_ratio(coefficient, known)
            if ratio is not None:
                groups[place] = (combined + product * ratio, known)
                break
        else:
            groups.append((product, coefficient))
    slopes = _slopes(derived, claim, symbols)
    parts = []
    for combined, coefficient in groups:
        same = _same_as(coefficient, values)
        repairs = () if same else _repairs(ring, combined, coefficient, slopes, values)
        parts.append(Part(Formula(ring, combined), Formula(ring, coefficient), None, same, repairs))
    return tuple(parts)


def _values(derived: Derived, symbols: Symbols, expressions: list[Expression]) -> dict[str, Polynomial]:
    """The abbreviations that occur, as polynomials in declared parameters."""
    scene = scene_of_claims(derived)
    wanted = symbols.occurring(expressions)
    lower = symbols.in_scene(scene)
    return {name: in_parameters(derived, lower(Name(name))) for name in symbols.values if name in wanted}


def _same_as(coefficient: Polynomial, values: Mapping[str, Polynomial]) -> str:
    """``c18`` or ``-2*c18``, if the coefficient is a rational multiple of an abbreviation."""
    for name, value in values.items():
        ratio = None if value.is_constant() else rational_ratio(coefficient, value)
        if ratio is not None:
            sign = "-" if ratio < 0 else ""
            return sign + (name if abs(ratio) == 1 else f"{abs(ratio)}*{name}")
    return ""


def _slopes(derived: Derived, claim: Claim, symbols: Symbols) -> dict[str, Polynomial]:
    """What stands before each abbreviation in the claim, for those that enter it linearly."""
    scene = scene_of_claims(derived)
    slopes = {}
    for name in symbols.values:
        if name not in names(claim.equals):
            continue
        slope = differentiate(claim.equals, name)
        if name in names(slope):
            continue
        slopes[name] = in_parameters(derived, symbols.in_scene(scene)(symbols.opened(slope)))
    return slopes


def _repairs(
    ring: Ring,
    combined: Polynomial,
    coefficient: Polynomial,
    slopes: Mapping[str, Polynomial],
    values: Mapping[str, Polynomial],
) -> tuple[tuple[str, Formula], ...]:
    """Abbreviations that stand before just this combination: with -difference added the claim would be right.

    Where some of them are made of the parameters of the difference, the others are not named.
    """
    found, likely = [], []
    needed = _parameters(ring, coefficient)
    for name, slope in slopes.items():
        ratio = rational_ratio(combined, slope)
        if ratio is not None:
            found.append((name, Formula(ring, ring.reduce(-coefficient * ratio))))
            if needed <= _parameters(ring, values[name]):
                likely.append(found[-1])
    return tuple(likely or found)


def _parameters(ring: Ring, x: Polynomial) -> set[int]:
    degrees = x.degrees()
    return {k for k, g in enumerate(ring.generators) if g.kind == "parameter" and degrees[k] > 0}


# Multiples of a derived formula that a claimed one is, or comes closest to.


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
