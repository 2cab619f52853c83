"""What generated C and model.py integrate of a description in speeds, and what exports say of their states."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import zipfile
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.analysis import Analysis
from mbsym.numerics.kernels import arrays
from mbsym.numerics.scenario import scenario
from mbsym.numerics.states import StateDynamics, scenario_in_states
from mbsym.report.code import c_source
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.targets import FORMATS

COMPILER = shutil.which("cc")

#: Free, symmetric, turning about an axis across its own: it passes the pole of its angles exactly at t = pi/2.
POLE = """
mbsym: 1
name: Through the pole
parameters: {A: positive, C: positive}
values: {A: 2, C: 3}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 2, 1], angles: [a, b, c]}
    mass: 0
    inertia about: joint
    inertia: [A, A, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {e: quaternion}
initial: {a: 0, b: {position: 0, velocity: 1}, c: 0}
"""


@pytest.fixture(scope="module")
def satellite() -> Analysis:
    return mbsym.load(SHIPPED / "gravity-gradient-quaternion.yaml", (3, 7))


@pytest.fixture(scope="module")
def expected(satellite: Analysis) -> tuple[Any, Any]:
    """A state (e, p, q, r) with |e| = 1, and y' there of the right-hand side that runs integrate."""
    dynamics = StateDynamics(scenario_in_states(scenario(satellite.system)))
    state = np.array([0.1, -0.5, 0.7, 0.5, 0.02, -0.01, 0.015])
    return state, arrays.kernel(dynamics.right_hand_side)(np.concatenate(([3.0], state)))


def by_hand(y: Any) -> Any:
    """Euler's equations with the moment of the gravity gradient, and Euler's parameters (the description's numbers)."""
    e, w = y[:4], y[4:]
    omega0, moments = 0.001, np.array([12.0, 9.0, 15.0])
    b = np.array([2 * (e[1] * e[2] + e[0] * e[3]), e[0] ** 2 - e[1] ** 2 + e[2] ** 2 - e[3] ** 2,
                  2 * (e[2] * e[3] - e[0] * e[1])])  # fmt: skip
    c = np.array([2 * (e[1] * e[3] - e[0] * e[2]), 2 * (e[2] * e[3] + e[0] * e[1]),
                  e[0] ** 2 - e[1] ** 2 - e[2] ** 2 + e[3] ** 2])  # fmt: skip
    turn = w + omega0 * c
    rates = [-(e[1:] @ turn) / 2, *((e[0] * turn + np.cross(e[1:], turn)) / 2)]
    moment = 3 * omega0**2 * np.cross(b, moments * b) - np.cross(w, moments * w)
    return np.array([*rates, *(moment / moments)])


def test_what_runs_integrate_is_what_a_textbook_has(expected: tuple[Any, Any]) -> None:
    state, rates = expected
    assert np.allclose(rates, by_hand(state), rtol=1e-12, atol=1e-18)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_c_has_the_same_states(satellite: Analysis, expected: tuple[Any, Any], tmp_path: Path) -> None:
    (tmp_path / "model.c").write_text(c_source.render(satellite, (3, 7)), encoding="utf-8")
    (tmp_path / "model.h").write_text(c_source.header(satellite, (3, 7)), encoding="utf-8")
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([str(COMPILER), *warnings, "-O1", "-shared", "-fPIC", "-o", "model.so", "model.c", "-lm"],
                   cwd=tmp_path, check=True)  # fmt: skip
    library, prefix = ctypes.CDLL(str(tmp_path / "model.so")), prefix_of(satellite.system.name)
    state, rates = expected
    numbers = ctypes.c_double * 7
    found, given = numbers(), numbers(*state)
    defaults = ctypes.byref((ctypes.c_double * 7).in_dll(library, f"{prefix}_defaults"))
    status = library[f"{prefix}_speed_right_hand_side"](ctypes.c_double(3.0), given, defaults, found)
    assert status == 0
    assert np.allclose(list(found), rates, rtol=1e-13, atol=1e-20)
    three = ctypes.c_double * 3
    library[f"{prefix}_speed_state"].restype = None
    library[f"{prefix}_speed_state"](
        ctypes.c_double(0.0), three(0.1, 0.05, 0.02), three(0.0003, 0, 0.02), defaults, found
    )
    start = [float(x) for x in scenario_in_states(scenario(satellite.system)).state]
    assert np.allclose(list(found), start, rtol=1e-13, atol=1e-18)
    off = numbers(*(1.001 * state[:4]), *state[4:])
    library[f"{prefix}_speed_restore"](off)
    assert abs(sum(x * x for x in list(off)[:4]) - 1) < 1e-5  # the square of what was off
    assert list(off)[4:] == list(state[4:])


def test_model_py_integrates_them_through_the_pole(satellite: Analysis, expected: tuple[Any, Any]) -> None:
    """b = t: e = (cos t/2, 0, sin t/2, 0)."""
    module: dict[str, Any] = {}
    exec(str(FORMATS["python"].render(satellite, (3, 7))), module)
    state, rates = expected
    assert np.allclose(module["speed_rhs"](3.0, state, module["complete"]()), rates, rtol=1e-12, atol=1e-18)
    exec(str(FORMATS["python"].render(mbsym.loads(POLE, (3, 7)), (3, 7))), module)
    times, found = module["speed_simulate"](6.0, module["complete"](), samples=7)
    assert np.allclose(found[:4], [np.cos(times / 2), 0 * times, np.sin(times / 2), 0 * times], atol=1e-9)
    assert np.max(np.abs(np.sum(found[:4] ** 2, axis=0) - 1)) < 1e-15


def test_velocities_that_follow_from_speeds_are_not_taken_for_zero() -> None:
    """Angles and p, q, r are given: no b' = 0 is printed, and generated code asks for what it would have to compute."""
    start = "initial: {a: 1, b: 1/2, c: 0, p: 1, q: 2, r: 3}"
    text = "\n".join(start if line.startswith("initial:") else line for line in POLE.splitlines())
    analysis = mbsym.loads(text, (3,))
    shown = str(FORMATS["latex"].render(analysis, (3,)))
    assert "$p(0) = 1$" in shown
    assert "dot{b}(0)" not in shown
    module: dict[str, Any] = {}
    exec(str(FORMATS["python"].render(analysis, (3,))), module)
    with pytest.raises(ValueError, match="a, b, c"):
        module["initial_state"](module["complete"]())
    assert "b'[0]" not in str(FORMATS["wolfram"].render(analysis, (3,)))


@pytest.mark.parametrize("kind", ["casadi", "jax", "julia", "octave", "modelica", "fmu2"])
def test_exports_say_that_their_states_are_coordinates(satellite: Analysis, kind: str) -> None:
    made = FORMATS[kind].render(satellite, (3, 7))
    if isinstance(made, bytes):
        made = zipfile.ZipFile(BytesIO(made)).read("modelDescription.xml").decode()
    told = "The states are coordinates and their velocities: e0, e1, e2, e3, p, q, r of the description are none here"
    assert told in " ".join(str(made).replace("#", " ").replace("%", " ").split())
