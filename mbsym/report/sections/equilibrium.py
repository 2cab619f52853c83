"""Problem 4, equilibrium: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.tree import text
from mbsym.model.system import System
from mbsym.problems.equilibrium import Equilibrium
from mbsym.report.documents import results as doc
from mbsym.report.plain import Write, column_text, shortened

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: Equilibrium, system: System, write: Write) -> doc.Equilibrium:
    """The section of results.json."""
    return doc.Equilibrium(
        satisfied=found.satisfied,
        impossible=bool(found.impossible),
        conditions=column_text(found.conditions, write),
        solved={name: str(value) for name, value in found.solved},
    )


def lines(found: Equilibrium, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    if analysis.system.speeds:
        yield "problems 4 to 6 in generalised coordinates: near the motion smooth functions of the state in speeds"
    if found.satisfied:
        yield "the unperturbed motion satisfies the equations identically"
    elif found.impossible:
        yield "the unperturbed motion cannot satisfy the equations"
    if analysis.system.inputs:
        values = ", ".join(f"{one.name} = {text(one.held)}" for one in analysis.system.inputs)
        yield f"with the inputs held at {values}"
    for condition in found.conditions:
        yield shortened(f"{condition} = 0", condition.terms)
