"""Claims about constrained systems, in their coordinates or speeds.

Energies, places and velocities are those of the bodies; a claimed one that differs in general may still be the same
wherever the constraints hold.  An equation of motion is an expression that vanishes on every motion, so that neither
multipliers nor a choice of independent velocities matter; a first integral one whose rate does.  Both are tried at
exact states on the constraints with the accelerations of the equations without multipliers, and proved in the ring
(``mbsym.problems.constraints.integrals``).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

from flint import arb, ctx

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.constraints.programs import constrained_programs
from mbsym.mechanics.constraints.ranks import is_certain
from mbsym.mechanics.constraints.states import PRECISION, OnManifold
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import accelerated
from mbsym.model.claims import SUMS, Claim
from mbsym.model.system import System
from mbsym.problems.claims.comparison import examined_formula
from mbsym.problems.claims.counterexample import Counterexample, shown
from mbsym.problems.claims.equations import NOTHING, power_of
from mbsym.problems.claims.integrals import TOO_FEW_STATES, of_positions
from mbsym.problems.claims.quantities import IN_MOMENTA, derived_quantity
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome, in_parameters, scene_of_claims
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.constraints.integrals import STATES, AlongMotion
from mbsym.problems.constraints.result import Constraints

#: Digits of the numbers of a state that refutes a claim.
DIGITS_SHOWN = 8
#: A printed state keeps a constraint if it misses it by less than this part of 1 and of the row's size.
KEPT = 1e-6

ON_CONSTRAINTS = "with the velocities that the constraints allow"
FROM_CONSTRAINTS = "it follows from the constraints alone"


def examined(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """One claim; raises NoClosedForm for what is not judged under constraints."""
    if claim.kind in IN_MOMENTA or claim.kind.startswith(("state matrix", "linear matrix B")):
        raise NoClosedForm("a claim about the [[kind]]: not judged under constraints", kind=Message(claim.kind))
    if claim.kind == "coefficient" and claim.of not in SUMS:
        raise NoClosedForm("a coefficient of an equation, which multipliers complete: not judged under constraints")
    symbols, ring = Symbols.of(derived), derived.ring
    claimed = symbols.polynomial(scene_of_claims(derived), claim)
    if claim.kind == "first integral":
        return _integral(derived, ClaimResult(claim, about, Outcome.EXACT, Formula(ring, claimed)))
    if claim.kind == "acceleration":
        own = derived.form.accelerations.get(claim.of)
        own = ring.generator("velocity", claim.of) if own is None else own
        return _equation(derived, ClaimResult(claim, about, Outcome.EXACT, Formula(ring, own - claimed)))
    if claim.kind == "equation of motion":
        return _equation(derived, ClaimResult(claim, about, Outcome.EXACT, Formula(ring, claimed)))
    if derived.system.speeds:
        from mbsym.problems.claims import in_speeds  # few systems have speeds of their own

        result = in_speeds.examined(derived, claim, about)
    else:
        result = examined_formula(derived, claim, about, symbols, claimed, derived_quantity(derived, claim))
    if not result.refuted or claim.kind in ("mass matrix", "coefficient") or result.derived is None:
        return result
    return _on_constraints(derived, result, in_parameters(derived, claimed - result.derived.polynomial))


# --- along the motion ---


def _along(derived: Derived) -> AlongMotion:
    """Raises NoClosedForm where the dependent velocities are too long."""
    equations, system = derived.equations, derived.system.without_speeds
    tied = equations.constraints
    if tied.solved is None:
        raise NoClosedForm("the equations without multipliers have no closed form within the budget")
    programs = constrained_programs(system, derived.ring, [(name.constraint, name.component) for name in tied.names])
    return AlongMotion(derived.form, equations, programs)


def _integral(derived: Derived, result: ClaimResult) -> ClaimResult:
    """dI/dt = 0 along every motion, and I not a constant on the constraints."""
    ring, form, along = derived.ring, derived.form, _along(derived)
    claimed = _polynomial(derived, result)
    if not ring.dependencies(claimed, [u.name for u in form.speeds]):
        moving = ring.dependencies(claimed, [x.name for x in form.positions])
        if moving and along.vanishes(form.rate(claimed)):
            return replace(result, remark=FROM_CONSTRAINTS)
        return of_positions(form, result, claimed)
    if all(
        form.vanishes(x) is True for x in along.along_speeds([ring.derivative(claimed, u.name) for u in form.speeds])
    ):
        remark = "with the velocities that the constraints allow it contains none"
        return replace(result, outcome=Outcome.FAILS, remark=remark)
    known = [item.formula.polynomial for item in _integrals(derived) if item.status is Certainty.PROVED]
    if any(along.vanishes(claimed - integral) for integral in known):
        return result
    return _vanishing(derived, along, result, form.rate(claimed), "dI/dt")


def _integrals(derived: Derived) -> Any:
    """Problem 7's, as far as it has a result."""
    try:
        return derived.integrals
    except NOT_THERE:
        return ()


def _equation(derived: Derived, result: ClaimResult) -> ClaimResult:
    """The claimed expression vanishes along every motion, and is felt by an independent acceleration."""
    ring, form, along = derived.ring, derived.form, _along(derived)
    claimed = _polynomial(derived, result)
    x = along.in_motion(claimed)
    if ring.vanishes(claimed):
        return replace(result, outcome=Outcome.UNDECIDED, remark=NOTHING)
    equation = result.claim.kind == "equation of motion"
    what = "the claimed expression" if equation else "derived - claimed"
    claim_result = _vanishing(derived, along, result, x, what)
    slopes = along.along_speeds([x.derivative(u.rate_index) for u in form.speeds])
    if claim_result.holds and equation and all(form.vanishes(slope) is True for slope in slopes):
        return replace(claim_result, remark=FROM_CONSTRAINTS) if x == claimed else claim_result
    return claim_result


def _polynomial(derived: Derived, result: ClaimResult) -> Polynomial:
    assert result.derived is not None
    return in_parameters(derived, result.derived.polynomial)


def _vanishing(derived: Derived, along: AlongMotion, result: ClaimResult, x: Polynomial, what: str) -> ClaimResult:
    """Whether x = 0 along every motion: proved, verified at states, or refuted by one."""
    ring = derived.ring
    values = along.values(x)
    wrong = next(((on_manifold, value) for on_manifold, value in values if is_certain(value)), None)
    if wrong is not None and not derived.system.relations:
        with ctx.workprec(PRECISION):
            return replace(result, outcome=Outcome.FAILS, counterexample=_example(derived, *wrong, what))
    linear = power_of(ring, x, [u.rate_index for u in derived.form.speeds]) <= 1
    if wrong is None and linear and along.proves_zero(x):
        return result
    if wrong is not None:
        remark = "it does not vanish for all parameters; whether it does on their relations is not decided here"
        return replace(result, outcome=Outcome.UNDECIDED, remark=remark)
    if len(values) < STATES or ring.kinked:
        return replace(result, outcome=Outcome.UNDECIDED, remark=TOO_FEW_STATES)
    return replace(result, outcome=Outcome.NUMERICAL, remark="at exact states on the constraints")


def _example(derived: Derived, on_manifold: OnManifold, value: Any, what: str) -> Counterexample:
    """The state, in decimals, and what does not vanish there."""
    state, system = on_manifold.enclosed.state, derived.system
    names = [*system.parameter_names, *system.coordinates, *system.velocities]
    at = [(name, shown(state.values[name], DIGITS_SHOWN)) for name in names if name in state.values]
    return Counterexample(tuple(at), ((what, shown(arb(value), DIGITS_SHOWN)),))


def _on_constraints(derived: Derived, result: ClaimResult, difference: Polynomial) -> ClaimResult:
    """What differs in general may be equal wherever the constraints hold."""
    tied = derived.equations.constraints
    if tied.solved is None:
        return result
    along = _along(derived)
    left = along.restricted(difference)
    if derived.form.vanishes(left) is True:
        return ClaimResult(result.claim, result.title, Outcome.EXACT, result.derived, remark=ON_CONSTRAINTS)
    if along.vanishes_at_states(left) and not derived.ring.kinked:
        return ClaimResult(
            result.claim, result.title, Outcome.NUMERICAL, result.derived, remark="at states on the constraints"
        )
    return result


# --- numbers ---


def accelerated_at(system: System, ring: Ring, tied: Constraints, state: State) -> State:
    """The state with the accelerations of M q'' = f + J^T lambda, J q'' = -gamma, in balls.

    Raises SingularPoint where these are not determined, NoClosedForm where the state does not keep the constraints.
    """
    names = [tied.names[i] for i in tied.independent]
    programs = constrained_programs(system, ring, [(name.constraint, name.component) for name in names])
    n, m, program = len(system.coordinates), len(names), programs.tree.program
    nodes = [x for row in programs.jacobian for x in row] + [*programs.velocity]
    nodes += [program.zero if x is None else x for x in programs.position]
    parts = map(arb, program.evaluate(nodes, state.values, state.numbers))
    rows = [list(islice(parts, n)) for _ in range(m)]
    for kind, errors in ((Message("velocity"), list(islice(parts, m))), (Message("position"), list(islice(parts, m)))):
        for name, row, error in zip(names, rows, errors, strict=True):
            if abs(error) > KEPT * (1 + sum((abs(x) for x in row), arb(0))):
                raise NoClosedForm(
                    "the state does not keep [[label]] ([[kind]]: off by [[error]])",
                    label=name.label,
                    kind=kind,
                    error=shown(abs(error), 3),
                )
    return accelerated(system, state, programs.tree, programs.jacobian, programs.acceleration)
