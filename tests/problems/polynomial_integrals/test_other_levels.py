"""Integrals where another one has a value other than zero: planted ones are found with the value, elsewhere none."""

from __future__ import annotations

from fractions import Fraction

import pytest
from conftest import SHIPPED
from flint import Ordering, fmpq, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import polynomial
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.homogenised import InAnyField
from mbsym.problems.polynomial_integrals.levels import on_level
from mbsym.problems.polynomial_integrals.other_levels import _Search, _weights
from mbsym.problems.polynomial_integrals.search import polynomial_integrals


def planted(c, slope=1):
    """x' = (y - c) z^2, y' = 0, z' = x y + slope z:  y is constant, and where it is c, x is; by hand nowhere else."""
    context = fmpq_mpoly_ctx.get(["x", "y", "z"], Ordering.lex)
    x, y, z = context.gens()
    tops = ((y - fmpq(c.numerator, c.denominator)) * z**2, 0 * x, x * y + slope * z)
    return PolynomialField(context, (), ("x", "y", "z"), tops, context.constant(1))


def others_of(field, kinds, degree, known=()):
    return InAnyField(polynomial_integrals(field, grading(field, kinds), degree, known), kinds, known).other_levels()


@pytest.mark.parametrize("c", [Fraction(2), Fraction(-3, 7)])
def test_the_value_is_found(c):
    field = planted(c)
    found = others_of(field, (("x", "y", "z"),), 2)
    (level,) = found.levels
    assert [(one.value, [str(f) for _, f in one.integrals], one.complete) for one in level.values] == [(c, ["x"], True)]
    assert (level.complete, level.whole, level.undecided, level.irrational) == (True, False, (), ())


def test_along_a_trajectory_x_is_constant_at_that_value_alone():
    """Numbers beside the algebra: Euler's small steps; what is exactly constant stays so."""

    def moved(y):
        x, z = 0.5, 0.25
        for _ in range(100):
            x, z = x + 1e-2 * (y - 2.0) * z**2, z + 1e-2 * (x * y + z)
        return x

    assert moved(2.0) == 0.5
    assert abs(moved(1.5) - 0.5) > 1e-3


def vector(factor):
    """x' = y^2 - factor (a^2 + b^2), a' = y b, b' = -y a, with a^2 + b^2 = 1: x is constant where y^2 is factor."""
    context = fmpq_mpoly_ctx.get(["x", "y", "a", "b"], Ordering.lex)
    x, y, a, b = context.gens()
    tops = (y**2 - factor * (a**2 + b**2), 0 * x, y * b, -y * a)
    return PolynomialField(context, (), ("x", "y", "a", "b"), tops, context.constant(1), (a**2 + b**2 - 1,))


def test_a_unit_vector_fixes_the_size():
    """Its square has the weight 2, y the weight 1: values are those of y^2. Without the relation there are none."""
    kinds = (("x", "y"), ("a", "b"))
    found = others_of(vector(4), kinds, 2)
    (level,) = [one for one in found.levels if str(one.level.polynomial) == "y"]
    assert level.power == 2
    assert [(one.value, [str(f) for _, f in one.integrals]) for one in level.values] == [(Fraction(4), ["x"])]
    assert level.complete
    (other,) = [one for one in others_of(vector(5), kinds, 2).levels if str(one.level.polynomial) == "y"]
    assert [one.value for one in other.values] == [Fraction(5)]


def test_of_heavy_tops_there_are_none_at_any_value():
    """Scaling: the area integral has the weight 3, the square of gamma 4, and K would have a negative weight."""
    system = mbsym.load(SHIPPED / "goryachev-chaplygin.yaml")
    there = polynomial.setting(system, {name: Fraction(1) for name in ("C", "m", "g", "x0")})
    found = polynomial.integrals_of(there, 4)
    energy, area = InAnyField(found, there.kinds, there.known).other_levels().levels
    assert (energy.power, energy.by_rank, energy.complete, energy.whole) == (2, True, True, True)
    assert (area.power, area.by_rank, area.complete, area.whole) == (4, False, True, True)
    # A second route: the search at a number, on the levels of both.
    length = next(one for one in found.generators if one.name.startswith("length of "))
    for level, power, other in ((energy.level, 2, 1), (area.level, 4, 3)):
        at = _Search(found, length, level, power, other, [4]).at(Fraction(5))
        assert at is not None
        assert (at.integrals, at.complete) == ((), True)
    # Where it is zero there is Goryachev and Chaplygin's: that one is told by its own search.
    assert [w for w, _ in on_level(found, area.level).integrals] == [3]


def test_without_a_size_scaling_proves_that_there_are_none():
    """Euler's top without weight: energy and the square of the angular momentum, at any values."""
    context = fmpq_mpoly_ctx.get(["p", "q", "r"], Ordering.lex)
    p, q, r = context.gens()
    field = PolynomialField(context, (), ("p", "q", "r"), (q * r, -2 * r * p, p * q), context.constant(1))
    found = others_of(field, (("p", "q", "r"),), 2)
    assert not found.fixed
    assert [(one.complete, one.by_rank, one.values) for one in found.levels] == [(True, False, ())] * 2


def test_weights_to_which_terms_can_be_raised():
    """Sums of 3 and 4 are 0, 3, 4, 6 and all that follow: from weights 0 ... 4 all to 10; of 2 and 4 the even ones."""
    assert _weights(4, 3, 4) == [10]
    assert _weights(4, 2, 4) == [3, 4]
    assert _weights(3, 5, 1) == [3]
