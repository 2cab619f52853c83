"""Systems that are given by their matrices, in the pipeline: which problems they have, and what stands for the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.expressions.message import Message
from mbsym.mechanics.given_matrices import HINT, WITHOUT_BODIES
from mbsym.mechanics.given_matrices import refuse_matrices as refuse_matrices
from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.checks import Check
    from mbsym.problems.dissipation import Balance
    from mbsym.problems.linearisation import Linearisation

#: The problems that such a system has.
PROBLEMS = (5, 6, 8)


def chosen(system: System, problems: tuple[int, ...]) -> tuple[int, ...]:
    """Of problems that nobody has named, those that the system has."""
    if system.linear is None or not problems:
        return problems
    return tuple(number for number in PROBLEMS if number in problems or number == 8)


def refuse() -> None:
    why = NoResult(Message("not derived: [[why]]", why=WITHOUT_BODIES), HINT, "no bodies", "given-by-matrices")
    raise Unavailable("bodies", why)


def first_approximation(analysis: Analysis) -> Linearisation:
    from mbsym.problems import given_system  # few systems are given so

    return given_system.by_matrices(analysis.parameters_scene, analysis.system.input_names)


def at_zero() -> Equilibrium:
    """x = 0 satisfies the equations."""
    return Equilibrium(satisfied=True, residuals=())


def balance(analysis: Analysis) -> Balance:
    from mbsym.problems import given_system

    return given_system.OpenBalance(analysis.parameters_scene, None, analysis.signs, {})


def check(analysis: Analysis) -> Check | None:
    """The matrices, against the formulas of the description at numbers."""
    from mbsym.problems import given_system

    linear = analysis.optional("linearisation")
    return None if linear is None else given_system.check_matrices(analysis.parameters_scene, linear)
