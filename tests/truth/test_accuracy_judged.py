"""What ``--accuracy`` promises, judged by solutions of equations that were written by hand (``truth/independent``).

Over the whole interval, at irregular times: the run is within its bound, the bound within what was asked for, and the
bound is worth something: not a thousand times the error.
"""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from truth.independent.scenes import SCENES, Scene
from truth.independent.solve import agreement, places, states_of

import mbsym
from mbsym.numerics import accuracy
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning import pilot, planning
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.scenario import scenario
from mbsym.numerics.states import dynamics_of
from mbsym.numerics.trade import tradeoff
from mbsym.simulation import accurate
from mbsym.simulation.accurate import simulate_accurately
from mbsym.simulation.request import Request
from mbsym.simulation.result import Simulation

SOLUTIONS = json.loads((Path(__file__).parent / "independent" / "solutions.json").read_text(encoding="utf-8"))
SIZES = json.loads((Path(__file__).parent / "independent" / "sizes.json").read_text(encoding="utf-8"))

#: Van der Pol's oscillator about its highest velocity: from there comes its error, and it is gone at the next place.
PEAK = json.loads((Path(__file__).parent / "independent" / "peak.json").read_text(encoding="utf-8"))

#: Rounding of one number, and what a handful of them make; a bound needs not be better.
FLOOR = 1e-13


@cache
def exact(name: str) -> Any:
    """(2n, m), to more digits than a float has."""
    more = PEAK["states"] if name == "van der pol" else []
    return np.array([*SOLUTIONS[name]["states"], *more], dtype=np.longdouble).T


def true_errors(name: str, computed: Any) -> Any:
    """Of each component, relative to its size in the whole motion, peaks between the places included."""
    truth = exact(name)
    size = np.max(np.abs(truth), axis=1)
    if name in SIZES:
        size = np.maximum(size, SIZES[name])
    return np.max(np.abs(computed - truth), axis=1) / np.where(size > 0, size, 1)


FINE = [pytest.param(scene, 1e-8, id=f"{scene.name} 1e-8") for scene in SCENES]
COARSE = [pytest.param(scene, 1e-4, id=f"{scene.name} 1e-4") for scene in SCENES]


def judged(scene: Scene, found: Any) -> float:
    """The largest of the true errors of a simulation."""
    times = np.array([*places(scene.time), *(PEAK["times"] if scene.name == "van der pol" else [])])
    order = np.argsort(times)
    states = found.at(times[order])[:, np.argsort(order)]
    return float(np.max(true_errors(scene.name, states)))


@pytest.mark.parametrize(("scene", "target"), [*FINE, *COARSE])
def test_what_is_promised_is_kept(scene: Scene, target: float) -> None:
    given = scenario(mbsym.loads(scene.text).system)
    found = simulate_accurately(given, Request(scene.time, samples=101), Accuracy(target))
    assert found.plan is not None
    assert found.whole
    error = judged(scene, found)
    bound = found.plan.bound.total
    assert error <= bound
    assert found.plan.reached
    assert error <= target
    assert bound <= max(1000 * error, FLOOR)
    if isinstance(found.error, ErrorEstimate):  # what the run itself is found to be wrong by is within its bound
        assert found.error.largest <= found.plan.bound.total


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_the_estimate_of_a_plain_run_is_true(scene: Scene) -> None:
    """Whatever ``simulate`` chooses by itself: the error it tells is the error, within a factor, or none is told."""
    found = mbsym.simulate(mbsym.loads(scene.text), scene.time, samples=101, estimate=True)
    error = judged(scene, found)
    if isinstance(found.error, ErrorEstimate):
        assert error <= 3 * found.error.largest + FLOOR
        assert found.error.largest <= 1000 * error + FLOOR


@pytest.mark.parametrize("scene", [x for x in SCENES if x.name in ("kepler", "furuta")], ids=lambda x: x.name)
def test_what_a_trade_tells_is_true(scene: Scene) -> None:
    """Each error in the table is that of such a run, and the advice follows from the rows: none of them is quicker
    among those that reach the target; the target of a digit more is reached by what is named for it."""
    given = scenario(mbsym.loads(scene.text).system)
    found = tradeoff.studied(given, [METHODS["dop853"], METHODS["rk4"]], scene.time, 2.0, False).trade
    times, dynamics = np.array(places(scene.time)), dynamics_of(given)
    order = np.argsort(times)
    rows = [row for row in found.rows if 100 * found.reference.error < row.error < 1e-2 and row.error > FLOOR]
    assert len(rows) > 10
    for row in rows[::3]:
        how = row
        states = np.array(how.method.start(dynamics, how.setting, how.scalar).fill(times[order]))
        error = float(np.max(true_errors(scene.name, states[:, np.argsort(order)])))
        assert row.error / 100 < error < 2 * row.error, how.label
    target = 1e-5
    text = str(tradeoff.advice(found, target))
    reaching = [row for row in found.rows if row.error + found.reference.error <= target]
    best = min(reaching, key=lambda row: row.seconds)
    assert text.startswith(f"{best.label} reaches 1e-05 in the least time measured here: error {best.error:.1e} ")
    finer = min((row for row in reaching if row.error <= target / 10), key=lambda row: row.seconds)
    assert f"{finer.seconds / best.seconds:.2g} times as much ({finer.label})" in text or finer is best


@pytest.mark.parametrize("name", ["kepler", "contact"])
def test_the_solutions_are_made_as_is_said(name: str) -> None:
    """Made again, by another order and other steps."""
    scene = next(scene for scene in SCENES if scene.name == name)
    again = states_of(scene, 50, 0.8)
    with mpmath.workdps(60):
        known = [[mpmath.mpf(text) for text in row] for row in SOLUTIONS[name]["states"]]
    assert agreement(again, known) < 1e-20


def test_all_scenes_are_known_to_many_digits() -> None:
    assert SOLUTIONS.keys() == {scene.name for scene in SCENES}
    assert all(entry["agreement"] < 1e-20 for entry in SOLUTIONS.values())


@pytest.mark.parametrize("name", ["elastic", "three", "top"])
def test_a_wrong_digit_is_noticed(name: str) -> None:
    """The judge itself: a state that is off by 1e-6 of its size fails at a target of 1e-8."""
    scene = next(scene for scene in SCENES if scene.name == name)
    found = mbsym.simulate(mbsym.loads(scene.text), scene.time, samples=101, tolerance=1e-13)
    states = found.at(np.array(places(scene.time)))
    assert float(np.max(true_errors(name, states))) < 1e-8
    states[0] *= 1 + 1e-6
    assert float(np.max(true_errors(name, states))) > 1e-8


# --- planted lies ---


def accurately(text: str, time: float, target: float) -> Simulation:
    """Estimated, too."""
    return mbsym.simulate(mbsym.loads(text), time, samples=101, estimate=True, accuracy=target)


def broken_promises(found: Simulation, error: float, target: float) -> list[str]:
    """What a plan, its run and the estimate of that run say, and is not so by an independent solution, the ``error``.

    So is a plan's setting that the estimate of its run contradicts: the run is repeated more finely then.
    """
    assert found.plan is not None
    bound = found.plan.bound
    broken = {
        "bound": error <= bound.total,
        "reached": found.plan.reached is (bound.total <= target) and (error <= target or not found.plan.reached),
        "doubled": isinstance(found.error, ErrorEstimate) and 1.8 * found.error.largest <= bound.integrated,
        "setting": not any("by the estimate of that run" in text for text in found.plan.remarks),
        "estimate": isinstance(found.error, ErrorEstimate) and error <= 3 * found.error.largest + FLOOR,
    }
    return [promise for promise, kept in broken.items() if not kept]


def estimated_by_itself(patched: pytest.MonkeyPatch) -> None:
    def itself(dynamics: Any, found: Any, method: Any, scalar: str, completed: Any) -> Any:
        return iter([(method, scalar, found.setting)])

    patched.setattr(accuracy, "_candidates", itself)
    patched.setattr(accuracy, "WITNESSES", {})


def trials_skipped(patched: pytest.MonkeyPatch) -> None:
    """What judges passes for what came of every setting that is tried."""
    run = pilot.Bench.run

    def skipped(bench: Any, method: Any, scalar: str, setting: Any, often: bool = False) -> Any:
        if bench.stick is None or method.traits.fixed:
            return run(bench, method, scalar, setting, often)
        trial = replace(bench.stick.trial, method=method, scalar=scalar, setting=setting, error=bench.stick.known)
        trial = replace(trial, errors=np.zeros(len(trial.states)))
        bench.trials.append(replace(trial, states=None))
        return trial

    patched.setattr(pilot.Bench, "run", skipped)


def bound_halved(patched: pytest.MonkeyPatch) -> None:
    """And not raised again by the run's own estimate."""
    bounds_of = planning.bounds_of

    def halved(scene: Any, accuracy: Any, shares: Any) -> Any:
        return bounds_of(scene, accuracy, tuple((name, errors / 2, how) for name, errors, how in shares))

    patched.setattr(planning, "bounds_of", halved)
    patched.setattr(accurate, "_raised", lambda plan, found: plan.bounds)


def reference_of_the_same_settings(patched: pytest.MonkeyPatch) -> None:
    """A run that is as coarse as what it judges, said to be known."""

    def same(bench: Any, method: Any, tolerance: float, goal: float, *most: int) -> Any:
        return pilot.Yardstick(bench.run(method, "float64", Setting(1e-5)), 1e-12, 1e-5)

    patched.setattr(planning, "yardstick", same)


LIES = [
    (None, []),
    (estimated_by_itself, ["estimate"]),
    (trials_skipped, ["setting"]),
    (bound_halved, ["doubled"]),
    (reference_of_the_same_settings, ["setting"]),
]


@pytest.mark.parametrize(("lie", "promises"), LIES)
def test_each_planted_lie_is_caught(lie: Any, promises: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """An estimate of a run with itself, a trial that is skipped, a bound halved, a reference as coarse as the rest."""
    if lie is not None:
        lie(monkeypatch)
    scene = next(scene for scene in SCENES if scene.name == "kepler")
    found = accurately(scene.text, scene.time, 1e-8)
    broken = broken_promises(found, judged(scene, found), 1e-8)
    assert {*promises} <= {*broken} if promises else not broken
