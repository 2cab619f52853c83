"""``index.html``: the batch as a page, one file, without scripts and network; every report is a link from it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from html import escape
from urllib.parse import quote

from mbsym.batch.outcome import Outcome, Row, Summary
from mbsym.expressions.message import Counted, Message, joined, worded
from mbsym.expressions.safe import safe
from mbsym.report.language import Language

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


def index_page(summary: Summary, name: str, language: Language) -> str:
    """The page; ``name`` is that of the summary beside it."""
    page = _Page(language.say)
    rows = "\n".join(map(page.row, summary.rows))
    columns = ("description", "name", "outcome", "stability", "claims and self-checks", "files")
    return f"""<!DOCTYPE html>
<html lang="{language.name}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>mbsym batch</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>mbsym batch</h1>
<p>{page.text(_head(summary))}. mbsym {page.text(summary.version)}. <a href="{quote(name)}">{page.text(name)}</a></p>
<table>
<thead><tr>{"".join(f'<th scope="col">{page.text(column)}</th>' for column in columns)}</tr></thead>
<tbody>
{rows}
</tbody>
</table>
</body>
</html>
"""


def _head(summary: Summary) -> Message:
    """How many of what, and of which part."""
    counts = [Message("[[count]] [[outcome]]", count=n, outcome=one) for one, n in summary.totals.items()]
    head = (
        joined((Counted(len(summary.rows), "system"), joined(counts, ", ")), ": ") if counts else Message("no systems")
    )
    return Message("[[head]], part [[part]]", head=head, part=summary.shard) if summary.shard else head


class _Page:
    """Rows of the table in a language."""

    def __init__(self, say: Callable[[str], str]) -> None:
        self.say = say

    def text(self, value: str) -> str:
        """Text of a description, or about one, as text of the page."""
        return escape(safe(self.say(value)))

    def row(self, row: Row) -> str:
        style = ' class="bad"' if row.outcome.failed else ""
        cells = [
            f'<th scope="row">{escape(safe(row.file))}</th>',
            f"<td>{escape(safe(row.name))}</td>",
            f"<td><span{style}>{self.text(row.outcome.value)}</span>{self._list(_reasons(row))}</td>",
            f"<td>{self._list(_verdicts(row))}</td>",
            f"<td>{self._list(_checks(row))}</td>",
            f"<td>{', '.join(_links(row))}</td>",
        ]
        return f"<tr>{''.join(cells)}</tr>"

    def _list(self, items: Iterable[str]) -> str:
        lines = "".join(f"<li>{self.text(item)}</li>" for item in items)
        return f"<ul>{lines}</ul>" if lines else ""


def _reasons(row: Row) -> Iterator[str]:
    if row.message:
        yield row.message
    yield from row.notes
    for complaint in row.complaints:
        place = [f"{complaint.line}:{complaint.column}"] if complaint.line else []
        text = "warning: [[message]]" if complaint.severity == "warning" else "error: [[message]]"
        told = joined((*place, Message(text, message=worded(complaint.message))), ": ")
        yield Message("[[told]] ([[hint]])", told=told, hint=worded(complaint.hint)) if complaint.hint else told


def _verdicts(row: Row) -> Iterator[str]:
    for problem in row.problems:
        if problem.verdict is not None:
            yield Message("in symbols: [[verdict]]", verdict=worded(problem.verdict))
        if problem.verdict_at_values is not None:
            yield Message("at the values: [[verdict]]", verdict=worded(problem.verdict_at_values))
        if problem.status != "derived" and row.outcome is not Outcome.ERRORS:
            reason = worded(problem.reason or problem.code or "")
            yield Message("no problem [[number]]: [[why]]", number=problem.number, why=reason)


def _checks(row: Row) -> Iterator[str]:
    held = sum(claim.word == "held" for claim in row.claims)
    if row.claims:
        yield Message("claims that hold: [[held]] of [[count]]", held=held, count=len(row.claims))
    for claim in row.claims:
        if claim.word != "held":
            place = [claim.place] if claim.place else []
            yield joined((worded(claim.word), *place, worded(claim.title), worded(claim.outcome)), ": ")
    failed = [check for check in row.checks if check.failed]
    for check in failed:
        yield joined((Message("SELF-CHECK FAILED"), worded(check.name), worded(check.detail)), ": ")
    if row.checks and not failed:
        outcomes = [worded(outcome) for outcome in sorted({check.outcome for check in row.checks})]
        yield Message("self-checks: [[count]] ([[outcomes]])", count=len(row.checks), outcomes=joined(outcomes, ", "))


def _links(row: Row) -> Iterator[str]:
    there = {file.name for file in row.files}
    for name in (name for name in _LINKED if name in there):
        yield f'<a href="{quote(f"{row.folder}/{name}")}">{escape(name)}</a>'
