"""Problem 2, energy: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from msgspec import UNSET

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.problems.energy import Energy
from mbsym.report.documents.results import energy as doc
from mbsym.report.plain import Write, column_text, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: Energy, system: System, write: Write) -> doc.Energy:
    """The section of results.json."""
    return doc.Energy(
        kinetic_energy=write(found.kinetic_energy),
        A2=matrix_text(found.A2, write),
        A1=column_text(found.A1, write),
        A0=write(found.A0),
        force_function=write(found.force_function),
        cyclic=list(found.cyclic),
        speeds=list(getattr(found, "speeds", ())) if system.speeds else UNSET,
    )


def lines(found: Energy, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    kinetic, force = found.kinetic_energy.terms, found.force_function.terms
    yield f"T: {counted(kinetic, 'term')}, U: {counted(force, 'term')}"
    if found.cyclic:
        what = "not in L" if analysis.system.constraints else "cyclic"
        yield f"{what}: {', '.join(found.cyclic)}"
