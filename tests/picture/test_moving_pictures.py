"""Motions, modes and equilibria for pages: textbook values, a second route for every shipped system, and refusals."""

from __future__ import annotations

import json
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.numerics.kernels import arrays
from mbsym.numerics.planning.models import LinearisedDynamics
from mbsym.numerics.scenario import Incomplete, scenario
from mbsym.problems.stability.words import Word
from mbsym.report.viewer.modes import Modes, modes, modes_json
from mbsym.report.viewer.motion import motion, motion_json
from mbsym.report.viewer.page import at_rest, at_rest_json
from mbsym.simulation import Request


def loaded(name: str) -> Any:
    return mbsym.load(SHIPPED / f"{name}.yaml")


def wrong(found: Modes, analysis: Any) -> float:
    """The largest |J v - lambda v|, v = (x, lambda x), as a part of its terms; J from the differentiated program."""
    system = analysis.system.without_speeds if analysis.system.speeds else analysis.system
    dynamics = LinearisedDynamics(scenario(system, state=False))
    size = 2 * len(system.coordinates)
    names = system.coordinates
    start = [found.base[name] for name in names] + [found.turning.get(name, 0.0) for name in names]
    rows = np.array(arrays.kernel(dynamics.jacobian)(np.array([[0.0], *([x] for x in start)])), dtype=float)
    J = rows.reshape(size, size)
    worst = 0.0
    for mode in found.modes:
        root = complex(mode.real, mode.imaginary)
        x = np.array([mode.shape.get(name, 0) for name in names])
        v = np.concatenate([x, root * x])
        terms = np.abs(J) @ np.abs(v) + abs(root) * np.abs(v)
        worst = max(worst, float(np.max(np.abs(J @ v - root * v))) / (float(np.max(terms)) or 1.0))
    return worst


SECOND = (
    *("double-pendulum", "cart-pole", "heavy-top", "orbital-gyrostat", "satellite", "satellite-with-gyroscope"),
    *("ziegler-damped", "spring-pendulum", "three-bodies", "gravity-gradient-quaternion", "dumbbell"),
)


@pytest.mark.parametrize("name", SECOND)
def test_modes_are_eigenvectors_of_the_differentiated_program(name: str) -> None:
    analysis = loaded(name)
    found = modes(analysis)
    assert wrong(found, analysis) < 1e-7
    assert found.verdict == analysis.stability.numerical or analysis.system.speeds
    json.dumps(modes_json(found), allow_nan=False)


def test_a_flipped_gyroscopic_term_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.report.viewer import modes as module

    right = module.matrices_at

    def flipped(*given: Any) -> Any:
        m, d, g, k, n = right(*given)
        return [m, d, [[-x for x in row] for row in g], k, n]

    monkeypatch.setattr(module, "matrices_at", flipped)
    analysis = loaded("heavy-top")
    assert wrong(modes(analysis), analysis) > 1e-3


def test_modes_of_the_double_pendulum() -> None:
    """Equal masses and rods: omega^2 = (2 -+ sqrt 2) g/l; absolute angles 1 : +-sqrt 2, so relative +-sqrt 2 - 1."""
    found = modes(loaded("double-pendulum"))
    slow, fast = found.modes
    assert (slow.real, fast.real) == (0, 0)
    assert slow.imaginary == pytest.approx(sqrt((2 - sqrt(2)) * 9.81))
    assert fast.imaginary == pytest.approx(sqrt((2 + sqrt(2)) * 9.81))
    assert slow.frequency == pytest.approx(slow.imaginary / (2 * pi))
    assert slow.damping == 0
    for mode, ratio in ((slow, sqrt(2) - 1), (fast, -sqrt(2) - 1)):
        assert mode.shape["theta2"] / mode.shape["theta1"] == pytest.approx(ratio)
        assert max(map(abs, mode.shape.values())) == pytest.approx(1)
        assert not mode.fewer
    assert found.verdict.word is Word.STABLE
    assert modes_json(found)["verdict"]["verdict"] == "stable"
    assert modes_json(found)["sentences"][0] == "The motion at these values: stable (Lagrange-Dirichlet)."


def test_damping_and_multiple_roots() -> None:
    """x'' + 2 x' + 5 x = 0 has -1 +- 2i: damping 1/sqrt 5.  A free mass has 0 twice and one shape."""
    text = """mbsym: 1
name: two
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
  - {name: b, attached to: 0, connection point: [0, y, 0], mass: 1, coordinates: [y]}
loads:
  - spring: {coordinate: x, stiffness: 5}
  - damper: {coordinate: x, coefficient: 2}
motion: {x: 0, y: 0}
"""
    damped, free = modes(mbsym.loads(text)).modes
    assert (damped.real, damped.imaginary) == pytest.approx((-1, 2))
    assert damped.damping == pytest.approx(1 / sqrt(5))
    assert damped.shape == {"x": 1}
    assert (free.real, free.imaginary, free.multiplicity, free.fewer) == (0, 0, 2, True)
    isotropic = text.replace("spring: {coordinate: x, stiffness: 5}", "potential: (x**2 + y**2)/2")
    both = modes(mbsym.loads(isotropic.replace("  - damper: {coordinate: x, coefficient: 2}\n", ""))).modes
    assert [(x.imaginary, x.fewer) for x in both] == [(1, False), (1, False)]


def test_no_modes_without_a_motion_or_numbers() -> None:
    with pytest.raises(Failure, match="no unperturbed motion"):
        modes(loaded("four-bar"))
    with pytest.raises(Failure, match="does not exist there"):
        modes(loaded("spherical-pendulum"))
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").replace("l2: 1, g: 9.81", "g: 9.81")
    with pytest.raises(Failure, match="not all parameters have values"):
        modes(mbsym.loads(text))


def test_modes_under_velocity_constraints_name_what_stands_still() -> None:
    found = modes(loaded("dish-sphere"))
    assert found.still == ("z",)
    assert any(x.startswith("Not moved") for x in modes_json(found)["sentences"])
    assert not any(x.startswith("Not moved") for x in modes_json(modes(loaded("heavy-top")))["sentences"])


def test_a_motion_ends_where_the_run_does_and_says_what_it_is() -> None:
    found = motion(loaded("double-pendulum").system, Request(1.0))
    assert found.times[0] == 0
    assert found.times[-1] == 1
    assert found.coordinates["theta1"][0] == 1
    assert found.coordinates["theta2"][0] == 0.5
    assert found.drift_of == "drift of the energy"
    told = motion_json(found, ("theta1_dot",))
    json.dumps(told, allow_nan=False)
    assert {*told["velocities"]} == {"theta1_dot"}
    assert len(told["times"]) == len(told["coordinates"]["theta2"]) == len(told["energy"])
    damped = motion(loaded("simple-pendulum").system, Request(1.0))
    assert damped.drift_of == "change of the energy"


def test_long_motions_are_thinned_and_keep_their_end() -> None:
    """x = cos t at unit mass and stiffness, 5001 samples."""
    text = """mbsym: 1
name: oscillator
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
initial: {x: 1}
"""
    found = motion(mbsym.loads(text).system, Request(10.0, samples=5001))
    assert len(found.times) <= 2401
    assert found.times[-1] == 10
    assert np.asarray(found.coordinates["x"]) == pytest.approx(np.cos(found.times), abs=1e-7)
    assert any("one of 3 samples" in x for x in found.sentences)


def test_names_keep_their_spelling_at_the_beginning_of_a_sentence() -> None:
    """A point at the distance 1, begun off it: c is moved, and C is a parameter."""
    text = """mbsym: 1
name: bob
parameters: {C: positive}
bodies:
  - {name: a, attached to: 0, connection point: [b, c, 0], mass: C, coordinates: [b, c]}
constraints:
  - distance: {between: [{body: 0, point: [0, 0, 0]}, {body: a, point: [0, 0, 0]}], length: 1}
values: {C: 1}
initial: {b: 0, c: 2}
"""
    said = motion(mbsym.loads(text).system, Request(0.1)).sentences
    assert "c = 1 instead of 2." in said
    assert any(x.startswith("Start: what was given") for x in said)


def test_motions_make_no_numbers_up() -> None:
    text = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").replace("l2: 1, g: 9.81", "g: 9.81")
    with pytest.raises(Incomplete, match="l2"):
        motion(mbsym.loads(text).system, Request(1.0))


def test_equilibria_of_the_pendulum() -> None:
    """Down it is stable with friction, up unstable; two, and no more."""
    found = at_rest(loaded("simple-pendulum").system)
    assert found.complete
    by_value = {round(next(iter(x.values.values())), 9): x for x in found.listed}
    assert {*by_value} == {0, round(pi, 9)}
    assert by_value[0].verdict.word is Word.ASYMPTOTIC
    assert by_value[round(pi, 9)].verdict.word is Word.UNSTABLE
    json.dumps(at_rest_json(found), allow_nan=False)
    sleigh = (SHIPPED / "chaplygin-sleigh.yaml").read_text(encoding="utf-8")
    with pytest.raises(Failure):  # y = x^2 leaves the plane no symmetry along which a sleigh moves steadily
        at_rest(mbsym.loads(sleigh.replace("constraints:\n", "constraints:\n  - relation: y = x**2\n")).system)
