"""``mbsym simulate --certify``: what it says, writes and refuses."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import jsonschema
import mpmath
import pytest
from click.testing import CliRunner, Result

from mbsym.report.schemas import schema
from mbsym_cli.main import main

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
)
OSCILLATOR = LINE + "loads:\n  - potential: x**2/2\ninitial: {x: 1}\n"
BLOW_UP = LINE + "loads:\n  - potential: -2*x**3\ninitial: {x: {position: 1, velocity: 2}}\n"


def simulated(folder: Path, text: str, *options: str) -> Result:
    file = folder / "one.yaml"
    file.write_text(text)
    return CliRunner().invoke(main, ["simulate", str(file), "--out", str(folder / "out"), "-f", "csv", *options])


def rows_of(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / "out" / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


def record_of(folder: Path) -> dict[str, Any]:
    record: dict[str, Any] = json.loads((folder / "out" / "simulation.json").read_text())
    jsonschema.validate(record, schema("simulation"))
    return record


def test_the_truth_is_within_the_radius_as_printed(tmp_path: Path) -> None:
    done = simulated(tmp_path, OSCILLATOR, "--time", "10", "--samples", "21", "--certify", "1e-20")
    assert done.exit_code == 0, done.output
    assert "of the exact solution at all 21 rows (proved" in done.output
    rows = rows_of(tmp_path, "enclosure.csv")
    assert len(rows) == 21
    with mpmath.workdps(40):
        for row in rows:
            t = mpmath.mpf(float(row["t"]))
            for name, exact in (("x", mpmath.cos(t)), ("x_dot", -mpmath.sin(t))):
                assert abs(mpmath.mpf(row[name]) - exact) <= mpmath.mpf(row[f"{name}_radius"])
    found = record_of(tmp_path)["certificate"]
    assert found["whole"] is True
    # The bound is one of the run as it stands in trajectory.csv.
    worst = max(abs(float(row["x"]) - math.cos(float(row["t"]))) for row in rows_of(tmp_path, "trajectory.csv"))
    assert found["quantities"]["x"]["largest_error"] >= worst - 2e-16


def test_what_cannot_be_proved_is_said(tmp_path: Path) -> None:
    """x = 1/(1 - t)^2: the run breaks down as well, near t = 1."""
    done = simulated(tmp_path, BLOW_UP, "--time", "0.999", "--certify", "1e-6")
    assert done.exit_code in (0, 3)
    done = simulated(tmp_path, BLOW_UP, "--time", "2", "--certify", "1e-6")
    assert done.exit_code == 3
    found = record_of(tmp_path)
    assert found["status"] == "partial"
    assert found["certificate"]["reached"] < 1


def test_functions_without_a_power_series_are_refused(tmp_path: Path) -> None:
    done = simulated(tmp_path, OSCILLATOR.replace("x**2/2", "abs(x)"), "--time", "10", "--certify")
    assert done.exit_code == 2
    assert "abs in the equations has no power series" in done.output or "sign in the equations" in done.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("width", ["0", "1", "1e-500", "nothing"])
def test_a_width_that_is_none(tmp_path: Path, width: str) -> None:
    done = simulated(tmp_path, OSCILLATOR, "--time", "10", f"--certify={width}")
    assert done.exit_code == 2
    assert "--certify: error[" in done.output
    assert not (tmp_path / "out").exists()
