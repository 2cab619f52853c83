"""Claims about systems with speeds and unit vectors of their own, in the variables of these.

A claim holds if claimed - derived vanishes wherever unit vectors are orthonormal and quaternions of norm 1; an equation
also if it is a multiple of the derived one by parameters, or a combination of all of them.  A first integral is decided
by its rate along the motion.  Matrices, characteristic polynomials and conditions are those of the first approximation
in coordinates.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.expressions.rates import without_velocity
from mbsym.formulas.formula import Formula
from mbsym.mechanics.motion import relations
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.claims import Claim
from mbsym.problems.claims.equations import NOT_LINEAR, NOTHING, SAME_ACCELERATIONS, Dynamics, along_motion
from mbsym.problems.claims.integrals import of_positions, substituted
from mbsym.problems.claims.quantities import derived_quantity
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome, in_parameters, scene_of_claims
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.constraints.integrals import AlongMotion
from mbsym.problems.in_speeds import SpeedEquations

#: Quantities that are the same whatever the variables are; those of one body among them.
_QUANTITIES = (
    "kinetic energy", "force function", "potential energy", "lagrangian", "angular velocity",
    "relative angular velocity", "direction cosine", "position", "velocity",
)  # fmt: skip


def examined(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """One claim.  Raises NoClosedForm where it is about something that is not derived in speeds."""
    form = derived.form
    scene = scene_of_claims(derived)
    claimed = in_parameters(derived, Symbols.of(derived).polynomial(scene, claim))
    if claim.kind == "first integral":
        return _integral(derived, form, claim, about, claimed)
    truth = in_parameters(derived, _derived(derived, form, claim))
    result = ClaimResult(claim, about, Outcome.EXACT, Formula(form.ring, truth))
    images = relations(derived.parameters_scene)
    difference = form.ring.reduce(claimed - truth)
    known = form.vanishes(difference)
    if known is True:
        return result
    if claim.kind == "equation of motion":
        if form.vanishes(form.ring.substitute(claimed, images)) is True:
            return replace(result, outcome=Outcome.UNDECIDED, remark=NOTHING)
        factor = _factor(form, claimed, truth)
        if factor is not None:
            return replace(result, outcome=Outcome.FACTOR, factor=Formula(form.ring, factor))
    if images:
        difference = form.ring.substitute(difference, images)
        known = form.vanishes(difference)
        if known is True:
            return replace(result, outcome=Outcome.RELATIONS)
    outcome = Outcome.UNDECIDED if known is None else Outcome.DIFFERS
    result = replace(result, outcome=outcome, difference=Formula(form.ring, difference))
    return _along(derived, form, result, claimed) if claim.kind == "equation of motion" else result


def _along(derived: Derived, form: SpeedForm, own_result: ClaimResult, claimed: Polynomial) -> ClaimResult:
    """A claimed equation that is no multiple of the own one: a combination of all, or what it differs by from one."""
    ring, images = form.ring, relations(derived.parameters_scene)
    dynamics = Dynamics.of(derived)

    def verdict(left: Polynomial) -> tuple[str, str]:
        known = form.vanishes(ring.substitute(left, images) if images else left)
        return Outcome.UNDECIDED if known is None else Outcome.EXACT if known else Outcome.DIFFERS, ""

    try:
        (outcome, _), made = along_motion(dynamics, claimed, verdict)
    except Failure:
        remark = "whether it vanishes on every motion is not decided: the equations are too long"
        return replace(own_result, outcome=Outcome.UNDECIDED, difference=None, remark=remark)
    plain = replace(own_result, outcome=outcome, difference=None)
    if outcome == Outcome.EXACT:
        remark = NOT_LINEAR if made is None else made.words(dynamics, derived, without_velocity(own_result.claim.of))
        return replace(plain, outcome=Outcome.ALONG, remark=remark)
    if outcome == Outcome.UNDECIDED:
        return replace(plain, remark="whether it vanishes on every motion is not decided")
    if made is not None and made.coefficients and own_result.difference is not None:
        whole = made.equation(dynamics)
        rest = form.shortened(ring.reduce(claimed - whole))
        if not ring.vanishes(rest) and len(rest) < len(own_result.difference.polynomial):
            result = replace(own_result, derived=Formula(ring, whole), difference=Formula(ring, rest))
            return replace(result, outcome=Outcome.DIFFERS, remark=SAME_ACCELERATIONS)
    return replace(own_result, outcome=Outcome.DIFFERS)


def _derived(derived: Derived, form: SpeedForm, claim: Claim) -> Polynomial:
    names = derived.system.claimable
    if claim.kind in _QUANTITIES:
        return derived_quantity(derived, claim)
    equations = cast(SpeedEquations, derived.equations)
    if claim.kind == "mass matrix":
        rows = [_speed(form, names[k - 1]) for k in claim.entry]
        return equations.mass_matrix[rows[0], rows[1]].polynomial
    if claim.kind == "equation of motion":
        for position in form.positions:
            if position.name == claim.of and claim.of in derived.system.variables:
                return form.ring.context.gen(position.rate_index) - form.rates[claim.of]
        return equations.equality(_speed(form, claim.of)).polynomial
    if claim.kind == "acceleration":
        top, bottom = Dynamics.of(derived).solved(_speed(form, claim.of))
        return form.ring.ratio(top, bottom)
    raise NoClosedForm("a claim about the [[kind]]: not judged in speeds", kind=Message(claim.kind))


def _speed(form: SpeedForm, name: str) -> int:
    """The place of a speed, or of the generalised velocity of a coordinate that is one."""
    for r, u in enumerate(form.speeds):
        if name in (u.name, without_velocity(u.name)):
            return r
    raise NoClosedForm("the velocity of [[name]] is no speed: other speeds have taken its place", name=name)


def _factor(form: SpeedForm, claimed: Polynomial, truth: Polynomial) -> Polynomial | None:
    """Parameters lambda, not zero, with claimed = lambda truth; None where there are none."""
    ring = form.ring
    for variable in (*form.speeds, *form.positions):
        first, second = claimed.derivative(variable.rate_index), truth.derivative(variable.rate_index)
        held = ring.dependencies(first, [x.name for x in (*form.positions, *form.speeds)])
        if ring.vanishes(first) or ring.vanishes(second) or held:
            continue
        if form.vanishes(ring.times(second, claimed) - ring.times(first, truth)) is True:
            return ring.ratio(first, second)
    return None


def _integral(derived: Derived, form: SpeedForm, claim: Claim, about: str, claimed: Polynomial) -> ClaimResult:
    ring, equations = form.ring, cast(SpeedEquations, derived.equations)
    result = ClaimResult(claim, about, Outcome.EXACT, Formula(ring, claimed))
    if not ring.dependencies(claimed, [u.name for u in form.speeds]):
        return of_positions(form, result, claimed)
    images = relations(derived.parameters_scene)
    motion = AlongMotion(form, equations)
    outcome, known = Outcome.EXACT, motion.keeps(claimed)
    if known is not True and images:
        outcome, claimed = Outcome.RELATIONS, ring.substitute(claimed, images)
        motion = AlongMotion(form, substituted(ring, equations, images))
        known = motion.keeps(claimed)
    if known is True:
        slopes = [ring.derivative(claimed, u.name) for u in form.speeds]
        if all(form.vanishes(slope) is True for slope in slopes):
            return replace(result, outcome=Outcome.FAILS, remark="it is a constant, whatever the motion")
        return replace(result, outcome=outcome)
    rate = motion.rate_in_lowest_terms(claimed)
    return replace(result, outcome=Outcome.UNDECIDED if known is None else Outcome.FAILS, difference=rate)
