"""A cyclic coordinate, and all coordinates damped: D > 0, so that K of the others decides and no Hurwitz minor does.

By hand: v*.(lambda^2 M + lambda (D + G) + K).v = 0 has no solution with Re lambda >= 0 but lambda = 0 if K >= 0.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvals

import mbsym
from mbsym.problems.stability.words import Word

TEXT = """
mbsym: 1
name: Two pendulums in a row on a cart
parameters: {M: positive, m: positive, l: positive, g: positive, c: SIGN, b: positive, k: STIFFNESS}
bodies:
  - {name: cart, connection point: [x, 0, 0], mass: M, coordinates: [x]}
  - {name: upper, attached to: cart, rotation: {axes: [3], angles: [u]}, mass centre: [0, -l, 0], mass: m}
  - name: lower
    attached to: upper
    rotation: {axes: [3], angles: [v - u]}
    connection point: [0, -l, 0]
    mass centre: [0, -l, 0]
    mass: m
    coordinates: [v]
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: x, coefficient: c}
  - rayleigh: DISSIPATION
  - spring: {coordinate: u, stiffness: k, rest: 0}
motion: {x: 0, u: 0, v: 0}
"""

BOTH = "b*u_dot**2/2 + b*(v_dot - u_dot)**2/2"


def cart(sign: str = "positive", stiffness: str = "positive", dissipation: str = BOTH) -> mbsym.Analysis:
    return mbsym.loads(system_text(sign, stiffness, dissipation))


def system_text(sign: str, stiffness: str, dissipation: str) -> str:
    return TEXT.replace("SIGN", sign).replace("STIFFNESS", stiffness).replace("DISSIPATION", dissipation)


def test_complete_dissipation_decides_without_conditions() -> None:
    assert cart().stability.verdict.word is Word.ASYMPTOTIC_BUT_CYCLIC


@pytest.mark.parametrize(
    ("sign", "dissipation"), [("nonnegative", BOTH), ("positive", "b*(v_dot - u_dot)**2/2"), ("negative", BOTH)]
)
def test_what_is_not_damped_everywhere_is_not_decided_so(sign: str, dissipation: str) -> None:
    """c = 0 leaves the cart running on; only the lower joint damped: D is singular; c < 0 drives the cart away."""
    assert cart(sign, dissipation=dissipation).stability.verdict.word is not Word.ASYMPTOTIC_BUT_CYCLIC


def test_where_stiffness_is_negative_it_is_unstable_and_nothing_is_claimed_on_the_border() -> None:
    """K = diag(0, 2 m l g + k, m l g): at k = -2 m l g terms of higher order, -u^4/12, turn the pendulum over."""
    assert cart(stiffness="real").stability.verdict.word is Word.DEPENDS
    words = {}
    for k in (-1, -2, -3):
        values = f"values: {{M: 2, m: 1, l: 1, g: 1, c: 1, b: 1, k: {k}}}"
        stability = mbsym.loads(system_text("positive", "real", BOTH) + values).stability
        assert stability.numerical is not None
        words[k] = stability.numerical.word
    assert words[-1] is Word.ASYMPTOTIC_BUT_CYCLIC
    assert words[-2] in (Word.UNSTABLE, Word.UNDECIDED)
    assert words[-3] is Word.UNSTABLE


def test_random_dampers_agree_with_the_roots() -> None:
    """The roots of pencils with D > 0, G, K = diag(0, K'): as many to the right as K' has negative eigenvalues."""
    generator = np.random.default_rng(5)
    for _ in range(50):
        m, d, h = (generator.normal(size=(4, 4)) for _ in range(3))
        mass, damping, gyroscopic = m @ m.T + np.eye(4), d @ d.T + np.eye(4) / 2, h - h.T
        k = generator.normal(size=(3, 3))
        stiffness = np.zeros((4, 4))
        stiffness[1:, 1:] = k + k.T
        inverse = np.linalg.inv(mass)
        state = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ stiffness, -inverse @ (damping + gyroscopic)]])
        roots = eigvals(state)
        assert np.sum(roots.real > 1e-9) == np.sum(np.linalg.eigvalsh(stiffness) < 0)
        assert np.sum(abs(roots) < 1e-9) == 1
