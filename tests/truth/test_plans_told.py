"""What a plan says of itself, against what is true of its scene: what is cheap, and what is accurate enough."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import filed, invoked
from truth import test_accuracy_judged as judge
from truth.independent.scenes import SCENES, Scene

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning import planning
from mbsym.numerics.planning.choice import Choice
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import planned
from mbsym.numerics.planning.prices import cost, cost_of_rows
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.trade.trial import trial_of
from mbsym.report.runs.plan_words import bound_lines, choice_lines

DOUBLE = Path(__file__).parents[2] / "systems" / "double-pendulum.yaml"


def scene(text: str) -> Scenario:
    return scenario(mbsym.loads(text).system)


@pytest.mark.parametrize(("end", "count"), [(20.0, 2001), (20.0, 101)])
def test_the_price_of_a_run_with_rows_is_about_what_it_takes(end: float, count: int) -> None:
    """Prices choose the method, and tell what others would take: of two methods their ratio is right within 5.

    Rows of Taylor series are made in Python, some 50 us a step with a row in it, fifty times the step itself; where
    they lie close those of many steps are made together.
    """
    dynamics = Dynamics(scenario(mbsym.load(DOUBLE).system))
    seconds, priced = {}, {}
    for name in ("dop853", "taylor"):
        times = np.linspace(0, end, count)
        runs = [trial_of(METHODS[name], dynamics, Setting(1e-10), times) for _ in range(5)]
        seconds[name] = min(run.seconds for run in runs)
        work, (numbers, _) = runs[0].work, runs[0].states.shape
        priced[name] = cost(dynamics, name, "float64", work) + cost_of_rows(name, work, count, numbers)
    true, told = (found["taylor"] / found["dop853"] for found in (seconds, priced))
    assert true / 5 < told < 5 * true


# A stiff scene as implicit methods see it, with its solution known to whoever can solve a quadratic equation.
OVERDAMPED = """
mbsym: 1
name: Overdamped
parameters: {m: positive, k: positive, c: positive}
bodies:
  - name: b
    attached to: 0
    connection point: [x, 0, 0]
    mass: m
    coordinates: [x]
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
values: {m: 1, k: 1, c: 1000}
initial: {x: 1}
"""


@pytest.fixture
def stiff(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scenes count as stiff, as those do on which explicit steps are too many."""
    known = planning.choose

    def choose(dynamics: Dynamics, *how: float) -> Choice:
        return replace(known(dynamics, *how), method=METHODS["radau"])

    monkeypatch.setattr(planning, "choose", choose)


@pytest.mark.usefixtures("stiff")
def test_what_implicit_methods_err_by_is_not_held_against_others() -> None:
    """x = (b exp(-a t) - a exp(-b t))/(b - a), a and b = (c -+ sqrt(c^2 - 4))/2.

    Radau's tolerances end at 2.3e-14, and so do its errors, about; measured by it alone nothing is accurate to 1e-14,
    while the explicit method in more digits is, and is said to be.
    """
    given = scene(OVERDAMPED)
    times = np.linspace(0, 2, 41)
    plan = planned(given, Accuracy(1e-14), times)
    assert plan.reached
    run = trial_of(METHODS[plan.method], Dynamics(given), plan.setting, times, plan.scalar)
    root = np.sqrt(np.longdouble(1000) ** 2 - 4)
    b = (1000 + root) / 2
    a = 1 / b
    t = times.astype(np.longdouble)
    x = (b * np.exp(-a * t) - a * np.exp(-b * t)) / (b - a)
    rate = (np.exp(-b * t) - np.exp(-a * t)) / (b - a)  # a b = 1
    true = max(np.max(abs(run.states[0] - x)), np.max(abs(run.states[1] - rate)) / np.max(abs(rate)))
    assert true <= plan.bound.total <= 1e-14


@pytest.mark.usefixtures("stiff")
def test_what_nothing_good_could_be_measured_by_is_not_said_to_be_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same where explicit steps are too many for a run to measure by: then nothing is known of what was tried."""
    monkeypatch.setattr(planning, "MOST_TO_MEASURE", 0.0)
    plan = planned(scene(OVERDAMPED), Accuracy(1e-14), np.linspace(0, 2, 41))
    told = "\n".join(text for _, text in (*bound_lines(plan, None), *choice_lines(plan)))
    assert not plan.reached
    assert "the accuracy asked for is not shown" in told
    assert "not reached" not in told
    assert "none tried is accurate enough" not in told
    assert "inf only" not in told


#: x'' = -2 k x x', x(0) = 0, x'(0) = k: x = tanh(k t), x' = k/cosh(k t)^2, which dies out at the rate 2 k from 1/k on.
TURNING = """
mbsym: 1
name: stiff from the first moment on
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -20000*x*x_dot}
initial: {x: {position: 0, velocity: 10000}}
"""

#: x'' = -c x' - x, x(0) = 1, c = 10^6: two rates that lie 10^12 apart; x' is never more than 1/c.
SLOW = """
mbsym: 1
name: two rates
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: x**2/2
  - generalized force: {x: -10**6*x_dot}
initial: {x: 1}
"""


def slow(t: Any) -> Any:
    fast = -(1e6 + np.sqrt(1e12 - 4)) / 2
    lasting = 1 / fast
    return (fast * np.exp(lasting * t) - lasting * np.exp(fast * t)) / (fast - lasting)


@pytest.mark.parametrize(
    ("text", "time", "truth", "target"),
    [
        (TURNING, 10.0, lambda t: np.tanh(10_000 * t), 1e-6),
        (TURNING, 10.0, lambda t: np.tanh(10_000 * t), 1e-10),
        (SLOW, 50.0, slow, 1e-8),
    ],
)
def test_stiff_motions_get_the_stiff_method(text: str, time: float, truth: Any, target: float) -> None:
    """Explicit steps cost a thousand times as much where a motion turns stiff on the way.

    Where a velocity is small beside 1, nothing finer than what was asked for is needed to measure by.
    """
    found = mbsym.simulate(mbsym.loads(text), time, samples=101, accuracy=target)
    assert found.plan is not None
    assert found.plan.reached
    assert found.plan.method == "rodas5p"
    assert found.trajectory.work.steps < 10_000
    assert np.max(np.abs(found["x"] - truth(found.times))) <= found.plan.bound.total


def test_a_witness_that_never_comes_to_rest_is_not_believed() -> None:
    """The same with c = 10^4 to 1e-11: implicit steps err by 6e-13 of the velocity, as 40 digits of it tell.

    Explicit steps as long as stability lets them be err by 1e-10, at every tolerance otherwise: what they differ by is
    theirs.
    """
    found = mbsym.simulate(mbsym.loads(SLOW.replace("10**6", "10**4")), 10, samples=101, accuracy=1e-11, estimate=True)
    assert found.plan is not None
    assert found.plan.reached
    times = np.linspace(0, 3e-3, 61)
    with mpmath.workdps(40):
        fast = -(10**4 + mpmath.sqrt(10**8 - 4)) / 2
        slow = 1 / fast
        rates = [(mpmath.exp(slow * t) - mpmath.exp(fast * t)) / (fast - slow) for t in map(mpmath.mpf, times.tolist())]
    rate = np.array([float(x) for x in rates])
    assert np.max(np.abs(found.at(times)[1] - rate)) <= found.plan.bound.total * np.max(np.abs(rate))


# --- every sentence of a plan, parsed back ---

#: Seconds of the units that durations are written in.
UNIT = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}
NUMBER = r"[-+.\de]+"
SETTING = rf"(\w+) (h=)?({NUMBER})(?:, (float32|extended))?"


def sections(output: str) -> dict[str, list[str]]:
    """The lines beneath the name of the system by their titles."""
    found: dict[str, list[str]] = {}
    title = ""
    for line in output.splitlines()[1:]:
        if re.match(r"  \S", line):
            title = line[2:].split("  ")[0].strip()
        found.setdefault(title, []).append(line[2 + len(title) :].strip() if re.match(r"  \S", line) else line.strip())
    return found


def true_error(scene: Scene, name: str, step: str | None, fineness: str, scalar: str | None) -> float:
    """Of a setting, by the solution of the equations by hand."""
    setting: dict[str, Any] = {"step" if step else "tolerance": float(fineness), "arithmetic": scalar or "float64"}
    system = mbsym.loads(scene.text)
    return judge.judged(scene, mbsym.simulate(system, scene.time, method=name, samples=101, estimate=False, **setting))


@pytest.mark.parametrize("target", [1e-6])
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_what_a_plan_says_is_what_stands_in_its_file_and_is_so(scene: Scene, target: float, tmp_path: Path) -> None:
    """Numbers of every sentence against simulation.json; errors of what was refused against solutions by hand.

    Nothing that was measured is cheaper by 1.5 and meets the doubled target.
    """
    path = filed(tmp_path / "scene.yaml", scene.text)
    words = ["--time", repr(scene.time), "--accuracy", repr(target), "--samples", "101", "-v", "--format", "csv"]
    done = invoked("simulate", path, *words, "--out", tmp_path)
    said, file = sections(done.output), json.loads((tmp_path / "simulation.json").read_text())
    plan = file["plan"]
    (bound,) = plan["bounds"]

    assert said["accuracy"] == [f"{target:g} of the size of every coordinate and velocity, from 0 to {scene.time:g}"]
    assert plan["accuracy"]["everything"] == target
    assert said["bound"][0] == f"{bound['quantity']} within {bound['total']:.1e} of its size ({bound['how']})"
    parts = dict(re.match(rf"(\w+) ({NUMBER})?", text).groups() for text in said["bound"][1].split(" + "))  # type: ignore[union-attr]
    assert [*parts] == [share["name"] for share in bound["shares"]] == ["model", "integration", "arithmetic"]
    for share in bound["shares"]:
        assert share["how"] == "together" or float(parts[share["name"]] or 0) == pytest.approx(share["error"], rel=0.06)
    assert sum(share["error"] for share in bound["shares"]) == pytest.approx(bound["total"])
    assert plan["reached"] is (bound["total"] <= target) is ("warning" not in said or "reached" not in done.output)

    own = re.match(rf"(\w+), (tolerance|step) ({NUMBER}), ({NUMBER}) (\w+) a run: (.*)", said["method"][0])
    assert own is not None
    name, kind, fineness, number, unit, rest = own.groups()
    assert (name, float(fineness)) == (file["method"]["name"], file[kind])
    assert plan["options"][plan["options"].index(f"--{kind}") + 1] == repr(float(fineness)).removesuffix(".0")
    seconds, why = float(number) * UNIT[unit], next(item["why"] for item in plan["items"] if item["kind"] == "method")
    assert rest.startswith(why)

    for refused in rest.removeprefix(why).split("; ")[1:]:
        match = re.fullmatch(rf"{SETTING}: error ({NUMBER}), about ({NUMBER}) (\w+)", refused)
        if match is None:
            assert "error inf" not in refused
            continue
        other, step, size, scalar, error, number, unit = match.groups()
        cost, error = float(number) * UNIT[unit], float(error)
        if 2 * error <= target:
            assert cost >= seconds / 1.5, refused
        if error < 0.1 and model_is_whole(plan):
            true = true_error(scene, other, step, size, scalar)
            assert error / 100 < true < 1.5 * error + 1e-13, refused
    for text in said.get("cost", []):
        match = re.match(rf"one digit (more|less), ({NUMBER}): about .* work \({SETTING}", text)
        if match is None:
            assert "no finer tolerance" in text
            continue
        digit, wanted, other, step, size, scalar = match.groups()
        assert float(wanted) == pytest.approx(target * (0.1 if digit == "more" else 10))
        if model_is_whole(plan):
            assert true_error(scene, other, step, size, scalar) <= float(wanted)

    estimate, text = file["estimated_error"], said["error"][0]
    numbers = re.match(rf"about ({NUMBER}) at the end(?:, ({NUMBER}) at worst)?", text)
    assert numbers is not None
    assert float(numbers[1]) == pytest.approx(estimate["final"], rel=0.06)
    assert float(numbers[2] or numbers[1]) == pytest.approx(estimate["largest"], rel=0.06 if numbers[2] else 0.5)
    assert f"against {estimate['against']['method']}, tolerance {estimate['against']['tolerance']:.2g}" in text
    assert said["energy"][0].startswith("conserved (proved)") is (file["energy"]["how"] == "proved")


def model_is_whole(plan: dict[str, Any]) -> bool:
    """Whether the equations are those of the description."""
    return all(share["error"] == 0 for bound in plan["bounds"] for share in bound["shares"] if share["name"] == "model")
