"""What problem 6 says of a part of the parameters: asked of a description that holds what is true there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.signs import Condition, ContradictionError
from mbsym.analysis import higher
from mbsym.analysis.constrained import in_parameters
from mbsym.expressions.message import Message
from mbsym.expressions.tree import ZERO, divide
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.model.substitution import put
from mbsym.model.system import Assumption, System
from mbsym.problems.stability.problem import Stability, with_cases
from mbsym.problems.stability.requirements import REVERSED, Case, Place, Requirement
from mbsym.problems.stability.verdict import Verdict, here, weakest
from mbsym.problems.stability.words import Word

if TYPE_CHECKING:
    from mbsym.algebra.ring import Polynomial
    from mbsym.analysis.pipeline import Analysis

#: So many parameters that only terms of higher order know are tried.
MOST_PARAMETERS = 2


def where_zero(analysis: Analysis, p: Polynomial) -> Verdict | None:
    """What problem 6 says wherever p vanishes, a polynomial in parameters; None where it was not asked.

    Where p = c1 x + c0, x a parameter and c1 != 0 whatever the others are, it is asked of the description with
    x = -c0/c1.  A factor of p that cannot vanish is left out.
    """
    signs = analysis.signs
    factors = [] if p.is_constant() else [factor for factor, _ in irreducible_factors(p)[1]]
    verdicts = [_where_zero(analysis, factor) for factor in factors if not signs.never_zero(factor)]
    if not verdicts or None in verdicts:
        return None
    known = [verdict for verdict in verdicts if verdict is not None]
    alike = len({verdict.word for verdict in known}) == 1 or all(verdict.stable for verdict in known)
    return weakest(known) if alike else None


def _where_zero(analysis: Analysis, p: Polynomial) -> Verdict | None:
    system, ring, degrees = analysis.system, analysis.ring, p.degrees()
    free = {*system.parameter_names} - {item.name for item in system.relations}
    for k in occurring([p]):
        slope, name = p.derivative(k), ring.generators[k].name
        if degrees[k] != 1 or name not in free or not analysis.signs.never_zero(slope):
            continue
        rest, below = (in_parameters(ring, x) for x in (slope * ring.context.gen(k) - p, slope))
        if rest is None or below is None:
            return None
        parameters = tuple(item for item in system.parameters if item.name != name)
        return _asked(analysis, put(replace(system, parameters=parameters, claims=()), {name: divide(rest, below)}))
    return None


def where_positive(analysis: Analysis, p: Polynomial) -> Verdict | None:
    """What problem 6 says wherever p > 0, a polynomial in parameters: of the description that assumes it."""
    system, left = analysis.system, in_parameters(analysis.ring, p)
    if left is None:
        return None
    return _asked(analysis, replace(system, assumptions=(*system.assumptions, Assumption(left, ">", ZERO)), claims=()))


def _asked(analysis: Analysis, system: System) -> Verdict | None:
    """The verdict on another description, its work charged to who asks; None where there is none.

    That coordinates are cyclic there, where none is for all parameters, is told.
    """
    ring, other = analysis.ring, type(analysis)(system, (), analysis.terms, suggests=False)
    try:
        its = other.ring
    except (Failure, *NOT_THERE):
        return None
    verdict: Verdict | None = None
    with its.budget(ring.work_budget - ring.work) as spent, suppress(Failure, ContradictionError, *NOT_THERE):
        verdict = other.stability.verdict
        if other.balance.ignorable and not analysis.balance.ignorable:
            verdict = here(verdict)
    ring.spend(spent.work)
    return verdict


def by_sign(analysis: Analysis, found: Stability) -> Stability:
    """An open verdict on one part, told by the sign of a polynomial in the parameters where that decides it.

    It is the first term of V of one coordinate, or a parameter that the first approximation does not know.
    """
    if len(found.subsystems) != 1 or found.presumed or not analysis.suggests:
        return found
    for label, p in _hinges(analysis, found):
        each = where_positive(analysis, p), where_positive(analysis, -p), where_zero(analysis, p)
        above, below, between = (None if x is None or x.word.open or x.word is Word.DEPENDS else x for x in each)
        if above is None and below is None:
            continue
        lower = label if above is None else Message(REVERSED, label=label)
        of = [(label, p, ">", above), (lower, -p, ">", below), (label, p, "=", between)]
        if above and between and (above.word, above.theorems) == (between.word, between.theorems):
            of = [(label, p, ">=", above), of[1]]
        cases = [_case(name, x, relation, verdict) for name, x, relation, verdict in of if verdict is not None]
        return with_cases(found, analysis.ring, analysis.signs, cases)
    return found


def _case(label: str, p: Polynomial, relation: str, verdict: Verdict) -> Case:
    condition = Condition("inequality", p, (p,))
    return Case((Requirement(label, p, condition, relation, place=Place.SUFFICIENT),), (), verdict)


def _hinges(analysis: Analysis, found: Stability) -> Iterator[tuple[str, Polynomial]]:
    """What may decide, and what it is called."""
    signs, ring = analysis.signs, analysis.ring
    term = higher.first_term(analysis)
    if term is not None:
        condition = signs.condition(term.coefficient)
        if term.order % 2 == 0 and condition.kind == "inequality" and not condition.nonzero:
            yield Message("term of order [[order]] of the potential energy", order=term.order), condition.polynomial
        return
    (part,) = found.subsystems
    known = ring.held(x for matrix in part.matrices for row in matrix.polynomials for x in row)
    acting = ring.held(_equations(analysis))
    of_higher_order = (k for k in sorted(acting - known) if ring.generators[k].kind == "parameter")
    letters = (ring.context.gen(k) for k in of_higher_order)
    for letter in islice(
        (x for x in letters if signs.sign(x) in ("unknown", "nonzero", "nonnegative", "nonpositive")), MOST_PARAMETERS
    ):
        yield Message("a parameter of terms of higher order"), letter


def _equations(analysis: Analysis) -> Iterator[Polynomial]:
    energy = analysis.energy
    yield from (energy.kinetic_energy.polynomial, energy.force_function.polynomial)
    yield from generalized_forces(analysis.held_scene).values()
