"""The ledger as CSV, as part of ``results.json`` and as lines for the terminal."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO

from mbsym.algebra.certainty import Certainty
from mbsym.numerics.ledger.entry import NOT_NEEDED, SECONDS, Ledger, Measure, Saving
from mbsym.report.documents.results import ledger as doc
from mbsym.report.documents.writer import plain

COLUMNS = ("kind", "what", "why", "how", "quantity", "unit", "without", "with", "saved", "at_least", "standing")

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


def ledger_lines(found: Ledger) -> tuple[LedgerLine, ...]:
    """Every saving as text; measures that come out equal, or nearly as quick, are left to the files."""
    return tuple(
        LedgerLine(
            item.kind,
            _names(item.what),
            item.why,
            item.how,
            tuple(_compared(measure) for measure in item.measures if measure.clear),
            item.standing,
        )
        for item in found.savings
    )


def _names(names: Sequence[str]) -> str:
    more = len(names) - MOST_NAMES
    return ", ".join(names) if more <= 1 else ", ".join(names[:MOST_NAMES]) + f" and {more} more"


def _compared(item: Measure) -> str:
    least = "more than " if item.at_least else ""
    costs = " (costs more)" if item.saved < 0 else ""
    return f"{item.quantity}: {_number(item.taken, item)} instead of {least}{_number(item.without, item)}{costs}"


def _number(value: float, item: Measure) -> str:
    return f"{value:.3g}" if item.unit == SECONDS else str(int(value))


def ledger_csv(found: Ledger) -> str:
    """One row a measure."""
    stream = StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for saving in found.savings:
        head = (saving.kind, "; ".join(saving.what), saving.why, saving.how)
        for item in saving.measures:
            numbers = (f"{x:.6g}" if item.unit == SECONDS else int(x) for x in (item.without, item.taken, item.saved))
            writer.writerow(
                (*head, item.quantity, item.unit, *numbers, "yes" if item.at_least else "no", saving.standing)
            )
    return stream.getvalue()


def ledger_data(found: Ledger) -> doc.Ledger:
    """The ledger as a part of results.json."""
    return doc.Ledger(savings=[_saving(item) for item in found.savings], not_measured=list(found.unmeasured))


def _saving(item: Saving) -> doc.Saving:
    measures = [
        doc.Measure(
            quantity=measure.quantity,
            unit=measure.unit,
            without=measure.without,
            with_=measure.taken,
            at_least=measure.at_least,
        )
        for measure in item.measures
    ]
    return doc.Saving(
        kind=item.kind,
        what=list(item.what),
        why=item.why,
        how=item.how,
        measures=measures,
        standing=item.standing,
        error=item.error,
        tolerable=item.tolerable,
    )


def with_ledger(results: str, found: Ledger) -> str:
    """The text of ``results.json`` with the ledger in it."""
    content = json.loads(results) | {"ledger": plain(ledger_data(found))}
    return json.dumps(content, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
