"""Angles that become multiples of pi, or arc tangents, only when the motion is put in: w x at x = 3 pi/(2 w).

A bead on the street y = A sin(w x) rests where cos(w x) = 0; K = m g A w^2 in the valleys, -m g A w^2 on the hills.
"""

from __future__ import annotations

import pytest
from conftest import TESTS

import mbsym

TEXT = (TESTS / "cases" / "statements" / "cos-3pi-2-as-condition.yaml").read_text()


@pytest.mark.parametrize(
    ("place", "word"),
    [
        ("3*pi/(2*w)", "stable"),
        ("-pi/(2*w)", "stable"),
        ("7*pi/(2*w)", "stable"),
        ("pi/(2*w)", "unstable"),
        ("(pi/2 + 2*pi)/w", "unstable"),
        ("(3*pi/w - pi/w)/4", "unstable"),
    ],
)
def test_a_bead_rests_in_valleys_and_on_hills(place: str, word: str) -> None:
    found = mbsym.loads(TEXT.replace("motion: {x: 3*pi/(2*w)}", f"motion: {{x: {place}}}"))
    assert found.equilibrium.satisfied
    assert found.stability.verdict.word == word
    assert not any(check.failed for check in found.checks)


@pytest.mark.parametrize("place", ["pi/(3*w)", "0", "pi/w", "atan(A)/w", "pi/(7*w)", "1/w"])
def test_it_rests_nowhere_else(place: str) -> None:
    """cos = 1/2, 1, -1, 1/sqrt(1 + A^2), cos(pi/7) > 0, cos(1) > 0: the condition is impossible, and not left open."""
    found = mbsym.loads(TEXT.replace("motion: {x: 3*pi/(2*w)}", f"motion: {{x: {place}}}"))
    assert not found.equilibrium.satisfied
    assert found.equilibrium.impossible
