"""Problem 7 in the pipeline: with formulas, or where these outgrow their budget, what is conserved by structure."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from mbsym.algebra.failures import Failure
from mbsym.analysis import constrained
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.expressions.message import Message, joined, worded
from mbsym.problems import integrals
from mbsym.problems.checks import EXACT, NUMERICAL
from mbsym.problems.integrals import Integral

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.in_speeds.speeds import SpeedEquations


def first_integrals(analysis: Analysis) -> tuple[Integral, ...]:
    """All first integrals of problem 7.

    Raises Failure where formulas outgrow a limit; the reason names then what is conserved nevertheless, if the
    straight-line program from which that is read has passed its check.
    """
    if analysis.system.constraints:
        return constrained.integrals_of(analysis)
    if analysis.speed_form is not None:
        from mbsym.problems.in_speeds import speed_integrals

        equations = cast("SpeedEquations", analysis.equations)
        return speed_integrals.integrals(analysis.speed_form, analysis.scene, analysis.energy, equations)
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
