"""Measure of a formula: any expression in parameters and symbols of the notation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from flint import arb

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoValue
from mbsym.algebra.program import Node, Program
from mbsym.expressions.tree import Expression
from mbsym.maps.section import Section
from mbsym.numerics.kernels import llvm
from mbsym.numerics.kernels.interface import Code
from mbsym.sweeps.points import Column
from mbsym.sweeps.polynomials import Horner


class FormulaMeasure:
    """``expression`` in the parameters of a section.  Raises NoValue for a name that has no value there."""

    def __init__(self, section: Section, expression: Expression, text: str) -> None:
        self.columns = (Column("value", f"{text}, in floating point"),)
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
