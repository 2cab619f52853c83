"""What is said of problem 10: sentences with gaps, filled by whoever writes them (terminal, LaTeX, HTML)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from mbsym.formulas.formula import Formula
from mbsym.problems.invariant_sets import (
    Definiteness,
    Family,
    FirstApproximation,
    Gap,
    InvariantSets,
    Kind,
    Relation,
    SecondVariation,
    StationarySet,
)
from mbsym.report.words.said import Said


@dataclass(frozen=True)
class Medium:
    """How a medium writes names, ``formula relation 0``, ``name = formula``, ``name' = formula``, a formula, a word."""

    names: Callable[[Sequence[str]], str]
    condition: Callable[[Formula, str], str]
    value: Callable[[str, Formula], str]
    rate: Callable[[str, Formula], str]
    formula: Callable[[Formula], str]
    even: Callable[[Sequence[Formula]], str]
    word: Callable[[str], str]


def opening(found: InvariantSets, write: Medium) -> Iterator[Said]:
    """What the families are made of."""
    yield (
        "Families K of first integrals with constant multipliers; a motion that begins where grad K = 0 stays there.",
        {},
    )
    for k, (name, formula) in enumerate(found.integrals):
        yield "V[[k]], [[name]]: [[formula]].", {"k": k, "name": write.word(name), "formula": write.formula(formula)}
    if found.left_out:
        names = ", ".join(map(write.word, found.left_out))
        yield (
            "Left out of the families, as functions of these (verified at a random state): [[names]].",
            {"names": names},
        )
    if found.relations:
        relations = ", ".join(write.condition(one, "=") for one in found.relations)
        yield "Between the variables: [[relations]].", {"relations": relations}
        text = "Of the zero roots of a first approximation so many belong to these relations, and to no motion: [[n]]."
        yield text, {"n": len(found.relations)}
    yield "What is said of stability is about these variables: [[names]].", {"names": write.names(found.variables)}
    if found.in_angles and found.relations:
        yield "Multipliers of the geometry are Lagrange's: along a motion only the others are constant.", {}


def told_families(found: InvariantSets) -> list[Family]:
    """Those of which there is something to tell; where there is nothing of any of them, that."""
    return [one for one in found.families if not _is_empty(one)] or list(found.families)


def _is_empty(family: Family) -> bool:
    return not (family.sets or family.unfinished or family.singular or family.parts)


def family_title(family: Family, whole: InvariantSets) -> str:
    """``K = V0 + lambda1 V1 + lambda2 V2``, in letters that every medium has."""
    first = len(whole.integrals) - len(family.integrals)
    terms = [f"{name}*V{first + k + 1}" for k, name in enumerate(family.multipliers)]
    return " + ".join([f"V{first}", *terms])


def of_family(family: Family, write: Medium) -> Iterator[Said]:
    if _is_empty(family):
        yield "It has no stationary points for almost all parameters (proved).", {}
    if family.unfinished:
        yield (
            "Branches left aside, because they are beyond the budget or no point of them was found: [[n]]; some may be "
            "empty, and there may be further sets.",
            {"n": family.unfinished},
        )
    if family.singular:
        yield (
            "Branches on which the coordinates are singular, left aside: [[n]]; some may have no real points.",
            {"n": family.singular},
        )
    if family.parts:
        yield "Pieces that are not invariant by themselves, left aside: [[n]].", {"n": family.parts}


def of_set(one: StationarySet, number: int, write: Medium) -> Iterator[Said]:
    """What is known of one set."""
    equations = [write.value(name, x) for name, x in one.solved] + [write.condition(x, "=") for x in one.relations]
    gaps: dict[str, object] = {
        "number": number,
        "equations": ", ".join(equations),
        "dimension": one.dimension,
        "union": one.union,
    }
    if one.kind is Kind.STEADY:
        yield "Set [[number]], steady motions: [[equations]].", gaps
        if one.union:
            yield "They form a family of dimension [[union]].", gaps
    else:
        text = "Set [[number]], an invariant manifold of dimension [[dimension]] for fixed multipliers: [[equations]]."
        yield text, gaps
    if one.nonzero:
        yield "There [[nonzero]].", {"nonzero": ", ".join(write.condition(x, "!=") for x in one.nonzero)}
    told = [write.value(name, x) for name, x in one.multipliers if x is not None]
    if told:
        yield "Multipliers: [[told]].", {"told": ", ".join(told)}
    if one.motion:
        yield "On it: [[motion]].", {"motion": ", ".join(write.rate(name, x) for name, x in one.motion)}
    yield _INVARIANT[one.invariant], {}
    if not one.real:
        yield "No real point was found at the parameters that were tried: whether it has any is open.", {}
    if one.variation is not None:
        yield from _variation(one, one.variation, write)
    if one.first is not None:
        yield from _first(one.first, write)
        yield from _gap(one)


_INVARIANT = {
    True: "It is invariant (proved: d/dt of its equations vanishes on it).",
    None: "That it is invariant was not verified: d/dt of its equations could not be reduced on it.",
    False: "It is NOT invariant by the equations of motion: this is a defect of mbsym.",
}


def _all(relations: Sequence[Relation], write: Medium) -> str:
    return ", ".join(write.condition(one.formula, one.relation) for one in relations)


def _variation(one: StationarySet, found: SecondVariation, write: Medium) -> Iterator[Said]:
    if not one.invariant:
        return
    steady = one.kind is Kind.STEADY
    if found.outcome is Definiteness.STABLE:
        yield (
            (
                "Stable (proved: the second variation of K on the level of the integrals is definite)."
                if steady
                else "Stable as a set, near motions on it that stay bounded (proved: K is definite across it)."
            ),
            {},
        )
    elif found.outcome is Definiteness.CONDITIONAL:
        sides = [_all(side, write) for side in (found.positive, found.negative) if side is not None]
        chosen: dict[str, object] = {"chosen": write.names(found.chosen), "first": sides[0], "second": sides[-1]}
        if found.chosen and steady:
            yield "Sufficient for stability, for some value of [[chosen]]: [[first]].", chosen
        elif found.chosen:
            yield _AS_A_SET_FOR_SOME, chosen
        elif steady:
            yield "Sufficient for stability: [[first]].", chosen
        else:
            yield "Sufficient for stability as a set, near motions on it that stay bounded: [[first]].", chosen
        if len(sides) == 2:
            yield "Or, with K of the other sign: [[second]].", chosen
    else:
        yield _NOTHING[found.outcome], {}


_AS_A_SET_FOR_SOME = (
    "Sufficient for stability as a set, near motions on it that stay bounded, for some value of [[chosen]]: [[first]]."
)
_NOTHING = {
    Definiteness.NEVER: "The second variation is never definite: this family decides nothing about stability.",
    Definiteness.DEGENERATE: "The second variation is degenerate: this family decides nothing about stability.",
    Definiteness.LEFT_OUT: "The second variation was not looked at: it is beyond the budget.",
    Definiteness.VARYING: "Its stability was not looked at: multipliers vary over it.",
}


def _first(found: FirstApproximation, write: Medium) -> Iterator[Said]:
    if found.factors:
        factors = ", ".join(write.even(factor) for factor in found.factors)
        if found.left:
            text = "First approximation: zero roots: [[zeros]]; among the others are the roots of [[factors]]."
            yield text, {"zeros": found.zeros, "factors": factors}
        elif found.zeros:
            text = "First approximation: zero roots: [[zeros]]; the others are roots of [[factors]]."
            yield text, {"zeros": found.zeros, "factors": factors}
        else:
            yield "First approximation: roots of [[factors]].", {"factors": factors}
    if found.left:
        text = "Roots of factors that are not even in lambda, not looked at here but for signs of coefficients: [[n]]."
        yield text, {"n": found.left}
    if found.unstable:
        yield "Unstable (proved by the first approximation).", {}
        return
    plain = [one for one in found.necessary if not one.unless]
    if plain:
        yield "Necessary for stability: [[conditions]].", {"conditions": _all(plain, write)}
    for one in found.necessary:
        if one.unless:
            unless = " or ".join(write.condition(x, "=") for x in one.unless)
            gaps: dict[str, object] = {"condition": _all([one], write), "unless": unless}
            yield "Necessary for stability: [[condition]], unless [[unless]].", gaps
    if not found.complete:
        yield "Further necessary conditions were not written out.", {}


def _gap(one: StationarySet) -> Iterator[Said]:
    if one.gap is Gap.FOUND:
        yield (_GAP_FOR_SOME if one.variation is not None and one.variation.chosen else _GAP), {}
    elif one.gap is Gap.NONE_FOUND:
        yield _NO_GAP, {}


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


def closing(found: InvariantSets, write: Medium) -> Iterator[Said]:
    if found.generic:
        zeros = ", ".join(write.condition(one, "!=") for one in found.generic)
        yield "All this is for parameters with [[zeros]]; others were not looked at.", {"zeros": zeros}
