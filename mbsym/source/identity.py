"""Is an expression identically zero?  Decided without a computer algebra system, so that reading stays light.

The expression is evaluated at random points of a large prime field.  Names become random elements; sin and cos of
angles become elements with sin^2 + cos^2 = 1 through sin = 2u/(1 + u^2), cos = (1 - u^2)/(1 + u^2), with multiple
angles by the addition theorem, so every identity between rational functions of names, sines and cosines holds exactly.
A nonzero value is a proof of difference; an identity that holds by accident has a probability of about 1e-30.

What is not such a function (``sqrt(x)``, ``sin(1)``, ``sin(x*y)``) is evaluated in floating point instead.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import KINKED, Call, Expression, Name, Negative, Number, Operation, names, walk

_PRIME = 2**127 - 1
_POINTS = 2
_MAX_MULTIPLE = 1_000
_TOLERANCE = 1e-9


class _NotRational(Exception):
    """Internal: this expression has no value in the prime field."""


def vanishes(expression: Expression, replaced: Mapping[str, Expression] | None = None) -> bool | None:
    """Whether an expression is zero at every point, or None where it cannot be evaluated.

    None, too, where it holds roots and is zero for some signs and orders of names alone, as sqrt((a - b)**2) - b + a.
    ``replaced`` gives the names that are functions of other names (relations between parameters, without circles).
    """
    replaced = _needed(expression, replaced or {})
    try:
        scales = _denominators([expression, *replaced.values()])
        return all(_FieldPoint(seed, scales, replaced).value(expression) == 0 for seed in range(_POINTS))
    except (_NotRational, RecursionError):
        return _vanishes_in_floats(expression, replaced)


def independent(rows: Sequence[Sequence[Expression]]) -> list[int]:
    """The columns, from the left, that make a matrix as regular as it is; as many as its rank at a random point.

    Full rank is proved; a deficient one may be by accident, as ``vanishes`` says, or by rounding where the entries are
    no rational functions of names, sines and cosines.
    """
    entries = [x for row in rows for x in row]
    try:
        point = _FieldPoint(0, _denominators(entries), {})
        return _pivots([[point.value(x) for x in row] for row in rows], _inverse, lambda x: x % _PRIME, 0)
    except (_NotRational, RecursionError):
        floats = _FloatPoint(0, {})
        return _pivots([[floats.value(x) for x in row] for row in rows], lambda x: 1 / x, lambda x: x, _TOLERANCE)


def _pivots(
    rows: list[list[Any]], inverse: Callable[[Any], Any], normal: Callable[[Any], Any], small: float
) -> list[int]:
    pivots: list[int] = []
    for column in range(len(rows[0]) if rows else 0):
        k = len(pivots)
        best = max(range(k, len(rows)), key=lambda i: abs(rows[i][column]), default=None)
        if best is None or abs(rows[best][column]) <= small:
            continue
        rows[k], rows[best] = rows[best], rows[k]
        factor = inverse(rows[k][column])
        for i in range(k + 1, len(rows)):
            share = normal(rows[i][column] * factor)
            rows[i] = [normal(x - share * y) for x, y in zip(rows[i], rows[k], strict=True)]
        pivots.append(column)
    return pivots


def _needed(expression: Expression, replaced: Mapping[str, Expression]) -> dict[str, Expression]:
    """The replacements that matter for an expression, each after those that it uses itself."""
    ordered: dict[str, Expression] = {}
    opened: set[str] = set()
    pending = sorted(names(expression) & replaced.keys())
    while pending:
        name = pending[-1]
        before = names(replaced[name]) & replaced.keys() - ordered.keys() - opened
        opened.add(name)
        if before:
            pending += sorted(before)
        else:
            ordered[pending.pop()] = replaced[name]
    return ordered


def _denominators(expressions: Iterable[Expression]) -> dict[str, int]:
    """For each name the common denominator of its coefficients inside sines and cosines."""
    scales: dict[str, int] = {}
    for expression in expressions:
        for node in walk(expression):
            form = linear_form(node.argument) if isinstance(node, Call) else None
            for name, coefficient in form.coefficients if form else ():
                scales[name] = math.lcm(scales.get(name, 1), coefficient.denominator)
    return scales


def _inverse(value: int) -> int:
    if value % _PRIME == 0:
        raise _NotRational
    return pow(value, -1, _PRIME)


def _sum_of_angles(a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
    """sin and cos of a sum, from those of its parts."""
    return (a[0] * b[1] + a[1] * b[0]) % _PRIME, (a[1] * b[1] - a[0] * b[0]) % _PRIME


class _FieldPoint:
    """One random point: a value and a half-angle tangent for every name."""

    def __init__(self, seed: int, scales: Mapping[str, int], replaced: Mapping[str, Expression]) -> None:
        self.seed = seed
        self.scales = scales
        self.replaced = replaced
        self.known: dict[str, int] = {}
        for name, value in replaced.items():
            self.known[name] = self.value(value)

    def random(self, what: str) -> int:
        return random.Random(f"{self.seed} {what}").randrange(1, _PRIME)

    def value(self, expression: Expression) -> int:
        match expression:
            case Number(number):
                return self.fraction(number)
            case Name(name):
                return self.name(name)
            case Negative(operand):
                return -self.value(operand) % _PRIME
            case Operation("**", base, Number(exponent)):
                return self.power(self.value(base), exponent)
            case Operation("+", left, right):
                return (self.value(left) + self.value(right)) % _PRIME
            case Operation("-", left, right):
                return (self.value(left) - self.value(right)) % _PRIME
            case Operation("*", left, right):
                return self.value(left) * self.value(right) % _PRIME
            case Operation("/", left, right):
                return self.value(left) * _inverse(self.value(right)) % _PRIME
            case Call("sin" | "cos" | "tan" as function, argument):
                return self.circular(function, argument)
        raise _NotRational

    def fraction(self, number: Fraction) -> int:
        return number.numerator * _inverse(number.denominator) % _PRIME

    def name(self, name: str) -> int:
        if name not in self.known:
            self.known[name] = self.random("value " + name)
        return self.known[name]

    def power(self, base: int, exponent: Fraction) -> int:
        if exponent.denominator != 1:
            raise _NotRational
        if exponent < 0:
            base = _inverse(base)
        return pow(base, abs(exponent.numerator), _PRIME)

    def circular(self, function: str, argument: Expression) -> int:
        form = linear_form(argument)
        if form is None or form.constant or any(name in self.replaced for name, _ in form.coefficients):
            raise _NotRational
        sine, cosine = self.sine_and_cosine(form)
        if function == "tan":
            return sine * _inverse(cosine) % _PRIME
        return sine if function == "sin" else cosine

    def sine_and_cosine(self, form: LinearForm) -> tuple[int, int]:
        quarters = form.turns * 2
        if quarters.denominator != 1:
            raise _NotRational
        sine, cosine = ((0, 1), (1, 0), (0, -1), (-1, 0))[quarters.numerator % 4]
        for name, coefficient in form.coefficients:
            sine, cosine = _sum_of_angles((sine, cosine), self.multiple(name, coefficient))
        return sine % _PRIME, cosine % _PRIME

    def multiple(self, name: str, coefficient: Fraction) -> tuple[int, int]:
        """sin and cos of coefficient * name, from those of name / scale."""
        scale = self.scales.get(name, 1)
        count = abs(coefficient.numerator) * (scale // coefficient.denominator)
        if count > _MAX_MULTIPLE:
            raise _NotRational
        half = self.random("angle " + name)
        inverse = _inverse(1 + half * half)
        one = 2 * half * inverse % _PRIME, (1 - half * half) * inverse % _PRIME
        sine, cosine = 0, 1
        for _ in range(count):
            sine, cosine = _sum_of_angles((sine, cosine), one)
        return (sine if coefficient > 0 else -sine % _PRIME), cosine


def in_floats(expression: Expression, values: Mapping[str, Expression]) -> float | None:
    """About what an expression is worth; None where a name has no value, or the expression has none."""
    if not names(expression) <= values.keys() | {"pi"}:
        return None
    try:
        value = _FloatPoint(0, values).value(expression)
    except (ArithmeticError, ValueError, TypeError, RecursionError):
        return None
    return value if math.isfinite(value) else None


def _vanishes_in_floats(expression: Expression, replaced: Mapping[str, Expression]) -> bool | None:
    verdicts = _verdicts_in_floats(expression, replaced, range(4))
    if not verdicts or all(verdicts):
        return True if verdicts else None
    return None if any((*verdicts, *_verdicts_in_floats(expression, replaced, range(4, 16)))) else False


def _verdicts_in_floats(expression: Expression, replaced: Mapping[str, Expression], seeds: Iterable[int]) -> list[bool]:
    """Whether it is zero, at the points of these seeds at which it has a value."""
    verdicts = []
    for seed in seeds:
        try:
            point = _FloatPoint(seed, replaced)
            value, size = point.value(expression), point.largest
        except (ArithmeticError, ValueError, TypeError, RecursionError):
            continue
        if math.isfinite(value) and math.isfinite(size):
            verdicts.append(abs(value) <= _TOLERANCE * size)
    return verdicts


class _FloatPoint:
    """One random point of ordinary numbers; remembers the largest number met, the measure of rounding.

    Names are positive at the points of seeds 0 to 3, of any sign at others.
    """

    def __init__(self, seed: int, replaced: Mapping[str, Expression]) -> None:
        self.seed = seed
        self.largest = 1.0
        self.known: dict[str, float] = {}
        for name, value in replaced.items():
            self.known[name] = self.value(value)

    def value(self, expression: Expression) -> float:
        value = self.evaluated(expression)
        if isinstance(value, complex):
            raise ValueError
        self.largest = max(self.largest, abs(value))
        return value

    def evaluated(self, expression: Expression) -> float:
        match expression:
            case Number(number):
                return float(number)
            case Name("pi"):
                return math.pi
            case Name(name):
                return self.name(name)
            case Negative(operand):
                return -self.value(operand)
            case Operation("**", base, exponent):
                return float(self.value(base) ** self.value(exponent))
            case Operation("+", left, right):
                return self.value(left) + self.value(right)
            case Operation("-", left, right):
                return self.value(left) - self.value(right)
            case Operation("*", left, right):
                return self.value(left) * self.value(right)
            case Operation("/", left, right):
                return self.value(left) / self.value(right)
            # |x| - x vanishes at some points only.
            case Call(function, argument, table=None) if function not in KINKED:
                return float(getattr(math, function)(self.value(argument)))
        raise ValueError

    def name(self, name: str) -> float:
        if name not in self.known:
            source = random.Random(f"{self.seed} {name}")
            size = source.uniform(0.4, 1.4)
            self.known[name] = size if self.seed < 4 or source.random() < 0.5 else -size
        return self.known[name]
