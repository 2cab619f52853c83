"""``summary.json``: what became of every description, for programs.

The member ``run`` has what differs from batch to batch (seconds, what was up to date, budgets); everything else is the
same bytes for the same descriptions and options.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mbsym.batch.outcome import CheckRow, ClaimRow, ComplaintRow, FileRow, Outcome, ProblemRow, Summary
from mbsym.expressions.safe import encodable
from mbsym.report.documents.base import SHA256, Format, Part, words, written
from mbsym.report.schemas import Schema, schema_of

FILENAME = "summary.json"

ExitCode = Annotated[int, words(0, 1, 2, 4, 130)]


class Options(Part, frozen=True):
    """what was asked of every description"""

    problems: Annotated[list[Annotated[int, Meta(ge=1)]] | None, "null: those that the formats show"]
    formats: Annotated[list[str], "formats of the files"]
    terms: Annotated[int, "budget of terms of one closed formula", Meta(ge=1)]
    angles: Annotated[str | None, words("products", "sums", "shorter"), "null: what each kind of text usually has"]
    detail: Annotated[str, words("compact", "full"), "how much the reports show"]


class Totals(Part, frozen=True):
    """how many there are"""

    systems: Annotated[int, "descriptions", Meta(ge=0)]
    outcomes: Annotated[dict[Outcome, Annotated[int, Meta(ge=1)]], "how many came to each outcome, of those that occur"]


class Row(Part, frozen=True):
    """a description"""

    exit_code: Annotated[ExitCode, "what the batch ends with at least"]
    file: Annotated[str, "path of the description, with /, as it was found from the current folder"]
    folder: Annotated[str, "folder of its files in the folder of the batch"]
    outcome: Annotated[Outcome, "what became of it"]
    name: Annotated[str, "its name"]
    problems: Annotated[tuple[ProblemRow, ...], "the problems that were asked for"]
    claims: Annotated[tuple[ClaimRow, ...], "its claims"]
    checks: Annotated[tuple[CheckRow, ...], "its self-checks"]
    complaints: Annotated[tuple[ComplaintRow, ...], "errors and warnings"]
    files: Annotated[tuple[FileRow, ...], "the files that were written"]
    message: Annotated[str, "what happened to it, where nothing else says so"]
    notes: Annotated[tuple[str, ...], "what else is to be told of derivation and files"]


class RowRun(Part, frozen=True):
    """of one description"""

    cached: Annotated[bool, "it was up to date: nothing was derived"]
    seconds: Annotated[float, "how long it took", Meta(ge=0)]


class Run(Part, frozen=True):
    """what differs from batch to batch"""

    seconds: Annotated[float, "how long the batch took", Meta(ge=0)]
    timeout: Annotated[Annotated[float, Meta(ge=0)] | None, "seconds that one description was granted; null: no bound"]
    memory: Annotated[Annotated[int, Meta(ge=0)] | None, "bytes that one description was granted; null: no bound"]
    cached: Annotated[int, "how many were up to date", Meta(ge=0)]
    systems: Annotated[dict[str, RowRun], "by file"]


class SummaryFile(Part, frozen=True, kw_only=True):
    """What became of every description of a batch. Only the member run differs from batch to batch over the same
    descriptions.
    """

    format: Format = 1
    mbsym: Annotated[str, "version of mbsym"]
    derivation: Annotated[
        str,
        "digest of what derives: the source of mbsym, the versions of the libraries that formulas come from",
        SHA256,
    ]
    options: Options
    shard: Annotated[
        Annotated[str, Meta(pattern="^[1-9][0-9]*/[1-9][0-9]*$")] | None, "I/N where this is one of N parts"
    ]
    exit_code: Annotated[ExitCode, "that of the worst description"]
    totals: Totals
    systems: Annotated[list[Row], "the descriptions, in the order of their files"]
    run: Run


def schema() -> Schema:
    """The JSON Schema of ``summary.json``."""
    return schema_of(SummaryFile, "summary", "summary.json of mbsym batch")


def summary_file(summary: Summary) -> SummaryFile:
    """The file as a value."""
    problems = None if summary.problems is None else list(summary.problems)
    return SummaryFile.from_result(
        summary,
        mbsym=summary.version,
        options=Options(problems, list(summary.formats), summary.terms, summary.angles, summary.detail),
        totals=Totals(len(summary.rows), summary.totals),
        systems=[Row(**{name: getattr(row, name) for name in Row.__struct_fields__}) for row in summary.rows],
        run=Run.from_result(
            summary,
            seconds=round(summary.seconds, 3),
            systems={row.file: RowRun(row.cached, round(row.seconds, 3)) for row in summary.rows},
        ),
    )


def summary_text(summary: Summary) -> str:
    """The file's text."""
    return encodable(written(summary_file(summary), indent=2))
