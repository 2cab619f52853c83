"""What the stability kernel requires, as statements that every report can print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Formula
from mbsym.problems.stability_theory import Case, Requirement


@dataclass(frozen=True)
class Statement:
    """``formula`` ``relation`` 0.

    ``formula`` is None where the statement cannot hold, or is too long to be written out; ``note`` says so.
    """

    label: str
    formula: Formula | None
    relation: str
    note: str = ""


def statements(ring: Ring, requirements: Sequence[Requirement], by_mass: bool = False) -> Iterator[Statement]:
    """The requirements that are not known to hold; with ``by_mass`` also those that the kinetic energy guarantees."""
    for requirement in requirements:
        if requirement.always and not (by_mass and requirement.by_mass):
            continue
        condition = requirement.condition
        note = "holds: the kinetic energy is positive definite" if requirement.by_mass else ""
        if condition.kind == "inequality":
            yield Statement(requirement.label, Formula(ring, condition.polynomial), requirement.relation, note)
        elif condition.kind == "unwritten":
            yield Statement(requirement.label, None, requirement.relation, "too long to be written out")
        elif condition.kind == "never":
            yield Statement(requirement.label, None, requirement.relation, "never holds")
        for polynomial in condition.nonzero:
            yield Statement(requirement.label, Formula(ring, polynomial), "!=", note)


@dataclass(frozen=True)
class CaseStatement:
    """If ``all_of`` and one of ``any_of`` hold: the verdict.  Requirements that always hold are left out."""

    all_of: tuple[Statement, ...]
    any_of: tuple[Statement, ...]
    word: str
    theorem: str
    explanation: str


def cases(ring: Ring, found: Sequence[Case]) -> list[CaseStatement]:
    """The cases that can occur."""
    return [
        CaseStatement(
            tuple(statements(ring, case.all_of)),
            tuple(statements(ring, [r for r in case.any_of if not r.never])),
            case.verdict.word,
            case.verdict.theorem,
            case.verdict.explanation,
        )
        for case in found
        if not case.never
    ]
