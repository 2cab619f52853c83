"""``mbsym integrals`` in the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from mbsym.report.content import say
from mbsym.report.plain_writer import Writer
from mbsym.report.words.integrals_words import HEADING, sentences, title, weights_text
from mbsym_cli.console import console, printable
from mbsym_cli.integrals_cases import along_lines, cases_lines
from mbsym_cli.integrals_relations import darboux_lines, darboux_values, level_lines, relation_lines
from mbsym_cli.integrals_values import other_lines

if TYPE_CHECKING:
    from mbsym.analysis.invariant_relations import InvariantRelations
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import Along, Cases, DarbouxAlong, PolynomialIntegrals


@dataclass(frozen=True)
class Further:
    """What was asked for besides the integrals, None where it was not."""

    line: Along | None
    cases: Cases | None
    relations: InvariantRelations | None
    at: DarbouxAlong | None = None


def show(file: Path, name: str, there: Setting, found: PolynomialIntegrals, further: Further) -> None:
    """The table of integrals, what is known of it as a whole, and what is there besides."""
    out = console()
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}", "dim")))
    uniform = "quasi-homogeneous" if found.grading.homogeneous else "not quasi-homogeneous"
    weights = weights_text(found.field.variables, found.grading.weights)
    out.print(Text(f"  weights {weights}; the equations are {uniform} under them"))
    out.print(Text.assemble("  ", (Writer().said(say(HEADING, degree=str(found.degree))), "bold cyan")))
    for one in found.generators:
        out.print(Text.assemble(f"    weight {one.weight}  ", (title(one), "bold" if one.is_new else "")))
        out.print(Text(f"      {there.formula(one.polynomial)}"), soft_wrap=True)
    for text in map(Writer().said, sentences(found)):
        out.print(Text(f"    {text}"))
    for heading, lines in _sections(there, found, further):
        out.print(Text.assemble("  ", (heading, "bold cyan")))
        for text in lines:
            out.print(Text(f"    {text}"), soft_wrap=True)


def _sections(there: Setting, found: PolynomialIntegrals, further: Further) -> Iterator[tuple[str, Iterator[str]]]:
    if further.line is not None:
        yield "Special values", along_lines(there, found, further.line)
    if further.cases is not None:
        yield "Special cases", cases_lines(there, further.cases)
    relations = further.relations
    if relations is not None:
        yield "Integrals where another one is zero", level_lines(there, found, relations.levels)
        yield "Integrals where another one has a value that is not zero", other_lines(there, relations.others)
        yield "Linear invariant relations", relation_lines(there, relations.linear)
        yield "Invariant relations f = 0 with f' = K f", darboux_lines(there, found, relations.darboux)
    if further.at is not None:
        yield f"Values of {further.at.name} with further f' = K f", darboux_values(there, found, further.at)
