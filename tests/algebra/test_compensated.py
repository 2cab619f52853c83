"""Operations in pairs: what rounding takes away is exact, values mean the same, and cancelled digits come back."""

from __future__ import annotations

from fractions import Fraction as F
from math import sqrt
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

from mbsym.algebra import compensated as module
from mbsym.algebra.compensated import compensated
from mbsym.algebra.program import PRODUCT_ROUNDING, SUM_ROUNDING, Node, Program
from mbsym.numerics.kernels.arrays import stepwise
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.llvm import available, kernel
from mbsym.numerics.kernels.precise import enclosures

FINITE = st.floats(-1e60, 1e60).filter(lambda x: x == 0 or abs(x) > 1e-60)


@pytest.mark.parametrize("made", [kernel, stepwise])
@settings(max_examples=80)
@given(a=FINITE, b=FINITE)
def test_roundings_are_exact(made: Any, a: float, b: float) -> None:
    """fl(a + b) + rounding = a + b and fl(a b) + rounding = a b, in fractions."""
    run = made(ROUNDED, FLOAT64)
    s, ds, p, dp = map(F, run(np.array([a, b])))
    assert s + ds == F(a) + F(b)
    assert p + dp == F(a) * F(b)


def rounded_code() -> Code:
    program = Program()
    x, y = program.input("x"), program.input("y")
    outputs = (
        program.plus(x, y),
        program.rounding(SUM_ROUNDING, x, y),
        program.product(x, y),
        program.rounding(PRODUCT_ROUNDING, x, y),
    )
    return Code(program, ("x", "y"), outputs)


ROUNDED = rounded_code()


def test_roundings_vanish_in_exact_arithmetic() -> None:
    found = enclosures(ROUNDED, (0.1, 3.7))
    assert found[1].is_zero()
    assert found[3].is_zero()


def test_signs_are_moved_out_of_roundings() -> None:
    """-a b is -(a b): so is what rounding takes away, and no fused operation may stand in for the product."""
    program = Program()
    x, y = program.input("x"), program.input("y")
    whole = program.difference(program.number(1), program.product(x, y))
    rest = program.rounding(PRODUCT_ROUNDING, program.minus(x), y)
    run = kernel(Code(program, ("x", "y"), (whole, rest, program.plus(whole, rest))), FLOAT64)
    a, b = 0.1, 0.7
    found = run(np.array([a, b]))
    assert found[0] == 1 - a * b
    assert F(found[1]) == F(a * b) - F(a) * F(b)


def example() -> tuple[Program, list[Node]]:
    """Forms in which everything cancels: twelve digits and more are lost by plain sums."""
    program = Program()
    x, y = program.input("x"), program.input("y")
    large = program.number(F(10**12) + F(1, 3))
    middle = program.number(F(10**5) + F(1, 3))
    s, c = program.sin_cos_of(x)
    a = large * c + program.number(F(2, 3))
    b = large * c
    return program, [
        program.divide(a * b - b * b, b) - program.number(F(1, 7)),
        program.square_root(middle * middle + y * y) - middle,
        (large * s) * s + (large * c) * c + program.number(F(1, 7)) - large,
        program.divide(a, b) - program.one,
        -(a - b) * y + x,
    ]


@pytest.mark.parametrize("many", [False, True])
def test_digits_come_back(many: bool) -> None:
    """Against balls of 300 bits, one state and many states side by side; a half of them or less is lost without."""
    program, outputs = example()
    states = np.array([[0.3, 0.7], [1.1, 2.9], [-2.2, 0.4]]).T
    plain = Code(program, ("x", "y"), tuple(outputs))
    pairs = Code(program, ("x", "y"), tuple(compensated(program, outputs, program.live(outputs))))
    worst = {"plain": 0.0, "pairs": 0.0}
    for name, code in (("plain", plain), ("pairs", pairs)):
        run = kernel(code, FLOAT64)
        wide = run(np.repeat(states, 8, axis=1)) if many else None
        for k, state in enumerate(states.T):
            found = run(state) if wide is None else wide[:, 8 * k]
            for value, exact in zip(found, enclosures(plain, [float(x) for x in state], 300), strict=True):
                worst[name] = max(worst[name], abs(float((value - exact) / exact)))
    assert worst["plain"] > 1e-5
    assert worst["pairs"] < 4e-15


def test_only_what_is_sensitive_costs() -> None:
    program, outputs = example()
    assert compensated(program, outputs, ()) == outputs
    one = compensated(program, outputs, program.live(outputs[:1]))
    assert (
        program.operations(outputs)
        < program.operations(one)
        < program.operations(compensated(program, outputs, program.live(outputs)))
    )


@pytest.mark.parametrize("scalar", [FLOAT32, EXTENDED])
def test_other_arithmetics_are_no_worse(scalar: str) -> None:
    if not available(scalar):
        pytest.skip(f"no {scalar} here")
    program = Program()
    x, y = program.input("x"), program.input("y")
    outputs = [(x + y) * (x - y) + program.number(F(1, 3)), program.divide(x * y, x + y)]
    pairs = compensated(program, outputs, program.live(outputs))
    for code in (outputs, pairs):
        found = kernel(Code(program, ("x", "y"), tuple(code)), scalar)(np.array([0.3, 0.7]))
        assert [float(v) for v in found] == pytest.approx([0.3**2 - 0.7**2 + 1 / 3, 0.21], rel=1e-6)


def double_doubles(x: float) -> tuple[Any, Any]:
    with ctx.workprec(300):
        return arb(fmpq(*x.as_integer_ratio())), arb(2) ** -100


def test_a_root_has_twice_the_digits() -> None:
    """high + low of sqrt x agree with the root to 100 bits: by hand, not by the program's own outputs."""
    program = Program()
    x = program.input("x")
    root = program.square_root(x)
    pairs = module._Pairs(program, frozenset(program.live([root])))
    pairs.images([root])
    high, low = pairs.pairs[root.number]
    assert low is not None
    run = kernel(Code(program, ("x",), (high, low)), FLOAT64)
    for value in (2.0, 0.3, 7e11):
        a, b = run(np.array([value]))
        exact, tiny = double_doubles(value)
        with ctx.workprec(300):
            assert a == sqrt(value)
            assert abs((arb(float(a)) + arb(float(b))) / exact.sqrt() - 1) < tiny


@pytest.mark.parametrize("planted", ["rounding", "half", "fused"])
def test_planted_errors_are_noticed(planted: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lost rounding, 1 - cos with a lost factor 2, a product that is fused though its rounding is taken."""
    if planted == "rounding":
        monkeypatch.setattr(Program, "rounding", lambda self, operation, a, b: self.zero)
    elif planted == "half":
        monkeypatch.setattr(module, "HALF", F(1))
    else:
        from mbsym.numerics.kernels import llvm

        monkeypatch.setattr(llvm, "PRODUCT_ROUNDING", "none of them")
        with pytest.raises((AssertionError, KeyError)):
            test_digits_come_back(False)
        return
    with pytest.raises(AssertionError):
        test_digits_come_back(False)
