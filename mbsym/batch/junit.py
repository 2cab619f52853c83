"""``junit.xml``: a suite a description; a case for its reading, each problem, claim and self-check.

A case has failed where something of the description's is wrong (it has errors, a self-check disagrees, a claim is
refuted where claims must hold), an error where mbsym or a budget ended it, and is skipped where there is no answer and
none is owed: a problem without a closed form, a claim that is undecided.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from mbsym.batch.outcome import ClaimRow, Outcome, Row, Summary
from mbsym.expressions.safe import safe

FILENAME = "junit.xml"

#: Outcomes that are no fault of the description.
_ENDED = (Outcome.CRASHED, Outcome.TIMEOUT, Outcome.MEMORY, Outcome.NOT_WRITTEN, Outcome.INCOMPLETE)
_UNTRIED = (Outcome.SKIPPED, Outcome.INTERRUPTED)


@dataclass(frozen=True, slots=True)
class Case:
    """``kind`` is "" for what holds, else failure, error or skipped, with what to say."""

    name: str
    kind: str = ""
    message: str = ""
    text: str = ""


def junit(summary: Summary) -> str:
    """The file's text; the times are those of the batch, 0 for what was up to date."""
    suites = Element("testsuites", {"name": "mbsym"})
    totals = {"tests": 0, "failures": 0, "errors": 0}
    for row in summary.rows:
        for key, count in _suite(suites, row, summary).items():
            totals[key] += count
    suites.attrib |= {key: str(count) for key, count in totals.items()} | {"time": f"{summary.seconds:.3f}"}
    indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(suites, encoding="unicode") + "\n"


def _suite(suites: Element, row: Row, summary: Summary) -> dict[str, int]:
    """One description; how many cases there are, and how many did not hold."""
    tests = list(cases(row, strict=row.outcome is Outcome.CLAIMS))
    count = {kind: sum(case.kind == kind for case in tests) for kind in ("failure", "error", "skipped")}
    seconds = 0.0 if row.cached else row.seconds
    numbers = {"tests": len(tests), "failures": count["failure"], "errors": count["error"]}
    counts = {key: str(value) for key, value in numbers.items()}
    attributes = {"name": safe(row.file), **counts, "skipped": str(count["skipped"]), "time": f"{seconds:.3f}"}
    suite = SubElement(suites, "testsuite", attributes)
    properties = SubElement(suite, "properties")
    shown = {
        "system": row.name,
        "outcome": str(row.outcome),
        "mbsym": summary.version,
        "cached": str(row.cached).lower(),
    }
    for name, value in shown.items():
        SubElement(properties, "property", {"name": name, "value": safe(value)})
    for case in tests:
        element = SubElement(suite, "testcase", {"classname": safe(row.file), "name": safe(case.name), "time": "0"})
        if case.kind:
            inner = SubElement(element, case.kind, {"message": safe(case.message)})
            if case.kind != "skipped":
                inner.set("type", "mbsym")
                inner.text = "\n".join(map(safe, (case.text or case.message).split("\n")))
    return numbers


def cases(row: Row, strict: bool = False) -> Iterator[Case]:
    """The cases of one description.  ``strict``: a claim that is not proved to hold has failed."""
    yield _reading(row)
    if row.outcome in _ENDED:
        text = row.message or "; ".join(row.notes)
        yield Case("derivation", "error", f"{row.outcome}: {text}" if text else str(row.outcome), "\n".join(row.notes))
    elif row.outcome in _UNTRIED:
        yield Case("derivation", "skipped", str(row.outcome))
    for problem in row.problems:
        name = f"problem {problem.number}: {problem.title}"
        reason = problem.reason or problem.code or ""
        kind = "" if problem.status == "derived" else "error" if problem.defect else "skipped"
        yield Case(name, kind, reason, "\n".join(filter(None, (reason, problem.hint))))
    for number, claim in enumerate(row.claims, start=1):
        yield _claim(number, claim, strict)
    for check in row.checks:
        kind = "failure" if check.failed else "skipped" if check.outcome == "undecided" else ""
        text = f"{check.first} against {check.second}: {check.outcome}"
        yield Case(f"self-check: {check.name}", kind, text, f"{text}\n{check.detail}")


def _reading(row: Row) -> Case:
    errors = [complaint for complaint in row.complaints if complaint.severity == "error"]
    if not errors:
        return Case("description")
    places = [f"{row.file}:{error.line}:{error.column}: " if error.line else f"{row.file}: " for error in errors]
    lines = [
        f"{place}{error.code}: {error.message}" + (f" (hint: {error.hint})" if error.hint else "")
        for place, error in zip(places, errors, strict=True)
    ]
    return Case("description", "failure", lines[0], "\n".join(lines))


def _claim(number: int, claim: ClaimRow, strict: bool) -> Case:
    """A refuted claim is a finding, no failure, unless claims must hold: it is skipped with its reason."""
    name = f"claim {number}: " + (f"{claim.place}: " if claim.place else "") + claim.title
    if claim.word == "held":
        return Case(name)
    kind = "failure" if strict else "skipped"
    said = claim.outcome if claim.outcome.startswith(claim.word) else f"{claim.word}: {claim.outcome}"
    return Case(name, kind, said, "\n".join([claim.outcome, *claim.lines]))
