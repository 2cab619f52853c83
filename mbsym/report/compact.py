"""Which problems' formulas a report for people tells through named intermediates, and what it says then.

A formula longer than some lines is told compactly; short systems keep closed formulas.  ``--detail full`` asks for the
closed formulas of everything.  Every target for people makes the same choice here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from mbsym.formulas.formula import Formula
from mbsym.formulas.tree import angles_or
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.telling import ToldSystem
from mbsym.report.targets import FULL
from mbsym.report.words.passages import Passage, passages

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: A formula of so many terms takes some eight lines: longer ones are told through intermediates.
LONGEST = 56
#: So are the formulas of a problem that have more terms than this together, which is about a page.
WHOLE = 200
#: If at least so many times fewer terms are left to read.
SHORTER = 2
#: More definitions than this nobody follows: some eight pages.
MOST_DEFINITIONS = 400
_ENDLESS = 10**9


@dataclass(frozen=True)
class Compact:
    """A problem told: ``passages`` introduce every name that the formulas of ``system`` for this problem need.

    ``expanded``: the terms of the closed formulas in whose place this stands; 0 where there are none.
    """

    system: ToldSystem
    passages: tuple[Passage, ...]
    expanded: int

    @property
    def definitions(self) -> int:
        return sum(len(x.definitions) for x in self.passages)


def compact(analysis: Analysis, problems: Mapping[int, Any]) -> dict[int, Compact]:
    """By number, the problems that are told; ``problems`` holds the results of those shown, None where there is none.

    Nothing is derived unless some problem is long.  The choice is made once for all files of an analysis.
    """
    if analysis.detail == FULL:
        return {}
    key = (angles_or("shorter"), *((n, id(problems[n])) for n in (1, 2, 3) if n in problems))
    made = _MADE.setdefault(analysis, {})
    if key not in made:  # the results are kept with the choice, so that their ids stay their own
        made[key] = tuple(problems.values()), _chosen(analysis, problems)
    return made[key][1]


_MADE: WeakKeyDictionary[Analysis, dict[tuple[Any, ...], tuple[Any, dict[int, Compact]]]] = WeakKeyDictionary()


def _chosen(analysis: Analysis, problems: Mapping[int, Any]) -> dict[int, Compact]:
    candidates = {n: _formulas(problems[n]) for n in (1, 2, 3) if n in problems}
    candidates = {n: formulas for n, formulas in candidates.items() if _is_long(formulas)}
    compressed = analysis.optional("told") if candidates else None
    if compressed is None:
        return {}
    compacts = {}
    for number, closed in candidates.items():
        total = _ENDLESS if closed is None else sum(x.terms for x in closed)
        formulas = told_formulas(compressed, number)
        listed = passages(compressed.told, analysis.system, formulas)
        length = sum(x.terms for x in formulas) + sum(y.formula.terms for x in listed for y in x.definitions)
        one = Compact(compressed, listed, _replaced(problems[number], total))
        if one.definitions <= MOST_DEFINITIONS and (not one.expanded or SHORTER * length <= total):
            compacts[number] = one
    return compacts


def _replaced(result: Any, printed: int) -> int:
    """The terms of what is told: of T as a whole, though where it is written out its A_ij stand as M_ij in problem 3.

    A velocity that is that of the joint is told as that.
    """
    match result:
        case None:
            return 0
        case Energy():
            return result.terms
        case Kinematics():
            same = (x.velocity_mass_centre for x in result.bodies if x.velocity_mass_centre == x.velocity_origin)
            return printed - sum(x.terms for v in same for x in v)
    return printed


def told_formulas(compressed: ToldSystem, number: int) -> list[Formula]:
    """The formulas of problems 1, 2 and 3 in terms of intermediates."""
    if number == 1:
        vectors = (
            v
            for body in compressed.kinematics.values()
            for v in (body.angular_velocity, body.velocity_origin, body.velocity_mass_centre)
        )
        return [x for v in vectors for x in v]
    if number == 2:
        return [compressed.kinetic_energy, compressed.force_function]
    return [*_upper(compressed.mass_matrix.rows), *compressed.forcing]


def _upper(rows: tuple[tuple[Formula, ...], ...]) -> list[Formula]:
    return [x for i, row in enumerate(rows) for x in row[i:]]


def _formulas(result: Any) -> list[Formula] | None:
    """The formulas of a result as a report prints them; None where it has none."""
    match result:
        case Kinematics():
            vectors = ((x.angular_velocity, x.velocity_origin, x.velocity_mass_centre) for x in result.bodies)
            return [entry for body in vectors for vector in body for entry in vector]
        case Energy():
            return [*result.A1, result.A0, result.force_function]
        case Equations():
            return [*_upper(result.mass_matrix.rows), *result.forcing]
    return None


def _is_long(formulas: Sequence[Formula] | None) -> bool:
    """Whether there is more to read than a page, or eight lines of one formula; without formulas there would be."""
    if formulas is None:
        return True
    terms = sorted((x.terms for x in formulas), reverse=True)
    if not terms or (terms[0] <= LONGEST and sum(terms) <= WHOLE):
        return False
    # Sums of angles may be much shorter; they are looked for in the longest formula first.
    longest = max(formulas, key=lambda x: x.terms)
    return (
        longest.terms_read > LONGEST
        or sum(x.terms_read for x in formulas) > WHOLE
        or any(x.terms > LONGEST and x.terms_read > LONGEST for x in formulas)
    )
