"""Claimed first integrals: dI/dt on the equations of motion, and a state where it is not zero."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import product as combinations_of

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.expressions.tree import names, reached
from mbsym.formulas.formula import Formula, Matrix, column
from mbsym.mechanics.motion import relations
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.claims import Claim
from mbsym.problems.claims.comparison import MOST_SIGNS, decided, restriction, signs_under_roots
from mbsym.problems.claims.counterexample import against_constancy, rate_at_states
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome
from mbsym.problems.equations import Equations
from mbsym.problems.integrals import is_conserved, is_proved, rate_on_motion, total_rate

TOO_FEW_STATES = "there are too few states at which it could be tried"
#: c x' = -k (x - y), c y' = k (x - y): x + y is one.
WITHOUT_INERTIA = "it contains no velocity; whether it is constant where coordinates carry no inertia is not decided"


def of_positions(form: SpeedForm, result: ClaimResult, claimed: Polynomial) -> ClaimResult:
    """What holds no velocity: of unit vectors and quaternions alone it is known, else it is no integral."""
    vectors = [name for body in form.oriented for vector in body.orientation for name in vector.components]
    if form.ring.dependencies(claimed, vectors) and form.vanishes(form.rate(claimed)) is True:
        what = Message("unit vectors") if form.by_vectors else Message("quaternion")
        return replace(result, remark=Message("of the [[what]] alone: it is known beforehand", what=what))
    return replace(result, outcome=Outcome.FAILS, remark="it contains no velocity")


def examined_integral(derived: Derived, claim: Claim, about: str, claimed: Polynomial) -> ClaimResult:
    """dI/dt = 0 on the equations of motion, as they stand or with the relations between parameters used."""
    scene, ring, equations = derived.scene, derived.ring, derived.equations
    result = ClaimResult(claim, about, Outcome.EXACT, Formula(ring, claimed))
    if not ring.dependencies(claimed, derived.system.velocities):
        light = (row for row in equations.mass_matrix if all(ring.vanishes(x.polynomial) for x in row))
        if any(True for _ in light) and ring.dependencies(claimed, derived.system.coordinates):
            return replace(result, outcome=Outcome.UNDECIDED, remark=WITHOUT_INERTIA)
        return of_positions(derived.form, result, claimed)
    outcome = Outcome.EXACT
    for outcome in (Outcome.EXACT, Outcome.RELATIONS):
        if outcome == Outcome.RELATIONS:
            images = relations(derived.parameters_scene)
            if not images:
                break
            claimed = ring.substitute(claimed, images)
            equations = substituted(ring, equations, images)
        conserved = is_conserved(scene, equations, claimed)
        if conserved:
            constant = _constant_where(derived, claimed)
            if constant is not None:
                message = Message("it is a constant, whatever the motion")
                if constant:
                    message = Message("it is a constant [[where]], whatever the motion", where=constant)
                return replace(result, outcome=Outcome.FAILS, remark=message)
            if is_proved(scene, equations, claimed):
                return replace(result, outcome=outcome)
            decision, where = _conserved_where(derived, equations, claimed)
            if decision != Outcome.DIFFERS:
                return replace(result, outcome=outcome if decision == Outcome.EXACT else decision, where=where)
    rate = total_rate(scene, claimed)
    difference = _rate_of(derived, equations, claimed)
    if difference is None:
        parts = [rate, *(x.polynomial for row in equations.mass_matrix for x in row)]
        parts += [x.polynomial for x in equations.forcing]
    else:
        parts = [difference.polynomial]
    used = _names_in(derived, parts)
    timely = ["t", *(item.name for item in derived.system.prescribed)]
    if any(ring.dependencies(x, timely) for x in parts):
        used.add("t")
    if difference is not None and difference.is_zero:
        return replace(result, outcome=outcome)
    example = against_constancy(derived.system, ring, derived.programs, rate, used)
    if example is None and conserved is None:
        return replace(result, outcome=Outcome.UNDECIDED, difference=difference, remark=TOO_FEW_STATES)
    remark = "" if difference is not None else "dI/dt does not vanish on the equations of motion"
    return replace(result, outcome=Outcome.FAILS, difference=difference, remark=remark, counterexample=example)


def _conserved_where(derived: Derived, equations: Equations, claimed: Polynomial) -> tuple[str, str]:
    """What became of dI/dt = 0 for the signs that are not declared: EXACT, NUMERICAL or DIFFERS, and where."""
    scene, ring = derived.scene, derived.ring
    fraction = rate_on_motion(scene, equations, claimed)
    if fraction is not None:
        outcome, where = decided(derived, fraction[0])
        if outcome != Outcome.UNDECIDED:
            return outcome, where
    rate = total_rate(scene, claimed)
    parts = [rate, *(x.polynomial for row in equations.mass_matrix for x in row)]
    _, under = signs_under_roots(derived, *parts, *(x.polynomial for x in equations.forcing))
    unknown = [ring.generators[k].name for k in under if ring.generators[k].kind in ("coordinate", "parameter")]
    for pattern in combinations_of((1, -1), repeat=min(len(unknown), MOST_SIGNS)):
        negative = [name for name, sign in zip(unknown, pattern, strict=False) if sign < 0]
        positive = [name for name in unknown if name not in negative]
        states = rate_at_states(derived.system, ring, derived.programs, rate, negative, positive)
        if any(not value.contains(0) for _, value in states):
            return (Outcome.NUMERICAL, restriction(unknown, len(unknown) == 1)) if negative else (Outcome.DIFFERS, "")
    return Outcome.NUMERICAL, "" if len(unknown) <= MOST_SIGNS else restriction(unknown, False)


def _constant_where(derived: Derived, claimed: Polynomial) -> str | None:
    """ "", or "for v > 0", where no derivative by a velocity is different from zero; None if one is.

    sqrt(v**2)/v is 1 or -1, and sqrt(v**2) - v is 0 for v > 0.
    """
    ring = derived.ring
    slopes = [ring.velocity_derivative(claimed, name) for name in derived.system.coordinates]
    decisions = [decided(derived, slope) for slope in slopes]
    if any(outcome not in (Outcome.EXACT, Outcome.NUMERICAL) for outcome, _ in decisions):
        return None
    where = next((where for _, where in decisions if where), "")
    return Message("for [[positive]]", positive=where.gaps["positive"]) if isinstance(where, Message) else ""


def _rate_of(derived: Derived, equations: Equations, claimed: Polynomial) -> Formula | None:
    """dI/dt on the equations of motion in lowest terms; None where that is too long."""
    ring = derived.ring
    try:
        fraction = rate_on_motion(derived.scene, equations, claimed)
        if fraction is None:
            return None
        return Formula(ring, ring.ratio(*ring.lowest_terms(*fraction)))
    except Failure:
        return None


def _names_in(derived: Derived, values: Iterable[Polynomial]) -> set[str]:
    """Coordinates, velocities, inputs and parameters in the values, those that relations are made of included."""
    ring, system = derived.ring, derived.system
    variables = [*system.coordinates, *system.velocities, *system.input_names]
    occurring: set[str] = set()
    for x in values:
        occurring |= set(ring.dependencies(x, variables))
        occurring |= {g.name for k, g in enumerate(ring.generators) if g.kind == "parameter" and _holds(ring, x, k)}
    made_of = {item.name: names(item.value) for item in system.relations}
    return reached(made_of, occurring)


def _holds(ring: Ring, x: Polynomial, index: int) -> bool:
    """Whether a generator occurs in x, in what its reciprocals, roots and functions are made of included."""
    degrees = x.degrees()
    if degrees[index] > 0:
        return True
    inner = (g.argument for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0)
    return any(argument is not None and _holds(ring, argument, index) for argument in inner)


def substituted(ring: Ring, equations: Equations, images: Mapping[int, Polynomial]) -> Equations:
    def moved(x: Formula) -> Polynomial:
        return ring.substitute(x.polynomial, images)

    return replace(
        equations,
        mass_matrix=Matrix.of(ring, [[moved(x) for x in row] for row in equations.mass_matrix]),
        forcing=column(ring, [moved(x) for x in equations.forcing]),
    )
