"""What is wrong with the descriptions of a batch, for code scanning and annotations."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.batch.outcome import Outcome, Row, Summary
from mbsym.report.words.findings import Finding

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
    for one in row.complaints:
        yield Finding(row.file, one.code, one.message, one.severity, one.line, one.column, one.length or 1, one.hint)
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
