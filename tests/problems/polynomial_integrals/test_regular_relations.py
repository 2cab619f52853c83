"""What divides its derivative because the equations divide by it is no invariant relation."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import SHIPPED
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis import polynomial
from mbsym.problems.polynomial_integrals.darboux import darboux_polynomials, is_regular_on
from mbsym.problems.polynomial_integrals.gradings import grading
from mbsym.problems.polynomial_integrals.relations import linear_relations
from mbsym.problems.polynomial_integrals.search import polynomial_integrals


@pytest.mark.parametrize("name", ["spring-pendulum", "gravity-gradient"])
def test_poles_of_coordinates_are_no_relations(name):
    """r' = r_dot and (cos theta)' = -sin(theta) theta_dot are not zero where r and cos theta are."""
    there = polynomial.setting(mbsym.load(SHIPPED / f"{name}.yaml"))
    found = linear_relations(there.field, (1,) * len(there.field.variables), (), free=False)
    told = {str(there.formula(one.polynomial)) for one in found.relations}
    assert not told & {"r", "cos(theta)"}


def test_a_plane_pendulum_is_a_spherical_one():
    """psi_dot = 0 stays so, although its equation is divided by the sine of theta."""
    there = polynomial.setting(mbsym.load(SHIPPED / "spherical-pendulum.yaml"))
    found = linear_relations(there.field, (1,) * len(there.field.variables), ("l", "m", "g"), free=False)
    assert [str(there.formula(one.polynomial)) for one in found.relations] == ["psi_dot"]
    assert all(one.nonzero == () for one in found.relations)


def radial():
    """x' = z, y' = a y z/x, z' = 0, times x."""
    context = fmpq_mpoly_ctx.get(["a", "x", "y", "z"], Ordering.lex)
    a, x, y, z = context.gens()
    return PolynomialField(context, ("a",), ("x", "y", "z"), (x * z, a * y * z, 0 * x), x), (a, x, y, z)


def test_darboux_polynomials_on_which_nothing_is_defined_are_marked():
    """By hand: x' = z does not vanish with x, although x divides x x'; y' = a y z/x vanishes with y."""
    field, (_, x, y, _) = radial()
    found = darboux_polynomials(polynomial_integrals(field, grading(field, (field.variables,)), 1))
    assert {str(one.polynomial): one.defined for one in found.polynomials} == {"x": False, "y": True}
    assert is_regular_on(field, x + y)
    assert not is_regular_on(field, x * x)


def test_a_circle_is_looked_at_with_its_relation():
    """1 - s^2 is not divided by c, but vanishes with it; at c + s = 0 it is a half."""
    context = fmpq_mpoly_ctx.get(["u", "s", "c"], Ordering.lex)
    u, s, c = context.gens()
    field = PolynomialField(context, (), ("u", "s", "c"), (u, c, -s), 1 - s**2, (s**2 + c**2 - 1,))
    assert not is_regular_on(field, c)
    assert is_regular_on(field, c + s)
    assert is_regular_on(field, s)
    assert is_regular_on(field, u)
    sphere = replace(field, denominator=(u**2 + s**2), relations=(u**2 + s**2 + c**2 - 1,))
    assert not is_regular_on(sphere, c - 1)
    assert is_regular_on(sphere, c)


LINE = """
mbsym: 1
name: two points on lines
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
  - {name: two, attached to: 0, connection point: [0, y, 0], mass: 1, coordinates: [y]}
loads:
  - potential: POTENTIAL
"""


def test_what_vanishes_nowhere_is_no_relation_of_motions():
    """exp(x - y)' = (x' - y') exp(x - y), and no state has exp(x - y) = 0; nor 1/(x^2 + y^2) = 0."""
    there = polynomial.setting(mbsym.loads(LINE.replace("POTENTIAL", "exp(x - y)")))
    found = darboux_polynomials(polynomial.integrals_of(there, 2))
    assert {str(there.formula(one.polynomial)): one.defined for one in found.polynomials} == {"exp(x - y)": False}
    there = polynomial.setting(mbsym.loads(LINE.replace("POTENTIAL", "-1/sqrt(x**2 + y**2)")))
    assert there.field.units == {"sqrt(x**2 + y**2)", "1/(x**2 + y**2)"}
    assert linear_relations(there.field, (1,) * 6, (), free=False).relations == ()
