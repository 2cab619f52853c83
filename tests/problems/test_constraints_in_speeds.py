"""Every kind of constraint in speeds: rows against places in inertial axes, embedded equations against multipliers."""

from __future__ import annotations

from math import cosh, tanh

import pytest
from conftest import analysed
from kinds_of_constraints import BODIES, KINDS

import mbsym
from mbsym.analysis.pipeline import Analysis
from mbsym.problems.checks import EXACT, NUMERICAL

#: Without multipliers their equations outgrow the budget, and nobody has them to check.
LONG = {"parallel"}

ARM = "connection point: [1, 0, 0],\n     inertia about: joint, inertia: [A, A, A]}"
WHEEL = "angles: [phi]}, inertia about: joint,\n     inertia: [A, A, A]}"


def in_speeds(kind: str, orientation: str) -> Analysis:
    assert ARM in BODIES
    assert WHEEL in BODIES
    arm = ARM[:-1] + f", speeds: {{p: omega1, q: omega2, n: omega3}}, orientation: {orientation}}}"
    wheel = WHEEL[:-1] + ", speeds: {k: omega1, w: omega3, h: x_dot + y*phi_dot}}"
    text = BODIES.replace(ARM, arm).replace(WHEEL, wheel) + f"  - {KINDS[kind]}\n"
    return analysed(text, (3,))


@pytest.mark.parametrize("orientation", ["angles", "direction cosines"])
@pytest.mark.parametrize("kind", KINDS)
def test_rows_and_equations_agree_with_the_oracle(kind: str, orientation: str) -> None:
    found = in_speeds(kind, orientation)
    found.stage(3)
    rows = found.check("constraints")
    assert rows is not None, found.stage(3).failure
    assert rows.outcome in (EXACT, NUMERICAL), rows
    if kind == "distance":  # the second check takes ten seconds of enclosures
        return
    motion = found.check("constrained motion")
    assert (motion is None) == (kind in LONG)
    assert motion is None or motion.outcome in (EXACT, NUMERICAL), motion
    assert not found.defects


#: Suslov's problem: a body about a fixed point that does not turn about an axis in itself.
SUSLOV = """mbsym: 1
name: Suslov
parameters: {A: positive, B: positive, C: positive, D: positive, E: real}
bodies:
  - {name: body, attached to: 0, rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}, mass: 1, inertia about: joint,
     inertia: [[A, 0, D], [0, B, E], [D, E, C]], speeds: {p: omega1, q: omega2, r: omega3},
     orientation: {e: quaternion}}
constraints: [velocity: CONSTRAINT]
"""


@pytest.mark.parametrize("constraint", ["r = 0", "2*r = 0", "phi_dot + psi_dot*cos(theta) = 0"])
def test_suslov_s_equations_from_a_constraint_in_speeds(constraint):
    """A p' = -D p q - E q^2,  B q' = D p^2 + E p q:  of velocities the same is read as speeds."""
    text = SUSLOV.replace("CONSTRAINT", constraint)
    if "dot" in constraint:
        text = text.replace(",\n     orientation: {e: quaternion}", "")
    found = mbsym.loads(text, (3,)).equations.embedded
    assert found.free == ("p", "q")
    assert [str(x) for x in found.forcing] == ["-D*p*q - E*q**2", "D*p**2 + E*p*q"]
    assert [[str(x) for x in row] for row in found.mass_matrix.rows] == [["A", "0"], ["0", "B"]]


def test_suslov_s_body_turns_over_as_in_closed_form():
    """With E = 0:  q = w tanh(k t + c), k = D w/A, A p^2 + B q^2 = B w^2, from rest far behind to rest far ahead."""
    a, b, d, w, c = 1.0, 2.0, 1 / 3, 1.5, -4.0
    k, time = d * w / a, 16.0
    start = {"p": (b / a) ** 0.5 * w / cosh(c), "q": w * tanh(c)}
    values = "values: {A: 1, B: 2, C: 5/2, D: 1/3, E: 0}\n"
    initial = f"initial: {{p: {start['p']!r}, q: {start['q']!r}, r: 0, psi: 0, theta: 1, phi: 0}}\n"
    run = mbsym.simulate(
        mbsym.loads(SUSLOV.replace("CONSTRAINT", "r = 0") + values + initial), time=time, tolerance=1e-11
    )
    assert run["q"][-1] == pytest.approx(w * tanh(k * time + c), abs=1e-9)
    assert run["p"][-1] == pytest.approx((b / a) ** 0.5 * w / cosh(k * time + c), abs=1e-9)
    assert run["r"][-1] == pytest.approx(0, abs=1e-14)
