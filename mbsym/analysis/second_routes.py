"""The self-check in the pipeline: every result of the asked-for problems that has a second route, compared with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure, NotInstalled, message_of
from mbsym.algebra.ring import Polynomial
from mbsym.analysis import constrained, forms
from mbsym.analysis.stages import later
from mbsym.formulas.formula import Column
from mbsym.mechanics import motion
from mbsym.problems import checks as comparison
from mbsym.problems import equilibrium, knowledge, linearisation, perturbation
from mbsym.problems.checks import Check
from mbsym.problems.equations import Equations
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.reduction_check import check_motion, check_perturbed_motion

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


#: One check may take this part of the work that a run may take.
CHECK_SHARE = 2


def checks(analysis: Analysis) -> tuple[Check, ...]:
    """Every check on which the asked-for problems stand, as far as their results allow it, and those of the program."""
    for number in analysis.problems:
        analysis.stage(number)
    if analysis.system.speeds and 5 in analysis.problems:
        analysis.optional("first_order")
    return tuple(checked for name in _wanted(analysis) if (checked := analysis.check(name)) is not None)


def carried_out(analysis: Analysis) -> list[Check]:
    """Those of the same that what is derived so far allows; nothing else is derived."""
    with analysis.unvouched():
        return [checked for name in _wanted(analysis) if (checked := analysis.check(name)) is not None]


def _wanted(analysis: Analysis) -> list[str]:
    """The names of these checks, in the order in which they are told."""
    names = {name for problem in analysis.asked for name in problem.stands_on}
    if 3 in analysis.problems or "programs" in analysis.derived:
        names |= {"straight-line program", "mass matrix"}
    if 3 in analysis.problems and analysis.system.reactions:
        names.add(constrained.REACTIONS)
    names |= set(forms.wanted_checks(analysis))
    if analysis.system.speeds:
        names |= {"first approximation in speeds"}
    return [name for name in SECOND_ROUTES if name in names]


def check(analysis: Analysis, name: str) -> Check | None:
    """One check; None where there is nothing to compare, ``undecided`` where it cannot be carried out.

    It has work of its own to spend: what the derivation used up does not keep a finished result from being checked.
    """
    ring = analysis.ring
    try:
        with ring.budget(ring.work_budget // CHECK_SHARE):
            return SECOND_ROUTES[name](analysis)
    except Failure as reason:
        return Check(name, "", "", comparison.UNDECIDED, message_of(reason))
    except Exception as error:
        failure = analysis.contained(error)
        if isinstance(failure, NotInstalled):
            return None
        return Check(name, "", "", comparison.UNDECIDED, failure.reason)


# --- one by one: None where there is nothing to compare ---


def _kinematics(analysis: Analysis) -> Check | None:
    kinematics = analysis.optional("kinematics")
    return None if kinematics is None else comparison.check_kinematics(analysis.oracles, kinematics)


def _energy(analysis: Analysis) -> Check | None:
    energy = analysis.optional("energy")
    return None if energy is None else comparison.check_energy(analysis.oracles, energy, energy.speeds)


def _closed(analysis: Analysis) -> Equations | None:
    """The closed equations, where something has asked for them."""
    return analysis.optional("equations") if "equations" in analysis.derived else None


def _equations(analysis: Analysis) -> Check | None:
    closed = _closed(analysis)
    return None if closed is None else comparison.check_equations(analysis.oracles, closed)


def _program(analysis: Analysis) -> Check | None:
    programs = analysis.optional("programs")
    form = analysis.form if analysis.system.speeds else None
    return None if programs is None else comparison.check_program(analysis.oracles, programs, form)


def _mass_matrix(analysis: Analysis) -> Check | None:
    programs = analysis.optional("programs")
    return None if programs is None else comparison.check_mass_matrix(analysis.oracles, programs)


def _equilibrium(analysis: Analysis) -> Check | None:
    """Against the closed equations where these are derived, else against d'Alembert's principle."""
    steady_state, closed = analysis.optional("equilibrium"), _closed(analysis)
    if steady_state is None or analysis.system.linear is not None:
        return None
    if steady_state.singular:  # what is demanded besides is differentiated a second time
        closed = analysis.optional("equations")
    if closed is not None and not closed.constraints.names:
        return comparison.check_residuals(analysis.ring, residuals_of(analysis, closed), steady_state.residuals)
    reduced = analysis.reduced
    on_motion = steady_state.residuals[: len(reduced.residuals)]
    return check_motion(analysis.system, analysis.ring, on_motion, reduced.about, dependent(analysis))


def _linearisation(analysis: Analysis) -> Check | None:
    if analysis.system.linear is not None:
        from mbsym.analysis import given

        return given.check(analysis)
    linear, closed = analysis.optional("linearisation"), _closed(analysis)
    if linear is None or closed is None or linear.about.ties:
        return None
    return comparison.check_linearisation(analysis.ring, linear, linearised(analysis, closed))


def _perturbed(analysis: Analysis) -> Check | None:
    linear = analysis.optional("linearisation")
    if linear is None or analysis.system.linear is not None:
        return None
    existing = None
    if linear.about.ties:
        # a motion that breaks the constraints' rows has no first approximation: the routes leave the rows differently
        existing = equilibrium.on_a_branch(analysis.parameters_scene, analysis.equilibrium)
    return check_perturbed_motion(analysis.system, analysis.ring, linear, dependent(analysis, existing))


def _first_order(analysis: Analysis) -> Check | None:
    """Only where somebody has asked for it."""
    if not analysis.system.speeds or "first_order" not in analysis.derived:
        return None
    first_order_form, linear = analysis.optional("first_order"), analysis.optional("linearisation")
    if first_order_form is None or linear is None:
        return None
    from mbsym.problems import first_order
    from mbsym.problems.in_speeds import SpeedEquations

    closed = analysis.equations
    assert isinstance(closed, SpeedEquations)
    return first_order.check(analysis.form, closed, first_order_form, analysis.equilibrium, analysis.reduced)


def _integrals(analysis: Analysis) -> Check | None:
    integrals = analysis.optional("integrals")
    return constrained.integrals_check(analysis, integrals) if integrals else None


def _stabilisation(analysis: Analysis) -> Check | None:
    """Only where somebody has asked for it."""
    stabilisation = analysis.optional("stabilisation") if "stabilisation" in analysis.derived else None
    if stabilisation is None:
        return None
    from mbsym.problems.stabilisation.checks import check_stabilisation

    return check_stabilisation(analysis.parameters_scene, analysis.judgeable, stabilisation)


#: Every check, by its name, in the order in which they are told.
SECOND_ROUTES: dict[str, Callable[[Analysis], Check | None]] = {
    "kinematics": _kinematics,
    "energy": _energy,
    "equations of motion": _equations,
    "straight-line program": _program,
    "mass matrix": _mass_matrix,
    "equilibrium": _equilibrium,
    "linearisation": _linearisation,
    "perturbed motion": _perturbed,
    "first approximation in speeds": _first_order,
    "first integrals": _integrals,
    "stabilisation": _stabilisation,
    "polynomial integrals": later("mbsym.analysis.polynomial", "check"),
    "normal forms": later("mbsym.analysis.higher", "check"),
    "constraints": constrained.rows_check,
    "constrained motion": constrained.motion_check,
    constrained.REACTIONS: constrained.reactions_check,
    **forms.CHECKS,
}


def dependent(analysis: Analysis, determined: Mapping[int, Polynomial] | None = None) -> perturbation.Dependent:
    """What the matrices of problem 5 have already been freed of (or ``determined``), and what their notation means."""
    scene = analysis.parameters_scene
    values = motion.dependent(scene, analysis.equilibrium.determined(scene) if determined is None else determined)
    names = [item.name for item in analysis.system.notation]
    return perturbation.Dependent(values, {name: knowledge.definition_in_parameters(scene, name) for name in names})


def residuals_of(analysis: Analysis, closed: Equations) -> Column:
    """The motion substituted into the closed equations: the second route of problem 4."""
    ring, names = analysis.ring, analysis.system.coordinates
    forcing = linearisation.with_inertia(analysis.scene, closed)
    singular = analysis.equilibrium.singular
    if singular:
        slopes = {x: [ring.derivative(f, name) for name in names] for x, f in zip(names, forcing, strict=True)}
        forcing += equilibrium.beside(slopes, singular, ring.zero)
    return equilibrium.equilibrium(analysis.scene, forcing, analysis.signs).residuals


def linearised(analysis: Analysis, closed: Equations) -> Linearisation:
    """The closed equations differentiated on the motion: the second route of problem 5."""
    return linearisation.by_equations(analysis.scene, closed, analysis.equilibrium)
