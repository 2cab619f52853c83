"""Bounds of rounding hold: the exact value is never farther away than is told, and signs that are told are right."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest

from mbsym.algebra.point import Rationals
from mbsym.algebra.program import Program
from mbsym.algebra.running_error import Approximate, RunningErrors, certain_sign, outputs
from mbsym.numerics.kernels import llvm
from mbsym.numerics.kernels.interface import Code

NAMES = ("x", "y", "z")


def random_formula(source: Random, algebra, values, depth: int):  # type: ignore[no-untyped-def]
    """The same formula over any algebra, by the same draws."""
    if depth == 0:
        chosen = source.randrange(4)
        return (
            values[chosen]
            if chosen < 3
            else algebra.number(Fraction(source.randint(-20, 20), source.choice((1, 3, 7))))
        )
    a = random_formula(source, algebra, values, depth - 1)
    b = random_formula(source, algebra, values, depth - 1)
    match source.randrange(5):
        case 0:
            return a + b
        case 1 | 2:
            return a - b
        case 3:
            return algebra.times(a, b)
    return algebra.times(a, algebra.reciprocal(algebra.times(b, b) + algebra.one))


@pytest.mark.parametrize("seed", range(12))
def test_the_exact_value_is_within_the_bound(seed: int) -> None:
    program = Program()
    algebra = RunningErrors(program)
    made = random_formula(Random(seed), algebra, [algebra.input(name) for name in NAMES], 5)
    value, error = outputs({"f": made})["f"]
    points = np.random.default_rng(seed).normal(size=(3, 60))
    points[:, 30:] = points[:, :30].round(2)  # cancellation
    found = llvm.kernels({"f": Code(program, NAMES, (value, error))}, wide=True)["f"](points)
    numbers = Rationals({}, {})
    for place in range(60):
        exact = random_formula(Random(seed), numbers, [numbers.number(Fraction(x)) for x in points[:, place]], 5)
        gap = abs(Fraction(int(exact.p), int(exact.q)) - Fraction(float(found[0, place])))
        assert gap <= Fraction(float(found[1, place])) * Fraction(1000001, 1000000)


def test_a_sign_that_rounding_invents_is_not_told() -> None:
    """(x + 1e-17) - x has a sign; rounding makes 0 of it at 1 and at 0.2, not at 0.1."""
    program = Program()
    algebra = RunningErrors(program)
    x = algebra.input("x")
    tiny = (x + algebra.number(Fraction(1, 10**17))) - x
    product = algebra.times(x - algebra.number(Fraction(1, 10)), algebra.number(3))
    nodes = [n for pair in outputs({"tiny": tiny, "product": product}).values() for n in pair]
    run = llvm.kernels({"f": Code(program, ("x",), tuple(nodes))}, wide=True)["f"]
    found = run(np.array([[1.0, 0.1, 0.2]]))
    assert certain_sign(found[0], found[1]).tolist() == [2, 1, 2]
    assert certain_sign(found[2], found[3]).tolist() == [1, 2, 1]  # 0.1 is not 1/10: the sign needs more digits
    # without the bound a wrong sign, none, would be told
    assert certain_sign(found[0], np.zeros(3)).tolist() == [0, 1, 0]


def test_what_may_be_divided_by_zero_has_no_sign() -> None:
    program = Program()
    algebra = RunningErrors(program)
    x = algebra.input("x")
    near = (x + algebra.number(Fraction(1, 3))) - algebra.number(Fraction(1, 3))
    inverse: Approximate = algebra.reciprocal(near)
    value, error = outputs({"f": inverse})["f"]
    found = llvm.kernels({"f": Code(program, ("x",), (value, error))}, wide=True)["f"](np.array([[1e-17, 1.0]]))
    assert certain_sign(found[0], found[1]).tolist() == [2, 1]
