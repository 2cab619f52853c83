"""What stands in a description, in LaTeX as it stands there: expressions, tables."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction

from mbsym.expressions.tree import KINKED, Call, Expression, Number
from mbsym.formulas.latex import LatexNames, Symbol
from mbsym.report.tree_printer import CALLED, TreePrinter

# --- expressions ---

#: A table of more points is shown by so many of its first and of its last.
MOST_LISTED, SHOWN_FIRST = 100, 4


def call(function: str, argument: str) -> str:
    """A function of one argument, known by Python's name."""
    if function == "sqrt":
        return f"\\sqrt{{{argument}}}"
    if function == "abs":
        return f"\\lvert {argument} \\rvert"
    if function in KINKED:
        return f"\\operatorname{{{function}}}({argument})"
    return f"\\{CALLED.get(function, function)}({argument})"


def expression(value: Expression, names: LatexNames) -> str:
    """An expression of the description, as it stands."""
    return _Latex(names)(value)


def speed_form(form: Expression, names: LatexNames, number: int) -> str:
    """What a speed is made of; ``number`` is that of its body."""
    return _Latex.of_body(names, number)(form)


def points(value: Sequence[tuple[Fraction, Fraction]], names: LatexNames) -> str:
    """The points of a table; a line may end behind each.  Of many the first and last."""
    written = [f"({expression(Number(x), names)},\\, {expression(Number(y), names)})" for x, y in shown_points(value)]
    if len(value) > MOST_LISTED:
        written[SHOWN_FIRST:SHOWN_FIRST] = [r"\dots"]
    return ",\\; \\allowbreak ".join(written)


def shown_points(value: Sequence[tuple[Fraction, Fraction]]) -> Sequence[tuple[Fraction, Fraction]]:
    """All of them, or some from either end where there are too many to read."""
    return value if len(value) <= MOST_LISTED else (*value[:SHOWN_FIRST], *value[-SHOWN_FIRST:])


class _Latex(TreePrinter[LatexNames]):
    minus, times, pi = "-", " ", r"\pi"

    @staticmethod
    def spin(number: int, k: int) -> str:
        return str(Symbol(f"(\\omega_{{{number}}})", str(k)))

    def symbol(self, name: str, dots: str) -> str:
        return self.names[name].accented(dots) if dots else str(self.names[name])

    def decimal(self, text: str) -> str:
        return text

    def quotient(self, value: Fraction) -> str:
        return self.fraction(str(value.numerator), str(value.denominator))

    def fraction(self, top: str, bottom: str) -> str:
        return f"\\frac{{{top}}}{{{bottom}}}"

    def power(self, base: str, exponent: str) -> str:
        return f"{base}^{{{exponent}}}"

    def sum(self, left: str, operator: str, right: str) -> str:
        return f"{left} {operator} {right}"

    def bracketed(self, text: str) -> str:
        return f"({text})"

    def call(self, value: Call, arguments: Sequence[str]) -> str:
        if value.table is None:
            return call(value.function, ", ".join(arguments))
        written = value.function.replace("_", "\\_")
        return f"\\operatorname{{{written}}}({arguments[0]})"


#: A formula of a sentence that is written with more characters may be broken.
LONGEST_IN_LINE = 160


def breakable(formula: str) -> str:
    """A formula in the line; a long one may be broken before a sign, a factor in brackets and after a comma."""
    if len(formula) <= LONGEST_IN_LINE:
        return f"${formula}$"
    parts, depth = [], 0
    for k, piece in enumerate(re.split(r"(\\[{}]|[{}]| [+-] |,\\; ?| \(| \\cos| \\sin)", formula)):
        depth += (piece == "{") - (piece == "}")
        at_sign = depth == 0 and k % 2 == 1
        if at_sign and piece.startswith(" "):
            piece = f" \\penalty0{piece}"
        elif at_sign and piece.startswith(","):
            piece = f"{piece}\\penalty0 "
        parts.append(piece)
    return f"${''.join(parts)}$"
