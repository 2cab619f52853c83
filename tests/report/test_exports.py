"""Exports, each run by who reads it, against d'Alembert's principle and closed formulas at random states.

Every check is run on corrupted files, too, and has to find each of them.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import io
import math
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, imported
from mutants import corrupted
from test_reports import NASTY
from truth_at_states import Point, differences, random_point, truth

import mbsym
from mbsym.analysis import Analysis
from mbsym.report.code import c_source
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.exports import fmu
from mbsym.report.exports.modelica import proposed
from mbsym.report.targets import EXPORTS, FORMATS, TARGETS
from tests.report.readers import unreadable

#: Functions of every kind, the time, a spring and a damper between points, a length that is driven.
FUNCTIONS = """
mbsym: 1
name: Functions of 漢字 "kinds" \\ $x # % //
parameters: {m: positive, end: positive, g: positive, k: {positive: true, value: 7/3}, model: positive, c: 0.1}
prescribed: {lift: {rate: c, initial: end/3}}
relations: {model: k**2/end}
bodies:
  - {name: "first/body", attached to: 0, connection point: [0, lift, 0], rotation: {axes: [3], angles: [phi]},
     mass centre: [end, 0, 0], mass: m, inertia about: mass centre, inertia: [k, k, k]}
  - {name: "end", attached to: "first/body", connection point: [u, 0, 0], coordinates: [u], mass: model}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
  - spring: {coordinate: u, stiffness: k, rest: end}
  - damper: {coordinate: phi, coefficient: c}
  - generalized force: {u: log(1 + u**2)*exp(-c*t) + atan(phi)/3, phi: tanh(u_dot) - sinh(phi)*cosh(u)/11}
  - potential: sqrt(1 + u**2)*k
motion: {phi: 0, u: 0}
initial: {phi: {position: pi/6, velocity: 1/3}, u: {position: end/2}}
"""
#: Functions with kinks and jumps, of the time, of places and of velocities.
KINKED = """
mbsym: 1
name: Kinks and jumps
parameters: {m: positive, k: positive, F: positive, a: positive, b: positive}
bodies:
  - {name: block, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: arm, attached to: block, rotation: {axes: [3], angles: [q]}, mass centre: [a, 0, 0], mass: m}
loads:
  - potential: k*abs(x - a*sin(q)) + abs(q)**3/3
  - rayleigh: b*abs(x_dot + q_dot)
  - generalized force:
      x: F*pulse(t, a, b) - F*sign(x_dot - b)*abs(x) + step(x - a/3)*F
      q: -F*step(1 - 2*t) + tanh(x)*abs(q_dot)*q_dot
"""
#: Forces by points: of the time, and of a place.
TABULATED = """
mbsym: 1
name: Tabulated
parameters: {m: positive, a: positive, F: positive}
tables:
  push: {points: [[0, 0], [0.25, 2.5], [0.75, 0], [3, 1]], between: cubic}
  sag: {points: [[-2, 1/3], [0.3, 0.25], [3.1, -1]], outside: zero}
bodies:
  - {name: block, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
  - {name: arm, attached to: block, rotation: {axes: [3], angles: [q]}, mass centre: [a, 0, 0], mass: m}
loads:
  - generalized force: {x: F*push(t), q: sag(q)*a + push(x_dot)}
"""
#: Name -> description; how many states.
SYSTEMS = {
    "double-pendulum": 2,
    "satellite": 1,
    "satellite-with-damper-driven": 1,
    "clebsch": 1,
    "nasty": 1,
    "functions": 2,
    "kinked": 8,
    "tabulated": 3,
}
SMALL = ("double-pendulum", "functions", "kinked")
COMPILER = shutil.which("cc")


@cache
def analysis_of(name: str) -> Analysis:
    own = {"nasty": NASTY, "functions": FUNCTIONS, "kinked": KINKED, "tabulated": TABULATED}
    return mbsym.loads(own[name]) if name in own else mbsym.load(SHIPPED / f"{name}.yaml")


@cache
def points(name: str) -> list[Point]:
    return [random_point(analysis_of(name), seed) for seed in range(SYSTEMS[name])]


@cache
def expected(name: str) -> list[dict[str, Any]]:
    return [truth(analysis_of(name), point) for point in points(name)]


@cache
def text_of(name: str, kind: str) -> str:
    analysis = analysis_of(name)
    text = FORMATS[kind].render(analysis, (5, 7))
    assert isinstance(text, str)
    assert not unreadable(FORMATS[kind].filename, text)
    return text


# --- who reads them ---


def module(text: str, folder: Path) -> Any:
    return imported(filed(folder / "exported.py", text))


def by_casadi(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    pytest.importorskip("casadi")
    functions = module(text, folder).functions()
    return [
        gathered(
            {
                key: np.array(function(at.t, list(at.x), list(at.p), *some(key, at)))
                for key, function in functions.items()
            }
        )
        for at in points(name)
    ]


def some(name: str, at: Point) -> list[list[float]]:
    """Accelerations or forces, where a function takes some."""
    return [[1.0 + k for k in range(len(at.x) // 2)]] if name in ("inverse_dynamics", "forward_dynamics") else []


def gathered(found: dict[str, Any]) -> dict[str, Any]:
    """With poses and Jacobians of all frames as one array each."""
    for stem in ("pose", "jacobian"):
        found[f"frame_{stem}s"] = np.array([x for key, x in found.items() if key.startswith(f"frame_{stem}_")])
    return found


def by_jax(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    model = module(text, folder)
    frames = [key for key in dir(model) if key.startswith("frame_")]
    frames.sort(key=lambda key: text.index(f"def {key}("))
    return [
        gathered(
            {
                key: np.array(getattr(model, key)(at.t, np.array(at.x), np.array(at.p), *map(np.array, some(key, at))))
                for key in [*(key for key in wanted if not key.startswith("frame_")), *frames]
            }
        )
        for at, wanted in zip(points(name), expected(name), strict=True)
    ]


def by_octave(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    if shutil.which("octave-cli") is None:
        pytest.skip("no Octave")
    (folder / "model.m").write_text(text, encoding="utf-8")
    lines = ["m = model();"]
    for at, wanted in zip(points(name), expected(name), strict=True):
        lines += [f"t = {at.t!r}; x = {list(at.x)}; p = {list(at.p)};"]
        lines += [f"printf('%.17g ', m.{key}(t, x, p)'); printf('\\n');" for key in wanted if key not in ARMS]
    done = subprocess.run(
        ["octave-cli", "--no-gui", "--norc", "--eval", " ".join(lines)], cwd=folder, capture_output=True, text=True
    )
    rows = iter(done.stdout.split("\n"))
    found = []
    for wanted in expected(name):
        found.append({key: np.array(next(rows, "").split(), float) for key in wanted if key not in ARMS})
    return found


def by_julia(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    """Julia where it is installed; its functions translated line by line where it is not."""
    if shutil.which("julia") is not None:
        return by_julia_itself(text, name, folder)
    functions = translated(text)
    return [
        {key: np.array(functions[key](at.t, np.array(at.x), np.array(at.p))) for key in wanted if key not in ARMS}
        for at, wanted in zip(points(name), expected(name), strict=True)
    ]


def by_julia_itself(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    kind = re.findall(r"^module (\w+)$", text, re.MULTILINE)[0]
    lines = [text]
    for at, wanted in zip(points(name), expected(name), strict=True):
        state = f"{at.t!r}, Float64{list(at.x)}, Float64{list(at.p)}"
        lines += [f"println(join(permutedims([{kind}.{key}({state});;]), ' '))" for key in wanted if key not in ARMS]
    (folder / "model.jl").write_text("\n".join(lines), encoding="utf-8")
    done = subprocess.run(["julia", "--startup-file=no", "model.jl"], cwd=folder, capture_output=True, text=True)
    rows = iter(done.stdout.split("\n"))
    return [
        {key: np.array(next(rows, "").split(), float) for key in wanted if key not in ARMS} for wanted in expected(name)
    ]


def translated(text: str) -> dict[str, Any]:
    """The functions of (t, x, p) of a module of Julia as functions of Python: what differs are indices and zeros."""
    names: dict[str, Any] = {"np": np, "zeros": lambda _, *shape: np.zeros(shape)}
    names |= {key: getattr(math, key) for key in ("sin", "cos", "sqrt", "exp", "log", "atan", "sinh", "cosh", "tanh")}
    names |= {"abs": abs, "sign": np.sign}
    names |= dict.fromkeys(("promote_type", "typeof", "eltype"), lambda *_: None) | {"Float64": None}
    for head, body in re.findall(r"^function (\w+\(t, x, p\))\n(.*?)^end\n", text, re.MULTILINE | re.DOTALL):
        indexed = re.sub(r"\[([\d, ]+)\]", lambda m: str([int(k) - 1 for k in m[1].split(",")]), body)
        indexed = re.sub(r"\[(\d+), (\d+)\]", r"[\1][\2]", indexed)
        if not head.startswith(("right_hand_side", "consistent")):
            exec(f"def {head}:\n{indexed}", names)
    return names


def by_modelica(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    system = analysis_of(name).system
    found = []
    for at in points(name):
        values = by_modelica_at(text, folder, [proposed(key) for key in system.parameter_names], at)
        slopes = [key for key in values if key.startswith("der(")]
        own: dict[str, Any] = {"accelerations": [values[key] for key in slopes[len(slopes) // 2 :]]}
        own |= {key: values[key] for key in ("energy", "generalized_energy")}
        own["integrals"] = [value for key, value in values.items() if key.startswith("integral_")]
        for key, stem in (("joints", "joint"), ("mass_centres", "centre")):
            bodies = range(1, len(system.bodies) + 1)
            own[key] = [[values[f"{stem}{k}[{axis}]"] for axis in (1, 2, 3)] for k in bodies]
        found.append(own)
    return found


def by_modelica_at(text: str, folder: Path, own_names: list[str], at: Point) -> dict[str, float]:
    """Name -> value.  Parsed by pymoca, which gives left - right of all equations; as no variable needs itself, they
    are solved by putting right sides in place of left ones until nothing changes."""
    pytest.importorskip("pymoca")
    casadi = pytest.importorskip("casadi")
    from pymoca.backends.casadi import generator
    from pymoca.backends.casadi.api import transfer_model

    generator.OP_MAP["/"] = "__truediv__"  # pymoca says __div__, which Python no longer has
    casadi.MX.atan = casadi.MX.arctan  # it looks for Modelica's own names
    (folder / "model.mo").write_text(text, encoding="utf-8")
    model = transfer_model(str(folder), re.findall(r"^model (\w+)", text)[0], {"cache": False})
    residual = model.dae_residual_function
    states, slopes, others = ([v.symbol for v in part] for part in (model.states, model.der_states, model.alg_states))
    assert len(states) == len(slopes) == len(at.x)
    places = {key.name(): k for k, key in enumerate(slopes)}
    for symbol in others:
        first, size = len(places), symbol.numel()
        places |= {f"{symbol.name()}[{k + 1}]" if size > 1 else symbol.name(): first + k for k in range(size)}
    left = re.findall(r"^  (\S+) = ", text.rpartition("\nequation\n")[2], re.MULTILINE)
    order = [places[key] for key in left]
    assert sorted(order) == list(range(len(places)))
    given = dict(zip(own_names, at.p, strict=True))
    p = [given[v.symbol.name()] for v in model.parameters]
    values = np.ones(len(places))
    for _ in range(len(places) + 2):
        sides = residual(at.t, at.x, values[: len(slopes)], values[len(slopes) :], [], [], p)
        new = values[order] - np.array(sides).ravel()
        new[~np.isfinite(new)] = 1.0
        if np.array_equal(values[order], new):
            break
        values[order] = new
    return {key: float(values[place]) for key, place in places.items()}


def by_python(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    """model.py, three equal states at once and one alone."""
    model, system, found = module(text, folder), analysis_of(name).system, []
    for at in points(name):
        n = len(system.coordinates)
        x, p = np.array(at.x), dict(zip(system.parameter_names, at.p, strict=True))
        own = {
            "mass_matrix": model.mass_matrix(x[:n], p, at.t),
            "forcing": model.forcing(x[:n], x[n:], p, at.t),
            "accelerations": model.rhs(at.t, x, p)[n:],
            "jacobian": model.jacobian(at.t, x, p),
            "energy": model.energy(x[:n], x[n:], p, at.t),
            "generalized_energy": model.generalized_energy(x[:n], x[n:], p, at.t),
            "inverse_dynamics": model.inverse_dynamics(x[:n], x[n:], *some("inverse_dynamics", at), p, at.t),
            "forward_dynamics": model.forward_dynamics(x[:n], x[n:], *some("forward_dynamics", at), p, at.t),
            "coriolis": model.coriolis(x[:n], x[n:], p, at.t),
            "gravity": model.gravity(x[:n], p, at.t),
            "frame_poses": np.array([model.frame_pose(one, x[:n], p, at.t) for one in model.FRAMES]),
            "frame_jacobians": np.array([model.frame_jacobian(one, x[:n], p, at.t) for one in model.FRAMES]),
        }
        many = np.repeat(x[:, np.newaxis], 3, axis=1)
        assert np.allclose(
            model.frame_jacobian(model.FRAMES[-1], many[:n], p, at.t)[..., 1], own["frame_jacobians"][-1]
        )
        assert np.allclose(model.jacobian(at.t, many, p)[..., 1], own["jacobian"], rtol=1e-13)
        if model.INTEGRALS:
            values = model.integrals(at.t, x, p)
            assert list(values) == list(model.INTEGRALS)
            own["integrals"] = list(values.values())
            assert model.integrals(at.t, many, p)[next(iter(values))].shape == (3,)
        found.append(own)
    return found


def by_c(text: str, name: str, folder: Path) -> list[dict[str, Any]]:
    """model.c, compiled."""
    if COMPILER is None:
        pytest.skip("no C compiler")
    from mbsym.report.code import c_source

    analysis = analysis_of(name)
    (folder / "model.c").write_text(text, encoding="utf-8")
    (folder / "model.h").write_text(c_source.header(analysis, ()), encoding="utf-8")
    library = folder / f"model{len(list(folder.iterdir()))}.so"
    command = [COMPILER, "-std=c99", "-O1", "-shared", "-fPIC", "-o", str(library), str(folder / "model.c"), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    functions, prefix = ctypes.CDLL(str(library)), prefix_of(analysis.system.name)
    n, found = len(analysis.system.coordinates), []
    for at in points(name):
        x, p, t = (ctypes.c_double * (2 * n))(*at.x), (ctypes.c_double * (len(at.p) or 1))(*at.p), ctypes.c_double(at.t)
        qd = ctypes.cast(ctypes.byref(x, 8 * n), ctypes.POINTER(ctypes.c_double))
        some_numbers = (ctypes.c_double * n)(*range(1, n + 1))
        own: dict[str, Any] = {}
        for key, arguments, size in (
            ("mass_matrix", (x,), n * n), ("forcing", (x, qd), n), ("accelerations", (x, qd), n),
            ("jacobian", (x,), 4 * n * n), ("coriolis", (x, qd), n), ("gravity", (x,), n),
            ("inverse_dynamics", (x, qd, some_numbers), n), ("forward_dynamics", (x, qd, some_numbers), n),
        ):  # fmt: skip
            out = (ctypes.c_double * size)()
            getattr(functions, f"{prefix}_{key}")(t, *arguments, p, out)
            own[key] = list(out)
        for key, size in (("frame_pose", 16), ("frame_jacobian", 6 * n)):
            out, rows = (ctypes.c_double * size)(), []
            for k in range(len(analysis.system.bodies)):
                assert getattr(functions, f"{prefix}_{key}")(k, t, x, p, out) == 0
                rows.append(list(out))
            assert getattr(functions, f"{prefix}_{key}")(k + 1, t, x, p, out) != 0
            own[f"{key}s"] = rows
        for key in ("energy", "generalized_energy"):
            function = getattr(functions, f"{prefix}_{key}")
            function.restype = ctypes.c_double
            own[key] = function(t, x, qd, p)
        found.append(own)
    return found


Reader = Callable[[str, str, Path], list[dict[str, Any]]]
READERS: dict[str, Reader] = {
    "casadi": by_casadi,
    "jax": by_jax,
    "octave": by_octave,
    "julia": by_julia,
    "modelica": by_modelica,
    "python": by_python,
    "c": by_c,
}
#: What they do not hold; Modelica's tools differentiate themselves.
PLACES = {"joints", "mass_centres"}
ARMS = {"inverse_dynamics", "forward_dynamics", "frame_poses", "frame_jacobians"}
LEFT = {
    "modelica": {"mass_matrix", "forcing", "jacobian", "coriolis", "gravity", *ARMS},
    "octave": ARMS,
    "julia": ARMS,
    "python": PLACES,
    "c": {*PLACES, "integrals"},
}


def wrong(kind: str, text: str, name: str, folder: Path) -> list[str]:
    found = READERS[kind](text, name, folder)
    wanted = [{key: value for key, value in one.items() if key not in LEFT.get(kind, ())} for one in expected(name)]
    return [key for own, one in zip(found, wanted, strict=True) for key in differences(own, one)]


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("kind", READERS)
def test_numbers_are_those_of_mechanics(kind: str, name: str, tmp_path: Path) -> None:
    assert wrong(kind, text_of(name, kind), name, tmp_path) == []


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("kind", READERS)
def test_a_corrupted_file_is_found(kind: str, name: str, tmp_path: Path) -> None:
    text, computed = text_of(name, kind), 0  # these seeds plant no change that algebra undoes
    for seed in range(12):
        if seed >= 4 and computed:
            break
        chance = Random(f"{seed} of {name} as {kind}")
        code, mark, rest = text.partition("def linear_matrices")  # of the first approximation, which is not compared
        changed = corrupted(code, chance) + mark + rest
        assert changed != text
        if unreadable(FORMATS[kind].filename, changed):
            continue
        try:
            assert wrong(kind, changed, name, tmp_path), changed
            computed += 1
        except (NameError, RuntimeError, ValueError, TypeError, AttributeError, IndexError, KeyError):
            continue  # its reader refuses it
    assert computed


# --- values, states, what is missing ---


def test_parameters_and_states_are_the_description_s(tmp_path: Path) -> None:
    """lift = c t + end/3, model = k^2/end; m, end and g have no value and must be given."""
    for kind in ("casadi", "jax"):
        pytest.importorskip(kind)
        model = module(text_of("functions", kind), tmp_path)
        with pytest.raises(ValueError, match=r"no value for m, end, g, model$"):
            model.parameters()
        with pytest.raises(ValueError, match="no parameter mm"):
            model.parameters(mm=1)
        p = model.parameters(m=1, end=2, g=3)
        assert p == pytest.approx([1, 2, 3, 7 / 3, 49 / 18, 0.1], rel=1e-15)
        assert model.parameters(m=1, end=2, g=3, model=5)[4] == 5
        assert model.initial_state(p) == pytest.approx([math.pi / 6, 1.0, 1 / 3, 0.0], rel=1e-15)
    assert "parameter Real m;" in text_of("functions", "modelica")
    assert "parameter Real model_ = k*k/end_;" in text_of("functions", "modelica")


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="no Octave")
def test_octave_takes_parameters_by_name(tmp_path: Path) -> None:
    (tmp_path / "model.m").write_text(text_of("functions", "octave"), encoding="utf-8")
    code = """m = model(); try, m.parameters(struct()); catch e, disp(e.message); end
    given = struct('m', 1, 'g', 3); given.('end') = 2; p = m.parameters(given);
    printf('%.17g ', p, m.initial_state(p));
    [~, x] = ode45(@(t, x) m.right_hand_side(t, x, p), [0 0.1], m.initial_state(p)); disp(size(x, 2));"""
    done = subprocess.run(
        ["octave-cli", "--no-gui", "--norc", "--eval", code], cwd=tmp_path, capture_output=True, text=True
    )
    first, numbers = done.stdout.strip().split("\n")
    assert first == "no value for m, end, g, model"
    expected_ = [1, 2, 3, 7 / 3, 49 / 18, 0.1, math.pi / 6, 1, 1 / 3, 0, 4]
    assert [float(x) for x in numbers.split()] == pytest.approx(expected_, rel=1e-15)


# --- FMUs ---

needs_compiler = pytest.mark.skipif(fmu.compiler() is None, reason="no C compiler")


def unzipped(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


class Instance:
    """An FMU of either version, ready to be asked at a point."""

    def __init__(self, path: Path, version: int) -> None:
        fmpy = pytest.importorskip("fmpy")
        self.description = fmpy.read_model_description(str(path))
        folder = fmpy.extract(str(path), unzipdir=str(path.with_suffix("")))
        kind = {2: "fmi2.FMU2Model", 3: "fmi3.FMU3Model"}[version].split(".")
        made = getattr(importlib.import_module(f"fmpy.{kind[0]}"), kind[1])
        identifier = self.description.modelExchange.modelIdentifier
        self.version = version
        self.model = made(
            guid=self.description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="it"
        )
        self.model.instantiate()
        self.references = {item.name: item.valueReference for item in self.description.modelVariables}

    def set(self, name: str, value: float) -> None:
        (self.model.setReal if self.version == 2 else self.model.setFloat64)([self.references[name]], [value])

    def get(self, name: str) -> float:
        return float((self.model.getReal if self.version == 2 else self.model.getFloat64)([self.references[name]])[0])

    def start(self, at: float = 0.0) -> None:
        if self.version == 2:
            self.model.setupExperiment(startTime=at)
            self.model.enterInitializationMode()
        else:
            self.model.enterInitializationMode(startTime=at)
        self.model.exitInitializationMode()


def by_fmu(path: Path, version: int, name: str) -> list[dict[str, Any]]:
    """x' by its states, energies, and J by seeds of one column each."""
    system, found = analysis_of(name).system, []
    names = [*system.coordinates, *system.velocities]
    for at in points(name):
        instance = Instance(path, version)
        related = {item.name for item in system.relations}
        for key, value in zip(system.parameter_names, at.p, strict=True):
            if key not in related:
                instance.set(key, value)
        for key, value in zip(names, at.x, strict=True):
            instance.set(key, value)
        instance.start(at.t)
        unknowns = [instance.references[f"der({key})"] for key in names]
        knowns = [instance.references[key] for key in names]
        derivative = instance.model.getDirectionalDerivative
        columns = [derivative(unknowns, [known], [1.0]) for known in knowns]
        found.append(
            {
                "accelerations": [instance.get(f"der({key})") for key in system.velocities],
                "jacobian": np.array(columns, float).T,
                "energy": instance.get("energy"),
                "generalized_energy": instance.get("generalized_energy"),
            }
        )
        instance.model.freeInstance()
    return found


def related_points(name: str, monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The truth where parameters keep to their relations, as in an FMU: these points take the place of the others."""
    from fractions import Fraction

    from mbsym.numerics.scenario import exact

    system, kept = analysis_of(name).system, []
    for at in points(name):
        known = dict(zip(system.parameter_names, map(Fraction, at.p), strict=True))
        for _ in system.relations:
            known |= {item.name: exact(item.value, known) for item in system.relations}
        kept.append(Point(at.t, at.x, tuple(float(known[key]) for key in system.parameter_names)))
    monkeypatch.setitem(globals(), "points", lambda _: kept)
    keys = ("accelerations", "jacobian", "energy", "generalized_energy")
    return [{key: truth(analysis_of(name), at)[key] for key in keys} for at in kept]


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["double-pendulum", "functions"])
def test_an_fmu_is_valid_and_its_numbers_are_those_of_mechanics(
    version: int, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    path = tmp_path / "model.fmu"
    content = EXPORTS[f"fmu{version}"].render(analysis_of(name), ())
    assert isinstance(content, bytes)
    assert not unreadable("model.fmu", content)
    path.write_bytes(content)
    assert validate_fmu(str(path)) == []
    wanted = related_points(name, monkeypatch)
    found = by_fmu(path, version, name)
    assert [differences(own, one) for own, one in zip(found, wanted, strict=True)] == [[]] * len(wanted)


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_moves_as_the_simulation_does(version: int, tmp_path: Path) -> None:
    fmpy = pytest.importorskip("fmpy")
    path = tmp_path / "model.fmu"
    content = EXPORTS[f"fmu{version}"].render(analysis_of("double-pendulum"), ())
    path.write_bytes(bytes(content))
    run = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 3, tolerance=1e-12)
    names = ["theta1", "theta2"]
    result = fmpy.simulate_fmu(
        str(path), stop_time=3, solver="CVode", relative_tolerance=1e-10, output=names, output_interval=0.1
    )
    assert [result[key][-1] for key in names] == pytest.approx([run[key][-1] for key in names], abs=1e-6)


@needs_compiler
def test_an_fmu_wants_what_has_no_value(tmp_path: Path) -> None:
    pytest.importorskip("fmpy")
    for version in (2, 3):
        path = tmp_path / f"model{version}.fmu"
        path.write_bytes(bytes(EXPORTS[f"fmu{version}"].render(analysis_of("functions"), ())))
        instance = Instance(path, version)
        instance.set("m", 1.0)
        instance.set("end", 2.0)
        assert instance.get("model") == pytest.approx(49 / 18, rel=1e-15)
        assert math.isnan(instance.get("g"))
        with pytest.raises(Exception, match="ExitInitializationMode"):
            instance.start()
        with pytest.raises(Exception, match="Set"):
            instance.set("model", 1.0)


@needs_compiler
def test_a_corrupted_source_of_an_fmu_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fmpy")
    wanted = related_points("double-pendulum", monkeypatch)
    files = fmu.sources(analysis_of("double-pendulum"), 2)
    head, mark, code = files["sources/model.c"].decode().partition("double double_pendulum_energy(")
    for seed in range(3):
        changed = corrupted(code, Random(f"fmu {seed}"))
        broken = files | {"sources/model.c": (head + mark + changed).encode()}
        path = tmp_path / f"{seed}.fmu"
        try:
            path.write_bytes(fmu._zip(broken | fmu._library(analysis_of("double-pendulum"), broken, 2)))
        except RuntimeError:
            continue  # the compiler refuses it
        found = by_fmu(path, 2, "double-pendulum")
        assert any(differences(own, one) for own, one in zip(found, wanted, strict=True)), changed


def test_the_same_fmu_whenever_it_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the same compiler even the binary; without one the sources alone, and that is told."""
    first, again = (EXPORTS["fmu3"].render(mbsym.load(SHIPPED / "simple-pendulum.yaml"), ()) for _ in range(2))
    assert first == again
    monkeypatch.setattr(fmu, "compiler", lambda: None)
    without = EXPORTS["fmu3"].render(mbsym.load(SHIPPED / "simple-pendulum.yaml"), ())
    assert not any(name.startswith("binaries") for name in unzipped(bytes(without)))
    assert "sources/buildDescription.xml" in unzipped(bytes(without))
    assert "no C compiler" in fmu.remark()
    assert not unreadable("model.fmu", without)
    assert unreadable("model.fmu", without[:-30])


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("version", [2, 3])
def test_sources_of_an_fmu_compile_without_a_warning(version: int, compiler: str, tmp_path: Path) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    for name in ("nasty", "functions"):
        for path, content in fmu.sources(analysis_of(name), version).items():
            (tmp_path / Path(path).name).write_bytes(content)
        options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only"]
        done = subprocess.run([compiler, *options, f"fmi{version}.c"], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_what_the_header_says_of_results_that_are_no_numbers(tmp_path: Path) -> None:
    # Kepler's problem at the centre: M = diag(m, m) is regular and every number finite, the force mu m/r^2 is not.
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    kepler = mbsym.load(Path(__file__).parents[1] / "cases" / "statements" / "kepler.yaml")
    header, library = c_source.header(kepler, ()), tmp_path / "model.so"
    (tmp_path / "model.c").write_text(c_source.render(kepler, ()))
    (tmp_path / "model.h").write_text(header)
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, tmp_path / "model.c", "-lm"], check=True)
    functions, out = ctypes.CDLL(str(library)), (ctypes.c_double * 4)()
    values = (ctypes.c_double * 2).in_dll(functions, "kepler_e_0_9_defaults")
    for x, status in ((0.1, 0), (0.0, 1)):
        state = (ctypes.c_double * 4)(x, 0, 0, 1)
        assert functions.kepler_e_0_9_right_hand_side(ctypes.c_double(0), state, values, out) == status
    assert "a force is infinite or has no value" in " ".join(header.split())


def test_exports_are_made_only_where_they_are_named() -> None:
    assert not TARGETS.keys() & EXPORTS.keys()
    assert FORMATS.keys() == TARGETS.keys() | EXPORTS.keys()


# --- model.py as a program ---


def test_model_py_simulates_and_plots(tmp_path: Path) -> None:
    """By itself, in a process of its own: as mbsym simulates, and its types hold in strict mode."""
    path, figure = tmp_path / "model.py", tmp_path / "motion.png"
    path.write_text(text_of("double-pendulum", "python"), encoding="utf-8")
    command = [sys.executable, str(path), "--time", "3", "--plot", str(figure), "--set", "theta1=0.5", "--set", "m2=2"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    run = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 3, values={"theta1": "0.5", "m2": "2"}, tolerance=1e-12)
    told = dict(re.findall(r"  (\w+) = (\S+) at the end", done.stdout))
    assert {key: float(value) for key, value in told.items()} == pytest.approx(
        {key: run[key][-1] for key in ("theta1", "theta2", "theta1_dot", "theta2_dot")}, abs=1e-6
    )
    assert "generalized_energy (generalised energy, proved)" in done.stdout
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_model_py_names_what_it_lacks(tmp_path: Path) -> None:
    model = module(text_of("functions", "python"), tmp_path)
    with pytest.raises(ValueError, match=r"parameters m, end, g, model$"):
        model.rhs(0.0, np.zeros(4), model.complete())
    p = model.complete({"m": 1, "end": 2, "g": 3})
    assert p["model"] == pytest.approx(49 / 18, rel=1e-15)
    assert model.complete({"m": 1, "end": 2, "g": 3, "model": 5})["model"] == 5
    assert model.initial_state(p) == pytest.approx([math.pi / 6, 1.0, 1 / 3, 0.0], rel=1e-15)
    assert model.initial_state(p, {"u": 7})[1] == 7
    model = module(text_of("nasty", "python"), tmp_path)
    with pytest.raises(ValueError, match="no initial position for s, phi, lam"):
        model.initial_state(model.complete())
    done = subprocess.run([sys.executable, tmp_path / "exported.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert "no value for the parameters N, K" in done.stderr


def test_types_of_model_py_hold_in_strict_mode(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    path = filed(tmp_path / "model.py", text_of("satellite-with-damper-driven", "python"))
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--config-file", "", str(path)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
