"""``mbsym simulate --certify``: what it says, writes and refuses."""

from __future__ import annotations

import csv
import json
import math
import time
from pathlib import Path
from typing import Any

import jsonschema
import mpmath
import pytest
from click.testing import Result
from conftest import filed, invoked

from mbsym.expressions.message import duration
from mbsym.numerics.enclosure.enclose import OUT_OF_TIME, Enclosure
from mbsym.report.schemas import schema

LINE = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
)
OSCILLATOR = LINE + "loads:\n  - potential: x**2/2\ninitial: {x: 1}\n"
BLOW_UP = LINE + "loads:\n  - potential: -2*x**3\ninitial: {x: {position: 1, velocity: 2}}\n"


def simulated(folder: Path, text: str, *options: str, code: int | None = None) -> Result:
    file = filed(folder / "one.yaml", text)
    return invoked("simulate", file, "--out", folder / "out", "-f", "csv", *options, code=code)


def rows_of(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / "out" / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


def record_of(folder: Path) -> dict[str, Any]:
    record: dict[str, Any] = json.loads((folder / "out" / "simulation.json").read_text())
    jsonschema.validate(record, schema("simulation"))
    return record


def test_the_truth_is_within_the_radius_as_printed(tmp_path: Path) -> None:
    done = simulated(tmp_path, OSCILLATOR, "--time", "10", "--samples", "21", "--certify", "1e-20", code=0)
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
    done = simulated(tmp_path, BLOW_UP, "--time", "2", "--certify", "1e-6", code=3)
    found = record_of(tmp_path)
    assert found["status"] == "partial"
    assert found["certificate"]["reached"] < 1


def test_functions_without_a_power_series_are_refused(tmp_path: Path) -> None:
    done = simulated(tmp_path, OSCILLATOR.replace("x**2/2", "abs(x)"), "--time", "10", "--certify", code=2)
    assert "abs in the equations has no power series" in done.output or "sign in the equations" in done.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("width", ["0", "1", "1e-500", "nothing"])
def test_a_width_that_is_none(tmp_path: Path, width: str) -> None:
    done = simulated(tmp_path, OSCILLATOR, "--time", "10", f"--certify={width}", code=2)
    assert "--certify: error[" in done.output
    assert not (tmp_path / "out").exists()


FREE = """
mbsym: 1
name: fast terms
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: -sin(1000*x)*cos(1300*t) - cos(1700*x + sin(1900*t))}
initial: {x: 1}
"""


def test_a_proof_that_would_take_too_long_says_so_and_ends(tmp_path: Path) -> None:
    """Fast terms want millions of steps: a tenth of the time shows it."""
    begun = time.process_time()
    done = simulated(tmp_path, FREE, "--time", "300", "--samples", "3", "--no-estimate", "--certify", "1e-9",
                     "--certify-seconds", "2")  # fmt: skip
    assert done.exit_code == 3, done.output
    assert time.process_time() - begun < 60
    assert "its time is too short, " in done.stdout
    assert "at this pace all would take" in done.stdout
    found = record_of(tmp_path)["certificate"]
    assert found["ended"] == "out_of_time"
    assert found["reached"] < 300


def test_the_pace_is_that_of_the_steps_taken() -> None:
    found = Enclosure((), 50, 2.0, OUT_OF_TIME, 3.0, 600.0)
    assert found.whole_seconds == 900.0
    assert Enclosure((), 50, 0.0, OUT_OF_TIME, 3.0, 600.0).whole_seconds == math.inf
    assert [duration(x) for x in (40.0, 600.0, 10800.0, 864000.0)] == ["40 s", "10 min", "3 h", "10 days"]


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
def test_a_certificate_proves_shares_of_a_plan(accuracy: float, tmp_path: Path) -> None:
    """x = cos t, as planned: what is said to be proved at the rows holds there, and is no thousand times too much."""
    done = simulated(
        tmp_path,
        OSCILLATOR,
        "--time",
        "10",
        "--samples",
        "21",
        "--accuracy",
        str(accuracy),
        "--certify",
        "1e-12",
        code=0,
    )
    (bound,) = record_of(tmp_path)["plan"]["bounds"]
    assert "at every row (proved" in done.stdout
    exact = {"x": math.cos, "x_dot": lambda t: -math.sin(t)}[bound["quantity"]]
    rows = [(float(row["t"]), float(row[bound["quantity"]])) for row in rows_of(tmp_path, "trajectory.csv")]
    error = max(abs(value - exact(t)) for t, value in rows) / max(abs(value) for _, value in rows)
    assert error * (1 - 1e-6) - 1e-15 <= bound["proved_at_rows"] <= error * 1.001 + 1e-11
    assert bound["proved_at_rows"] <= bound["total"]


def test_what_is_not_certified_is_not_called_proved(tmp_path: Path) -> None:
    done = simulated(tmp_path, OSCILLATOR, "--time", "10", "--samples", "21", "--accuracy", "1e-6", code=0)
    assert "at every row (proved" not in done.stdout
    assert "proved_at_rows" not in record_of(tmp_path)["plan"]["bounds"][0]


def test_a_width_that_is_not_reached_is_exit_code_3(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """x'' = x from (1, -1): what a ball is wide by grows by 2.4e17 until t = 40, and more bits cost too much here."""
    monkeypatch.setattr("mbsym.studies.simulate.fitting.WORK", 0.08)
    text = LINE + "loads:\n  - potential: -x**2/2\ninitial: {x: {position: 1, velocity: -1}}\n"
    done = simulated(tmp_path, text, "--time", "40", "--samples", "21", "--certify", "1e-10", code=3)
    assert "that is wider than the 1e-10 that was asked for: it takes more work than it may" in " ".join(
        done.output.split()
    )
    found = record_of(tmp_path)["certificate"]
    assert (found["whole"], found["narrow"], found["asked"]) == (True, False, 1e-10)
    assert found["known"] > 1e-10
    monkeypatch.undo()
    done = simulated(tmp_path, text, "--time", "40", "--samples", "21", "--certify", "1e-10", code=0)
    assert record_of(tmp_path)["certificate"]["narrow"] is True
