"""Parsed expressions: small immutable trees of exact numbers, names, operations and function calls.

An expression is what a description says, before any algebra: ``l/2`` stays a quotient of a name and a number.
It knows how to print itself back (so that a description survives ``mbsym convert``), which names it holds, and
how to differentiate itself; it knows no mechanics and no polynomials.  ``mbsym.algebra`` gives it values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from mbsym.expressions.place import Span
from mbsym.expressions.table import OUTSIDE_ZERO, Table, pieces

#: Smooth functions of one argument that a description may call, in the spelling of Python's ``math``.
SMOOTH = ("sin", "cos", "tan", "sqrt", "exp", "log", "atan", "sinh", "cosh", "tanh")

#: Functions with a jump, in their value or in their first derivative:
#:
#:     sign(x) = -1, 0, 1   for x < 0, x = 0, x > 0        abs(x) = x sign(x)
#:     step(x) = (1 + sign(x))/2: 1/2 at the jump          pulse(x, a, b) = step(x - a) - step(x - b)
JUMPS = ("sign", "step", "pulse")
KINKED = ("abs", *JUMPS)

#: All that a description may call.
FUNCTIONS = (*SMOOTH, *KINKED)

#: The arguments of a function that has more than one, as messages name them.
SIGNATURES = {"pulse": "pulse(x, start, end)"}

#: ``pi`` is a number, never a parameter.
CONSTANTS = ("pi",)


@dataclass(frozen=True, slots=True)
class Number:
    """An exact rational number; ``0.1`` is 1/10."""

    value: Fraction
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name:
    """A parameter, a coordinate, a velocity ``theta_dot``, ``pi`` or the time ``t``."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Negative:
    """``-operand``."""

    operand: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Operation:
    """``left operator right`` with operator one of ``+ - * / **``."""

    operator: str
    left: Expression
    right: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Call:
    """``function(argument, *more)`` with a function of :data:`FUNCTIONS`, or the name of a ``table``."""

    function: str
    argument: Expression
    span: Span | None = field(default=None, compare=False, repr=False)
    more: tuple[Expression, ...] = ()
    table: Table | None = None


Expression = Number | Name | Negative | Operation | Call

ZERO = Number(Fraction(0))
ONE = Number(Fraction(1))


def number(value: int | Fraction) -> Number:
    return Number(Fraction(value))


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct operands of an expression, left to right."""
    match expression:
        case Negative(operand):
            return (operand,)
        case Operation(_, left, right):
            return (left, right)
        case Call(_, argument, more=more):
            return (argument, *more)
    return ()


def walk(expression: Expression) -> Iterator[Expression]:
    """Every node of the tree, parents first, left to right."""
    pending = [expression]
    while pending:
        node = pending.pop()
        yield node
        pending.extend(reversed(children(node)))


def names(expression: Expression) -> set[str]:
    """The names that occur, ``pi`` excepted."""
    return {node.name for node in walk(expression) if isinstance(node, Name)} - set(CONSTANTS)


def expanded(table: Table, x: Expression) -> Expression:
    """f(x) of a table by the functions that there are: every knot is a kink, where steps end,

        f = y_0 + sum_k q_k(u_k),    u_k = (|x - x_k| - |x - x_(k+1)| + x_(k+1) - x_k)/2,
        q_k(u) = u (a_k + u (b_k + u c_k))

    u_k being x - x_k in its piece, 0 before it and the length of the piece behind: no digits are lost far from the
    first point.  Where f is zero outside, its ends are steps.
    """
    (first, start), (last, end) = table.points[0], table.points[-1]
    half = Number(Fraction(1, 2))
    kinks = [Call("abs", subtract(x, _exact(place))) for place, _ in table.points]
    total = _exact(start)
    for k, ((one, later), polynomial) in enumerate(zip(pairwise(table.points), pieces(table), strict=True)):
        inside = multiply(half, add(subtract(kinks[k], kinks[k + 1]), _exact(later[0] - one[0])))
        a, b, c = map(_exact, polynomial)
        total = add(total, multiply(inside, add(a, multiply(inside, add(b, multiply(inside, c))))))
    if table.outside == OUTSIDE_ZERO:
        total = subtract(total, multiply(_exact(start), Call("step", subtract(_exact(first), x))))
        total = subtract(total, multiply(_exact(end), Call("step", subtract(x, _exact(last)))))
    return total


def _exact(value: Fraction) -> Expression:
    return Number(value) if value >= 0 else Negative(Number(-value))


# --- building, with the few simplifications that keep derivatives readable -----------------------------------------


def is_number(expression: Expression, value: int | None = None) -> bool:
    return isinstance(expression, Number) and (value is None or expression.value == value)


def add(left: Expression, right: Expression) -> Expression:
    if is_number(left, 0):
        return right
    if is_number(right, 0):
        return left
    if isinstance(right, Negative):
        return subtract(left, right.operand)
    return Operation("+", left, right)


def subtract(left: Expression, right: Expression) -> Expression:
    if is_number(right, 0):
        return left
    if is_number(left, 0):
        return negative(right)
    return Operation("-", left, right)


def negative(operand: Expression) -> Expression:
    if is_number(operand, 0):
        return ZERO
    if isinstance(operand, Negative):
        return operand.operand
    return Negative(operand)


def multiply(left: Expression, right: Expression) -> Expression:
    if is_number(left, 0) or is_number(right, 0):
        return ZERO
    if is_number(left, 1):
        return right
    if is_number(right, 1):
        return left
    if isinstance(left, Negative):
        return negative(multiply(left.operand, right))
    if isinstance(right, Negative):
        return negative(multiply(left, right.operand))
    return Operation("*", left, right)


def divide(left: Expression, right: Expression) -> Expression:
    if is_number(left, 0):
        return ZERO
    if is_number(right, 1):
        return left
    return Operation("/", left, right)


def power(base: Expression, exponent: Expression) -> Expression:
    if is_number(exponent, 1):
        return base
    if is_number(exponent, 0):
        return ONE
    return Operation("**", base, exponent)


def differentiate(expression: Expression, name: str) -> Expression:
    """The partial derivative with respect to a name; all other names are constants.  See Derivation."""
    return Derivation({name: ONE})(expression)


class Derivation:
    """The derivation D with D(name) = ``rates[name]``, and 0 for every other name and every number:

        D(u + v) = Du + Dv,  D(u v) = Du v + u Dv,  D(u**n) = n u**(n-1) Du,  D f(u) = f'(u) Du

    Exponents are constants.  A tree shared by many parents is differentiated once, by identity, also from call to call,
    so the trees must outlive it; the result is simplified only by dropping zeros and ones.  d|u| = sign(u) du holds off
    u = 0.  Raises TypeError for what is not an expression, ValueError for a function without a derivative: it jumps.
    """

    def __init__(self, rates: Mapping[str, Expression]) -> None:
        self.rates = rates
        self._known: dict[int, Expression] = {}
        self._kept: list[Expression] = []  # what tables are, for as long as their identities count

    def __call__(self, expression: Expression) -> Expression:
        found = self._known.get(id(expression))
        if found is None:
            found = self._known[id(expression)] = self._derivative(expression)
        return found

    def _derivative(self, expression: Expression) -> Expression:
        match expression:
            case Number():
                return ZERO
            case Name(name):
                return self.rates.get(name, ZERO)
            case Negative(operand):
                return negative(self(operand))
            case Operation("+", left, right):
                return add(self(left), self(right))
            case Operation("-", left, right):
                return subtract(self(left), self(right))
            case Operation("*", left, right):
                return add(multiply(self(left), right), multiply(left, self(right)))
            case Operation("/", left, right):
                second = divide(multiply(left, self(right)), power(right, number(2)))
                return subtract(divide(self(left), right), second)
            case Operation("**", base, exponent):
                inner = self(base)
                if is_number(inner, 0):
                    return ZERO
                lowered: Expression = subtract(exponent, ONE)
                if isinstance(exponent, Number):
                    lowered = Number(exponent.value - 1)
                return multiply(multiply(exponent, power(base, lowered)), inner)
            case Call(_, argument, table=Table() as table):
                self._kept.append(expanded(table, argument))
                return self(self._kept[-1])
            case Call(function, argument) if function in JUMPS:
                if all(is_number(self(one), 0) for one in children(expression)):
                    return ZERO
                raise ValueError(f"{function} has a jump, and no derivative")
            case Call(function, argument):
                inner = self(argument)
                return ZERO if is_number(inner, 0) else multiply(_derivative_of_function(function, argument), inner)
        raise TypeError(f"not an expression: {expression!r}")


def _derivative_of_function(function: str, argument: Expression) -> Expression:
    match function:
        case "sin":
            return Call("cos", argument)
        case "cos":
            return negative(Call("sin", argument))
        case "tan":
            return add(ONE, power(Call("tan", argument), number(2)))
        case "sqrt":
            return divide(ONE, multiply(number(2), Call("sqrt", argument)))
        case "exp":
            return Call("exp", argument)
        case "log":
            return divide(ONE, argument)
        case "atan":
            return divide(ONE, add(ONE, power(argument, number(2))))
        case "sinh":
            return Call("cosh", argument)
        case "cosh":
            return Call("sinh", argument)
        case "tanh":
            return subtract(ONE, power(Call("tanh", argument), number(2)))
        case "abs":
            return Call("sign", argument)
    raise ValueError(f"no derivative is known for {function}")


def substitute(expression: Expression, replacements: Mapping[str, Expression]) -> Expression:
    """The expression with names replaced, all at once."""
    match expression:
        case Name(name):
            return replacements.get(name, expression)
        case Negative(operand):
            return negative(substitute(operand, replacements))
        case Operation(operator, left, right):
            return Operation(operator, substitute(left, replacements), substitute(right, replacements))
        case Call(function, argument, more=more, table=table):
            others = tuple(substitute(one, replacements) for one in more)
            return Call(function, substitute(argument, replacements), more=others, table=table)
    return expression


# --- printing back ---------------------------------------------------------------------------------------------------

_PRECEDENCE = {"+": 1, "-": 1, "*": 2, "/": 2, "**": 4}


def text(expression: Expression) -> str:
    """The expression in the syntax of descriptions; parsing it again gives an equal tree."""
    return _text(expression, 0)


def _text(expression: Expression, outer: int) -> str:
    match expression:
        case Number(value):
            written, own = _decimal(value), 5
            if value < 0 or "/" in written:  # a literal is neither: only built trees hold such numbers
                own = 1
        case Name(name):
            written, own = name, 5
        case Call(function):
            written, own = f"{function}({', '.join(_text(one, 0) for one in children(expression))})", 5
        case Negative(operand):
            written, own = "-" + _text(operand, 3), 3
        case Operation("**", base, exponent):
            written, own = f"{_text(base, 5)}**{_text(exponent, 3)}", 4
        case Operation(operator, left, right):
            own = _PRECEDENCE[operator]
            blank = " " if own == 1 else ""
            written = f"{_text(left, own)}{blank}{operator}{blank}{_text(right, own + 1)}"
    return f"({written})" if own < outer else written


def _decimal(value: Fraction) -> str:
    """A terminating decimal where there is one (literals always have one), else a quotient."""
    denominator = value.denominator
    twos = fives = 0
    while denominator % 2 == 0:
        denominator, twos = denominator // 2, twos + 1
    while denominator % 5 == 0:
        denominator, fives = denominator // 5, fives + 1
    if denominator != 1:
        return str(value)
    places = max(twos, fives)
    if places == 0:
        return str(value.numerator)
    digits = str(abs(value.numerator) * 10**places // value.denominator).rjust(places + 1, "0")
    return ("-" if value < 0 else "") + digits[:-places] + "." + digits[-places:]
