"""Formulas, vectors and matrices in LaTeX for a page of some width: as a whole where they fit, else entry by entry."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from mbsym.expressions.tree import ZERO, Expression
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.latex import LatexNames, latex_factor, latex_matrix, latex_text
from mbsym.report.latex.description import expression

#: Matrices estimated wider than this (in ems) are written entry by entry.
WIDEST = 40
#: The same in a column of a two-column document, 229 pt in article, with an equation number beside it.
NARROW = 17
#: Longer formulas are left to the machine-readable files: nobody reads them, and TeX's memory is finite.
LONGEST = 6000
#: Conditions with more terms than this are counted instead of written: what they say, they say in results.json.
LONGEST_CONDITION = 150


def formula(value: Formula) -> str:
    """A formula that may be broken."""
    return latex_text(value.ring, value.polynomial, breaks=True)


def is_readable(value: Formula) -> bool:
    """Whether anybody would read the polynomial."""
    return value.terms <= LONGEST and len(_SIGN.findall(formula(value))) < LONGEST_CONDITION


def width(latex: str) -> float:
    """A rough estimate in ems."""
    letters = _WITHOUT_WIDTH.sub("", latex)
    functions = len(_FUNCTION.findall(letters))
    symbols = _SYMBOL.sub("x", letters)
    return 0.55 * symbols.count("x") + functions + 1.3 * len(_SIGN.findall(symbols))


_WITHOUT_WIDTH = re.compile(r"\\(frac|left|right|bigl|bigr|Bigl|Bigr|dot|ddot|mathrm|mathit|penalty\d+)")
_FUNCTION, _SYMBOL, _SIGN = (re.compile(x) for x in (r"\\(sin|cos|exp|ln)", r"\\[A-Za-z]+|[^\W_]", r" [+-] "))


def measured_matrix(value: Matrix) -> tuple[str, float]:
    """The pmatrix and its width; "" if an entry is too long for any page."""
    if any(x.terms > 60 for row in value for x in row):
        return "", 0.0
    number, rest = value.number_and_rest
    rows = [[x.latex() for x in row] for row in rest]
    wide = sum(max(map(width, column)) + 1.2 for column in zip(*rows, strict=True))
    text = latex_matrix(rows) if number == 1 else f"{number} {latex_matrix(rows)}"
    return text, wide


#: Gives ``measured_matrix``, perhaps from what was printed before.
Measured = Callable[[Matrix], tuple[str, float]]


def matrix(
    value: Matrix, long: frozenset[int] = frozenset(), widest: float = WIDEST, measured: Measured = measured_matrix
) -> str:
    """A pmatrix, or nothing if that would be too wide or holds one of the ``long`` formulas."""
    if any(id(x) in long for row in value for x in row):
        return ""
    text, wide = measured(value)
    return text if wide <= widest else ""


def tensor(value: Sequence[Sequence[Expression]], names: LatexNames, widest: float) -> str:
    """A tensor of inertia; a wide one row by row."""
    if all(value[i][j] == ZERO for i in range(3) for j in range(3) if i != j):
        return "\\operatorname{diag}(" + ",\\; ".join(expression(value[k][k], names) for k in range(3)) + ")"
    rows = [[expression(x, names) for x in expressions] for expressions in value]
    if sum(max(map(width, column)) + 1.2 for column in zip(*rows, strict=True)) <= widest:
        return latex_matrix(rows)
    return "(" + ";\\; \\penalty0 ".join(",\\; ".join(one) for one in rows) + ")"


def row(values: Column, long: frozenset[int] = frozenset(), widest: float = WIDEST) -> str:
    """Components side by side, or nothing if that would be too wide or holds one of the ``long`` formulas."""
    if any(id(x) in long for x in values):
        return ""
    written = [x.latex() if x.terms <= 30 else "" for x in values]
    fits = all(written) and sum(map(width, written)) <= widest
    return ",\\; ".join(written) if fits else ""


def polynomial(coefficients: Sequence[Formula], variable: str, length: Callable[[Formula], str]) -> str:
    """sum of coefficient*variable^k, highest power first; instead of one that nobody would read its ``length``."""
    written: list[str] = []
    for power, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient.is_zero:
            continue
        raised = "" if power == 0 else f" {variable}" if power == 1 else f" {variable}^{{{power}}}"
        if not is_readable(coefficient):
            written.append(" \\penalty0 " + ("+ " if written else "") + length(coefficient) + raised)
            continue
        if raised:
            text = latex_factor(coefficient.ring, coefficient.polynomial, breaks=True)
        else:
            text = formula(coefficient)
        written.append(" \\penalty0 " + ("" if text.startswith("-") or not written else "+ ") + text + raised)
    return "".join(written) or "0"
