"""Cases as sets of parameters: what is said of a system whose parts have cases, for all parameters at once.

The cases of a part are read in order; together with what none of them covers they divide the parameters.  Those of all
parts are intersected, and what is proved to be empty is left out: "depends on the parameters" is said of what is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mbsym.algebra.failures import Failure
from mbsym.algebra.semialgebraic import EVERYTHING, NOTHING, Atom, ParameterSet, atom, where
from mbsym.algebra.signs import MOST_TERMS, Polynomial, Signs
from mbsym.problems.stability.reasons import Because
from mbsym.problems.stability.requirements import Case, Requirement
from mbsym.problems.stability.verdict import Verdict, combine, depends, undecided, unstable_inside, weakest
from mbsym.problems.stability.word import Word

#: Intersections of the cases of several parts are followed up to so many.
MOST_CELLS = 64

Lift = Callable[[Polynomial], Polynomial]


@dataclass(frozen=True)
class Cell:
    """A set of parameters that is not known to be empty, and the verdict there."""

    where: ParameterSet
    verdict: Verdict


def cells_of(cases: Sequence[Case], lift: Lift = lambda p: p) -> tuple[Cell, ...] | None:
    """The cases of one part as sets that do not overlap, and what is left; None where one is too long to be written.

    ``lift`` carries polynomials into the ring in which sets of several parts are compared.
    """
    found: list[Cell] = []
    left = EVERYTHING
    try:
        for case in cases:
            there = _set_of(case, lift)
            if there is None:
                return None
            found.append(Cell(left & there, case.verdict))
            left = left & there.complement()
        return (*found, Cell(left, undecided(Because.BORDER)))
    except Failure:
        return None


def _set_of(case: Case, lift: Lift) -> ParameterSet | None:
    """Where the case holds, whatever the others do."""
    if any(r.unwritten for r in (*case.all_of, *case.any_of)):
        return None
    found = EVERYTHING
    for requirement in case.all_of:
        found = found & where(*atoms(requirement, lift))
    if case.any_of:
        some = NOTHING
        for requirement in case.any_of:
            some = some | where(*atoms(requirement, lift))
        found = found & some
    return found


def atoms(requirement: Requirement, lift: Lift = lambda p: p) -> tuple[Atom, ...]:
    """What is left of a requirement once everything known has been used; a set for ``where``."""
    condition = requirement.condition
    if requirement.always:
        return ()
    if condition.kind == "never":
        return (atom(lift(condition.polynomial * 0), ">"),)
    apart = tuple(atom(lift(x), "!=") for x in condition.nonzero)
    if condition.kind == "inequality":
        return (atom(lift(condition.polynomial), requirement.relation), *apart)
    return apart


def everywhere(verdict: Verdict) -> tuple[Cell, ...]:
    """The one cell of a part whose verdict does not depend on the parameters."""
    return (Cell(EVERYTHING, verdict),)


def alone(cells: Sequence[Cell], signs: Signs) -> Verdict:
    """The verdict on one part for all parameters: that of all its cells which are not empty, if they have one word."""
    if _differ([cells], signs, one_energy=True, within=EVERYTHING):
        return depends()
    left = [cell for cell in cells if not _is_empty(cell.where, signs)]
    return depends() if len({cell.verdict.word for cell in left}) > 1 and _all_stable(left) else _common(left, signs)


def uncovered(cells: Sequence[Cell], signs: Signs) -> bool:
    """Whether parameters are known, and all that are near them, at which none of the cases of one part holds."""
    if signs.numbers or signs.normal is not None:  # witnesses mean nothing
        return False
    left = cells[-1].where.inner()
    return any(left.holds(point) for point in signs.witnesses)


def joined(
    parts: Sequence[Sequence[Cell]], signs: Signs, one_energy: bool, within: ParameterSet = EVERYTHING
) -> Verdict:
    """The verdict on a whole for all parameters ``within``: what cells that are not empty have in common.

    Where every part is stable in every case, but not always asymptotically, it is stable.
    """
    left: list[tuple[ParameterSet, tuple[Verdict, ...]]] = [(within, ())]
    try:
        if _differ(parts, signs, one_energy, within):
            return depends()
        for part in parts:
            crossed = [(there & cell.where, (*verdicts, cell.verdict)) for there, verdicts in left for cell in part]
            left = [one for one in crossed if not _is_empty(one[0], signs)]
            if len(left) > MOST_CELLS:
                return depends()
    except Failure:
        return depends()
    return _common([Cell(there, combine(verdicts, one_energy)) for there, verdicts in left], signs)


def _differ(parts: Sequence[Sequence[Cell]], signs: Signs, one_energy: bool, within: ParameterSet) -> bool:
    """Whether points are known at which the verdicts differ, not all of them stable."""
    if signs.numbers or signs.normal is not None:
        return False
    found: dict[Word, bool] = {}
    for point in signs.witnesses:
        if not within.holds(point):
            continue
        there = [next((cell for cell in part if cell.where.inner().holds(point)), None) for part in parts]
        verdicts = [cell.verdict for cell in there if cell is not None]
        if len(verdicts) == len(parts):
            verdict = combine(verdicts, one_energy)
            found[verdict.word] = verdict.stable
            if len(found) > 1 and not all(found.values()):
                return True
    return False


def _common(cells: Sequence[Cell], signs: Signs) -> Verdict:
    if not cells:
        return undecided(Because.BORDER)
    verdicts = [cell.verdict for cell in cells]
    if len({one.word for one in verdicts}) == 1 or _all_stable(cells):
        return weakest(verdicts)
    unstable = [one for one in verdicts if one.word is Word.UNSTABLE]
    others = [cell for cell in cells if cell.verdict.word is not Word.UNSTABLE]
    if unstable and all(_is_empty(cell.where.inner(), signs) for cell in others):
        return unstable_inside(weakest(unstable))
    return depends()


def _all_stable(cells: Sequence[Cell]) -> bool:
    return all(cell.verdict.stable for cell in cells)


def _is_empty(there: ParameterSet, signs: Signs) -> bool:
    """Whether no parameters are in it, proved."""
    if any(len(one.polynomial) > MOST_TERMS for piece in there.pieces for one in piece):
        short = (tuple(one for one in piece if len(one.polynomial) <= MOST_TERMS) for piece in there.pieces)
        there = ParameterSet(tuple(short))  # a larger set
    return there.is_empty(signs)
