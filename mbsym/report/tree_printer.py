"""What stands in a description as it stands there, in the notation of a medium: signs, brackets and numbers alike."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Generic, TypeVar

from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, children
from mbsym.model.speeds import OMEGA

Symbols = TypeVar("Symbols")

#: What ``expressions.rates`` puts behind the name of a velocity and an acceleration.
DOTS = ("dot", "ddot")

#: How functions are called in print.
CALLED = {"atan": "arctan", "log": "ln"}


class TreePrinter(ABC, Generic[Symbols]):
    """Writes expressions in the ``names`` of a system; ``spins`` are other names, which come first.

    A number that ends in few digits is a decimal, any other a fraction.
    """

    minus: str
    times: str
    pi: str

    def __init__(self, names: Symbols, spins: Mapping[str, str] | None = None) -> None:
        self.names, self.spins = names, spins or {}

    @classmethod
    def of_body(cls, names: Symbols, number: int) -> TreePrinter[Symbols]:
        """With the components of the angular velocity of a body: (omega_2)_1."""
        return cls(names, {name: cls.spin(number, k) for k, name in enumerate(OMEGA, start=1)})

    def __call__(self, value: Expression) -> str:
        return self._written(value)[0]

    @staticmethod
    @abstractmethod
    def spin(number: int, k: int) -> str:
        """(omega_number)_k."""

    @abstractmethod
    def symbol(self, name: str, dots: str) -> str:
        """A name, with dots above it or "" for none."""

    @abstractmethod
    def decimal(self, text: str) -> str: ...

    @abstractmethod
    def quotient(self, value: Fraction) -> str: ...

    @abstractmethod
    def fraction(self, top: str, bottom: str) -> str: ...

    @abstractmethod
    def power(self, base: str, exponent: str) -> str: ...

    @abstractmethod
    def sum(self, left: str, operator: str, right: str) -> str: ...

    @abstractmethod
    def bracketed(self, text: str) -> str: ...

    @abstractmethod
    def call(self, value: Call, arguments: Sequence[str]) -> str: ...

    def _written(self, value: Expression) -> tuple[str, int]:
        """(text, precedence): 1 sum, 2 product, 3 power, 4 atom."""
        match value:
            case Number(number):
                decimal = _decimal(number)
                return self.quotient(number) if decimal is None else self.decimal(decimal), 4 if number >= 0 else 1
            case Name("pi"):
                return self.pi, 4
            case Name(name):
                base, _, dots = name.rpartition("_")
                if dots in DOTS and base:
                    return self.symbol(base, dots), 4
                return self.spins.get(name) or self.symbol(name, ""), 4
            case Negative(operand):
                return self.minus + self._within(operand, 2), 1
            case Call():
                return self.call(value, list(map(self, children(value)))), 4
            case Operation("/", left, right):
                return self.fraction(self(left), self(right)), 4
            case Operation("**", base, exponent):
                # Of a fraction the exponent would seem to belong to the denominator.
                return self.power(self._within(base, 5 if _is_fraction(base) else 4), self(exponent)), 3
            case Operation("*", Negative(left), right):
                return self._written(Negative(Operation("*", left, right)))
            case Operation("*", Number(left), Number(right)):  # side by side they would be read as one
                return self._written(Number(left * right))
            case Operation("*", left, right):
                return self._within(left, 2) + self.times + self._within(right, 2), 2
            case Operation(operator, left, right):
                return self.sum(self._within(left, 1), operator, self._within(right, 2 if operator == "-" else 1)), 1
        raise TypeError(f"not an expression: {value!r}")

    def _within(self, value: Expression, minimum: int) -> str:
        text, precedence = self._written(value)
        return text if precedence >= minimum else self.bracketed(text)


def _is_fraction(value: Expression) -> bool:
    match value:
        case Operation("/"):
            return True
        case Number(number):
            return _decimal(number) is None
    return False


def _decimal(value: Fraction) -> str | None:
    """Its digits where these are few and all; None where it is a fraction."""
    if value.denominator == 1:
        return str(value.numerator)
    shown = repr(float(value))
    return shown if "e" not in shown and Fraction(shown) == value else None
