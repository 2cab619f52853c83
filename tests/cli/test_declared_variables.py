"""``mbsym simulate`` of a description with speeds: its columns, and every option that goes with coordinates only."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from conftest import SHIPPED

from mbsym_cli.main import main

SATELLITE = SHIPPED / "gravity-gradient-quaternion.yaml"


def called(*arguments: object) -> Result:
    return CliRunner().invoke(main, ["simulate", *map(str, arguments)])


def test_columns_and_words_are_those_of_the_description(tmp_path: Path) -> None:
    how = ("--time", 300, "--samples", 31, "-f", "csv,svg", "--event", "e1 = e2", "-v", "--out", tmp_path)
    result = called(SATELLITE, *how)
    assert result.exit_code == 0, result.output
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
    result = called(SATELLITE, *how)
    assert result.exit_code == 0, result.output
    header = (tmp_path / "trajectory.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert header[:4] == ["t", "psi", "theta", "phi"]
    assert {"e0", "p"} <= set(header)
    assert "coordinates and their velocities; speeds are computed from them" in result.stdout


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("--linear", ("--linear",)),
        ("--bodies", ("--bodies",)),
        ("--animate", ("--animate",)),
        ("--method", ("--method", "midpoint", "--step", "0.1")),
        ("--method", ("--method", "lsoda")),
    ],
)
def test_what_goes_with_coordinates_only_is_refused_by_name(
    option: str, words: tuple[str, ...], tmp_path: Path
) -> None:
    result = called(SATELLITE, "--time", 10, *words, "--out", tmp_path / "out")
    assert result.exit_code == 2, result.output
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
    result = called(words[0], "--time", 1, *words[1:], "--out", tmp_path / "out")
    assert result.exit_code == 2, result.output
    assert told in result.stderr
