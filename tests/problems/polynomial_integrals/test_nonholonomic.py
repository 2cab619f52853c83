"""Problems 9 and 10 of systems whose velocities are tied: the equations without multipliers as a polynomial field."""

from __future__ import annotations

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.constrained import integrals_check
from mbsym.analysis.polynomial import setting
from mbsym.formulas.formula import Formula
from mbsym.problems.integrals import Integral
from mbsym.problems.invariant_sets.result import Definiteness

#: u' = a w^2,  (J + m a^2) w' = -m a u w  (S. A. Chaplygin, 1911).
SLEIGH = """
mbsym: 1
name: Chaplygin sleigh in its own speeds
parameters: {m: positive, J: positive, a: positive}
bodies:
  - name: sleigh
    attached to: 0
    connection point: [x, y, 0]
    rotation: {axes: [3], angles: [theta]}
    mass centre: [a, 0, 0]
    mass: m
    inertia about: mass centre
    inertia: [J/2, J/2, J]
    coordinates: [x, y, theta]
    speeds: {u: x_dot*cos(theta) + y_dot*sin(theta), s: y_dot*cos(theta) - x_dot*sin(theta), w: theta_dot}
constraints:
  - velocity: y_dot*cos(theta) - x_dot*sin(theta) = 0
"""
#: A p' = -(D p + E q) q,  B q' = (D p + E q) p  (G. K. Suslov, 1902).
SUSLOV = """
mbsym: 1
name: Suslov's problem
parameters: {A: positive, B: positive, C: positive, D: real, E: real}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: {tensor: [[A, 0, D], [0, B, E], [D, E, C]], accept: true}
    speeds: {p: omega1, q: omega2, s: omega3}
constraints:
  - velocity: psi_dot*cos(theta) + phi_dot = 0
"""


def test_the_field_of_the_sleigh_is_chaplygins():
    field = setting(mbsym.loads(SLEIGH)).field
    assert field.variables == ("u", "w")
    m, J, a, u, w = (field.generator(name) for name in ("m", "J", "a", "u", "w"))
    slopes = [x * (J + m * a**2) for x in field.numerators]
    assert slopes == [field.denominator * x for x in (a * w**2 * (J + m * a**2), -m * a * u * w)]


def test_the_sleigh_has_its_energy_and_nothing_else():
    found = mbsym.loads(SLEIGH).polynomial_integrals
    (energy,) = found.formulas
    assert str(energy) in ("m*u**2 + (m*a**2 + J)*w**2", "m*u**2 + m*a**2*w**2 + J*w**2")
    assert found.integrals.complete
    assert not found.integrals.new


def test_suslovs_body_keeps_more_where_its_axis_is_principal():
    """D = E = 0: p and q are constant."""
    general = mbsym.loads(SUSLOV)
    assert [str(x) for x in general.polynomial_integrals.formulas] == ["A*p**2 + B*q**2"]
    plain = SUSLOV.replace("[[A, 0, D], [0, B, E], [D, E, C]]", "[A, B, C]").replace(", D: real, E: real", "")
    assert {str(x) for x in mbsym.loads(plain).polynomial_integrals.formulas} == {"p", "q"}


#: R. M. Rosenberg's particle on a spring: the reaction does no work along y, so that m y'' = -k y.
PARTICLE = """
mbsym: 1
name: a particle with z' = y x'
parameters: {m: positive, k: positive}
bodies: [{name: p, attached to: 0, connection point: [x, y, z], mass: m, coordinates: [x, y, z]}]
loads: [{spring: {coordinate: y, stiffness: k}}]
constraints: [{velocity: z_dot - y*x_dot = 0}]
dependent: [z]
"""


def test_an_integral_that_no_symmetry_says_is_found_and_checked():
    found = mbsym.loads(PARTICLE)
    result = found.polynomial_integrals
    pairs = zip(result.formulas, result.integrals.generators, strict=True)
    new = [str(formula) for formula, one in pairs if one.is_new]
    assert new == ["m*y_dot**2 + k*y**2"]
    check = found.check("polynomial integrals")
    assert check.outcome == "exact"
    assert "multipliers" in check.first


def test_steady_motions_and_manifolds_of_the_particle():
    """x' = 0 is kept, with y'' = -(k/m) y on it: both integrals together are m/2 (1 + y^2) x'^2, definite across it."""
    families = mbsym.loads(PARTICLE).invariant_sets.families
    rest, manifold = families[0].sets
    assert {(name, str(x)) for name, x in rest.solved} == {("x_dot", "0"), ("y_dot", "0"), ("y", "0")}
    assert [(name, str(x)) for name, x in manifold.solved] == [("x_dot", "0")]
    assert ("y_dot", "-k*y/m") in [(name, str(x)) for name, x in manifold.motion]
    assert all(one.variation.outcome is Definiteness.STABLE for one in (rest, manifold))


def test_a_wrong_integral_is_seen():
    """(1 - y^2) x'^2 in its place, along the motion with multipliers."""
    analysis = mbsym.loads(PARTICLE)
    ring = analysis.ring
    x, y = ring.generator("velocity", "x"), ring.generator("coordinate", "y")
    wrong = Integral("wrong", "polynomial", "", Formula(ring, x**2 * (1 - y**2)), Certainty.PROVED)
    assert integrals_check(analysis, (wrong,)).failed


def test_an_energy_that_is_a_quotient_is_said_to_be_one():
    """x' and y' of the snakeboard are theta' times quotients of cos phi and sin phi; the energy holds their squares."""
    found = mbsym.load(SHIPPED / "snakeboard.yaml").polynomial_integrals.integrals
    assert found.rational == ("generalised energy",)
    assert mbsym.loads(SLEIGH).polynomial_integrals.integrals.rational == ()


def test_relations_that_share_their_variables_are_refused_with_the_reason():
    with pytest.raises(NoClosedForm, match="constraints tie positions"):
        setting(mbsym.load(SHIPPED / "four-bar.yaml"))
