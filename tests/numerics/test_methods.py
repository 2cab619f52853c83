"""Integration methods: measured orders, published solutions, conservation, stiffness, and how each one fails."""

from __future__ import annotations

import ctypes
import gc
import signal
import sys
import weakref
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import cos, exp, sin, sqrt
from typing import Any

import numpy as np
import pytest
from conftest import OWN, SHIPPED, dynamics_of, reference
from scipy import integrate

import mbsym
from mbsym.expressions.tree import number
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.elimination import factorise, solve
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import SCALARS, available, compiled
from mbsym.numerics.kernels.writer import INTEGER, POINTER, Function
from mbsym.numerics.methods import runge_kutta, symplectic
from mbsym.numerics.methods.interface import Breakdown, Cause, Setting, Unusable, once
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.methods.tableaux import DOP853, RK4, RK45, RODAS5P, Clock
from mbsym.numerics.scenario import scenario

FIXED = [name for name, method in METHODS.items() if method.traits.fixed]
ADAPTIVE = [name for name, method in METHODS.items() if not method.traits.fixed]
STIFF = ["rodas5p", "lsoda", "radau", "bdf"]


@pytest.fixture(scope="module")
def kepler() -> Dynamics:
    return dynamics_of(OWN / "kepler.yaml")


@pytest.fixture(scope="module")
def pendulum() -> Dynamics:
    return dynamics_of(SHIPPED / "double-pendulum.yaml")


def start(name: str, dynamics: Dynamics, scalar: str = FLOAT64, **setting: Any) -> Any:
    """A run, skipped where an extra or an arithmetic is missing."""
    extra = METHODS[name].traits.extra
    if extra is not None:
        pytest.importorskip(extra)
    if not available(scalar):
        pytest.skip(f"no {scalar}")
    return METHODS[name].start(dynamics, Setting(**setting), scalar)


def ellipse(t: float) -> Any:
    """Kepler's problem with e = 3/5, a = 1: (x, y, x', y') from Kepler's equation t = E - e sin E."""
    e = 0.6
    anomaly = t
    for _ in range(100):
        anomaly -= (anomaly - e * sin(anomaly) - t) / (1 - e * cos(anomaly))
    r, b = 1 - e * cos(anomaly), sqrt(1 - e * e)
    return np.array([cos(anomaly) - e, b * sin(anomaly), -sin(anomaly) / r, b * cos(anomaly) / r])


def orders(steps: list[float], errors: list[float]) -> float:
    """The slope of log(error) over log(step), by least squares."""
    slope, _ = np.polyfit(np.log(steps), np.log(errors), 1)
    return float(slope)


# --- coefficients ---


def test_coefficients_are_those_of_scipy_and_satisfy_order_conditions() -> None:
    """A second source, and the quadrature conditions sum b c^(k-1) = 1/k far beyond double precision."""
    for tableau, other in ((RK45, integrate.RK45), (DOP853, integrate.DOP853)):
        stages = len(tableau.stages)
        ours = np.zeros((stages, stages))
        for i, row in enumerate(tableau.stages):
            ours[i, : len(row)] = [float(x) for x in row]
        width = other.A.shape[1]
        assert np.array_equal(ours[:, :width], other.A[:stages])
        assert np.array_equal([float(x) for x in tableau.weights], other.B)
    assert np.allclose([float(x) for x in RK45.errors[0]], other_error(integrate.RK45), rtol=0, atol=1e-17)
    assert np.allclose([float(x) for x in DOP853.errors[0]], integrate.DOP853.E5, rtol=0, atol=1e-16)
    assert np.allclose([float(x) for x in DOP853.errors[1]], integrate.DOP853.E3, rtol=0, atol=1e-16)
    assert np.array_equal([[float(x) for x in row] for row in DOP853.dense], integrate.DOP853.D)
    for tableau in (RK4, RK45, DOP853):
        nodes = [sum(row, Fraction(0)) for row in tableau.stages]
        for k in range(1, tableau.order + 1):
            total = sum(b * c ** (k - 1) for b, c in zip(tableau.weights, nodes, strict=True))
            assert abs(total - Fraction(1, k)) < Fraction(1, 10**27), (tableau.name, k)
        for row in tableau.errors:
            assert abs(sum(row)) < Fraction(1, 10**26)


def other_error(method: Any) -> Any:
    return method.E


def test_compositions_satisfy_their_conditions() -> None:
    """sum g = 1 exactly, sum g^3 = 0 for order 4, and sum g^5 = 0 besides for order 6; symmetric."""
    for method in symplectic.METHODS:
        g = method.fractions
        assert sum(g) == 1
        assert g == g[::-1]
        for power in range(3, method.order, 2):
            assert abs(sum(x**power for x in g)) < Fraction(1, 10**18), (method.name, power)


# --- orders of the fixed-step methods ---

STEPS = {
    "rk4": (0.05, 0.02, 0.01),
    "midpoint": (0.02, 0.01, 0.005),
    "midpoint4": (0.05, 0.02, 0.01),
    "midpoint6": (0.05, 0.02, 0.0125),
}


@pytest.mark.parametrize("name", FIXED)
def test_measured_orders_on_the_kepler_problem(name: str, kepler: Dynamics) -> None:
    errors = []
    for step in STEPS[name]:
        run = start(name, kepler, step=step)
        errors.append(float(np.abs(run.advance(5.0) - ellipse(5.0)).max()))
    assert orders(list(STEPS[name]), errors) == pytest.approx(METHODS[name].traits.order, abs=0.3)


@pytest.mark.parametrize("name", FIXED)
def test_measured_orders_on_the_double_pendulum(name: str, pendulum: Dynamics) -> None:
    """Non-separable kinetic energy; the truth is dop853 at 1e-13, a thousand times better than any error here."""
    truth = start("dop853", pendulum, tolerance=1e-14).advance(4.0)
    steps = [0.005, 0.0025, 0.00125] if name == "rk4" else [0.02, 0.01, 0.005]
    errors = [float(np.abs(start(name, pendulum, step=h).advance(4.0) - truth).max()) for h in steps]
    assert orders(steps, errors) == pytest.approx(METHODS[name].traits.order, abs=0.3)


def test_orders_would_be_missed_by_a_wrong_coefficient(kepler: Dynamics) -> None:
    """The negative control: rk4 with weights that sum to 1 but are wrong is of order 1."""
    wrong = replace(RK4, name="wrong", weights=tuple(Fraction(x, 6) for x in (2, 1, 2, 1)))
    method = runge_kutta.RungeKutta(wrong)
    steps = [0.01, 0.005, 0.0025]
    errors = [float(np.abs(method.start(kepler, Setting(step=h)).advance(5.0) - ellipse(5.0)).max()) for h in steps]
    assert orders(steps, errors) < 2.5


def test_energy_of_composed_midpoint_rules_is_of_their_order() -> None:
    """SUNDIALS' ark_kepler: the error of the Hamiltonian at t = 50 for the published steps, order within 0.3."""
    published = reference("kepler_order")
    steps = published["reference"]["published_McLachlan4"]["dt"]
    tolerance = published["suggested_tolerance"]["order_abs"]
    theirs = [abs(x) for x in published["reference"]["published_McLachlan4"]["H_minus_H0"]]
    assert orders(steps[1:], theirs[1:]) == pytest.approx(4, abs=tolerance)
    dynamics = dynamics_of(OWN / "kepler.yaml")
    for name, order in (("midpoint4", 4), ("midpoint6", 6)):
        errors = []
        for step in steps[1:]:
            x, y, vx, vy = start(name, dynamics, step=step).advance(float(published["parameters"]["tf"]))
            errors.append(abs((vx * vx + vy * vy) / 2 - 1 / np.hypot(x, y) - float(Fraction(-1, 2))))
            # The angular momentum is a quadratic invariant, which the midpoint rule conserves exactly.
            assert abs(x * vy - y * vx - float(Fraction(published["reference"]["L0"]))) < 1e-13
        assert orders(steps[1:], errors) == pytest.approx(order, abs=tolerance)
    x, y, vx, vy = start("rk4", dynamics, step=0.05).advance(50.0)
    assert abs(x * vy - y * vx - 0.8) > 1e-6  # what is no variational method drifts


def test_energy_does_not_drift_over_many_periods(pendulum: Dynamics) -> None:
    """Ten thousand steps: the energy error of the midpoint rule stays where it was, that of rk4 grows."""
    kernel = runge_kutta.compiled_kernel(pendulum, "relative_energy")
    worst: dict[str, list[float]] = {}
    for name, step in (("midpoint", 0.02), ("rk4", 0.04)):
        run = start(name, pendulum, step=step)
        energies = []
        for k in range(1, 401):
            energies.append(float(kernel(np.concatenate(([0.0], run.advance(float(k)))))[0]))
        first = float(kernel(np.concatenate(([0.0], [float(x) for x in pendulum.scenario.state])))[0])
        errors = np.abs(np.array(energies) - first)
        worst[name] = [errors[:100].max(), errors[300:].max()]
    assert worst["midpoint"][1] < 2 * worst["midpoint"][0]
    assert worst["rk4"][1] > 2.5 * worst["rk4"][0]


# --- adaptive methods ---


@pytest.mark.parametrize("name", ADAPTIVE)
def test_errors_decrease_with_the_tolerance(name: str, kepler: Dynamics) -> None:
    slow = name in ("radau", "bdf")
    errors = []
    for tolerance in (1e-3, 1e-5, 1e-7) if slow else (1e-4, 1e-7, 1e-10):
        run = start(name, kepler, tolerance=tolerance)
        errors.append(float(np.abs(run.advance(10.0) - ellipse(10.0)).max()))
        assert run.work.steps > 0
    assert errors[0] > 5 * errors[1] > 25 * errors[2]
    assert errors[2] < (1e-3 if slow else 1e-6)


@pytest.mark.parametrize("scalar", [FLOAT64, EXTENDED, FLOAT32])
@pytest.mark.parametrize("name", ["rk45", "dop853", "taylor"])
def test_times_between_steps_are_as_accurate_as_steps(name: str, scalar: str, kepler: Dynamics) -> None:
    tolerance = {FLOAT32: 1e-6}.get(scalar, 1e-11)
    run = start(name, kepler, scalar, tolerance=tolerance)
    errors = [float(np.abs(run.advance(t) - ellipse(t)).max()) for t in np.linspace(0, 6, 301)[1:]]
    assert max(errors) < 3000 * tolerance
    assert run.work.steps < 300 or name == "rk45"
    direct = start(name, kepler, scalar, tolerance=tolerance)
    direct.advance(6.0)
    assert abs(direct.work.steps - run.work.steps) <= 3  # asking more often costs no steps


def test_dense_output_of_order_seven(kepler: Dynamics) -> None:
    """The same steps, seen in their middle: a coefficient of the interpolant gone wrong would cost many digits."""
    coarse = start("dop853", kepler, tolerance=1e-9)
    coarse.advance(3.0)
    start_, length = (float(coarse.clock[place]) for place in (Clock.START, Clock.LAST))
    ends = [start_ + s * length for s in (0.0, 0.3, 0.5, 0.8, 1.0)]
    states = coarse.curve()(np.array(ends)).T
    between = [float(np.abs(state - ellipse(t)).max()) for state, t in zip(states, ends, strict=True)]
    assert max(between[1:4]) < 20 * max(between[0], between[4]) + 1e-10


#: x'' = -(1 + sin t) x' - x + cos(3 t) (2 - x x'): neither linear nor autonomous.
DRIVEN = """
mbsym: 1
name: driven
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -(1 + sin(t))*x_dot - x + cos(3*t)*(2 - x*x_dot)}
initial: {x: {position: 1, velocity: 1/2}}
"""


def errors_of(method: Any, lengths: Sequence[float], place: float, end: float = 2.0) -> list[float]:
    """The largest error at ``place`` (0 to 1) in steps of these lengths, which no tolerance shortens."""
    dynamics = dynamics_of(DRIVEN)
    truth = METHODS["dop853"].start(dynamics, Setting(1e-14))
    known = [truth.step() for _ in iter(lambda: truth.time < end, False)]
    found = []
    for length in lengths:
        run = method.start(dynamics, Setting(tolerance=1e3, longest=length))
        worst, steps = 0.0, []
        while run.time < end - length / 2:
            run.clock[Clock.STEP] = length
            steps.append(run.step())
        for step in steps:
            t = step.start + place * (step.end - step.start)
            exact = next(piece(t) for piece in known if piece.start <= t <= piece.end)
            worst = max(worst, float(np.max(np.abs(step(t) - exact))))
        found.append(worst)
    return found


LENGTHS = (0.04, 0.02, 0.01)


@pytest.mark.parametrize(("place", "order"), [(1.0, 5), (0.3, 5), (0.7, 5)])
def test_steps_and_dense_output_of_rodas5p_are_of_order_five(place: float, order: int) -> None:
    """Dense output is of order 4 by itself: an error of h^5 in each step, as much as all steps add up to."""
    method = next(one for one in runge_kutta.METHODS if one.traits.name == "rodas5p")
    assert orders(LENGTHS, errors_of(method, LENGTHS, place)) == pytest.approx(order, abs=0.4)


@pytest.mark.parametrize("what", ["slopes", "times", "coupling", "stages", "weights", "dense"])
def test_orders_of_rodas5p_would_be_missed_by_any_wrong_coefficient(what: str) -> None:
    """The negative control: one number of each kind is wrong in its third digit."""
    given = getattr(RODAS5P, what)
    first = given[-1] if isinstance(given[-1], tuple) else given
    spoiled = (first[0], first[1] + Fraction(1, 250), *first[2:])
    wrong = replace(RODAS5P, name=f"wrong {what}", **{what: spoiled if first is given else (*given[:-1], spoiled)})
    place = 0.3 if what == "dense" else 1.0
    assert orders(LENGTHS, errors_of(runge_kutta.RungeKutta(wrong), LENGTHS, place)) < 4.3


@pytest.mark.parametrize("size", [1, 2, 5, 40])
@pytest.mark.parametrize("kind", [FLOAT64, EXTENDED])
def test_linear_equations_in_machine_code(size: int, kind: str) -> None:
    """Random ones, and those of permutations, which without exchanged rows have no solution."""
    if not available(kind):
        pytest.skip(f"no {kind}")
    scalar = SCALARS[kind]
    f = Function("linear", [("matrix", POINTER), ("vector", POINTER)])
    exchanged = f.slot(INTEGER, size)
    factorise(f, scalar.type, f["matrix"], size, exchanged)
    solve(f, scalar.type, f["matrix"], f["vector"], size, exchanged)
    f.leave(0)
    codes = {"rhs": dynamics_of(DRIVEN).right_hand_side}
    linear = compiled(codes, kind, f.text(), many=False).function(
        "linear", *[ctypes.c_void_p] * 2, result=ctypes.c_int64
    )
    generator = np.random.default_rng(size)
    for matrix in (
        generator.normal(size=(size, size)),
        np.eye(size)[generator.permutation(size)],
        7 * np.eye(size)[::-1],
    ):
        wanted = generator.normal(size=size)
        left, right = matrix.astype(scalar.dtype), (matrix @ wanted).astype(scalar.dtype)
        linear(left.ctypes.data, right.ctypes.data)
        assert right.astype(float) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def test_extended_arithmetic_gives_more_digits(kepler: Dynamics) -> None:
    """Arenstorf's orbit is traced back to its start: errors are amplified a million times on the way."""
    dynamics = dynamics_of(OWN / "restricted-three-bodies.yaml")
    published = reference("cr3bp")["parameters"]["arenstorf"]
    initial = np.array([0.994, 0, 0, float(published["yd0"])])
    errors = {}
    for scalar in (FLOAT64, EXTENDED):
        # Next to the moon the acceleration is 300: a period rounded to float64 would hide the extended result.
        period = np.longdouble(published["period"]) if scalar == EXTENDED else float(published["period"])
        end = start("dop853", dynamics, scalar, tolerance=1e-17).advance(period)
        errors[scalar] = float(np.abs(end - initial).max())
    assert errors[FLOAT64] < float(reference("cr3bp")["suggested_tolerance"]["arenstorf_abs"])
    assert errors[EXTENDED] < errors[FLOAT64] / 30
    end = start("taylor", dynamics, tolerance=1e-15).advance(float(published["period"]))
    assert np.abs(end - initial).max() < 1e-6


@pytest.mark.parametrize("scalar", [FLOAT64, FLOAT32, EXTENDED])
def test_close_rows_of_taylor_series_are_those_of_its_steps(scalar: str, pendulum: Dynamics) -> None:
    pytest.importorskip("heyoka")
    pieces, filling = (start("taylor", pendulum, scalar, tolerance=1e-8) for _ in range(2))
    parts = np.linspace(0.0, 3.0, 700), np.linspace(3.0, 20.0, 1500)[1:]
    found = np.hstack([filling.fill(part) for part in parts])
    times, steps = np.concatenate(parts), []
    expected = [np.asarray(pieces.state)[:, None]]
    while pieces.time < times[-1]:
        steps.append(piece := pieces.step())
        within = (piece.start < times) & (times <= piece.end)
        expected.append(piece(times[within]))
    assert np.array_equal(found, np.hstack(expected))
    assert filling.work.steps == len(steps) > 100


@pytest.mark.parametrize("name", ["dop853", "rk45", "taylor"])
def test_the_pleiades(name: str) -> None:
    """Seven stars with close encounters (Hairer, Norsett & Wanner); 13 published digits."""
    published = reference("ivp_pleiades")["reference"]
    run = start(name, dynamics_of(OWN / "pleiades.yaml"), tolerance=1e-13)
    end = run.advance(3.0)
    for i in range(7):
        for place, key in ((2 * i, "x"), (2 * i + 1, "y"), (14 + 2 * i, "vx"), (15 + 2 * i, "vy")):
            assert end[place] == pytest.approx(float(published[key][i]), rel=1e-9, abs=1e-9), (key, i)


CONSERVATIVE = [
    "double-pendulum", "heavy-top", "spherical-pendulum", "spring-pendulum", "spatial-arm",
]  # fmt: skip


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_all_kinds_of_methods_agree_on_shipped_systems(name: str) -> None:
    """A variational method never sees the accelerations, and an explicit one never the Lagrangian."""
    dynamics = dynamics_of(SHIPPED / f"{name}.yaml")
    end = start("dop853", dynamics, tolerance=1e-13).advance(0.5)
    other = start("midpoint6", dynamics, step=0.0025).advance(0.5)
    scale = np.maximum(np.abs(end), 1.0)
    assert np.max(np.abs(other - end) / scale) < 1e-8
    series = start("taylor", dynamics, tolerance=1e-15).advance(0.5)
    assert np.max(np.abs(series - end) / scale) < 1e-10


def test_variational_methods_in_a_turning_frame() -> None:
    """A prescribed rotation puts terms linear in q' into L; order 4 holds there too."""
    dynamics = dynamics_of(OWN / "restricted-three-bodies.yaml")
    truth = start("dop853", dynamics, tolerance=1e-14).advance(0.02)
    steps = [0.002, 0.001, 0.0005]
    errors = [float(np.abs(start("midpoint4", dynamics, step=h).advance(0.02) - truth).max()) for h in steps]
    assert orders(steps, errors) == pytest.approx(4, abs=0.4)


def test_float32_runs_in_float32(pendulum: Dynamics) -> None:
    truth = start("dop853", pendulum, tolerance=1e-13).advance(1.0)
    for name, setting in (("rk4", {"step": 0.005}), ("dop853", {"tolerance": 1e-5})):
        run = start(name, pendulum, FLOAT32, **setting)
        end = run.advance(1.0)
        assert end.dtype == np.float32
        error = np.abs(end - truth).max()
        assert 1e-9 < error < 1e-3


# --- stiffness ---

STIFF_SYSTEM = """
mbsym: 1
name: Stiff damper
parameters: {m: 1, k: 1000000, c: 1000000}
bodies:
  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
initial:
  x: {position: 1, velocity: 0}
"""


def overdamped(t: float) -> float:
    """x'' + c x' + k x = 0 with c = k = 10^6 from rest at 1; the roots are about -1 and -10^6."""
    c = k = 1e6
    root = sqrt(c * c / 4 - k)
    fast, slow = -c / 2 - root, -k / (c / 2 + root)
    return (fast * exp(slow * t) - slow * exp(fast * t)) / (fast - slow)


@pytest.mark.parametrize("name", STIFF)
def test_stiff_systems_take_few_steps(name: str) -> None:
    dynamics = dynamics_of(STIFF_SYSTEM)
    run = start(name, dynamics, tolerance=1e-8, step_limit=5000)
    assert run.advance(1.0)[0] == pytest.approx(overdamped(1.0), rel=1e-5)
    assert run.work.steps < 2000
    if name != "lsoda":  # LSODA does not tell
        assert run.work.jacobians > 0
    explicit = start("dop853", dynamics, tolerance=1e-8, step_limit=5000)
    with pytest.raises(Breakdown) as failed:
        explicit.advance(1.0)
    assert failed.value.kind == Cause.STEP_LIMIT
    assert 0 < failed.value.time < 0.1


# --- what goes wrong ---

POLE = """
mbsym: 1
name: Pole
bodies:
  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - force function: 2*x**3
initial:
  x: {position: 1, velocity: 2}
"""


@pytest.mark.parametrize("name", list(METHODS))
def test_a_pole_of_the_solution_is_reported(name: str, recwarn: pytest.WarningsRecorder) -> None:
    """x'' = 6 x^2 with x = 1/(1 - t)^2: there is nothing beyond t = 1."""
    dynamics = dynamics_of(POLE)
    setting = {"step": 1e-3} if METHODS[name].traits.fixed else {"tolerance": 1e-6}
    run = start(name, dynamics, step_limit=200_000, **setting)
    half = run.advance(0.5)
    assert half == pytest.approx([4, 16], rel=1e-2)
    with pytest.raises(Breakdown) as failed:
        run.advance(2.0)
    assert failed.value.kind in (Cause.BLOW_UP, Cause.STUCK)
    assert failed.value.time == pytest.approx(1, abs=0.05)
    assert len(failed.value.state) == 2
    assert np.all(np.isfinite(failed.value.state))
    assert not [w for w in recwarn if issubclass(w.category, RuntimeWarning)]


@pytest.mark.parametrize("name", list(METHODS))
def test_the_step_limit_is_kept(name: str, pendulum: Dynamics) -> None:
    setting = {"step": 1e-3} if METHODS[name].traits.fixed else {"tolerance": 1e-9}
    run = start(name, pendulum, step_limit=50, **setting)
    with pytest.raises(Breakdown) as failed:
        run.advance(100.0)
    assert failed.value.kind == Cause.STEP_LIMIT
    assert 0 < failed.value.time < 100
    assert len(failed.value.state) == 4
    assert run.work.steps <= 50


@pytest.mark.parametrize("name", [name for name in METHODS if name != "taylor"])
def test_a_start_that_is_singular_is_reported(name: str) -> None:
    """1/x at x = 0."""
    text = POLE.replace("2*x**3", "-1/x").replace("position: 1", "position: 0")
    setting = {"step": 1e-2} if METHODS[name].traits.fixed else {"tolerance": 1e-6}
    if name in ("midpoint", "midpoint4", "midpoint6"):
        setting, text = {"step": 1e-2}, text.replace("velocity: 2", "velocity: 0")
    with pytest.raises(Breakdown) as failed:
        start(name, dynamics_of(text), step_limit=10_000, **setting).advance(1.0)
    assert failed.value.time < 0.05


@pytest.mark.parametrize("force", ["-sign(x)*sqrt(abs(x)) - 100000*x_dot", "sqrt(t)"])
def test_rodas5p_does_not_step_from_where_a_derivative_is_infinite(force: str) -> None:
    """1/inf = 0 would leave everything where it is, with an estimated error of 0; dop853 goes on there."""
    text = POLE.replace("force function: 2*x**3", f"generalized force: {{x: {force}}}").replace(
        "position: 1", "position: 0"
    )
    with pytest.raises(Breakdown) as failed:
        start("rodas5p", dynamics_of(text), tolerance=1e-8).advance(1e-4)
    assert failed.value.kind == Cause.NOT_SMOOTH
    assert failed.value.time == 0
    moved = start("dop853", dynamics_of(text), tolerance=1e-8).advance(1e-4)
    assert moved[0] > 1e-5


def test_a_better_run_that_needs_derivatives_leaves_the_estimate_to_another() -> None:
    """sqrt(t) has none at t = 0: rodas5p would be taken beside radau."""
    text = POLE.replace("force function: 2*x**3", "generalized force: {x: sqrt(t) - x}")
    run = mbsym.simulate(mbsym.loads(text), 1.0, method="radau", tolerance=1e-7)
    assert isinstance(run.error, ErrorEstimate)
    assert run.error.against.method == "dop853"


@pytest.mark.parametrize("name", ["dop853", "rk45", "rodas5p"])
def test_what_is_not_finite_just_ahead_is_no_blow_up(name: str) -> None:
    """A root of 1 - x, as x passes 1 at a speed of 3: neither values nor rates grow."""
    text = POLE.replace("force function: 2*x**3", "generalized force: {x: sqrt(1 - x)}")
    text = text.replace("position: 1", "position: 0")
    with pytest.raises(Breakdown) as failed:
        start(name, dynamics_of(text), tolerance=1e-8).advance(2.0)
    assert failed.value.kind == Cause.STUCK


@pytest.mark.parametrize("name", [method.name for method in symplectic.METHODS])
def test_variational_methods_refuse_forces_without_potential(name: str) -> None:
    with pytest.raises(Unusable, match="without a potential: coordinate damper"):
        start(name, dynamics_of(STIFF_SYSTEM), step=1e-3)
    none = dynamics_of(STIFF_SYSTEM.replace("c: 1000000", "c: 0"))
    start(name, none, step=1e-3)
    damped = Dynamics(scenario(none.system, {"c": number(1)}))
    with pytest.raises(Unusable, match="without a potential: coordinate damper"):
        start(name, damped, step=1e-3)


def test_a_step_far_too_long_for_the_implicit_equation() -> None:
    with pytest.raises(Breakdown) as failed:
        start("midpoint", dynamics_of(SHIPPED / "double-pendulum.yaml"), step=5.0).advance(1000.0)
    assert failed.value.kind in (Cause.STUCK, Cause.BLOW_UP)


@pytest.mark.parametrize("name", FIXED)
def test_a_step_is_needed(name: str, pendulum: Dynamics) -> None:
    for step in (None, 0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(Unusable, match="needs a step"):
            METHODS[name].start(pendulum, Setting(step=step))


def test_taylor_without_heyoka_says_what_to_install(pendulum: Dynamics, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(Unusable, match="pip install heyoka"):
        METHODS["taylor"].start(pendulum, Setting(tolerance=1e-9))


def test_arithmetic_that_a_method_lacks(pendulum: Dynamics, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(Unusable, match="float64 only"):
        METHODS["radau"].start(pendulum, Setting(tolerance=1e-6), FLOAT32)
    monkeypatch.setattr(runge_kutta, "available", lambda scalar: scalar != EXTENDED)
    with pytest.raises(Unusable, match="no extended"):
        METHODS["dop853"].start(pendulum, Setting(tolerance=1e-6), EXTENDED)


# --- stopping and going on ---


@pytest.mark.parametrize("name", ["rk4", "dop853", "midpoint4"])
def test_pauses_change_nothing(name: str, pendulum: Dynamics, monkeypatch: pytest.MonkeyPatch) -> None:
    setting = {"step": 1e-3} if METHODS[name].traits.fixed else {"tolerance": 1e-10}
    whole = start(name, pendulum, **setting).advance(3.0)
    module = symplectic if name.startswith("mid") else runge_kutta
    monkeypatch.setattr(module, "OPERATIONS_AT_A_TIME", 3000)
    assert np.array_equal(start(name, pendulum, **setting).advance(3.0), whole)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers")
@pytest.mark.parametrize("name", ["rk4", "dop853", "midpoint"])
def test_machine_code_can_be_interrupted(name: str, pendulum: Dynamics) -> None:
    setting = {"step": 1e-6} if METHODS[name].traits.fixed else {"tolerance": 1e-12}
    run = start(name, pendulum, step_limit=10**12, **setting)

    def interrupt(number: int, frame: Any) -> None:
        if run.work.steps > 1000:  # a busy machine may not have come so far
            raise KeyboardInterrupt

    kept = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2, 0.1)
        with pytest.raises(KeyboardInterrupt):
            run.advance(1e7)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, kept)
    assert 1000 < run.work.steps < 10**9


def test_times_are_hit_exactly_and_may_be_repeated(pendulum: Dynamics) -> None:
    for name in ("rk4", "midpoint", "dop853", "scipy-dop853"):
        setting = {"step": 0.03} if METHODS[name].traits.fixed else {"tolerance": 1e-9}
        run = start(name, pendulum, **setting)
        first = np.array(run.advance(0.1))
        assert run.time == 0.1
        assert np.array_equal(run.advance(0.1), first)
    run = start("rk4", pendulum, step=0.03)
    run.advance(0.1)
    assert run.work.steps == 4


def test_everything_is_compiled_once_and_let_go() -> None:
    dynamics = dynamics_of(SHIPPED / "simple-pendulum.yaml")
    made = []
    for _ in range(2):
        once(dynamics, "key", lambda: made.append(1))
    assert made == [1]
    first, second = (start("dop853", dynamics, tolerance=1e-6) for _ in range(2))
    assert first._library is second._library
    watched = weakref.ref(dynamics)
    del dynamics, first, second
    gc.collect()
    assert watched() is None


def test_runs_do_not_disturb_each_other(pendulum: Dynamics) -> None:
    for name, setting in (
        ("taylor", {"tolerance": 1e-9}),
        ("dop853", {"tolerance": 1e-9}),
        ("midpoint", {"step": 0.01}),
    ):
        alone = start(name, pendulum, **setting).advance(1.0)
        first, second = start(name, pendulum, **setting), start(name, pendulum, **setting)
        first.advance(0.5)
        second.advance(0.25)
        assert first.advance(1.0) == pytest.approx(alone, rel=1e-6)
        assert second.advance(1.0) == pytest.approx(alone, rel=1e-6)


def test_method_names_and_traits() -> None:
    assert list(METHODS) == [
        "rk4", "rk45", "dop853", "rodas5p", "midpoint", "midpoint4", "midpoint6", "taylor", "scipy-rk45",
        "scipy-dop853", "lsoda", "radau", "bdf",
    ]  # fmt: skip
    assert {name for name, method in METHODS.items() if method.traits.conservative} == {
        "midpoint",
        "midpoint4",
        "midpoint6",
    }
    assert all(FLOAT64 in method.traits.scalars for method in METHODS.values())
