"""``mbsym simulate --accuracy``: what is printed, what is recorded, that the run can be repeated without choosing."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import Result
from conftest import SHIPPED, invoked

from mbsym.numerics.planning.pilot import Bench
from mbsym.report import schemas


def called(*arguments: object, code: int | None = None) -> Result:
    return invoked("simulate", *arguments, code=code)


def test_a_run_is_repeated_byte_by_byte_by_the_command_it_prints(tmp_path: Path) -> None:
    first, again = tmp_path / "first", tmp_path / "again"
    done = called(SHIPPED / "double-pendulum.yaml", "--time", "5", "--accuracy", "1e-5", "-f", "csv", "-o", first)
    assert done.exit_code == 0, done.output
    command = shlex.split(done.stdout.splitlines()[-1])
    assert command[:2] == ["mbsym", "simulate"]
    assert "--accuracy" not in command
    called(*command[2:], "-f", "csv", "-o", again, code=0)
    assert (first / "trajectory.csv").read_bytes() == (again / "trajectory.csv").read_bytes()


def test_simulation_json_holds_the_plan_and_keeps_to_its_schema(tmp_path: Path) -> None:
    called(SHIPPED / "satellite.yaml", "--time", "1", "--accuracy", "1e-2", "-f", "csv", "-o", tmp_path, code=0)
    found = json.loads((tmp_path / "simulation.json").read_text())
    jsonschema.validate(found, schemas.schema("simulation"))
    plan = found["plan"]
    assert plan["reached"]
    for bound in plan["bounds"]:
        assert bound["total"] == pytest.approx(sum(share["error"] for share in bound["shares"]))
        assert bound["total"] <= bound["target"] == 1e-2
    assert plan["options"][plan["options"].index("--method") + 1] == found["method"]["name"]
    assert {"order of gravity", "method", "tolerance", "arithmetic"} <= {item["kind"] for item in plan["items"]}


def test_only_a_plan_writes_nothing(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = called(SHIPPED / "simple-pendulum.yaml", "--time", "5", "--accuracy", "theta=1e-4", "--plan", "-o", out)
    assert done.exit_code == 0, done.output
    assert not out.exists()
    assert "theta within" in done.stdout
    assert "one digit more" in done.stdout
    assert "to repeat:" in done.stdout


def test_an_accuracy_that_is_not_reached_is_told_and_ends_with_3(tmp_path: Path) -> None:
    options = ("--time", "10", "--accuracy", "1e-9", "--tolerance", "1e-3", "--plan")
    done = called(SHIPPED / "simple-pendulum.yaml", *options, code=3)
    assert "not reached" in done.stdout
    assert "as asked for, too coarse for this accuracy" in done.stdout


def test_a_model_settled_by_hand_is_integrated(tmp_path: Path) -> None:
    done = called(SHIPPED / "satellite.yaml", "--time", "1", "--gravity", "exact", "-f", "csv", "-o", tmp_path / "a")
    plain = called(SHIPPED / "satellite.yaml", "--time", "1", "-f", "csv", "-o", tmp_path / "b")
    assert done.exit_code == plain.exit_code == 0
    exact, second = (json.loads((tmp_path / x / "simulation.json").read_text()) for x in "ab")
    assert exact["model"]["gravity"] == "exact"
    assert second["model"]["gravity"] is None
    assert exact["description_sha256"] == second["description_sha256"]
    assert (tmp_path / "a" / "trajectory.csv").read_bytes() != (tmp_path / "b" / "trajectory.csv").read_bytes()


def test_the_energy_of_linear_equations_is_not_said_to_be_conserved(tmp_path: Path) -> None:
    options = ("--time", "10", "--linear", "-f", "csv", "-o", tmp_path)
    done = called(SHIPPED / "simple-pendulum.yaml", *options, code=0)
    energy = json.loads((tmp_path / "simulation.json").read_text())["energy"]
    assert energy["conserved"] is False
    assert "conserved (proved)" not in done.output


@pytest.mark.parametrize(
    ("options", "complaints"),
    [
        (["--plan"], ["--plan: error[missing-option]"]),
        (["--accuracy", "0"], ["--accuracy: error[bad-number]"]),
        (["--accuracy", "thet=1e-3"], ["--accuracy: error[unknown-quantity]", "did you mean 'theta'"]),
        (["--accuracy", "1e-3,1e-4"], ["two errors are given for everything"]),
        (["--accuracy", "x"], ["--accuracy: error[unknown-name]"]),
        (["--gravity", "2"], ["--gravity: error[unsuitable-option]"]),
        (["--gravity", "5"], ["--gravity: error[unknown-order]"]),
        (["--without", "zeta"], ["--without: error[unknown-parameter]"]),
        (["--accuracy", "1e-3", "--vary", "theta=0:1:3"], ["--accuracy: error[conflicting-options]"]),
        (["--accuracy", "1e-3", "--step", "0.1"], ["--step: error[conflicting-options]"]),
    ],
)
def test_what_makes_no_sense_is_complained_about(tmp_path: Path, options: list[str], complaints: list[str]) -> None:
    out = tmp_path / "out"
    done = called(SHIPPED / "simple-pendulum.yaml", "--time", "1", *options, "-o", out, code=2)
    for text in complaints:
        assert text in done.stderr
    assert not out.exists()


@pytest.mark.parametrize("more", [(), ("--plan",)])
def test_a_plan_that_is_interrupted_says_so_and_leaves_nothing(
    more: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C in the third of the runs that are tried."""
    usual, runs = Bench.run, []

    def run(*arguments: Any, **named: Any) -> Any:
        runs.append(arguments)
        if len(runs) == 3:
            raise KeyboardInterrupt
        return usual(*arguments, **named)

    monkeypatch.setattr(Bench, "run", run)
    done = called(SHIPPED / "simple-pendulum.yaml", "--time", "5", "--accuracy", "1e-6", *more, "-o", tmp_path / "out")
    assert len(runs) == 3
    assert done.exit_code == 130
    assert "interrupted; nothing was written" in done.stderr
    assert not list(tmp_path.iterdir())
