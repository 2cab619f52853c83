"""The ledger: every saving is justified independently of what justified it, and nothing false is ever in it."""

from __future__ import annotations

import copy
import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, filed, invoked
from flint import fmpq

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.point import Rationals
from mbsym.analysis import ALL_PROBLEMS, Analysis
from mbsym.expressions.tree import Name, names
from mbsym.mechanics import factorisation
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import accelerated, programs
from mbsym.mechanics.states import rational_states
from mbsym.mechanics.variables import expressions, ring_of
from mbsym.model.loads import GeneralizedForce
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ledger import table as code
from mbsym.numerics.ledger.entry import (
    OPERATIONS,
    SECONDS,
    TERMS,
    Ledger,
    Measure,
    Saving,
)
from mbsym.numerics.ledger.table import ledger
from mbsym.numerics.ledger.work import Work
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.scenario import scenario
from mbsym.numerics.simulate import simulate
from mbsym.report.runs.ledger import ledger_lines

GENERIC = """
mbsym: 1
name: A heavy body of no special shape
parameters: {m: positive, a: real, b: real, c: real, g1: real, g2: real, g3: real,
             J11: positive, J22: positive, J33: positive, J12: real, J13: real, J23: real}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 2], angles: [x, y, z]}
    mass: m
    mass centre: [a, b, c]
    inertia about: joint
    inertia: [[J11, J12, J13], [J12, J22, J23], [J13, J23, J33]]
loads:
  - uniform gravity: {vector: [g1, g2, g3]}
values: {m: 3/2, a: 0.11, b: 0.13, c: 0.17, g1: 2.3, g2: 3.7, g3: 5.9,
         J11: 2.1, J22: 2.7, J33: 3.1, J12: 0.19, J13: 0.23, J23: 0.29}
initial: {x: {position: 0.3, velocity: 0}, y: {position: 0.4, velocity: 0}, z: {position: 0.5, velocity: 0}}
"""

#: Kinds that exist for every description with parameters, however little it allows.
ALWAYS = {"route to q''", "dead instructions", "parameters only", "values put in"}

PLANE = {
    "initial": "initial: {psi: 0, phi: 0, sigma: 0, theta: {position: -0.2, velocity: -0.2}, "
    "delta: {position: 0.4, velocity: 0.3}}\n"
}


def satellite_in_plane(psi: str = "0") -> str:
    """The satellite of the paper, starting in the plane of its orbit (but for psi)."""
    text = (SHIPPED / "satellite.yaml").read_text(encoding="utf-8")
    before, _, after = text.partition("initial:\n")
    _, _, rest = after.partition("# What the paper prints")
    return before + PLANE["initial"].replace("psi: 0", f"psi: {psi}") + "# " + rest.partition("abbreviations:")[0]


@cache
def shipped(name: str, problems: tuple[int, ...] = ALL_PROBLEMS) -> tuple[Analysis, dict[str, list[Saving]]]:
    """The analysis and the ledger of a shipped system, made once."""
    analysis = mbsym.load(SHIPPED / f"{name}.yaml", problems)
    return analysis, savings(analysis)


def savings(analysis: Analysis) -> dict[str, list[Saving]]:
    """The ledger by kind, after a run over the problems asked for."""
    for number in analysis.problems:
        analysis.stage(number)
    found: dict[str, list[Saving]] = {}
    for item in ledger(analysis, budget=120).savings:
        found.setdefault(item.kind, []).append(item)
    return found


def measure(item: Saving, start: str) -> Measure:
    return next(x for x in item.measures if x.quantity.startswith(start))


# --- nothing false ---


def test_where_nothing_can_be_saved_nothing_is_claimed() -> None:
    """A body of general shape at rest under an oblique force: all its coordinates are pushed, all parameters count."""
    assert savings(mbsym.loads(GENERIC)).keys() <= ALWAYS


@pytest.mark.parametrize("name", ["satellite", "heavy-top", "cart-pendulum", "dumbbell"])
def test_every_row_saves_something_and_says_why(name: str) -> None:
    for items in shipped(name)[1].values():
        for item in items:
            assert item.what
            assert item.why
            assert any(x.saved > 0 for x in item.measures if x.unit != SECONDS)
            assert all(x.without >= 0 and x.taken >= 0 for x in item.measures)


# --- coordinates that rest ---


def test_plane_motion_is_found_and_true_in_the_whole_system() -> None:
    analysis = mbsym.loads(satellite_in_plane(), (5,))
    (item,) = savings(analysis)["plane motion"]
    assert item.how == Certainty.PROVED
    assert set(item.what) == {"psi", "phi", "sigma"}
    assert "axis 3" in item.why
    assert (item.measures[0].without, item.measures[0].taken) == (5, 2)
    assert measure(item, "operations").saved > 0
    from mbsym.numerics.methods.interface import Setting
    from mbsym.numerics.methods.table import METHODS

    whole = Dynamics(scenario(analysis.system))
    found = simulate(whole, METHODS["dop853"], Setting(tolerance=1e-10), np.linspace(0, 5, 21))
    at = [analysis.system.coordinates.index(name) for name in item.what]
    assert np.max(np.abs(found.states[[*at, *(5 + k for k in at)]])) == 0
    moving = [k for k in range(5) if k not in at]
    assert np.min(np.ptp(found.states[moving], axis=1)) > 0.01


def test_off_the_plane_nothing_rests() -> None:
    found = savings(mbsym.loads(satellite_in_plane(psi="0.1"), (5,)))
    assert not found.keys() & {"plane motion", "coordinates that rest"}


# --- what drops out ---


def used_parameters(system: System) -> list[str]:
    occurring = {name for x in expressions((system.bodies, system.loads, system.prescribed)) for name in names(x)}
    return [name for name in system.parameter_names if name in occurring]


def moving_states(system: System) -> list[State]:
    """Three exact states with the accelerations of the equations of motion; where M is singular there are none."""
    ring = ring_of(system)
    found, moving = programs(system, ring), []
    for state in rational_states(system, ring, 6):
        try:
            moving.append(accelerated(system, state, found))
        except (SingularPoint, ZeroDivisionError):
            continue
    assert len(moving) >= 3
    return moving[:3]


def satisfied(system: System, state: State) -> bool:
    """d'Alembert's principle, exactly."""
    return all(value == 0 for value in Oracle(system, state).residuals.values())


def holds_with_another_value(system: System, name: str) -> bool:
    """Whether q'' found with one value of a parameter satisfies the equations with another."""
    return all(
        satisfied(system, State(state.numbers, {**state.values, name: state.values[name] * 7 / 5}))
        for state in moving_states(system)
    )


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("satellite", {"M2"}),
        ("clebsch", {"M", "R"}),
        ("spherical-pendulum", {"m"}),
        ("double-pendulum", set()),
        ("dumbbell", {"m1", "m2", "l"}),
    ],
)
def test_dropped_parameters_are_those_that_make_no_difference(name: str, expected: set[str]) -> None:
    analysis, found = shipped(name)
    rows = found.get("parameters that drop out", [])
    assert {parameter for item in rows for parameter in item.what} == expected
    assert all(item.how == Certainty.PROVED for item in rows)
    system = analysis.system
    assert {p for p in used_parameters(system) if holds_with_another_value(system, p)} == expected


def test_a_dropped_parameter_that_no_closed_form_proves_is_only_verified(monkeypatch: pytest.MonkeyPatch) -> None:
    analysis = mbsym.load(SHIPPED / "spherical-pendulum.yaml", (5,))
    monkeypatch.setattr(Work, "result", lambda self, stage: None)
    (item,) = savings(analysis)["parameters that drop out"]
    assert item.what == ("m",)
    assert item.how == "verified numerically"


def test_cyclic_coordinates_lower_the_order_by_two_each() -> None:
    analysis, found = shipped("heavy-top")
    (item,) = found["cyclic coordinates"]
    assert item.what == ("phi",)
    assert (item.measures[0].without, item.measures[0].taken) == (6, 4)
    assert {name for name in ("alpha", "beta", "phi") if turned_alike(analysis.system, name)} == {"phi"}


def turned_alike(system: System, name: str) -> bool:
    """Whether q'' found at one angle satisfies the equations at another."""
    for state in moving_states(system):
        numbers = copy.copy(state.numbers)
        assert isinstance(numbers, Rationals)
        numbers.basic = {**numbers.basic, name: (fmpq(5, 13), fmpq(12, 13))}
        if not satisfied(system, State(numbers, state.values)):
            return False
    return True


def test_a_driven_coordinate_is_not_cyclic() -> None:
    """Negative control: phi is absent from L, but a torque about it changes its momentum."""
    system = mbsym.load(SHIPPED / "heavy-top.yaml").system
    driven = replace(system, loads=(*system.loads, GeneralizedForce((("phi", Name("A")),))))
    analysis = Analysis(driven, (2, 3))
    assert "phi" in analysis.energy.cyclic
    assert "cyclic coordinates" not in savings(analysis)


# --- bodies and joints ---


def test_point_masses_of_the_double_pendulum_save_four_terms() -> None:
    """J3 theta1'^2/2 for the first rod, J3 (theta1' + theta2')^2/2 for the second: 1 + 3 terms."""
    (item,) = shipped("double-pendulum")[1]["point masses"]
    assert item.what == ("first rod", "second rod")
    assert measure(item, "terms of T").saved == 4


def test_a_massless_frame_and_unused_axes() -> None:
    _, found = shipped("satellite")
    assert found["massless bodies"][0].what == ("orbital frame",)
    # m R^2 omega0^2/2 is all that a mass of the orbital frame adds to T.
    assert measure(found["massless bodies"][0], "terms of T").saved == 1
    assert found["unused axes"][0].what == ("orbital frame", "rod", "point mass")
    assert found["point masses"][0].what == ("point mass",)


def test_constant_rotations_cost_nothing() -> None:
    text = GENERIC.replace(
        "rotation: {axes: [3, 1, 2], angles: [x, y, z]}", "rotation: {axes: [3, 1], angles: [x, {}]}"
    )
    text = text.partition("initial:")[0]
    for angle, constant in (("pi/6", True), ("a", True), ("y", False)):
        found = savings(mbsym.loads(text.replace("{}", angle), (2,)))
        assert ("constant rotations" in found) is constant
        if constant:
            assert measure(found["constant rotations"][0], "operations").saved > 0


# --- closed formulas ---


def test_subsystems_and_vanishing_entries_of_the_satellite() -> None:
    analysis, found = shipped("satellite")
    (item,) = found["subsystems"]
    assert item.what == ("{psi, phi, sigma}", "{theta, delta}")
    assert measure(item, "terms of det").saved > 0
    (entries,) = found["entries that vanish"]
    assert "D, N as a whole" in entries.what
    nonzero = sum(not m[i, j].is_zero for m in analysis.linearisation.matrices for i in range(5) for j in range(5))
    assert (entries.measures[0].without, entries.measures[0].taken) == (125, nonzero)


def test_coupled_coordinates_are_no_subsystems() -> None:
    assert "subsystems" not in shipped("double-pendulum")[1]


def test_outputs_nobody_asked_for_are_those_that_were_not_derived() -> None:
    analysis = mbsym.load(SHIPPED / "satellite.yaml", (5,))
    rows = savings(analysis)["outputs nobody asked for"]
    told = {int(item.what[0].split(",")[0].split()[1]) for item in rows}
    assert told == {1, 2, 3, 6, 7}  # 5 needs 4
    assert not analysis.derived & {"kinematics", "energy", "equations", "stability", "integrals"}
    (third,) = (item for item in rows if "problem 3" in item.what[0])
    whole = mbsym.load(SHIPPED / "satellite.yaml").equations
    terms = whole.mass_matrix.terms + sum(x.terms for x in whole.forcing)
    assert measure(third, "terms").without == terms
    assert "expanded while" in third.why


def test_all_problems_asked_leave_nothing_unasked() -> None:
    assert "outputs nobody asked for" not in shipped("double-pendulum")[1]


# --- programs ---


def counterfactual_solvers(path: Path) -> tuple[Any, int]:
    """M, f and both solutions at an exact state."""
    system = mbsym.load(path).system
    ring = ring_of(system)
    found = programs(system, ring)
    (state,) = rational_states(system, ring, 1)
    both = [
        factorisation.solve(found.program, found.mass_matrix, found.forcing)[0],
        code._eliminated(found.program, found.mass_matrix, found.forcing),
    ]
    nodes = [x for solution in both for x in solution]
    return found.program.evaluate(nodes, state.values, state.numbers), len(system.coordinates)


@pytest.mark.parametrize("name", ["cart-pendulum", "double-pendulum", "spatial-arm"])
def test_the_unsymmetric_counterfactual_solves_the_same_equations(name: str) -> None:
    values, n = counterfactual_solvers(SHIPPED / f"{name}.yaml")
    assert values[:n] == values[n:]


def test_sparsity_and_symmetry_of_an_arm() -> None:
    analysis = mbsym.load(SHIPPED / "spatial-arm.yaml", (3,))
    found = savings(analysis)
    closed = analysis.equations.mass_matrix
    zeros = sum(closed[i, j].is_zero for i in range(6) for j in range(6))
    assert measure(found["sparsity of M"][0], "entries").saved <= zeros
    for kind in ("sparsity of M", "symmetry of M"):
        assert measure(found[kind][0], "operations").saved > 0


def test_zero_values_take_their_terms_with_them() -> None:
    text = GENERIC.partition("initial:")[0]
    none = savings(mbsym.loads(text, (2,)))
    assert "values that are zero" not in none
    (item,) = savings(mbsym.loads(text.replace("J12: 0.19", "J12: 0"), (2,)))["values that are zero"]
    assert item.what == ("J12",)
    assert measure(item, "operations").saved > 0


def test_what_depends_on_parameters_only_is_counted_once() -> None:
    (item,) = shipped("double-pendulum")[1]["parameters only"]
    assert item.measures[0].unit == OPERATIONS
    assert item.measures[0].saved > 0


# --- gravity ---


def test_the_order_of_gravity_is_judged_by_a_number() -> None:
    """l/R of the gyrostat by hand: distance of the mass centre and radius of gyration, over the distance R."""
    analysis = mbsym.load(SHIPPED / "gyrostat.yaml", (2,))
    (item,) = savings(analysis)["order of gravity"]
    assert item.how == Certainty.ESTIMATED
    values = scenario(analysis.system).parameters
    m, moments = float(values["M"]), sum(float(values[x]) for x in "ABC")
    centre = sum(float(values[x]) ** 2 for x in ("x0", "y0", "z0"))
    # The tensor is about the fixed point: its trace holds 2 m c^2 more than that about the mass centre.
    size = sqrt(centre) + sqrt((moments - 2 * m * centre) / (2 * m))
    assert f"l/R = {size / float(values['R']):.1e}" in item.why


def test_without_numbers_the_order_of_gravity_is_undecided() -> None:
    system = mbsym.load(SHIPPED / "gyrostat.yaml").system
    bare = replace(system, parameters=tuple(replace(p, value=None) for p in system.parameters), initial=())
    (item,) = savings(Analysis(bare, (2,)))["order of gravity"]
    assert item.how == Certainty.UNDECIDED


# --- bounds ---


def test_no_counterfactual_is_begun_beyond_the_budget() -> None:
    analysis = mbsym.load(SHIPPED / "satellite.yaml", (5,))
    analysis.stage(5)
    found = ledger(analysis, budget=0.0)
    assert "point masses" in found.unmeasured
    assert "point masses" not in {item.kind for item in found.savings}


def test_a_counterfactual_beyond_the_budget_costs_more_than_what_was_spent() -> None:
    analysis = Analysis(mbsym.load(SHIPPED / "satellite.yaml").system, (2,), terms=600)
    analysis.stage(2)
    lines = {line.kind: line for line in ledger_lines(ledger(analysis, budget=60))}
    assert any("instead of more than" in text for text in lines["unused axes"].saved)


# --- the command ---


def test_the_command_tells_and_writes_the_ledger(tmp_path: Path) -> None:
    file = filed(tmp_path / "plane.yaml", satellite_in_plane())
    found = invoked("run", file, "--problems", "4,5", "--format", "json", "--ledger", "--out", tmp_path / "out", code=0)
    assert "plane motion psi, phi, sigma" in " ".join(found.output.split())
    assert "(proved)" in found.output
    content = json.loads((tmp_path / "out" / "results.json").read_text(encoding="utf-8"))
    kinds = [item["kind"] for item in content["ledger"]["savings"]]
    assert {"plane motion", "outputs nobody asked for", "parameters that drop out"} <= set(kinds)
    rows = list(csv.DictReader((tmp_path / "out" / "ledger.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["kind"] for row in rows} == set(kinds)
    assert {row["unit"] for row in rows} >= {TERMS, OPERATIONS, SECONDS}
    for row in rows:
        assert float(row["saved"]) == pytest.approx(float(row["without"]) - float(row["with"]), abs=1e-5)


def test_without_the_flag_there_is_no_ledger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*arguments: Any) -> None:
        raise AssertionError("the ledger was made although nobody asked for it")

    monkeypatch.setattr("mbsym.numerics.ledger.table.ledger", forbidden)
    found = invoked("run", SHIPPED / "double-pendulum.yaml", "--format", "json", "--out", tmp_path, code=0)
    assert "ledger" not in found.output
    assert {path.name for path in tmp_path.iterdir()} == {"results.json", ".mbsym.json"}
    assert "ledger" not in json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))


# --- mbsym simulate ---


def table(folder: Path) -> tuple[list[str], np.ndarray[Any, Any]]:
    (path,) = folder.glob("trajectory*.csv")
    header, *rows = path.read_text(encoding="utf-8").splitlines()
    return header.split(","), np.array([[float(x) for x in row.split(",")] for row in rows])


@pytest.fixture(scope="module")
def plane(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return filed(tmp_path_factory.mktemp("plane") / "plane.yaml", satellite_in_plane())


def simulated(file: Path, folder: Path, *words: Any, code: int | None = None) -> Any:
    return invoked(
        "simulate", file, "--time", 5, "--samples", 21, "--format", "csv", "-v", "--out", folder, *words, code=code
    )


@pytest.mark.parametrize("words", [(), ("--arithmetic", "extended"), ("--method", "rk4", "--step", "1e-2")])
def test_resting_coordinates_are_taken_out_and_put_back(plane: Path, tmp_path: Path, words: Sequence[str]) -> None:
    less = simulated(plane, tmp_path / "less", *words)
    whole = simulated(plane, tmp_path / "whole", "--whole", *words)
    assert less.exit_code == whole.exit_code == 0, less.output + whole.output
    assert "psi, phi, sigma (proved): 2 of 5 coordinates integrated" in less.output
    assert "rest (" not in whole.output
    names_, values = table(tmp_path / "less")
    others, truth = table(tmp_path / "whole")
    assert names_ == others
    for name in ("psi", "phi", "sigma", "psi_dot", "phi_dot", "sigma_dot"):
        assert np.all(values[:, names_.index(name)] == 0)
    kept = names_.index("relative_drift") if "relative_drift" in names_ else len(names_) - 1
    assert np.max(np.abs(np.delete(values - truth, kept, axis=1))) < 1e-7
    told = json.loads((tmp_path / "less" / "simulation.json").read_text(encoding="utf-8"))["resting"]
    assert told["coordinates"] == ["psi", "phi", "sigma"]
    assert told["operations"]["reduced"] < told["operations"]["whole"]


def test_nothing_is_taken_out_off_the_plane(tmp_path: Path) -> None:
    file = filed(tmp_path / "off.yaml", satellite_in_plane(psi="0.1"))
    found = simulated(file, tmp_path / "out", code=0)
    assert "rest (" not in found.output
    assert json.loads((tmp_path / "out" / "simulation.json").read_text(encoding="utf-8"))["resting"] is None


def test_what_is_not_proved_is_integrated(plane: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mbsym.numerics.planning import reduced as module

    proved = module.resting
    monkeypatch.setattr(
        module, "resting", lambda *given, **more: replace(proved(*given, **more), how="verified numerically")
    )
    doubtful = simulated(plane, tmp_path / "doubtful")
    monkeypatch.setattr(module, "resting", lambda *given, **more: None)
    whole = simulated(plane, tmp_path / "whole")
    assert "integrated all the same" in doubtful.output
    assert np.array_equal(table(tmp_path / "doubtful")[1], table(tmp_path / "whole")[1])
    assert whole.exit_code == 0


def test_an_early_end_tells_the_whole_state(plane: Path, tmp_path: Path) -> None:
    found = simulated(plane, tmp_path / "out", "--step-limit", 3, code=3)
    assert "psi = 0" in found.output
    assert "sigma_dot = 0" in found.output
    names_, values = table(tmp_path / "out")
    assert values.shape[1] == len(names_)


def test_a_coordinate_held_at_an_angle_keeps_it(tmp_path: Path) -> None:
    """A pendulum in the plane psi = pi/3 stays there; psi is put back as it stood, not as zero."""
    text = (SHIPPED / "spherical-pendulum.yaml").read_text(encoding="utf-8")
    file = filed(tmp_path / "p.yaml", text)
    found = simulated(file, tmp_path / "out", "--set", "psi=pi/3", "--set", "psi_dot=0", code=0)
    assert "resting psi (proved)" in " ".join(found.output.split())
    names_, values = table(tmp_path / "out")
    psi = values[:, names_.index("psi")]
    assert np.ptp(psi) == 0
    assert abs(psi[0] - np.pi / 3) < 3e-16
    assert np.ptp(values[:, names_.index("theta")]) > 0.1


# --- the package ---


def test_every_package_folder_is_listed_and_exists() -> None:
    """A folder that pyproject.toml forgets is missing after ``pip install .``."""
    import tomllib

    root = SHIPPED.parent
    settings = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    folders = {path.parent for path in (root / "mbsym").rglob("*.py")}
    expected = {".".join(path.relative_to(root).parts) for path in folders}
    assert {name for name in settings["packages"] if name.split(".")[0] == "mbsym"} == expected
    assert all((folder / "__init__.py").is_file() for folder in folders)
    assert len(settings["packages"]) == len(set(settings["packages"]))
    for name, folder in settings["package-dir"].items():
        assert name in settings["packages"]
        assert (root / folder).is_dir()


def test_seconds_are_told_only_where_they_differ_beyond_doubt() -> None:
    """Counts are exact; two timings of the same work differ by noise."""
    told = [(1, "s", 0.040, 0.037), (2, "s", 0.2, 0.02), (3, "n", 514, 515), (4, "n", 7, 7), (5, "s", 0.025, 0.043)]
    measures = tuple(
        Measure(str(number), SECONDS if unit == "s" else TERMS, without, taken) for number, unit, without, taken in told
    )
    lines = ledger_lines(Ledger((Saving("kind", ("what",), "why", Certainty.PROVED, measures),)))
    assert [text.split(":")[0] for text in lines[0].saved] == ["2", "3"]


def test_parts_that_nothing_links_are_listed() -> None:
    """Two particles that know nothing of each other, and the same two with a spring between them."""
    text = (
        "mbsym: 1\nname: two\nbodies:\n"
        "  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
        "  - {name: b, attached to: 0, connection point: [0, y, 0], mass: 1, coordinates: [y]}\n"
        "loads:\n  - potential: x**2/2 + y**2/2\ninitial: {x: 1, y: 1}\n"
    )
    found = [saving for saving in ledger(mbsym.loads(text)).savings if saving.kind == Kind.PARTS]
    assert [saving.what for saving in found] == [("x", "y")]
    assert found[0].how == Certainty.PROVED
    assert [(item.without, item.taken) for item in found[0].measures] == [(2, 1), (16, 8)]
    linked = text.replace("y**2/2", "y**2/2 + x*y/2")
    assert not [saving for saving in ledger(mbsym.loads(linked)).savings if saving.kind == Kind.PARTS]
