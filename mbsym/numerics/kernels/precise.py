"""Any precision: the program as a Python function over ``arb`` numbers, for reference solutions.

Some three times quicker than walking through the instructions; radii are kept, whoever does not want them takes
midpoints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.point import Balls
from mbsym.numerics.kernels.interface import Code

# Rigorous enclosures: the same program over ``arb`` balls.


def enclosures(code: Code, values: Sequence[Any], bits: int = 128) -> list[arb]:
    """Balls that contain the outputs at exactly the given values (floats, fractions or balls), one number each."""
    with ctx.workprec(bits):
        inputs = {name: _ball(value) for name, value in zip(code.inputs, values, strict=True)}
        return code.program.evaluate(code.outputs, inputs, Balls(inputs))


def _ball(value: Any) -> arb:
    if isinstance(value, arb):
        return value
    numerator, denominator = value.as_integer_ratio()
    return arb(fmpq(int(numerator), int(denominator)))


_SIGNS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/"}


def precise(code: Code, bits: int) -> Callable[[Sequence[arb]], list[arb]]:
    """The code as a function of ``arb`` numbers; call it at a working precision of ``bits``."""
    balls = Balls({})
    own = ("sin", "cos", "sqrt", "exp", "log")
    return written(code, bits, lambda name: getattr(arb, name) if name in own else partial(balls.function, name))


def written(
    code: Code, bits: int, meaning: Callable[[str], Callable[[Any], Any]]
) -> Callable[[Sequence[Any]], list[Any]]:
    """The code as a function of whatever has arithmetic with ``arb``; ``meaning`` gives each function by its name."""
    program = code.program
    scope: dict[str, Any] = {}
    slots = {name: place for place, name in enumerate(code.inputs)}
    lines = ["def f(x):"]
    values: dict[int, str] = {}
    with ctx.workprec(bits):
        for number in program.live(code.outputs):
            instruction = program.instructions[number]
            operands = [values[operand] for operand in instruction.operands]
            local = values[number] = f"v{number}"
            match instruction.operation, operands:
                case "constant", _:
                    assert isinstance(instruction.payload, Fraction)
                    scope[local] = rationals.ball(instruction.payload)
                    continue
                case "input", _:
                    text = f"x[{slots[str(instruction.payload)]}]"
                case "negative", [a]:
                    text = f"-{a}"
                case operation, [a, b]:
                    text = f"{a} {_SIGNS[operation]} {b}"
                case function, [a]:
                    called = scope.setdefault("names", {}).setdefault(function, f"call_{len(scope['names'])}")
                    scope[called] = meaning(function)
                    text = f"{called}({a})"
            lines.append(f"    {local} = {text}")
    lines.append("    return [" + ", ".join(values[node.number] for node in code.outputs) + "]")
    exec(compile("\n".join(lines), "<straight-line program>", "exec"), scope)  # our own text, made of numbers only
    compiled: Callable[[Sequence[Any]], list[Any]] = scope["f"]
    return compiled
