"""Rigorous enclosures: the same program over ``arb`` balls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra.point import Balls
from mbsym.numerics.kernels.interface import Code


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
