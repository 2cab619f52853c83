"""Estimated errors of runs against their true errors: closed solutions, and equations written by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import SHIPPED, STATEMENTS, STIFF

import mbsym
from mbsym.numerics.accuracy import Against, ErrorEstimate, Lacking, NoEstimate, contradicted
from mbsym.numerics.kernels.llvm import available
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.methods.landing import Landing
from mbsym.numerics.methods.runge_kutta import RungeKutta
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.methods.tableaux import DOP853, RODAS5P
from mbsym.numerics.simulate import Rests
from mbsym.numerics.trade.comparison import Comparison, Difference
from mbsym.report.runs.simulation_words import error_json, error_lines, warnings
from mbsym.report.runs.summary import result_lines
from mbsym.simulation import Simulation

needs_extended = pytest.mark.skipif(not available("extended"), reason="this machine has no extended arithmetic")

#: (q, q') at one time.
Solution = Callable[[Any], list[Any]]


def oscillator(t: Any) -> list[Any]:
    return [mpmath.cos(t), -mpmath.sin(t)]


def kepler(t: Any) -> list[Any]:
    """a = 1, e = 9/10 from the perihelion: E - e sin E = t."""
    e = mpmath.mpf(9) / 10
    anomaly = mpmath.findroot(lambda x: x - e * mpmath.sin(x) - t, t + e * mpmath.sin(t)) if t else mpmath.mpf(0)
    c, s, b = mpmath.cos(anomaly), mpmath.sin(anomaly), mpmath.sqrt(1 - e * e)
    return [c - e, b * s, -s / (1 - e * c), b * c / (1 - e * c)]


def falling(t: Any) -> list[Any]:
    """A bob on a telescope without friction falls freely: a parabola in polar coordinates, r counted from l = 1."""
    g, angle = mpmath.mpf("9.81"), mpmath.mpf("0.4")
    x, y, v = mpmath.sin(angle) / 2, -mpmath.cos(angle) / 2 - g * t * t / 2, -g * t
    rho = mpmath.hypot(x, y)
    return [rho + 1, mpmath.atan2(x, -y), y * v / rho, x * v / rho**2]


def decaying(t: Any) -> list[Any]:
    """x' = v, v' = -1e6 v - x, stiff, and y'' = -y: both by their exact roots."""
    root = mpmath.sqrt(mpmath.mpf(10) ** 12 - 4)
    fast, slow = (-(mpmath.mpf(10) ** 6) - root) / 2, (-(mpmath.mpf(10) ** 6) + root) / 2
    a, b = -slow / (fast - slow), fast / (fast - slow)
    position = a * mpmath.exp(fast * t) + b * mpmath.exp(slow * t)
    speed = a * fast * mpmath.exp(fast * t) + b * slow * mpmath.exp(slow * t)
    return [position, mpmath.cos(t), speed, -mpmath.sin(t)]


def true_errors(run: Simulation, solution: Solution, rows: int = 60) -> tuple[float, float]:
    """(at the end, at worst over some rows), each quantity relative to its largest value."""
    places = np.unique(np.linspace(0, len(run.times) - 1, rows).astype(int))
    states = run.trajectory.states
    with mpmath.workdps(40):
        truth = np.array([solution(mpmath.mpf(float(run.times[k]))) for k in places], dtype=object).T
        size = np.array([max(abs(x) for x in row) for row in truth])
        # An extended number is the sum of two doubles.
        heads = states[:, places].astype(float)
        tails = (states[:, places] - heads).astype(float)
        errors = np.array(
            [
                [float(abs(mpmath.mpf(h) + mpmath.mpf(r) - x) / s) for h, r, x in zip(hs, rs, xs, strict=True)]
                for hs, rs, xs, s in zip(heads, tails, truth, size, strict=True)
            ]
        )
    return float(np.max(errors[:, -1])), float(np.max(errors))


SETTINGS: list[dict[str, Any]] = [
    {},
    {"tolerance": 1e-5},
    {"tolerance": 1e-15},
    {"tolerance": 1e-18},
    {"method": "rk45"},
    {"method": "rk4", "step": 1e-2},
    {"method": "lsoda"},
    {"method": "lsoda", "tolerance": 2e-14},
    {"arithmetic": "float32"},
    {"arithmetic": "float32", "tolerance": 1e-9},
]


@needs_extended
@pytest.mark.parametrize(
    "setting", SETTINGS, ids=lambda given: " ".join(f"{k}={v}" for k, v in given.items()) or "auto"
)
@pytest.mark.parametrize(("case", "solution"), [("osc", oscillator), ("kepler", kepler), ("arm3", falling)])
def test_estimates_are_true(case: str, solution: Solution, setting: dict[str, Any]) -> None:
    """Also where the tolerance is below what the arithmetic has: no run is compared with itself."""
    run = mbsym.simulate(STATEMENTS / f"{case}.yaml", 6, estimate=True, **setting)
    assert isinstance(run.error, ErrorEstimate)
    final, worst = true_errors(run, solution)
    rounding = run.error.rounding
    assert final / 2 <= run.error.final <= 2 * max(final, rounding)
    assert worst / 2 <= run.error.largest <= 30 * max(worst, rounding)  # the worst row may not be among those looked at


@needs_extended
def test_estimates_of_stiff_systems_are_true() -> None:
    run = mbsym.simulate(mbsym.loads(STIFF, ()), 2, estimate=True)
    assert run.chosen.method.traits.implicit
    assert isinstance(run.error, ErrorEstimate)
    position = run.error.quantities[0]
    with mpmath.workdps(40):
        truth = [decaying(mpmath.mpf(float(t)))[0] for t in run.times[[0, 500, 2000]]]
    errors = [abs(float(mpmath.mpf(x) - y)) for x, y in zip(run["x"][[0, 500, 2000]], truth, strict=True)]
    assert position.final == pytest.approx(errors[-1], rel=0.5, abs=1e-16)
    assert true_errors(run, decaying, 5)[0] <= 2 * run.error.final


@needs_extended
@pytest.mark.parametrize(("case", "solution"), [("osc", oscillator), ("kepler", kepler), ("arm3", falling)])
def test_the_finest_run_is_judged_by_an_extrapolation(
    monkeypatch: pytest.MonkeyPatch, case: str, solution: Solution
) -> None:
    """No method has more digits; 160 bits have."""
    monkeypatch.setattr("mbsym.numerics.accuracy.PRECISE_COST", 30.0)
    run = mbsym.simulate(STATEMENTS / f"{case}.yaml", 3, arithmetic="extended", tolerance=1e-19)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.against.scalar == "160 bits"
    final, worst = true_errors(run, solution)
    assert final / 3 <= run.error.final <= 3 * max(final, run.error.rounding)
    assert worst / 3 <= run.error.largest <= 30 * max(worst, run.error.rounding)


@needs_extended
def test_the_finest_run_has_no_estimate_where_that_takes_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.numerics.accuracy.PRECISE_COST", 1e-3)
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 1, arithmetic="extended", tolerance=1e-19)
    assert run.error == NoEstimate(Lacking.FINEST)
    assert list(error_lines(run.error)) == [f"not estimated: {Lacking.FINEST.value}"]
    assert error_json(run.error).available is False


@pytest.mark.parametrize("tolerance", [1e-15, 1e-16, 1e-18])
@pytest.mark.parametrize(("case", "solution"), [("osc", oscillator), ("kepler", kepler), ("arm3", falling)])
def test_without_finer_arithmetic_a_clamped_tolerance_is_not_compared_with_itself(
    monkeypatch: pytest.MonkeyPatch, case: str, solution: Solution, tolerance: float
) -> None:
    """1e-16 and 1e-18 are one run in float64: their difference, 0, is no error."""
    monkeypatch.setattr("mbsym.numerics.accuracy.PRECISE_COST", 30.0)
    monkeypatch.setattr("mbsym.numerics.accuracy.available", lambda scalar: scalar != "extended")
    run = mbsym.simulate(STATEMENTS / f"{case}.yaml", 6, tolerance=tolerance)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.against.scalar == "160 bits"
    final, worst = true_errors(run, solution)
    assert final / 3 <= run.error.final <= 3 * max(final, run.error.rounding)
    assert worst / 3 <= run.error.largest <= 30 * max(worst, run.error.rounding)


def test_a_planted_comparison_of_a_run_with_itself_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: were the run its own better one, its error would be that of rounding, and is not."""
    monkeypatch.setattr(
        "mbsym.numerics.accuracy._candidates",
        lambda dynamics, found, method, scalar, completed: iter([(method, scalar, found.setting)]),
    )
    witnessed = mbsym.simulate(STATEMENTS / "kepler.yaml", 6, tolerance=1e-7, estimate=True)
    final, _ = true_errors(witnessed, kepler)
    assert isinstance(witnessed.error, ErrorEstimate)
    assert final / 2 <= witnessed.error.final, "the witness finds it out"
    monkeypatch.setattr("mbsym.numerics.accuracy.WITNESSES", {})
    alone = mbsym.simulate(STATEMENTS / "kepler.yaml", 6, tolerance=1e-7, estimate=True)
    assert isinstance(alone.error, ErrorEstimate)
    assert not final / 2 <= alone.error.final


def test_without_finer_arithmetic_a_coarse_run_is_judged_by_a_finer_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mbsym.numerics.accuracy.available", lambda scalar: scalar != "extended")
    coarser = mbsym.simulate(STATEMENTS / "osc.yaml", 6, tolerance=1e-8).error
    assert isinstance(coarser, ErrorEstimate)
    assert (coarser.against.scalar, coarser.against.setting.tolerance) == ("float64", pytest.approx(1e-10))


def test_a_pulse_that_was_stepped_over_is_noticed() -> None:
    """x(10) = cos 10 + sqrt(pi) sin 5 by the impulse 1000 * 0.001 * sqrt(pi); the run has cos 10."""
    run = mbsym.simulate(STATEMENTS / "pulse.yaml", 10, estimate=True)
    truth = np.cos(10) + np.sqrt(np.pi) * np.exp(-1e-6 / 4) * np.sin(5)
    assert isinstance(run.error, ErrorEstimate)
    if abs(run["x"][-1] - truth) > 1e-3:
        assert run.error.quantities[0].final == pytest.approx(abs(run["x"][-1] - truth), rel=1e-3)
        assert any("stepped over something short" in text for text in warnings(run.conservation, run.error))
    else:
        assert run.error.quantities[0].final < 1e-3


def test_what_rests_by_symmetry_is_measured_by_the_scene() -> None:
    """The cart under two opposite pendulums stays where it is: rounding of it is no chaos."""
    run = mbsym.simulate(STATEMENTS / "symmetric_cart.yaml", 10, estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    by_name = {q.name: q for q in run.error.quantities}
    assert by_name["x"].rests
    assert by_name["x_dot"].rests
    assert not by_name["a"].rests
    # Kinetic energy 2 (a'^2/2) at most 2 g (1 - cos 0.7); M = 3 for the cart.
    kinetic = 2 * 9.81 * (1 - np.cos(0.7))
    assert by_name["x_dot"].scale == pytest.approx(np.sqrt(2 * kinetic / 3), rel=1e-3)
    assert run.error.largest < 1e-8
    assert not list(warnings(run.conservation, run.error))
    assert any("at rest but for rounding, as far as can be told: x, x_dot;" in text for text in error_lines(run.error))


def test_what_rests_in_both_runs_is_not_measured_by_nothing() -> None:
    """A block that dry friction holds: no "0.0e+00", and no "sizes below 0.0e+00"."""
    text = """
mbsym: 1
name: Block
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -x - sign(x_dot)}
initial: {x: 1/2}
"""
    told = list(error_lines(mbsym.simulate(mbsym.loads(text), 5).error))
    assert "at rest in this run and in the better one: x_dot" in told


def test_sizes_are_those_of_the_whole_motion() -> None:
    """At whole periods the velocity of an oscillator is nearly 0, which is no size of it."""
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 4 * np.pi, samples=3, estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    assert [q.size for q in run.error.quantities] == pytest.approx([1, 1], rel=1e-3)
    assert run.error.largest < 1e-8


def test_light_motion_is_measured_by_itself() -> None:
    """A swing of 1e-9 rad is motion, not rest."""
    start = {"theta1": 1e-9, "theta2": 0, "theta1_dot": 0, "theta2_dot": 0}
    run = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 3, values=start, tolerance=1e-13, estimate=True)
    assert isinstance(run.error, ErrorEstimate)
    assert not any(q.rests for q in run.error.quantities)
    assert 1e-9 < run.error.largest < 1e-5, "roundings of angles of about 1 are 1e-16"


def test_an_estimate_that_a_conserved_energy_belies_is_withdrawn() -> None:
    against = Against("dop853", "float64", Setting(1e-12))
    difference = Difference("x", 1e-9, 1e-9, 1.0, 1.0, 1.0, 0.0)
    compared = Comparison((difference,), 1.0, 10, True, None, np.array([0.0, 1.0]), np.zeros((1, 2)))
    estimate = ErrorEstimate(against, compared, 1e-16)
    assert contradicted(estimate, 0.5)
    assert not contradicted(estimate, 1e-8)
    assert not contradicted(NoEstimate(Lacking.NOT_ASKED), 0.5)


def test_a_coarse_run_is_called_so() -> None:
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 100, method="rk4", step=1.0, every=1.0, estimate=True)
    final, worst = true_errors(run, oscillator, 101)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.final == pytest.approx(final, rel=1e-6)
    assert run.error.largest == pytest.approx(worst, rel=1e-2)
    assert any("little in common" in text for text in warnings(run.conservation, run.error))


def test_a_run_across_a_pole_has_no_estimate_and_the_reason() -> None:
    """U = 1/(x - 1/2): thrown at the wall, steps of 0.2 jump through it, and any better run ends at it or turns."""
    wall = (
        STIFF[: STIFF.index("parameters:")]
        + """parameters: {m: 1}
bodies:
  - {name: ball, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - force function: 1/(x - 1/2)**2
initial: {x: {position: 1, velocity: -1}}
"""
    )
    run = mbsym.simulate(mbsym.loads(wall, ()), 2, method="rk4", step=0.2, estimate=True)
    assert run.whole
    assert isinstance(run.error, NoEstimate)
    assert run.error.why is Lacking.BREAKS_DOWN
    assert list(error_lines(run.error)) == [f"not estimated: {Lacking.BREAKS_DOWN.value}"]


def test_steps_that_a_longest_step_rules_are_not_compared_with_the_same_steps() -> None:
    """x'' = -x in steps of 1 whatever the tolerance: held against cos t."""
    text = """
mbsym: 1
name: p
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: x**2/2
initial: {x: 1}
"""
    request = {"method": "dop853", "tolerance": 0.1, "max_step": 1.0}
    found = mbsym.simulate(mbsym.loads(text), 2000.0, samples=4001, estimate=True, **request)
    assert isinstance(found.error, ErrorEstimate)
    error = float(np.max(np.abs(found.at(found.times)[0] - np.cos(found.times))))
    assert error > 1e-5
    assert found.error.largest == pytest.approx(error, rel=0.2)


def test_an_estimate_that_nobody_asked_for_is_cut_and_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Asked for it gets its time: the budget, here none at all, is of others only."""
    monkeypatch.setattr("mbsym.simulation.run.LEAST", 0.0)
    monkeypatch.setattr("mbsym.simulation.run.AT_MOST", 0.0)
    system = mbsym.loads(STIFF.replace("c: 1e6", "c: 1e3"))
    run = mbsym.simulate(system, 1)
    assert run.error == NoEstimate(Lacking.CUT)
    assert "--estimate" in " ".join(error_lines(run.error))
    assert isinstance(mbsym.simulate(system, 1, estimate=True).error, ErrorEstimate)


@needs_extended
@pytest.mark.parametrize("tableau", [DOP853, RODAS5P], ids=lambda tableau: tableau.name)
def test_a_method_that_is_wrong_itself_is_not_judged_by_itself(tableau: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: weights that are too large, so that all its runs solve x' = (1 + 1e-5) f, or nearly, and agree."""
    wrong = replace(tableau, weights=tuple(weight * Fraction(100_001, 100_000) for weight in tableau.weights))
    monkeypatch.setitem(METHODS, tableau.name, Landing(RungeKutta(wrong)))
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 6, method=tableau.name, estimate=True)
    final, worst = true_errors(run, oscillator)
    assert worst > 1e-6
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.against.method != tableau.name
    assert final / 2 <= run.error.final <= 2 * final
    assert worst / 2 <= run.error.largest <= 2 * worst


UPRIGHT = """
mbsym: 1
name: Pendulum
bodies:
  - {name: b, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [0, -1, 0], mass: 1}
loads: [{uniform gravity: {vector: [0, -981/100, 0]}}]
initial: {a: ANGLE}
"""


@pytest.mark.parametrize(
    ("angle", "begins"), [("pi", True), ("0", True), ("-3*pi", True), ("3.14159265358979", False), ("1/10^13", False)]
)
def test_a_motion_that_begins_in_an_equilibrium(angle: str, begins: bool) -> None:
    """a'' = -9.81 sin(a): told where sin(a) = 0, and not where a double is all but there."""
    run = mbsym.simulate(mbsym.loads(UPRIGHT.replace("ANGLE", angle)), 10)
    assert run.begins_in_equilibrium is begins
    assert any(title == "motion" for title, _ in result_lines(run, "x.yaml")) is begins
    assert run.trajectory.work.steps < 5000  # the rounding of pi does not rule them


def test_what_begins_in_an_equilibrium_is_exact_without_a_plan() -> None:
    """a = pi stays: upright, roundings would grow as exp(3.13 t); nothing is planned, every row is the first."""
    upright = mbsym.loads(UPRIGHT.replace("ANGLE", "pi"))
    run = mbsym.simulate(upright, 30, accuracy=1e-9)
    assert run.plan is None
    assert run.trajectory.work.evaluations == 0
    assert np.all(run.trajectory.states == [[np.pi], [0]])
    assert np.all(run.at([0.1, 29.9]) == [[np.pi] * 2, [0] * 2])
    assert np.all(mbsym.simulate(upright, 30)["a"] == np.pi)
    assert not np.all(mbsym.simulate(upright, 30, method="rk45")["a"] == np.pi)  # as it was asked for
    with pytest.raises(Rests):
        mbsym.plan(upright, 30, 1e-9)


@pytest.mark.parametrize("start", ["{a: {position: pi, velocity: 1}}", "{a: pi}"])
def test_what_is_pushed_or_driven_is_in_no_equilibrium(start: str) -> None:
    """By its velocity, or by a force that is zero at first: a'' = -9.81 sin(a) + t."""
    text = UPRIGHT.replace("{a: ANGLE}", start)
    text = text if "velocity" in start else text.replace("loads: [", "loads: [{generalized force: {a: t}}, ")
    assert not mbsym.simulate(mbsym.loads(text), 1).begins_in_equilibrium


@pytest.mark.parametrize(("force", "begins"), [("sqrt(x)", False), ("x*sqrt(x**2 + 1)", True)])
def test_where_slopes_are_infinite_what_rests_may_leave(force: str, begins: bool) -> None:
    """Norton's dome: x'' = sqrt(x) has the solution t^4/144 beside x = 0."""
    text = (
        UPRIGHT[: UPRIGHT.index("bodies:")]
        + f"""bodies:
  - {{name: b, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}}
loads: [{{generalized force: {{x: {force}}}}}]
initial: {{x: 0}}
"""
    )
    assert mbsym.simulate(mbsym.loads(text), 1, estimate=False).begins_in_equilibrium is begins


def test_small_motions_beside_zero_keep_their_digits() -> None:
    """a = 1e-13 cos(sqrt(g) t) below: what is no rounding of a position is followed to its own size."""
    run = mbsym.simulate(mbsym.loads(UPRIGHT.replace("ANGLE", "1/10^13")), 10)
    assert run["a"] == pytest.approx(1e-13 * np.cos(np.sqrt(9.81) * run.times), abs=1e-13 * 1e-6)
