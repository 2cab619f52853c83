"""What is said of problem 10.

Names are those of ``ring``, in which the formulas are: sines and cosines have names of their own there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from mbsym.algebra.ring import Ring
from mbsym.expressions.message import worded
from mbsym.formulas.formula import Formula
from mbsym.problems.invariant_sets.result import (
    Definiteness,
    Family,
    FirstApproximation,
    Gap,
    InvariantSets,
    Kind,
    SecondVariation,
    StationarySet,
)
from mbsym.problems.invariant_sets.result import Relation as Sign
from mbsym.report.content import Gaps, Math, Name, Notation, Polynomial, Relation, Said, compared, joined, named, say


def ring_of(invariant_sets: InvariantSets) -> Ring | None:
    """The ring of its formulas."""
    return next((x.ring for _, x in invariant_sets.integrals), None)


def opening(invariant_sets: InvariantSets) -> Iterator[Said]:
    """What the families are made of."""
    yield Said(
        "Families $K$ of first integrals with constant multipliers; a motion that begins where $\\mathrm{grad}\\, K = "
        "0$ stays there."
    )
    if invariant_sets.inputs:
        values = ", ".join(f"{name} = {value}" for name, value in invariant_sets.inputs)
        yield say("The inputs are constant, as on the unperturbed motion: [[values]].", values=values)
    for k, (name, formula) in enumerate(invariant_sets.integrals):
        yield say("[[symbol]], [[name]]: [[formula]].", symbol=_integral(k), name=worded(name), formula=formula)
    if invariant_sets.left_out:
        names = tuple(map(worded, invariant_sets.left_out))
        yield say(
            "Left out of the families, as functions of these (verified at a random state): [[names]].", names=names
        )
    if invariant_sets.relations:
        yield say("Between the variables: [[relations]].", relations=compared(invariant_sets.relations))
        text = "Of the zero roots of a first approximation so many belong to these relations, and to no motion: [[n]]."
        yield say(text, n=str(len(invariant_sets.relations)))
    yield say(
        "What is said of stability is about these variables: [[names]].",
        names=named(invariant_sets.variables, ring_of(invariant_sets)),
    )
    if invariant_sets.in_angles and invariant_sets.relations:
        yield Said("Multipliers of the geometry are Lagrange's: along a motion only the others are constant.")


def told_families(invariant_sets: InvariantSets) -> list[Family]:
    """Those of which there is something to tell; where there is nothing of any of them, that."""
    return [family for family in invariant_sets.families if not _is_empty(family)] or list(invariant_sets.families)


def _is_empty(family: Family) -> bool:
    return not (family.sets or family.unfinished or family.singular or family.parts)


def family_title(family: Family, whole: InvariantSets) -> Relation:
    """K = V0 + lambda1 V1 + lambda2 V2."""
    first = len(whole.integrals) - len(family.integrals)
    parts: list[Math | str] = [Notation("K"), "=", _integral(first)]
    for k, name in enumerate(family.multipliers, start=first + 1):
        parts += ["+", Name(name, ring=ring_of(whole)), _integral(k)]
    return Relation(*parts)


def _integral(k: int) -> Notation:
    return Notation(f"V_{{{k}}}")


def of_family(family: Family) -> Iterator[Said]:
    if _is_empty(family):
        yield Said("It has no stationary points for almost all parameters (proved).")
    if family.unfinished:
        yield say(
            "Branches left aside, because they are beyond the budget or no point of them was found: [[n]]; some may be "
            "empty, and there may be further sets.",
            n=str(family.unfinished),
        )
    if family.singular:
        yield say(
            "Branches on which the coordinates are singular, left aside: [[n]]; some may have no real points.",
            n=str(family.singular),
        )
    if family.parts:
        yield say("Pieces that are not invariant by themselves, left aside: [[n]].", n=str(family.parts))


def of_set(stationary_set: StationarySet, number: int, ring: Ring | None) -> Iterator[Said]:
    """What is known of one set."""
    gaps: Gaps = {
        "number": str(number),
        "equations": (*_values(stationary_set.solved, ring), *compared(stationary_set.relations)),
        "dimension": str(stationary_set.dimension),
        "union": str(stationary_set.union),
    }
    if stationary_set.kind is Kind.STEADY:
        yield Said("Set [[number]], steady motions: [[equations]].", gaps)
        if stationary_set.union:
            yield Said("They form a family of dimension [[union]].", gaps)
    else:
        text = "Set [[number]], an invariant manifold of dimension [[dimension]] for fixed multipliers: [[equations]]."
        yield Said(text, gaps)
    if stationary_set.nonzero:
        yield say("There [[nonzero]].", nonzero=compared(stationary_set.nonzero, "!="))
    relations = _values([(name, x) for name, x in stationary_set.multipliers if x is not None], ring)
    if relations:
        yield say("Multipliers: [[told]].", told=relations)
    rates = dict(stationary_set.solved)
    motion = [
        (name, x) for name, x in stationary_set.motion if str(x) not in (f"{name}_dot", str(rates.get(f"{name}_dot")))
    ]
    if motion:  # that y' is y', or what an equation of the set says, is told already
        yield say("On it: [[motion]].", motion=_values(motion, ring, 1))
    yield Said(_INVARIANT[stationary_set.invariant])
    if not stationary_set.real:
        yield Said("No real point was found at the parameters that were tried: whether it has any is open.")
    if stationary_set.variation is not None:
        yield from _variation(stationary_set, stationary_set.variation, ring)
    if stationary_set.first is not None:
        yield from _first(stationary_set.first)
        yield from _gap(stationary_set)


_INVARIANT = {
    True: "It is invariant (proved: d/dt of its equations vanishes on it).",
    None: "That it is invariant was not verified: d/dt of its equations could not be reduced on it.",
    False: "It is NOT invariant by the equations of motion: this is a defect of mbsym.",
}


def _values(pairs: Iterable[tuple[str, Formula]], ring: Ring | None, dots: int = 0) -> tuple[Relation, ...]:
    return tuple(Relation(Name(name, dots, ring), "=", x) for name, x in pairs)


def _all(signs: Iterable[Sign]) -> tuple[Relation, ...]:
    return tuple(Relation(sign.formula, sign.relation, 0) for sign in signs)


def _variation(stationary_set: StationarySet, variation: SecondVariation, ring: Ring | None) -> Iterator[Said]:
    if not stationary_set.invariant:
        return
    steady = stationary_set.kind is Kind.STEADY
    if variation.outcome is Definiteness.STABLE:
        yield Said(
            "Stable (proved: the second variation of $K$ on the level of the integrals is definite)."
            if steady
            else "Stable as a set, near motions on it that stay bounded (proved: $K$ is definite across it)."
        )
    elif variation.outcome is Definiteness.CONDITIONAL:
        sides = [_all(side) for side in (variation.positive, variation.negative) if side is not None]
        chosen: Gaps = {"chosen": named(variation.chosen, ring), "first": sides[0], "second": sides[-1]}
        if variation.chosen and steady:
            yield Said("Sufficient for stability, for some value of [[chosen]]: [[first]].", chosen)
        elif variation.chosen:
            yield Said(_AS_A_SET_FOR_SOME, chosen)
        elif steady:
            yield Said("Sufficient for stability: [[first]].", chosen)
        else:
            yield Said("Sufficient for stability as a set, near motions on it that stay bounded: [[first]].", chosen)
        if len(sides) == 2:
            yield Said("Or, with $K$ of the other sign: [[second]].", chosen)
    else:
        yield Said(_NOTHING[variation.outcome])


_AS_A_SET_FOR_SOME = (
    "Sufficient for stability as a set, near motions on it that stay bounded, for some value of [[chosen]]: [[first]]."
)
_NOTHING = {
    Definiteness.NEVER: "The second variation is never definite: this family decides nothing about stability.",
    Definiteness.DEGENERATE: "The second variation is degenerate: this family decides nothing about stability.",
    Definiteness.LEFT_OUT: "The second variation was not looked at: it is beyond the budget.",
    Definiteness.VARYING: "Its stability was not looked at: multipliers vary over it.",
}


def _first(approximation: FirstApproximation) -> Iterator[Said]:
    if approximation.factors:
        factors = tuple(map(_even, approximation.factors))
        if approximation.left:
            text = "First approximation: zero roots: [[zeros]]; among the others are the roots of [[factors]]."
            yield say(text, zeros=str(approximation.zeros), factors=factors)
        elif approximation.zeros:
            text = "First approximation: zero roots: [[zeros]]; the others are roots of [[factors]]."
            yield say(text, zeros=str(approximation.zeros), factors=factors)
        else:
            yield say("First approximation: roots of [[factors]].", factors=factors)
    if approximation.left:
        text = (
            "Roots of factors that are not even in $\\lambda$, not looked at here but for signs of coefficients: [[n]]."
        )
        yield say(text, n=str(approximation.left))
    if approximation.unstable:
        yield Said("Unstable (proved by the first approximation).")
        return
    plain = [condition for condition in approximation.necessary if not condition.unless]
    if plain:
        yield say("Necessary for stability: [[conditions]].", conditions=_all(plain))
    for relation in approximation.necessary:
        if relation.unless:
            unless = joined(compared(relation.unless), " ", Said("or"), " ")
            gaps: Gaps = {"condition": _all([relation]), "unless": unless}
            yield Said("Necessary for stability: [[condition]], unless [[unless]].", gaps)
    if not approximation.complete:
        yield Said("Further necessary conditions were not written out.")


def _even(factor: Sequence[Formula]) -> Polynomial:
    """A polynomial in lambda^2, lowest coefficient first."""
    zero = factor[0] * 0
    return Polynomial(tuple(x for formula in factor for x in (formula, zero))[:-1], "lambda")


def _gap(stationary_set: StationarySet) -> Iterator[Said]:
    if stationary_set.gap is Gap.FOUND:
        yield Said(_GAP_FOR_SOME if stationary_set.variation is not None and stationary_set.variation.chosen else _GAP)
    elif stationary_set.gap is Gap.NONE_FOUND:
        yield Said(_NO_GAP)


_GAP = (
    "Between them is a gap: a point was found at which what is necessary holds strictly and what is sufficient does "
    "not; there this family decides nothing."
)
_GAP_FOR_SOME = (
    "Between them is perhaps a gap: a point was found at which what is necessary holds strictly and what is sufficient "
    "for no multipliers that were tried."
)
_NO_GAP = (
    "At every point that was tried where the necessary conditions held strictly the sufficient ones held, too: no gap "
    "was found, which is no proof that there is none."
)


def closing(invariant_sets: InvariantSets) -> Iterator[Said]:
    if invariant_sets.generic:
        text = "All this is for parameters with [[zeros]]; others were not looked at."
        yield say(text, zeros=compared(invariant_sets.generic, "!="))
