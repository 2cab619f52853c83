"""Code of constrained systems, run in its own languages: against d'Alembert's principle with multipliers at states, and
against mbsym's simulation."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, ball, precision
from mutants import corrupted
from scipy.integrate import solve_ivp
from test_exports import differences, module, translated
from truth_at_states import BITS, Point, _Truth

import mbsym
from mbsym.algebra.point import Balls
from mbsym.analysis import Analysis
from mbsym.mechanics.constraints.oracle import oracle_rows
from mbsym.mechanics.oracle import State
from mbsym.model.system import acceleration_name
from mbsym.report.code import c_source
from mbsym.report.code.constrained_code import tied_of
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.exports import fmu
from mbsym.report.exports.modelica import proposed
from mbsym.report.targets import FORMATS
from tests.report.readers import unreadable

COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler")

#: The shipped four-bar with a motor at the crank; the reaction in one of its joints is asked for.
DRIVEN = """
inputs:
  drive: {meaning: torque at the crank}
loads:
  - generalized force: {q1: drive*cos(q1)}
reactions: [rocker]
constraints:"""
#: Name -> the input's value.
SYSTEMS: dict[str, tuple[float, ...]] = {"four-bar": (), "chaplygin-sleigh": (), "driven": (7.0,)}


@cache
def analysis_of(name: str) -> Analysis:
    if name == "driven":
        text = (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8")
        return mbsym.loads(text.replace("\nconstraints:", DRIVEN, 1), (3, 7))
    return mbsym.load(SHIPPED / f"{name}.yaml", (3, 7))


@cache
def point_of(name: str) -> Point:
    """The description's values, at a state beside the constraints."""
    analysis = analysis_of(name)
    n = len(analysis.system.coordinates)
    model: dict[str, Any] = {}
    exec(text_of(name, "python"), model)
    found = list(model["complete"]().values())
    state = np.random.default_rng(4).uniform(0.3, 1.2, 2 * n)
    return Point(0.25, tuple(state), tuple(found))


class _Tied(_Truth):
    def values(self, x: Any) -> dict[str, Any]:
        inputs = zip(self.system.input_names, SYSTEMS[self.name], strict=True)
        return super().values(x) | {key: ball(value) for key, value in inputs}

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(analysis_of(name), point_of(name))


@cache
def expected(name: str) -> dict[str, Any]:
    """M, f by d'Alembert's principle, rows from places in inertial axes, (q'', lambda) of these by elimination."""
    with precision(BITS):
        truth = _Tied(name)
        x = [ball(value) for value in truth.point.x]
        mass, force = truth.dynamics(x)
        still = truth.values(x) | {acceleration_name(q): ball(0) for q in truth.system.coordinates}
        groups = oracle_rows(truth.system, State(Balls(still), still))
    n, tied = truth.n, tied_of(analysis_of(name))
    assert not isinstance(tied, str)
    rows = [groups[k][max(component - 1, 0)] for k, component in tied.kept]
    found = {
        "mass_matrix": np.array([float(v) for v in mass.entries()]).reshape(n, n),
        "forcing": np.array([float(v) for v in force.entries()]),
        "constraint_jacobian": np.array([[float(v) for v in row.partials] for row in rows]),
        "constraint_velocity": np.array([float(row.velocity) for row in rows]),
        "constraint_acceleration": np.array([float(row.acceleration) for row in rows]),
    }
    if tied.positions:
        found["constraints"] = np.array([float(row.position) for row in rows[: tied.positions]])
    jacobian, m = found["constraint_jacobian"], len(rows)
    whole = np.block([[found["mass_matrix"], -jacobian.T], [jacobian, np.zeros((m, m))]])
    solution = np.linalg.solve(whole, np.concatenate([found["forcing"], -found["constraint_acceleration"]]))
    return found | {"accelerations": solution[:n], "multipliers": solution[n:]} | _reactions(name, solution)


def _reactions(name: str, solution: Any) -> dict[str, Any]:
    """From the closed formulas of problem 3, whose second route releases the joint."""
    analysis = analysis_of(name)
    if not analysis.system.reactions:
        return {}
    assert [check.failed for check in analysis.checks if check.name == "reactions"] == [False]
    truth, n = _Tied(name), len(analysis.system.coordinates)
    values = truth.values([ball(x) for x in truth.point.x])
    names = map(acceleration_name, analysis.system.coordinates)
    values |= {key: ball(float(x)) for key, x in zip(names, solution[:n], strict=True)}

    def number(x: Any) -> float:
        return float(analysis.ring.evaluate(x.polynomial, values))

    (one,) = analysis.reactions
    total = np.array([number(x) for x in (*one.force, *one.moment)])
    for weight, (force, moment) in zip(solution[n:], one.per_multiplier, strict=True):
        total += weight * np.array([number(x) for x in (*force, *moment)])
    return {"reactions": total[np.newaxis]}


@cache
def run_of(name: str) -> Any:
    """(x(0), x(1)) of mbsym's own simulation, inputs held at zero."""
    run = mbsym.simulate(analysis_of(name), 1, tolerance=1e-11)
    names = [*analysis_of(name).system.coordinates, *analysis_of(name).system.velocities]
    return np.array([run[key][0] for key in names]), np.array([run[key][-1] for key in names])


def moved(name: str, rhs: Callable[[float, Any], Any], start: Any) -> None:
    """A run with the exported right-hand side ends where mbsym's does."""
    first, last = run_of(name)
    assert np.allclose(start, first, atol=1e-9)
    done = solve_ivp(rhs, (0.0, 1.0), start, method="DOP853", rtol=1e-10, atol=1e-12)
    assert done.y[:, -1] == pytest.approx(last, abs=1e-7)


@cache
def text_of(name: str, kind: str) -> str:
    text = FORMATS[kind].render(analysis_of(name), (7,))
    assert isinstance(text, str)
    return text


@pytest.mark.parametrize("name", SYSTEMS)
def test_python(name: str, tmp_path: Path) -> None:
    model, at, u = module(text_of(name, "python"), tmp_path), point_of(name), SYSTEMS[name]
    p, x = dict(zip(model.PARAMETERS, at.p, strict=True)), np.array(at.x)
    n = len(x) // 2
    q, qd = x[:n], x[n:]
    driven = (list(u),) if u else ()
    found = {
        "mass_matrix": model.mass_matrix(q, p, at.t), "forcing": model.forcing(q, qd, p, at.t, *driven),
        "constraint_jacobian": model.constraint_jacobian(q, p, at.t),
        "constraint_velocity": model.constraint_velocity(q, qd, p, at.t),
        "constraint_acceleration": model.constraint_acceleration(q, qd, p, at.t),
        "constraints": model.constraints(q, p, at.t),
        "accelerations": model.rhs(at.t, x, p, *driven)[n:], "multipliers": model.multipliers(at.t, x, p, *driven),
    }  # fmt: skip
    if name == "driven":
        found["reactions"] = model.reactions(at.t, x, p, *driven)
        assert model.REACTIONS == ("rocker",)
    assert differences(found, expected(name)) == []
    changes = np.eye(2 * n) * 1e-6
    slopes = [(model.rhs(at.t, x + d, p, *driven) - model.rhs(at.t, x - d, p, *driven)) / 2e-6 for d in changes]
    size = np.max(np.abs(slopes))
    assert model.jacobian(at.t, x, p, *driven) == pytest.approx(np.array(slopes).T, abs=1e-6 * size)
    start = model.consistent(model.initial_state(p), p, held=model.GIVEN)
    moved(name, lambda t, x: model.rhs(t, x, p, *((0.0,),) if u else ()), start)


@needs_compiler
@pytest.mark.parametrize("name", SYSTEMS)
def test_c(name: str, tmp_path: Path) -> None:
    analysis, at, u = analysis_of(name), point_of(name), SYSTEMS[name]
    (tmp_path / "model.c").write_text(text_of(name, "c"), encoding="utf-8")
    (tmp_path / "model.h").write_text(c_source.header(analysis, ()), encoding="utf-8")
    options = ["-std=c99", "-O1", "-Wall", "-Wextra", "-pedantic", "-Werror", "-shared", "-fPIC"]
    library = tmp_path / "model.so"
    subprocess.run([str(COMPILER), *options, "-o", library, tmp_path / "model.c", "-lm"], check=True)
    functions, prefix = ctypes.CDLL(str(library)), prefix_of(analysis.system.name)
    n, wanted = len(analysis.system.coordinates), expected(name)
    p, given = array(at.p), (array(u),) if u else ()

    def call(key: str, x: Any, *arguments: str) -> tuple[int, Any]:
        values = {"q": array(x[:n]), "qd": array(x[n:]), "x": array(x), "p": p}
        out = (ctypes.c_double * int(np.size(wanted.get(key, x))))()
        driven = given if key in ("forcing", "accelerations", "multipliers", "right_hand_side", "reactions") else ()
        passed = [values[one] for one in arguments]
        told = getattr(functions, f"{prefix}_{key}")(ctypes.c_double(at.t), *passed, *driven, out)
        return told, np.array(out).reshape(np.shape(wanted.get(key, x)))

    of_q = ("mass_matrix", "constraints", "constraint_jacobian")
    found = {}
    for key in wanted:
        told, found[key] = call(key, at.x, *(("q", "p") if key in of_q else ("q", "qd", "p")))
        assert told == 0 or key in ("mass_matrix", "forcing", *[k for k in wanted if k.startswith("constraint")])
    assert differences(found, wanted) == []
    start = array(mbsym_start(name))
    flags = (ctypes.c_int * (2 * n)).in_dll(functions, f"{prefix}_given")
    assert getattr(functions, f"{prefix}_consistent")(ctypes.c_double(0), start, p, flags) == 0
    given = (array([0.0]),) if u else ()
    moved(name, lambda t, x: call("right_hand_side", x, "x", "p")[1], np.array(start))
    lost = array([np.nan] * len(at.x))
    assert getattr(functions, f"{prefix}_consistent")(ctypes.c_double(0), lost, p, None) == 1


def array(values: Any) -> Any:
    return (ctypes.c_double * max(len(values), 1))(*values)


def mbsym_start(name: str) -> list[float]:
    """What the description gives; velocities left out are zero."""
    model: dict[str, Any] = {}
    exec(text_of(name, "python"), model)
    return list(model["initial_state"](model["complete"]()))


@needs_compiler
def test_c_names_singular_positions_and_what_does_not_close(tmp_path: Path) -> None:
    """Four-bar: all links in line; a ground longer than all links together."""
    analysis = analysis_of("four-bar")
    (tmp_path / "model.c").write_text(text_of("four-bar", "c"), encoding="utf-8")
    (tmp_path / "model.h").write_text(c_source.header(analysis, ()), encoding="utf-8")
    library = tmp_path / "model.so"
    subprocess.run(
        [str(COMPILER), "-std=c99", "-shared", "-fPIC", "-o", library, tmp_path / "model.c", "-lm"], check=True
    )
    functions, out = ctypes.CDLL(str(library)), (ctypes.c_double * 6)()
    p = array([0.5, 0.2, 0.1, 0.2, 1.0])
    straight = array([np.pi, 0, 0, 0, 0, 0])
    assert functions.four_bar_linkage_right_hand_side(ctypes.c_double(0), straight, p, out) == 2
    assert np.all(np.isfinite(out))
    before = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0]
    start = array(before)
    assert functions.four_bar_linkage_consistent(ctypes.c_double(0), start, array([9.0, *p[1:]]), None) in (2, 3)
    assert list(start) == before


@pytest.mark.parametrize("name", SYSTEMS)
def test_casadi(name: str, tmp_path: Path) -> None:
    pytest.importorskip("casadi")
    model, at, u = module(text_of(name, "casadi"), tmp_path), point_of(name), SYSTEMS[name]
    functions = model.functions()
    driven = (list(u),) if u else ()
    found = {key: np.array(functions[key](at.t, list(at.x), list(at.p), *driven)) for key in expected(name)}
    assert differences(found, expected(name)) == []
    n, still = len(at.x) // 2, ([0.0],) if u else ()
    led = np.array(model.consistent(at.t, list(at.x), list(at.p), *driven), float).ravel()
    for key in ("constraints", "constraint_velocity"):
        if key in functions:
            assert np.array(functions[key](at.t, led, list(at.p), *driven)).ravel() == pytest.approx(0, abs=1e-13)
    rhs = functions["right_hand_side"]
    moved(name, lambda t, x: np.array(rhs(t, x, list(at.p), *still)).ravel(), run_of(name)[0])
    assert n == functions["accelerations"](0, led, list(at.p), *driven).numel()


@pytest.mark.parametrize("name", ["driven"])
def test_jax(name: str, tmp_path: Path) -> None:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    model, at, u = module(text_of(name, "jax"), tmp_path), point_of(name), SYSTEMS[name]
    x, p, driven = np.array(at.x), np.array(at.p), (np.array(u),) if u else ()
    found = {key: np.array(getattr(model, key)(at.t, x, p, *driven)) for key in expected(name)}
    assert differences(found, expected(name)) == []
    led = model.consistent(at.t, x, p, *driven)
    assert np.array(model.constraints(at.t, led, p, *driven)) == pytest.approx(0, abs=1e-13)
    rhs, still = jax.jit(model.right_hand_side), (np.zeros(1),) if u else ()
    moved(name, lambda t, x: np.array(rhs(t, x, p, *still)), run_of(name)[0])


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="no Octave")
def test_octave(tmp_path: Path) -> None:
    name = "driven"
    (tmp_path / "model.m").write_text(text_of(name, "octave"), encoding="utf-8")
    at, keys, first = point_of(name), list(expected(name)), [float(x) for x in run_of(name)[0]]
    lines = [f"m = model(); p = {list(at.p)}'; x = {[float(v) for v in at.x]}'; u = {list(SYSTEMS[name])};"]
    lines += [f"printf('%.17g ', m.{key}({at.t!r}, x, p, u)'); printf('\\n');" for key in keys]
    lines += [
        "led = m.consistent(0, x, p, u); printf('%.17g ', m.constraints(0, led, p, u)); printf('\\n');",
        "o = odeset('RelTol', 1e-9, 'AbsTol', 1e-11); rhs = @(t, x) m.right_hand_side(t, x, p, 0);",
        f"[~, x] = ode45(rhs, [0 1], {first}', o);",
        "printf('%.17g ', x(end, :));",
    ]
    done = subprocess.run(
        ["octave-cli", "--no-gui", "--norc", "--eval", " ".join(lines)], cwd=tmp_path, capture_output=True, text=True
    )
    rows = [np.array(line.split(), float) for line in done.stdout.split("\n")]
    found = {key: row.reshape(np.shape(expected(name)[key])) for key, row in zip(keys, rows, strict=False)}
    assert differences(found, expected(name)) == [], done.stderr
    assert rows[len(keys)] == pytest.approx([0, 0], abs=1e-13)
    assert rows[len(keys) + 1] == pytest.approx(run_of(name)[1], abs=1e-6)


def test_julia() -> None:
    """Its functions, translated line by line."""
    name = "four-bar"
    functions, at = translated(text_of(name, "julia")), point_of(name)
    found = {key: np.array(functions[key](at.t, np.array(at.x), np.array(at.p))) for key in expected(name)}
    assert differences(found, expected(name)) == []


@pytest.mark.parametrize("name", ["four-bar", "chaplygin-sleigh"])
def test_modelica(name: str, tmp_path: Path) -> None:
    """The equations as the parser of pymoca reads them, solved by putting right sides in place of left ones."""
    pytest.importorskip("pymoca")
    pytest.importorskip("casadi")
    from test_exports import by_modelica_at

    text, at, system = text_of(name, "modelica"), point_of(name), analysis_of(name).system
    values = by_modelica_at(text, tmp_path, [proposed(key) for key in system.parameter_names], at)
    wanted = expected(name)
    slopes = [values[f"der({proposed(rate)})"] for rate in system.velocities]
    assert slopes == pytest.approx(wanted["accelerations"], rel=1e-11)
    for stem, key in (("multiplier", "multipliers"), ("constraint_velocity", "constraint_velocity")):
        assert [values[f"{stem}_{k + 1}"] for k in range(len(wanted[key]))] == pytest.approx(wanted[key], rel=1e-11)
    initial = text.partition("initial equation\n")[2].partition("\nequation\n")[0]
    loose = len(re.findall(r"fixed = false", text))
    assert len(initial.split("\n")) == loose == {"four-bar": 4, "chaplygin-sleigh": 1}[name]


@needs_compiler
@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_is_led_back_to_its_constraints(version: int, tmp_path: Path) -> None:
    """With a coarse tolerance the drift is taken back in event mode; with a fine one it ends where mbsym does."""
    fmpy = pytest.importorskip("fmpy")
    from fmpy.validation import validate_fmu

    path, names = tmp_path / "model.fmu", ["q1", "q2", "q3", "q1_dot", "q2_dot", "q3_dot"]
    path.write_bytes(fmu.render(analysis_of("driven"), (), version))
    assert validate_fmu(str(path)) == []
    model: dict[str, Any] = {}
    exec(text_of("driven", "python"), model)
    for tolerance, bound in ((1e-4, 2e-2), (1e-10, 1e-6)):
        run = fmpy.simulate_fmu(
            str(path), stop_time=1, solver="CVode", relative_tolerance=tolerance, output=names, output_interval=0.1
        )
        end = [run[key][-1] for key in names]
        assert end == pytest.approx(run_of("driven")[1], abs=bound)
        assert max(model["constraint_error"](1.0, end, model["complete"]())) < 2e-6


@pytest.mark.parametrize("seed", range(3))
def test_a_corrupted_file_is_found(seed: int, tmp_path: Path) -> None:
    pytest.importorskip("casadi")
    at, text = point_of("four-bar"), text_of("four-bar", "casadi")
    code, mark, rest = text.partition("def energy")
    changed = corrupted(code.partition("def mass_matrix")[2], Random(f"tied {seed}"))
    broken = code.partition("def mass_matrix")[0] + "def mass_matrix" + changed + mark + rest
    assert broken != text
    try:
        functions = module(broken, tmp_path).functions()
    except (NameError, TypeError, ValueError):
        return  # Python refuses it
    found = {key: np.array(functions[key](at.t, list(at.x), list(at.p))) for key in expected("four-bar")}
    assert differences(found, expected("four-bar"))
    lost = {**expected("four-bar"), "multipliers": -expected("four-bar")["multipliers"]}
    assert differences(lost, expected("four-bar")) == ["multipliers"]


def test_reactions_in_the_wolfram_language() -> None:
    """Force and moment of the joint asked for, and the same for each of the two multipliers."""
    text = FORMATS["wolfram"].render(analysis_of("driven"), (3,))
    assert isinstance(text, str)
    assert not unreadable("report.wl", text)
    assert unreadable("report.wl", text.replace('reaction["rocker"] = {{', 'reaction["rocker"] = {'))
    (one,) = analysis_of("driven").reactions
    _, mark, rest = text.partition('reactionPerMultiplier["rocker"] = {\n')
    assert mark
    rows = rest.partition("\n  };")[0].split("\n")
    assert len(rows) == len(one.per_multiplier) == 2
    for row, (force, moment) in zip(rows, one.per_multiplier, strict=True):
        parts = (", ".join(x.wolfram() for x in part) for part in (force, moment))
        assert row.strip().rstrip(",") == "{{" + "}, {".join(parts) + "}}"
