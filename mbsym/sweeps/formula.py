"""Measure of a formula: any expression in parameters and symbols of the notation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from mbsym.algebra.base import Algebra, Lowering, S
from mbsym.algebra.failures import NoValue
from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.tree import Expression
from mbsym.maps.section import Section
from mbsym.numerics.kernels import llvm
from mbsym.numerics.kernels.interface import Code
from mbsym.sweeps.points import Column

# Polynomials in the axes of a section as a straight-line program.


class Horner:
    """Polynomials over an algebra, factor by factor (fewer operations, less rounding), each once.

    ``inputs`` are the values of the generators of their context.
    """

    def __init__(self, algebra: Algebra[S], inputs: Sequence[S]) -> None:
        self.algebra, self.inputs = algebra, tuple(inputs)
        self._powers: dict[tuple[int, int], Any] = {}
        self._known: dict[tuple[Any, ...], Any] = {}

    def __call__(self, x: Polynomial) -> Any:
        key = tuple((tuple(map(int, exponents)), str(number)) for exponents, number in x.terms())
        if key not in self._known:
            self._known[key] = self._factored(x)
        return self._known[key]

    def _factored(self, x: Polynomial) -> Any:
        algebra = self.algebra
        if x.is_constant():
            return self._expanded(x)
        unit, factors = x.factor()
        product = algebra.number(Fraction(int(unit.p), int(unit.q)))
        for factor, exponent in factors:
            product = algebra.times(product, algebra.power(self._expanded(factor), int(exponent)))
        return product

    def _expanded(self, x: Polynomial) -> Any:
        return self._horner({tuple(map(int, exponents)): number for exponents, number in x.terms()}, 0)

    def _horner(self, terms: Mapping[tuple[int, ...], Any], at: int) -> Any:
        """By Horner's rule in one generator after the other."""
        algebra = self.algebra
        if not terms:
            return algebra.zero
        if at == len(self.inputs):
            (number,) = terms.values()
            return algebra.number(Fraction(int(number.p), int(number.q)))
        by_power: dict[int, dict[tuple[int, ...], Any]] = {}
        for exponents, number in terms.items():
            by_power.setdefault(exponents[at], {})[exponents] = number
        value, above = algebra.zero, 0
        for exponent in sorted(by_power, reverse=True):
            if above:
                value = algebra.times(value, self._power(at, above - exponent))
            value, above = value + self._horner(by_power[exponent], at + 1), exponent
        return algebra.times(value, self._power(at, above)) if above else value

    def _power(self, at: int, exponent: int) -> Any:
        if (at, exponent) not in self._powers:
            self._powers[at, exponent] = self.algebra.power(self.inputs[at], exponent)
        return self._powers[at, exponent]


def written(polynomials: Sequence[Polynomial], names: Sequence[str]) -> tuple[Program, tuple[str, ...], list[Node]]:
    """(program, names of its inputs, the polynomials' nodes)."""
    program = Program()
    value = Horner(program, [program.input(name) for name in names])
    return program, tuple(names), [value(x) for x in polynomials]


class FormulaMeasure:
    """``expression`` in the parameters of a section.  Raises NoValue for a name that has no value there."""

    def __init__(self, section: Section, expression: Expression, text: str) -> None:
        self.columns = (Column("value", f"{text}, in floating point", title=text),)
        program = Program()
        names = tuple(axis.name for axis in section.axes)
        node = Lowering(program, _Values(section, program))(expression)
        self._kernel = llvm.kernels({"value": Code(program, names, (node,))}, wide=True)["value"]

    def at(self, points: Any) -> Mapping[str, Any]:
        return {"value": self._kernel(np.ascontiguousarray(points))[0]}


class _Values(dict[str, Node]):
    """What names stand for, in a program of the axes."""

    def __init__(self, section: Section, program: Program) -> None:
        super().__init__({"pi": program.number(_pi())})
        self.section, self.program = section, program
        self._value = Horner(program, [program.input(axis.name) for axis in section.axes])

    def __missing__(self, name: str) -> Node:
        ring = self.section.images.ring
        if not ring.has("parameter", name):
            raise NoValue(name)
        top, below = self.section.images(ring.context.gen(ring.index("parameter", name)))
        self[name] = self.program.divide(self._value(top), self._value(below))
        return self[name]


def _pi() -> Any:
    from fractions import Fraction

    return Fraction(float(arb.pi().mid()))
