"""Whether positions in which constraints are singular are real ones is told: they are solved for exactly.

A curve f(x, y) = 0 is singular where grad f = 0 on it: y^2 = (x - 1)^3 at its cusp (1, 0); y^2 = (x^2 + 1)^2,
two parabolas that do not meet, at (i, 0) and (-i, 0) only; y^2 = (x^2 - 1)^2 at (1, 0) and (-1, 0).
"""

from __future__ import annotations

import pytest

import mbsym

POINT = """
mbsym: 1
name: point on a curve
bodies: [{name: p, mass: 1, connection point: [x, y, 0], coordinates: [x, y]}]
loads: [{uniform gravity: {vector: [10, 0, 0]}}, {spring: {coordinate: x, stiffness: 1}},
  {spring: {coordinate: y, stiffness: 1}}]
constraints: [{relation: y**2 = CURVE}]
"""
REAL = "there are positions in which the constraints are singular"


@pytest.mark.parametrize(("curve", "real"), [("(x - 1)**3", True), ("(x**2 + 1)**2", False), ("(x**2 - 1)**2", True)])
def test_only_real_ones_are_said_to_be_there(curve: str, real: bool) -> None:
    remarks = " ".join(map(str, mbsym.equilibria(mbsym.loads(POINT.replace("CURVE", curve))).remarks))
    assert (REAL in remarks) is real
    assert "perhaps" not in remarks
