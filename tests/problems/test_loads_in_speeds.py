"""Loads that hold speeds and unit vectors: M u' = f by hand, the second route in angles, integrals, the way back."""

from __future__ import annotations

import pytest
from conftest import parsed

import mbsym
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.source import read, to_yaml

BODY = """
mbsym: 1
name: a body about its fixed point
parameters: {{A: positive, B: positive, C: positive, k: positive, N: real}}
bodies:
  - name: body
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass: 0
    inertia about: joint
    inertia: [A, B, C]
    speeds: {{p: omega1, q: omega2, r: omega3}}
    {orientation}
loads:
  - {load}
"""
IN_VECTORS, IN_ANGLES = "orientation: {gamma: 3}", "orientation: angles"


def _body(load: str, orientation: str = IN_VECTORS) -> mbsym.Analysis:
    return mbsym.loads(BODY.format(load=load, orientation=orientation))


def _is(found, right, text):
    scene = found.form.scene(bodies=False)
    return found.ring.is_zero(right.polynomial - scene.lower(parsed(text)))


# Euler's equations with the torque L on the right, by hand: f_1 = (B - C) q r + L_1, and so on around.
LOADS = {
    "torque: {body: body, axes: body, components: [-k*p, -k*q, -k*r]}": ("-k*p", "-k*q", "-k*r"),
    "rayleigh: k*(p**2 + q**2 + r**2)/2": ("-k*p", "-k*q", "-k*r"),
    # of a charge that turns in a field along gamma: L = k omega x gamma
    "torque: {body: body, axes: body, components: [k*(q*gamma3 - r*gamma2), k*(r*gamma1 - p*gamma3), k*(p*gamma2 - "
    "q*gamma1)]}": ("k*(q*gamma3 - r*gamma2)", "k*(r*gamma1 - p*gamma3)", "k*(p*gamma2 - q*gamma1)"),
    # the torque of a Newtonian field, as Steklov and Lyapunov write it beside Kirchhoff's equations
    "torque: {body: body, axes: body, components: [N*(C - B)*gamma2*gamma3, N*(A - C)*gamma3*gamma1, "
    "N*(B - A)*gamma1*gamma2]}": ("N*(C - B)*gamma2*gamma3", "N*(A - C)*gamma3*gamma1", "N*(B - A)*gamma1*gamma2"),
}


@pytest.mark.parametrize("load", LOADS)
def test_the_load_stands_in_the_equations_as_it_was_written(load):
    found = _body(load)
    gyroscopic = ("(B - C)*q*r", "(C - A)*r*p", "(A - B)*p*q")
    for right, turning, torque in zip(found.equations.forcing, gyroscopic, LOADS[load], strict=True):
        assert _is(found, right, f"{turning} + {torque}")
    # d'Alembert's principle in angles, in which the same load stands as a function of psi, theta, phi and their rates.
    assert found.checks
    assert not any(one.failed for one in found.checks)


@pytest.mark.parametrize("load", [x for x in LOADS if "gamma" not in x])
def test_without_unit_vectors_it_is_the_same(load):
    found = _body(load, IN_ANGLES)
    assert _is(found, found.equations.forcing[0], "(B - C)*q*r - k*p")
    assert not any(one.failed for one in found.checks)


def test_a_slip_in_the_angles_is_seen(monkeypatch):
    from mbsym.model import substitution

    right = substitution.angular_velocity
    monkeypatch.setattr(substitution, "angular_velocity", lambda system, body: right(system, body)[::-1])
    assert any(one.failed for one in _body("rayleigh: k*p**2/2").checks)


def test_clebsch_given_as_a_torque_has_his_integral():
    """f_4 = A^2 p^2 + ... - N (B C gamma1^2 + ...) and the energy, which no force function tells here."""
    load = next(x for x in LOADS if "N*(C - B)" in x)
    there = setting(_body(load))
    found = integrals_of(there, 2)
    field = there.field
    N, A, B, C, p, q, r, g1, g2, g3 = map(field.generator, ("N", "A", "B", "C", *field.variables))
    energy = A * p**2 + B * q**2 + C * r**2 + N * (A * g1**2 + B * g2**2 + C * g3**2)
    fourth = A**2 * p**2 + B**2 * q**2 + C**2 * r**2 - N * (B * C * g1**2 + C * A * g2**2 + A * B * g3**2)
    assert field.derivative(energy) == field.derivative(fourth) == 0
    assert len(found.generators) == 4
    assert found.complete


def test_on_a_tree_a_speed_is_what_its_form_says():
    """A sledge with the drag -k v along its runners: m (x'', y'') = -k v (cos phi, sin phi), by hand in the plane."""
    text = """
mbsym: 1
name: a sledge
parameters: {m: positive, J: positive, k: positive}
bodies:
  - name: sledge
    connection point: [x, y, 0]
    rotation: {axes: [3, 0, 0], angles: [phi, 0, 0]}
    coordinates: [x, y, phi]
    mass: m
    inertia about: mass centre
    inertia: [0, 0, J]
    speeds: {v: x_dot*cos(phi) + y_dot*sin(phi), w: -x_dot*sin(phi) + y_dot*cos(phi), r: phi_dot}
loads:
  - LOAD
"""
    for load in (
        "force: {body: sledge, point: [0, 0, 0], axes: sledge, components: [-k*v, 0, 0]}",
        "rayleigh: k*v**2/2",
        "generalized force: {x: -k*v*cos(phi), y: -k*v*sin(phi)}",
    ):
        found = mbsym.loads(text.replace("LOAD", load))
        for right, by_hand in zip(found.equations.forcing, ("m*r*w - k*v", "-m*r*v", "0"), strict=True):
            assert _is(found, right, by_hand)
        assert not any(one.failed for one in found.checks)


def test_what_was_written_is_written_back():
    for load in LOADS:
        system = _body(load).system
        text = to_yaml(system)
        assert read(text)[0] == system
        assert "sin(" not in text
