"""First integrals in p, q, r and unit vectors: found, claimed, denied where they do not exist."""

import pytest
from test_speeds import CARRIED, GYROSTAT, PLATE, POISSON, SPEEDS, expected, load

import mbsym
from mbsym.problems.checks import EXACT
from mbsym.problems.claims import Outcome


def test_the_three_classical_integrals_of_a_heavy_gyrostat(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=POISSON))
    assert [item.kind for item in found.integrals] == ["generalised energy", "angular momentum", "unit vectors"]
    assert all(item.status == "proved" for item in found.integrals)
    energy = "(A*p**2 + B*q**2 + C*r**2)/2 + m*g*(x0*gamma1 + y0*gamma2 + z0*gamma3)"
    area = "(A*p + l1)*gamma1 + (B*q + l2)*gamma2 + (C*r + l3)*gamma3"
    assert [item.formula for item in found.integrals] == expected(
        found, [energy, area, "gamma1**2 + gamma2**2 + gamma3**2"]
    )
    assert found.check("first integrals").outcome == EXACT


def test_with_angles_they_are_the_same(tmp_path):
    found = load(tmp_path, GYROSTAT.format(told=SPEEDS))
    assert [item.name for item in found.integrals] == ["generalised energy", "momentum of psi"]
    assert found.check("first integrals").outcome == EXACT


def test_jacobi_where_a_frame_turns_as_prescribed(tmp_path):
    """A bead (no load) on a rod that turns with W: T_2 - T_0 = m (s'^2 - W^2 s^2)/2, also in w = s' + W s."""
    text = """
mbsym: 1
name: A bead on a rod that turns
parameters: {m: positive, W: real}
prescribed: {chi: {rate: W}}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: bead, attached to: rod, connection point: [s, 0, 0], coordinates: [s], mass: m, speeds: {w: s_dot + W*s}}
"""
    found = load(tmp_path, text)
    assert [item.name for item in found.integrals] == ["generalised energy"]
    assert [found.integrals[0].formula] == expected(found, ["m*((w - W*s)**2 - W**2*s**2)/2"])
    assert found.check("first integrals").outcome == EXACT


def test_what_is_not_conserved_is_not_listed(tmp_path):
    """Forces at the mass centre of a plate do work and exert no moment: J phi' is kept, no energy and no momentum.

    A damper and a carrier that turns as prescribed leave the unit vectors, and the momentum along s, which is level.
    """
    assert [item.name for item in load(tmp_path, PLATE).integrals] == ["momentum of phi"]
    found = [item.name for item in load(tmp_path, CARRIED).integrals if item.kind != "unit vectors"]
    assert found == ["momentum of s"]


KOVALEVSKAYA = """
mbsym: 1
name: Kovalevskaya's top
parameters: {{C: positive, k: positive, m: positive, g: positive, x0: positive}}
bodies:
  - name: body
    attached to: 0
    rotation: {{axes: [3, 1, 3], angles: [psi, theta, phi]}}
    mass centre: [x0, 0, 0]
    mass: m
    inertia about: joint
    inertia: [{k}*C, {k}*C, C]
    speeds: {{p: omega1, q: omega2, r: omega3}}
    orientation: {{gamma: 3}}
loads:
  - uniform gravity: {{vector: [0, 0, -g]}}
abbreviations: {{nu: m*g*x0/C}}
claims:
  - {{claim: first integral, equals: "(p**2 - q**2 {sign} nu*gamma1)**2 + (2*p*q {sign} nu*gamma2)**2"}}
"""


@pytest.mark.parametrize(
    ("k", "sign", "outcome"),
    [("2", "-", Outcome.EXACT), ("2", "+", Outcome.FAILS), ("k", "-", Outcome.FAILS)],
)
def test_kovalevskayas_integral(tmp_path, k, sign, outcome):
    """With xi = (p + i q)^2 - nu (gamma1 + i gamma2):  xi' = -i r xi  for A = B = 2 C, by hand."""
    found = load(tmp_path, KOVALEVSKAYA.format(k=k, sign=sign))
    (claim,) = found.claims
    assert claim.outcome == outcome
    assert (claim.difference is None) == (outcome == Outcome.EXACT)


CLAIMS = """
claims:
  - {claim: equation of motion, of: p, equals: 2*m*(A*p_dot + (C - B)*q*r + q*l3 - r*l2 - m*g*(gamma2*z0 - gamma3*y0))}
  - {claim: equation of motion, of: p, equals: A*p_dot + (C - B)*q*r + q*l3 - r*l2 + m*g*(gamma2*z0 - gamma3*y0)}
  - {claim: equation of motion, of: gamma3, equals: gamma3_dot - q*gamma1 + p*gamma2}
  - {claim: equation of motion, of: gamma3, equals: gamma3_dot + q*gamma1 - p*gamma2}
  - {claim: kinetic energy, equals: A*p**2/2 + B*q**2/2 + C*r**2/2
      + (l1*p + l2*q + l3*r)*(gamma1**2 + gamma2**2 + gamma3**2)}
  - {claim: kinetic energy, equals: A*p**2/2 + B*q**2/2 + C*r**2/2}
  - {claim: lagrangian, equals: A*p**2/2 + B*q**2/2 + C*r**2/2 + l1*p + l2*q + l3*r
      - m*g*(x0*gamma1 + y0*gamma2 + z0*gamma3) + p}
  - {claim: mass matrix, entry: [q, q], equals: B}
  - {claim: mass matrix, entry: [q, r], equals: B}
  - {claim: angular velocity, of: body, component: 2, equals: q}
  - {claim: direction cosine, of: body, entry: [1, 3], equals: gamma1}
  - {claim: first integral, equals: gamma1**2 + gamma2**2 + gamma3**2}
  - {claim: first integral, equals: gamma1**2 + gamma2**2}
  - {claim: first integral, equals: p*(gamma1**2 + gamma2**2 + gamma3**2 - 1) + A}
"""
OUTCOMES = [
    Outcome.FACTOR,
    Outcome.DIFFERS,
    Outcome.EXACT,
    Outcome.DIFFERS,
    Outcome.EXACT,
    Outcome.DIFFERS,
    Outcome.DIFFERS,
    Outcome.EXACT,
    Outcome.DIFFERS,
    Outcome.EXACT,
    Outcome.EXACT,
    Outcome.EXACT,
    Outcome.FAILS,
    Outcome.FAILS,
]


def test_claims_hold_and_fail_as_they_should(tmp_path):
    """A Lagrangian that differs by p is another one: p is no derivative of a coordinate, and dp/dt no total rate."""
    found = load(tmp_path, GYROSTAT.format(told=POISSON) + CLAIMS)
    assert [claim.outcome for claim in found.claims] == OUTCOMES
    assert found.claims[-1].remark == "it is a constant, whatever the motion"


def test_lagranges_top_keeps_its_spin(tmp_path):
    top = GYROSTAT.format(told=POISSON).replace("[x0, y0, z0]", "[0, 0, z0]").replace("[A, B, C]", "[A, A, C]")
    found = load(tmp_path, top.replace("    gyrostatic moment: [l1, l2, l3]\n", ""))
    names = [item.name for item in found.integrals]
    assert names == ["generalised energy", "angular momentum about axis 3", "dT/dr", "length of gamma"]
    assert [found.integrals[2].formula] == expected(found, ["C*r"])


TILTED = """
mbsym: 1
name: ball
parameters: {m: positive, J: positive, al: real}
bodies:
  - {name: frame, attached to: 0, mass: 0, rotation: {axes: [3], angles: [al]}}
  - {name: ball, attached to: frame, connection point: [x, 2*y, 0], rotation: {axes: [3, 1, 3], angles: [a, b, c]},
     coordinates: [x, y, a, b, c], orientation: {e: quaternion}, speeds: {p: omega1, q: omega2, s: omega3}, mass: m,
     inertia about: mass centre, inertia: [J, J, J]}
"""


@pytest.mark.parametrize("angle", ["al", "0", "pi/3"])
def test_momenta_that_are_combinations_of_others_are_told_once(angle: str) -> None:
    """m x' cos(al) - 2 m y' sin(al) along an inertial axis follows from m x' and 4 m y'."""
    found = mbsym.loads(TILTED.replace("[al]", f'["{angle}"]'), (7,)).integrals
    assert not [one.name for one in found if one.kind == "linear momentum"]
    assert {"momentum of x", "momentum of y", "angular momentum about axis 1"} <= {one.name for one in found}
