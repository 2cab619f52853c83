"""Darboux polynomials D f = K f: planted ones are found, Hess's with and without a rotor, and absence is proved."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from conftest import SHIPPED
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import polynomial
from mbsym.analysis.polynomial import invariant_relations
from mbsym.problems.polynomial_integrals.darboux import cofactor_of, darboux_polynomials, rest_means
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.homogenised import InAnyField
from mbsym.problems.polynomial_integrals.modular import PRIMES, lifted
from mbsym.problems.polynomial_integrals.result import Obstacle
from mbsym.problems.polynomial_integrals.search import polynomial_integrals


def planted(names=("k",)):
    """x' = k x z/2 - y z, y' = k y z/2 + x z, z' = x y:  D (x^2 + y^2) = k z (x^2 + y^2) by hand."""
    context = fmpq_mpoly_ctx.get([*names, "x", "y", "z"], Ordering.lex)
    k, x, y, z = context.gens()
    tops = (k * x * z / 2 - y * z, k * y * z / 2 + x * z, x * y)
    return PolynomialField(context, names, ("x", "y", "z"), tops, context.constant(1)), (k, x, y, z)


def usual(field, degree):
    return polynomial_integrals(field, grading(field, (field.variables,)), degree)


def test_an_irreducible_one_of_degree_two_is_found_with_its_cofactor():
    """Eigenvalues k/2 + i, k/2 - i and 0 at (0, 0, 1): their mean k/2, twice, is K = k z; x + i y is not rational."""
    field, (k, x, y, z) = planted()
    found = darboux_polynomials(usual(field, 2))
    assert [(one.polynomial, one.cofactor, one.weight) for one in found.polynomials] == [(x**2 + y**2, k * z, 2)]
    assert (found.complete, found.obstacle) == (True, None)
    assert rest_means(field, (0, 0, 1)) == [k / 2]
    # Its square, and its products with others, are no new ones.
    assert len(darboux_polynomials(usual(field, 4)).polynomials) == 1
    assert darboux_polynomials(usual(field, 4), PRIMES[1]).polynomials == found.polynomials


def test_both_routes_refuse_a_planted_error():
    field, (k, x, y, z) = planted()
    assert cofactor_of(field, x**2 + y**2) == k * z
    assert cofactor_of(field, x**2 + 2 * y**2) is None
    support = [(2, 0, 0), (0, 2, 0)]
    assert lifted(field, support, False, (2, 0, 0), factor=k * z) == x**2 + y**2
    assert lifted(field, support, False, (2, 0, 0), factor=2 * k * z) is None
    wrong = replace(field, numerators=(field.numerators[0], -field.numerators[1], field.numerators[2]))
    found = darboux_polynomials(usual(wrong, 2))
    assert x**2 + y**2 not in [one.polynomial for one in found.polynomials]
    assert found.complete


def test_where_the_field_is_not_at_rest_nothing_is_proved():
    """x' = x^2, y' = x y is no rest at (1, 0); of a K with x y, for x' = x^2 y, y' = x y^2, rest tells nothing."""
    context = fmpq_mpoly_ctx.get(["x", "y"], Ordering.lex)
    x, y = context.gens()
    field = PolynomialField(context, (), ("x", "y"), (x**2, x * y), context.constant(1))
    found = darboux_polynomials(usual(field, 2))
    assert (found.obstacle, found.complete) == (Obstacle.NOT_AT_REST, False)
    mixed = PolynomialField(context, (), ("x", "y"), (x**2 * y, x * y**2), context.constant(1))
    assert darboux_polynomials(usual(mixed, 2)).obstacle is Obstacle.MIXED


def of_file(name, values, degree):
    system = mbsym.load(SHIPPED / f"{name}.yaml")
    there = polynomial.setting(system, {key: Fraction(x) for key, x in values.items()})
    return there, polynomial.integrals_of(there, degree)


def test_hess_relation_is_the_only_one_of_its_top():
    there, found = of_file("hess-appelrot", {}, 4)
    told = darboux_polynomials(found)
    assert [str(there.formula(one.polynomial)) for one in told.polynomials] == ["A*x0*p + C*z0*r"]
    assert told.complete
    assert [cofactor_of(there.field, one.polynomial) for one in told.polynomials] == [
        one.cofactor for one in told.polynomials
    ]


@pytest.mark.parametrize(
    ("numbers", "expected"),
    [
        # x0^2 A (B - C) = z0^2 C (A - B): 6 = 6.  6 p' = q r - h q + gamma2, 3 r' = 2 p q - gamma2, so that
        # h - 2 p - r has the derivative q/3 (h - 2 p - r).
        ({"A": 6, "B": 4, "C": 3, "x0": 1, "z0": 1}, [("h - 2*p - r", "q/3")]),
        ({"A": 6, "B": 5, "C": 3, "x0": 1, "z0": 1}, []),
    ],
)
def test_hess_gyrostat(numbers, expected):
    """L. N. Sretensky (1963): Hess's case with a rotor; f is linear, but not homogeneous."""
    there, found = of_file("heavy-gyrostat", numbers | {"m": 1, "g": 1}, 3)
    told = InAnyField(found, there.kinds, there.known).darboux()
    assert [
        (str(there.formula(one.polynomial)), str(there.quotient(one.cofactor, there.field.denominator)))
        for one in told.polynomials
    ] == expected
    assert told.complete


def test_levels_that_are_not_looked_at_are_not_said_to_be_empty():
    there, found = of_file("double-pendulum", {}, 1)
    assert invariant_relations(InAnyField(found, there.kinds, there.known), []).levels is None
    there, found = of_file("goryachev-chaplygin", {}, 4)
    levels = invariant_relations(InAnyField(found, there.kinds, there.known), ["C"]).levels
    assert levels is not None
    assert [(one.level.weight, [w for w, _ in one.integrals], one.complete) for one in levels.levels] == [
        (2, [], True),
        (3, [3], True),
    ]
