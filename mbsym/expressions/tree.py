"""Parsed expressions: small immutable trees of exact numbers, names, operations and function calls.

An expression is what a description says, before any algebra: ``l/2`` stays a quotient of a name and a number.
It knows how to print itself back (so that a description survives ``mbsym convert``), which names it holds, and
how to differentiate itself; it knows no mechanics and no polynomials.  ``mbsym.algebra`` gives it values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import TypeVar

from mbsym.expressions.place import Span
from mbsym.expressions.rates import is_velocity
from mbsym.expressions.table import Curve, Table, curve_name

T = TypeVar("T")

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


class _Written:
    """What is written as a description has it, in a sentence, too."""

    __slots__ = ()

    def __str__(self) -> str:
        return text(self)  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class Number(_Written):
    """An exact rational number; ``0.1`` is 1/10."""

    value: Fraction
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name(_Written):
    """A parameter, a coordinate, a velocity ``theta_dot``, ``pi`` or the time ``t``."""

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Negative(_Written):
    """``-operand``."""

    operand: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Operation(_Written):
    """``left operator right`` with operator one of ``+ - * / **``."""

    operator: str
    left: Expression
    right: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Call(_Written):
    """``function(argument, *more)`` with a function of :data:`FUNCTIONS`, or a ``table``'s ``order``-th derivative."""

    function: str
    argument: Expression
    span: Span | None = field(default=None, compare=False, repr=False)
    more: tuple[Expression, ...] = ()
    table: Table | None = None
    order: int = 0


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


def rewritten(expression: Expression, change: Callable[[Expression], Expression | None]) -> Expression:
    """The expression with what ``change`` puts in the place of parts of it, the outermost first; None: it stays."""
    changed = change(expression)
    if changed is not None:
        return changed
    match expression:
        case Negative(operand):
            return negative(rewritten(operand, change))
        case Operation(operator, left, right):
            return Operation(operator, rewritten(left, change), rewritten(right, change))
        case Call(function, argument, more=more, table=table, order=order):
            others = tuple(rewritten(extra, change) for extra in more)
            return Call(function, rewritten(argument, change), more=others, table=table, order=order)
    return expression


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


def reached(needs: Mapping[T, Iterable[T]], start: Iterable[T]) -> set[T]:
    """All that something depends on, directly or through others, and what it starts from."""
    known = set(start)
    pending = list(known)
    while pending:
        new = set(needs.get(pending.pop(), ())) - known
        known |= new
        pending += new
    return known


def curve_of(table: Table, order: int = 0) -> Curve:
    """A derivative of what a table is, jumps at its ends apart."""
    return curve_name(table, order).curve


#: A table with more points is not written out by moduli.
MOST_WRITTEN_OUT = 100


def written_out(table: Table, x: Expression, whole: bool = True) -> Expression:
    """f(x) of a table by moduli, for whoever knows no tables, or has to stay at a knot where a slope jumps:

        f = y_0 + sum_k q_k(u_k),    u_k = (|x - x_k| - |x - x_(k+1)| + x_(k+1) - x_k)/2,    q_k(u) = f(x_k + u) - y_k

    u_k being x - x_k in its piece, 0 before it and the length of the piece behind: no digits are lost far from the
    first point.  Outside u is (x - x_0 - |x - x_0|)/2 or (x - x_n + |x - x_n|)/2; where f is zero there, its ends are
    steps, if the ``whole`` of it is wanted.
    """
    (first, start), (last, end) = table.points[0], table.points[-1]
    half, polynomials = Number(Fraction(1, 2)), table.curve.polynomials
    kinks = [Call("abs", subtract(x, _exact(place))) for place, _ in table.points]
    inside = [multiply(half, subtract(subtract(x, _exact(first)), kinks[0]))]
    for k, ((earlier, _), (later, _)) in enumerate(pairwise(table.points)):
        inside.append(multiply(half, add(subtract(kinks[k], kinks[k + 1]), _exact(later - earlier))))
    inside.append(multiply(half, add(subtract(x, _exact(last)), kinks[-1])))
    total = _exact(start)
    for u, polynomial in zip(inside, polynomials, strict=True):
        grown: Expression = ZERO
        for coefficient in reversed(polynomial[1:]):
            grown = multiply(u, add(_exact(coefficient), grown))
        total = add(total, grown)
    if table.jumps and whole:
        total = subtract(total, multiply(_exact(start), Call("step", subtract(_exact(first), x))))
        total = subtract(total, multiply(_exact(end), Call("step", subtract(x, _exact(last)))))
    return total


def slope_written_out(curve: Curve, x: Expression) -> Expression:
    """A derivative by its pieces, each times a pulse that is 1 on it: at a knot the mean of both."""
    knots = [_exact(knot) for knot in curve.knots]
    pulses = [
        subtract(ONE, Call("step", subtract(x, knots[0]))),
        *(Call("pulse", x, more=pair) for pair in pairwise(knots)),
        Call("step", subtract(x, knots[-1])),
    ]
    total: Expression = ZERO
    for pulse, base, polynomial in zip(pulses, curve.bases, curve.polynomials, strict=True):
        own: Expression = ZERO
        for coefficient in reversed(polynomial):
            own = add(_exact(coefficient), multiply(subtract(x, _exact(base)), own))
        total = add(total, multiply(own, pulse))
    return total


def without_tables(expression: Expression, chosen: Callable[[Call], bool]) -> Expression:
    """The expression with the chosen calls of tables written out."""

    def change(part: Expression) -> Expression | None:
        match part:
            case Call(_, argument, table=Table() as table, order=0) if chosen(part):
                return written_out(table, without_tables(argument, chosen))
        return None

    return rewritten(expression, change)


def sticks(call: Call) -> bool:
    """Whether a table has kinks in velocities: as a dissipation function it is dry friction, which holds there."""
    moving = any(is_velocity(name) for name in names(call.argument))
    return moving and call.table is not None and call.table.curve.smoothness == 0


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
    opposite = _without_minus(right)
    return Operation("+", left, right) if opposite is None else subtract(left, opposite)


def subtract(left: Expression, right: Expression) -> Expression:
    if is_number(right, 0):
        return left
    if is_number(left, 0):
        return negative(right)
    opposite = _without_minus(right)
    return Operation("-", left, right) if opposite is None else add(left, opposite)


def _without_minus(expression: Expression) -> Expression | None:
    """-x of an x that begins with a minus, as -6*a does; None of any other."""
    match expression:
        case Negative(operand):
            return operand
        case Operation("*" | "/" as operator, left, right) if (opposite := _without_minus(left)) is not None:
            return Operation(operator, opposite, right)
    return None


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


def without_jump(product: Expression) -> Expression:
    """sign(u) u**n = |u| u**(n - 1) and sign(u) |u|**n = u |u|**(n - 1) put in: what vanishes with u does not jump.

    So |u|**3 has two derivatives for whoever expands about u = 0.  A product of other factors is given back as it is.
    """
    for u, rest in _signs(product, set()):
        joined = _times_sign(rest, u, set())
        if joined is not None:
            return without_jump(replace(joined, span=product.span))
    return product


def _signs(product: Expression, seen: set[int]) -> Iterator[tuple[Expression, Expression]]:
    """(u, the other factors) for each factor sign(u); what many parents share is ``seen`` once."""
    if id(product) in seen:
        return
    seen.add(id(product))
    match product:
        case Call("sign", u):
            yield u, ONE
        case Negative(operand):
            yield from ((u, negative(rest)) for u, rest in _signs(operand, seen))
        case Operation("*", left, right):
            yield from ((u, multiply(rest, right)) for u, rest in _signs(left, seen))
            yield from ((u, multiply(left, rest)) for u, rest in _signs(right, seen))
        case Operation("/", left, right):
            yield from ((u, divide(rest, right)) for u, rest in _signs(left, seen))


def _times_sign(product: Expression, u: Expression, seen: set[int]) -> Expression | None:
    """sign(u) times a product, continuous; None where no factor is a power of u or |u|."""
    if id(product) in seen:
        return None
    seen.add(id(product))
    if product == u:
        return Call("abs", u, product.span)
    if product == Call("abs", u):
        return u
    match product:
        case Operation("**", base, Number(n)) if n > 1:
            joined = _times_sign(base, u, seen) if base in (u, Call("abs", u)) else None
            return None if joined is None else multiply(joined, power(base, Number(n - 1)))
        case Negative(operand):
            joined = _times_sign(operand, u, seen)
            return None if joined is None else negative(joined)
        case Operation("*", left, right):
            joined = _times_sign(left, u, seen)
            if joined is not None:
                return multiply(joined, right)
            joined = _times_sign(right, u, seen)
            return None if joined is None else multiply(left, joined)
        case Operation("/", left, right):
            joined = _times_sign(left, u, seen)
            return None if joined is None else divide(joined, right)
    return None


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
        self._signs_arise = False

    def __call__(self, expression: Expression) -> Expression:
        derivative = self._known.get(id(expression))
        if derivative is None:
            derivative = self._known[id(expression)] = self._derivative(expression)
        return derivative

    def _joined(self, left: Expression, right: Expression) -> Expression:
        product = multiply(left, right)
        return without_jump(product) if self._signs_arise else product

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
                return add(self._joined(self(left), right), self._joined(left, self(right)))
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
                return self._joined(multiply(exponent, power(base, lowered)), inner)
            case Call(function, argument, table=Table() as table, order=order):
                inner = self(argument)
                if is_number(inner, 0):
                    return ZERO
                if table.jumps or curve_of(table, order).smoothness < 0:
                    raise ValueError(f"{function} has a jump, and no derivative")
                return multiply(Call(function + "'", argument, table=table, order=order + 1), inner)
            case Call(function, argument) if function in JUMPS:
                if all(is_number(self(child), 0) for child in children(expression)):
                    return ZERO
                raise ValueError(f"{function} has a jump, and no derivative")
            case Call(function, argument):
                inner = self(argument)
                self._signs_arise |= function == "abs" and not is_number(inner, 0)
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
    return rewritten(expression, lambda part: replacements.get(part.name) if isinstance(part, Name) else None)


# --- printing back ---------------------------------------------------------------------------------------------------

_PRECEDENCE = {"+": 1, "-": 1, "*": 2, "/": 2, "**": 4}


def sign_by_structure(expression: Expression, signs: Mapping[str, str]) -> str | None:
    """What the signs of its names force: ``positive``, ``negative`` (both strict), or None for not known."""
    match expression:
        case Number(value):
            return "positive" if value > 0 else "negative" if value < 0 else None
        case Name("pi"):
            return "positive"
        case Name(name):
            return signs.get(name) if signs.get(name) in ("positive", "negative") else None
        case Negative(operand):
            return {"positive": "negative", "negative": "positive"}.get(sign_by_structure(operand, signs) or "")
        case Operation("+", left, right):
            return _common(sign_by_structure(left, signs), sign_by_structure(right, signs))
        case Operation("-", left, right):
            return _common(sign_by_structure(left, signs), sign_by_structure(Negative(right), signs))
        case Operation("*" | "/", left, right):
            first, second = sign_by_structure(left, signs), sign_by_structure(right, signs)
            if first is None or second is None:
                return None
            return "positive" if first == second else "negative"
        case Operation("**", base, Number(exponent)):
            inner = sign_by_structure(base, signs)
            if inner == "positive" or (inner == "negative" and exponent.denominator == 1 and exponent.numerator % 2):
                return inner
            return "positive" if inner == "negative" and exponent.denominator == 1 else None
        case Call("exp" | "cosh", _):
            return "positive"
        case Call("sqrt", argument) if sign_by_structure(argument, signs) == "positive":
            return "positive"
    return None


def _common(first: str | None, second: str | None) -> str | None:
    return first if first == second else None


def text(expression: Expression) -> str:
    """The expression in the syntax of descriptions; parsing it again gives an equal tree."""
    return _text(expression, 0)


def _text(expression: Expression, outer: int) -> str:
    match expression:
        case Number(value):
            written, own = decimal_text(value), 5
            if value < 0 or "/" in written:  # a literal is neither: only built trees hold such numbers
                own = 1
        case Name(name):
            written, own = name, 5
        case Call(function):
            written, own = f"{function}({', '.join(_text(child, 0) for child in children(expression))})", 5
        case Negative(operand):
            written, own = "-" + _text(operand, 3), 3
        case Operation("**", base, exponent):
            written, own = f"{_text(base, 5)}**{_text(exponent, 3)}", 4
        case Operation(operator, left, right):
            own = _PRECEDENCE[operator]
            blank = " " if own == 1 else ""
            written = f"{_text(left, own)}{blank}{operator}{blank}{_text(right, own + 1)}"
    return f"({written})" if own < outer else written


def decimal_text(value: Fraction) -> str:
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
