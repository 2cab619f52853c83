"""What became of the descriptions of a batch, as values: one Row each, together a Summary.

Front ends (tables, summary.json, whatever a CI system reads) are made from these alone.  Only ``seconds`` and
``cached`` differ between two batches over the same descriptions; the rest of a row is the same wherever it was derived.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Annotated

from msgspec import Meta

from mbsym.report.documents.base import SHA256, Part, words
from mbsym.report.words.findings import Finding

#: The version of the schema of summary.json; another one where a reader would have to be changed.
FORMAT = 1

#: Exit codes, those of ``mbsym run``; and one more, where a budget of seconds or of memory was met.
OK, FAILED, BAD_INPUT, BUDGET, INTERRUPTED = 0, 1, 2, 4, 130


class Outcome(StrEnum):
    """What became of one description, in the words of tables and of summary.json."""

    #: All that was asked for is there, or the reason why there is none is an answer; no check failed.
    DERIVED = "derived"
    #: The description has errors, or cannot be read; nothing was derived.
    ERRORS = "description errors"
    #: Derived and written; but two independent routes to a result disagree.
    SELF_CHECK = "self-check failed"
    #: Derived and written; a claim does not hold, and claims had to (``--strict-claims``).
    CLAIMS = "claim does not hold"
    #: An internal error cost a result or a file; the others were written.
    INCOMPLETE = "incomplete"
    #: Derived, but the files could not be written.
    NOT_WRITTEN = "not written"
    #: The process ended by itself: a signal, an abort, somebody's kill.
    CRASHED = "crashed"
    TIMEOUT = "timeout"
    MEMORY = "out of memory"
    #: Never begun: another one failed and ``--fail-fast`` was given.
    SKIPPED = "skipped"
    #: Begun or waiting when the batch was stopped.
    INTERRUPTED = "interrupted"

    @property
    def exit_code(self) -> int:
        """What the batch ends with at least; that of the worst row is its exit code."""
        return _EXIT_CODES.get(self, FAILED)

    @property
    def finished(self) -> bool:
        """Whether the derivation came to its end by itself, so that doing it again would give the same."""
        return self in (Outcome.DERIVED, Outcome.SELF_CHECK, Outcome.CLAIMS)

    @property
    def failed(self) -> bool:
        """Whether something is wrong with it; what was never begun is not."""
        return self not in (Outcome.DERIVED, Outcome.SKIPPED, Outcome.INTERRUPTED)


_EXIT_CODES = {
    Outcome.DERIVED: OK,
    Outcome.SKIPPED: OK,
    Outcome.ERRORS: BAD_INPUT,
    Outcome.TIMEOUT: BUDGET,
    Outcome.MEMORY: BUDGET,
    Outcome.INTERRUPTED: INTERRUPTED,
}


class ProblemRow(Part, frozen=True):
    """a numbered problem"""

    number: Annotated[int, "its number", Meta(ge=1)]
    name: Annotated[str, "its name in results.json"]
    title: Annotated[str, "what it is about"]
    status: Annotated[str, words("derived", "none"), "whether there is a result"]
    code: Annotated[
        str | None, "kind of the reason why there is no result: no-closed-form, internal-error, withdrawn, ..."
    ] = None
    reason: Annotated[str | None, "the same in a sentence"] = None
    hint: Annotated[str | None, "what to try next, in a sentence"] = None
    defect: Annotated[bool, "the program is at fault"] = False
    verdict: Annotated[str | None, "of problem 6"] = None
    verdict_at_values: Annotated[str | None, "of problem 6 at the description's values"] = None


class ClaimRow(Part, frozen=True):
    """a claim of the description"""

    place: Annotated[str, "where it is printed"]
    title: Annotated[str, "what it is about, in words"]
    word: Annotated[str, words("held", "refuted", "undecided"), "the outcome in one word"]
    outcome: Annotated[str, "how it holds, or does not"]
    lines: Annotated[tuple[str, ...], "by what it differs"] = ()


class CheckRow(Part, frozen=True):
    """a self-check: two routes to a result"""

    name: Annotated[str, "what is compared"]
    first: Annotated[str, "the first route"]
    second: Annotated[str, "the second route"]
    outcome: Annotated[
        str,
        words("exact", "verified numerically", "undecided", "singular", "FAILED"),
        "how certain it is that they agree",
    ]
    detail: Annotated[str, "how they were compared, or what differs, in words"] = ""

    @property
    def failed(self) -> bool:
        return self.outcome == "FAILED"


class ComplaintRow(Part, frozen=True):
    """a complaint about the description"""

    severity: Annotated[str, words("error", "warning"), "how bad it is"]
    code: Annotated[str, "what kind of complaint it is"]
    message: Annotated[str, "the same in a sentence"]
    line: Annotated[Annotated[int, Meta(ge=1)] | None, "line, counted from 1; null: the file as a whole"] = None
    column: Annotated[Annotated[int, Meta(ge=1)] | None, "column, counted from 1"] = None
    length: Annotated[Annotated[int, Meta(ge=0)] | None, "so many characters"] = None
    hint: Annotated[str | None, "what to do, in a sentence"] = None


class FileRow(Part, frozen=True):
    """a file that was written"""

    name: Annotated[str, "its name in the folder of the description"]
    sha256: Annotated[str, "its SHA-256", SHA256]


@dataclass(frozen=True)
class Row:
    """One description.

    ``file`` is its path as it was found from the current folder, ``folder`` that of its files inside the batch's; both
    with ``/`` on every system.  ``message`` says in a sentence what happened where nothing else does (a crash, a
    budget, a full disk); ``notes`` are what else is to be told of derivation and files.
    """

    file: str
    folder: str
    outcome: Outcome
    name: str = ""
    problems: tuple[ProblemRow, ...] = ()
    claims: tuple[ClaimRow, ...] = ()
    checks: tuple[CheckRow, ...] = ()
    complaints: tuple[ComplaintRow, ...] = ()
    files: tuple[FileRow, ...] = ()
    message: str = ""
    notes: tuple[str, ...] = ()
    cached: bool = field(default=False, compare=False)
    seconds: float = field(default=0.0, compare=False)

    @property
    def exit_code(self) -> int:
        return self.outcome.exit_code

    def judged(self, strict_claims: bool) -> Row:
        """The row, worse by a claim that does not hold where claims have to."""
        if strict_claims and self.outcome is Outcome.DERIVED and any(claim.word != "held" for claim in self.claims):
            return replace(self, outcome=Outcome.CLAIMS)
        return self


@dataclass(frozen=True)
class Summary:
    """All rows, in the order of their files.

    ``version`` and ``derivation`` are those of mbsym (the second is a digest of its source); ``options`` what was asked
    of every description, ``budget`` what each was granted (None: no bound); ``shard`` is ``i/n`` where the batch is one
    of several.
    """

    rows: tuple[Row, ...]
    version: str
    derivation: str
    problems: tuple[int, ...] | None
    formats: tuple[str, ...]
    terms: int
    angles: str | None = None
    detail: str = "compact"
    shard: str | None = None
    timeout: float | None = field(default=None, compare=False)
    memory: int | None = field(default=None, compare=False)
    seconds: float = field(default=0.0, compare=False)

    @property
    def totals(self) -> dict[Outcome, int]:
        """How many rows have each outcome, of those that occur."""
        count = Counter(row.outcome for row in self.rows)
        return {outcome: count[outcome] for outcome in Outcome if count[outcome]}

    @property
    def cached(self) -> int:
        """How many were up to date."""
        return sum(row.cached for row in self.rows)

    @property
    def exit_code(self) -> int:
        """That of the worst row: 4 above 2 above 1 above 0, and 130 where the batch was stopped."""
        return worst(row.exit_code for row in self.rows)


def worst(codes: Iterable[int]) -> int:
    return max(codes, default=OK)


# What is wrong with the descriptions of a batch, for code scanning and annotations.


#: Codes of what concerns a file as a whole.
_CODES = {
    Outcome.CRASHED: "crashed",
    Outcome.TIMEOUT: "timeout",
    Outcome.MEMORY: "out-of-memory",
    Outcome.NOT_WRITTEN: "not-written",
    Outcome.INCOMPLETE: "incomplete",
}


def findings(summary: Summary) -> tuple[Finding, ...]:
    """Complaints with their places, then failed self-checks, claims that do not hold, and budgets that were met."""
    return tuple(finding for row in summary.rows for finding in _of(row))


def _of(row: Row) -> Iterator[Finding]:
    for x in row.complaints:
        yield Finding(row.file, x.code, x.message, x.severity, x.line, x.column, x.length or 1, x.hint)
    for check in row.checks:
        if check.failed:
            yield Finding(row.file, "self-check-failed", f"self-check failed: {check.name}: {check.detail}")
    severity = "error" if row.outcome is Outcome.CLAIMS else "warning"
    for claim in row.claims:
        if claim.word == "refuted":
            place = f"{claim.place}: " if claim.place else ""
            message = f"a claim does not hold: {place}{claim.title}: {claim.outcome}"
            yield Finding(row.file, "claim-refuted", message, severity)
    if row.outcome in _CODES:
        yield Finding(row.file, _CODES[row.outcome], row.message or "; ".join(row.notes) or str(row.outcome))
