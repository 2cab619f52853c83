"""Problem 3 in Hamilton's and Routh's forms in the pipeline: results, their second routes, which of them are told."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from mbsym.algebra.ring import Ring
from mbsym.mechanics.kinematics import over_ring

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.model.system import System
    from mbsym.problems.canonical import Brackets, Hamilton, Independent, Routh
    from mbsym.problems.checks import Check

# What few ask for is not imported for nothing: names stand here, modules in the functions.

#: The forms besides Lagrange's, which are stages of the pipeline; what else is derived of Hamilton's.
FORMS, BRACKETS = ("routh", "hamilton"), "brackets"
#: The checks of these three.
REDUCED, CANONICAL, INVOLUTION = "Routh's equations", "canonical equations", "Poisson brackets"
#: Each check and the stage that it is about.
CHECKED = {REDUCED: "routh", CANONICAL: "hamilton", INVOLUTION: BRACKETS}


def independent(analysis: Analysis) -> Independent:
    """The system in the velocities, or speeds, that constraints leave."""
    from mbsym.problems.canonical import Independent

    tied = analysis.constraints
    equations = analysis.equations if tied.names or tied.in_speeds else None  # else T and U are enough
    return Independent(analysis.form, analysis.scene, analysis.energy, tied, equations)


def hamilton(analysis: Analysis) -> Hamilton:
    """The canonical equations, formulas written as the description wants its names."""
    from mbsym.problems import canonical

    equations = canonical.hamilton(independent(analysis), analysis.terms)
    write_symbols(analysis.system, equations.hamiltonian.ring)
    return equations


def routh(analysis: Analysis) -> Routh:
    """Routh's equations."""
    from mbsym.problems import canonical

    equations = canonical.routh(independent(analysis), analysis.terms)
    write_symbols(analysis.system, equations.function.ring)
    return equations


def brackets(analysis: Analysis) -> Brackets | None:
    """The Poisson brackets of problem 7's integrals; None without any."""
    from mbsym.problems import canonical as problem

    return problem.brackets(independent(analysis), analysis.hamilton, analysis.integrals)


def write_symbols(system: System, ring: Ring) -> None:
    """From now on formulas over the ring are written as the description wants its names."""
    if system.symbols:
        from mbsym.formulas.latex import write_as

        write_as(ring, {symbol.name: symbol.latex for symbol in system.symbols})


def requested_forms(analysis: Analysis) -> tuple[str, ...]:
    """The forms that reports of problem 3 show besides Lagrange's, in their order."""
    return tuple(name for name in FORMS if name in analysis.forms) if 3 in analysis.problems else ()


def wanted_checks(analysis: Analysis) -> Iterator[str]:
    """The names of the checks of what is told."""
    shown = requested_forms(analysis)
    for check, stage in CHECKED.items():
        if stage in shown or (stage == BRACKETS and "hamilton" in shown and 7 in analysis.problems):
            yield check


# --- second routes: None where there is nothing to compare ---


def _hamilton(analysis: Analysis) -> Check | None:
    equations = analysis.optional("hamilton")
    if equations is None:
        return None
    from mbsym.problems.canonical import check_hamilton

    return check_hamilton(analysis.oracles, independent(analysis), equations, analysis.tied_programs)


def _routh(analysis: Analysis) -> Check | None:
    equations = analysis.optional("routh")
    if equations is None:
        return None
    from mbsym.problems.canonical import check_routh

    return check_routh(analysis.oracles, independent(analysis), equations, analysis.tied_programs)


def _brackets(analysis: Analysis) -> Check | None:
    poisson_brackets = analysis.optional(BRACKETS)
    if poisson_brackets is None:
        return None
    from mbsym.problems.canonical import check_brackets

    system, ring = analysis.system, analysis.hamilton.hamiltonian.ring
    scene = over_ring(system, ring, bodies=False)
    return check_brackets(poisson_brackets, analysis.hamilton, scene)


CHECKS: dict[str, Callable[[Analysis], Check | None]] = {REDUCED: _routh, CANONICAL: _hamilton, INVOLUTION: _brackets}
