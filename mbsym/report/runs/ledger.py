"""The ledger as CSV, as part of ``results.json`` and as a document."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message, joined, worded
from mbsym.numerics.ledger.entry import NEEDED, NOT_NEEDED, OPEN, SECONDS, Ledger, Measure
from mbsym.report.content import Block, Fact, Facts, Graded, Phrase, Subheading, paragraph
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import plain
from mbsym.report.runs.trajectory_csv import text_table

COLUMNS = ("kind", "what", "why", "how", "quantity", "unit", "without", "with", "saved", "at_least", "standing")

#: By what follows of a saving; an accuracy is that of --accuracy and --until.
_TITLES = {
    NOT_NEEDED: Message("ledger: left out because this scene does not need it"),
    OPEN: Message("ledger: left out; whether this scene needs it depends on the accuracy (--accuracy X --until T)"),
    NEEDED: Message("ledger: left out although this scene needs it at this accuracy"),
}
_GRADES = {Certainty.ESTIMATED: "open", Certainty.UNDECIDED: "open"}

#: So many names are told on the terminal; the files hold all of them.
MOST_NAMES = 8


@dataclass(frozen=True)
class LedgerLine:
    """One saving as text: what was left out, why that is safe (and how it is known), what it saved; whether the scene
    needs it."""

    kind: str
    what: str
    why: str
    how: Certainty
    saved: tuple[str, ...]
    standing: str = NOT_NEEDED


def ledger_lines(ledger: Ledger) -> tuple[LedgerLine, ...]:
    """Every saving as text; measures that come out equal, or nearly as quick, are left to the files."""
    return tuple(
        LedgerLine(
            worded(item.kind),
            _names(item.what),
            item.why,
            item.how,
            tuple(_compared(measure) for measure in item.measures if measure.clear),
            item.standing,
        )
        for item in ledger.savings
    )


def ledger_blocks(ledger: Ledger) -> Iterator[Block]:
    """What was left out, why that is safe, what it saved; apart, what nobody knows to be safe, and what is not."""
    lines = ledger_lines(ledger)
    for standing, title in _TITLES.items():
        own = [line for line in lines if line.standing == standing]
        if own or standing == NOT_NEEDED:
            yield Subheading((Graded(title, "bad") if standing == NEEDED else title,))
            yield Facts(tuple(map(_fact, own))) if own else paragraph("  ", Message("nothing"))
    if ledger.unmeasured:
        kinds = joined(map(worded, ledger.unmeasured), ", ")
        yield paragraph(Graded(Message("not measured, beyond the budget: [[kinds]]", kinds=kinds), "open"))


def _fact(line: LedgerLine) -> Fact:
    why = Phrase((worded(line.why), " (", Graded(worded(line.how), _GRADES.get(line.how, "good")), ")"))
    return Fact(worded(line.kind), (line.what, why, *line.saved))


def _names(names: Sequence[str]) -> Message:
    more = len(names) - MOST_NAMES
    if more <= 1:
        return joined(names, ", ")
    return Message("[[names]] and [[more]] more", names=joined(names[:MOST_NAMES], ", "), more=more)


def _compared(item: Measure) -> Message:
    taken, without = _number(item.taken, item), _number(item.without, item)
    if item.at_least:
        text = "[[quantity]]: [[taken]] instead of more than [[without]]"
    elif item.saved < 0:
        text = "[[quantity]]: [[taken]] instead of [[without]] (costs more)"
    else:
        text = "[[quantity]]: [[taken]] instead of [[without]]"
    return Message(text, quantity=worded(item.quantity), taken=taken, without=without)


def _number(value: float, item: Measure) -> str:
    return f"{value:.3g}" if item.unit == SECONDS else str(int(value))


def ledger_csv(ledger: Ledger) -> str:
    """One row a measure."""
    rows: list[Sequence[object]] = []
    for saving in ledger.savings:
        head = (saving.kind, "; ".join(saving.what), saving.why, saving.how)
        for item in saving.measures:
            numbers = (f"{x:.6g}" if item.unit == SECONDS else int(x) for x in (item.without, item.taken, item.saved))
            rows.append((*head, item.quantity, item.unit, *numbers, "yes" if item.at_least else "no", saving.standing))
    return text_table(COLUMNS, rows)


def with_ledger(results: str, ledger: Ledger) -> str:
    """The text of ``results.json`` with the ledger in it."""
    content = json.loads(results) | {"ledger": plain(doc.Ledger.from_result(ledger))}
    return json.dumps(content, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
