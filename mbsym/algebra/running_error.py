"""Every value of a program with a bound of what rounding did to it: pairs (value, error), computed side by side.

With u = 2^-53 and |a - a*| <= e_a for the exact a* of the floating-point a::

    a + b    v = fl(a + b)     e = e_a + e_b + u |v|
    a b      v = fl(a b)       e = |a| e_b + |b| e_a + e_a e_b + u |v|
    1/b      v = fl(1/b)       e = e_b / (|b| (|b| - e_b)) + u |v|
    sqrt a   v = fl(sqrt a)    e = e_a / sqrt(a - e_a) + u |v|
    sin, cos                   e = e_a + 4 u

(Wilkinson's running error analysis; Higham, Accuracy and Stability of Numerical Algorithms, 3.3.)  Where a divisor or a
radicand is not known to differ from 0 the bound is not a number, and everything that is made of it: nothing is claimed.
The bounds themselves are rounded, which ``SLACK`` covers; ``certain`` is what may be read off a pair.

Inputs are taken as exact: the numbers that are judged are the floating-point ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import NoClosedForm, SingularPoint
from mbsym.algebra.program import Node, Program
from mbsym.expressions.angles import LinearForm

#: The unit roundoff of float64, and what the rounding of the bounds is covered by.
UNIT, SLACK = Fraction(1, 2**53), 1 + 1e-6
#: Below this, products lose digits (they are subnormal), and signs are not read off.
SMALLEST = 1e-280


@dataclass(frozen=True)
class Approximate:
    """A value and a bound of its error, nodes of one program; an error of None is 0."""

    program: Program
    value: Node
    error: Node | None = None

    def __add__(self, other: Approximate) -> Approximate:
        program = self.program
        if program.vanishes(self.value) and self.error is None:
            return other
        if program.vanishes(other.value) and other.error is None:
            return self
        return _rounded(program, program.plus(self.value, other.value), _sum(program, self.error, other.error))

    def __sub__(self, other: Approximate) -> Approximate:
        return self + (-other)

    def __neg__(self) -> Approximate:
        return Approximate(self.program, self.program.minus(self.value), self.error)


def _sum(program: Program, a: Node | None, b: Node | None) -> Node | None:
    return b if a is None else a if b is None else program.plus(a, b)


def _rounded(program: Program, value: Node, error: Node | None) -> Approximate:
    """A computed value: its own rounding is added to what it inherited."""
    own = program.product(program.number(UNIT), program.function("abs", value))
    return Approximate(program, value, _sum(program, error, own))


class RunningErrors(Algebra[Approximate]):
    """``program`` is the one in which values and bounds are written; names stand for exact floating-point inputs."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.zero, self.one = self.number(0), self.number(1)

    def input(self, name: str) -> Approximate:
        """A number that is given."""
        return Approximate(self.program, self.program.input(name))

    def number(self, value: Fraction | int) -> Approximate:
        exact = Fraction(value)
        node = self.program.number(exact)
        try:
            lost = exact != Fraction(float(exact))
        except OverflowError:
            raise NoClosedForm("a number beyond the range of floating point") from None
        return Approximate(self.program, node, self.program.number(abs(exact) * UNIT) if lost else None)

    def irrational(self, value: float) -> Approximate:
        """A number of which the nearest float is known."""
        exact = Fraction(value)
        return Approximate(self.program, self.program.number(exact), self.program.number(2 * abs(exact) * UNIT))

    def vanishes(self, x: Approximate) -> bool:
        return x.error is None and self.program.vanishes(x.value)

    def times(self, a: Approximate, b: Approximate) -> Approximate:
        program = self.program
        if self.vanishes(a) or self.vanishes(b):
            return self.zero
        for approximate, other in ((a, b), (b, a)):
            if approximate.error is None and approximate.value == program.one:
                return other
            if approximate.error is None and approximate.value == program.minus(program.one):
                return -other
        error = None
        for approximate, other in ((a, b), (b, a)):
            if other.error is not None:
                size = program.function("abs", approximate.value)
                error = _sum(program, error, program.product(size, other.error))
        if a.error is not None and b.error is not None:
            error = _sum(program, error, program.product(a.error, b.error))
        return _rounded(program, program.product(a.value, b.value), error)

    def reciprocal(self, x: Approximate) -> Approximate:
        program = self.program
        if self.vanishes(x):
            raise SingularPoint("division by zero")
        error = None
        if x.error is not None:
            size = program.function("abs", x.value)
            room = program.difference(size, x.error)  # its root is no number where x may be 0
            safe = program.product(program.square_root(room), program.square_root(room))
            error = program.divide(x.error, program.product(size, safe))
        return _rounded(program, program.divide(program.one, x.value), error)

    def square_root(self, x: Approximate) -> Approximate:
        program = self.program
        error = None
        if x.error is not None:
            error = program.divide(x.error, program.square_root(program.difference(x.value, x.error)))
        return _rounded(program, program.square_root(x.value), error)

    def sin_cos(self, angle: LinearForm) -> tuple[Approximate, Approximate]:
        total = self.zero
        for name, coefficient in angle.coefficients:
            total = total + self.times(self.number(coefficient), self.input(name))
        if angle.turns:
            raise NoClosedForm("an angle with pi")
        return self.sin_cos_of(total)

    def sin_cos_of(self, argument: Approximate) -> tuple[Approximate, Approximate]:
        program = self.program
        error = _sum(program, argument.error, program.number(4 * UNIT))
        sine, cosine = program.sin_cos_of(argument.value)
        return Approximate(program, sine, error), Approximate(program, cosine, error)

    def function(self, name: str, x: Approximate) -> Approximate:
        raise NoClosedForm("[[name]] has no bound of its rounding here", name=name)


def outputs(approximations: Mapping[str, Approximate]) -> dict[str, tuple[Node, Node]]:
    """(value, error) of every name, as nodes."""
    return {name: (x.value, x.program.zero if x.error is None else x.error) for name, x in approximations.items()}


def certain_sign(value: Any, error: Any) -> Any:
    """-1, 0 or 1 where the sign of the exact number is known, 2 where it is not: arrays of one shape.

    An exact 0 (value 0, error 0) is known.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        size = np.abs(value)
        known = (size > error * SLACK) & (size > SMALLEST) & np.isfinite(value)
        exact_zero = (value == 0) & (error == 0)
        return np.where(known, np.sign(value), np.where(exact_zero, 0, 2)).astype(np.int8)
