"""Problem 7, integrals: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.model.system import System
from mbsym.problems.integrals import Integral
from mbsym.report.documents import results as doc
from mbsym.report.plain import Write

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def data(found: tuple[Integral, ...], system: System, write: Write) -> list[doc.Integral]:
    """The section of results.json."""
    return [
        doc.Integral(name=item.name, kind=item.kind, of=item.of, formula=write(item.formula), status=item.status)
        for item in found
    ]


def lines(found: tuple[Integral, ...], analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    for item in found:
        yield f"{item.name}: {item.status}"
    if not found:
        yield "none in closed form of the kinds that are looked for"
