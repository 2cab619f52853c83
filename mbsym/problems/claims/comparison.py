"""A claimed formula against the derived one: equal, on the relations, up to a factor, or different by exactly this."""

from __future__ import annotations

from dataclasses import replace

from mbsym.algebra.ring import Polynomial
from mbsym.formulas.formula import Formula
from mbsym.model.claims import CLAIMS, SUMS, Claim
from mbsym.problems.claims.differences import differing
from mbsym.problems.claims.forms import in_parameters, is_moving, on_relations
from mbsym.problems.claims.multiples import closest_multiple, constant_factor
from mbsym.problems.claims.result import (
    EQUIVALENT,
    EXACT,
    FACTOR,
    NUMERICAL,
    RELATIONS,
    SCALED,
    UNDECIDED,
    ClaimResult,
    Derived,
)
from mbsym.problems.claims.signs_under_roots import decided
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.integrals import total_rate


def examined_formula(
    derived: Derived, claim: Claim, about: str, symbols: Symbols, claimed: Polynomial, truth: Polynomial
) -> ClaimResult:
    ring = derived.ring
    result = ClaimResult(claim, about, EXACT, Formula(ring, truth))
    homogeneous = CLAIMS[claim.kind].homogeneous
    if ring.is_zero(claimed - truth):  # in the description's own symbols, if both are written in them
        return result
    if homogeneous:
        multiple = closest_multiple(derived, claim, claimed, truth)
        if multiple is not None and multiple.verdict == (EXACT, ""):
            return replace(result, outcome=FACTOR, factor=multiple.factor, remark=multiple.remark)
    own = ring.reduce(claimed - truth)
    claimed, truth = in_parameters(derived, claimed), in_parameters(derived, truth)
    difference = ring.reduce(claimed - truth)
    if ring.is_zero(difference):
        return result
    exact = EXACT
    related = on_relations(derived, claim, difference)
    if related != difference:
        claimed, truth = on_relations(derived, claim, claimed), on_relations(derived, claim, truth)
        difference, exact = related, RELATIONS
    outcome, where = decided(derived, difference)
    if outcome == EXACT:
        return replace(result, outcome=exact, where=where)
    if outcome in (NUMERICAL, UNDECIDED):
        return replace(result, outcome=outcome, where=where, difference=Formula(ring, difference))
    if homogeneous:
        return _up_to_multiple(derived, result, symbols, claimed, truth, min(difference, own, key=len))
    factor = constant_factor(derived, claimed, truth)
    if factor is not None:
        return replace(result, outcome=SCALED, factor=factor)
    if claim.kind in SUMS and _same_equations(derived, difference):
        remark = "it differs by a constant"
        if is_moving(derived, difference):
            remark = "the equations of motion are the same"
        if _allows(derived, claim, difference):
            return replace(result, outcome=EQUIVALENT, difference=Formula(ring, difference), remark=remark)
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
    found = replace(result, factor=multiple.factor, remark=multiple.remark)
    outcome, where = multiple.verdict
    if outcome == EXACT:
        return replace(found, outcome=FACTOR, where=where)
    if outcome in (NUMERICAL, UNDECIDED):
        difference = Formula(derived.ring, multiple.difference)
        return replace(found, outcome=outcome, where=where, difference=difference)
    return differing(derived, replace(found, remark=""), symbols, multiple.difference)


def _same_equations(derived: Derived, difference: Polynomial) -> bool:
    """Whether d/dt dD/dq'_i - dD/dq_i vanishes identically for every coordinate: D = dF(q, t)/dt."""
    ring, scene = derived.ring, derived.parameters_scene
    for name in derived.system.coordinates:
        momentum = ring.velocity_derivative(difference, name)
        if ring.is_zero(total_rate(scene, momentum) - ring.derivative(difference, name)) is not True:
            return False
    return True
