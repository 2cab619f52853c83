"""Results as plain text: formulas in Python syntax, counted things."""

from __future__ import annotations

from collections.abc import Callable

from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.report.documents.parts import Counted

#: The text of a formula; of one that is not written out, its length and a digest of it.
Written = str | Counted
Write = Callable[[Formula], Written]


def column_text(values: Column, write: Write) -> list[Written]:
    return [write(x) for x in values]


def matrix_text(values: Matrix, write: Write) -> list[list[Written]]:
    return [column_text(row, write) for row in values]
