"""Which formulas of a report are counted instead of printed: nobody reads thousands of terms, and files have limits.

A formula is printed if it has at most ``longest`` terms and its problem has room for it, the shortest first; every
problem has the same room of its own, so that the kinematics of a long chain does not keep the energy out.  The rule
counts terms, so a report does not depend on the machine.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from mbsym.algebra.program import Node, Program
from mbsym.formulas.formula import Formula
from mbsym.report.content import Said, say


@dataclass(frozen=True)
class Limit:
    """``longest``: the terms of one formula; ``whole``: those of all formulas of one problem."""

    longest: int
    whole: int


#: The problems whose formulas are counted; those of the others have rules of their own.
COUNTED = (1, 2, 3, 5, 7)
#: Longer straight-line programs are left to ``model.py`` and ``model.c``: so many assignments.
PAPER_PROGRAM, FILE_PROGRAM = 1_000, 20_000
#: For people: about half a megabyte a problem.
PAPER = Limit(2_000, 10_000)
#: Of Routh's and Hamilton's forms on paper: longer ones have coefficients that no line holds.
PAPER_FORMS = Limit(300, 3_000)
#: For programs; the numbers of long equations come from straight-line programs anyway.
FILE = Limit(6_000, 40_000)


def withheld(results: Iterable[Any], limit: Limit) -> frozenset[int]:
    """The identities (``id``) of the formulas in some problems' results that are not printed."""
    identities: set[int] = set()
    for result in results:
        room = limit.whole
        for formula in sorted(formulas(result), key=lambda formula: formula.terms):
            if formula.terms > min(limit.longest, room):
                identities.add(id(formula))
            else:
                room -= formula.terms
    return frozenset(identities)


def formulas(result: Any) -> Iterator[Formula]:
    """Every formula of a result, in the order of its fields."""
    if isinstance(result, Formula):
        yield result
    elif isinstance(result, (tuple, list)):
        for item in result:
            yield from formulas(item)
    elif is_dataclass(result):
        for field in fields(result):
            yield from formulas(getattr(result, field.name))


def program_not_printed(program: Program, outputs: Iterable[Node]) -> Said:
    """The same for straight-line code."""
    count = str(program.operations(outputs))
    return say("[[count]] operations, not printed; model.py and model.c have them", count=count)


def not_printed(formula: Formula) -> Said:
    """What stands in a formula's place."""
    return say("[[count]] terms, not printed", count=str(formula.terms))


def length(formula: Formula, in_full: bool = True) -> Said:
    """What stands in the place of a polynomial that nobody would read; ``in_full``: results.json has it in full."""
    degree = max(map(sum, formula.polynomial.monoms()))
    text = (
        "[[terms]] terms, of degree [[degree]]; in full in results.json"
        if in_full
        else "[[terms]] terms, of degree [[degree]]"
    )
    return say(text, terms=str(formula.terms), degree=str(degree))
