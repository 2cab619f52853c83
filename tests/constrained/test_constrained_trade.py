"""What accuracy costs with constraints: columns of the drift, references through dead points and of stiff scenes."""

from __future__ import annotations

import csv
from dataclasses import dataclass, replace
from io import StringIO
from math import inf
from typing import Any

import numpy as np
import pytest
from conftest import system_of

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Method, Run, Setting, Traits
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.trade import reference_search
from mbsym.numerics.trade.reference_search import EXPLICIT, IMPLICIT, WAYS, Reference, _Search, whole_reference
from mbsym.numerics.trade.tradeoff import Tradeoff, tradeoff
from mbsym.report.figures.tradeoff_figure import work_precision
from mbsym.report.runs.constrained_run_words import constraint_lines
from mbsym.report.runs.tradeoff_table import tradeoff_csv
from mbsym.simulation import Request, simulate

#: On the unit circle, from rest at height 0 in a field of 1: at angle a from the vertical v^2 = 2 cos a.
PENDULUM = """
mbsym: 1
name: Pendulum in Cartesian coordinates
parameters: {m: 1, g: 1}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
constraints:
  - relation: x**2 + y**2 = 1
initial: {x: 1, y: 0}
"""

#: Bars of equal lengths from upright: c = a, b = -a, and 5/6 a'^2 + 2 g cos a is constant; all in line at a = -pi/2.
PARALLELOGRAM = """
mbsym: 1
name: Parallelogram
parameters: {m: 1, g: 9.81}
bodies:
  - {name: crank, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, mass centre: [0, 1/2, 0],
     inertia about: mass centre, inertia: [0, 0, m/12]}
  - {name: coupler, attached to: crank, connection point: [0, 1, 0], rotation: {axes: [3], angles: [b]}, mass: m,
     mass centre: [1/2, 0, 0], inertia about: mass centre, inertia: [0, 0, m/12]}
  - {name: rocker, attached to: 0, connection point: [1, 0, 0], rotation: {axes: [3], angles: [c]}, mass: m,
     mass centre: [0, 1/2, 0], inertia about: mass centre, inertia: [0, 0, m/12]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
constraints:
  - coincide: [{body: coupler, point: [1, 0, 0]}, {body: rocker, point: [0, 1, 0]}]
initial: {a: {position: 0, velocity: -1}, b: {position: 0, velocity: 1}, c: {position: 0, velocity: -1}}
"""


def described(text: str) -> Scenario:
    system = system_of(text)
    return scenario(system)


@dataclass(frozen=True)
class _Off:
    """A method that is wrong on purpose: dop853, with positions stretched by ``much`` behind its first state."""

    much: float
    traits: Traits

    def start(self, dynamics: Dynamics, setting: Setting, scalar: str) -> Run:
        run = METHODS["dop853"].start(dynamics, Setting(1e-13), scalar)
        fill = run.fill

        def stretched(times: Any) -> Any:
            found = np.array(fill(times))
            found[: dynamics.size] *= 1 + self.much
            return found

        run.fill = stretched  # type: ignore[method-assign]
        return run


@pytest.fixture(scope="module")
def trade() -> Tradeoff:
    dynamics = Dynamics(described(PENDULUM))
    truth = whole_reference(dynamics, 4.0, 6.0)
    off: Method = _Off(1e-6, METHODS["dop853"].traits)
    # More than the ladders cost.
    good = tradeoff(dynamics, [METHODS["rk4"]], truth, 60.0)
    wrong = tradeoff(dynamics, [off], truth, 60.0)
    return Tradeoff((*good.rows, *wrong.rows), truth, (), ())


def test_what_strays_from_constraints_is_seen(trade: Tradeoff) -> None:
    """x(1+e): f = x^2 + y^2 - 1 = 2 e, g = (1+e) times what it was, 0; measured by max 2|x| + max 2|y| = 4.

    x and y both reach 1 within the motion, from the right over the lowest point to the left.
    """
    stretched = [row for row in trade.rows if row.method.traits.name == "dop853"]
    exact = [row for row in stretched if row.scalar != "float32"]  # whose own rounding is 1e-7
    assert len(exact) > 3
    for row in exact:
        assert row.strayed is not None
        assert row.strayed[0] == pytest.approx(2e-6 / 4, rel=1e-3)
        assert row.strayed[1] < 1e-11
    fine = [row for row in trade.rows if row.shown == "h=0.00781" and row.scalar == "float64"]
    assert fine
    assert max(fine[0].strayed or (1.0,)) < 1e-14


def test_the_drift_is_a_column_of_the_table_where_there_are_constraints(trade: Tradeoff) -> None:
    rows = list(csv.DictReader(StringIO(tradeoff_csv(trade))))
    assert list(rows[0])[5:8] == ["drift", "constraint_drift", "constraint_velocity_drift"]
    off = next(row for row in rows if row["method"] == "dop853")
    assert float(off["constraint_drift"]) == pytest.approx(5e-7, rel=1e-3)


def test_where_no_run_came_to_the_end_there_is_no_figure(trade: Tradeoff) -> None:
    """A budget that is too short leaves rows without errors, which have no place on a logarithmic axis."""
    none = replace(trade, rows=tuple(replace(row, error=inf, drift=inf) for row in trade.rows))
    assert work_precision(described(PENDULUM).system, 1.0, none, 1e-9, (), ("png",)) == {}


def _at_end(truth: Reference) -> list[float]:
    return [float(x) for x in truth.states[:, -1]]


def test_a_reference_goes_through_a_position_in_which_links_are_in_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps in many bits cannot; of the two methods that carry over it the difference is told."""
    monkeypatch.setattr(reference_search, "PARTS", 100)  # fewer steps than usual: it is quicker
    monkeypatch.setattr(reference_search, "PLACES", 200)
    truth = whole_reference(Dynamics(described(PARALLELOGRAM)), 2.8, 40.0)
    assert truth.way == EXPLICIT
    a, b, c, va, vb, vc = _at_end(truth)
    assert a < -4.8
    assert [b, c, vb, vc] == pytest.approx([-a, a, -va, va], abs=1e-8)
    assert 5 / 6 * va**2 + 19.62 * np.cos(a) == pytest.approx(5 / 6 + 19.62, abs=1e-6)
    assert truth.error < 1e-8


def test_stiff_constrained_scenes_have_a_reference_by_two_methods_that_keep_to_constraints(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(reference_search, "PARTS", 50)
    monkeypatch.setattr(reference_search, "PLACES", 200)
    dynamics = Dynamics(described(PENDULUM))
    implicit = next(way for way, _ in WAYS if way.__name__ == "_implicit")
    truth = implicit(_Search(dynamics, 0.25, 60.0, lambda text: None))
    assert truth.way == IMPLICIT
    assert truth.method.startswith("rodas5p and radau")
    x, y, vx, vy = _at_end(truth)
    assert x * x + y * y == pytest.approx(1, abs=1e-12)
    assert vx * vx + vy * vy == pytest.approx(-2 * y, abs=1e-7)


# --- steps that go over a position in which links are in line ---

#: 1 + 3 = 2 + 2: at a = 0 the links are in line, once in every turn of the crank.
CHANGE_POINT = """
mbsym: 1
name: Change-point four-bar
parameters: {m: 1}
bodies:
  - {name: crank, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, mass centre: [1/2, 0, 0],
     inertia about: mass centre, inertia: [0, 0, m/12]}
  - {name: coupler, attached to: crank, connection point: [1, 0, 0], rotation: {axes: [3], angles: [b]}, mass: m,
     mass centre: [1, 0, 0], inertia about: mass centre, inertia: [0, 0, m/3]}
  - {name: rocker, attached to: coupler, connection point: [2, 0, 0], rotation: {axes: [3], angles: [c]}, mass: m,
     mass centre: [3/2, 0, 0], inertia about: mass centre, inertia: [0, 0, 3*m/4]}
constraints:
  - coincide: [{body: rocker, point: [3, 0, 0]}, {body: 0, point: [2, 0, 0]}]
initial: {a: {position: 1, velocity: -1}, b: 1, c: -2}
"""


@pytest.mark.parametrize(("method", "how"), [("rk4", {"step": 0.05}), ("dop853", {"tolerance": 1e-4})])
def test_steps_that_go_over_a_singular_position_are_told(method: str, how: dict[str, float]) -> None:
    """A run with small steps is carried over it and names the time; one with long steps passes, and is told."""
    system = system_of(CHANGE_POINT)
    fine = simulate(scenario(system), Request(time=5.0, tolerance=1e-11, estimate=False))
    (when,) = fine.trajectory.work.singular
    assert not fine.stepped_over
    assert np.sin(fine.at(when)[0]) == pytest.approx(0, abs=1e-6)
    coarse = simulate(scenario(system), Request(time=5.0, method=method, estimate=False, **how))  # type: ignore[arg-type]
    assert not coarse.trajectory.work.singular
    assert coarse.stepped_over == pytest.approx([when], abs=0.01)
    assert any("steps went over" in text for _, text in constraint_lines(coarse))


def test_near_misses_are_not_called_singular() -> None:
    """The ground link is longer by a hundredth: the loop comes near a line and never lies in one."""
    system = system_of(CHANGE_POINT.replace("point: [2, 0, 0]}]", "point: [2.01, 0, 0]}]"))
    found = simulate(scenario(system), Request(time=5.0, method="rk4", step=0.05, estimate=False))
    assert not found.stepped_over
    assert not found.trajectory.work.singular
