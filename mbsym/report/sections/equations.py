"""Problem 3, equations: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, cast

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.problems.equations import Equations
from mbsym.report.plain import Write, column_text, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.speeds import SpeedEquations


def data(found: Equations, system: System, write: Write) -> dict[str, Any]:
    """The section of results.json."""
    section = {"mass_matrix": matrix_text(found.mass_matrix, write), "forcing": column_text(found.forcing, write)}
    return section | _in_speeds(cast("SpeedEquations", found), write) if found.in_speeds else section


def _in_speeds(found: SpeedEquations, write: Write) -> dict[str, Any]:
    rates = zip(found.positions, found.rates, strict=True)
    return {
        "speeds": list(found.speeds),
        "needed": column_text(found.needed, write),
        "supplied": column_text(found.supplied, write),
        "positions": {name: write(rate) for name, rate in rates},
        "aside": list(found.aside),
    }


def lines(found: Equations, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    n = len(found.forcing)
    if found.in_speeds:
        own = cast("SpeedEquations", found)
        yield f"Kane's equations in {', '.join(own.speeds)}; with {', '.join(name for name, _ in own.kinematic)}"
    terms = sum(x.terms for x in found.forcing)
    size = counted(found.mass_matrix.terms, "term")
    yield f"{counted(n, 'equation')}; mass matrix {size}, right-hand sides {counted(terms, 'term')}"
