"""Which parts of an expression are numbers, and whether these numbers are there: real, finite, within range.

A part without names is rational (``Fraction``, exact), or a ball around what it is worth, of some hundred bits first.
Where such a ball holds zero and it matters (a divisor, what stands under a root or a logarithm), it is computed in
thousands of bits; what is zero to so many counts as zero: no description means 1e-1200.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, children, walk

#: Bits of balls: at first, and where zero has to be told from not zero.
_BITS = (192, 4096)

#: Fractions longer than this become balls.
_LONGEST = 4096

#: Beyond 2**MOST_BITS, and closer to zero than its reciprocal, double precision ends.
MOST_BITS = 1000

_OPERATORS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}

#: Values of names: numbers, or what ``Constants`` made of such.
Known = Mapping[str, Any]


class _NoValue(Exception):
    """Internal: a node has no real finite value."""

    def __init__(self, node: Expression, message: str) -> None:
        super().__init__(message)
        self.node, self.message = node, message


class _Vague(Exception):
    """Internal: more bits are needed."""


class _TakesBalls(Exception):
    """Internal: fractions do not do."""


class _Unknown(Exception):
    """Internal: not even thousands of bits tell what this is (the sine of 1e9565)."""


def meaningless(tree: Expression, known: Known | None = None) -> tuple[Expression, str] | None:
    """The first part of a tree that has no real finite value, whatever its names are worth, and why; None: there is no
    such.  ``known`` are names that have values (``value``)."""
    if isinstance(tree, Number | Name):
        return None
    try:
        _computed(tree, known or {})
    except _NoValue as reason:
        return reason.node, reason.message
    return None


def out_of_range(tree: Expression) -> str:
    """Why no double holds the number that a tree is; "" where one does, or the tree has names or no value."""
    number = value(tree)
    if number is None:
        return ""
    if isinstance(number, Fraction):
        size = number.numerator.bit_length() - number.denominator.bit_length() if number else 0
    else:
        number = abs(number)
        size = 0 if number.contains(0) else 2 * MOST_BITS if number > _power_of_two(MOST_BITS) else 0
        if not number.contains(0) and number < _power_of_two(-MOST_BITS):
            size = -2 * MOST_BITS
    if size > MOST_BITS:
        return "it is beyond the range of double precision"
    return "it is too close to zero for double precision" if size < -MOST_BITS else ""


def value(tree: Expression, known: Known | None = None) -> Any:
    """The number that a tree is, a Fraction or a ball; None where it has other names, or no value."""
    try:
        return _computed(tree, known or {})
    except _NoValue:
        return None


def sign_of(tree: Expression) -> int | None:
    """-1, 0 or 1; None where the tree has names, or no value."""
    for bits in _BITS:
        constants = _Constants({}, bits, bits == _BITS[-1])
        with suppress(_Vague):
            try:
                number = constants.computed(tree)
                return None if number is None else constants.sign(number)
            except (_NoValue, _Unknown):
                return None
    return None


def unsupported_power(tree: Expression) -> Fraction | None:
    """The exponent of a number's power that is neither whole nor half, in a tree without names."""
    exponents = (
        node.right.value
        for node in walk(tree)
        if isinstance(node, Operation) and node.operator == "**" and isinstance(node.right, Number)
    )
    odd = next((x for x in exponents if x.denominator > 2), None)
    return odd if odd is not None and value(tree) is not None else None


def _computed(tree: Expression, known: Known) -> Any:
    for bits in _BITS:
        try:
            return _Constants(known, bits, bits == _BITS[-1]).computed(tree)
        except _Vague:
            continue
    raise AssertionError("the last of them is never vague")


def _power_of_two(exponent: int) -> Any:
    from flint import arb

    return arb(2) ** exponent


@dataclass(frozen=True)
class _Constants:
    """Values of the parts of one tree, at so many ``bits``; ``last``: zero is what cannot be told from it.

    ``exact``: there are fractions only; what takes balls raises _TakesBalls.
    """

    known: Known
    bits: int
    last: bool
    exact: bool = False

    def computed(self, tree: Expression) -> Any:
        """In fractions as long as they do: only then is the library of balls loaded."""
        try:
            return replace(self, exact=True)._all(tree)
        except _TakesBalls:
            from flint import ctx

            with ctx.workprec(self.bits):
                return self._all(tree)

    def _all(self, tree: Expression) -> Any:
        """The value of a tree, from the leaves upwards: trees may be deep."""
        values: dict[int, Any] = {}
        for node in _below(tree):
            parts = [values[id(child)] for child in children(node)]
            try:
                values[id(node)] = self._value(node, parts)
            except _Unknown:
                values[id(node)] = None
        return values[id(tree)]

    def _value(self, node: Expression, parts: list[Any]) -> Any:
        match node:
            case Number(number):
                return number
            case Name("pi"):
                if self.exact:
                    raise _TakesBalls
                from flint import arb

                return arb.pi()
            case Name(name):
                known = self.known.get(name)
                return known if known is None or isinstance(known, Fraction) else self._ball(known)
            case Negative():
                return None if parts[0] is None else -parts[0]
            case Operation(sign):
                return self._operation(node, sign, *parts)
            case Call(function, table=None):
                return None if any(x is None for x in parts) else self._call(node, function, parts)
        return None

    def _operation(self, node: Expression, sign: str, left: Any, right: Any) -> Any:
        if sign == "/" and right is not None and self._is_zero(right):
            raise _NoValue(node, "division by zero")
        if left is None or right is None:
            return None
        if sign == "**":
            return self._power(node, left, right)
        if not (isinstance(left, Fraction) and isinstance(right, Fraction)):
            left, right = self._ball(left), self._ball(right)
        return self._finite(node, _OPERATORS[sign](left, right))

    def _power(self, node: Expression, base: Any, exponent: Any) -> Any:
        if not isinstance(exponent, Fraction):
            return None
        if exponent.denominator == 1 and isinstance(base, Fraction):
            length = max(base.numerator.bit_length(), base.denominator.bit_length())
            if length * abs(exponent) <= _LONGEST and (base or exponent > 0):
                return base**exponent.numerator
        if exponent <= 0 and self._is_zero(base):
            raise _NoValue(node, "zero has no such power")
        if exponent.denominator == 1:
            return self._finite(node, self._ball(base) ** int(exponent))
        if self.sign(base) < 0:
            raise _NoValue(node, "a negative number has no such power")
        if self.sign(base) == 0:
            return Fraction(0)
        return self._finite(node, self._ball(base) ** self._ball(exponent))

    def _call(self, node: Expression, function: str, parts: list[Any]) -> Any:
        x = parts[0]
        if function == "sqrt":
            sign = self.sign(x)
            if sign < 0:
                raise _NoValue(node, "a negative number has no square root")
            return self._finite(node, self._ball(x).sqrt()) if sign else Fraction(0)
        if function == "log":
            sign = self.sign(x)
            if sign <= 0:
                raise _NoValue(node, f"{'a negative number' if sign else 'zero'} has no logarithm")
            return self._finite(node, self._ball(x).log())
        if function == "tan":
            cosine = self._ball(x).cos()
            if self._is_zero(cosine):
                raise _NoValue(node, "tan has a pole here")
            return self._finite(node, self._ball(x).sin() / cosine)
        if function == "sign":
            return Fraction(self.sign(x))
        if function == "step":
            return Fraction(1 + self.sign(x), 2)
        if function == "pulse":  # step(x - start) - step(x - end)
            start, end = (self.sign(self._ball(x) - self._ball(edge)) for edge in parts[1:])
            return Fraction(start - end, 2)
        if function == "abs":
            return abs(x)
        return self._finite(node, getattr(self._ball(x), function)())

    def _finite(self, node: Expression, number: Any) -> Any:
        if isinstance(number, Fraction):
            if max(number.numerator.bit_length(), number.denominator.bit_length()) > _LONGEST:
                return self._ball(number)
            return number
        if number.is_finite():
            return number
        if not self.last:
            raise _Vague
        raise _NoValue(node, "it is infinite, or far beyond the range of any arithmetic")

    def _is_zero(self, x: Any) -> bool:
        return self.sign(x) == 0

    def sign(self, x: Any) -> int:
        if isinstance(x, Fraction):
            return (x > 0) - (x < 0)
        if not x.contains(0):
            return 1 if x > 0 else -1
        if not self.last:
            raise _Vague
        if x.rad() > _power_of_two(-self.bits // 2):
            raise _Unknown
        return 0

    def _ball(self, x: Any) -> Any:
        if self.exact:
            raise _TakesBalls
        from flint import arb, fmpq

        return arb(fmpq(x.numerator, x.denominator)) if isinstance(x, Fraction) else x


def _below(tree: Expression) -> Iterator[Expression]:
    """Every node, children before parents."""
    order, pending = [], [tree]
    while pending:
        node = pending.pop()
        order.append(node)
        pending.extend(children(node))
    return reversed(order)
