"""Disturbances to first order are the first two coefficients of series to second order, which are those of calculus."""

from __future__ import annotations

import random

import pytest
from conftest import parsed
from flint import arb, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.point import Balls, Rationals
from mbsym.mechanics.oracle import Dual, FirstOrder, Series, TaylorSeries

NAMES = ("x", "y", "z")
POLYNOMIAL = "(x - 2*y)**3 + x*y*z - z**2*(y - x)/7"
RATIONAL = f"({POLYNOMIAL})/(x**2 + y**2 + 1) + sin(x - 2*y)*cos(z) - x*sin(z)**2"
IRRATIONAL = f"sqrt(x**2 + y**2)*exp(-x) + log(1 + y**2) + atan(z*x) + sin(x*y) + sinh(z) + ({RATIONAL})"


def disturbed(source: random.Random, kind: type) -> dict[str, tuple[object, object]]:
    def number() -> object:
        return kind(fmpq(source.randint(1, 30), source.randint(1, 20)))

    return {name: (number(), number()) for name in NAMES}


@pytest.mark.parametrize("text", [POLYNOMIAL, RATIONAL])
def test_exactly_the_same_over_rationals(text: str) -> None:
    source = random.Random(7)
    for _ in range(20):
        tangents = {name: fmpq(source.randint(1, 9), source.randint(1, 9)) for name in NAMES}
        numbers = Rationals(tangents, dict.fromkeys(NAMES, 1))
        given = disturbed(source, fmpq)
        series = {name: Series(a, b, numbers.zero) for name, (a, b) in given.items()}
        duals = {name: Dual(a, b) for name, (a, b) in given.items()}
        second = Lowering(TaylorSeries(numbers, series), series)(parsed(text))
        first = Lowering(FirstOrder(numbers, duals), duals)(parsed(text))
        assert (first.a, first.b) == (second.a, second.b)


def test_the_difference_quotient_over_balls() -> None:
    """(f(x + h x') - f(x - h x'))/(2 h) differs from the first coefficient by terms in h^2 only."""
    source, h = random.Random(8), arb(2) ** -20
    given = disturbed(source, arb)
    duals = {name: Dual(a, b) for name, (a, b) in given.items()}
    numbers = Balls({name: a for name, (a, _) in given.items()})
    found = Lowering(FirstOrder(numbers, duals), duals)(parsed(IRRATIONAL))

    def at(step: arb) -> arb:
        values = {name: a + step * b for name, (a, b) in given.items()}
        return Lowering(Balls(values), values)(parsed(IRRATIONAL))

    assert found.a.overlaps(at(arb(0)))
    quotient = (at(h) - at(-h)) / (2 * h)
    assert abs(quotient - found.b) < arb("1e-6") * (1 + abs(found.b))
