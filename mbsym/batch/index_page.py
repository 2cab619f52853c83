"""``index.html``: the batch as a page, one file, without scripts and network; every report is a link from it."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from urllib.parse import quote

from mbsym.batch.outcome import Outcome, Row, Summary
from mbsym.expressions.message import counted
from mbsym.expressions.safe import safe

FILENAME = "index.html"

_STYLE = """
:root { color-scheme: light dark; font: 15px/1.45 system-ui, sans-serif; }
body { max-width: 78rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .35rem .6rem; border-bottom: 1px solid #8885; }
.bad { color: light-dark(#a11, #f88); font-weight: 600; }
.quiet { color: light-dark(#555, #aaa); }
ul { margin: 0; padding-left: 1.1rem; }
@media print { body { max-width: none; margin: 0; } }
"""

#: Files that are worth a link of their own, in this order.
_LINKED = ("report.html", "report.tex", "appendix.tex", "report.wl", "model.py", "model.c", "results.json")


def index_page(summary: Summary, name: str) -> str:
    """The page; ``name`` is that of the summary beside it."""
    totals = ", ".join(f"{count} {outcome}" for outcome, count in summary.totals.items())
    head = f"{counted(len(summary.rows), 'system', 'systems')}: {totals}" if summary.rows else "no systems"
    rows = "\n".join(_row(row) for row in summary.rows)
    part = f", part {_text(summary.shard)}" if summary.shard else ""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>mbsym batch</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>mbsym batch</h1>
<p>{_text(head)}{part}. mbsym {_text(summary.version)}. <a href="{quote(name)}">{_text(name)}</a></p>
<table>
<thead><tr><th scope="col">description</th><th scope="col">system</th><th scope="col">outcome</th>
<th scope="col">stability</th><th scope="col">claims, self-checks</th><th scope="col">files</th></tr></thead>
<tbody>
{rows}
</tbody>
</table>
</body>
</html>
"""


def _text(value: str) -> str:
    """Text of a description, or about one, as text of the page."""
    return escape(safe(value))


def _row(row: Row) -> str:
    style = ' class="bad"' if row.outcome.failed else ""
    cells = [
        f'<th scope="row">{_text(row.file)}</th>',
        f"<td>{_text(row.name)}</td>",
        f"<td><span{style}>{_text(str(row.outcome))}</span>{_list(_reasons(row))}</td>",
        f"<td>{_list(_verdicts(row))}</td>",
        f"<td>{_list(_checks(row))}</td>",
        f"<td>{', '.join(_links(row))}</td>",
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _list(items: Iterator[str]) -> str:
    found = list(items)
    return f"<ul>{''.join(f'<li>{_text(item)}</li>' for item in found)}</ul>" if found else ""


def _reasons(row: Row) -> Iterator[str]:
    if row.message:
        yield row.message
    yield from row.notes
    for complaint in row.complaints:
        place = f"{complaint.line}:{complaint.column}: " if complaint.line else ""
        yield f"{place}{complaint.severity}: {complaint.message}" + (f" ({complaint.hint})" if complaint.hint else "")


def _verdicts(row: Row) -> Iterator[str]:
    for problem in row.problems:
        if problem.verdict is not None:
            yield f"in symbols: {problem.verdict}"
        if problem.verdict_at_values is not None:
            yield f"at the values: {problem.verdict_at_values}"
        if problem.status != "derived" and row.outcome is not Outcome.ERRORS:
            yield f"no problem {problem.number}: {problem.reason or problem.code}"


def _checks(row: Row) -> Iterator[str]:
    held = sum(claim.word == "held" for claim in row.claims)
    if row.claims:
        yield f"{held} of {counted(len(row.claims), 'claim holds', 'claims hold')}"
    for claim in row.claims:
        if claim.word != "held":
            yield f"{claim.word}: {claim.place + ': ' if claim.place else ''}{claim.title}: {claim.outcome}"
    failed = [check for check in row.checks if check.failed]
    for check in failed:
        yield f"self-check FAILED: {check.name}: {check.detail}"
    if row.checks and not failed:
        words = sorted({check.outcome for check in row.checks})
        yield f"{counted(len(row.checks), 'self-check', 'self-checks')}: {', '.join(words)}"


def _links(row: Row) -> Iterator[str]:
    there = {file.name for file in row.files}
    for name in (name for name in _LINKED if name in there):
        yield f'<a href="{quote(f"{row.folder}/{name}")}">{escape(name)}</a>'
