"""``mbsym simulate --vary`` and ``--sensitivity`` as a user meets them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from conftest import SHIPPED, filed, invoked
from jsonschema import Draft202012Validator

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import machine_code
from mbsym.numerics.scenario import scenario
from mbsym.report.schemas import schema

PENDULUM = str(SHIPPED / "double-pendulum.yaml")
AWAY = """
mbsym: 1
name: Away
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - generalized force: {x: x**3}
initial: {x: 0.5}
"""


def run(*arguments: str, code: int | None = None) -> Result:
    return invoked("simulate", *arguments, code=code)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_an_ensemble_is_written_and_summed_up(tmp_path: Path) -> None:
    arguments = ["--time", "2", "--vary", "theta1=0:pi/2:9", "--vary", "m1=1:2:3", "--samples", "11"]
    done = run(PENDULUM, *arguments, "--out", str(tmp_path), code=0)
    assert "27, theta1, m1 varied" in done.output
    content = json.loads((tmp_path / "ensemble.json").read_text())
    Draft202012Validator(schema("ensemble")).validate(content)
    assert content["members"] == 27
    assert sorted(content["files"]) == ["ensemble.csv", "fan.png", "members.csv"]
    spread, members = rows(tmp_path / "ensemble.csv"), rows(tmp_path / "members.csv")
    assert len(spread) == 11
    assert len(members) == 27
    # the mean of the members' final states is the mean at the end, and a member is a simulation of its own
    last = np.array([float(row["theta2_final"]) for row in members])
    assert float(spread[-1]["theta2_mean"]) == pytest.approx(last.mean(), abs=1e-14)
    own = mbsym.simulate(PENDULUM, 2, values={"theta1": float(members[13]["theta1"]), "m1": float(members[13]["m1"])})
    assert last[13] == pytest.approx(own["theta2"][-1], abs=1e-9)


def test_members_that_end_early_are_told_everywhere(tmp_path: Path) -> None:
    path = filed(tmp_path / "away.yaml", AWAY)
    done = run(str(path), "--time", "3", "--vary", "x=0:1:11", "--out", str(tmp_path / "out"), "--format", "csv")
    assert done.exit_code == 3
    assert "member 10 (x = 1): blow-up" in done.output
    assert "members ended early" in done.output
    members = rows(tmp_path / "out" / "members.csv")
    # x'' = x^3 from rest at a: gone after 1.854/a (a complete elliptic integral of the first kind)
    gone = [row["member"] for row in members if row["ended"]]
    assert gone == [str(k) for k in range(11) if k and 1.8540746773013719 / (k / 10) < 3]
    assert all(row["x_final"] == "" for row in members if row["ended"])
    assert rows(tmp_path / "out" / "ensemble.csv")[-1]["alive"] == str(11 - len(gone))


def test_the_same_seed_draws_the_same_members(tmp_path: Path) -> None:
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        arguments = ["--time", "1", "--vary", "theta1=normal(0.3, 0.01)", "--members", "20", "--seed", seed]
        assert run(PENDULUM, *arguments, "--out", str(tmp_path / name), "--format", "csv", "-q").exit_code == 0
    first, second, third = ((tmp_path / name / "members.csv").read_text() for name in "abc")
    assert first == second
    assert first != third


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--vary", "theta1"], "this says no range"),
        (["--vary", "theta1=0:1"], "this is no range"),
        (["--vary", "theta1=normal(0, z)", "--members", "5"], "unknown name z"),
        (["--vary", "thta1=0:1:5"], "did you mean 'theta1'"),
        (["--vary", "theta1=normal(0, 1)"], "how many members to draw"),
        (["--vary", "theta1=0:1:5", "--vary", "m1=uniform(1, 2)"], "do not go together"),
        (["--vary", "theta1=0:1:5000000"], "too many"),
        (["--vary", "theta1=0:1:5", "--method", "radau"], "side by side"),
        (["--vary", "theta1=0:1:5", "--invariants"], "--invariants does not go"),
        (["--members", "5"], "--members goes with --vary"),
        (["--vary", "m1=-1:1:5"], "declared positive"),
        (["--sensitivity", "m9"], "nothing called 'm9'"),
        (["--sensitivity", "m1", "--vary", "m1=1:2:3"], "exclude each other"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_written(arguments: list[str], told: str, tmp_path: Path) -> None:
    done = run(PENDULUM, "--time", "1", *arguments, "--out", str(tmp_path / "out"), code=2)
    assert told in done.output
    assert not (tmp_path / "out").exists()


def test_derivatives_over_switches_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    (tmp_path / "kink.yaml").write_text(AWAY.replace("x**3", "-sign(x_dot) - x"), encoding="utf-8")
    done = run(str(tmp_path / "kink.yaml"), "--time", "1", "--sensitivity", "x", "--out", str(tmp_path / "out"), code=2)
    assert "--sensitivity: error[not-smooth]" in done.output
    assert not (tmp_path / "out").exists()


def test_derivatives_are_written(tmp_path: Path) -> None:
    run(PENDULUM, "--time", "1", "--sensitivity", "theta1,m1", "--out", str(tmp_path), "--format", "csv", code=0)
    found = rows(tmp_path / "sensitivity.csv")
    assert float(found[0]["d theta1/d theta1(0)"]) == 1
    h = 1e-5
    ends = [mbsym.simulate(PENDULUM, 1, values={"m1": 1 + sign * h}, tolerance=1e-13)["theta2"][-1] for sign in (1, -1)]
    assert float(found[-1]["d theta2/d m1"]) == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-6)


def test_python_returns_arrays() -> None:
    found = mbsym.ensemble(PENDULUM, 1, {"theta1": ("uniform", 0, 1), "g": ("normal", 9.81, 0.01)}, members=50)
    assert found.statistics.quantiles.shape == (5, 201, 4)
    answers = mbsym.sensitivities(PENDULUM, 1, ["theta1", "l1"])
    assert answers["theta1", "theta1"][0] == 1
    with pytest.raises(ValueError, match="no distribution"):
        mbsym.ensemble(PENDULUM, 1, {"theta1": ("gamma", 0, 1)}, members=50)


TRIPLE = """
mbsym: 1
name: three links
parameters: {m: positive, l1: positive, l2: positive, l3: positive, g: positive}
bodies:
  - {name: a, attached to: 0, rotation: {axes: [3], angles: [p]}, mass centre: [0, -l1, 0], mass: m}
  - {name: b, attached to: a, connection point: [0, -l1, 0], rotation: {axes: [3], angles: [q]},
     mass centre: [0, -l2, 0], mass: m}
  - {name: c, attached to: b, connection point: [0, -l2, 0], rotation: {axes: [3], angles: [r]},
     mass centre: [0, -l3, 0], mass: m}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
values: {m: 1, l1: 1, l2: 1e-6, l3: 1, g: 9.81}
initial: {p: 1, q: 1/2, r: 1/3}
"""


def test_where_kernels_carry_pairs_ensembles_are_said_not_to(tmp_path: Path) -> None:
    """And so it is: the accelerations of a member's program are those of the plain kernel, not of the one in pairs."""
    (tmp_path / "triple.yaml").write_text(TRIPLE, encoding="utf-8")
    done = invoked("extremes", tmp_path / "triple.yaml", "--out", tmp_path, code=0)
    told = " ".join(done.stdout.split())
    assert "carry" in told
    assert "in pairs of numbers" in told
    assert "Ensembles (mbsym simulate --vary) are computed with plain kernels" in told
    given = scenario(mbsym.loads(TRIPLE).system)
    dynamics, at = Dynamics(given), np.array([0.0, *map(float, given.state)])
    plain, pairs = kernel(dynamics.right_hand_side)(at), kernel(machine_code(dynamics, "right_hand_side"))(at)
    member = kernel(Parametrised(given, []).right_hand_side)(at)
    assert np.any(plain != pairs)
    assert np.array_equal(member, plain)


def test_where_no_kernel_carries_pairs_nothing_is_said_of_ensembles(tmp_path: Path) -> None:
    (tmp_path / "away.yaml").write_text(AWAY, encoding="utf-8")
    done = invoked("extremes", tmp_path / "away.yaml", "--out", tmp_path, code=0)
    assert "Ensembles" not in done.stdout
