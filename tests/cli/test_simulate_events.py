"""``mbsym simulate --event --stop --section``: what is written and said, and complaints about conditions."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
from click.testing import Result
from conftest import SHIPPED, invoked
from jsonschema import Draft202012Validator
from PIL import Image

from mbsym.report.schemas import schema

DOUBLE = SHIPPED / "double-pendulum.yaml"


def ran(folder: Path, *options: str, code: int | None = None) -> Result:
    return invoked("simulate", DOUBLE, "--out", folder, "--no-estimate", *options, code=code)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_events_stops_and_a_section_are_written_drawn_and_said(tmp_path: Path) -> None:
    done = ran(
        tmp_path,
        *("--time", "60", "--format", "csv,png,svg", "--samples", "201"),
        *("--event", "low: theta1 = 0 rising", "--event", "theta1 < 0"),
        *("--stop", "t > 50", "--section", "theta1 = 0 mod 2*pi rising", "--axes", "theta2, theta2_dot"),
        code=0,
    )
    content = json.loads((tmp_path / "simulation.json").read_text())
    assert list(Draft202012Validator(schema("simulation")).iter_errors(content)) == []
    assert content["status"] == "whole"
    assert content["stopped"]["time"] == 50
    assert [one["name"] for one in content["events"]] == ["low", "theta1 < 0", "t > 50"]
    rows = table(tmp_path / "events.csv")
    assert len(rows) == sum(one["count"] for one in content["events"])
    assert [float(row["t"]) for row in rows] == sorted(float(row["t"]) for row in rows)
    assert {row["direction"] for row in rows if row["event"] == "theta1 < 0"} == {"-1"}
    assert max(abs(float(row["theta1"])) for row in rows if row["event"] != "t > 50") < 1e-12
    points = table(tmp_path / "section.csv")
    assert len(points) == content["section"]["count"] > 10
    assert {row["t"] for row in rows if row["event"] == "low"} <= {row["t"] for row in points}
    trajectory = table(tmp_path / "trajectory.csv")
    assert float(trajectory[-1]["t"]) == 50
    assert {"section.png", "events.csv", "section.csv"} <= set(content["files"])
    assert np.asarray(Image.open(tmp_path / "section.png").convert("L")).std() > 5
    assert "stopped at t = 50 by t > 50" in " ".join(done.output.split())
    assert "low: " in done.output


def test_every_complaint_about_conditions_at_once_and_nothing_written(tmp_path: Path) -> None:
    done = ran(
        tmp_path / "none",
        *("--time", "1", "--event", "thta1 = 0", "--stop", "theta1", "--axes", "theta1", "--event", "0 < theta1 < 1"),
        code=2,
    )
    for part in (
        "--event: error[unknown-name]: unknown name 'thta1'",
        "hint: did you mean 'theta1'?",
        "--stop: error[bad-condition]",
        "--axes: error[missing-option]",
        "--event: error[bad-condition]: more than one of = < >",
    ):
        assert part in done.output
    assert not (tmp_path / "none").exists()


def test_a_condition_without_a_value_names_its_option(tmp_path: Path) -> None:
    done = ran(tmp_path, "--time", "1", "--stop", "theta1**(1/3) = 0", code=2)
    assert "--stop: error[no-value]" in done.output


def test_what_holds_at_the_start_stops_there_and_is_said(tmp_path: Path) -> None:
    done = ran(tmp_path, "--time", "5", "--stop", "theta1_dot < 1", code=0)
    assert "stopped at t = 0" in " ".join(done.output.split())
    assert len(table(tmp_path / "trajectory.csv")) == 1


def test_what_never_leaves_the_error_of_a_step_is_undecided(tmp_path: Path) -> None:
    done = ran(tmp_path, "--time", "5", "--event", "theta1 - theta1 = 0", "--event", "theta2 = 9", code=0)
    assert "nothing can be told" in done.output
    assert "theta2 = 9: never" in done.output


def test_a_stop_that_holds_at_the_start_says_so(tmp_path: Path) -> None:
    """One row, and no word of a better run that broke down: there was nothing to be integrated."""
    done = ran(tmp_path, "--time", "2", "--format", "csv", "--estimate", "--stop", "theta2 < 10", code=0)
    told = " ".join(done.output.split())
    assert "stopped at t = 0 by theta2 < 10, which holds at the start: nothing was integrated" in told
    assert "singularity" not in told
    content = json.loads((tmp_path / "simulation.json").read_text())
    assert list(Draft202012Validator(schema("simulation")).iter_errors(content)) == []
    assert len(table(tmp_path / "trajectory.csv")) == 1
