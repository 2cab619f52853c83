"""Results as plain text: formulas in Python syntax, counted things, conditions in a line."""

from __future__ import annotations

from collections.abc import Callable

from mbsym.expressions.counting import counted
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.report.conditions import Statement
from mbsym.report.documents.parts import Counted

#: The text of a formula; of one that is not written out, its length and a digest of it.
Written = str | Counted
Write = Callable[[Formula], Written]


#: Conditions longer than this are counted, not printed.
LONGEST = 100


def column_text(values: Column, write: Write) -> list[Written]:
    return [write(x) for x in values]


def matrix_text(values: Matrix, write: Write) -> list[list[Written]]:
    return [column_text(row, write) for row in values]


def statement_text(statement: Statement) -> str:
    """``formula > 0``, or what is wrong with it."""
    if statement.formula is None:
        return f"{statement.label} {statement.relation} 0: {statement.note}"
    return f"{statement.formula} {statement.relation} 0"


def shortened(text: str, terms: int) -> str:
    """The text, or how long it is."""
    return text if len(text) <= LONGEST else f"({counted(terms, 'term')}; see the reports)"
