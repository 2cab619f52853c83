"""Potentials of unit vectors: the torque e x dV/de in speeds against dV/dq in angles, and who tells which."""

from __future__ import annotations

import pytest

import mbsym
from mbsym.expressions.tree import names
from mbsym.expressions.tree import text as written
from mbsym.mechanics.loads import kinds as forces

TWO = """
mbsym: 1
name: a top on a base, each with its directions
parameters: {A: positive, B: positive, C: positive, J: positive, k1: real, k2: real, l: positive, m: positive}
bodies:
  - name: base
    attached to: 0
    rotation: {axes: [1, 2, 3], angles: [a, b, c]}
    inertia about: joint
    inertia: [A, B, C]
    mass: 1
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
  - name: top
    attached to: base
    connection point: [l, 0, 0]
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass centre: [0, l, 0]
    inertia about: mass centre
    inertia: [J, 2*J, 3*J/2]
    mass: m
    speeds: {u: omega1, v: omega2, w: omega3}
    orientation: ORIENTATION
loads:
  - force function: FORMULA
"""
VECTORS, FORMULA = "{s: 1, n: 3}", "k1*gamma1*n2**2 + k2*s1*n3*gamma3"


def described(formula: str = FORMULA, orientation: str = VECTORS) -> str:
    return TWO.replace("ORIENTATION", orientation).replace("FORMULA", formula)


def failed(text: str) -> set[str]:
    analysis = mbsym.loads(text, (1, 2, 3))
    return {check.name for check in analysis.checks if check.failed}


def test_both_routes_agree_and_the_frame_is_under_the_opposite_torque() -> None:
    assert failed(described()) == set()


def test_a_torque_of_the_other_sign_or_without_reaction_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    own = forces._torques
    for planted in (lambda *given: [one for one in own(*given) if one.body == "top"], lambda *given: own(*given)[1:]):
        with monkeypatch.context() as patch:
            patch.setattr(forces, "_torques", planted)
            assert "equations of motion" in failed(described())


def test_it_is_written_back_as_it_stood() -> None:
    system = mbsym.loads(described(), ()).system
    (load,) = system.loads
    assert written(load.written.expression) == FORMULA
    assert {"gamma1", "n2"}.isdisjoint(names(load.expression))


@pytest.mark.parametrize(
    ("formula", "orientation", "told"),
    [
        ("k1*e0", "{e: quaternion}", "'e0' is a component of a quaternion"),
        ("k1*gamma1*cos(theta)", VECTORS, "the angle 'theta' stands in a load"),
        ("k1*gamma4", VECTORS, "unknown name 'gamma4'"),
        ("k1*gamma1_dot", VECTORS, "unknown name 'gamma1_dot'"),
    ],
)
def test_what_no_potential_holds_is_refused(formula: str, orientation: str, told: str) -> None:
    with pytest.raises(mbsym.DescriptionError, match=told):
        mbsym.loads(described(formula, orientation), ())
