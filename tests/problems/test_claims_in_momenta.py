"""Claims about H, momenta, Routh's function and about B, A, C, D: textbook formulas hold, planted mistakes do not."""

from __future__ import annotations

import pytest
from conftest import SHIPPED
from test_canonical_checks import TOP

import mbsym
from mbsym import DescriptionError
from mbsym.problems.claims import ClaimResult, Outcome
from mbsym.source.yaml_writer import to_yaml

POLE = (SHIPPED / "cart-pole.yaml").read_text()


def judged(text: str, *claims: str) -> list[ClaimResult]:
    head = text.split("\nclaims:")[0]
    return list(mbsym.loads(head + "\nclaims:\n" + "".join(f"  - {{{claim}}}\n" for claim in claims)).claims)


WHOLE = "p_theta**2/(2*A) + (p_psi - p_phi*cos(theta))**2/(2*A*sin(theta)**2) + p_phi**2/(2*C) + m*g*l*cos(theta)"
POTENTIAL = WHOLE.split(" + ", 1)[1]


def test_lagranges_top() -> None:
    """Goldstein, 5.7; Landau & Lifshitz, section 35."""
    found = judged(
        TOP,
        f'claim: hamiltonian, equals: "{WHOLE}"',
        f'claim: hamiltonian, equals: "{WHOLE.replace("+ m*g", "- m*g")}"',
        'claim: momentum, of: phi, equals: "C*(phi_dot + psi_dot*cos(theta))"',
        'claim: momentum, of: phi, equals: "C*(phi_dot - psi_dot*cos(theta))"',
        f'claim: reduced potential, equals: "{POTENTIAL}"',
        f'claim: reduced potential, equals: "{POTENTIAL.replace("(2*C)", "C")}"',
        f'claim: routh function, equals: "A*theta_dot**2/2 - ({POTENTIAL})"',
        f'claim: routh function, equals: "A*theta_dot**2 - ({POTENTIAL})"',
        'claim: first integral, equals: "p_psi"',
        'claim: first integral, equals: "p_psi*p_phi - p_phi**2"',
        'claim: first integral, equals: "p_theta"',
    )
    assert [one.holds for one in found] == [True, False] * 4 + [True, True, False]
    assert {one.outcome for one in found[:8:2]} == {Outcome.EXACT}
    # By hand: H claimed - H = -2 m g l cos(theta); R claimed - R = A theta'^2/2.
    assert str(found[1].difference) == "-2*m*l*g*cos(theta)"
    assert str(found[7].difference) == "A*theta_dot**2/2"


#: Astrom & Murray, Feedback Systems, example 3.2 and 5.4 (balance systems), upright, without friction.
DELTA = "(J*(M + m) + M*m*l**2)"
RIGHT = (
    "claim: linear matrix B, entry: [p, F], equals: 1",
    "claim: linear matrix B, entry: [theta, 1], equals: 0",
    f"claim: state matrix B, entry: [p_dot, F], equals: (J + m*l**2)/{DELTA}",
    f"claim: state matrix B, entry: [theta_dot, F], equals: m*l/{DELTA}",
    f"claim: state matrix A, entry: [p_dot, theta], equals: m**2*l**2*g/{DELTA}",
    f"claim: state matrix A, entry: [4, 2], equals: (M + m)*m*g*l/{DELTA}",
    "claim: state matrix A, entry: [p, p_dot], equals: 1",
)


def test_the_balance_system_of_astrom_and_murray() -> None:
    found = judged(POLE, *RIGHT)
    assert [one.outcome for one in found] == [Outcome.EXACT] * len(RIGHT), [(one.title, one.outcome) for one in found]
    wrong = judged(POLE, RIGHT[0].replace("equals: 1", "equals: -1"), RIGHT[4].replace("m**2", "m"), RIGHT[6] + "0")
    assert [one.holds for one in wrong] == [False] * 3
    assert found[2].title == "state matrix B [p_dot, F]"


@pytest.mark.parametrize(
    ("text", "claim", "words"),
    [
        (TOP, "claim: linear matrix B, entry: [psi, u], equals: 1", "the system has no inputs"),
        (POLE, "claim: state matrix C, entry: [9, p], equals: 1", "'9' is no row or column"),
        (POLE, "claim: state matrix B, entry: [p, p], equals: 1", "'p' is no row or column"),
        (TOP, "claim: kinetic energy, equals: p_theta**2/(2*A)", "'p_theta' is a momentum, and a claim about the"),
        (TOP, "claim: hamiltonian, equals: p_thta", "did you mean 'p_theta'?"),
        (TOP, "claim: hamiltonian, equals: A, state: {theta: 1}", "state"),
    ],
)
def test_complaints(text: str, claim: str, words: str) -> None:
    with pytest.raises(DescriptionError) as failure:
        judged(text, claim)
    assert words in str(failure.value)


def test_momenta_have_units() -> None:
    units = TOP.replace(
        "{A: positive, C: positive, m: positive, l: positive, g: positive}",
        """
  A: {sign: positive, unit: kg*m**2}
  C: {sign: positive, unit: kg*m**2}
  m: {sign: positive, unit: kg}
  l: {sign: positive, unit: m}
  g: {sign: positive, unit: m/s**2}""",
    )
    assert judged(units, f'claim: hamiltonian, equals: "{WHOLE}"')[0].holds
    with pytest.raises(DescriptionError, match="cannot be added"):
        judged(units, f'claim: hamiltonian, equals: "{WHOLE.replace("(2*C)", "2")}"')


def test_what_was_written_comes_back() -> None:
    """Entries by names of inputs and states survive both spellings."""
    claims = [f"  - {{{one}}}\n" for one in RIGHT]
    system = mbsym.loads(POLE.split("\nclaims:")[0] + "\nclaims:\n" + "".join(claims)).system

    assert mbsym.loads(to_yaml(system)).system.claims == system.claims
