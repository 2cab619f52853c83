"""Inputs in generated code: every format takes them as an argument, and gives the accelerations found by hand."""

from __future__ import annotations

import ctypes
import math
import runpy
import shutil
import subprocess
import zipfile
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import filed

import mbsym
from mbsym.analysis import Analysis
from mbsym.report.code import c_source, python_module
from mbsym.report.exports import fmu, languages, modelica
from tests.report.readers import READERS

POLE = Path(__file__).parents[2] / "systems" / "cart-pole.yaml"
THETA, FORCE = 0.05, 3.0


@pytest.fixture(scope="module")
def pole() -> Analysis:
    return mbsym.load(POLE, ())


def accelerations() -> tuple[float, float]:
    """(M + m) p'' - m l c th'' = F, (J + m l^2) th'' - m l c p'' = m g l s at rest, by Cramer's rule."""
    c, s = math.cos(THETA), math.sin(THETA)
    down = 90 * 180 - (80 * c) ** 2
    return (180 * FORCE + 80 * c * 80 * 9.8 * s) / down, (90 * 80 * 9.8 * s + 80 * c * FORCE) / down


def test_c_takes_inputs(pole: Analysis, tmp_path: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    (tmp_path / "model.c").write_text(c_source.render(pole, ()))
    (tmp_path / "model.h").write_text(c_source.header(pole, ()))
    library = tmp_path / "model.so"
    strict = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-shared", "-fPIC"]
    subprocess.run([compiler, *strict, "-o", library, tmp_path / "model.c", "-lm"], check=True)
    functions = ctypes.CDLL(str(library))
    x, u, out = (ctypes.c_double * 4)(0, THETA, 0, 0), (ctypes.c_double * 1)(FORCE), (ctypes.c_double * 4)()
    values = (ctypes.c_double * 7).in_dll(functions, "cart_with_a_pole_defaults")
    assert functions.cart_with_a_pole_right_hand_side(ctypes.c_double(0), x, values, u, out) == 0
    assert list(out)[2:] == pytest.approx(accelerations(), rel=1e-13)


def test_casadi_and_jax_take_inputs(pole: Analysis, tmp_path: Path) -> None:
    for name in ("casadi", "jax"):
        text = languages.render(name, pole, ())
        assert "def right_hand_side(t, x, p, u):" in text
        compile(text, name, "exec")
        try:
            __import__(name)
        except ImportError:
            continue
        path = filed(tmp_path / f"exported_{name}.py", text)
        made = runpy.run_path(str(path))
        found = made["accelerations"](0.0, [0.0, THETA, 0.0, 0.0], made["parameters"](), [FORCE])
        assert [float(found[k]) for k in (0, 1)] == pytest.approx(accelerations(), rel=1e-6)


def test_octave_takes_inputs(pole: Analysis, tmp_path: Path) -> None:
    text = languages.render("octave", pole, ())
    READERS["m"](text)
    program = shutil.which("octave")
    if program is None:
        pytest.skip("no Octave")
    (tmp_path / "model.m").write_text(text)
    call = (
        f"m = model(); p = m.parameters(struct()); printf('%.15g ', m.accelerations(0, [0;{THETA};0;0], p, [{FORCE}]))"
    )
    done = subprocess.run([program, "-q", "--eval", call], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert [float(x) for x in done.stdout.split()] == pytest.approx(accelerations(), rel=1e-12)


def test_julia_and_modelica_name_inputs(pole: Analysis) -> None:
    text = languages.render("julia", pole, ())
    READERS["jl"](text)
    assert "function right_hand_side(t, x, p, u)" in text
    assert 'const INPUTS = ("F", )' in text
    flat = modelica.render(pole, ())
    READERS["mo"](flat)
    assert '  input Real F "force on the cart";' in flat


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_has_inputs_as_variables(pole: Analysis, version: int, tmp_path: Path) -> None:
    content = fmu.render(pole, (), version)
    READERS["fmu"](content)
    with zipfile.ZipFile(BytesIO(content)) as archive:
        archive.extractall(tmp_path)
    root = ElementTree.parse(tmp_path / "modelDescription.xml").getroot()
    inputs = [item for item in root.iter() if item.get("causality") == "input"]
    assert [(item.get("name"), item.get("variability")) for item in inputs] == [("F", "continuous")]
    libraries = list(tmp_path.glob("binaries/*/*.so"))
    if not libraries or version == 3:
        return
    place = int(str(inputs[0].get("valueReference")))
    slopes = [int(str(x.get("valueReference"))) for x in root.iter() if (x.get("name") or "").startswith("der(")]
    functions = ctypes.CDLL(str(libraries[0]))
    functions.fmi2Instantiate.restype = ctypes.c_void_p
    made = ctypes.c_void_p(functions.fmi2Instantiate(b"one", 0, str(root.get("guid")).encode(), b"", None, 0, 0))
    assert made.value
    one = (ctypes.c_uint * 1)(place)
    assert functions.fmi2EnterInitializationMode(made) == 0
    assert functions.fmi2ExitInitializationMode(made) == 0
    assert functions.fmi2SetReal(made, one, ctypes.c_size_t(1), (ctypes.c_double * 1)(FORCE)) == 0
    out = (ctypes.c_double * 4)()
    assert functions.fmi2GetReal(made, (ctypes.c_uint * 4)(*slopes), ctypes.c_size_t(4), out) == 0
    assert list(out)[2:] == pytest.approx(accelerations(), rel=1e-13)
    functions.fmi2FreeInstance(made)


def test_names_that_code_would_take_for_its_own(tmp_path: Path) -> None:
    text = POLE.read_text(encoding="utf-8").replace("{p:", "{u:").replace("[p,", "[u,").replace("[p]", "[u]")
    text = text.replace("coordinate: p,", "coordinate: u,").replace("y1: p", "y1: u")
    analysis = mbsym.loads(text, ())
    assert analysis.system.coordinates == ("u", "theta")
    path = filed(tmp_path / "exported_u.py", python_module.render(analysis, (5,)))
    made = runpy.run_path(str(path))
    found = made["rhs"](0.0, [0.0, THETA, 0.0, 0.0], made["DEFAULTS"], [FORCE])
    assert list(found[2:]) == pytest.approx(accelerations(), rel=1e-13)
