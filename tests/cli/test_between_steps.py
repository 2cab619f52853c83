"""``mbsym simulate`` over switches and narrow loads: what is said, what is written, and --max-step."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import Result
from conftest import filed, invoked

HEAD = (
    "mbsym: 1\nname: one\nbodies:\n"
    "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
    "  - potential: x**2/2\n  - generalized force:\n"
)


def simulated(folder: Path, force: str, *options: str) -> tuple[Result, dict[str, object]]:
    file = filed(folder / "one.yaml", f"{HEAD}      x: {force}\ninitial: {{x: {{position: 1}}}}\n")
    options = (*options, "--format", "csv", "--out", str(folder / "out"))
    done = invoked("simulate", file, "--time", "8", "-v", *options)
    written = folder / "out" / "simulation.json"
    return done, json.loads(written.read_text()) if written.exists() else {}


def test_switches_are_told_and_written(tmp_path: Path) -> None:
    done, written = simulated(tmp_path, "50*pulse(t, 5, 5.002)")
    assert done.exit_code == 0
    assert "2, at t = 5, 5.002: a step ends at each" in " ".join(done.output.split())
    between = written["between_steps"]
    assert between == {"switches": [pytest.approx(5), pytest.approx(5.002)], "narrow": [], "unresolved": []}


def test_a_load_that_fixed_steps_pass_is_warned_of_with_its_place_and_a_command(tmp_path: Path) -> None:
    done, written = simulated(tmp_path, "100*exp(-((t - 5.3)/0.001)**2)", "--method", "rk4", "--step", "0.01")
    said = " ".join(done.output.split())
    assert "exp(-((t - 5.3)/0.001)**2) (line 8, column 14) changes within 0.001 at t = 5.3" in said
    assert "--method rk4 --step 0.00025" in said
    assert written["between_steps"]["narrow"]  # type: ignore[index]
    followed, _ = simulated(tmp_path, "100*exp(-((t - 5.3)/0.001)**2)", "--method", "rk4", "--step", "0.00025")
    assert "changes within" not in followed.output


@pytest.mark.parametrize("method", ["dop853", "rk45", "rodas5p", "radau", "taylor"])
def test_no_step_is_longer_than_asked(method: str, tmp_path: Path) -> None:
    done, written = simulated(tmp_path, "sin(t)", "--method", method, "--max-step", "0.01", "--no-estimate")
    assert done.exit_code == 0, done.output
    assert written["longest_step"] == 0.01
    assert written["work"]["steps"] >= 800  # type: ignore[index]
    assert "steps up to 0.01" in done.output


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--max-step", "0"), "--max-step"),
        (("--max-step", "x"), "--max-step"),
        (("--method", "rk4", "--step", "0.1", "--max-step", "0.01"), "rk4 takes steps of one length"),
    ],
)
def test_what_cannot_be_met_is_refused(options: tuple[str, ...], complaint: str, tmp_path: Path) -> None:
    done, written = simulated(tmp_path, "sin(t)", *options)
    assert done.exit_code == 2
    assert complaint in done.output + done.stderr
    assert not written
