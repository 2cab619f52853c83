"""Dimensionless groups of systems in speeds: the same as of the same systems in angles."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
import sympy
from conftest import SHIPPED

import mbsym
from mbsym.analysis.in_groups import group_of, in_groups
from mbsym.expressions.tree import text
from mbsym.problems.scaling import groups

BODY = """
mbsym: 1
name: heavy body
parameters: {A: positive, B: positive, C: positive, m: positive, g: positive, x0: positive, y0: positive, z0: positive}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [x0, y0, z0]
    mass: m
    inertia about: joint
    inertia: {tensor: [A, B, C], accept: true}
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
values: {A: 8, B: 7, C: 6, m: 1, g: 1, x0: 2, y0: 1, z0: 1}
initial: {psi: 0, theta: 1, phi: 0, p: 1/2, q: 1/3, r: 1/4}
"""
SPEEDS = "    speeds: {p: omega1, q: omega2, r: omega3}\n    orientation: {gamma: 3}\n"


def _found(analysis):
    return groups(analysis.scene, analysis.equations)


def _told(found):
    return [text(group_of(one.parameter, one.powers)) for one in found.groups]


@pytest.mark.parametrize("orientation", ["{gamma: 3}", "direction cosines", "{e: quaternion}"])
def test_a_heavy_body_has_four_ratios_in_any_variables(orientation):
    """A : B : C and x0 : y0 : z0; m g x0/A is the square of the unit of 1/t, which the components of w have, too."""
    rate = (("A", Fraction(-1, 2)), ("m", Fraction(1, 2)), ("g", Fraction(1, 2)), ("x0", Fraction(1, 2)))
    found = _found(mbsym.loads(BODY.replace("{gamma: 3}", orientation)))
    assert sorted(_told(found)) == ["B/A", "C/A", "y0/x0", "z0/x0"]
    assert found.units == ("A", "m", "g", "x0")
    assert found.rate == rate
    assert [(one.parameter, one.powers) for one in found.lengths] == [(name, rate) for name in "pqr"]


def test_without_speeds_they_are_the_same():
    spoken, plain = _found(mbsym.loads(BODY)), _found(mbsym.loads(BODY.replace(SPEEDS, "").split("initial:")[0]))
    assert (spoken.units, spoken.groups, spoken.rate) == (plain.units, plain.groups, plain.rate)


def test_the_field_of_the_centre_against_the_rate_is_a_group():
    """Clebsch, Tisserand, Brun: N = 3 nu/R^3 is the square of a rate, as W^2 is, so that N/W^2 matters."""
    assert _told(_found(mbsym.load(Path(SHIPPED) / "clebsch-poisson.yaml"))) == ["N/W**2", "B/A", "C/A"]


def test_initial_speeds_are_told_in_their_units():
    """m g x0/A = 1/4: a component of the angular velocity of 1/2 is 1 in units of 1/2."""
    analysis = mbsym.loads(BODY)
    written = in_groups(analysis.system, _found(analysis))
    values = {one.coordinate: float(sympy.sympify(text(one.position))) for one in written.start}
    assert values == pytest.approx({"p": 1, "q": 2 / 3, "r": 1 / 2})


def test_speeds_that_are_velocities():
    """k/m and w^2 are squares of rates: with speeds y' or x' + w y of its own, w^2 m/k is the only number."""
    text_of = """
mbsym: 1
name: oscillator
parameters: {{m: positive, k: positive, w: positive}}
bodies:
  - name: P
    attached to: 0
    connection point: [x, y, 0]
    mass: m
    coordinates: [x, y]
    speeds: {{{speeds}}}
loads:
  - potential: k*x**2/2 + m*w**2*y**2
"""
    for speeds in ("v: y_dot", "v: x_dot + w*y"):
        assert _told(_found(mbsym.loads(text_of.format(speeds=speeds)))) in (["w*sqrt(m/k)"], ["k/(m*w**2)"])
