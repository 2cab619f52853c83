"""The free body about its axes, A < B < C, in all twelve rotation sequences: the same verdicts.

Euler: A p' = (B - C) q r and its like.  About the axis k at the rate W, with moments I_i, I_j about the others, a
deviation obeys  I_i I_j p_i'' + (I_k - I_i)(I_k - I_j) W^2 p_i = 0: unstable about the middle axis; about the others
stable by energy and the square of the angular momentum (Chetaev), or by energy alone at constant momenta (largest axis,
Routh).  A body that is turned in space spins on: the angular momentum may lie anywhere, which gives lambda^2 + W^2.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from conftest import STATEMENTS

import mbsym
from mbsym.analysis import Analysis
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.words import Because, Word

SEQUENCES = [axes for axes in product((1, 2, 3), repeat=3) if axes[0] != axes[1] != axes[2]]
MOMENTS = {1: Fraction(1), 2: Fraction(2), 3: Fraction(3)}
TRUTH = {1: Word.STABLE_BUT_CYCLIC, 2: Word.UNSTABLE, 3: Word.STABLE_BUT_CYCLIC}
RATE = Fraction(5)


def body(axes: tuple[int, ...], motion: str, speeds: bool = False) -> Analysis:
    own = ", speeds: {p: omega1, q: omega2, r: omega3}" if speeds else ""
    return mbsym.loads(f"""
mbsym: 1
name: Free body
parameters: {{A: {{positive: true, value: 1}}, B: {{positive: true, value: 2}}, C: {{positive: true, value: 3}},
  W: {{positive: true, value: 5}}}}
assumptions: [B > A, C > B]
bodies:
  - {{name: box, attached to: 0, rotation: {{axes: {list(axes)}, angles: [q1, q2, q3]}}, mass: 1,
     inertia about: mass centre, inertia: [A, B, C]{own}}}
motion: {motion}
""")


def spins() -> list[tuple[tuple[int, ...], int, str]]:
    """Of every sequence the steady spins, their body axis: one of its axes with the other angles zero; the first turn
    with the second one by pi/2, if first and third axis are one: about the axis that does not occur, or the second."""
    found = []
    for axes in SEQUENCES:
        for place, axis in enumerate(axes):
            found.append((axes, axis, f"{{q{place + 1}: {{value: 0, rate: W}}}}"))
        if axes[0] == axes[2]:
            # R = R_i(W t) R_j(pi/2): body axis R_j(-pi/2) e_i, which is the third one, up to its sign
            (third,) = {1, 2, 3} - {*axes}
            found.append((axes, third, "{q1: {value: 0, rate: W}, q2: pi/2}"))
    return found


def charpoly(parts: tuple[SubsystemStability, ...]) -> list[Fraction]:
    """Coefficients of the determinant at the values, from low powers to high ones, the highest 1."""
    whole = [Fraction(1)]
    for part in parts:
        whole = times(whole, [Fraction(str(x.subs({"A": 1, "B": 2, "C": 3, "W": 5}))) for x in part.characteristic])
    return [x / whole[-1] for x in whole]


def times(p: list[Fraction], q: list[Fraction]) -> list[Fraction]:
    return [
        sum((p[k] * q[n - k] for k in range(len(p)) if 0 <= n - k < len(q)), Fraction(0))
        for n in range(len(p) + len(q) - 1)
    ]


@pytest.mark.parametrize("speeds", [False, True])
@pytest.mark.parametrize(("axes", "axis", "motion"), spins())
def test_the_verdict_is_that_of_the_axis(axes: tuple[int, ...], axis: int, motion: str, speeds: bool) -> None:
    found = body(axes, motion, speeds).stability
    i, j = (MOMENTS[k] for k in MOMENTS if k != axis)
    own = MOMENTS[axis]
    zero, one = Fraction(0), Fraction(1)
    euler = [(own - i) * (own - j) * RATE**2 / (i * j), zero, one]
    assert charpoly(found.subsystems) == times([zero, zero, one], times([RATE**2, zero, one], euler))
    assert found.numerical is not None
    assert found.numerical.word is TRUTH[axis]
    assert found.verdict.word in ({Word.UNSTABLE} if axis == 2 else {Word.STABLE_BUT_CYCLIC, Word.GYROSCOPIC})


def test_angles_that_are_not_those_of_the_description_are_told() -> None:
    found = mbsym.load(STATEMENTS / "racket-no-result-in-this-rotation-order.yaml").stability
    assert found.verdict.because(Because.OTHER_ANGLES)
    assert "about axes 2, 1, 3 by q2, q1, q3" in found.verdict.explanation
    assert not body((2, 1, 3), "{q1: {value: 0, rate: W}}").stability.verdict.because(Because.OTHER_ANGLES)


def test_a_load_that_knows_an_angle_keeps_the_sequence() -> None:
    """A spring on q1 acts in q1 of this sequence alone: in no other does the same stand, and nothing is claimed."""
    text = """
mbsym: 1
name: Body with a spring
parameters: {A: positive, B: positive, C: positive, W: positive, k: positive}
bodies:
  - {name: box, attached to: 0, rotation: {axes: [1, 2, 3], angles: [q1, q2, q3]}, mass: 1,
     inertia about: mass centre, inertia: [A, B, C]}
loads: [{spring: {coordinate: q1, stiffness: k}}]
motion: {q2: {value: 0, rate: W}}
"""
    assert mbsym.loads(text).optional("stability") is None
