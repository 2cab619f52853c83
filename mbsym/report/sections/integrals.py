"""Problem 7, integrals: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.model.system import System
from mbsym.problems.integrals import ENERGY, Integral
from mbsym.report.content import Block, Display, Folded, Heading, Inline, Name, Notation, Relation, Said, paragraph, say
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import Write

if TYPE_CHECKING:
    from mbsym.report.results import Results


def data(integrals: tuple[Integral, ...], system: System, write: Write) -> list[doc.Integral]:
    """The section of results.json."""
    return [doc.Integral.from_result(item, write) for item in integrals]


_ENERGY = (
    "where $T_2 = \\frac12 \\sum M_{ij}\\, \\dot q_i \\dot q_j$ and $T_0$, the value of $T$ at $\\dot q = 0$, are the "
    "parts of $T$ that are quadratic in the velocities and free of them; $T$ and $U$ are those of problem 2, $M$ is "
    "that of problem 3."
)
CONSTANT = Notation(r"\mathrm{const}")


def title(item: Integral) -> Inline:
    """What it is called; the coordinate that it is of as a letter."""
    name = worded(item.name)
    return say(name.text, **{gap: Name(item.of) if x == item.of else x for gap, x in name.gaps.items()})


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("integrals", Said("Problem 7. First integrals"))
    yield from results.missing(7)
    if 7 not in results.by_problem:
        return
    integrals: tuple[Integral, ...] = results.by_problem[7]
    for number, item in enumerate(integrals, start=1):
        yield paragraph(title(item), " (", worded(item.status), "):")
        written = Display(Relation(item.formula, "=", CONSTANT), f"integral:{number}")
        if item.kind == ENERGY and 2 in results.compact and 3 in results.problems:
            yield Display(Relation(Notation("T_2 - T_0 - U"), "=", CONSTANT), f"integral:{number}")
            yield paragraph(
                Said(_ENERGY), " ", say("Written out there are [[count]] terms.", count=str(item.formula.terms))
            )
            yield Folded(Said("The same, written out"), (written,))
        else:
            yield written
    if not integrals:
        yield paragraph(Said("None in closed form of the kinds that are looked for."))
