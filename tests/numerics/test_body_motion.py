"""What bodies do along a trajectory, against closed forms, differences and the energy of the whole."""

from __future__ import annotations

import csv
from io import StringIO

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.numerics.between import accelerations
from mbsym.numerics.body_motion import BodyMotions, body_motions
from mbsym.numerics.scenario import scenario
from mbsym.report.runs.trajectory_csv import bodies_parts
from mbsym.simulation import Simulation


def along(run: Simulation) -> BodyMotions:
    found = run.trajectory
    return body_motions(run.scenario, found.times, found.states, accelerations(run.dynamics, found.times, found.states))


def test_a_pendulum_in_closed_form() -> None:
    """r = l (sin, -cos), v = l w (cos, sin), a = l e (cos, sin) + l w^2 (-sin, cos), at any angle, rate and e."""
    system = mbsym.load(SHIPPED / "simple-pendulum.yaml").system
    given = scenario(system)
    mass, length = float(given.parameters["m"]), float(given.parameters["l"])
    inertia = float(given.parameters["J"])  # about the mass centre
    angle, rate, change = np.array([0.3, -2.0, 7.0]), np.array([1.5, 0.0, -4.0]), np.array([-0.7, 3.0, 2.0])
    found = body_motions(given, [0.0, 1.0, 2.0], [angle, rate], [change])
    sine, cosine, zero = np.sin(angle), np.cos(angle), 0 * angle
    along_path, inwards = np.array([cosine, sine, zero]), np.array([-sine, cosine, zero])
    assert found.names == ("pendulum",)
    assert np.allclose(found.places[0], -length * inwards, atol=1e-14)
    assert np.allclose(found.velocities[0], length * rate * along_path, atol=1e-14)
    assert np.allclose(found.accelerations[0], length * change * along_path + length * rate**2 * inwards, atol=1e-13)
    assert np.allclose(found.angular_velocities[0], [zero, zero, rate])
    assert np.allclose(found.kinetic[0], 0.5 * (mass * length**2 + inertia) * rate**2)
    assert np.allclose(found.axes[0, 0], [cosine, sine, zero])
    assert np.allclose(found.axes[0, 1], [-sine, cosine, zero])


@pytest.mark.parametrize(("name", "time"), [("satellite", 2.0), ("tethered-satellites", 5.0)])
def test_velocities_and_accelerations_are_rates(name: str, time: float) -> None:
    """Central differences of fourth order; also where a frame is driven (the orbit of the satellite)."""
    found = along(mbsym.simulate(SHIPPED / f"{name}.yaml", time, samples=801, estimate=False))
    step = found.times[1] - found.times[0]

    def difference(values: np.ndarray) -> np.ndarray:
        near, far = values[..., 3:-1] - values[..., 1:-3], values[..., 4:] - values[..., :-4]
        return (8 * near - far) / (12 * step)

    for values, rates in ((found.places, found.velocities), (found.velocities, found.accelerations)):
        assert np.max(np.abs(difference(values) - rates[..., 2:-2])) < 1e-6 * np.max(np.abs(rates))
    turning = np.einsum("bikm,bjkm->bijm", found.axes, found.axes)
    assert np.allclose(turning, np.eye(3)[None, :, :, None], atol=1e-12)


@pytest.mark.parametrize("name", ["double-pendulum", "spring-pendulum", "tethered-satellites"])
def test_energies_of_bodies_add_up(name: str) -> None:
    run = mbsym.simulate(SHIPPED / f"{name}.yaml", 2.0, samples=101, estimate=False)
    found = along(run)
    whole = found.kinetic.sum(axis=0) - found.force_function
    assert np.max(np.abs(whole - run.energy)) < 1e-12 * max(np.max(found.kinetic), np.max(np.abs(run.energy)))
    assert np.ptp(whole) < 1e-8 * np.max(found.kinetic)  # no force of theirs but has a potential


def test_the_table_reads_back() -> None:
    run = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 1.0, samples=11, estimate=False)
    found = along(run)
    rows = list(csv.DictReader(StringIO("".join(bodies_parts([found])))))
    assert len(rows) == 11
    for k, row in enumerate(rows):
        assert float(row["t"]) == found.times[k]
        assert float(row["second rod.acceleration_2"]) == found.accelerations[1, 1, k]
        assert float(row["first rod.angular_velocity_3"]) == run["theta1_dot"][k]
        parts = float(row["first rod.kinetic_energy"]) + float(row["second rod.kinetic_energy"])
        assert float(row["kinetic_energy"]) == pytest.approx(parts, rel=1e-15)
        difference = float(row["kinetic_energy"]) - float(row["force_function"])
        assert float(row["energy"]) == pytest.approx(difference, rel=1e-15)
