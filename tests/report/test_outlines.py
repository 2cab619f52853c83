"""Shapes of bodies are drawn where they are: against rotations of SciPy and places by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import system_of
from scipy.spatial.transform import Rotation as Turned

import mbsym.report.outlines as module
from mbsym.model.system import Rotation
from mbsym.numerics.body_motion import body_motions
from mbsym.numerics.scenario import scenario
from mbsym.report.outlines import Outline, outlines, shape_lines
from mbsym.simulation import Request, Simulation, simulate

ARM = """
mbsym: 1
name: Arm
bodies:
  - name: upper
    attached to: 0
    rotation: {axes: [2], angles: [q1]}
    coordinates: [q1]
    mass centre: [0, 0, 0.25]
    mass: 1
    inertia about: mass centre
    inertia: [0.02, 0.02, 0.002]
    shapes:
      - {cylinder: [0.06, 0.5], at: [0, 0, 0.25]}
  - name: fore
    attached to: upper
    connection point: [0, 0, 0.5]
    rotation: {axes: [1, 1], angles: [0.3, q2]}
    coordinates: [q2]
    mass centre: [0.1, 0, 0.2]
    mass: 1
    shapes:
      - {sphere: 0.07, at: [0, 0, 0.45]}
      - {box: [0.1, 0.06, 0.4], at: [0, 0, 0.2], rotation: {axes: [3, 1], angles: [0.5, 0.2]}}
loads:
  - uniform gravity: {acceleration: 9.81, direction: [0, 0, -1]}
initial: {q1: 0.8, q2: 0.9}
"""


@pytest.fixture(scope="module")
def run() -> Simulation:
    system = system_of(ARM, "arm.yaml")
    return simulate(scenario(system), Request(1.0, samples=21, estimate=False))


def drawn_outlines(run: Simulation) -> tuple[Outline, ...]:
    states = run.trajectory.states
    return outlines(run.scenario, body_motions(run.scenario, run.times, states, 0 * states[:2], "0"))


def check(run: Simulation) -> None:
    """Places of the sphere and of the box's corners at all rows, from q1 and q2 alone."""
    fore = next(item for item in drawn_outlines(run) if item.body == "fore")
    corners = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.03, 0.03) for z in (-0.2, 0.2)])
    inside = Turned.from_euler("ZX", [0.5, 0.2]).apply(corners) + np.array([0, 0, 0.2])
    for k in range(len(run.times)):
        q1, q2 = run.trajectory.states[:2, k]
        upper = Turned.from_euler("Y", q1)
        whole = upper * Turned.from_euler("X", 0.3 + q2)
        elbow = upper.apply([0, 0, 0.5])
        lines = fore.at(k)
        for ring in lines[:3]:
            centre = elbow + whole.apply([0, 0, 0.45])
            assert np.allclose(np.linalg.norm(ring.T - centre, axis=1), 0.07, atol=1e-9)
        drawn = np.concatenate(lines[3:], axis=1).T
        for corner in elbow + whole.apply(inside):
            assert np.min(np.linalg.norm(drawn - corner, axis=1)) < 1e-9


def test_shapes_turn_and_move_with_their_bodies(run: Simulation) -> None:
    check(run)


@pytest.mark.parametrize("mistake", ["turned back", "from the joint"])
def test_a_shape_at_a_wrong_place_is_caught(mistake: str, run: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the shape's rotation the other way round, and its place taken from the mass centre."""
    if mistake == "turned back":
        right = module.turned
        monkeypatch.setattr(module, "turned", lambda *given: np.array(right(*given)).T)
    else:
        place = module._placed
        monkeypatch.setattr(
            module, "_placed", lambda *given: [line + np.array([0.1, 0, 0.2]) for line in place(*given)]
        )
    with pytest.raises(AssertionError):
        check(run)


def test_turns_of_shapes_are_those_of_scipy() -> None:
    system = system_of(ARM.replace("[3, 1], angles: [0.5, 0.2]", "[3, 1, 2], angles: [0.5, -1/3, pi/5]"), "arm.yaml")
    rotation: Rotation = system.bodies[1].shapes[1].rotation
    wanted = Turned.from_euler("ZXY", [0.5, -1 / 3, np.pi / 5]).as_matrix()
    assert np.allclose(np.array(module.turned(rotation, {"pi": Fraction(0)})).T, wanted, atol=1e-14)


@pytest.mark.parametrize(
    ("kind", "size", "half"),
    [
        ("box", [2.0, 4.0, 6.0], [1, 2, 3]),
        ("sphere", [2.0], [2, 2, 2]),
        ("ellipsoid", [1.0, 2.0, 3.0], [1, 2, 3]),
        ("cylinder", [1.0, 4.0], [1, 1, 2]),
        ("capsule", [1.0, 4.0], [1, 1, 3]),  # its length is that of the straight part
    ],
)
def test_an_outline_is_as_large_as_its_shape(kind: str, size: list[float], half: list[float]) -> None:
    points = np.concatenate(shape_lines(kind, size))
    assert np.allclose(np.max(points, axis=0), half, atol=1e-12)
    assert np.allclose(np.min(points, axis=0), np.negative(half), atol=1e-12)
