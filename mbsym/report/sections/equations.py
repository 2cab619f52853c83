"""Problem 3, equations: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.problems.equations import Equations
from mbsym.report.plain import Write, column_text, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: Equations, system: System, write: Write) -> dict[str, Any]:
    """The section of results.json."""
    return {"mass_matrix": matrix_text(found.mass_matrix, write), "forcing": column_text(found.forcing, write)}


def lines(found: Equations, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    n = len(found.forcing)
    terms = sum(x.terms for x in found.forcing)
    size = counted(found.mass_matrix.terms, "term")
    yield f"{counted(n, 'equation')}; mass matrix {size}, right-hand sides {counted(terms, 'term')}"
