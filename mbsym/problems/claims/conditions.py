"""Claimed conditions of stability: those of problem 6, or refuted by exact parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.expressions.tree import (
    subtract,
    text,
)
from mbsym.model.claims import NECESSARY, SUFFICIENT, Claim
from mbsym.problems.claims.counterexample import (
    Counterexample,
)
from mbsym.problems.claims.differences import rational_ratio
from mbsym.problems.claims.forms import in_parameters, on_relations
from mbsym.problems.claims.result import EXACT, FAILS, UNDECIDED, ClaimResult, Derived
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.stability.theory import (
    ASYMPTOTIC,
    ASYMPTOTIC_BUT_CYCLIC,
    ASYMPTOTIC_BUT_TURNED,
    GYROSCOPIC,
    STABLE,
    STABLE_BUT_CYCLIC,
    UNSTABLE,
)

#: Verdicts of a motion that is stable; the last is about the first approximation only.
_LINEARLY_STABLE = (
    STABLE,
    ASYMPTOTIC,
    STABLE_BUT_CYCLIC,
    ASYMPTOTIC_BUT_CYCLIC,
    ASYMPTOTIC_BUT_TURNED,
    GYROSCOPIC,
)


def examined_condition(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """Looks for the inequality among those of problem 6, factors of known sign apart, then for a counterexample.

    Sufficient conditions of one place may be refuted together even where each is one of those of problem 6.
    """
    ring, scene = derived.ring, derived.parameters_scene
    symbols = Symbols(derived.system)
    assert claim.right is not None
    sides = [claim.equals, claim.right]
    lower = symbols.lowering(ring, scene.environment, symbols.occurring(sides))
    left, right = (lower(symbols.opened(side)) for side in sides)
    strict = claim.relation in ("<", ">", "!=")
    if claim.relation in ("<", "<="):
        left, right = right, left
    result = ClaimResult(claim, about, EXACT)
    if claim.role == SUFFICIENT:
        refuted = _contradicted(derived, claim, result)
        if refuted is not None:
            return refuted
    for own in (True, False):  # in the description's own symbols, then in declared parameters
        try:
            wanted = _essential(derived, claim, left - right, own)
            known = list(_conditions(derived, claim, own))
            for same in (_proportional, partial(_same_condition, derived.signs)):
                for what, found, relation in known:
                    if same(wanted, found, relation == "!="):
                        equal = strict == (relation in (">", "!="))
                        note = what + ("" if equal else ", but for the case of equality")
                        if claim.role == SUFFICIENT:
                            note += "; no parameters that were tried refute that those of its place are sufficient"
                        return replace(result, remark=note)
            kind = "" if claim.relation == "!=" else derived.signs.condition(wanted).kind
        except NoClosedForm:
            if own:
                raise
            break
        if kind == "always" and claim.role != SUFFICIENT:
            return replace(result, remark="it follows from the declared signs and assumptions")
        if kind == "never":
            return replace(result, outcome=FAILS, remark="with the declared signs and assumptions it never holds")
    refuted = None if claim.role == SUFFICIENT else _contradicted(derived, claim, result)
    if refuted is not None:
        return refuted
    remark = "it is not one of the conditions of problem 6 as they stand there; no parameters that were tried refute it"
    return replace(result, outcome=UNDECIDED, remark=remark)


def _contradicted(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """The claim refuted by parameters: stable without it, or (where it is to be sufficient) unstable with it."""
    sufficient = claim.role == SUFFICIENT
    together = [claim]
    if sufficient and claim.place:
        shared = (claim.kind, claim.role, claim.place)
        together = [one for one in derived.system.claims if (one.kind, one.role, one.place) == shared]
    find = partial(_counterexample, derived, together, sufficient)
    found = find() if len(together) == 1 else derived.trials.once(claim.place, find)
    if found is None:
        return None
    if sufficient:
        subject = "it is" if len(together) == 1 else "the conditions of this place together are"
        remark = f"{subject} not sufficient for stability"
    else:
        in_first = dict(found.shows)["the motion"] == GYROSCOPIC
        remark = "it is not necessary for stability" + (" in the first approximation" if in_first else "")
    return replace(result, outcome=FAILS, remark=remark, counterexample=found)


def _counterexample(derived: Derived, together: Sequence[Claim], sufficient: bool) -> Counterexample | None:
    """Parameters that refute these conditions; None where none are found, or the formulas are too long."""
    symbols = Symbols(derived.system)
    environment = derived.parameters_scene.environment

    def claimed(numbers: Any, values: Mapping[str, Any]) -> list[tuple[str, Any, str]]:
        found = []
        for one in together:
            assert one.right is not None
            sides = [one.equals, one.right]
            lower = symbols.lowering(numbers, values, symbols.occurring(sides))
            left, right = (lower(symbols.opened(side)) for side in sides)
            found.append((text(subtract(one.equals, one.right)), left - right, one.relation))
        return found

    try:
        claimed(derived.ring, environment)  # its budgets end what would be too long as numbers, too
        return derived.trials.counterexample(claimed, sufficient, (UNSTABLE,) if sufficient else _LINEARLY_STABLE)
    except NoClosedForm:
        return None


def _conditions(derived: Derived, claim: Claim, own: bool) -> Iterator[tuple[str, Polynomial, str]]:
    """What a condition of problem 6 is called, the polynomial that has to be positive (or not zero), the relation."""
    for part in derived.stability.subsystems:
        whose = ", ".join(part.coordinates)
        sufficient = () if claim.role == NECESSARY else part.sufficient
        for found, note in (
            ((*part.conditions, *part.unreduced, *sufficient), ""),
            (part.guaranteed, ": it holds, the kinetic energy is positive definite"),
        ):
            for label, formula, relation in found:
                polynomial = _essential(derived, claim, formula.polynomial, own)
                yield f"it is the condition {label} of {whose}{note}", polynomial, relation


def _essential(derived: Derived, claim: Claim, x: Polynomial, own: bool) -> Polynomial:
    """x in its ``own`` symbols, or in declared parameters with relations used; denominators cleared by their signs."""
    ring = derived.ring
    whole = x if own else on_relations(derived, claim, in_parameters(derived, x))
    numerator, denominators = ring.fraction(whole)
    for factor, exponent in denominators:
        if exponent % 2 and derived.signs.sign(factor) != "positive":
            numerator = ring.times(numerator, factor)
    return numerator


def _proportional(first: Polynomial, second: Polynomial, unequal: bool) -> bool:
    ratio = rational_ratio(first, second)
    return ratio is not None and (unequal or ratio > 0)


def _same_condition(signs: Signs, first: Polynomial, second: Polynomial, unequal: bool) -> bool:
    """Whether two polynomials are positive together (nonzero together) for all parameters."""
    decide = signs.nonzero_condition if unequal else signs.condition
    one, other = decide(first), decide(second)
    if one.kind != other.kind or one.kind not in ("inequality", "nonzero"):
        return False
    return one.polynomial == other.polynomial and sorted(map(str, one.nonzero)) == sorted(map(str, other.nonzero))
