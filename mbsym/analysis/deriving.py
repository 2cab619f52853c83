"""How the results of the pipeline are derived where that takes more than a line: which module, for which system."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.matrices import determinant
from mbsym.analysis import approximation, constrained, given, higher
from mbsym.analysis.judge import Judge
from mbsym.analysis.poles import pole
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.analysis.where import by_sign
from mbsym.expressions.message import Message, joined, worded
from mbsym.mechanics.kinematics import over_ring
from mbsym.mechanics.motion import relations, unperturbed_with
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.mechanics.rotation_orders import Reordered, rotation_orders
from mbsym.model.substitution import with_free_rates
from mbsym.problems import dissipation, energy, equilibrium, integrals
from mbsym.problems.checks import EXACT, NUMERICAL
from mbsym.problems.dissipation import Balance
from mbsym.problems.energy import Energy
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.stability import problem as stability
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.verdict import undecided
from mbsym.problems.stability.words import Because, Word
from mbsym.problems.telling import ToldSystem, told_system

if TYPE_CHECKING:
    from mbsym.algebra.ring import Polynomial
    from mbsym.analysis.pipeline import Analysis
    from mbsym.model.system import System
    from mbsym.problems.constrained_balance import ConstrainedBalance
    from mbsym.problems.constraints.motion import Embedded, Turned
    from mbsym.problems.first_order import FirstOrder
    from mbsym.problems.in_speeds import SpeedEquations
    from mbsym.problems.linearisation import Reduction, Subsystem
    from mbsym.problems.relative_equilibria.equilibria import Equilibria
    from mbsym.problems.stabilisation.result import Stabilisation
    from mbsym.problems.state_space import StateSpace


def energy_of(analysis: Analysis) -> Energy:
    """T, U and their parts, in speeds where the system has some."""
    return energy.energy(analysis.scene, analysis.form if analysis.system.speeds else None)


def stability_of(analysis: Analysis) -> Stability:
    """The verdicts of problem 6; open ones are looked at further, in other angles where those given do not serve."""
    try:
        judgement = _judged(analysis)
    except Unavailable as failure:
        other = in_other_angles(analysis) if failure.failure.code in ("time-dependent", "not-steady") else None
        if other is None:
            raise
        return other
    judgement = _of_a_family(analysis, judgement)
    return (in_other_angles(analysis) if judgement.verdict.coordinates_singular else None) or judgement


def _of_a_family(analysis: Analysis, judgement: Stability) -> Stability:
    """With the verdict at the values where zero roots are those of steady motions at other rates.

    A rate may be a number in the description: the motion is the same as with a parameter of that value.
    """
    here = judgement.numerical
    if here is None or not analysis.system.constraints or not here.because(Because.MORE_ZERO_ROOTS):
        return judgement
    system = with_free_rates(analysis.system)
    if system is analysis.system:
        return judgement
    try:
        there = type(analysis)(system, (), analysis.terms, suggests=False).stability.numerical
    except (Failure, *NOT_THERE):
        return judgement
    known = there is not None and not there.because(Because.MORE_ZERO_ROOTS)
    return replace(judgement, numerical=there) if known else judgement


def in_other_angles(analysis: Analysis) -> Stability | None:
    """The verdict on a body's steady spin in a rotation sequence in which that is steady and regular; None without one.

    The unperturbed motion is the same: stability is a property of it, not of angles.
    """
    for other, there in in_steady_angles(analysis):
        axes = ", ".join(map(str, other.axes))
        return stability.because(there.stability, Because.OTHER_ANGLES, other.body, axes, ", ".join(other.angles))
    return None


def in_steady_angles(analysis: Analysis) -> Iterator[tuple[Reordered, Analysis]]:
    """Analyses in rotation sequences in which a body's spin is steady and regular."""
    for other in rotation_orders(analysis.system) if analysis.suggests else ():
        there = type(analysis)(other.system, (), analysis.terms, suggests=False)
        there.__dict__["ring"] = analysis.ring
        try:
            with there.strictly():
                judgement = there.stability
        except Failure:
            continue
        if not judgement.verdict.coordinates_singular:
            yield other, there


def _leading(part: Subsystem) -> list[list[Polynomial]]:
    """M; of coordinates that follow by equations of first order (zero rows of M) D + G among each other."""
    mass = [list(row) for row in part.M.polynomials]
    following = [i for i, row in enumerate(mass) if all(x.is_zero() for x in row)]
    for i in following:
        for j in following:
            mass[i][j] = part.D.polynomials[i][j] + part.G.polynomials[i][j]
    return mass


def _demand_regular(analysis: Analysis) -> None:
    """Raises Unavailable where M is singular on the motion: K says nothing about stability there."""
    ring, parts = analysis.ring, analysis.judgeable.subsystems
    if analysis.system.linear is not None or all(
        ring.is_zero(determinant(ring, _leading(x))) is not True for x in parts
    ):
        return
    reason = (
        "the mass matrix is singular on the motion (coordinates are singular there, or what moves has no mass): "
        "no theorem about stabilisation applies"
    )
    hint = ""
    for other, _ in in_steady_angles(analysis):
        axes, angles = ", ".join(map(str, other.axes)), ", ".join(other.angles)
        hint = Message(
            "with 'rotation: {axes: [[[axes]]], angles: [[[angles]]]}' of body '[[body]]' it is derived",
            axes=axes,
            angles=angles,
            body=other.body,
        )
        break
    raise Unavailable("stabilisation", NoResult(reason, hint, "singular coordinates", "singular-coordinates"))


def _judged(analysis: Analysis) -> Stability:
    scene, linear = analysis.parameters_scene, analysis.judgeable
    judgement = stability.stability(scene, analysis.balance, linear, analysis.equilibrium, analysis.signs)
    judge = Judge(analysis)
    if judgement.verdict.word in (Word.UNDECIDED, Word.CRITICAL) and judge.may_add(judgement.verdict):
        verdict = higher.of_one_coordinate(analysis, judgement.verdict)
        verdict = judge.for_all(verdict)
        further = higher.by_reduced_potential(analysis) if verdict.word is Word.UNDECIDED else None
        judgement = stability.with_verdict(judgement, further or verdict)
        if judgement.verdict.word.open:
            judgement = by_sign(analysis, judgement)
        if judgement.verdict.word.open and judgement.numerical is None:
            judgement = stability.because(judgement, Because.VALUES_DECIDE)
    values = None if judgement.numerical is None else stability.parameter_values(scene, analysis.equilibrium)
    divisor = None if values is None or analysis.system.linear is not None else pole(analysis, values)
    if divisor is not None:
        return replace(judgement, numerical=undecided(Because.POLE, divisor), spectra=())
    if judgement.numerical is None or values is None:
        return judgement
    judged, general = judgement.numerical, judgement.verdict
    weaker = general.because(Because.FEWER_CONSTRAINTS)  # than what rests near by may say
    if judged.word.open and higher.decided(general.word) and judge.may_add(judged) and not weaker:
        judged = general  # for all values, and so for these
    else:
        judged = judge.decided(judged, values)
    before = judgement.numerical if judged.because(Because.TERMS_OF_HIGHER_ORDER) else None
    if general.word.open and not judged.word.open and not analysis.system.parameters:
        judgement = stability.with_verdict(judgement, judged)  # there are no other values
    return replace(judgement, numerical=judged, before_higher_order=before)


def stabilisation_of(analysis: Analysis) -> Stabilisation:
    """Problem 8, with numbers where the description gives all of them."""
    from mbsym.problems.stabilisation import problem  # few ask for it

    steady_state, linear = analysis.equilibrium, analysis.judgeable  # raises first where there is no such motion
    approximation.refuse_unsolved(steady_state)
    _demand_regular(analysis)
    values = stability.parameter_values(analysis.parameters_scene, steady_state)
    if values is not None and not problem.on_motion(analysis.parameters_scene, steady_state, values):
        values = None
    return problem.stabilisation(analysis.parameters_scene, linear, analysis.signs, values)


def equilibrium_of(analysis: Analysis) -> Equilibrium:
    """Whether the given motion satisfies the equations."""
    if analysis.system.linear is not None:
        return given.at_zero()
    residuals = [x.polynomial for x in analysis.residuals]
    on_motion = bool(analysis.system.constraints)
    there = analysis.reduced.expansion.scene
    singular = () if on_motion else equilibrium.singular_displacements(there, lambda: analysis.expanded)
    residuals += approximation.beside(analysis, singular)
    return equilibrium.equilibrium(analysis.parameters_scene, residuals, analysis.signs, on_motion, singular)


def balance_of(analysis: Analysis) -> Balance:
    """What the energy does on the motion."""
    if analysis.system.linear is not None:
        return given.balance(analysis)
    energies = analysis.optional("energy")
    if analysis.system.constraints:
        from mbsym.problems.constrained_balance import ConstrainedBalance

        tied = analysis.optional("constraints")
        redundant = () if tied is None or tied.in_speeds else tied.redundant
        proved = frozenset(row.name for row in redundant if row.certainty is Certainty.PROVED)
        about = analysis.reduced.about
        balance = ConstrainedBalance(analysis.scene, energies, analysis.signs, {}, about=about, following=proved)
        return balance if about.holonomic or about.leaf else _with_steady_motions(analysis, balance)
    return dissipation.balance(
        analysis.parameters_scene if energies is None else analysis.held_scene, energies, analysis.signs
    )


def _with_steady_motions(analysis: Analysis, balance: ConstrainedBalance) -> ConstrainedBalance:
    """Of a nonholonomic system: with the position that velocities follow, and the dimension of the steady motions.

    The dimension is found by the equations, or by first integrals that are proved.
    """
    from mbsym.problems.constraints.motion import oscillating_position

    about = analysis.reduced.about
    derived = analysis.optional("equations")
    ring, embedded = analysis.ring, None if derived is None else derived.embedded
    at = unperturbed_with(analysis.parameters_scene, relations(analysis.parameters_scene))
    if embedded is not None and not about.following:
        position = oscillating_position(ring, embedded, analysis.system.coordinates)
        position = position or _in_other_velocities(analysis, embedded)
        if position and ring.reduce(at[ring.index("velocity", position)]).is_zero():
            balance = replace(balance, oscillating=position)
    steady = _steady_motions(analysis, about, None)
    if steady is None and balance.turned is not None:
        steady = _steady_motions(analysis, about, balance.turned)
    if steady is None:
        kept = [x.formula.polynomial for x in analysis.optional("integrals") or () if x.status is Certainty.PROVED]
        with suppress(Failure):
            steady = balance.steady_by(kept, at)
    return replace(balance, steady=steady)


def _steady_motions(analysis: Analysis, about: Reduction, turned: Turned | None) -> int | None:
    """The dimension of the steady motions by the equations without multipliers of this analysis."""
    from mbsym.problems.constraints.motion import dependent_velocities, steady_motions

    equations = analysis.optional("equations")
    if equations is None or equations.embedded is None or equations.constraints.solved is None:
        return None
    ring, names = analysis.ring, analysis.system.coordinates
    at = unperturbed_with(analysis.parameters_scene, relations(analysis.parameters_scene))
    images = dependent_velocities(analysis.form, equations.constraints.solved)
    try:
        return steady_motions(ring, equations.embedded, names, about.idle, at, analysis.signs, images, turned)
    except Failure:  # independent velocities may be singular on the motion
        return None


#: So many choices of independent velocities are tried.
MOST_CHOICES = 4


def _in_other_velocities(analysis: Analysis, embedded: Embedded) -> str:
    """The position that velocities follow, told in others: x' of a body that turns brings in a heading, u does not.

    These may be singular on the motion itself (s' = q u at q = 0): no coupling with q' in either mass matrix, that the
    one equation is even in q' and the others q' A(q, w) hold in regular velocities around it then, and so at it, too.
    """
    from mbsym.problems.constraints.motion import felt_coordinates, oscillating_position

    idle, system = {*analysis.reduced.about.idle}, analysis.system
    felt = {*(felt_coordinates(analysis.ring, embedded, system.coordinates) or ())}
    if len(felt - idle) != 1 or not felt & idle:
        return ""
    replaced = [name for name in embedded.free if name not in felt]
    for name in [name for name in system.coordinates if name not in embedded.free][:MOST_CHOICES]:
        chosen = replace(system, dependent=(*replaced, name))
        other = type(analysis)(chosen, (), analysis.terms, suggests=False)
        other_equations = other.optional("equations")
        if other_equations is not None and other_equations.embedded is not None:
            position = oscillating_position(other.ring, other_equations.embedded, system.coordinates)
            if position:
                return position
    return ""


def state_space_of(analysis: Analysis) -> StateSpace:
    """A, B, C, D."""
    from mbsym.problems import state_space  # few systems have inputs

    linear = analysis.linearisation  # the motion exists
    if analysis.system.linear is not None:
        return state_space.of_matrices(analysis.parameters_scene, linear)
    return state_space.state_space(analysis.parameters_scene, analysis.reduced, analysis.equilibrium)


def first_order_of(analysis: Analysis) -> FirstOrder:
    """x' = A x in speeds and positions."""
    from mbsym.problems import first_order

    if not analysis.system.speeds:
        why = NoResult("the system has no speeds of its own", "see problem 5", "no speeds", "no-speeds")
        raise Unavailable("first order", why)
    equations = cast("SpeedEquations", analysis.equations)
    return first_order.first_order(analysis.form, equations, analysis.equilibrium, analysis.reduced)


def told_of(analysis: Analysis) -> ToldSystem:
    """The equations through named intermediates."""
    if analysis.system.speeds:
        reason = "not derived: speeds and unit vectors are not taken into account here yet"
        hint = "without 'speeds' and 'orientation' it is derived in generalised velocities"
        raise Unavailable("told", NoResult(reason, hint, "speeds", "speeds"))
    return told_system(analysis.system, analysis.ring, analysis.terms)


def equilibria_of(analysis: Analysis) -> Equilibria:
    """Equilibria at the values of the description."""
    values = given_values(analysis.system, {})
    missing = missing_values(analysis.system, values)
    if missing:
        hint = Message("add for example  values: {[[name]]: 1, ...}", name=missing[0])
        raise Unavailable(
            "values",
            NoResult(Message("no number for [[name]]", name=", ".join(missing)), hint, "no values", "no-value"),
        )
    from mbsym.analysis import resting
    from mbsym.problems.relative_equilibria import equilibria

    return resting.judged(analysis.system, values, equilibria.equilibria(analysis.system, values))


def first_integrals(analysis: Analysis) -> tuple[Integral, ...]:
    """All first integrals of problem 7.

    Raises Failure where formulas outgrow a limit; the reason names then what is conserved nevertheless, if the
    straight-line program from which that is read has passed its check.
    """
    if analysis.system.constraints or analysis.system.speeds:
        return constrained.integrals_of(analysis)
    try:
        return integrals.integrals(analysis.scene, analysis.energy, analysis.equations, analysis.programs)
    except Failure as failure:
        if failure.limit is None or analysis.optional("programs") is None:
            raise
        known = integrals.by_structure(analysis.system, analysis.programs)
        check = analysis.check("straight-line program") if known else None
        if check is None or check.outcome not in (EXACT, NUMERICAL):
            raise
        without = NoResult.of(failure)
        reason = Message(
            "[[why]]; conserved all the same, by structure: [[known]]",
            why=without.reason,
            known=joined(map(worded, known), ", "),
        )
        raise Unavailable("integrals", replace(without, reason=reason)) from failure


# Problems 4 to 6 of a system in speeds: in generalised coordinates and velocities, where these follow from the speeds.
#
# With  u = S(q, t) q' + s0  and det S different from 0 on the unperturbed motion, (q, q') and the state in speeds and
# unit vectors are smooth functions of each other near it: the one satisfies its equations where the other does, and
# stability, asymptotic stability and instability are the same for both.  The theorems about second-order equations
# (Lagrange, Kelvin and Chetaev) hold in q and q'.


def analysis(source: Analysis) -> Analysis:
    """The analysis of the same system without speeds.  Raises Unavailable where det S vanishes, or may do so."""
    form = source.form
    system = source.system.without_speeds
    ring = source.ring
    if system.motion:
        plain = over_ring(system, ring, bodies=False)
        at = unperturbed_with(plain, relations(plain))
        rows = [
            [x.derivative(ring.index("velocity", name)) for name in system.coordinates] for x in form.in_coordinates
        ]
        if ring.is_zero(ring.substitute(determinant(ring, rows), at)) is not False:
            reason = (
                "on the given motion the speeds do not determine the velocities of coordinates: angles are singular "
                "there, or speeds dependent"
            )
            hint = "choose other axes of 'rotation' (those of unit vectors may be any), or other speeds"
            raise Unavailable("motion", NoResult(reason, hint, "singular angles", "singular-angles"))
    return _same(source, system)


def result_in_coordinates(source: Analysis, name: str) -> Any:
    """A result there; of angles that are singular on the motion the verdict may be had in others."""
    try:
        return getattr(source.in_coordinates, name)
    except Unavailable as failure:
        if failure.failure.code == "no-motion":  # what to try depends on the speeds
            approximation.demand_motion(source)
        singular = name == "stability" and failure.failure.code == "singular-angles"
        judgement = in_other_angles(_same(source, source.system.without_speeds)) if singular else None
        if judgement is None or judgement.presumed:  # conditions that no problem 4 tells would be presumed
            raise
        return judgement


def _same(source: Analysis, system: System) -> Analysis:
    there = type(source)(system, source.problems, source.terms, source.suggests, source.angles)
    there.__dict__["ring"] = source.ring
    return there
