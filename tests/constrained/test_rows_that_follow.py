"""A constraint that follows from others says nothing further: every verdict stays what it is without it.

x_dot sin(f) = y_dot cos(f) is the knife edge; the same times 1 + x^2 + y^2, which never vanishes, holds of the same
motions (Neimark & Fufaev, Dynamics of Nonholonomic Systems, chapter II).
"""

from __future__ import annotations

import pytest

import mbsym

EDGE = """
mbsym: 1
name: knife edge
parameters: {{m: positive, k: positive, c: positive, J: positive}}
bodies:
  - {{name: p, mass: m, connection point: [x, y, 0], rotation: {{axes: [3], angles: [f]}}, inertia about: joint,
     inertia: [J, J, J], coordinates: [x, y, f]}}
loads:
  - spring: {{coordinate: x, stiffness: k}}
  - spring: {{coordinate: f, stiffness: k}}
  - damper: {{coordinate: x, coefficient: c}}
  - damper: {{coordinate: f, coefficient: c}}
constraints: [{rows}]
motion: {{x: 0, y: 0, f: 0}}
values: {{m: 1, k: 3, c: 1, J: 2}}
"""
ROW = "{velocity: y_dot*cos(f) - x_dot*sin(f) = 0}"
TIMES = [
    "{velocity: y_dot*cos(f)*(1 + x**2 + y**2) - (1 + x**2 + y**2)*x_dot*sin(f) = 0}",
    "{velocity: y_dot*cos(f)*(2 + sin(y)) = (2 + sin(y))*x_dot*sin(f)}",
]


@pytest.mark.parametrize("times", TIMES)
@pytest.mark.parametrize("first", [False, True])
def test_a_row_times_a_function_changes_no_verdict(times: str, first: bool) -> None:
    alone = mbsym.loads(EDGE.format(rows=ROW)).stability
    both = mbsym.loads(EDGE.format(rows=", ".join([times, ROW] if first else [ROW, times]))).stability
    assert both.verdict.word is alone.verdict.word
    assert both.verdict.theorem == alone.verdict.theorem
    assert both.numerical is not None
    assert alone.numerical is not None
    assert both.numerical.word is alone.numerical.word
