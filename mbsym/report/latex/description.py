"""What stands in a description, in LaTeX as it stands there: expressions and loads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction

from mbsym.expressions.rates import without_velocity
from mbsym.expressions.table import Table
from mbsym.expressions.tree import KINKED, Call, Expression, Name, Negative, Number, Operation, children
from mbsym.formulas.latex import LatexNames, Symbol
from mbsym.model.speeds import OMEGA

# --- expressions ---

_FUNCTIONS = {"atan": "arctan", "log": "ln"}


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
    return f"\\{_FUNCTIONS.get(function, function)}({argument})"


def expression(value: Expression, names: LatexNames | _WithSpins) -> str:
    """An expression of the description, as it stands."""
    return _expression(value, names)[0]


class _WithSpins:
    """The names of a system, and the components of the angular velocity of a body: (omega_2)_1."""

    def __init__(self, names: LatexNames, number: int) -> None:
        self.names = names
        self.spins = {name: Symbol(f"(\\omega_{{{number}}})", str(k)) for k, name in enumerate(OMEGA, start=1)}

    def __getitem__(self, name: str) -> Symbol:
        return self.spins.get(name) or self.names[name]


def speed_form(form: Expression, names: LatexNames, number: int) -> str:
    """What a speed is made of; ``number`` is that of its body."""
    return expression(form, _WithSpins(names, number))


def speed(name: str, names: LatexNames) -> str:
    """A speed by name: p, or a dotted coordinate."""
    plain = without_velocity(name)
    return str(names[name]) if plain == name else names[plain].accented("dot")


def points(value: Sequence[tuple[Fraction, Fraction]], names: LatexNames) -> str:
    """The points of a table; a line may end behind each.  Of many the first and last."""
    written = [f"({expression(Number(x), names)},\\, {expression(Number(y), names)})" for x, y in shown_points(value)]
    if len(value) > MOST_LISTED:
        written[SHOWN_FIRST:SHOWN_FIRST] = [r"\dots"]
    return ",\\; \\allowbreak ".join(written)


def shown_points(value: Sequence[tuple[Fraction, Fraction]]) -> Sequence[tuple[Fraction, Fraction]]:
    """All of them, or some from either end where there are too many to read."""
    return value if len(value) <= MOST_LISTED else (*value[:SHOWN_FIRST], *value[-SHOWN_FIRST:])


def _expression(value: Expression, names: LatexNames | _WithSpins) -> tuple[str, int]:
    """(text, precedence): 1 sum, 2 product, 3 power, 4 atom."""
    match value:
        case Number(number):
            return _number(number), 4 if number >= 0 else 1
        case Name("pi"):
            return r"\pi", 4
        case Name(name):
            base, _, dots = name.rpartition("_")
            if dots in ("dot", "ddot") and base:
                return names[base].accented(dots), 4
            return str(names[name]), 4
        case Negative(operand):
            return "-" + _bracketed(operand, 2, names), 1
        case Call(function, argument, table=Table()):
            written = function.replace("_", "\\_")
            return f"\\operatorname{{{written}}}({expression(argument, names)})", 4
        case Call(function):
            return call(function, ", ".join(expression(one, names) for one in children(value))), 4
        case Operation("/", left, right):
            return f"\\frac{{{expression(left, names)}}}{{{expression(right, names)}}}", 4
        case Operation("**", base, exponent):
            # Of a fraction the exponent would seem to belong to the denominator.
            return f"{_bracketed(base, 5 if _is_fraction(base) else 4, names)}^{{{expression(exponent, names)}}}", 3
        case Operation("*", Negative(left), right):
            return _expression(Negative(Operation("*", left, right)), names)
        case Operation("*", left, right):
            return f"{_bracketed(left, 2, names)} {_bracketed(right, 2, names)}", 2
        case Operation(sign, left, right):
            return f"{_bracketed(left, 1, names)} {sign} {_bracketed(right, 2 if sign == '-' else 1, names)}", 1
    raise TypeError(f"not an expression: {value!r}")


def _bracketed(value: Expression, wanted: int, names: LatexNames | _WithSpins) -> str:
    text, precedence = _expression(value, names)
    return text if precedence >= wanted else f"({text})"


def _is_fraction(value: Expression) -> bool:
    match value:
        case Operation("/"):
            return True
        case Number(number):
            return _number(number).startswith("\\frac")
    return False


def _number(value: Fraction) -> str:
    if value.denominator == 1:
        return str(value.numerator)
    shown = repr(float(value))
    if "e" not in shown and Fraction(shown) == value:
        return shown
    return f"\\frac{{{value.numerator}}}{{{value.denominator}}}"


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
