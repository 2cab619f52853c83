"""Claims in the pipeline: every claim of the description against what is derived, within a part of the run's work.

The results themselves do not depend on claims, and claims cost the reports nothing.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from mbsym.algebra.failures import Failure, message_of
from mbsym.analysis.deriving import in_steady_angles
from mbsym.analysis.judge import Judge
from mbsym.analysis.where import where_zero
from mbsym.mechanics.variables import angle_denominators, angles_of
from mbsym.model.claims import CLAIMS, Claim
from mbsym.problems import claims
from mbsym.problems.claims import ClaimResult
from mbsym.problems.claims.counterexample import Trials

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.analysis.pipeline import Analysis

#: All claims together may take this part of the work that a run may take, and one of them this part.
CLAIMS_SHARE, CLAIM_SHARE = 4, 16

#: What is derived before the claims that need it, by how their kinds begin: not within the small budget of one claim.
_EXPANSIONS = {
    "oscillation": "claimed_oscillation",
    "slow manifold": "claimed_manifold",
    "normal form": "normal_forms",
    "lyapunov": "normal_forms",
}


def judged_claims(analysis: Analysis) -> tuple[ClaimResult, ...]:
    """Every claim's outcome, in the order of the description, which has some."""
    system = analysis.system
    for number in analysis.problems:  # not under the small budget of a claim, whose failures would be remembered
        analysis.stage(number)
    judged = _in_steady_angles(analysis) if any(CLAIMS[claim.kind].inequality for claim in system.claims) else analysis
    symbols = claims.Symbols.of(analysis)
    own, there = angle_denominators(system), set(angles_of(system))
    arguments = {
        id(claim): [x for x in symbols.arguments(claim) if x not in there]
        for claim in system.claims
        if not CLAIMS[claim.kind].oscillates  # their phase is no angle of the system
    }
    for kind, stage in _EXPANSIONS.items():
        if any(claim.kind.startswith(kind) for claim in system.claims):
            analysis.optional(stage)
    # Sines that only claims hold: those claims are judged in a ring of their own, and cost the others nothing.
    further = {key: some for key, some in arguments.items() if some and angle_denominators(system, some) != own}
    source = analysis
    if further:
        angles = [expression for some in further.values() for expression in some]
        source = type(analysis)(system, analysis.problems, analysis.terms, angles=angles)
        source.defects = analysis.defects
    allowance = analysis.ring.work_budget // CLAIMS_SHARE
    results = []
    for claim in system.claims:
        own_source = judged if CLAIMS[claim.kind].inequality else analysis
        result, spent = _judged(source if id(claim) in further else own_source, claim, allowance)
        allowance -= spent
        results.append(result)
    return tuple(results)


def _in_steady_angles(analysis: Analysis) -> Analysis:
    """The analysis that problem 6 judges: in other angles where a spin is steady in these alone."""
    if analysis.optional("trials") is None:
        for _, there in in_steady_angles(analysis):
            there.optional("trials")
            return there
    return analysis


def _judged(source: Analysis, claim: Claim, allowance: int) -> tuple[ClaimResult, int]:
    """One claim and the work that it took, bounded by itself."""
    ring = source.ring
    with ring.budget(min(ring.work_budget // CLAIM_SHARE, allowance)) as spent:
        try:
            with source.strictly():  # a claim is no better than the checks of what it is compared with
                result = claims.examine(source, claim)
        except Failure as reason:
            result = claims.undecided(source.system, claim, message_of(reason))
        except Exception as error:
            result = claims.undecided(source.system, claim, source.contained(error).reason)
    return result, spent.work


def claimed_oscillation(analysis: Analysis) -> Oscillating:
    """The periodic solution of problem 12, to the highest order that is claimed."""
    from mbsym.analysis.oscillating import oscillating

    return oscillating(analysis, _order(analysis, "oscillation"))


def claimed_manifold(analysis: Analysis) -> Expansion:
    """The slow manifold of problem 12, to the highest order that is claimed."""
    from mbsym.analysis.expanding import expansion

    return expansion(analysis, _order(analysis, "slow manifold"))


def _order(analysis: Analysis, kind: str) -> int:
    return max([1, *(claim.order for claim in analysis.system.claims if claim.kind.startswith(kind))])


def trials(analysis: Analysis) -> Trials:
    """Parameters at which claimed conditions are tried, with exact verdicts."""
    judge = Judge(analysis)
    solved = {name: value.polynomial for name, value in analysis.equilibrium.solved}
    mass_matrix = analysis.judgeable.M
    where = partial(where_zero, analysis)
    return Trials(analysis.system, analysis.ring, mass_matrix, solved, judge.first_approximation, judge.decided, where)
