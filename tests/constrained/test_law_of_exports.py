"""The law of constrained motion in every export: accelerations are those of d'Alembert's principle with all rows.

At random states of mechanisms whose rows follow from others (bars, axles of many wheels, balls on surfaces, random
trees closed by redundant loops), where any fixed choice of rows may fail: Python, C, CasADi, JAX, FMU.
"""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.report.code import c_source
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.exports import fmu
from mbsym.report.targets import FORMATS
from tests.constrained.test_redundant_rows import begun, by_all_rows, case, parallelogram
from tests.random_systems import closed_tree, coupled, mechanism

#: (t, x) -> q''.
Rates = Callable[[Any], Any]

#: Random ones by their seeds, of which it is known that a run may begin in them and something moves.
SYSTEMS = {
    "bars": parallelogram(0)[0],
    "bars and a pendulum": parallelogram(3)[0],
    "axle": case("four-wheels-on-an-axle"),
    "ball": case("ball-in-a-cylinder"),
    "sarrus": case("sarrus-linkage"),
    **{f"random {seed}": closed_tree(Random(f"mechanism {seed}")) for seed in (1, 6, 11, 19)},
    **{f"{kind} {seed}": mechanism(kind, seed) for kind in ("axle", "ball", "coupled") for seed in (0, 1)},
    "pins in line": coupled(Random("coupled 1"), "relation", Fraction(0)),
}


@dataclass(frozen=True)
class Mechanism:
    """A description with its states and their accelerations by all rows."""

    analysis: Any
    states: list[tuple[Any, Any]]

    def rendered(self, kind: str) -> str:
        text = FORMATS[kind].render(self.analysis, ())
        assert isinstance(text, str)
        return text

    def loaded(self, kind: str) -> dict[str, Any]:
        found: dict[str, Any] = {}
        exec(compile(self.rendered(kind), kind, "exec"), found)
        return found

    @property
    def values(self) -> Any:
        model = self.loaded("python")
        return np.array(list(model["complete"]().values()))


@cache
def mechanism_of(name: str) -> Mechanism:
    text = SYSTEMS[name]
    return Mechanism(mbsym.loads(text, (3,)), [*by_all_rows(Dynamics(begun(text)), np.random.default_rng(4))])


def python(found: Mechanism, folder: Path) -> Rates:
    model = found.loaded("python")
    values = model["complete"]()
    return lambda x: model["rhs"](0.0, x, values)[len(x) // 2 :]


def c(found: Mechanism, folder: Path) -> Rates:
    (folder / "model.c").write_text(found.rendered("c"), encoding="utf-8")
    (folder / "model.h").write_text(c_source.header(found.analysis, ()), encoding="utf-8")
    library = folder / "model.so"
    subprocess.run(["cc", "-std=c99", "-O0", "-shared", "-fPIC", "-o", library, folder / "model.c", "-lm"], check=True)
    function = getattr(ctypes.CDLL(str(library)), f"{prefix_of(found.analysis.system.name)}_right_hand_side")
    values = found.values

    def rates(x: Any) -> Any:
        out = (ctypes.c_double * len(x))()
        given, numbers = ((ctypes.c_double * max(1, len(y)))(*y) for y in (x, values))
        assert function(ctypes.c_double(0), given, numbers, out) == 0
        return np.array(out)[len(x) // 2 :]

    return rates


def casadi(found: Mechanism, folder: Path) -> Rates:
    pytest.importorskip("casadi")
    accelerations, values = found.loaded("casadi")["functions"]()["accelerations"], found.values
    return lambda x: np.array(accelerations(0.0, list(x), list(values))).ravel()


def jax(found: Mechanism, folder: Path) -> Rates:
    pytest.importorskip("jax").config.update("jax_enable_x64", True)
    accelerations, values = found.loaded("jax")["accelerations"], found.values
    return lambda x: np.array(accelerations(0.0, x, values))


def functional_unit(found: Mechanism, folder: Path) -> Rates:
    """Derivatives of the continuous states, by their names."""
    fmpy = pytest.importorskip("fmpy")
    from fmpy.fmi2 import FMU2Model

    path = folder / "model.fmu"
    path.write_bytes(fmu.render(found.analysis, (), 2))
    told, place = fmpy.read_model_description(str(path)), fmpy.extract(str(path), unzipdir=str(folder / "unit"))
    one = FMU2Model(
        guid=told.guid, unzipDirectory=place, modelIdentifier=told.modelExchange.modelIdentifier, instanceName="one"
    )
    one.instantiate()
    one.setupExperiment(startTime=0.0)
    one.enterInitializationMode()
    one.exitInitializationMode()
    one.enterContinuousTimeMode()
    system = found.analysis.system
    wanted = [*system.coordinates, *system.velocities]
    names = [x.variable.derivative.name for x in told.derivatives]

    def rates(x: Any) -> Any:
        state = dict(zip(wanted, x, strict=True))
        given, out = ((ctypes.c_double * len(x))(*(state[name] for name in names)) for _ in range(2))
        one.setContinuousStates(given, len(x))
        one.getDerivatives(out, len(x))
        by_name = dict(zip(names, out, strict=True))
        return np.array([by_name[name] for name in system.velocities])

    return rates


@pytest.mark.parametrize("export", [python, c, casadi, jax, functional_unit], ids=lambda one: one.__name__)
@pytest.mark.parametrize("name", SYSTEMS)
def test_accelerations_are_those_of_all_rows(name: str, export: Any, tmp_path: Path) -> None:
    found = mechanism_of(name)
    rates = export(found, tmp_path)
    assert found.states
    for state, wanted in found.states:
        assert rates(state) == pytest.approx(wanted, abs=1e-6 * (1 + np.max(np.abs(wanted))))
