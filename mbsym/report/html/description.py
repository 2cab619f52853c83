"""What stands in a description, in HTML as it stands there: expressions in MathML, loads in words."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from markupsafe import Markup

from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, children
from mbsym.formulas.mathml import (
    APPLY,
    TIMES,
    MathNames,
    bracketed,
    fraction,
    mi,
    mn,
    mo,
    power,
    sign,
)
from mbsym.model.speeds import OMEGA

_FUNCTIONS = {"atan": "arctan", "log": "ln"}
_DOTS = {"dot": "˙", "ddot": "¨"}


# --- expressions ------------------------------------------------------------------------------------------------------


def expression(value: Expression, names: MathNames | _WithSpins) -> Markup:
    """An expression of the description as MathML, as it stands."""
    return Markup(_expression(value, names)[0])


class _WithSpins:
    """The names of a system, and the components of the angular velocity of a body: (omega_2)_1."""

    def __init__(self, names: MathNames, number: int) -> None:
        self.names = names
        self.spins = {
            name: Markup(
                f"<msub><mrow><mo>(</mo><msub><mi>ω</mi><mn>{number}</mn></msub><mo>)</mo></mrow><mn>{k}</mn></msub>"
            )
            for k, name in enumerate(OMEGA, start=1)
        }

    def __getitem__(self, name: str) -> Any:
        return self.spins.get(name) or self.names[name]


def speed_form(form: Expression, names: MathNames, number: int) -> Markup:
    """What a speed is made of; ``number`` is that of its body."""
    return expression(form, _WithSpins(names, number))


def speed(name: str, names: MathNames) -> Markup:
    """A speed by name: p, or a dotted coordinate."""
    plain = without_velocity(name)
    return Markup(str(names[name]) if plain == name else str(names[plain].dotted("˙")))


def point_of_table(x: Fraction, y: Fraction, names: MathNames) -> str:
    """(x, y)."""
    return bracketed(f"{expression(Number(x), names)}{mo(',')}{expression(Number(y), names)}")


def _expression(value: Expression, names: MathNames | _WithSpins) -> tuple[str, int]:
    """(MathML, precedence): 1 sum, 2 product, 3 power, 4 atom."""
    match value:
        case Number(number):
            return _number(number), 4 if number >= 0 else 1
        case Name("pi"):
            return mi("π"), 4
        case Name(name):
            base, _, dots = name.rpartition("_")
            return str(names[base].dotted(_DOTS[dots]) if dots in _DOTS and base else names[name]), 4
        case Negative(operand):
            return sign("\u2212") + _bracketed(operand, 2, names), 1
        case Call("sqrt", argument):
            return f"<msqrt>{expression(argument, names)}</msqrt>", 4
        case Call("abs", argument):
            return f"<mrow>{mo('|')}{expression(argument, names)}{mo('|')}</mrow>", 4
        case Call(function):
            inner = bracketed(mo(",").join(expression(one, names) for one in children(value)))
            return f"<mrow>{mi(_FUNCTIONS.get(function, function))}{APPLY}{inner}</mrow>", 4
        case Operation("/", left, right):
            return fraction(expression(left, names), expression(right, names)), 4
        case Operation("**", base, exponent):
            # Of a fraction the exponent would seem to belong to the denominator.
            return power(_bracketed(base, 5 if _is_fraction(base) else 4, names), expression(exponent, names)), 3
        case Operation("*", Negative(left), right):
            return _expression(Negative(Operation("*", left, right)), names)
        case Operation("*", left, right):
            return _bracketed(left, 2, names) + TIMES + _bracketed(right, 2, names), 2
        case Operation(operator, left, right):
            shown = mo("\u2212" if operator == "-" else operator)
            return _bracketed(left, 1, names) + shown + _bracketed(right, 2 if operator == "-" else 1, names), 1
    raise TypeError(f"not an expression: {value!r}")


def _bracketed(value: Expression, wanted: int, names: MathNames | _WithSpins) -> str:
    text, precedence = _expression(value, names)
    return text if precedence >= wanted else bracketed(text)


def _is_fraction(value: Expression) -> bool:
    match value:
        case Operation("/"):
            return True
        case Number(number):
            return "<mfrac>" in _number(number)
    return False


def _number(value: Fraction) -> str:
    before = sign("\u2212") if value < 0 else ""
    if value.denominator == 1:
        return before + mn(abs(value.numerator))
    shown = repr(abs(float(value)))
    if "e" not in shown and Fraction(shown) == abs(value):
        return before + mn(shown)
    return before + fraction(mn(abs(value.numerator)), mn(value.denominator))
