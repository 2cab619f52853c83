"""What the ledger says of simpler equations: held against runs with and without them, and against the plan."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import filed, invoked

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.numerics.ledger import table
from mbsym.numerics.ledger.entry import NEEDED, NOT_NEEDED, OPEN, Saving
from mbsym.numerics.ledger.work import AccuracyGoal, Work
from mbsym.numerics.planning import model_choice
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.models import Model, emptied, parted
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import Pins, planned
from mbsym.numerics.scenario import scenario
from mbsym.simulation import Request, simulate

#: A dumbbell in the plane of its orbit, 1/100 of the radius long.
DUMBBELL = """
mbsym: 1
name: A dumbbell in its orbit
parameters: {nu: positive, m: positive, l: positive}
bodies:
  - {name: centre, attached to: 0, coordinates: [r, u], rotation: {axes: [3], angles: [u]},
     connection point: [r*cos(u), r*sin(u), 0], mass: 0}
  - {name: first, attached to: centre, rotation: {axes: [3], angles: [phi]}, coordinates: [phi], mass: m,
     mass centre: [l, 0, 0]}
  - {name: second, attached to: first, mass: 2*m, mass centre: [-l/2, 0, 0]}
loads:
  - newtonian gravity: {constant: nu, centre: 0, about: centre, order: 2}
values: {nu: 1, m: 1, l: 1/100}
initial: {r: 1, u: {position: 0, velocity: 1}, phi: {position: 0.4, velocity: 0}}
"""

TIME = 6.0


@cache
def difference() -> float:
    """Of the motion with the field of order 2 from that with the whole field, by the sizes of what moves in it."""
    given = scenario(mbsym.loads(DUMBBELL, ()).system)
    states: list[Any] = [
        simulate(
            given, Request(TIME, samples=501, tolerance=1e-13, model=Model(order), estimate=False)
        ).trajectory.states
        for order in (2, "exact")
    ]
    apart = np.max(np.abs(states[0] - states[1]), axis=1)
    sizes = np.maximum(np.max(np.abs(states[1]), axis=1), 1e-300)
    return float(np.max(apart / sizes))


def gravity(accuracy: float | None) -> Saving:
    wanted = None if accuracy is None else AccuracyGoal(accuracy, TIME)
    (found,) = table.gravity_orders(Work(mbsym.loads(DUMBBELL, ()), goal=wanted))
    return found


def test_without_an_accuracy_an_estimate_decides_nothing() -> None:
    found = gravity(None)
    assert (found.how, found.standing, found.error) == (Certainty.ESTIMATED, OPEN, None)


def test_what_the_ledger_measures_is_the_difference_of_two_runs() -> None:
    found = gravity(1e-6)
    assert found.how == Certainty.MEASURED
    assert found.error is not None
    assert 0.5 * difference() < found.error < 2 * difference()


@pytest.mark.parametrize(("times", "standing"), [(0.5, NEEDED), (10.0, NOT_NEEDED)])
def test_the_scene_needs_what_differs_by_more_than_the_accuracy(times: float, standing: str) -> None:
    assert gravity(times * difference()).standing == standing


@pytest.mark.parametrize("times", [0.5, 10.0])
def test_the_plan_says_the_same(times: float) -> None:
    accuracy = times * difference()
    given = scenario(mbsym.loads(DUMBBELL, ()).system)
    settled = Pins(model=Model(2), method="dop853", tolerance=1e-12)
    plan = planned(given, Accuracy(accuracy), np.linspace(0, TIME, table.TIMES), settled)
    (item,) = (item for item in plan.items if item.kind == Kind.GRAVITY)
    found = gravity(accuracy)
    assert plan.reached == (found.standing == NOT_NEEDED)
    assert item.chosen == "2"
    assert item.error == pytest.approx(found.error, rel=1e-3)


def test_a_difference_that_is_too_small_by_far_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the equation of the difference loses its residual.  The rerun says otherwise."""
    honest = model_choice.model_error

    def lied(*given: Any, **more: Any) -> Any:
        found = honest(*given, **more)
        found.difference[:] = 0.0
        return found

    monkeypatch.setattr(model_choice, "model_error", lied)
    assert gravity(0.5 * difference()).standing == NEEDED


# --- laws of the standing ---


def test_what_is_proved_is_not_needed_and_what_is_estimated_is_open() -> None:
    def of(how: str, error: float | None = None, tolerable: float | None = None) -> str:
        return Saving("kind", ("what",), "why", how, (), error, tolerable).standing

    assert of(Certainty.PROVED) == NOT_NEEDED
    assert of(Certainty.ESTIMATED) == OPEN
    assert of(Certainty.ESTIMATED, 2e-6, 1e-6) == NEEDED
    assert of(Certainty.MEASURED, 1e-6, 1e-6) == NOT_NEEDED


# --- negligible masses ---

#: A chain of two links in space; the first weighs nothing to speak of.
CHAIN = """
mbsym: 1
name: A weight on a light rod
parameters: {m1: positive, J1: positive, m: positive, J: positive, L: positive, g: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [1, 2], angles: [a, b]}, mass: m1, mass centre: [L/9, L/7, -L/2],
     inertia about: mass centre, inertia: [[4*J1, J1, -J1/2], [J1, 5*J1, J1/3], [-J1/2, J1/3, 6*J1]]}
  - {name: weight, attached to: rod, connection point: [0, 0, -L], rotation: {axes: [1, 2], angles: [c, d]}, mass: m,
     mass centre: [0, 0, -L], inertia about: mass centre, inertia: [[J, 0, 0], [0, J, 0], [0, 0, J]]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, 0, -1]}
values: {m1: 1e-10, J1: 1e-11, m: 1, J: 1/10, L: 1, g: 9.81}
initial: {a: 0.3, b: 0.2, c: 0.1, d: -0.2}
"""


def test_a_light_rod_is_left_out_by_the_plan_and_told_by_the_ledger() -> None:
    analysis = mbsym.loads(CHAIN, ())
    plan = planned(scenario(analysis.system), Accuracy(1e-5), np.linspace(0, 2, table.TIMES))
    assert set(plan.model.without) == {"m1", "J1"}
    (item,) = (item for item in plan.items if item.kind == Kind.MASSES)
    assert item.what == ("rod",)
    (found,) = table.simpler_model(Work(analysis, goal=AccuracyGoal(1e-5, 2.0)))
    assert (found.kind, found.what, found.standing) == (Kind.MASSES, ("rod",), NOT_NEEDED)
    assert found.measures[0].saved > 0


def test_a_body_is_without_mass_when_all_of_it_is_gone() -> None:
    given = scenario(mbsym.loads(CHAIN, ()).system)
    assert emptied(given, ("m1", "J1")) == {"rod": ("m1", "J1")}
    assert emptied(given, ("m1",)) == {}
    assert parted(given, Model(without=("m1", "J1", "g"))) == (("rod",), ("g",))


# --- the command ---


def test_the_run_tells_what_is_needed(tmp_path: Path) -> None:
    file = filed(tmp_path / "dumbbell.yaml", DUMBBELL)
    common = ["run", str(file), "--problems", "2", "--format", "json", "--out", str(tmp_path / "out"), "--ledger"]
    plain = invoked(*common)
    assert "depends on the accuracy" in plain.output
    held = invoked(*common, "--accuracy", "1e-9", "--until", "6", code=0)
    assert "although this scene needs it" in held.output
    (saving,) = (
        one
        for one in json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))["ledger"]["savings"]
        if one["kind"] == Kind.GRAVITY
    )
    assert saving["standing"] == NEEDED
    assert saving["error"] > saving["tolerable"]


@pytest.mark.parametrize(
    "options",
    [
        ["--ledger", "--accuracy", "1e-6"],
        ["--ledger", "--until", "3"],
        ["--accuracy", "1e-6", "--until", "3"],
        ["--ledger", "--accuracy", "2", "--until", "0"],
    ],
)
def test_half_an_accuracy_is_refused(tmp_path: Path, options: list[str]) -> None:
    file = filed(tmp_path / "dumbbell.yaml", DUMBBELL)
    invoked("run", file, "--out", tmp_path / "out", *options, code=2)
    assert not (tmp_path / "out").exists()
