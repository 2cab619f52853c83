"""The measured trade: references of known error, ladders, orders, models, coordinates that rest, and the command."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import dynamics_of, filed, invoked

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.expressions.tree import number
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.reduced import resting
from mbsym.numerics.scenario import scenario
from mbsym.numerics.trade import reference_search
from mbsym.numerics.trade.fidelity import measured, model_advice
from mbsym.numerics.trade.reference_search import Reference, solved_at, whole_reference
from mbsym.numerics.trade.tradeoff import Measured, Tradeoff, advice, studied, tradeoff

ROOT = Path(__file__).parents[2]
SYSTEMS = ROOT / "systems"
TRUTH = Path(__file__).parents[1] / "references"

PENDULUM = """
mbsym: 1
name: Pendulum of the IFToMM library
parameters: {m: positive, L: positive, g: positive}
bodies:
  - name: bob
    attached to: 0
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -L, 0]
    mass: m
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {theta: 0}
values: {m: 1, L: 1, g: 9.81}
initial: {theta: -pi/2}
"""


def shipped(name: str, **values: int | Fraction) -> Dynamics:
    overrides = {key: number(value) for key, value in values.items()}
    return Dynamics(scenario(mbsym.load(SYSTEMS / name).system, overrides))


# --- the reference ---


def test_reference_agrees_with_the_closed_form_of_the_pendulum_and_knows_its_error() -> None:
    """sin(theta/2) = k cd(sqrt(g/L) t | 1/2): references/iftomm_a01_pendulum.json, 18 digits."""
    truth = json.loads((TRUTH / "iftomm_a01_pendulum.json").read_text())["reference"]["xy"]
    times = [0.0, *map(float, truth)]
    states = solved_at(dynamics_of(PENDULUM), times, 1e-24, 120.0)
    assert 0 < whole_reference(dynamics_of(PENDULUM), times[-1], 120.0).error < 1e-17
    for place, key in enumerate(truth, 1):
        x, y = (float(word) for word in truth[key])
        theta = float(states[0, place])
        assert abs(np.sin(theta) - x) < 1e-15
        assert abs(-np.cos(theta) - y) < 1e-15


def test_the_estimated_error_of_a_coarse_reference_is_no_smaller_than_its_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    dynamics = shipped("double-pendulum.yaml")
    for name, tolerance in (("FINE", 1e-12), ("ROUGH", 1e-9), ("BETWEEN", 1e-12)):
        monkeypatch.setattr(reference_search, name, tolerance)
    coarse = whole_reference(dynamics, 5.0, 60.0)
    places = np.linspace(0, len(coarse.times) - 1, 40).astype(int)
    fine = solved_at(dynamics, coarse.times[places], 1e-24, 120.0)
    error = np.max(np.abs(fine - coarse.states[:, places]) / np.asarray(coarse.scale)[:, np.newaxis])
    assert 0 < error <= coarse.error < 1e-4


def test_a_solution_that_does_not_exist_breaks_down() -> None:
    from mbsym.numerics.methods.interface import Breakdown

    text = PENDULUM.replace("uniform gravity: {acceleration: g, direction: [0, -1, 0]}", "force function: theta**4")
    with pytest.raises(Breakdown):
        whole_reference(dynamics_of(text), 20.0, 20.0)


# --- the trade ---


@pytest.fixture(scope="module")
def trade() -> Tradeoff:
    dynamics = shipped("double-pendulum.yaml")
    chosen = [METHODS[name] for name in ("rk4", "dop853")]
    return tradeoff(dynamics, chosen, whole_reference(dynamics, 4.0, 60.0), budget=12.0)


def test_fixed_step_methods_have_their_nominal_order(trade: Tradeoff) -> None:
    orders = {(item.method, item.scalar): item for item in trade.orders}
    found = orders["rk4", "float64"]
    assert found.nominal == 4
    assert found.pairs >= 3
    assert abs(found.measured - 4) < 0.3


def test_the_front_holds_what_nothing_beats(trade: Tradeoff) -> None:
    """Errors below the least that is judged are one."""

    def judged(row: Measured) -> tuple[float, float]:
        return max(row.error, trade.smallest_judged), row.seconds

    for row in trade.rows:
        own = judged(row)  # clocks tick: two rows may take the same time
        noworse = {judged(x) for x in trade.rows if judged(x)[0] <= own[0] and x.seconds <= row.seconds}
        assert row.front <= (noworse == {own} and row.error < inf)
        assert row.front or noworse != {own} or row.error == inf or any(x.front for x in trade.rows if judged(x) == own)


def test_tolerances_are_not_mistaken_for_errors(trade: Tradeoff) -> None:
    """The error grows along a chaotic trajectory: a tolerance of 1e-6 gives a larger one, and a finer one less."""
    rows = [r for r in trade.rows if r.method.traits.name == "dop853" and r.scalar == "float64"]
    errors = {row.setting.tolerance: row.error for row in rows}
    tolerances = sorted((t for t in errors if t is not None), reverse=True)
    assert len(tolerances) >= 6
    assert errors[tolerances[0]] > 1e3 * errors[tolerances[5]]
    assert len({*errors.values()} - {*tolerances}) == len(errors)


def test_advice_names_the_cheapest_setting_that_is_good_enough(trade: Tradeoff) -> None:
    text = advice(trade, 1e-6)
    best = trade.cheapest(1e-6)
    assert best is not None
    assert text.startswith(best.label)
    assert "one digit more costs" in text
    assert "one digit less" in text


def test_advice_refuses_targets_that_the_reference_cannot_judge(trade: Tradeoff) -> None:
    poor = replace(trade, reference=replace(trade.reference, error=1e-10))
    assert "cannot be judged" in advice(poor, 1e-9)
    assert "cannot be judged" not in advice(poor, 1e-7)


def test_a_wrong_reference_is_noticed_in_every_ladder() -> None:
    """Negative control: errors stop falling at the size of the planted mistake."""
    dynamics = shipped("double-pendulum.yaml")
    truth = whole_reference(dynamics, 1.0, 60.0)
    planted: Reference = replace(truth, states=truth.states * (1 + 1e-5))
    found = tradeoff(dynamics, [METHODS["dop853"]], planted, budget=2.0)
    assert min(row.error for row in found.rows) > 1e-6


def test_an_interrupt_keeps_the_rows_there_are() -> None:
    dynamics = shipped("double-pendulum.yaml")
    truth = whole_reference(dynamics, 1.0, 60.0)
    labels: list[str] = []

    def stop_later(label: str) -> None:
        labels.append(label)
        if len(labels) == 4:
            raise KeyboardInterrupt

    found = tradeoff(dynamics, [METHODS["dop853"]], truth, 10.0, stop_later)
    assert found.interrupted
    assert len(found.rows) == 3


# --- models ---


def test_models_converge_to_the_exact_field_order_by_order() -> None:
    """Each order of (size)/R = 1/25 gains more than a factor of 5 here; nothing else differs."""
    dynamics = shipped("satellite.yaml")
    rows = {r.model: r for r in measured(dynamics.scenario, METHODS["dop853"], np.linspace(0, 5, 3))}
    second, third, fourth = (rows[k].error for k in ("as described", "gravity of order 3", "gravity of order 4"))
    assert rows["exact gravity"].error == 0
    assert second > 5 * third > 25 * fourth > 1e-8
    assert rows["linearised"].operations < rows["as described"].operations / 5


def test_linearised_equations_err_quadratically_in_the_amplitude() -> None:
    """A pendulum: the neglected term is theta^3/6, so the relative error falls with the square of the amplitude."""
    errors = []
    for amplitude in (Fraction(1, 50), Fraction(1, 100)):
        numbers = scenario(mbsym.loads(PENDULUM).system, {"theta": number(amplitude)})
        rows = {r.model: r for r in measured(numbers, METHODS["dop853"], np.linspace(0, 3, 7))}
        errors.append(rows["linearised"].error)
    assert abs(errors[0] / errors[1] - 4) < 0.2


# --- coordinates that rest ---

PLANE = {name: number(0) for name in ("psi", "phi", "sigma", "psi_dot", "phi_dot", "sigma_dot")}


def test_the_satellite_in_the_plane_of_its_orbit_has_two_degrees_of_freedom() -> None:
    found = resting(scenario(mbsym.load(SYSTEMS / "satellite.yaml").system, PLANE))
    assert found is not None
    assert found.how == Certainty.PROVED
    assert set(found.values) == {"psi", "phi", "sigma"}
    assert found.scenario.system.coordinates == ("theta", "delta")


def test_the_reduced_system_moves_like_the_whole_one() -> None:
    whole = scenario(mbsym.load(SYSTEMS / "satellite.yaml").system, PLANE)
    found = resting(whole)
    assert found is not None
    times = [0.0, 7.0]
    free, _ = found.expanded(whole)
    both = [solved_at(Dynamics(item), times, 1e-16, 120.0)[:, -1] for item in (whole, found.scenario)]
    assert np.max(np.abs(both[0][list(free)] - both[1])) < 1e-13
    assert np.max(np.abs(np.delete(both[0], list(free)))) == 0


@pytest.mark.parametrize("pushed", ["psi", "phi", "sigma"])
def test_coordinates_that_are_pushed_are_kept(pushed: str) -> None:
    """Negative control: off the plane, every out-of-plane coordinate is pushed by the others."""
    found = resting(scenario(mbsym.load(SYSTEMS / "satellite.yaml").system, PLANE | {pushed: number(Fraction(1, 10))}))
    assert found is None


def test_a_moving_coordinate_is_no_candidate() -> None:
    moving = PLANE | {"sigma_dot": number(1)}
    assert resting(scenario(mbsym.load(SYSTEMS / "satellite.yaml").system, moving)) is None


# --- the command ---


def run(*words: Any, code: int | None = None) -> Any:
    return invoked("tradeoff", *words, code=code)


def test_the_command_writes_a_table_and_a_figure_and_gives_advice(tmp_path: Path) -> None:
    found = run(
        SYSTEMS / "double-pendulum.yaml",
        "--time",
        2,
        "--target",
        "1e-6",
        "--budget",
        8,
        "-m",
        "rk4,dop853",
        "--out",
        tmp_path,
        code=0,
    )
    assert "estimated error" in found.output
    assert "reaches 1e-06 in the least time measured here" in found.output
    rows = list(csv.DictReader((tmp_path / "tradeoff.csv").read_text().splitlines()))
    assert {"rk4", "dop853"} <= {row["method"] for row in rows}
    assert any(row["front"] == "yes" for row in rows)
    assert (tmp_path / "work-precision.png").read_bytes()[:4] == b"\x89PNG"
    assert "<svg" in (tmp_path / "work-precision.svg").read_text()
    models = list(csv.DictReader((tmp_path / "fidelity.csv").read_text().splitlines()))
    assert [row["model"] for row in models] == ["as described", "linearised"]


def test_every_series_looks_different() -> None:
    from mbsym.report.figures.tradeoff_figure import _DASHES, _INSIDE, _styles

    styles = _styles(METHODS)
    assert len({colour for colour, _ in styles.values()}) == len(METHODS)
    assert len({str(_DASHES[scalar]) for scalar in _DASHES}) == len(set(_INSIDE.values())) == 3
    many = _styles(f"method {i}" for i in range(50))
    assert len(set(many.values())) == 50


def test_everything_wrong_is_said_at_once(tmp_path: Path) -> None:
    found = run(SYSTEMS / "double-pendulum.yaml", "--time", "soon", "--target", 2, "-s", "l3=1", "-m", "euler", code=2)
    for word in ("soon", "--target: error[bad-number]: choose between", "l3", "euler", "4 errors; nothing was written"):
        assert word in found.output


def test_missing_values_are_listed(tmp_path: Path) -> None:
    path = filed(tmp_path / "bare.yaml", PENDULUM[: PENDULUM.index("values")])
    found = run(path, "--time", 1, code=2)
    assert "m, L, g, theta (its initial position)" in found.output


def test_a_finite_escape_time_is_an_answer(tmp_path: Path) -> None:
    path = tmp_path / "escape.yaml"
    text = PENDULUM.replace("uniform gravity: {acceleration: g, direction: [0, -1, 0]}", "force function: theta**4")
    path.write_text(text)
    found = run(path, "--time", 20, "--out", tmp_path, code=3)
    assert "no reference solution up to t = 20" in found.output


@pytest.mark.parametrize("angle", ["pi", "0"])
def test_an_equilibrium_has_no_best_method(angle: str, tmp_path: Path) -> None:
    """No run of it is better than another, and those that roundings move are not chaotic."""
    path = tmp_path / "upright.yaml"
    path.write_text(PENDULUM)
    found = run(path, "--time", 5, "--set", f"theta={angle}", "--out", tmp_path, code=1)
    assert "there is nothing to compare: the initial state is an equilibrium" in found.output


def test_a_trial_that_fails_in_a_way_that_nobody_foresaw_costs_its_ladder_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: Any) -> Any:
        raise ValueError("planted")

    monkeypatch.setattr(METHODS["scipy-rk45"], "start", broken)
    path = filed(tmp_path / "pendulum.yaml", PENDULUM)
    words = ("--time", 2, "--target", "1e-6", "--budget", 8, "-m", "scipy-rk45,dop853", "--out", tmp_path)
    found = run(path, *words, code=1)
    assert "internal error, please report it: ValueError: planted" in found.output
    assert "dop853" in found.output
    assert "reaches 1e-06 in the least time measured here" in found.output
    rows = list(csv.DictReader((tmp_path / "tradeoff.csv").read_text().splitlines()))
    failed = [row for row in rows if row["method"] == "scipy-rk45"]
    assert [(row["error"], row["trouble"]) for row in failed] == [("", "internal error: ValueError: planted")]


def gravity_models(text: str, tmp_path: Path, time: int = 1000) -> dict[str, str]:
    path = filed(tmp_path / "system.yaml", text)
    words = (path, "--time", time, "--target", "1e-6", "--budget", 60, "--methods", "dop853", "--out", tmp_path)
    run(*words, code=0)
    models = csv.DictReader((tmp_path / "fidelity.csv").read_text().splitlines())
    return {row["model"]: row["error"] for row in models}


def test_exact_gravity_is_the_most_faithful_model_where_it_is_described(tmp_path: Path) -> None:
    """A dumbbell of 2000 km at R = 7000 km: the terms above order 4 are (l/R)^3 of those of order 2, not nothing."""
    text = (SYSTEMS / "dumbbell.yaml").read_text()
    long = text.replace("l: 30}", "l: 2000000}")
    exact = gravity_models(long.replace("order: 2", "order: exact"), tmp_path)
    errors = {model: float(error) for model, error in exact.items()}
    assert errors["as described"] == 0
    assert errors["gravity of order 2"] > errors["gravity of order 3"] > errors["gravity of order 4"] > 1e-4
    expanded = gravity_models(long, tmp_path)
    assert float(expanded["exact gravity"]) == 0
    assert float(expanded["as described"]) == pytest.approx(errors["gravity of order 2"], rel=1e-3)


def test_fields_about_their_own_centre_are_not_expanded(tmp_path: Path) -> None:
    """Kepler's problem with the centre as O1 (R = 0): there is no expansion in size/R."""
    assert set(gravity_models(KEPLER, tmp_path, 20)) == {"as described"}


KEPLER = """
mbsym: 1
name: Kepler
parameters: {mu: positive}
bodies:
  - {name: planet, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - newtonian gravity: {constant: mu, centre: 0, about: 0, order: exact}
values: {mu: 1e6}
initial: {x: 100, y: {position: 0, velocity: 90}}
"""


# --- what is said of the trade ---

CASES = Path(__file__).parents[1] / "cases" / "statements"


def test_what_rests_by_symmetry_spoils_no_error() -> None:
    """The cart under two opposite pendulums stays where it is; its rounding, relative to itself, would be 1."""
    dynamics = Dynamics(scenario(mbsym.load(CASES / "symmetric_cart.yaml").system))
    found = studied(dynamics.scenario, [METHODS["dop853"]], 6.0, 60.0, False).trade
    assert found.reference.error < 1e-15
    assert min(row.error for row in found.rows) < 1e-11
    assert "reaches 1e-09 in the least time measured here" in advice(found, 1e-9)


def test_errors_at_whole_periods_are_parts_of_the_motion() -> None:
    """x = cos t at multiples of 2 pi: the velocity is 0 there, which is no size of it."""
    dynamics = Dynamics(scenario(mbsym.load(CASES / "osc.yaml").system))
    found = studied(dynamics.scenario, [METHODS["rk4"]], 64 * 2 * np.pi, 1.0, False).trade
    assert found.reference.scale == pytest.approx([1, 1], rel=1e-3)
    for row in found.rows:
        step = row.setting.step
        if row.scalar == "float64" and step is not None and step < 0.05:  # |error| = t h^4 / 120 + ..., of the phase
            assert row.error == pytest.approx(64 * 2 * np.pi * step**4 / 120, rel=0.01, abs=1e-12)


def test_a_target_is_reached_with_the_error_of_the_reference(trade: Tradeoff) -> None:
    """A row of 0.999 of the target, against a reference that is wrong by a hundredth of it, has not reached it."""
    row = replace(trade.rows[0], error=0.999e-6, trouble="", seconds=1e-9)
    planted = replace(trade, rows=(row,), reference=replace(trade.reference, error=1e-8))
    assert planted.cheapest(1e-6) is None
    assert "Nothing tried reaches 1e-06" in advice(planted, 1e-6)
    assert planted.cheapest(1.1e-6) is row


def test_errors_below_the_rounding_of_what_is_compared_are_none(trade: Tradeoff) -> None:
    """Reference and solutions are compared as float64: 1e-19 is no error that could be seen."""
    assert trade.smallest_judged >= 2**-52
    assert "cannot be judged" in advice(trade, 1e-17)


def test_nothing_that_came_to_the_end_is_said_to_be_accurate(trade: Tradeoff) -> None:
    rows = tuple(replace(row, error=inf, trouble="step limit") for row in trade.rows[:2])
    assert advice(replace(trade, rows=rows), 1e-6) == "Nothing tried reaches 1e-06: no run came to the end."


def test_the_models_own_error_is_part_of_the_advice() -> None:
    """A dumbbell of 2000 km in a field of order 2 is off by more than any solution of its equations."""
    text = (SYSTEMS / "dumbbell.yaml").read_text().replace("l: 30}", "l: 2000000}")
    study = studied(scenario(mbsym.loads(text).system), [METHODS["dop853"]], 1000.0, 0.3, True)
    assert "an error of 1e-09 is one of its equations, not of the motion" in model_advice(study.models, 1e-9)
    assert "which adds to the error" in model_advice(study.models, 0.5)
    exact = text.replace("order: 2", "order: exact")
    study = studied(scenario(mbsym.loads(exact).system), [METHODS["dop853"]], 1000.0, 0.3, True)
    assert model_advice(study.models, 1e-9) == ""
