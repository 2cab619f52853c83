"""What stands in a description, in HTML as it stands there: expressions in MathML."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from markupsafe import Markup

from mbsym.expressions.tree import Call, Expression, Number
from mbsym.formulas.mathml import APPLY, TIMES, MathNames, bracketed, fraction, mi, mn, mo, power, sign
from mbsym.report.tree_printer import CALLED, TreePrinter

_DOTS = {"dot": "˙", "ddot": "¨"}
_MINUS = "\u2212"


def expression(value: Expression, names: MathNames) -> Markup:
    """An expression of the description as MathML, as it stands."""
    return Markup(_MathML(names)(value))


def speed_form(form: Expression, names: MathNames, number: int) -> Markup:
    """What a speed is made of; ``number`` is that of its body."""
    return Markup(_MathML.of_body(names, number)(form))


def point_of_table(x: Fraction, y: Fraction, names: MathNames) -> str:
    """(x, y)."""
    return bracketed(f"{expression(Number(x), names)}{mo(',')}{expression(Number(y), names)}")


class _MathML(TreePrinter[MathNames]):
    minus, times, pi = sign(_MINUS), TIMES, mi("π")
    fraction, power = staticmethod(fraction), staticmethod(power)

    @staticmethod
    def spin(number: int, k: int) -> str:
        return f"<msub><mrow><mo>(</mo><msub><mi>ω</mi><mn>{number}</mn></msub><mo>)</mo></mrow><mn>{k}</mn></msub>"

    def symbol(self, name: str, dots: str) -> str:
        return str(self.names[name].dotted(_DOTS[dots]) if dots else self.names[name])

    def decimal(self, text: str) -> str:
        return self.minus + mn(text[1:]) if text.startswith("-") else mn(text)

    def quotient(self, value: Fraction) -> str:
        shown = fraction(mn(abs(value.numerator)), mn(value.denominator))
        return self.minus + shown if value < 0 else shown

    def sum(self, left: str, operator: str, right: str) -> str:
        return left + mo(_MINUS if operator == "-" else operator) + right

    def bracketed(self, text: str) -> str:
        return bracketed(text)

    def call(self, value: Call, arguments: Sequence[str]) -> str:
        inner = mo(",").join(arguments)
        if value.function == "sqrt":
            return f"<msqrt>{inner}</msqrt>"
        if value.function == "abs":
            return f"<mrow>{mo('|')}{inner}{mo('|')}</mrow>"
        return f"<mrow>{mi(CALLED.get(value.function, value.function))}{APPLY}{bracketed(inner)}</mrow>"
