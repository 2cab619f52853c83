"""The results of ``mbsym extremes`` as CSV, JSON and rows of a table on the screen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from mbsym.expressions.message import Message, joined, worded
from mbsym.numerics.extremes.extremes import Extremes, Row
from mbsym.numerics.extremes.extremes_told import sentences
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
from mbsym.numerics.trade.digits import FULL
from mbsym.report.documents import extremes as doc
from mbsym.report.documents.base import file_of
from mbsym.report.runs.trajectory_csv import text_table

HEADER = (
    "kind",
    "subject",
    "size",
    "quantity",
    "digits_float32",
    "digits_float64",
    "worst_entry_float32",
    "worst_entry_float64",
    "formula_digits_float64",
    "condition",
    "verdict",
    "bits",
)


def extremes_csv(extremes: Extremes) -> str:
    """One line for each quantity on each rung; verdicts of stability follow as quantity ``stability``."""
    rows: list[Sequence[object]] = []
    for row in extremes.rows:
        d = row.digits
        digits = [d.digits[FLOAT32], d.digits[FLOAT64], d.worst[FLOAT32], d.worst[FLOAT64], d.formula]
        numbers = [f"{x:.2f}" for x in digits]
        about = (row.kind, row.subject, f"{row.size:.0e}", row.quantity)
        rows.append((*about, *numbers, f"{d.condition:.3e}", d.verdict, d.bits))
    for item in extremes.verdicts:
        judged = item.judged
        said = [judged.floats[FLOAT32], judged.floats[FLOAT64]]
        about = (item.kind, item.subject, f"{item.size:.0e}", "stability")
        rows.append((*about, *said, "", "", "", "", judged.exact.word, ""))
    return text_table(HEADER, rows)


def extremes_json(extremes: Extremes) -> str:
    """Everything, with the sentences; numbers that are infinite are null."""
    singular = extremes.singularities
    return file_of(
        doc.Extremes,
        extremes.system,
        extremes,
        sentences=sentences(extremes),
        singular=None if singular is None or not singular.how else singular,
        eigenvalues=[
            (float(x.real.mid()), float(x.imag.mid()), float(max(x.real.rad(), x.imag.rad())))
            for x in extremes.eigenvalues
        ],
        stability=[
            doc.StabilityAt.from_result(item, floats_wrong={scalar: item.judged.wrong(scalar) for scalar in FULL})
            for item in extremes.verdicts
        ],
    )


def tables(extremes: Extremes) -> Iterator[tuple[list[str], list[list[str]]]]:
    """Column titles, and for each ladder the fewest digits of each quantity, ``float64 / float32``.

    A star marks digits lost by the formula rather than by the question.  The equations of motion come first, then the
    linear equations.
    """
    for linear in (False, True):
        columns = [quantity for quantity in extremes.quantities if (quantity in _LINEAR) == linear]
        rows = []
        for kind, subject in extremes.ladders:
            cells = [_cell(extremes.of(kind, subject, quantity)) for quantity in columns]
            if any(cells):
                own = [v for v in extremes.verdicts if (v.kind, v.subject) == (kind, subject)]
                title: str = worded(subject)
                if kind == "ratio":
                    title = Message("[[name]] times 1e-12 to 1e12", name=subject)
                elif kind == "rates":
                    title = Message("rates 1e-8 to 1e8")
                rows.append([title, *cells, *([_verdicts(own)] if linear else [])])
        if rows:
            yield [EXTREME, *map(Message, columns), *([APPROXIMATION] if linear else [])], rows


#: The title of verdicts: they are those of the linear equations, which problem 6 may know more about.
EXTREME, APPROXIMATION = Message("extreme"), Message("first approximation")

_LINEAR = ("M", "D", "G", "K", "N", "eigenvalues")


def _cell(rows: Sequence[Row]) -> str:
    if not rows:
        return ""
    known = [row for row in rows if row.digits.bits]
    if not known:
        return "?"
    least = {scalar: min(row.digits.digits[scalar] for row in known) for scalar in FULL}
    star = "*" if any(row.digits.verdict == "formula" for row in known) else ""
    return f"{least[FLOAT64]:.0f}{star} / {least[FLOAT32]:.0f}"


def _verdicts(own: Sequence[Any]) -> str:
    if not own:
        return ""
    words = joined(dict.fromkeys(Message(v.judged.exact.word) for v in own), ", ")
    wrong = sum(v.judged.wrong(FLOAT64) for v in own)
    text = "[[words]] (float64 wrong [[wrong]] of [[all]])"
    return Message(text, words=words, wrong=wrong, all=len(own)) if wrong else words
