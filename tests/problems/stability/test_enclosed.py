"""Verdicts by enclosures: what a ball leaves open is not claimed."""

from __future__ import annotations

from typing import Any

from flint import arb

from mbsym.problems.stability.enclosed import enclosed_verdict
from mbsym.problems.stability.word import Word

NOTHING = [[arb(0), arb(0)], [arb(0), arb(0)]]
UNIT = [[arb(1), arb(0)], [arb(0), arb(1)]]


def diagonal(*values: Any) -> list[list[arb]]:
    return [[arb(values[i]) if i == j else arb(0) for j in range(2)] for i in range(2)]


def spinning(rate: Any) -> list[list[arb]]:
    return [[arb(0), arb(rate)], [-arb(rate), arb(0)]]


def test_gyroscopic_only_where_stiffness_is_certainly_not_positive() -> None:
    """K = -1 twice and G = 3: (s^2 - 1)^2 + 9 s^2 has four imaginary roots."""
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(-1, -1), NOTHING], True)
    assert found.word is Word.GYROSCOPIC
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(1, 2), NOTHING], True)
    assert (found.word, found.theorem) == (Word.STABLE, "Routh")
    # One of the two, but the ball does not tell which: a frequency near 0.
    wide = arb(0, 1e-30)
    found = enclosed_verdict([UNIT, NOTHING, spinning(3), diagonal(1, wide), NOTHING], True)
    assert found.word is Word.UNDECIDED


def test_partial_damping() -> None:
    """K = 2 twice and a dashpot on the first coordinate: the second swings for ever."""
    parts = [UNIT, diagonal(1, 0), NOTHING, diagonal(2, 2), NOTHING]
    found = enclosed_verdict(parts, True)
    assert (found.word, found.theorem) == (Word.STABLE, "Lagrange-Dirichlet")
    assert enclosed_verdict(parts, False).word is Word.UNDECIDED
    negative = [UNIT, diagonal(-1, 0), NOTHING, diagonal(2, 2), NOTHING]
    assert enclosed_verdict(negative, False).word is Word.UNSTABLE
