"""The self-check: results that were derived twice."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.problems.checks import Check
from mbsym.report.content import Block, Graded, Heading, Inline, Said, Table, TableColumn, paragraph
from mbsym.report.words.claims import grade

if TYPE_CHECKING:
    from mbsym.report.results import Results


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    checks = results.analysis.checks
    if not checks:
        return
    yield Heading("checks", Said("Self-check"))
    yield paragraph(Said("These results were derived a second time by an independent route and compared."))
    yield Table(
        title=None,
        columns=(
            TableColumn(Said("result"), 2.6),
            TableColumn(Said("first route"), 4.4),
            TableColumn(Said("second route"), 4.4),
            TableColumn(Said("agreement"), 3.4),
        ),
        rows=tuple(
            ((worded(check.name),), (worded(check.first),), (worded(check.second),), _outcome(check))
            for check in checks
        ),
    )


def _outcome(check: Check) -> tuple[Inline, ...]:
    detail: tuple[Inline, ...] = (": ", worded(check.detail)) if check.detail else ()
    return Graded(worded(check.outcome), grade(check.outcome)), *detail
