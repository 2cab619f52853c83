"""Derivatives of motions against closed forms, against differences of motions, and planted mistakes."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised, dependent
from mbsym.numerics.methods.interface import Setting, compiled_kernel
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits import variational
from mbsym.numerics.orbits.variational import Variational, sensitive, split, units
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.simulate import integrated
from mbsym.simulation import read_values

OSCILLATOR = """
mbsym: 1
name: Oscillator
parameters: {m: positive, k: positive, w: positive, d: nonnegative}
relations: {k: m*w**2}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - damper: {coordinate: x, coefficient: d}
values: {m: 2, w: 3, d: 0}
initial: {x: {position: m/4, velocity: 1}}
"""


def system(text: str) -> Any:
    return mbsym.loads(text).system


def shipped(name: str) -> Any:
    return mbsym.load(SHIPPED / f"{name}.yaml").system


def at_end(dynamics: Dynamics, time: float, tolerance: float = 1e-12) -> Any:
    return integrated(dynamics, METHODS["dop853"], Setting(tolerance), [0.0, time]).states[:, -1]


def columns(given: Scenario, names: Sequence[str], time: float) -> Any:
    found = sensitive(given, names)
    return split(at_end(found, time), len(given.state))[1]


def test_an_oscillator_answers_as_its_closed_form() -> None:
    """x = a cos wt + (b/w) sin wt with a = m/4: by x(0), x'(0), w (through k = m w^2) and m (through a alone)."""
    t, w, a, b = 1.7, 3.0, 0.5, 1.0
    s, c = np.sin(w * t), np.cos(w * t)
    found = columns(scenario(system(OSCILLATOR)), ["x", "x_dot", "w", "m"], t)
    by_w = [-a * t * s + b * t * c / w - b * s / w**2, -a * (s + w * t * c) - b * t * s]
    expected = [[c, -w * s], [s / w, c], by_w, [c / 4, -w * s / 4]]
    assert np.max(np.abs(found - expected)) < 1e-10


def test_a_motion_that_no_mass_changes_has_zeros_in_few_steps() -> None:
    """Falling bodies fall alike: what roundings leave of the derivative by m rules no step."""
    text = """
mbsym: 1
name: Pendulum
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [0, -l, 0], mass: m}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
values: {m: 3, l: 0.7, g: 9.81}
initial: {a: 2}
"""
    found = sensitive(scenario(system(text)), ["m", "l"])
    run = integrated(found, METHODS["dop853"], Setting(1e-10), [0.0, 1.0])
    assert run.work.steps < 200
    by_mass, by_length = split(run.states[:, -1], 2)[1]
    assert np.max(np.abs(by_mass)) < 1e-13 < 1 < np.max(np.abs(by_length))


def test_what_follows_from_a_parameter_moves_with_it() -> None:
    given = system(OSCILLATOR)
    assert dependent(given, ["w"]) == ("k",)
    assert dependent(given, ["d"]) == ()
    free = Parametrised(scenario(given), ["w"])
    assert free.right_hand_side.inputs == ("t", "x", "x_dot", "w")
    with pytest.raises(ValueError, match="k follows from other parameters"):
        sensitive(scenario(given), ["k"])
    with pytest.raises(ValueError, match="nothing called z"):
        sensitive(scenario(given), ["z"])


NAMES = ("theta1", "theta2_dot", "m1", "l2", "g")


def differences(given: Any, names: Sequence[str], time: float) -> Any:
    """Central differences of runs in extended arithmetic: good to some nine digits."""
    rows = []
    for name in names:
        here = scenario(given)
        values = dict(zip((*given.coordinates, *given.velocities), here.state, strict=True)) | dict(here.parameters)
        h = Fraction(1, 100_000)
        ends = []
        for sign in (1, -1):
            moved = scenario(given, read_values(given, {name: values[name] + sign * h}))
            run = integrated(Dynamics(moved), METHODS["dop853"], Setting(1e-17), [0.0, time], "extended")
            ends.append(run.states[:, -1])
        rows.append(((ends[0] - ends[1]) / (2 * np.longdouble(h))).astype(float))
    return np.array(rows)


def test_a_double_pendulum_answers_as_runs_differ() -> None:
    given = shipped("double-pendulum")
    found = columns(scenario(given), NAMES, 5.0)
    assert np.max(np.abs(found - differences(given, NAMES, 5.0)) / (1 + np.abs(found))) < 2e-8


def test_prescribed_motions_move_with_their_rates() -> None:
    """A rotor driven at the rate Omega, which follows from Lambda: d/dLambda sees both."""
    given = shipped("satellite-with-damper-driven")
    found = columns(scenario(given), ["Lambda"], 3.0)
    moved = differences(given, ["Lambda"], 3.0)
    assert np.max(np.abs(found - moved)) < 1e-7 * np.max(np.abs(moved))


@pytest.mark.parametrize("name", ["double-pendulum", "heavy-top", "spherical-pendulum"])
def test_volumes_are_kept_where_nothing_dissipates(name: str) -> None:
    """det Phi = exp(int tr J): with p = dL/dq' it is det M(q(0)) / det M(q(t)) without dissipation (Liouville)."""
    given = scenario(shipped(name))
    dynamics = Dynamics(given)
    x, y = split(at_end(Variational(dynamics, units(dynamics)), 2.0), dynamics.dimension)
    mass = compiled_kernel(dynamics, "mass_matrix")
    n = dynamics.size
    ends = ([0.0, *map(float, given.state)], [2.0, *x])
    masses = [np.linalg.det(mass(np.array(end)).reshape(n, n)) for end in ends]
    assert abs(np.linalg.det(y) * masses[1] / masses[0] - 1) < 1e-8


# --- planted mistakes ---


def test_a_transposed_jacobian_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    given = scenario(shipped("double-pendulum"))
    right = columns(given, NAMES[:2], 1.0)
    applied = variational._applied
    monkeypatch.setattr(variational, "_applied", lambda p, m, v: applied(p, tuple(zip(*m, strict=True)), v))
    swept = lambda p, o, i, d: variational._applied(p, variational.jacobian(p, o, i), d)  # noqa: E731
    monkeypatch.setattr(variational, "directional", swept)
    assert np.max(np.abs(columns(given, NAMES[:2], 1.0) - right)) > 0.1


def test_a_lost_parameter_term_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    given = scenario(system(OSCILLATOR))
    zeros = lambda self, program, outputs, direction: [program.zero] * len(outputs)  # noqa: E731
    monkeypatch.setattr(Variational, "_offset", zeros)
    assert np.max(np.abs(columns(given, ["w"], 1.7))) < 1e-10  # nothing is left of it
