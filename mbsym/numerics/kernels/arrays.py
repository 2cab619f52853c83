"""NumPy source: readable, needs no compiler, and is vectorised over states.

    def f(t, q1, q2, ...):  ->  [outputs]

Arithmetic is that of the arrays handed in: float64, float32 or long double; constants are float64 unless they are
asked for in another type.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from mbsym.algebra.lookup import looked_up
from mbsym.algebra.program import PRODUCT_ROUNDING, SUM_ROUNDING
from mbsym.expressions.table import Tabulated
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import Dialect, Listing, listing
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code, Kernel

# One instruction after another in NumPy's numbers: nothing is compiled, and nothing contracted.


def stepwise(code: Code, scalar: str) -> Kernel:
    """A kernel that takes one instruction after another, with numbers of one type."""
    kind, program = (np.float32 if scalar == FLOAT32 else np.float64), code.program
    binary: dict[str, Any] = {"add": np.add, "subtract": np.subtract, "multiply": np.multiply, "divide": np.divide}
    binary |= {SUM_ROUNDING: _sum_rounding, PRODUCT_ROUNDING: _product_rounding}
    named = {"log": np.log, "atan": np.arctan}
    slots = {name: place for place, name in enumerate(code.inputs)}
    steps: list[tuple[int, Any, tuple[int, ...]]] = []
    constants: dict[int, Any] = {}
    entries: list[tuple[int, int]] = []
    for number in program.live(code.outputs):
        operation, operands, payload = program.instructions[number]
        if operation == "constant":
            assert isinstance(payload, Fraction)
            constants[number] = kind(float(payload))
        elif operation == "input":
            entries.append((number, slots[str(payload)]))
        else:
            function = binary.get(operation) or named.get(operation) or _function(operation)
            steps.append((number, function, operands))

    def kernel(inputs: Any) -> Any:
        values = dict(constants)
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


_NAMES = {"atan": "arctan"}
_TYPES = {"float32": np.float32, "float64": np.float64, "extended": np.longdouble}


def source(code: Code) -> str:
    """The kernel as the text of a Python function ``f`` that uses NumPy as ``np``."""
    names = _names(code)
    dialect = Dialect(
        call=lambda function, argument: f"np.{_NAMES.get(function, function)}({argument})",
        local=lambda count: f"s{count}",
        number=lambda value: repr(float(value)),
    )
    body = listing(code.program, code.outputs, names, dialect, {"np", "f"})
    return _text(code, body, names)


def kernel(code: Code, scalar: str = FLOAT64) -> Kernel:
    """A Kernel in NumPy; every constant is a correctly rounded number of the arithmetic."""
    names, dtype = _names(code), _TYPES[scalar]
    constants: dict[str, Any] = {}

    def constant(value: Fraction) -> str:
        name = f"c[{len(constants)}]"
        head = float(value)
        constants[name] = dtype(head) if dtype is not np.longdouble else _long(value, head)
        return name

    tables: list[Callable[[Any], Any]] = []

    def call(function: str, argument: str) -> str:
        if isinstance(function, Tabulated):
            tables.append(partial(looked_up, function.curve))
            return f"tables[{len(tables) - 1}]({argument})"
        return f"np.{_NAMES.get(function, function)}({argument})"

    dialect = Dialect(call=call, local=lambda count: f"s{count}", number=constant, tables=True)
    text = _text(code, listing(code.program, code.outputs, names, dialect, {"np", "f", "c", "tables"}), names)
    scope: dict[str, Any] = {"np": np, "c": list(constants.values()), "tables": tables}
    exec(compile(text, "<straight-line program>", "exec"), scope)  # our own text, made of numbers and own names only
    run = scope["f"]

    def called(values: Any) -> Any:
        inputs = np.asarray(values, dtype=dtype)
        if inputs.shape[0] != len(code.inputs) or inputs.ndim > 2:
            raise ValueError(f"expected {len(code.inputs)} rows, not an array of shape {inputs.shape}")
        out = np.empty((len(code.outputs), *inputs.shape[1:]), dtype=dtype)
        with np.errstate(all="ignore"):
            for place, row in enumerate(run(*inputs)):
                out[place] = row
        return out

    return called


def _long(value: Fraction, head: float) -> Any:
    return np.longdouble(head) + np.longdouble(float(value - Fraction(head)))


def _names(code: Code) -> Mapping[str, str]:
    """Inputs as Python names, whatever they are called."""
    return injective(code.inputs, lambda name: f"x_{''.join(c if c.isalnum() else '_' for c in name)}")


def _text(code: Code, body: Listing, names: Mapping[str, str]) -> str:
    lines = [f"def f({', '.join(names[name] for name in code.inputs)}):"]
    lines += [f"    {name} = {text}" for name, text in body.assignments]
    lines.append(f"    return [{', '.join(body.results)}]")
    return "\n".join([*lines, ""])
