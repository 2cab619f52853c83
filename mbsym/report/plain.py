"""Results as plain text: formulas in Python syntax, counted things, conditions in a line."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mbsym.expressions.counting import counted
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.report.conditions import Statement

#: The text of a formula, or its length.
Write = Callable[[Formula], str]


#: Conditions longer than this are counted, not printed.
LONGEST = 100


def column_text(values: Column, write: Write) -> list[str]:
    return [write(x) for x in values]


def matrix_text(values: Matrix, write: Write) -> list[list[str]]:
    return [column_text(row, write) for row in values]


def polynomial_text(coefficients: Sequence[Formula], variable: str) -> str:
    """sum of coefficient*variable**k, highest power first; the coefficients stay factored."""
    written = []
    for power, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient.is_zero:
            continue
        bare = variable if power == 1 else f"{variable}**{power}"
        written.append(f"({coefficient})" if power == 0 else bare if coefficient == 1 else f"({coefficient})*{bare}")
    return " + ".join(written) or "0"


def statement_text(statement: Statement) -> str:
    """``formula > 0``, or what is wrong with it."""
    if statement.formula is None:
        return f"{statement.label} {statement.relation} 0: {statement.note}"
    return f"{statement.formula} {statement.relation} 0"


def shortened(text: str, terms: int) -> str:
    """The text, or how long it is."""
    return text if len(text) <= LONGEST else f"({counted(terms, 'term')}; see the reports)"
