"""Slow manifolds whose lowest order is quadratic: which root, the square root in the coefficients, by hand."""

from __future__ import annotations

from math import sqrt

import pytest
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.factors import square_root_of
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.analysis.expanding import expansion
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.result import Choice, Outcome, scaled
from mbsym.problems.small_parameter.slow import adjoined, roots
from mbsym.simulation.expanded import measured

#: eps m z'' = m g - c (1 + z/h) z'^2: a light ball in a fluid that grows denser.
FALL = """
mbsym: 1
name: a light ball
parameters: {m: positive, c: positive, g: positive, h: positive, eps: positive}
bodies: [{name: ball, attached to: 0, connection point: [0, 0, -z], mass: eps*m, coordinates: [z]}]
loads: [{generalized force: {z: m*g - c*(1 + z/h)*z_dot**2}}]
small parameter: eps
values: {m: 1, c: 1, g: 2, h: 1, eps: 0.05}
initial: {z: {position: 0, velocity: 3}}
"""
#: eps m x'' = c x' (1 - x') - k x, and a second body that is at rest with the first.
ACTIVE = """
mbsym: 1
name: friction that drives
parameters: {m: positive, c: positive, k: positive, eps: positive}
bodies: [{name: ball, attached to: 0, connection point: [x, 0, 0], mass: eps*m, coordinates: [x]}]
loads: [{generalized force: {x: SIGN*c*x_dot*(1 - x_dot) - k*x}}]
small parameter: eps
motion: {}
"""


def value(formula, **at):
    return eval(str(formula), {"sqrt": sqrt}, at)


def told(found):
    manifold = found.manifold
    series = dict(zip((*manifold.fast, *manifold.slow), (*manifold.functions, *manifold.flow), strict=True))
    return {name: [found.formula(one.coefficient(k)) for k in range(2)] for name, one in series.items()}


@pytest.mark.parametrize("at", [{"m": 2, "c": 3, "g": 5, "h": 7, "z": 1}, {"m": 1, "c": 2, "g": 3, "h": 1, "z": 4}])
def test_the_manifold_of_a_fall_by_hand(at):
    """v0^2 = m g/(c d), d = 1 + z/h;  m v0 dv0/dz = -2 c d v0 v1  with  v0 dv0/dz = -m g/(2 c h d^2)."""
    found = expansion(mbsym.loads(FALL), 2)
    m, c, g, h, z = (at[x] for x in "mcghz")
    d = 1 + z / h
    v0 = sqrt(m * g / (c * d))
    v1 = m * m * g / (2 * c * h * d**2) / (2 * c * d * v0)
    for name in ("z_dot", "z"):
        first, second = told(found)[name]
        assert value(first, **at) == pytest.approx(v0, rel=1e-12)
        assert value(second, **at) == pytest.approx(v1, rel=1e-12)
    assert found.manifold.residuals == (3,)


def test_the_root_that_attracts_is_taken_and_the_other_told():
    found = expansion(mbsym.loads(FALL), 1)
    assert found.choice is Choice.ATTRACTING
    ((other,),) = found.others
    assert value(other, m=1, c=2, g=3, h=1, z=4) == pytest.approx(-sqrt(3 / 10))
    ((real,),) = (x.factors for x in found.real)
    assert str(Formula(found.transfer.ring, real)) == "z + h"
    assert [str(x) for x in found.provided] == ["z + h"]
    against = FALL.replace("m*g - c*", "-m*g + c*")  # reversed in time: what attracted repels
    ((other,),) = expansion(mbsym.loads(against), 1).others
    assert value(other, m=1, c=2, g=3, h=1, z=4) == pytest.approx(sqrt(3 / 10))


def test_the_error_shrinks_as_it_should():
    """From the manifold, all equations beside the flow on it up to eps^1: eps^2."""
    loaded = mbsym.loads(FALL)
    found = measured(loaded.system, expansion(loaded, 1), 2.0)
    assert found.orders == pytest.approx((2, 2), abs=0.25)
    assert not found.exact


@pytest.mark.parametrize(("sign", "outcome"), [("-1", Outcome.HOLDS), ("1", Outcome.FAILS)])
def test_of_several_roots_the_one_of_the_motion_is_taken(sign, outcome):
    """x' = 0 at rest, of x' = (1 -+ sqrt(1 - 4 k x/c))/2: friction there brakes (-1) or drives (1)."""
    found = expansion(mbsym.loads(ACTIVE.replace("SIGN", sign)), 1)
    assert found.choice is Choice.ON_MOTION
    assert value(told(found)["x_dot"][0], m=1, c=4, k=1, x=0) == 0
    assert found.fast[0] is outcome


def field(*rows):
    """(s', z') = (-s, row/eps) for each row."""
    context = fmpq_mpoly_ctx.get(["eps", "s", "z"], Ordering.lex)
    eps, s, z = context.gens()
    return PolynomialField(context, ("eps",), ("s", "z"), (-s * eps, *(row(s, z) + 0 * eps for row in rows)), eps)


def test_all_roots_are_found_and_those_that_are_not_counted():
    """z (s - z) (z^2 - 2 s) (z^3 - s): two rational ones, two square roots, three others; (s - z)^2 is singular."""
    there = scaled(field(lambda s, z: z * (s - z) * (z**2 - 2 * s) * (z**3 - s) * (z - 1) ** 2), "eps", {})
    found = roots(there, (1,))
    assert len(found.known) == 2
    (square,) = found.squares
    assert square_root_of(square * 2 * there.field.context.gen(1)) is not None
    assert found.others == 3


def test_a_square_root_in_the_place_of_a_variable_moves_as_it_should():
    """rho^2 = s: rho' = s'/(2 rho) = -rho/2, and s = rho^2 in what z' was."""
    plain = field(lambda s, z: s - z**2)
    changed, root = adjoined(plain, plain.context.gen(1), ("z", "eps"))
    eps, rho, z = changed.context.gens()
    assert changed.numerators[0] * 2 == -rho * changed.denominator
    assert changed.numerators[1] * eps == (rho**2 - z**2) * changed.denominator
    assert (root.instead, root.place) == ("s", 1)


def test_a_square_root_of_squares_is_refused():
    text = FALL.replace("(1 + z/h)", "(1 + z**2/h**2)").replace("m*g", "m**2*g**2").replace("c*", "c**2*")
    with pytest.raises(NoClosedForm, match="no slow variable or parameter is linear"):
        expansion(mbsym.loads(text.replace("mass: eps*m", "mass: eps")), 1)


SLOW = "{{name: {0}, attached to: 0, connection point: [{1}], mass: m, coordinates: [{0}]}}"


def drag(law):
    """eps m z'' = law."""
    return mbsym.loads(FALL.replace("m*g - c*(1 + z/h)*z_dot**2", law))


@pytest.mark.parametrize("law", ["c*(1 - z_dot)*(1 + z_dot**2)", "c*(z_dot - 1)*(z_dot**2 + h)"])
def test_square_roots_that_are_nowhere_real_are_no_solutions(law):
    found = expansion(drag(law), 1)
    assert (found.choice, found.others, found.unknown, found.real) == (Choice.ONLY, (), 0, ())
    assert [str(x) for x in told(found)["z_dot"]] == ["1", "0"]


@pytest.mark.parametrize("law", ["-c*(1 + z_dot**2)", "-c*(z**2 + h + z_dot**2)"])
def test_without_real_solutions_none_is_looked_for_further(law):
    with pytest.raises(NoClosedForm, match="no simple real solutions") as raised:
        expansion(drag(law), 1)
    assert not raised.value.remedy


def test_a_rational_solution_is_real_without_conditions():
    """x' = 0 beside x' = +-sqrt(x + k): only those need x + k > 0.  It attracts there, and repels where x + k < 0."""
    found = expansion(mbsym.loads(ACTIVE.replace("SIGN*c*x_dot*(1 - x_dot) - k*x", "c*x_dot*(x_dot**2 - x - k)")), 1)
    assert found.choice is Choice.FIRST
    assert str(told(found)["x_dot"][0]) == "0"
    assert len(found.others) == 2
    assert found.real == ()


def test_numbers_that_are_no_squares_have_no_remedy():
    with pytest.raises(NoClosedForm, match="square root of something") as raised:
        expansion(drag("c*(2 - z_dot**2)"), 1)
    assert not raised.value.remedy


def test_a_set_of_steady_states_is_told_in_the_variables_of_the_description():
    """Any x with x' = y' = 0 is steady; y' = +-sqrt(x + 1) are no solutions that it needs."""
    text = ACTIVE.replace("coordinates: [x]}", "coordinates: [x]}, " + SLOW.format("y", "0, y, 0"))
    text = text.replace("x: SIGN*c*x_dot*(1 - x_dot) - k*x", "x: -c*x_dot*(1 + y - x_dot**2), y: -k*y_dot")
    found = expansion(mbsym.loads(text), 1)
    assert found.choice is Choice.ON_MOTION
    assert len(found.others) == 2
    assert found.manifold.steady.free == ("y",)
    assert found.stabilizable == (Outcome.HOLDS, ())
    assert found.real == ()
    text = text.replace("1 + y - x_dot**2", "1 + y + z - x_dot**2")
    text = text.replace("bodies: [", "bodies: [" + SLOW.format("z", "0, 0, z") + ", ")
    both = expansion(mbsym.loads(text.replace("y: -k*y_dot", "y: -k*y_dot, z: -k*z_dot")), 1)
    assert set(both.manifold.steady.free) == {"y", "z"}
    tied = expansion(mbsym.loads(text.replace("y: -k*y_dot", "y: -k*y_dot - k*(y + z), z: -k*z_dot")), 1)
    assert tied.manifold.steady.free == ()
