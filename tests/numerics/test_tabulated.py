"""Runs with tabulated forces against closed forms, piece by piece, and against SciPy's spline and solver."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import mbsym
from mbsym.editing import suggestions
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.report.targets import TARGETS
from mbsym.source import read, to_text, to_yaml

POINTS = ((0, 0), (0.5, 2.5), (1.25, -1), (3, 0.75))
DESCRIPTION = """
mbsym: 1
name: Driven oscillator
parameters: {m: {positive: true, value: 1}, k: {positive: true, value: 4}}
tables:
  push: {points: [[0, 0], [0.5, 2.5], [1.25, -1], [3, 0.75]], MORE}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
loads:
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {x: push(t)}
initial: {x: 0.25}
"""
LINEAR = DESCRIPTION.replace(", MORE", "")
CUBIC = DESCRIPTION.replace("MORE", "between: cubic")
ENDING = DESCRIPTION.replace("MORE", "outside: zero")
TIMES = np.linspace(0, 5, 101)


def system_of(text: str) -> System:
    return mbsym.loads(text).system


def states(system: System, method: str = "dop853") -> Any:
    dynamics = Dynamics(scenario(system))
    setting = Setting(None, 0.001) if METHODS[method].traits.fixed else Setting(1e-13)
    return METHODS[method].start(dynamics, setting).fill(TIMES)


def closed(after: float) -> Any:
    """x'' + 4 x = y + s u between two points, u = t - t_k: cosine and sine about the straight line (y + s u)/4."""
    found, x, v = np.empty((2, len(TIMES))), 0.25, 0.0
    knots = [*POINTS, (np.inf, after)]
    for (start, y), (end, y_end) in pairwise(knots):
        if end == np.inf:
            y = after
        s = 0.0 if end == np.inf else (y_end - y) / (end - start)
        one, other = x - y / 4, (v - s / 4) / 2

        def at(u: Any, one: float = one, other: float = other, y: float = y, s: float = s) -> Any:
            place = one * np.cos(2 * u) + other * np.sin(2 * u) + (y + s * u) / 4
            return place, 2 * other * np.cos(2 * u) - 2 * one * np.sin(2 * u) + s / 4

        here = (start <= TIMES) & (end >= TIMES)
        found[:, here] = at(TIMES[here] - start)
        if end < np.inf:
            x, v = at(end - start)
    return found


@pytest.mark.parametrize(("text", "after"), [(LINEAR, 0.75), (ENDING, 0.0)])
def test_a_linear_table_against_the_closed_form(text: str, after: float) -> None:
    assert np.max(np.abs(states(system_of(text)) - closed(after))) < 1e-12


@pytest.mark.parametrize("method", ["rk4", "taylor", "rodas5p", "radau", "rk45"])
def test_every_method_ends_steps_at_points(method: str) -> None:
    if method == "taylor":
        pytest.importorskip("heyoka")
    assert np.max(np.abs(states(system_of(LINEAR), method) - closed(0.75))) < 2e-11


def test_a_cubic_table_against_another_spline_and_solver() -> None:
    spline = CubicSpline(*zip(*POINTS, strict=True), bc_type="natural")
    wanted, x = np.empty((2, len(TIMES))), np.array([0.25, 0.0])
    for start, end in ((0, 0.5), (0.5, 1.25), (1.25, 3), (3, 5)):
        here = (start <= TIMES) & (end >= TIMES)
        done = solve_ivp(
            lambda t, y: (y[1], spline(min(t, 3.0)) - 4 * y[0]), (start, end), x, "DOP853", rtol=3e-14, atol=1e-15,
            dense_output=True, max_step=0.02,
        )  # fmt: skip
        wanted[:, here], x = done.sol(TIMES[here]), done.y[:, -1]
    assert np.max(np.abs(states(system_of(CUBIC)) - wanted)) < 1e-12


def test_a_wrong_knot_is_noticed() -> None:
    """The judge is not blind: a point that is off by a millionth moves the motion by more than is allowed."""
    moved = LINEAR.replace("[1.25, -1]", "[1.250001, -1]")
    assert np.max(np.abs(states(system_of(moved)) - closed(0.75))) > 1e-8


def test_a_table_of_a_coordinate_is_a_force_and_a_potential() -> None:
    """A potential by points has the slopes of its pieces for a force: those of a step function of the coordinate."""
    by_points = DESCRIPTION.replace(", MORE", "").replace("- generalized force: {x: push(t)}", "- potential: push(x)")
    steps = "-5*pulse(x, 0, 1/2) + 14/3*pulse(x, 1/2, 5/4) - pulse(x, 5/4, 3)"  # slopes 5, -3.5/0.75, 1.75/1.75
    by_steps = LINEAR.replace("push(t)", f'"{steps}"')
    assert np.max(np.abs(states(system_of(by_points)) - states(system_of(by_steps)))) < 1e-11


@pytest.mark.parametrize("text", [LINEAR, CUBIC, ENDING])
def test_both_spellings_lose_nothing(text: str) -> None:
    system = system_of(text)
    for written, name in ((to_yaml(system), "x.yaml"), (to_text(system), "x.txt")):
        again, complaints = read(written, name)
        assert again == system, list(complaints)
    alone, complaints = read(to_text(system).replace("push = ((0, 0),", "push = points = ((0, 0),"), "x.txt")
    assert alone == system, list(complaints)


def test_dimensions() -> None:
    units = "units: {x: m, m: kg, k: N/m, push: N}\n"
    assert read(LINEAR + units)[0] is not None
    wrong = LINEAR.replace("0.75]]}", "0.75]], unit: m}") + "units: {x: m, m: kg, k: N/m}\n"
    system, complaints = read(wrong)
    assert system is None
    assert "push(t)" in next(item.message for item in complaints)
    both = LINEAR.replace("{x: push(t)}", "{x: push(t) + push(x)}") + units
    system, complaints = read(both)
    assert system is None
    assert "the argument of push" in next(item.message for item in complaints)


def test_reports_list_the_points() -> None:
    analysis = mbsym.loads(CUBIC.replace("0.75]]", "-1/3]]"))
    assert not any(check.failed for check in analysis.checks)
    latex = TARGETS["latex"].render(analysis, (1, 2, 3))
    assert r"Table \texttt{push}, a natural cubic spline, its end values outside: $(0,\, 0),\; " in latex
    assert r"(1.25,\, -1),\; \allowbreak (3,\, \frac{-1}{3})$." in latex
    assert r"\operatorname{push}(t)" in latex
    page = TARGETS["html"].render(analysis, (1, 2, 3))
    assert "Table <code>push</code>, a natural cubic spline, its end values outside: <math>" in page
    assert "<mn>0.5</mn><mo>,</mo><mn>2.5</mn>" in page


def test_the_editor_offers_tables() -> None:
    head, tail = LINEAR.split("push(t)")
    line, column = head.count("\n"), len(head.rpartition("\n")[2])
    found = suggestions(head + tail, line, column, read(LINEAR)[0])
    assert "push" in [one.label for one in found]
