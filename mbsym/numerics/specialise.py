"""Programs with numbers put in: what depends on parameters only is computed once, with ``PRECISION`` bits.

A parameter that is zero takes its terms out of the program; equal values make equal nodes.  Constants are kept as
fractions and are rounded, to far more bits than any arithmetic used later, only when they grow too long: so a double
constant of the compiled code is the correctly rounded value of its formula, whatever that formula loses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node, Program
from mbsym.expressions.angles import LinearForm
from mbsym.numerics.scenario import PRECISION, Scenario, rounded


class Specialised(Program):
    """A program some of whose inputs are bound to numbers or to other nodes."""

    def __init__(self) -> None:
        super().__init__()
        self.bound: dict[str, Node] = {}

    def number(self, value: Fraction | int) -> Node:
        value = Fraction(value)
        if max(value.numerator.bit_length(), value.denominator.bit_length()) > 2 * PRECISION:
            with ctx.workprec(PRECISION):
                value = rounded(rationals.ball(value))
        return super().number(value)

    def input(self, name: str) -> Node:
        return self.bound[name] if name in self.bound else super().input(name)

    def sin_cos(self, angle: LinearForm) -> tuple[Node, Node]:
        moving, constant = [], Fraction(0)
        for name, coefficient in angle.coefficients:
            value = self._constant(self.input(name))
            if value is None:
                moving.append((name, coefficient))
            else:
                constant += coefficient * value
        if len(moving) == len(angle.coefficients) or not constant:
            return super().sin_cos(LinearForm(tuple(moving), angle.turns))
        if not moving:
            return self._sin_cos_number(constant, angle.turns)
        total = self.number(constant)
        for name, coefficient in moving:
            total = total + self.number(coefficient) * self.input(name)
        if angle.turns:
            total = total + self.number(self._turned(angle.turns))
        return super().sin_cos_of(total)

    def sin_cos_of(self, argument: Node) -> tuple[Node, Node]:
        value = self._constant(argument)
        return super().sin_cos_of(argument) if value is None else self._sin_cos_number(value, Fraction(0))

    def _sin_cos_number(self, radians: Fraction, turns: Fraction) -> tuple[Node, Node]:
        with ctx.workprec(PRECISION + 64):
            angle = rationals.ball(radians)
            angle += arb.pi() * rationals.ball(turns)
            sine, cosine = angle.sin_cos()
            return self.number(rounded(sine)), self.number(rounded(cosine))

    @staticmethod
    def _turned(turns: Fraction) -> Fraction:
        with ctx.workprec(PRECISION + 64):
            return rounded(arb.pi() * rationals.ball(turns))

    def square_root(self, x: Node) -> Node:
        found = super().square_root(x)
        return found if self._constant(found) is not None else self._folded("sqrt", x, found)

    def function(self, name: str, x: Node) -> Node:
        return self._folded(name, x, super().function(name, x))

    def _folded(self, name: str, x: Node, otherwise: Node) -> Node:
        """The number that a function of a number is."""
        value = self._constant(x)
        if value is None:
            return otherwise
        with ctx.workprec(PRECISION + 64):
            balls = Balls({})
            argument = balls.number(value)
            result = balls.square_root(argument) if name == "sqrt" else balls.function(name, argument)
            if not result.is_finite():
                raise SingularPoint(f"{name} of {float(value):g}")
            return self.number(rounded(result))


def bound(scenario: Scenario) -> Specialised:
    """An empty program in which the names of parameters and prescribed quantities stand for their values."""
    fresh = Specialised()
    values: dict[str, Node] = {name: fresh.number(value) for name, value in scenario.parameters.items()}
    time = fresh.input("t")
    for name, (initial, rate) in scenario.prescribed.items():
        values[name] = fresh.number(initial) + fresh.number(rate) * time
    with ctx.workprec(PRECISION):
        values["pi"] = fresh.number(rounded(arb.pi()))
    fresh.bound = values
    return fresh


def substituted(program: Program, outputs: Sequence[Node], fresh: Program) -> list[Node]:
    """The outputs rebuilt in another program, whose ``input`` says what the names stand for there."""
    inputs: Mapping[str, Node] = Names(fresh)
    return program.evaluate(outputs, inputs, fresh)


class Names(dict[str, Node]):
    """What names stand for in a program, which knows which of them are bound."""

    def __init__(self, program: Program) -> None:
        super().__init__()
        self.program = program

    def __missing__(self, name: str) -> Node:
        return self.program.input(name)
