"""A joint that follows a smooth table: the pendulum on a shaken point, theta'' = -(g + y'') sin(theta)/l."""

from __future__ import annotations

from itertools import pairwise
from types import ModuleType

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import mbsym
from mbsym import DescriptionError
from mbsym.problems.checks import EXACT
from mbsym.report.code.python_module import render

SHAKEN = """
mbsym: 1
name: pendulum on a shaken point
parameters: {m: positive, l: positive, g: positive}
tables:
  y: {points: [[0, 0], [1, 1/2], [2, -1/3], [4, 1]], between: cubic, outside: extrapolate}
bodies:
  - name: rod
    attached to: 0
    connection point: [0, y(t), 0]
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -l, 0]
    mass: m
loads: [{uniform gravity: {vector: [0, -g, 0]}}]
motion: {theta: 0}
values: {m: 2, l: 1/2, g: 9.81}
initial: {theta: 0.3}
"""

#: The natural spline through the same points, by SciPy.
Y = CubicSpline([0, 1, 2, 4], [0, 1 / 2, -1 / 3, 1], bc_type="natural")


def acceleration(t: float, theta: float) -> float:
    return -(9.81 + float(Y(t, 2))) * np.sin(theta) / 0.5


def test_every_check_is_exact_and_code_has_the_acceleration_of_the_spline() -> None:
    analysis = mbsym.loads(SHAKEN, (1, 2, 3, 4))
    assert {check.outcome for check in analysis.checks} == {EXACT}
    module = ModuleType("shaken")
    exec(compile(render(analysis, (3,)), "shaken", "exec"), module.__dict__)
    for t in (0.25, 1.0, 1.5, 3.9):
        found = module.rhs(t, [0.3, 0.1], module.complete())[1]
        assert found == pytest.approx(acceleration(t, 0.3), rel=1e-12)


def test_a_motion_follows_it() -> None:
    found = mbsym.simulate(mbsym.loads(SHAKEN), time=4, samples=5)
    pieces = [0.0, 1.0, 2.0, 4.0]
    state = [0.3, 0.0]
    for start, end in pairwise(pieces):  # the third derivative jumps between
        done = solve_ivp(
            lambda t, s: [s[1], acceleration(t, s[0])], (start, end), state, "DOP853", rtol=1e-12, atol=1e-13
        )
        state = done.y[:, -1]
    assert found["theta"][-1] == pytest.approx(state[0], abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new"), [("between: cubic", "between: linear"), ("outside: extrapolate", "outside: hold")]
)
def test_a_table_with_a_kink_is_refused_with_a_hint_that_works(old: str, new: str) -> None:
    with pytest.raises(DescriptionError, match="which has a kink") as failure:
        mbsym.loads(SHAKEN.replace(old, new))
    assert "between: cubic, outside: extrapolate or error" in str(failure.value)
