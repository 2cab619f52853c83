"""Accuracies become plans: against closed forms over the whole interval, with what is settled by hand, and lies."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED
from scipy.special import ellipj, ellipk

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning import pilot, planning
from mbsym.numerics.planning import plan_items as plan_bounds
from mbsym.numerics.planning.models import Model
from mbsym.numerics.planning.pilot import Yardstick
from mbsym.numerics.planning.plan import ENERGY, Accuracy, Bound, Share
from mbsym.numerics.planning.plan_items import (
    Settled,
    _closest,
    _why_fineness,
    _why_method,
    _why_scalar,
    _worst,
    items_of,
)
from mbsym.numerics.planning.planning import Pins, planned
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.report.runs.plan_words import bound_lines
from mbsym.simulation import Request, simulate
from mbsym.simulation.accurate import simulate_accurately

PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: positive, L: positive, g: positive, c: nonnegative}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -L, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: theta, coefficient: c}
motion: {theta: 0}
values: {m: 1, L: 1, g: 1, c: 0}
initial: {theta: 2}
"""

KEPLER = """
mbsym: 1
name: Kepler orbit of eccentricity 0.9
parameters: {m: positive, k: positive}
bodies:
  - name: planet
    attached to: 0
    coordinates: [x, y]
    connection point: [x, y, 0]
    mass: m
loads:
  - force function: k*m/sqrt(x**2 + y**2)
values: {m: 1, k: 1}
initial:
  x: {position: 1/10, velocity: 0}
  y: {position: 0, velocity: 4.358898943540674}
"""


CHAOTIC = Path(__file__).parents[1] / "cases" / "statements" / "chaotic-double-pendulum.yaml"


def described(text: str, **values: str) -> Scenario:
    from mbsym.simulation import read_values

    system = mbsym.loads(text, ()).system
    return scenario(system, read_values(system, values))


def run_of(given: Scenario, plan: Any, times: Any) -> Any:
    """The states that the plan's run shows."""
    request = Request(
        float(times[-1]),
        samples=len(times),
        method=plan.method,
        tolerance=plan.setting.tolerance,
        step=plan.setting.step,
        arithmetic=plan.scalar,
        model=plan.model,
        estimate=False,
    )
    found = simulate(given, request)
    assert found.whole
    return found.trajectory.states.astype(float)


def pendulum_angle(times: Any, start: float) -> Any:
    """sin(theta/2) = k cd(t | k^2)."""
    k = np.sin(start / 2)
    sn, _, _, _ = ellipj(ellipk(k * k) - times, k * k)
    return 2 * np.arcsin(k * sn)


def kepler_positions(times: Any, e: float) -> Any:
    """x = cos E - e (from the far focus turned round), E - e sin E = t, with a = k = 1."""
    found = times.copy()
    for _ in range(200):
        found = found - (found - e * np.sin(found) - times) / (1 - e * np.cos(found))
    return np.vstack([np.cos(found) - e, np.sqrt(1 - e * e) * np.sin(found)])


def within(plan: Any, error: float, name: str) -> bool:
    """Whether a true error is below the bound, and above a thousandth of it."""
    bound = plan.bound
    return bool(error <= bound.total and (bound.quantity != name or error >= bound.total / 1000))


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-10])
def test_a_pendulum_is_as_accurate_as_asked_and_as_said(accuracy: float) -> None:
    given, times = described(PENDULUM), np.linspace(0, 30, 2001)
    plan = planned(given, Accuracy(accuracy), times)
    assert plan.reached
    assert plan.bound.total <= accuracy
    true = pendulum_angle(times, 2.0)
    error = float(np.max(np.abs(run_of(given, plan, times)[0] - true)) / np.max(np.abs(true)))
    assert within(plan, error, "theta")


def test_a_kepler_orbit_of_high_eccentricity_reaches_its_accuracy_over_whole_periods() -> None:
    """Rows at whole periods show little: the bound is of the whole interval."""
    given, end = described(KEPLER), 6 * np.pi
    few = np.linspace(0, end, 4)
    plan = planned(given, Accuracy(1e-7), few)
    assert plan.reached
    times = np.linspace(0, end, 5001)
    true = kepler_positions(times, 0.9)
    error = np.max(np.abs(run_of(given, plan, times)[:2] - true), axis=1) / np.max(np.abs(true), axis=1)
    assert np.max(error) <= plan.bound.total <= 1e-7


def test_a_small_swing_is_linear_and_a_large_one_is_not() -> None:
    times = np.linspace(0, 20, 1001)
    small = planned(described(PENDULUM, theta="0.01"), Accuracy(1e-3), times)
    assert small.model == Model(linear=True)
    assert small.bound.shares[0].error > 0
    states = run_of(described(PENDULUM, theta="0.01"), small, times)
    error = float(np.max(np.abs(states[0] - pendulum_angle(times, 0.01))) / 0.01)
    assert small.bound.total / 1000 <= error <= small.bound.total
    large = planned(described(PENDULUM, theta="1"), Accuracy(1e-3), times)
    assert not large.model.linear
    refused = [one for item in large.items if item.kind == "linear or nonlinear" for one in item.refused]
    assert [one.word for one in refused] == ["linear"]


def test_damping_that_nobody_feels_is_left_out_and_damping_that_counts_is_not() -> None:
    times = np.linspace(0, 10, 1001)
    faint = planned(described(PENDULUM, c="1e-7"), Accuracy(1e-3), times)
    assert faint.model.without == ("c",)
    true = pendulum_angle(times, 2.0)
    states = run_of(described(PENDULUM, c="1e-7"), faint, times)
    assert np.max(np.abs(states[0] - true)) / 2 <= faint.bound.total
    felt = planned(described(PENDULUM, c="0.01"), Accuracy(1e-3), times)
    assert felt.model.without == ()


def test_the_richer_field_is_taken_where_the_described_one_is_not_good_enough() -> None:
    given = scenario(mbsym.load(SHIPPED / "satellite.yaml", ()).system)
    times = np.linspace(0, 3, 1001)
    plan = planned(given, Accuracy(1e-2), times)
    (item,) = (one for one in plan.items if one.kind == "order of gravity")
    assert item.chosen == "exact"
    assert "richer than described" in item.why
    kept = planned(given, Accuracy(1e-2), times, Pins(model=Model(2)))
    assert not kept.reached
    assert kept.bound.shares[0].error > 1e-2
    # No tolerance finer than the model is worth.
    assert kept.bound.shares[1].error > 1e-2 * kept.bound.shares[0].error
    assert any("wrong, however it is integrated" in text for text in kept.remarks)


def test_a_tolerance_that_was_asked_for_is_kept_and_judged() -> None:
    given, times = described(PENDULUM), np.linspace(0, 10, 1001)
    fine = planned(given, Accuracy(1e-3), times, Pins(tolerance=1e-12))
    assert fine.setting.tolerance == 1e-12
    (method,) = (one for one in fine.items if one.kind == "method")
    assert method.why == "as asked for, finer than this accuracy needs"
    coarse = planned(given, Accuracy(1e-9), times, Pins(tolerance=1e-3))
    assert not coarse.reached
    true = pendulum_angle(times, 2.0)
    error = float(np.max(np.abs(run_of(given, coarse, times)[0] - true)) / 2)
    assert error <= coarse.bound.total


def test_more_digits_are_taken_where_float64_does_not_reach() -> None:
    given = scenario(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system)
    plan = planned(given, Accuracy(1e-10), np.linspace(0, 100, 2001), Pins(method="dop853"))
    assert plan.scalar == "extended"
    assert plan.reached


def test_what_cannot_be_reached_is_said_not_to_be() -> None:
    """At t = 200 rounding of 64 bits has grown by thirteen digits."""
    given = scenario(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system)
    plan = planned(given, Accuracy(1e-9), np.linspace(0, 150, 1001), Pins(method="dop853"))
    assert not plan.reached
    assert plan.bound.total > 1e-7


PUSHED = """
mbsym: 1
name: Pushed from an unstable rest
parameters: {k: positive}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: -k*x**2/2
values: {k: 1}
initial: {x: {position: 1, velocity: -0.9999999999}}
"""


def test_nothing_is_called_good_enough_where_the_bound_is_beyond_the_target() -> None:
    """x'' = x: whatever is wrong grows like e^t, by 2.4e17 until t = 40: 1e-12 is out of reach of the methods here."""
    plan = planned(described(PUSHED), Accuracy(1e-12), np.linspace(0, 40, 401))
    assert not plan.reached
    chosen = {item.kind: item.why for item in plan.items}
    # What measures is itself wrong by more than that: nothing tried is shown to be enough, and none to miss it.
    assert plan.measured_to is not None
    assert plan.measured_to > 1e-12
    assert "none can be told to be enough" in chosen["method"]
    assert not any("small enough" in why or why.endswith("tried that is good enough") for why in chosen.values())
    assert plan.bounds[0].total > 1e-12
    easy = planned(described(PUSHED), Accuracy(1e-4), np.linspace(0, 2, 41))
    assert easy.reached
    assert {item.kind: item.why for item in easy.items}["method"].startswith("by counted work the cheapest tried here")


def settled_beside(found: Any, *others: Any, shares: tuple[Share, ...] = ()) -> Settled:
    """What was found beside other trials, judged by a run without error of its own."""
    unused: Any = None
    bench: Any = SimpleNamespace(trials=[found, *others])
    stick: Any = SimpleNamespace(known=0.0)
    return Settled(*[unused] * 5, bench, stick, found, frozenset(), True, 1.0, Bound("x", shares, 1.0))


def trial_of(cost: float, error: float = 0.1, scalar: str = "float64", fineness: float = 1e-6) -> Any:
    return SimpleNamespace(cost=cost, error=error, scalar=scalar, method="rk", fineness=fineness)


CHEAPEST, ALIKE, NOTHING = (
    f"by counted work {word}" for word in ("the cheapest", "within a tenth of the cheapest", "")
)


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (trial_of(2.0), CHEAPEST),
        (trial_of(1.0), CHEAPEST),
        (trial_of(0.95), ALIKE),
        (trial_of(0.5), ""),
        (trial_of(0.5, error=0.45), ""),  # beyond what was aimed at, but doubled it is small enough
        (trial_of(0.5, error=0.55), CHEAPEST),
    ],
)
def test_what_is_called_the_cheapest_is_so_by_counted_work(other: Any, told: str) -> None:
    """Costs within a tenth are alike; beside a run that costs half and is good enough, too, nothing is the cheapest."""
    words = _why_method(settled_beside(trial_of(1.0), other), True)
    assert words.endswith("small enough")
    assert words.startswith(told or "its measured error")


@pytest.mark.parametrize(("cost", "told"), [(2.0, CHEAPEST), (0.95, ALIKE), (0.5, "none tried is accurate enough")])
def test_what_is_called_the_cheapest_of_the_least_wrong_is_so(cost: float, told: str) -> None:
    words = _closest(settled_beside(trial_of(1.0), trial_of(cost)))
    assert words.startswith("none tried is accurate enough")
    assert words.removeprefix("none tried is accurate enough: ").startswith(told)


@pytest.mark.parametrize(
    ("scalar", "others", "rounding", "told"),
    [
        ("float64", (), 1e-9, "its rounding stays below the error of the method"),
        ("float64", (), 1e-6, "its rounding is most of the error, and small enough"),
        ("float64", (), None, "good enough"),
        ("float32", (trial_of(2.0),), 1e-9, "its rounding stays below the error of the method, and it costs less"),
        ("float32", (trial_of(0.5),), 1e-9, "its rounding stays below the error of the method"),
        ("extended", (trial_of(0.1, 0.9),), None, "in float64 every error that was measured, doubled, is too large"),
        ("extended", (trial_of(2.0),), None, "it costs less by counted work"),
        ("extended", (trial_of(0.95),), None, "good enough"),
    ],
)
def test_what_is_said_of_rounding_is_what_was_measured(
    scalar: str, others: tuple[Any, ...], rounding: float | None, told: str
) -> None:
    how = None if rounding is None else Certainty.MEASURED
    shares = (Share("integration", 1e-7, Certainty.MEASURED), Share("arithmetic", rounding or 0.0, how))
    words = _why_scalar(settled_beside(trial_of(1.0, scalar=scalar), *others, shares=shares))
    assert words.startswith(told)
    assert ("costs less" in words) == ("costs less" in told)


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (trial_of(0.5, fineness=1e-7), "the coarsest tried that is good enough"),
        (trial_of(2.0, fineness=1e-5), "good enough, and cheaper by counted work than what is coarser"),
        (trial_of(0.95, fineness=1e-5), "good enough"),
        (trial_of(0.95, error=0.6, fineness=1e-5), "the coarsest tried that is good enough"),
    ],
)
def test_what_is_said_of_a_tolerance_is_what_was_tried(other: Any, told: str) -> None:
    assert _why_fineness(settled_beside(trial_of(1.0), other)) == told


@pytest.mark.parametrize(("asked", "time"), [(1e-5, 3.0), (5e-2, 29.5)])
def test_what_a_plan_says_of_its_setting_is_what_the_trials_say(
    monkeypatch: pytest.MonkeyPatch, asked: float, time: float
) -> None:
    """The search aims at less than half of what is tolerable; what it passes by on its way counts, too.

    "The cheapest" stood beside a run that costs a quarter less, and "none is accurate enough" above a bound that is.
    """
    seen: list[Settled] = []

    def watched(settled: Settled) -> Any:
        seen.append(settled)
        return items_of(settled)

    monkeypatch.setattr(planning, "items_of", watched)
    plan = planned(described(CHAOTIC.read_text()), Accuracy(asked), np.linspace(0, time, 401))
    (settled,) = seen
    known = settled.stick.known
    good = [one.cost for one in settled.bench.trials if 2 * (one.error - known) + known <= 1]
    (method,) = (item for item in plan.items if item.kind == "method")
    assert plan.reached
    assert "none tried" not in method.why
    assert settled.trial.cost <= 1.1 * min(good)
    assert (
        "the cheapest tried here" not in method.why or "within a tenth" in method.why or settled.trial.cost == min(good)
    )


def test_quantities_by_name_have_errors_of_their_own() -> None:
    given, times = described(PENDULUM), np.linspace(0, 10, 1001)
    loose = planned(given, Accuracy(None, {"theta": 1e-2}), times)
    assert [bound.quantity for bound in loose.bounds] == ["theta"]
    both = planned(given, Accuracy(1e-2, {ENERGY: 1e-11}), times)
    assert {bound.quantity for bound in both.bounds} >= {ENERGY}
    assert both.reached
    found = simulate(
        given, Request(10.0, 1001, None, both.method, both.setting.tolerance, both.setting.step, both.scalar)
    )
    assert np.max(np.abs(found.trajectory.drift)) <= 1e-11


PULSE = """
mbsym: 1
name: A mass on a spring, struck for a thousandth of a second
parameters: {m: positive, k: positive}
bodies:
  - name: mass
    attached to: 0
    coordinates: [x]
    connection point: [x, 0, 0]
    mass: m
loads:
  - spring: {coordinate: x, stiffness: k}
  - generalized force: {x: 1000*exp(-((t - 7.3)/0.001)**2)}
values: {m: 1, k: 1}
initial: {x: {position: 1, velocity: 0}}
"""


def test_a_short_push_is_not_stepped_over_and_no_coarser_setting_is_said_to_do() -> None:
    """x = cos t + 1000 w sqrt(pi) exp(-w^2/4) sin(t - 7.3) when the push is over, w = 0.001."""
    given, times = described(PULSE), np.linspace(0, 10, 1001)
    plan = planned(given, Accuracy(1e-6), times)
    assert plan.reached
    after = times > 7.4
    push = np.sqrt(np.pi) * np.exp(-(0.001**2) / 4) * np.sin(times - 7.3)
    true = np.cos(times) + push
    error = np.max(np.abs(run_of(given, plan, times)[0] - true)[after]) / np.max(np.abs(true[after]))
    assert error <= plan.bound.total
    assert plan.more is not None
    assert plan.more.seconds is None or plan.more.seconds >= 0.9 * plan.seconds


def test_a_coarse_look_that_breaks_down_ends_no_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between two stiff walls a run at 1e-6 missed a switch, one at 1e-10 does not; a motion that ends does in both."""
    places, looks = pilot.places, []

    def missed(method: Any, dynamics: Any, setting: Setting, end: float) -> Any:
        looks.append(setting.tolerance)
        if len(looks) == 1 or end > 5:
            raise Breakdown("switching without end", "a switch was missed", 1.0, np.zeros(2))
        return places(method, dynamics, setting, end)

    monkeypatch.setattr(planning, "places", missed)
    given = described(PENDULUM)
    assert planned(given, Accuracy(1e-5), np.linspace(0, 5, 101)).reached
    assert looks[1] < looks[0]
    with pytest.raises(Breakdown, match="a switch was missed"):
        planned(given, Accuracy(1e-5), np.linspace(0, 6, 101))


def test_a_reference_whose_coarse_runs_break_down_is_a_finer_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is a setting taken that breaks down."""
    whole = pilot.trial_of

    def broken(method: Any, dynamics: Any, setting: Setting, *more: Any) -> Any:
        found = whole(method, dynamics, setting, *more)
        coarse = (setting.tolerance or 0) > 1e-8
        return replace(found, ended=Breakdown("switching without end", "", 1.0, np.zeros(2))) if coarse else found

    monkeypatch.setattr(pilot, "trial_of", broken)
    plan = planned(described(PENDULUM), Accuracy(1e-5), np.linspace(0, 5, 101))
    assert plan.reached
    assert plan.setting.tolerance is None or plan.setting.tolerance <= 1e-8


def test_what_float64_has_no_room_for_is_measured_in_more_digits() -> None:
    """A millimetre about a place a thousand kilometres away: x = 10^6 + cos(t/1000)/1000, by hand.

    Float64 knows x to a ten-millionth of that: finer runs drowned in steps, and "no run could be had to measure by".
    """
    text = """mbsym: 1
name: far away
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -1e-6*(x - 1e6)}
initial: {x: 1000000.001}
"""
    times = np.linspace(0, 30_000, 101)
    given = scenario(mbsym.loads(text).system)
    plan = planned(given, Accuracy(1e-8), times)
    assert plan.reached
    assert plan.scalar == "extended"
    speed = METHODS[plan.method].start(Dynamics(given), plan.setting, plan.scalar).fill(times)[1]
    error = np.max(np.abs(speed + 1e-6 * np.sin(times / 1000))) / 1e-6
    assert error <= plan.bound.total <= 1e-8


def test_the_python_interface_plans_and_runs() -> None:
    plan = mbsym.plan(mbsym.loads(PENDULUM, ()), 10, {"theta": 1e-5})
    assert [bound.quantity for bound in plan.bounds] == ["theta"]
    run = mbsym.simulate(mbsym.loads(PENDULUM, ()), 10, accuracy=1e-7, samples=501)
    assert run.plan is not None
    assert run.plan.reached
    assert np.max(np.abs(run["theta"] - pendulum_angle(run.times, 2.0))) / 2 <= run.plan.bound.total <= 1e-7
    with pytest.raises(ValueError, match="no quantity phi; theta: an error is between"):
        mbsym.plan(mbsym.loads(PENDULUM, ()), 10, {"phi": 1e-5, "theta": 2.0})


# --- planted lies ---


def test_a_cost_table_turned_over_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the dearest taken for the cheapest the plan says so itself: what it refused costs less."""
    given, times = described(PENDULUM), np.linspace(0, 30, 2001)

    def cheaper_refused(plan: Any) -> bool:
        (method,) = (one for one in plan.items if one.kind == "method")
        fit = [one for one in method.refused if one.error is not None and one.error <= 0.4e-5]
        return any(one.cost is not None and one.cost < plan.seconds / 1.5 for one in fit)

    assert not cheaper_refused(planned(given, Accuracy(1e-5), times))
    original = pilot.Bench.run

    def turned(self: Any, *arguments: Any, **options: Any) -> Any:
        trial = original(self, *arguments, **options)
        return replace(trial, cost=1e-9 / trial.cost)

    monkeypatch.setattr(pilot.Bench, "run", turned)
    found = planned(given, Accuracy(1e-5), times)
    honest = METHODS[found.method]
    monkeypatch.undo()
    bench = pilot.Bench(planning.Dynamics(given), times, times, np.full(3, 1e-5), lambda method: method, np.ones(3))
    taken = bench.run(honest, found.scalar, found.setting, often=True).cost
    best = bench.run(METHODS["dop853"], "float64", Setting(1e-7), often=True).cost
    assert taken > 1.5 * best


def test_a_reference_with_a_wrong_digit_is_noticed_by_the_run_s_own_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    """The yardstick lies: a coarse run passes for good, and the estimate after the run finds it out."""
    from mbsym.simulation.accurate import simulate_accurately

    def lying(bench: Any, method: Any, tolerance: float, goal: float) -> Any:
        coarse = bench.run(method, "float64", Setting(1e-4))
        return Yardstick(coarse, 1e-9, 1e-4)

    monkeypatch.setattr(planning, "yardstick", lying)
    found = simulate_accurately(described(PENDULUM), Request(30.0), Accuracy(1e-8), Pins(method="dop853"))
    assert found.plan is not None
    assert any("repeated more finely" in text for text in found.plan.remarks)


def test_a_run_is_never_judged_by_itself() -> None:
    """A setting that happens to be the reference's has the reference's own error, not zero."""
    given, times = described(PENDULUM), np.linspace(0, 10, 501)
    bench = pilot.Bench(planning.Dynamics(given), times, times, np.full(3, 1e-6), lambda method: method, np.ones(3))
    stick = planning.yardstick(bench, METHODS["dop853"], 1e-8, 0.4)
    bench.stick = stick
    again = bench.run(METHODS["dop853"], stick.trial.scalar, stick.trial.setting)
    assert again.error >= stick.known > 0


OSCILLATOR = """
mbsym: 1
name: oscillator
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
initial: {x: {position: 1, velocity: 0}}
"""


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
@pytest.mark.parametrize("parts", [2500, 5000])
def test_a_longest_step_that_was_asked_for_does_not_make_the_reference_its_own_judge(
    parts: int, tolerance: float
) -> None:
    """x = cos t: with steps that the limit rules, not the tolerance, two runs by one limit would differ by nothing."""
    end = 200.0
    times = np.linspace(0, end, 2001)
    given, targets = described(OSCILLATOR), np.array([1e-3, 1e-3, inf])
    bench = pilot.Bench(
        planning.Dynamics(given), times, times, targets, lambda method: method, np.ones(3), longest=end / parts
    )
    stick = planning.yardstick(bench, METHODS["rk45"], tolerance, 0.4)
    assert stick.trial.setting.longest is not None
    assert stick.trial.setting.longest < end / parts
    true = float(np.max(np.abs(stick.trial.states[0] - np.cos(times)))) / 1e-3
    assert true / 1.5 <= stick.known <= 10 * true


TWO_BOBS = """
mbsym: 1
name: two bobs at nearly one place, either of which may go
parameters: {m1: positive, m2: positive, g: positive, d: positive, c: nonnegative}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass centre: [0, -1, 0], mass: m1}
  - {name: two, attached to: one, mass centre: [0, -1 - d, 0], mass: m2}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
  - damper: {coordinate: theta, coefficient: c}
values: {m1: 1, m2: 1, g: 1, d: 1e-7, c: 1e-9}
initial: {theta: 1}
"""


def test_one_mass_that_must_stay_does_not_keep_all_else() -> None:
    """Without both masses there are no equations; without one of them the pendulum has the length 1, or 1 + d."""
    times = np.linspace(0, 10, 1001)
    plan = planned(described(TWO_BOBS), Accuracy(1e-3), times)
    assert len({"m1", "m2"} & set(plan.model.without)) == 1
    assert "c" in plan.model.without
    true = pendulum_angle(times, 1.0)
    states = run_of(described(TWO_BOBS), plan, times)
    assert np.max(np.abs(states[0] - true)) <= plan.bound.total


# --- laws of the types ---


def test_laws_of_bounds() -> None:
    shares = (
        Share("model", 1e-3, Certainty.ESTIMATED),
        Share("integration", 2e-3, Certainty.MEASURED),
        Share("arithmetic", 0.0, None),
    )
    bound = Bound("theta", shares, 4e-3)
    assert bound.total == pytest.approx(3e-3)
    assert bound.reached
    assert not replace(bound, target=2e-3).reached
    assert bound.how == Certainty.ESTIMATED
    assert replace(bound, shares=shares[1:]).how == Certainty.MEASURED
    assert replace(bound, shares=(Share("model", 0.0, Certainty.PROVED),)).how == Certainty.PROVED


def test_laws_of_accuracies() -> None:
    names = ("theta", "theta_dot", ENERGY)
    assert list(Accuracy(1e-3).targets(names)) == [1e-3, 1e-3, inf]
    assert list(Accuracy(None, {"theta": 1e-3}).targets(names)) == [1e-3, inf, inf]
    assert list(Accuracy(1e-2, {ENERGY: 1e-9}).targets(names)) == [1e-2, 1e-2, 1e-9]
    assert Accuracy(1e-2, {ENERGY: 1e-9}).finest == 1e-9
    assert plan_bounds.DOUBLED >= 2


def test_a_bound_is_never_below_what_the_run_s_own_estimate_finds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a pilot that finds every setting a hundred times better than it is."""
    told = plan_bounds.shares_of

    def flattering(*arguments: Any) -> Any:
        return tuple((name, errors / 100, how) for name, errors, how in told(*arguments))

    monkeypatch.setattr(planning, "shares_of", flattering)
    given = scenario(mbsym.load(SHIPPED / "double-pendulum.yaml", ()).system)
    found = simulate_accurately(given, Request(2.0, samples=21), Accuracy(1e-6))
    assert isinstance(found.error, ErrorEstimate)
    assert found.plan is not None
    assert found.error.largest <= found.plan.bound.total
    quantity = max(found.error.quantities, key=lambda one: one.largest / one.scale)
    assert found.plan.bound.quantity == quantity.name


@pytest.mark.parametrize(
    ("asked", "told"),
    [(Accuracy(named={"x": 1e-3}), 2e-4), (Accuracy(named={ENERGY: 1e-2}), 0.1), (Accuracy(1e-3), 0.05)],
)
def test_errors_are_told_of_what_was_asked_for(asked: Accuracy, told: float) -> None:
    """Of a run whose errors in x, x' and the energy are 2e-4, 0.05 and 0.1: that of the quantity that was asked for.

    "error 5e-2, too coarse" stood beside a run that keeps x to 1e-3.
    """
    unused: Any = None
    bench: Any = SimpleNamespace(targets=asked.targets(("x", "x_dot", ENERGY)))
    settled = Settled(*[unused] * 5, bench, unused, unused, frozenset(), True, 1.0, unused)
    run: Any = SimpleNamespace(errors=np.array([2e-4, 0.05, 0.1]))
    assert _worst(settled, run) == told


@pytest.mark.parametrize("angle", ["0", "2"])
def test_what_another_digit_costs_is_measured(angle: str) -> None:
    """What is named for a digit more or less reaches it, and what is finer costs no less.

    A pendulum at rest, right to the last bit at 1e-2, was told to cost 0.02 times as much with one digit more.
    """
    text = PENDULUM.replace("initial: {theta: 2}", f"initial: {{theta: {angle}}}")
    plan = planned(described(text), Accuracy(1e-6), np.linspace(0, 10, 101))
    assert plan.more is not None
    assert plan.less is not None
    assert plan.more.times >= 0.9
    assert 0.2 < plan.less.times <= 1.1
    if angle == "0":
        return
    for other in (plan.more, plan.less):
        name, tolerance = other.label.split()
        run = mbsym.simulate(mbsym.loads(text, ()), 10, method=name, tolerance=float(tolerance), samples=501)
        assert np.max(np.abs(run["theta"] - pendulum_angle(run.times, 2.0))) / 2 <= other.target


FALLING = """
mbsym: 1
name: falls by many powers of ten
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 400}
  - damper: {coordinate: x, coefficient: 2}
initial: {x: 1000000000000}
"""


def test_what_steps_at_their_stability_err_by_is_not_laid_to_rounding() -> None:
    """x falls to 1e-26 of what it was; steps are then as long as stability lets them, and errors what the tolerance is.

    Two runs in different arithmetic differ by as much as each is wrong, 1e-8 of the size, where a rounding is 1e-16:
    "its rounding is most of the error" was said of float64.
    """
    plan = planned(described(FALLING), Accuracy(1e-6), np.linspace(0, 60, 201))
    assert plan.reached
    (bound,) = plan.bounds
    rounding = next(share for share in bound.shares if share.name == "arithmetic")
    assert rounding.how is None or rounding.error < 1e-12
    assert not any("rounding is most" in item.why for item in plan.items)


def test_nothing_is_told_of_runs_that_part_before_the_end() -> None:
    """Rounding of 64 bits grows by e^(2.1 t) or so: at t = 60 every run is another motion, and errors are unknown.

    Two such runs differ by the size of the motion, and a twentieth of that is no measure of either.
    """
    plan = planned(described(CHAOTIC.read_text(encoding="utf-8")), Accuracy(1e-6), np.linspace(0, 100, 101))
    assert not plan.reached
    assert plan.bound.total == float("inf")
    assert 5 < plan.parted < 60
    (warning,) = (str(text) for title, text in bound_lines(plan, None) if title == "warning")
    assert f"two fine runs part from t = {plan.parted:.3g} on" in warning
    assert (plan.more, plan.less) == (None, None)
    (method,) = (str(item.why) for item in plan.items if item.kind == "method")
    assert method.endswith("none can be told to be enough")


def test_dear_runs_that_part_are_not_made_finer_and_finer(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same where runs count as dear: three tell that no arithmetic here carries to the end, and one is tried."""
    monkeypatch.setattr(pilot, "DEAR", 0.0)
    runs: list[Setting] = []
    run = pilot.Bench.run

    def counted(bench: Any, method: Any, scalar: str, setting: Setting, often: bool = False) -> Any:
        runs.append(setting)
        return run(bench, method, scalar, setting, often)

    monkeypatch.setattr(pilot.Bench, "run", counted)
    given = described(CHAOTIC.read_text(encoding="utf-8"))
    assert planned(given, Accuracy(1e-6), np.linspace(0, 100, 101)).parted < 60
    assert len(runs) <= 5
    assert planned(given, Accuracy(1e-6), np.linspace(0, 2, 101)).reached
