"""Formulas of claims as trigonometric polynomials of a phase, over the numbers in which a solution is told."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.tower import Element, Tower
from mbsym.expressions.angles import linear_form
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation
from mbsym.problems.small_parameter.harmonics import Harmonics

#: Powers and harmonics beyond are not formed.
MOST_POWER, MOST_HARMONIC = 24, 60


class WaveFormulas:
    """Values of expressions.  ``known`` names have values, ``defined`` ones stand for an expression.

    Raises NoClosedForm for what is no trigonometric polynomial of the phase with such coefficients.
    """

    def __init__(
        self, tower: Tower, phase: str, known: Mapping[str, Element], defined: Mapping[str, Expression]
    ) -> None:
        self.tower, self.phase = tower, phase
        self.defined = defined
        self._values = {name: Harmonics.constant(tower, x) for name, x in known.items()}

    def __call__(self, expression: Expression) -> Harmonics:
        match expression:
            case Number(value):
                return self._constant(self.tower.number(value))
            case Name(name):
                return self._named(name)
            case Negative(operand):
                return self(operand).scaled(-self.tower.one)
            case Operation("+", left, right):
                return self(left) + self(right)
            case Operation("-", left, right):
                return self(left) - self(right)
            case Operation("*", left, right):
                return self._product(self(left), self(right))
            case Operation("/", left, right):
                return self(left).scaled(self.tower.reciprocal(self.constant(right)))
            case Operation("**", base, exponent):
                return self._power(self(base), exponent)
            case Call("sqrt", argument):
                return self._constant(self.tower.square_root(self.constant(argument)))
            case Call("sin" | "cos" as function, argument):
                return self._wave(function, argument)
            case Call(function, _):
                raise NoClosedForm(
                    Message("[[function]] in the coefficient of an expansion: not compared", function=function)
                )
        raise NoClosedForm("an expression that is not compared with expansions")

    def constant(self, expression: Expression) -> Element:
        """The value of what does not hold the phase."""
        value = self(expression)
        if any(k for k in value.waves):
            raise NoClosedForm("division by what changes with the phase: not compared with expansions")
        return value.mean

    def _constant(self, value: Element) -> Harmonics:
        return Harmonics.constant(self.tower, value)

    def _named(self, name: str) -> Harmonics:
        if name not in self._values:
            if name not in self.defined:
                what = "it is no constant of the solution" if name != self.phase else "it stands outside of sin and cos"
                raise NoClosedForm(Message("[[name]] is not in the solution: [[what]]", name=name, what=what))
            self._values[name] = self(self.defined[name])
        return self._values[name]

    def _product(self, one: Harmonics, other: Harmonics) -> Harmonics:
        if max((*one.waves, 0)) + max((*other.waves, 0)) > MOST_HARMONIC:
            raise NoClosedForm(Message("a harmonic beyond [[most]]", most=MOST_HARMONIC))
        return one * other

    def _power(self, base: Harmonics, exponent: Expression) -> Harmonics:
        form = linear_form(exponent)
        power = form.constant if form is not None and form.is_constant else None
        if power is None or power.denominator not in (1, 2) or abs(power) > MOST_POWER:
            raise NoClosedForm("a power that is no whole or half number: not compared with expansions")
        if power.denominator == 2 or power < 0:
            if any(k for k in base.waves):
                raise NoClosedForm("division by, or a root of, what changes with the phase: not compared")
            value = base.mean
            if power.denominator == 2:
                value, power = self.tower.square_root(value), power * 2
            base = self._constant(self.tower.reciprocal(value) if power < 0 else value)
        found = self._constant(self.tower.one)
        for _ in range(abs(int(power))):
            found = self._product(found, base)
        return found

    def _wave(self, function: str, argument: Expression) -> Harmonics:
        """sin or cos of k phase + m pi/2."""
        form = linear_form(self._opened(argument))
        times = dict(form.coefficients) if form is not None else {}
        k = times.pop(self.phase, Fraction(0))
        if form is None or times or form.constant or k.denominator != 1 or (2 * form.turns).denominator != 1:
            raise NoClosedForm("an angle that is no multiple of the phase and of pi/2: not compared with expansions")
        if abs(k) > MOST_HARMONIC:
            raise NoClosedForm(Message("a harmonic beyond [[most]]", most=MOST_HARMONIC))
        quarters = int(2 * form.turns) - (function == "sin")  # sin x = cos(x - pi/2)
        c, s = ((1, 0), (0, -1), (-1, 0), (0, 1))[quarters % 4]  # cos(k T + quarters pi/2) = c cos(k T) + s sin(k T)
        n = int(k)
        number = self.tower.number
        if n == 0:
            return self._constant(number(c))
        return Harmonics(self.tower, {abs(n): (number(c), number(s if n > 0 else -s))})

    def _opened(self, expression: Expression) -> Expression:
        """What stands for an angle, in the phase."""
        match expression:
            case Name(name) if name in self.defined:
                return self._opened(self.defined[name])
            case Negative(operand):
                return Negative(self._opened(operand))
            case Operation(operator, left, right):
                return Operation(operator, self._opened(left), self._opened(right))
        return expression
