"""A claimed formula against the derived one: equal, on the relations, up to a factor, or different by exactly this.

Whether a difference vanishes is a question of signs where roots occur: sqrt(r**2) is r for r > 0 only.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product as combinations_of
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.factors import rational_ratio
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, enumerated
from mbsym.expressions.tree import Expression, Name, differentiate, names
from mbsym.formulas.formula import Formula
from mbsym.mechanics.states import SEED
from mbsym.model.admissibility import number_of
from mbsym.model.assumptions import broken
from mbsym.model.claims import CLAIMS, SUMS, Claim
from mbsym.model.system import System
from mbsym.problems.claims.counterexample import PRECISION
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
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.integrals import total_rate

#: What is left of a number that is known so well, relatively, is rounding.
ROUNDING = arb(2) ** -60
#: Quantities of undeclared sign under roots for which both signs are tried, points with each, and attempts per point.
MOST_SIGNS, POINTS, ATTEMPTS = 4, 8, 40
#: The answer that counts where several choices of signs are possible, last.
_WORST = (Outcome.EXACT, Outcome.NUMERICAL, Outcome.UNDECIDED, Outcome.DIFFERS)
#: By what is known of a quantity: r sqrt(p) stands for sqrt(r^2 p), or -r sqrt(p).
_SIGN = {"positive": 1, "nonnegative": 1, "zero": 1, "negative": -1, "nonpositive": -1}
#: What may stand under a root and have either sign.
_SIGNED = ("coordinate", "velocity", "acceleration", "time", "prescribed", "parameter", "sine", "cosine")


def decided(derived: Derived, x: Polynomial) -> tuple[str, str]:
    """Whether x vanishes: EXACT, NUMERICAL, UNDECIDED or DIFFERS; and "for r > 0 ...", if it does for some signs only.

    Roots of squares are opened for each choice of the signs that are not declared.
    """
    ring = derived.ring
    if ring.is_zero(x):
        return Outcome.EXACT, ""
    numerator, _ = ring.fraction(x)
    degrees = numerator.degrees()
    adjoined = [g for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0]
    if all(g.kind == "root" and g.argument.is_constant() for g in adjoined):
        return Outcome.DIFFERS, ""
    known, unknown = signs_under_roots(derived, numerator)
    tried = unknown[:MOST_SIGNS]
    answers = {
        pattern: _decided_for(derived, numerator, known, dict(zip(tried, pattern, strict=True)))
        for pattern in combinations_of((1, -1), repeat=len(tried))
    }
    found = answers[(1,) * len(tried)]
    if found is None:  # no parameters that are allowed have all these signs
        found = max((x for x in answers.values() if x), key=_WORST.index, default=Outcome.UNDECIDED)
    if found not in (Outcome.EXACT, Outcome.NUMERICAL):
        return found, ""
    if all(other in (Outcome.EXACT, Outcome.NUMERICAL, None) for other in answers.values()) and tried == unknown:
        return (Outcome.NUMERICAL if Outcome.NUMERICAL in answers.values() else Outcome.EXACT), ""
    matters = [k for k, _ in enumerate(tried) if any(answers[p] != answers[_flipped(p, k)] for p in answers)]
    names = [_name(ring, tried[k]) for k in matters] + [_name(ring, k) for k in unknown[MOST_SIGNS:]]
    return found, restriction(names, len(names) == 1 and Outcome.DIFFERS in answers.values())


def _flipped(pattern: tuple[int, ...], place: int) -> tuple[int, ...]:
    return (*pattern[:place], -pattern[place], *pattern[place + 1 :])


def _name(ring: Ring, index: int) -> str:
    return str(Formula(ring, ring.context.gen(index)))


def restriction(unknown: Sequence[str], refuted: bool) -> str:
    positive = ", ".join(f"{name} > 0" for name in unknown)
    if refuted:
        return Message("for [[positive]] (it does not for [[other]] < 0)", positive=positive, other=unknown[0])
    return Message("for [[positive]] (it need not with other signs)", positive=positive)


def signs_under_roots(derived: Derived, *values: Polynomial) -> tuple[dict[int, int], list[int]]:
    """Generators of declared sign (+1, -1), and those under the roots that occur whose sign is open.

    Under a root the sine of an angle may hide in its cosine: sqrt(1 - cos(x)**2).
    """
    ring, system = derived.ring, derived.system
    under: set[int] = set()
    pending = [(x, False) for x in values]
    seen: set[tuple[int, bool]] = set()
    while pending:
        x, below = pending.pop()
        for k, degree in enumerate(x.degrees()):
            g = ring.generators[k]
            if degree <= 0 or (k, below) in seen:
                continue
            seen.add((k, below))
            if k < ring.spare and g.argument is not None:
                pending.append((g.argument, below or g.kind == "root"))
            if below and g.kind in _SIGNED and g.name != "pi":
                under.add(k)
                if g.kind in ("sine", "cosine") and g.argument is None:
                    under |= {ring.index(kind, g.name) for kind in ("sine", "cosine")}
    known = {}
    for parameter in system.parameters:
        index = ring.index("parameter", parameter.name)
        sign = _SIGN.get(derived.signs.sign(ring.context.gen(index)))
        if sign is not None:
            known[index] = sign
    return known, [k for k in sorted(under) if k not in known]


def _decided_for(derived: Derived, x: Polynomial, known: Mapping[int, int], tried: Mapping[int, int]) -> str | None:
    """Whether x vanishes where these generators have these signs; None where there is no such point.

    All others take both signs, and angles all quadrants.
    """
    ring, signs = derived.ring, {**known, **tried}
    opened, identical = x, False
    try:
        opened = _opened_roots(derived, x, signs)
        identical = ring.is_zero(opened) is True
    except Failure:
        pass
    if identical and not (tried and derived.system.assumptions):
        return Outcome.EXACT
    source = random.Random(SEED)
    finite, narrow, allowed_points = 0, True, 0
    with ctx.workprec(PRECISION):
        for _ in range(POINTS * ATTEMPTS):
            values = _point(ring, signs, source)
            if not _has_signs(ring, signs, values) or not _is_allowed(derived.system, values):
                continue
            if identical:
                return Outcome.EXACT
            allowed_points += 1
            value = ring.evaluate(opened, values)
            if not value.is_finite():
                continue
            if not value.contains(0):
                return Outcome.DIFFERS
            finite, narrow = finite + 1, narrow and value.rad() < ROUNDING
            if finite == POINTS:
                return Outcome.NUMERICAL if narrow else Outcome.UNDECIDED
    return Outcome.UNDECIDED if allowed_points else None


def _point(ring: Ring, signs: Mapping[int, int], source: random.Random) -> dict[str, Any]:
    """Numbers for all names: of the given signs, else of either; up to more than a full turn."""
    values = {}
    plain = {ring.generators[k].name: sign for k, sign in signs.items() if ring.generators[k].kind == "parameter"}
    for name in ring.names():
        number = fmpq(source.randint(1, 99), source.choice((64, 16)))
        values[name] = number * plain.get(name, source.choice((1, -1)))
    return values


def _has_signs(ring: Ring, signs: Mapping[int, int], values: Mapping[str, Any]) -> bool:
    """Whether the generators have these signs at the point."""
    open_ = ((k, sign) for k, sign in signs.items() if ring.generators[k].kind != "parameter")
    return all(ring.evaluate(ring.context.gen(k), values) * sign > 0 for k, sign in open_)


def _is_allowed(system: System, values: Mapping[str, fmpq]) -> bool:
    """Whether the assumptions hold at the point: sqrt((a - b)**2) is b - a under a < b."""
    if not system.assumptions:
        return True
    known = {name: rationals.fraction(x) for name, x in values.items()}
    for relation in system.relations:
        value = number_of(relation.value, known)
        if value is None:
            return True
        known[relation.name] = value
    return next(broken(system, known), None) is None


def _opened_roots(derived: Derived, x: Polynomial, signs: Mapping[int, int]) -> Polynomial:
    """x with sqrt(r^2 p) = +-r sqrt(p) for every root, r of known sign."""
    ring = derived.ring
    images, degrees = {}, x.degrees()
    for k, g in enumerate(ring.generators[: ring.spare]):
        if g.kind != "root" or degrees[k] <= 0 or g.argument.is_constant():
            continue
        content, factors = ring.factored(g.argument)
        outside, inside = ring.one, ring.context.constant(content)
        for factor, exponent in factors:
            index = _generator(factor)
            sign = signs[index] if index in signs else _SIGN.get(derived.signs.sign(factor), 0)
            if sign:
                outside = ring.times(outside, (factor * sign) ** (exponent // 2))
                exponent %= 2
            inside = ring.times(inside, factor**exponent)
        if not outside.is_one():
            images[k] = ring.times(outside, ring.square_root(inside))
    return ring.substitute(x, images) if images else x


def _generator(x: Polynomial) -> int:
    """The generator that x is a positive multiple of, or -1."""
    if len(x) != 1 or sum(map(int, x.monomial(0))) != 1 or not x.coefficient(0) > 0:
        return -1
    return [int(e) for e in x.monomial(0)].index(1)


# The comparison.


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
    occurring = symbols.occurring(expressions)
    lower = symbols.in_scene(scene)
    return {name: in_parameters(derived, lower(Name(name))) for name in symbols.values if name in occurring}


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
    repairs, likely = [], []
    needed = _parameters(ring, coefficient)
    for name, slope in slopes.items():
        ratio = rational_ratio(combined, slope)
        if ratio is not None:
            repairs.append((name, Formula(ring, ring.reduce(-coefficient * ratio))))
            if needed <= _parameters(ring, values[name]):
                likely.append(repairs[-1])
    return tuple(likely or repairs)


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
            shorter = ring.lowest_terms(top, bottom)
            if any(_accelerations(ring, x) for x in shorter):
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
        factor = ring.ratio(top, bottom)
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
    key = min(second, key=lambda monomial: len(first[monomial]) + len(second[monomial]))
    top, bottom = ring.lowest_terms(first[key], second[key])
    if len(top) > 1 or len(bottom) > 1:
        return None
    if not ring.is_zero(ring.times(claimed, bottom) - ring.times(truth, top)):
        return None
    return Formula(ring, ring.ratio(top, bottom))
