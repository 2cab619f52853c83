"""What is wrong with files, for programs: annotations of GitHub, SARIF 2.1.0, JSON.

A ``Finding`` is a complaint with its file.  Each format escapes what it must by itself: descriptions are untrusted.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from urllib.parse import quote

from mbsym.expressions.place import Complaint
from mbsym.expressions.safe import safe

SARIF_VERSION = "2.1.0"
SARIF_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


@dataclass(frozen=True, slots=True)
class Finding:
    """One complaint about one file.

    ``path`` has forward slashes; ``line`` and ``column`` count from 1, in characters (None: the file as a whole);
    ``severity`` is ``error`` or ``warning``; ``code`` a short stable word.
    """

    path: str
    code: str
    message: str
    severity: str = "error"
    line: int | None = None
    column: int | None = None
    length: int = 1
    hint: str | None = None

    @property
    def text(self) -> str:
        """Message and hint, printable."""
        return safe(self.message) + (f"; hint: {safe(self.hint)}" if self.hint else "")


def findings_of(path: str, complaints: Iterable[Complaint]) -> tuple[Finding, ...]:
    """The complaints about a file as findings."""
    return tuple(
        Finding(
            path,
            complaint.code,
            complaint.message,
            complaint.severity,
            None if complaint.span is None else complaint.span.line,
            None if complaint.span is None else complaint.span.column,
            1 if complaint.span is None else max(1, complaint.span.length),
            complaint.hint,
        )
        for complaint in complaints
    )


def github_annotations(findings: Iterable[Finding]) -> str:
    """Workflow commands, a line each, that GitHub shows beside the lines of the file.

    ``::error file=PATH,line=L,col=C,endColumn=C,title=CODE::MESSAGE``
    """
    return "".join(f"{_annotation(finding)}\n" for finding in findings)


def _annotation(finding: Finding) -> str:
    properties = {"file": finding.path.encode(errors="backslashreplace").decode()}
    if finding.line is not None and finding.column is not None:
        last = finding.column + finding.length - 1
        properties |= {"line": str(finding.line), "col": str(finding.column), "endColumn": str(last)}
    properties["title"] = finding.code
    attributes = ",".join(f"{key}={_property(value)}" for key, value in properties.items())
    return f"::{finding.severity} {attributes}::{_data(finding.text)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def json_lines(findings: Iterable[Finding]) -> str:
    """One object a line, with the fields of :class:`Finding`."""
    return "".join(json.dumps(asdict(finding), sort_keys=True) + "\n" for finding in findings)


def sarif(findings: Sequence[Finding], version: str) -> str:
    """A SARIF log (Static Analysis Results Interchange Format, OASIS 2.1.0) with one run."""
    codes = sorted({finding.code for finding in findings})
    driver = {"name": "mbsym", "version": version, "rules": [{"id": code} for code in codes]}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(finding, codes.index(finding.code)) for finding in findings],
    }
    log = {"$schema": SARIF_SCHEMA, "version": SARIF_VERSION, "runs": [run]}
    return json.dumps(log, indent=2, ensure_ascii=False) + "\n"


def _result(item: Finding, rule: int) -> dict[str, object]:
    place: dict[str, object] = {"artifactLocation": {"uri": quote(item.path, errors="surrogateescape")}}
    if item.line is not None and item.column is not None:
        place["region"] = {"startLine": item.line, "startColumn": item.column, "endColumn": item.column + item.length}
    return {
        "ruleId": item.code,
        "ruleIndex": rule,
        "level": item.severity,
        "message": {"text": item.text},
        "locations": [{"physicalLocation": place}],
    }
