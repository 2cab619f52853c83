"""Problem 5, linearisation: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from msgspec import UNSET

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Matrix
from mbsym.model.system import System
from mbsym.problems.linearisation import Linearisation
from mbsym.report.documents.results import linearisation as doc
from mbsym.report.plain import Write, Written, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.reduction import Reduction


#: B of at most so many terms stands in the terminal.
SHORT = 12


def data(found: Linearisation, system: System, write: Write) -> doc.Linearisation:
    """The section of results.json."""
    return doc.Linearisation(
        **_five(found, write),
        B=UNSET if found.B is None else matrix_text(found.B, write),
        reduction=UNSET if found.constrained is None else _reduction(found.constrained, write),
        subsystems=[
            doc.LinearSubsystem(coordinates=list(part.coordinates), **_five(part, write)) for part in found.subsystems
        ],
        time="t" if found.time_scale is None else f"({found.time_scale})*t",
        notation={item.name: text(item.value) for item in system.notation},
    )


def _reduction(about: Reduction, write: Write) -> doc.Reduction:
    return doc.Reduction(
        coordinates=list(about.coordinates),
        speeds=list(about.speeds),
        dependent_coordinates=list(about.dependent_coordinates),
        dependent_speeds=list(about.dependent_speeds),
        idle=list(about.idle),
        following=list(about.following) or UNSET,
        leaf=about.leaf or UNSET,
        rates={name: write(rate) for name, rate in about.rates},
        assumed_nonzero=[write(x) for x in about.assumed],
        holonomic=about.holonomic,
    )


def lines(found: Linearisation, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    if found.constrained is not None:
        from mbsym.report.words.constraint_words import Writer, filled, reduction_sentences

        yield from map(filled, reduction_sentences(found.constrained, Writer(", ".join)))
    if analysis.system.linear is not None and analysis.system.linear.of_first_order:
        yield "x' = A x, as M = 0, D = 1, K + N = -A"
    present = [name for name in "MDGKN" if not _is_zero(getattr(found, name))]
    yield f"matrices that are not zero: {', '.join(present)}"
    if found.B is not None:
        yield (
            f"B for {', '.join(found.inputs)}: {found.B}"
            if found.B.terms <= SHORT
            else f"B for {', '.join(found.inputs)}"
        )
    if len(found.subsystems) > 1:
        yield "subsystems: " + "; ".join(", ".join(part.coordinates) for part in found.subsystems)
    state = analysis.optional("first_order") if analysis.system.speeds else None
    if state is not None:
        yield f"in speeds and positions: x' = A x, x = ({', '.join(state.names)})"


def _five(found: Any, write: Write) -> dict[str, list[list[Written]]]:
    return {name: matrix_text(getattr(found, name), write) for name in "MDGKN"}


def _is_zero(matrix: Matrix) -> bool:
    return matrix.is_zero
