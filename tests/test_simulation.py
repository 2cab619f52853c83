"""``mbsym.simulate``: simulation as a library."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.numerics.accuracy import ErrorEstimate, Lacking, NoEstimate
from mbsym.numerics.methods.interface import Cause, Unusable
from mbsym.numerics.scenario import Incomplete
from mbsym.simulation import SAMPLES, Request, sample_times

ROOT = Path(__file__).parents[1]
DOUBLE = SHIPPED / "double-pendulum.yaml"

FREE = """
mbsym: 1
name: Particle
parameters: {k: 1}
bodies:
  - {name: particle, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - LOAD
initial: {x: 1}
"""


def free(load: str) -> mbsym.analysis.Analysis:  # type: ignore[name-defined]
    return mbsym.loads(FREE.replace("LOAD", load), ())


def test_a_result_has_times_coordinates_velocities_and_energies() -> None:
    run = mbsym.simulate(free("spring: {coordinate: x, stiffness: k}"), 2, values={"k": 4, "x": "1/2", "x_dot": 3})
    assert run.whole
    assert run.ended is None
    assert (run.times[0], run.times[-1], len(run.times)) == (0.0, 2.0, SAMPLES)
    truth = np.cos(2 * run.times) / 2 + 1.5 * np.sin(2 * run.times)
    assert np.allclose(run.coordinates, [truth], rtol=0, atol=1e-9)
    assert np.allclose(run.velocities, [-np.sin(2 * run.times) + 3 * np.cos(2 * run.times)], rtol=0, atol=1e-9)
    assert np.allclose(run.energy, 9 / 2 + 4 / 8, rtol=1e-10)
    assert (run.method, run.arithmetic) == ("dop853", "float64")
    assert "stiff" in run.why
    assert isinstance(run.error, ErrorEstimate)
    for name, row in (("t", run.times), ("x", run.coordinates[0]), ("x_dot", run.velocities[0])):
        assert np.array_equal(run[name], row)
    with pytest.raises(KeyError):
        run["y"]
    with pytest.raises(FrozenInstanceError):
        run.request = None  # type: ignore[misc]


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"method": "rk4", "step": 0.01},
        {"method": "midpoint6", "step": 0.02},
        {"method": "lsoda"},
        {"method": "radau"},
        {"arithmetic": "extended"},
    ],
    ids=str,
)
@pytest.mark.parametrize("most", [10**6, 3])
def test_a_result_is_a_function_of_time(how: dict[str, object], most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """x = cos 2t anywhere, in any order, at the rows what they are; the same where steps are too many to be kept."""
    monkeypatch.setattr("mbsym.simulation.result.MOST_KEPT", most)
    run = mbsym.simulate(
        free("spring: {coordinate: x, stiffness: k}"), 3, values={"k": 4}, samples=7, estimate=False, **how
    )  # type: ignore[arg-type]
    times = np.array([2.9, 0.1234, 0.0, 3.0, 1.777, 1.777])
    truth = np.array([np.cos(2 * times), -2 * np.sin(2 * times)])
    assert np.abs(run(times) - truth).max() < 2e-7
    assert run.at(0.5) == pytest.approx([np.cos(1), -2 * np.sin(1)], abs=2e-7)
    assert run.at(run.times).dtype == run.trajectory.states.dtype
    assert np.allclose(run.at(run.times), run.trajectory.states, rtol=0, atol=1e-13)
    assert run.at(np.array([])).shape == (2, 0)
    for beyond in (-1e-9, 3.0001, [1.0, float("nan")]):
        with pytest.raises(ValueError, match="the run goes from t = 0 to 3"):
            run.at(beyond)


def test_a_reduced_run_and_one_that_ended_are_functions_of_time() -> None:
    plane = dict.fromkeys(("psi", "phi", "sigma", "psi_dot", "phi_dot", "sigma_dot"), 0)
    run = mbsym.simulate(SHIPPED / "satellite.yaml", 4, values=plane, samples=5)
    whole = mbsym.simulate(SHIPPED / "satellite.yaml", 4, values=plane, samples=5, whole=True)
    times = np.linspace(0, 4, 33)
    assert run.chosen.resting is not None
    assert run.chosen.resting.proved
    assert np.allclose(run.at(times), whole.at(times), rtol=0, atol=1e-8)
    ended = mbsym.simulate(DOUBLE, 60, step_limit=50)
    assert not ended.whole
    assert np.allclose(ended.at(ended.times), ended.trajectory.states, rtol=0, atol=1e-13)
    with pytest.raises(ValueError, match="the run goes from"):
        ended.at(60.0)


def test_the_command_says_the_same(tmp_path: Path) -> None:
    """One library beneath both: equal numbers to the last digit."""
    words = ["simulate", str(DOUBLE), "--time", "2", "--samples", "11", "-f", "csv", "-o", str(tmp_path), "--quiet"]
    program = "import sys; from mbsym_cli.main import main; main(sys.argv[1:])"
    subprocess.run([sys.executable, "-c", program, *words], check=True)
    found = np.genfromtxt(tmp_path / "trajectory.csv", delimiter=",", names=True)
    run = mbsym.simulate(DOUBLE, 2, samples=11)
    for name in ("t", "theta1", "theta2", "theta1_dot", "theta2_dot"):
        assert np.array_equal(found[name], run[name])
    assert np.array_equal(found["energy"], run.energy)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"time": 0}, "time must be positive"),
        ({"time": float("nan")}, "time must be positive"),
        ({"time": 1, "samples": 1}, "2 at least"),
        ({"time": 1, "samples": 3, "every": 0.1}, "exclude"),
        ({"time": 1, "method": "dop835"}, "no method dop835"),
        ({"time": 1, "method": "rk4"}, "give a step"),
        ({"time": 1, "method": "rk4", "step": 0.1, "tolerance": 1e-3}, "no tolerance"),
        ({"time": 1, "step": 0.1}, "tolerance, not by a step"),
        ({"time": 1, "arithmetic": "float16"}, "no arithmetic float16"),
        ({"time": 1, "step_limit": 0}, "step_limit"),
        ({"time": 1, "values": {"mu": 1, "g": "2*", "l1": "q", "l2": float("inf")}}, "nothing called mu"),
        ({"time": 1, "values": {"mu": 1, "g": "2*", "l1": "q", "l2": float("inf")}}, "unknown name q"),
        ({"time": 1, "values": {"mu": 1, "g": "2*", "l1": "q", "l2": float("inf")}}, "l2 = inf is no number"),
    ],
)
def test_what_cannot_be_met_is_said_at_once(given: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)):
        mbsym.simulate(DOUBLE, **given)  # type: ignore[arg-type]


def test_missing_numbers_and_methods_that_do_not_apply_are_raised() -> None:
    with pytest.raises(Incomplete, match="no value for k"):
        mbsym.simulate(mbsym.loads(FREE.replace("{k: 1}", "{k: real}").replace("LOAD", "potential: k*x"), ()), 1)
    with pytest.raises(mbsym.DescriptionError):
        mbsym.simulate(SHIPPED / "none.yaml", 1)
    with pytest.raises(Unusable, match="conservative"):
        mbsym.simulate(free("generalized force: {x: -k}"), 1, method="midpoint", step=0.1)


@pytest.mark.parametrize(
    "method", [{}, {"method": "rk4", "step": 0.01}, {"method": "lsoda"}], ids=["auto", "rk4", "lsoda"]
)
@pytest.mark.parametrize(
    ("load", "end"),
    [
        # sqrt(x) from x = 1 under x'' = -1 - sqrt(x): at x = 0 there is no force any more.
        ("generalized force: {x: -k - sqrt(x)}", 1.0258),
        # x reaches -1 where x'' = -1: sqrt(2 * 2) s after the start.
        ("generalized force: {x: -k + 0.000001*log(x + 1)}", 2.0),
    ],
)
def test_a_run_that_leaves_the_domain_of_its_forces_says_so(load: str, end: float, method: dict[str, object]) -> None:
    run = mbsym.simulate(free(load), 5, **method)  # type: ignore[arg-type]
    assert run.ended is not None
    assert run.ended.kind == Cause.UNDEFINED
    assert run.ended.time == pytest.approx(end, abs=0.02)
    assert np.all(np.isfinite(run.trajectory.states))
    assert np.all(np.isfinite(run.energy))
    assert run.error == NoEstimate(Lacking.NOT_WHOLE)


def test_an_energy_without_a_value_ends_the_run() -> None:
    """Steps that jump over the pole of -1/(x + 2): beyond it the force is real, and its potential log(x + 2) is not."""
    run = mbsym.simulate(free("potential: x + k*log(x + 2)"), 5, method="rk4", step=0.01)
    assert run.ended is not None
    assert run.ended.kind == Cause.UNDEFINED
    assert np.all(run["x"] > -2)
    assert np.all(np.isfinite(run.energy))


def test_other_ends_are_results_too() -> None:
    limited = mbsym.simulate(DOUBLE, 60, step_limit=200)
    assert (limited.whole, limited.ended.kind) == (False, Cause.STEP_LIMIT)  # type: ignore[union-attr]
    pole = mbsym.simulate(SHIPPED / "spherical-pendulum.yaml", 1, values={"theta": 0})
    assert pole.ended is not None
    assert pole.ended.kind == Cause.SINGULAR


def test_times_are_chosen_within_bounds() -> None:
    system = mbsym.load(DOUBLE, ()).system
    assert np.array_equal(sample_times(Request(1.0, every=0.3), 1.0, system), [0, 0.3, 0.6, 0.8999999999999999, 1])
    assert len(sample_times(Request(1.0, samples=7), 1.0, system)) == 7
    assert len(sample_times(Request(1.0), 1e9, system)) == 20_001
    rows = sample_times(Request(1.0, method="rk4", step=0.3), 1.0, system)
    assert np.allclose(rows, [0, 0.3, 0.6, 0.9, 1.0])


def test_importing_stays_light() -> None:
    program = (
        "import sys, mbsym; mbsym.simulate; print([m for m in ('numpy', 'llvmlite', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
