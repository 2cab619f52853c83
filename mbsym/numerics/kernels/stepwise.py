"""One instruction after another in NumPy's numbers: nothing is compiled, and nothing contracted."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from mbsym.algebra.lookup import looked_up
from mbsym.algebra.program import PRODUCT_ROUNDING, SUM_ROUNDING
from mbsym.expressions.table import Tabulated
from mbsym.numerics.kernels.interface import FLOAT32, Code, Kernel


def stepwise(code: Code, scalar: str) -> Kernel:
    """A kernel that takes one instruction after another, with numbers of one type."""
    kind, program = (np.float32 if scalar == FLOAT32 else np.float64), code.program
    binary: dict[str, Any] = {"add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide}
    binary |= {SUM_ROUNDING: _sum_rounding, PRODUCT_ROUNDING: _product_rounding}
    named = {"log": np.log, "atan": np.arctan}
    slots = {name: place for place, name in enumerate(code.inputs)}
    steps: list[tuple[int, Any, tuple[int, ...]]] = []
    given: dict[int, Any] = {}
    entries: list[tuple[int, int]] = []
    for number in program.live(code.outputs):
        operation, operands, payload = program.instructions[number]
        if operation == "constant":
            assert isinstance(payload, Fraction)
            given[number] = kind(float(payload))
        elif operation == "input":
            entries.append((number, slots[str(payload)]))
        else:
            function = binary.get(operation) or named.get(operation) or _function(operation)
            steps.append((number, function, operands))

    def kernel(inputs: Any) -> Any:
        values = dict(given)
        for number, place in entries:
            values[number] = kind(inputs[place])
        for number, function, operands in steps:
            values[number] = function(*(values[k] for k in operands))
        return np.array([values[node.number] for node in code.outputs])

    return kernel


def _function(operation: str) -> Any:
    if isinstance(operation, Tabulated):
        return partial(looked_up, operation.curve)
    return getattr(np, operation)


def _sum_rounding(a: Any, b: Any) -> Any:
    """(a + b) - fl(a + b), Knuth."""
    s = a + b
    part = s - a
    return (a - (s - part)) + (b - part)


def _product_rounding(a: Any, b: Any) -> Any:
    """a b - fl(a b), exactly."""
    p = a * b
    if not np.isfinite(p):
        return p * 0
    return type(p)(Fraction(float(a)) * Fraction(float(b)) - Fraction(float(p)))
