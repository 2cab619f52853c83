"""The self-check in the pipeline: every result of the asked-for problems that has a second route, compared with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure
from mbsym.formulas.formula import Column
from mbsym.mechanics.motion import relations
from mbsym.problems import checks as comparison
from mbsym.problems import equilibrium, knowledge, linearisation, perturbation
from mbsym.problems.checks import Check
from mbsym.problems.equations import Equations
from mbsym.problems.linearisation import Linearisation

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def checks(analysis: Analysis) -> tuple[Check, ...]:
    """Every check that the asked-for problems and their results allow."""
    done = []
    for name, check in _second_routes(analysis):
        try:
            done.append(check())
        except Failure as reason:
            done.append(Check(name, "", "", comparison.UNDECIDED, str(reason)))
    return tuple(done)


def _second_routes(analysis: Analysis) -> Iterator[tuple[str, Callable[[], Check]]]:
    """Name and computation of every check."""
    system, ring = analysis.system, analysis.ring
    truth = comparison.oracles(system, ring)
    asked = {stage.name: stage.value for stage in map(analysis.stage, analysis.problems)}
    closed, linear = asked.get("equations"), asked.get("linearisation")
    if asked.get("kinematics") is not None:
        yield "kinematics", lambda: comparison.check_kinematics(truth, asked["kinematics"])
    if asked.get("energy") is not None:
        yield "energy", lambda: comparison.check_energy(truth, asked["energy"])
    if closed is not None:
        yield "equations of motion", lambda: comparison.check_equations(truth, closed)
    if (3 in analysis.problems or "programs" in analysis.derived) and analysis.optional("programs") is not None:
        yield "straight-line program", lambda: comparison.check_program(truth, analysis.programs)
        yield "mass matrix", lambda: comparison.check_mass_matrix(truth, analysis.programs)
    if closed is not None and asked.get("equilibrium") is not None:
        found = analysis.equilibrium
        yield (
            "equilibrium",
            lambda: comparison.check_residuals(ring, residuals_of(analysis, closed), found.residuals),
        )
    if closed is not None and linear is not None:
        yield "linearisation", lambda: comparison.check_linearisation(ring, linear, linearised(analysis, closed))
    if linear is not None:
        known = dependent(analysis)
        yield "perturbed motion", lambda: perturbation.check_perturbed_motion(system, ring, linear, known)
    if asked.get("integrals"):
        yield (
            "first integrals",
            lambda: perturbation.check_integrals(truth, analysis.programs, asked["integrals"]),
        )


def dependent(analysis: Analysis) -> perturbation.Dependent:
    """What the matrices of problem 5 have already been freed of, and what their notation stands for."""
    scene, ring = analysis.parameters_scene, analysis.ring
    values = {ring.generators[k].name: value for k, value in relations(scene).items()}
    values |= {name: value.polynomial for name, value in analysis.equilibrium.solved}
    names = [item.name for item in analysis.system.notation]
    return perturbation.Dependent(values, {name: knowledge.definition_in_parameters(scene, name) for name in names})


def residuals_of(analysis: Analysis, closed: Equations) -> Column:
    """The motion substituted into the closed equations: the second route of problem 4."""
    forcing = [x.polynomial for x in closed.forcing]
    return equilibrium.equilibrium(analysis.scene, forcing, analysis.signs).residuals


def linearised(analysis: Analysis, closed: Equations) -> Linearisation:
    """The closed equations differentiated on the motion: the second route of problem 5."""
    return linearisation.by_equations(analysis.scene, closed, analysis.equilibrium)
