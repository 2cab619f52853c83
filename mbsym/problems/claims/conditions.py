"""Claimed conditions of stability: proved from those of problem 6, refuted by exact parameters, or left undecided.

With R the parameters at which every condition of problem 6 holds, and N those at which none of its inequalities is
reversed (R in N; outside N a root has a positive real part: the motion is unstable), a claimed condition C is

* one of problem 6, if it is the same inequality up to factors of known sign;
* necessary for stability, if N lies in C;
* necessary for asymptotic stability, if R lies in C and all roots lie to the left in R only;
* necessary for stability in the first approximation, if without it K of a conservative part is singular: q = q0 + q1 t;
* necessary but for border cases, if R lies in C: in N but outside R, nothing is proved;
* sufficient, if with C (and the others of its place) the cases of problem 6 give every subsystem a stable verdict.

That one set lies in another is proved by ``mbsym.algebra.signs``, or not at all.  Parameters that are no body's are
left out: where it helps, the triangle inequalities of the moments of inertia are used, and the remark says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.signs import ContradictionError, Signs
from mbsym.expressions.tree import subtract, text
from mbsym.model.claims import NECESSARY, SUFFICIENT, Claim
from mbsym.problems.claims.counterexample import Counterexample
from mbsym.problems.claims.differences import rational_ratio
from mbsym.problems.claims.regions import Inequality, Region, is_certain
from mbsym.problems.claims.result import BORDERS, EXACT, FAILS, UNDECIDED, ClaimResult, Derived
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.stability.sentences import with_theorem
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.word import Word

#: Verdicts of a motion that is stable, if only in first approximation.
_LINEARLY_STABLE = (*(word for word in Word if word.stable), Word.GYROSCOPIC)
_BODIES = ", with the triangle inequalities of the inertias"


def examined_condition(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """The claimed inequality against problem 6.

    Sufficient conditions of one place count together.
    """
    result = ClaimResult(claim, about, EXACT)
    examined = _sufficient if claim.role == SUFFICIENT else _necessary
    return examined(derived, claim, result)


# --- necessary conditions, and those without a role ---


def _necessary(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult:
    regions = list(forms(derived, claim))
    for region in regions:
        found = trivial(region, wanted_of(region, claim), result) or one_of_problem_6(region, claim, result)
        if found is not None:
            return found
    for region in regions:
        found = _needed(region, claim, result)
        if found is not None:
            return found
    refuted = _contradicted(derived, claim, result)
    if refuted is not None:
        return refuted
    for region in regions:
        found = _inside(derived, region, claim, result)
        if found is not None:
            return found
    remark = "it is not one of the conditions of problem 6 as they stand there; no parameters that were tried refute it"
    return replace(result, outcome=UNDECIDED, remark=remark)


def forms(derived: Derived, claim: Claim) -> Iterator[Region]:
    """What problem 6 requires in the description's own symbols, then in declared parameters."""
    yield Region(derived, claim, own=True)
    try:
        yield Region(derived, claim, own=False)
    except NoClosedForm:
        return


def wanted_of(region: Region, claim: Claim) -> Inequality:
    """The claimed inequality as p > 0, p >= 0 or p != 0.  Raises NoClosedForm."""
    derived = region.derived
    symbols = Symbols.of(derived)
    assert claim.right is not None
    lower = symbols.in_scene(derived.parameters_scene)
    left, right = (lower(symbols.opened(side)) for side in (claim.equals, claim.right))
    if claim.relation in ("<", "<="):
        left, right = right, left
    return Inequality(region.cleared(left - right), {"<": ">", "<=": ">="}.get(claim.relation, claim.relation))


def trivial(region: Region, wanted: Inequality, result: ClaimResult) -> ClaimResult | None:
    """What the declared signs, assumptions and the inertias of bodies decide by themselves."""
    known = "the declared signs and assumptions"
    for signs, what in (
        (region.signs, known),
        (region.signs_of_bodies, f"{known} and the triangle inequalities of the inertias"),
    ):
        if is_certain(signs, wanted):
            return replace(result, remark=f"it follows from {what}")
        if is_certain(signs, wanted.negated()):
            return replace(result, outcome=FAILS, remark=f"with {what} it never holds")
    return None


def one_of_problem_6(region: Region, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """The claim without a role that is a condition of problem 6, perhaps but for the case of equality."""
    if claim.role == NECESSARY:
        return None
    wanted = wanted_of(region, claim)
    what, equality = _found_among(region, wanted, ())
    if not what:
        return None
    if not equality:
        return replace(result, remark=what)
    outcome = EXACT if is_certain(region.not_unstable(), wanted) else BORDERS
    return replace(result, outcome=outcome, remark=f"{what}, but for the case of equality")


def _found_among(region: Region, wanted: Inequality, left_out: Sequence[str]) -> tuple[str, bool]:
    """ "it is the condition v0 of x" and whether it differs in the case of equality; "" where it is none of them."""
    for same in (_proportional, partial(_same_condition, region.signs)):
        for what, found in region.conditions(left_out):
            if (wanted.relation == "!=") == (found.relation == "!=") and same(wanted, found):
                return what, wanted.relation != found.relation
    return "", False


def _needed(region: Region, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """Proofs that nothing on the borders can contradict: of necessity for stability, or for asymptotic stability."""
    wanted = wanted_of(region, claim)
    what, _ = _found_among(region, wanted, ("sufficient",))
    for bodies in (False, True):
        note = _BODIES if bodies else ""
        if is_certain(region.not_unstable(bodies), wanted):
            why = what or f"it follows from {region.labels()}{note}"
            return replace(result, remark=f"{why}; without it the motion is unstable")
        if is_certain(region.inside(bodies, asymptotic=True), wanted):
            why = what or f"it follows from {region.labels(asymptotic=True)}{note}"
            return replace(result, remark=f"{why}; it is necessary for asymptotic stability")
    return None


def _inside(derived: Derived, region: Region, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """Proofs that leave borders open; a border where the motion is stable after all refutes a strict inequality."""
    wanted = wanted_of(region, claim)
    what, _ = _found_among(region, wanted, ("sufficient",))
    singular = region.makes_stiffness_singular(wanted.polynomial)
    for bodies in (False, True):
        why = what or f"it follows from {region.labels()}{_BODIES if bodies else ''}"
        weak = replace(wanted, relation=">=")
        on_all = wanted.relation == "!=" or is_certain(region.not_unstable(bodies), weak)
        if singular and on_all:
            remark = "stability in the first approximation needs it"
            return replace(result, remark=f"{what}; {remark}" if what else remark)
        if wanted.relation != "!=" and is_certain(region.inside(bodies), wanted):
            remark = f"{why}; where it or another condition is an equality, nothing is proved"
            return replace(result, outcome=BORDERS, remark=remark)
    return None


def _proportional(first: Inequality, second: Inequality) -> bool:
    ratio = rational_ratio(first.polynomial, second.polynomial)
    return ratio is not None and (first.relation == "!=" or ratio > 0)


def _same_condition(signs: Signs, first: Inequality, second: Inequality) -> bool:
    """Whether two polynomials are positive together (nonzero together) for all parameters."""
    decide = signs.nonzero_condition if first.relation == "!=" else signs.condition
    one, other = decide(first.polynomial), decide(second.polynomial)
    if one.kind != other.kind or one.kind not in ("inequality", "nonzero"):
        return False
    return one.polynomial == other.polynomial and sorted(map(str, one.nonzero)) == sorted(map(str, other.nonzero))


# --- sufficient conditions ---


def _sufficient(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult:
    refuted = _contradicted(derived, claim, result)
    if refuted is not None:
        return refuted
    together = _of_its_place(derived, claim)
    subject = "it" if len(together) == 1 else "the conditions of this place together"
    remark = f"{subject} {'is' if len(together) == 1 else 'are'} neither proved sufficient nor refuted by parameters"
    for region in forms(derived, claim):
        conditions = [wanted_of(region, one) for one in together]
        known = trivial(region, conditions[together.index(claim)], result)
        if known is not None and known.outcome == FAILS:
            return known
        for bodies in (False, True):
            found = region.verdict_with(conditions, bodies)
            if found is None:
                continue
            if found.word.stable:
                with_it = "with it" if len(together) == 1 else f"with {subject}"
                note = f"{with_it}{_BODIES if bodies else ''} the motion is {with_theorem(found.word, found.theorem)}"
                return replace(result, remark=note)
            if found.word in (Word.GYROSCOPIC, Word.CRITICAL):
                remark = f"in the first approximation {subject} suffice{'s' if len(together) == 1 else ''}; " + (
                    "whether the motion itself is stable is open"
                )
    found = _by_integrals(derived, claim, together)
    if found is not None:
        note = f"{'with it' if len(together) == 1 else f'with {subject}'} the motion is "
        return replace(result, remark=note + with_theorem(found.word, found.theorem))
    return replace(result, outcome=UNDECIDED, remark=remark)


def _by_integrals(derived: Derived, claim: Claim, together: Sequence[Claim]) -> Verdict | None:
    """The verdict of a combination of integrals where the conditions of one place hold."""
    from mbsym.problems.claims import by_integrals  # few claims need it

    try:
        region = Region(derived, claim, own=False)
        facts = [wanted_of(region, one) for one in together]
        known = region.signs.assuming((x.polynomial, x.relation) for x in facts if not x.polynomial.is_constant())
        return by_integrals.verdict_with(derived, known)
    except (ContradictionError, NoClosedForm):
        return None


def _of_its_place(derived: Derived, claim: Claim) -> list[Claim]:
    """The sufficient conditions that count together with this one."""
    if claim.role != SUFFICIENT or not claim.place:
        return [claim]
    shared = (claim.kind, claim.role, claim.place)
    return [one for one in derived.system.claims if (one.kind, one.role, one.place) == shared]


# --- parameters that refute ---


def _contradicted(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """The claim refuted by parameters: stable without it, or (where it is to be sufficient) unstable with it."""
    together = _of_its_place(derived, claim)
    find = partial(_counterexample, derived, claim, together)
    found = find() if len(together) == 1 else derived.trials.once(claim.place, find)
    if found is None:
        return None
    if claim.role == SUFFICIENT:
        subject = "it is" if len(together) == 1 else "the conditions of this place together are"
        remark = f"{subject} not sufficient for stability"
    else:
        in_first = found.word is Word.GYROSCOPIC
        remark = "it is not necessary for stability" + (" in the first approximation" if in_first else "")
        if claim.relation in ("<", ">") and found.at_equality:
            remark += ": with equality, too, the motion is stable"
    return replace(result, outcome=FAILS, remark=remark, counterexample=found)


def _counterexample(derived: Derived, claim: Claim, together: Sequence[Claim]) -> Counterexample | None:
    """Parameters that refute these conditions; None where none are found, or the formulas are too long.

    A condition that is to be necessary is tried on its border, too: at equality the motion may be stable.
    """
    symbols = Symbols.of(derived)
    environment = derived.parameters_scene.environment
    sufficient = claim.role == SUFFICIENT

    sides = []
    for one in together:
        assert one.right is not None
        said = text(subtract(one.equals, one.right))
        both = [one.equals, one.right]
        sides.append((said, [symbols.opened(side) for side in both], symbols.occurring(both), one.relation))

    def claimed(numbers: Any, values: Mapping[str, Any]) -> list[tuple[str, Any, str]]:
        found = []
        for said, (left, right), occurring, relation in sides:
            lower = symbols.lowering(numbers, values, occurring)
            found.append((said, lower(left) - lower(right), relation))
        return found

    try:
        claimed(derived.ring, environment)  # its budgets end what would be too long as numbers, too
        found = derived.trials.counterexample(claimed, sufficient, (Word.UNSTABLE,) if sufficient else _LINEARLY_STABLE)
        if found is not None or sufficient or claim.relation in ("<=", ">="):
            return found
        border = wanted_of(Region(derived, claim, own=False), claim).polynomial
        among = derived.trials.where_zero(border)
        return derived.trials.counterexample(claimed, sufficient, _LINEARLY_STABLE, among)
    except NoClosedForm:
        return None
