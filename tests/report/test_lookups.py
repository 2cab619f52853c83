"""Tables in generated code: C and Python against NumPy's ``interp`` and SciPy's spline; what is refused, and how."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.table import Tabulated
from mbsym.report.code.functions import c_definition, identifier
from mbsym.report.targets import FORMATS

X = np.cumsum(np.random.default_rng(3).integers(1, 9, 240)) / 64
Y = np.random.default_rng(4).integers(-300, 300, 240) / 32
DESCRIPTION = """
mbsym: 1
name: Mast
parameters: {m: {positive: true, value: 2}}
tables:
  wind_x: {points: [POINTS], outside: error}
  bump: {points: [[-1, 0.25], [0, 0], [1, 0.5]], between: cubic, outside: extrapolate}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
loads:
  - generalized force: {x: wind_x(t)}
  - potential: bump(x)
"""
BUMP = CubicSpline([-1, 0, 1], [0.25, 0, 0.5], bc_type="natural")
TEXT = DESCRIPTION.replace("POINTS", ", ".join(f"[{x}, {y}]" for x, y in zip(X, Y, strict=True)))


@pytest.fixture(scope="module")
def analysis() -> Any:
    return mbsym.loads(TEXT)


def expected(t: float, x: float) -> float:
    return float(np.interp(t, X, Y) - BUMP(x, 1)) / 2


AT = [(float(X[0]), -3.0), (3.21, 0.3), (float(X[17]), 0.0), (7.0, 2.5), (float(X[-1]), 0.99)]


def module_of(text: str, monkeypatch: pytest.MonkeyPatch | None = None) -> ModuleType:
    found = ModuleType("made")
    if monkeypatch is not None:  # NumPy has the names that are used of JAX
        jax = ModuleType("jax")
        jax.numpy = np  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "jax", jax)
        monkeypatch.setitem(sys.modules, "jax.numpy", np)
    exec(compile(text, "made.py", "exec"), found.__dict__)
    return found


def test_the_python_module(analysis: Any) -> None:
    model = module_of(FORMATS["python"].render(analysis, (1, 2, 3, 7)))
    for t, x in AT:
        assert model.rhs(t, np.array([x, 0.5]), {"m": 2})[1] == pytest.approx(expected(t, x), abs=1e-11)
    assert np.isnan(model.rhs(float(X[-1]) + 1e-6, np.array([0, 0]), {"m": 2})[1])
    many = model.rhs(3.21, np.array([[0.1, 0.2, -4], [0, 0, 0]]), {"m": 2})[1]
    assert many == pytest.approx([expected(3.21, x) for x in (0.1, 0.2, -4)], abs=1e-11)
    slope = model.jacobian(3.21, np.array([0.3, 0.5]), {"m": 2})[1][0]
    assert slope == pytest.approx(-float(BUMP(0.3, 2)) / 2)


def test_the_functions_for_jax(analysis: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    model = module_of(FORMATS["jax"].render(analysis, (1, 2, 3)), monkeypatch)
    for t, x in AT:
        assert model.accelerations(t, [x, 0.5], [2.0])[0] == pytest.approx(expected(t, x), abs=1e-11)


def test_the_source_in_c(tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    system = mbsym.loads(TEXT).system
    wind, bump = (Tabulated(table.curve) for table in system.tables)
    names = (wind, bump, bump.slope)
    text = "#include <math.h>\n" + "".join(map(c_definition, names))
    text += "".join(f"double out{k}(double x) {{ return {identifier(name)}(x); }}\n" for k, name in enumerate(names))
    (tmp_path / "f.c").write_text(text)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC", "-O1"]
    subprocess.run([compiler, *flags, str(tmp_path / "f.c"), "-o", str(tmp_path / "f.so")], check=True)
    library = ctypes.CDLL(str(tmp_path / "f.so"))
    functions = [library.out0, library.out1, library.out2]
    for one in functions:
        one.restype, one.argtypes = ctypes.c_double, [ctypes.c_double]
    for t, x in AT:
        assert functions[0](t) == pytest.approx(float(np.interp(t, X, Y)), abs=1e-11)
        assert functions[1](x) == pytest.approx(float(BUMP(x)), abs=1e-12)
        assert functions[2](x) == pytest.approx(float(BUMP(x, 1)), abs=1e-12)
    assert np.isnan(functions[0](float(X[-1]) + 1e-9))
    assert np.isnan(functions[1](float("nan")))


@pytest.mark.parametrize("target", ["casadi", "julia", "octave", "modelica"])
def test_languages_without_tables_say_so(analysis: Any, target: str) -> None:
    """Short tables are written out by moduli there, long ones are refused by name."""
    with pytest.raises(NoClosedForm, match="the table wind_x has 240 points"):
        FORMATS[target].render(analysis, (1, 2, 3))
    short = mbsym.loads(
        DESCRIPTION.replace("POINTS", "[0, 1], [1, 3], [2, -1]").replace("outside: error", "between: linear")
    )
    assert "abs(" in FORMATS[target].render(short, (1, 2, 3))


def test_a_wrong_number_is_noticed(analysis: Any) -> None:
    text = FORMATS["python"].render(analysis, (1, 2, 3, 7))
    place = text.index("def lookup__bump__1")
    wrong = text[:place] + text[place:].replace("row[1] + u*", "row[1] - u*", 1)
    assert wrong != text
    found = module_of(wrong).rhs(3.21, np.array([-0.5, 0.5]), {"m": 2})[1]
    assert abs(found - expected(3.21, -0.5)) > 1e-6
