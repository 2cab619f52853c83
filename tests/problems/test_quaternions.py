"""Bodies whose orientation is a quaternion: equations, integrals, first approximation against derivations by hand."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.analysis import Analysis
from mbsym.mechanics import frames as quaternions
from mbsym.problems.checks import EXACT, FAILED
from mbsym.source import to_text, to_yaml

ORBIT = (SHIPPED / "gravity-gradient-quaternion.yaml").read_text(encoding="utf-8")

TOP = """
mbsym: 1
name: Heavy rigid body about a fixed point
parameters: {A: positive, B: positive, C: positive, m: positive, g: positive, x0: real, y0: real, z0: real}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [x0, y0, z0]
    mass: m
    inertia about: joint
    inertia: [A, B, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: quaternion
loads:
  - uniform gravity: {vector: [0, 0, -g]}
claims:
  - {claim: equation of motion, of: p, equals: A*p_dot + (C - B)*q*r - m*g*(z0*(2*(e2*e3 + e0*e1)) - y0*(1 - 2*e1**2
      - 2*e2**2)), place: right}
  - {claim: equation of motion, of: e0, equals: 2*e0_dot + e1*p + e2*q + e3*r, place: right}
  - {claim: direction cosine, of: body, entry: [1, 2], equals: 2*(e1*e2 + e0*e3), place: right}
  - {claim: first integral, equals: "A*p*2*(e1*e3 - e0*e2) + B*q*2*(e2*e3 + e0*e1) + C*r*(1 - 2*e1**2 - 2*e2**2)",
      place: right}
  - {claim: first integral, equals: "A*p*2*(e1*e3 - e0*e2) + B*q*2*(e2*e3 + e0*e1) + C*r*(1 - 2*e1**2 - e2**2)",
      place: wrong}
  - {claim: equation of motion, of: e0, equals: 2*e0_dot + e1*p + e2*q - e3*r, place: wrong}
  - {claim: direction cosine, of: body, entry: [2, 1], equals: 2*(e1*e2 + e0*e3), place: wrong}
"""


@pytest.fixture(scope="module")
def top() -> Analysis:
    return mbsym.loads(TOP)


def test_a_claim_holds_where_the_norm_is_one(top: Analysis) -> None:
    """With gamma3 = 1 - 2 e1^2 - 2 e2^2 as with e0^2 - e1^2 - e2^2 + e3^2; and a transposed matrix does not."""
    assert {(claim.claim.place, bool(claim.holds)) for claim in top.claims} == {("right", True), ("wrong", False)}


def test_integrals_and_checks(top: Analysis) -> None:
    assert [x.name for x in top.integrals] == ["generalised energy", "angular momentum about axis 3", "norm of e"]
    assert {check.outcome for check in top.checks} == {EXACT}


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("rates", lambda algebra, e, w: _RATES(algebra, [e[0], *(-x for x in e[1:])], w)),
        ("cosines", lambda algebra, e: [list(row) for row in zip(*_COSINES(algebra, e), strict=True)]),
    ],
)
def test_a_planted_mistake_is_found(name: str, wrong: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """The conjugate in place of the quaternion, in the kinematic equations or in the direction cosines."""
    monkeypatch.setattr(quaternions, name, wrong)
    assert FAILED in {check.outcome for check in mbsym.loads(TOP).checks}


_RATES, _COSINES = quaternions.rates, quaternions.cosines


def test_the_first_approximation_has_one_root_that_belongs_to_no_motion() -> None:
    """Pitch of the satellite about its relative equilibrium: lambda^2 = -3 omega0^2 (A - B)/C (Beletskii)."""
    analysis = mbsym.loads(ORBIT)
    found = analysis.first_order
    assert found.names == ("e0", "e1", "e2", "e3", "p", "q", "r")
    assert [str(x) for x in found.values] == ["1", "0", "0", "0", "0", "0", "-omega0"]
    assert (found.relations, found.norms) == (1, 1)
    numbers = {"omega0": 0.001, "nu": 3.43e14, "R": 7e6, "A": 12.0, "B": 9.0, "C": 15.0}
    matrix = np.array([[eval_at(str(x), numbers) for x in row] for row in found.A])
    roots = sorted(np.linalg.eigvals(matrix * 1000), key=abs)
    assert abs(roots[0]) < 1e-9  # of the norm
    assert min(abs(x - 1j * math.sqrt(3 * (12 - 9) / 15)) for x in roots) < 1e-9
    assert analysis.check("first approximation in speeds").outcome == EXACT


def eval_at(text: str, numbers: dict[str, float]) -> float:
    return float(eval(text, {"__builtins__": {}}, numbers))


def test_a_motion_at_right_angles() -> None:
    """Turned by pi/2 about axis 2, then about the new axis 1: (1 + j)(1 + i)/2 = (1 + i + j - k)/2."""
    text = ORBIT.replace("motion: {psi: 0, theta: 0, phi: 0}", "motion: {psi: pi/2, theta: 0, phi: pi/2}")
    analysis = mbsym.loads(text)
    assert [str(x) for x in analysis.first_order.values[:4]] == ["1/2", "1/2", "1/2", "-1/2"]
    assert analysis.check("first approximation in speeds").outcome == EXACT


def test_relations_hold_body_by_body() -> None:
    """Unit vectors of different bodies have no angles that are kept."""
    body = """
  - {{name: {0}, attached to: {1}, rotation: {{axes: [3, 1, 3], angles: [a{0}, b{0}, c{0}]}}, mass: m,
     connection point: [l, 0, 0], inertia about: joint, inertia: [J, J, J],
     speeds: {{p{0}: omega1, q{0}: omega2, r{0}: omega3}}, orientation: {{g{0}: 3}}}}"""
    text = "mbsym: 1\nname: Two\nparameters: {m: positive, J: positive, l: positive, k: positive}\nbodies:"
    analysis = mbsym.loads(text + body.format("x", "0") + body.format("y", "x"))
    owners = {name: name[-1] for name, _ in analysis.equations.vectors if name[0] == "g"}
    pairs = {(pair[0][0][:2], pair[0][1][:2]) for pair in analysis.equations.relations}
    assert not [pair for pair in pairs if pair in {("gx", "gy"), ("gy", "gx")}]
    assert set(owners.values()) <= {"x", "y"}


def test_it_is_written_as_it_was_read(top: Analysis) -> None:
    for spelled in (to_yaml(top.system), to_text(top.system)):
        assert mbsym.loads(spelled).system.bodies[0].orientation == top.system.bodies[0].orientation


def test_a_body_that_moves_and_turns_keeps_its_places_beside_its_quaternion() -> None:
    """Newton's equations of the mass centre, which is the origin of the joint, beside Euler's."""
    analysis = mbsym.loads("""
mbsym: 1
name: Free body in space
parameters: {A: positive, B: positive, C: positive, m: positive, g: positive}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    connection point: [x, y, z]
    coordinates: [x, y, z, psi, theta, phi]
    mass: m
    inertia about: mass centre
    inertia: [A, B, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: quaternion
loads:
  - uniform gravity: {vector: [0, 0, -g]}
claims:
  - {claim: equation of motion, of: p, equals: A*p_dot + (C - B)*q*r}
  - {claim: equation of motion, of: z, equals: m*(z_ddot + g)}
""")
    assert analysis.equations.positions == ("x", "y", "z", "e0", "e1", "e2", "e3")
    assert analysis.equations.speeds == ("p", "q", "r", "x_dot", "y_dot", "z_dot")
    assert set(analysis.equations.aside) >= {"e0", "e1", "e2", "e3"}
    assert {check.outcome for check in analysis.checks} == {EXACT}
    assert all(claim.holds for claim in analysis.claims)


def test_what_is_known_beforehand_and_what_cannot_be_decided() -> None:
    """The norm is no integral of the motion's own; three squares are none at all; behind a root of e nothing is said
    to differ that may vanish where |e| = 1.
    """
    more = "claims:\n  - {claim: first integral, equals: e0**2 + e1**2 + e2**2 + e3**2, place: norm}"
    more += "\n  - {claim: first integral, equals: e0**2 + e1**2 + e2**2, place: part}"
    claims = {claim.claim.place: claim for claim in mbsym.loads(ORBIT.replace("claims:", more), (3,)).claims}
    assert claims["norm"].remark == "of the quaternion alone: it is known beforehand"
    assert claims["part"].holds is False
    far = mbsym.loads(ORBIT.replace("order: 2", "order: exact"), (3,))
    outcomes = {claim.claim.place: claim.outcome for claim in far.claims}
    assert "differs" not in " ".join(outcomes.values())
    assert {check.outcome for check in far.checks} == {EXACT}
