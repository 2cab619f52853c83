"""What model.c and model.py say beside the equations: a status where there is no number, and which energy is which."""

from __future__ import annotations

import ctypes
import math
import re
import shutil
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, imported
from test_kernels import COMPILER, compiled

import mbsym
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.targets import TARGETS

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler")
#: T2 = m R^2 theta'^2/2, T0 = m R^2 Omega^2 sin(theta)^2/2, U = m g R cos(theta).
HOOP = """
mbsym: 1
name: Bead on a rotating hoop
parameters: {m: positive, g: positive, R: positive, Omega: positive}
prescribed: {psi: {rate: Omega}}
bodies:
  - {name: hoop, rotation: {axes: [2], angles: [psi]}, mass: 0}
  - name: bead
    attached to: hoop
    rotation: {axes: [3], angles: [theta]}
    mass centre: [0, -R, 0]
    mass: m
loads: [uniform gravity: {vector: [0, -g, 0]}]
"""
M, G, R, OMEGA, THETA, RATE = 1.3, 9.81, 0.7, 2.5, 0.6, -1.1
SQUARE = M * R**2 / 2
POTENTIAL = -M * G * R * math.cos(THETA)
ENERGY = SQUARE * RATE**2 + SQUARE * (OMEGA * math.sin(THETA)) ** 2 + POTENTIAL
GENERALIZED = SQUARE * RATE**2 - SQUARE * (OMEGA * math.sin(THETA)) ** 2 + POTENTIAL


def doubles(*values: float) -> Any:
    return (ctypes.c_double * max(len(values), 1))(*values)


def module(text: str, tmp_path: Path) -> ModuleType:
    return imported(filed(tmp_path / "model.py", TARGETS["python"].render(mbsym.loads(text), (1, 2, 3))))


@needs_compiler
def test_a_singular_mass_matrix_is_a_status_in_c(tmp_path: Path) -> None:
    """A spherical pendulum in angles at theta = 0, where M11 = m l^2 sin(theta)^2 vanishes."""
    library = compiled(mbsym.load(SHIPPED / "spherical-pendulum.yaml"), tmp_path)
    parameters = doubles(1.0, 2.0, 9.81)
    cases = [
        ((0.3, 0.8, 1.0, 0.0), parameters, 0),
        ((0.3, 0.0, 1.0, 0.0), parameters, 1),
        ((0.3, 0.8, math.nan, 0.0), parameters, 1),
        ((0.3, 0.8, math.inf, 0.0), parameters, 1),
        ((0.3, 0.8, 1.0, 0.0), doubles(math.nan, math.nan, math.nan), 1),
    ]
    for state, values, status in cases:
        x, slope, jacobian = doubles(*state), doubles(*[7.0] * 4), doubles(*[7.0] * 16)
        assert library.right_hand_side(ctypes.c_double(0), x, values, slope) == status, state
        assert library.accelerations(ctypes.c_double(0), x, doubles(*state[2:]), values, slope) == status
        assert library.jacobian(ctypes.c_double(0), x, values, jacobian) == status
        assert all(map(math.isfinite, jacobian)) == (status == 0)


@needs_compiler
def test_a_parameter_may_be_called_like_a_function_of_the_file(tmp_path: Path) -> None:
    text = HOOP.replace("Omega", "status").replace("R", "BEAD_ON_A_ROTATING_HOOP_OK")
    library = compiled(mbsym.loads(text), tmp_path)
    parameters = doubles(M, G, R, OMEGA)
    slope = doubles(0, 0)
    assert library.right_hand_side(ctypes.c_double(0), doubles(THETA, RATE), parameters, slope) == 0
    # R theta'' = R Omega^2 sin cos - g sin.
    expected = OMEGA**2 * math.sin(THETA) * math.cos(THETA) - G / R * math.sin(THETA)
    assert slope[1] == pytest.approx(expected, rel=1e-14)


@needs_compiler
def test_the_header_compiles_as_cpp_too(tmp_path: Path) -> None:
    (tmp_path / "model.h").write_text(TARGETS["c"].companions[0].render(mbsym.loads(HOOP), ()), encoding="utf-8")
    program = '#include "model.h"\nint main() { return BEAD_ON_A_ROTATING_HOOP_OK; }\n'
    (tmp_path / "main.cpp").write_text(program, encoding="utf-8")
    words = ["c++", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", str(tmp_path / "main.cpp")]
    try:
        done = subprocess.run(words, capture_output=True, text=True)
    except FileNotFoundError:
        pytest.skip("no C++ compiler")
    assert done.returncode == 0, done.stderr


@needs_compiler
def test_two_energies_in_c(tmp_path: Path) -> None:
    library = compiled(mbsym.loads(HOOP), tmp_path)
    for name, expected in (("energy", ENERGY), ("generalized_energy", GENERALIZED)):
        function = getattr(library, name)
        function.restype = ctypes.c_double
        found = function(ctypes.c_double(0.4), doubles(THETA), doubles(RATE), doubles(M, G, R, OMEGA))
        assert found == pytest.approx(expected, rel=1e-14), name


def test_two_energies_in_python(tmp_path: Path) -> None:
    model = module(HOOP, tmp_path)
    values = {"m": M, "g": G, "R": R, "Omega": OMEGA}
    assert model.energy([THETA], [RATE], values, 0.4) == pytest.approx(ENERGY, rel=1e-14)
    assert model.generalized_energy([THETA], [RATE], values, 0.4) == pytest.approx(GENERALIZED, rel=1e-14)
    many = model.generalized_energy(np.full((1, 3), THETA), np.full((1, 3), RATE), values, 0.4)
    assert many == pytest.approx([GENERALIZED] * 3, rel=1e-14)


def test_where_nothing_is_prescribed_they_are_one(tmp_path: Path) -> None:
    model = module(HOOP.replace("prescribed: {psi: {rate: Omega}}\n", ""), tmp_path)
    assert re.search("nothing moves as prescribed", model.__doc__ or "")
    state = ([0.2, THETA], [1.5, RATE], {"m": M, "g": G, "R": R, "Omega": OMEGA})
    assert model.energy(*state) == model.generalized_energy(*state)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_two_models_link_into_one_program(compiler: str, tmp_path: Path) -> None:
    """Every name that the linker or the preprocessor sees is the system's own."""
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "-Wmissing-prototypes"]
    sources = []
    for name in ("simple-pendulum", "double-pendulum", "satellite"):
        analysis, folder = mbsym.load(SHIPPED / f"{name}.yaml"), tmp_path / name
        folder.mkdir()
        target = TARGETS["c"]
        for part in (target, *target.companions):
            (folder / part.filename).write_text(str(part.render(analysis, ())), encoding="utf-8")
        sources.append(str(folder / "model.c"))
    (tmp_path / "main.c").write_text(
        """#include <stdio.h>
#include "simple-pendulum/model.h"
#include "double-pendulum/model.h"
#include "satellite/model.h"
int main(void)
{
    const double x[4] = {0.5, 0.25, 0.0, 0.0};
    double slope[4];
    int status = double_pendulum_right_hand_side(0.0, x, &double_pendulum_defaults, slope);
    printf("%d %.17g %d\\n", status, slope[2], SATELLITE_GRAVITATIONAL_STABILIZER_COORDINATES);
    return sizeof(simple_pendulum_parameters) > 0 ? 0 : 1;
}
""",
        encoding="utf-8",
    )
    program = tmp_path / "program"
    command = [compiler, *options, "-o", str(program), str(tmp_path / "main.c"), *sources, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, slope, count = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    assert (status, count) == ("0", "5")
    assert float(slope) == pytest.approx(_at_rest(0.5, 0.25), rel=1e-13)


def _at_rest(first: float, second: float) -> float:
    """alpha'' of two unit masses on unit rods at rest: 2 alpha'' + c beta'' = -2 g sin(alpha), c alpha'' + beta'' = -g
    sin(beta) with the angles alpha, beta from the vertical and c = cos(alpha - beta)."""
    alpha, beta = first, first + second
    c = math.cos(alpha - beta)
    return (-2 * 9.81 * math.sin(alpha) + c * 9.81 * math.sin(beta)) / (2 - c * c)


def test_names_of_systems_become_identifiers_that_differ() -> None:
    names = ["Double pendulum", "a", "A b", "漢字", "漢", "", "2 bodies", "é", "e", "x" * 50, "x" * 51, "int", "_"]
    prefixes = [prefix_of(name) for name in names]
    assert prefixes[0] == "double_pendulum"
    assert prefix_of("2 bodies") == "model_2_bodies"
    assert len(set(prefixes)) == len(names)
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", prefix) and len(prefix) <= 46 for prefix in prefixes)
