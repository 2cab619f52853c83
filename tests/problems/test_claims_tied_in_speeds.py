"""Claims in declared speeds beside constraints, decided along the motion.

By hand.  A homogeneous ball that rolls on a table without loads but gravity keeps its angular velocity in space, and
omega x omega = 0 keeps its components in the ball, so that p' = q' = s' = 0 (Neimark & Fufaev, chapter I).  The centre
has the velocity omega x r e3 = (r w_y, -r w_x), w_y = omega . beta, w_x = omega . alpha, and T = m v^2/2 + J omega^2/2.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import mbsym
from mbsym.problems.claims import ClaimResult, Outcome

BALL = (Path(__file__).parents[2] / "systems" / "rolling-sphere-speeds.yaml").read_text(encoding="utf-8")
OMEGA_X, OMEGA_Y = (f"(p*{e}1 + q*{e}2 + s*{e}3)" for e in ("alpha", "beta"))
STATE = "psi: 0.2, psi_dot: 1, theta: 1, theta_dot: 0, phi: 0, phi_dot: 0, x_dot: 0, y_dot: 0"


def judged(*claims: str) -> list[ClaimResult]:
    analysis = mbsym.loads(BALL + "\nclaims:\n" + "".join(f"  - {{claim: {one}}}\n" for one in claims))
    found = list(analysis.claims)
    assert not analysis.defects
    return found


@pytest.mark.parametrize(
    ("claim", "outcome"),
    [
        (f"first integral, equals: m*r*{OMEGA_Y}", Outcome.EXACT),
        (f"first integral, equals: m*r*{OMEGA_Y} + x", Outcome.FAILS),
        ("first integral, equals: p**2 + q**2 + s**2", Outcome.EXACT),
        (
            "first integral, equals: alpha1*beta1 + alpha2*beta2 + alpha3*beta3",
            Outcome.EXACT,
        ),  # it is known beforehand
        ("first integral, equals: alpha1", Outcome.FAILS),
        ("equation of motion, of: p, equals: p_dot", Outcome.EXACT),
        ("equation of motion, of: p, equals: J*p_dot + m*r*q", Outcome.FAILS),
        (
            "equation of motion, of: alpha1, equals: alpha1_dot - (alpha2*s - alpha3*q)",
            Outcome.EXACT,
        ),  # e' = e x omega
        ("equation of motion, of: alpha1, equals: alpha1_dot + (alpha2*s - alpha3*q)", Outcome.FAILS),
        ("acceleration, of: p, equals: 0", Outcome.EXACT),
        ("acceleration, of: q, equals: p*s", Outcome.FAILS),
        (f"acceleration, of: x, equals: r*0*{OMEGA_Y}", Outcome.EXACT),
    ],
)
def test_a_claim_is_decided_along_the_motion(claim: str, outcome: str) -> None:
    (result,) = judged(claim)
    assert result.outcome == outcome, result.remark
    assert (result.counterexample is not None) == (outcome == Outcome.FAILS and not claim.endswith("alpha1"))


def test_quantities_hold_where_the_constraints_do() -> None:
    energy = f"m*r**2*({OMEGA_X}**2 + {OMEGA_Y}**2)/2 + J*(p**2 + q**2 + s**2)/2"
    right, wrong, mass = judged(
        f"kinetic energy, equals: {energy}",
        f"kinetic energy, equals: {energy.replace('r**2', 'r')}",
        "mass matrix, entry: [p, p], equals: J",
    )
    assert [right.holds, wrong.refuted, mass.outcome] == [True, True, Outcome.EXACT]
    assert right.remark


def test_a_number_of_the_ball() -> None:
    """It spins on its point of contact, about the vertical: q does not change."""
    right, wrong = judged(
        f"value, of: q_dot, state: {{{STATE}}}, equals: 0.0",
        f"value, of: q_dot, state: {{{STATE}}}, equals: 0.5",
    )
    assert right.outcome == Outcome.DIGITS
    assert wrong.refuted
