"""Angles as linear forms: what stands inside sin and cos.

sin(2*theta - chi + pi/2) is polynomial in sin theta, cos theta, sin chi, cos chi because its argument is a linear
form with rational coefficients.  An argument that is not (``Omega*t``, ``x*y``) is an angle of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation


@dataclass(frozen=True, slots=True)
class LinearForm:
    """sum_k coefficient_k * name_k + turns * pi + constant; coefficients sorted by name, none zero."""

    coefficients: tuple[tuple[str, Fraction], ...] = ()
    turns: Fraction = Fraction(0)
    constant: Fraction = Fraction(0)

    def __add__(self, other: LinearForm) -> LinearForm:
        total = dict(self.coefficients)
        for name, value in other.coefficients:
            total[name] = total.get(name, Fraction(0)) + value
        coefficients = tuple(sorted((name, value) for name, value in total.items() if value))
        return LinearForm(coefficients, self.turns + other.turns, self.constant + other.constant)

    def scaled(self, factor: Fraction) -> LinearForm:
        if not factor:
            return LinearForm()
        coefficients = tuple((name, value * factor) for name, value in self.coefficients)
        return LinearForm(coefficients, self.turns * factor, self.constant * factor)

    @property
    def is_constant(self) -> bool:
        return not self.coefficients and not self.turns


_ONE = Fraction(1)


def linear_form(expression: Expression) -> LinearForm | None:
    """The linear form an expression is, or None where it is none with rational coefficients."""
    match expression:
        case Number(value):
            return LinearForm(constant=value)
        case Name("pi"):
            return LinearForm(turns=_ONE)
        case Name(name):
            return LinearForm(((name, _ONE),))
        case Negative(operand):
            inner = linear_form(operand)
            return None if inner is None else inner.scaled(-_ONE)
        case Operation("+" | "-" as operator, left, right):
            if (first := linear_form(left)) is None or (second := linear_form(right)) is None:
                return None
            return first + (second if operator == "+" else second.scaled(-_ONE))
        case Operation("*", left, right):
            if (first := linear_form(left)) is None or (second := linear_form(right)) is None:
                return None
            if first.is_constant:
                return second.scaled(first.constant)
            return first.scaled(second.constant) if second.is_constant else None
        case Operation("/", left, right):
            if (second := linear_form(right)) is None or not second.is_constant or not second.constant:
                return None
            if (first := linear_form(left)) is None:
                return None
            return first.scaled(1 / second.constant)
        case Operation("**", base, Number(exponent)):
            inner = linear_form(base)
            if inner is None or not inner.is_constant or exponent.denominator != 1 or abs(exponent) > 64:
                return None
            if not inner.constant and exponent <= 0:
                return None
            return LinearForm(constant=Fraction(inner.constant**exponent.numerator))
        case Call():
            return None
    return None


def angle_name(angle: Expression | None) -> str | None:
    """``theta`` for an angle ``theta`` or ``-theta``; None for anything else."""
    match angle:
        case Name(name) | Negative(Name(name)):
            return name
    return None
