"""``mbsym simulate`` of a description with speeds: its columns, and every option that goes with coordinates only."""

from __future__ import annotations

import csv
import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from conftest import SHIPPED, invoked, reference

SATELLITE = SHIPPED / "gravity-gradient-quaternion.yaml"


def called(*arguments: object, code: int | None = None) -> Result:
    return invoked("simulate", *arguments, code=code)


def test_columns_and_words_are_those_of_the_description(tmp_path: Path) -> None:
    how = ("--time", 300, "--samples", 31, "-f", "csv,svg", "--event", "e1 = e2", "-v", "--out", tmp_path)
    result = called(SATELLITE, *how, code=0)
    with (tmp_path / "trajectory.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:8] == ["t", "e0", "e1", "e2", "e3", "p", "q", "r"]
    assert max(float(row["e_drift"]) for row in rows) < 1e-14
    assert all(abs(sum(float(row[f"e{k}"]) ** 2 for k in range(4)) - 1) < 1e-14 for row in rows)
    told = json.loads((tmp_path / "simulation.json").read_text(encoding="utf-8"))
    assert told["variables"]["positions"] == ["e0", "e1", "e2", "e3"]
    assert list(told["initial"]) == ["e0", "e1", "e2", "e3", "p", "q", "r"]
    assert "e0, e1, e2, e3; p, q, r, as declared" in result.stdout
    assert "norms of quaternions are restored" in result.stdout
    assert (tmp_path / "histories.svg").exists()
    assert (tmp_path / "motion.svg").exists()


def test_coordinates_are_integrated_where_they_are_asked_for(tmp_path: Path) -> None:
    how = ("--variables", "coordinates", "--time", 300, "--samples", 31, "-f", "csv", "-v", "--out", tmp_path)
    result = called(SATELLITE, *how, code=0)
    header = (tmp_path / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert header[:4] == ["t", "psi", "theta", "phi"]
    assert {"e0", "p"} <= set(header)
    assert "coordinates and their velocities; speeds are computed from them" in result.stdout


@pytest.mark.parametrize("model", [("--gravity", "3"), ("--gravity", "exact")])
def test_a_model_is_the_same_in_both_kinds_of_variables(model: tuple[str, str], tmp_path: Path) -> None:
    """The quaternion's columns of a run in angles: computed from these, by the same field of gravity."""
    rows = []
    for kind in ("declared", "coordinates"):
        where = tmp_path / kind
        how = ("--variables", kind, "--time", 300, "--samples", 4, "-f", "csv", "--tolerance", 1e-12, *model)
        called(SATELLITE, *how, "--out", where, code=0)
        rows.append(list(csv.DictReader((where / "trajectory.csv").read_text(encoding="utf-8").splitlines()))[-1])
    for name in ("e0", "e1", "e2", "e3", "p", "q", "r"):
        assert float(rows[0][name]) == pytest.approx(float(rows[1][name]), abs=1e-8)


@pytest.mark.parametrize(
    ("words", "table"),
    [
        (("--accuracy", "1e-6"), "trajectory.csv"),
        (("--sensitivity", "A"), "sensitivity.csv"),
        (("--vary", "theta=0.05:0.06:2"), "ensemble.csv"),
        (("--certify", "1e-6"), "enclosure.csv"),
        (("--linear",), "trajectory.csv"),
    ],
)
def test_what_knows_declared_variables_speaks_them(words: tuple[str, ...], table: str, tmp_path: Path) -> None:
    called(SATELLITE, "--time", 10, "--samples", 11, "-f", "csv", *words, "--out", tmp_path, code=0)
    head = (tmp_path / table).read_text(encoding="utf-8").splitlines()[0]
    assert "e0" in head
    assert "psi" not in head


def test_with_another_speed_the_other_speeds_stay(tmp_path: Path) -> None:
    """The initial velocities are those of angles: other speeds keep what they are by these."""
    words = ("--time", 10, "--samples", 2, "-f", "csv", "--out")
    called(SATELLITE, *words, tmp_path / "one", code=0)
    called(SATELLITE, *words, tmp_path / "many", "--vary", "p=0.01:0.02:3", code=0)
    called(SATELLITE, *words, tmp_path / "slopes", "--sensitivity", "p", code=0)

    def first(file: Path) -> dict[str, float]:
        with file.open(encoding="utf-8") as lines:
            return {name: float(x) for name, x in next(csv.DictReader(lines)).items()}

    usual, member = first(tmp_path / "one" / "trajectory.csv"), first(tmp_path / "many" / "ensemble.csv")
    slopes = first(tmp_path / "slopes" / "sensitivity.csv")
    for name in ("q", "r", "e0", "e1", "e2", "e3"):
        assert member[f"{name}_mean"] == pytest.approx(usual[name], abs=1e-15)
        assert slopes[f"d {name}/d p(0)"] == pytest.approx(0, abs=1e-12)
    assert member["p_mean"] == pytest.approx(0.015)
    assert slopes["d p/d p(0)"] == pytest.approx(1)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("--method", ("--method", "midpoint", "--step", "0.1")),
        ("--method", ("--method", "lsoda")),
    ],
)
def test_what_goes_with_coordinates_only_is_refused_by_name(
    option: str, words: tuple[str, ...], tmp_path: Path
) -> None:
    result = called(SATELLITE, "--time", 10, *words, "--out", tmp_path / "out", code=2)
    assert f"{option}: error[" in result.stderr
    assert "this system has speeds" in result.stderr or "at their lengths" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((SATELLITE, "--variables", "angles"), "--variables: error["),
        ((SATELLITE, "--event", "psi = 0"), "--event"),
        ((SHIPPED / "simple-pendulum.yaml", "--variables", "declared"), "the description declares no speeds"),
    ],
)
def test_what_cannot_be_meant_is_complained_about(words: tuple[object, ...], told: str, tmp_path: Path) -> None:
    result = called(words[0], "--time", 1, *words[1:], "--out", tmp_path / "out", code=2)
    assert told in result.stderr


def test_a_few_motions_of_a_grid_are_drawn_beside_each_other(tmp_path: Path) -> None:
    """Table 1 of Amer, Amer & Galal with lx = 30, 60, 90: the first at t = 1/2 against 30 digits."""
    truth = reference("gyrostat")["paper_P1_spin_only"]
    a, b = truth["parameters"]["A"], truth["parameters"]["B"]
    text = (SHIPPED / "gyrostat-fast.yaml").read_text(encoding="utf-8").partition("# The symbols")[0]
    text = text.replace("inertia: [A, B, C]", "inertia: {tensor: [A, B, C], accept: true}").replace("200", "5")
    values = f"R: 1000, g: 9.81, M: 300, A: {a}, B: {b}, C: 11, x0: 0.7, y0: 0.3, z0: 0.1, lx: 30, lz: 30"
    text = re.sub("^values: .*$", f"values: {{{values}}}", text, flags=re.MULTILINE)
    (tmp_path / "table-1.yaml").write_text(text.replace("atan(4/3)", "atan(sqrt(1 - 1/10**6)*1000)"), encoding="utf-8")
    words = ("--time", "1/2", "--samples", 51, "--vary", "lx=30:90:3", "-f", "csv,svg", "--out", tmp_path / "out")
    called(tmp_path / "table-1.yaml", *words, code=0)
    pictures = (tmp_path / "out" / "phase-planes-2.svg").read_text(encoding="utf-8")
    assert all(f"$l_{{x}}$ = {value} -->" in pictures for value in (30, 60, 90))
    with (tmp_path / "out" / "members.csv").open(encoding="utf-8") as file:
        (last, _, _) = csv.DictReader(file)
    (row,) = [one for one in truth["rows"] if Fraction(one["t"]) == Fraction(1, 2)]
    ours = {"p": "p", "q": "q", "r": "r", "gamma": "gamma1", "gammap": "gamma2", "gammapp": "gamma3"}
    wanted = {name: float(row[key]) for key, name in ours.items()}
    assert max(abs(float(last[f"{name}_final"]) - value) for name, value in wanted.items()) < 1e-8


@pytest.mark.parametrize("name", ["gravity-gradient-quaternion", "euler-poisson", "rolling-disc-speeds"])
def test_bodies_do_the_same_in_declared_variables(name: str, tmp_path: Path) -> None:
    """Places, velocities, accelerations, angular velocities, energies; of the disc under constraints."""
    tables = []
    for variables in ("declared", "coordinates"):
        words = ("--time", 1, "--samples", 6, "--no-estimate", "-f", "csv", "--bodies", "--variables", variables)
        called(SHIPPED / f"{name}.yaml", *words, "--out", tmp_path / variables, code=0)
        with (tmp_path / variables / "bodies.csv").open(encoding="utf-8") as lines:
            tables.append(list(csv.reader(lines)))
    assert tables[0][0] == tables[1][0]
    own, other = (np.array(rows[1:], dtype=float) for rows in tables)
    assert own == pytest.approx(other, rel=1e-8, abs=1e-8 * np.abs(other).max())


@pytest.mark.parametrize("name", ["gravity-gradient-quaternion", "rolling-disc-speeds"])
def test_a_run_in_declared_variables_goes_on(name: str, tmp_path: Path) -> None:
    """Two parts are one run, to its tolerance."""
    usual = (SHIPPED / f"{name}.yaml", "--no-estimate", "-f", "csv", "--every", "0.1", "--out")
    called(*usual, tmp_path / "first", "--time", 1, code=0)
    on = ("--continue", tmp_path / "first" / "simulation.json")
    called(usual[0], "--no-estimate", "-f", "csv", "--time", 2, *on, "--out", tmp_path / "on", code=0)
    called(*usual, tmp_path / "whole", "--time", 2, code=0)
    tables = [np.genfromtxt(tmp_path / part / "trajectory.csv", delimiter=",", names=True) for part in ("on", "whole")]
    assert tables[0].dtype.names == tables[1].dtype.names
    assert len(tables[0]) == 21
    for column in tables[0].dtype.names:
        if "drift" not in column:
            assert tables[0][column] == pytest.approx(tables[1][column], rel=1e-8, abs=1e-9)
    changed = called(usual[0], "--time", 3, "--continue", tmp_path / "on" / "simulation.json", "--set", "m=7", code=2)
    assert "that run had other values: m was " in " ".join(changed.stderr.split())
    there = called(usual[0], "--time", 3, *on, "--variables", "coordinates", "--out", tmp_path / "no", code=2)
    assert "its last state is not that of these coordinates" in " ".join(there.stderr.split())
