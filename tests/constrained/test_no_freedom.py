"""Constraints that leave nothing to move: a complaint; a mechanism that is driven whole: everything works."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import invoked

WHEEL = """\
mbsym: 1
name: Wheel
parameters: {m: positive, r: positive, J: positive, w: positive}
prescribed: {chi: {rate: w}}
bodies:
  - name: wheel
    attached to: 0
    rotation: {axes: [3], angles: [-phi]}
    connection point: [x, 0, 0]
    coordinates: [x, phi]
    mass: m
    inertia about: mass centre
    inertia: [0, 0, J]
constraints:
"""
VALUES = "values: {m: 1, r: 1/2, J: 1/8, w: 2}\ninitial: {x: 0, phi: {position: 0, velocity: 2}}\n"
#: The contact in axes that spin with the wheel: a point of the rim is held fast.
HELD = "  - relation: x - r*phi = 0\n  - rolling: {body: wheel, point: [0, -r, 0], on: ground}\n"
DRIVEN = "  - relation: phi - chi = 0\n  - velocity: x_dot - r*phi_dot = 0\n"


def called(tmp_path: Path, constraints: str, *command: str, code: int | None = None):  # type: ignore[no-untyped-def]
    file = tmp_path / "wheel.yaml"
    file.write_text(WHEEL.replace("prescribed: {chi: {rate: w}}\n", "" if "chi" not in constraints else
                                  "prescribed: {chi: {rate: w}}\n") + constraints + VALUES)  # fmt: skip
    return invoked(command[0], file, "--out", tmp_path / "out", *command[1:], code=code)


def test_what_cannot_move_is_complained_of_with_every_constraint(tmp_path: Path) -> None:
    done = called(tmp_path, HELD, "run", code=2)
    assert done.stderr.count("error[no-freedom]") == 2
    assert not (tmp_path / "out").exists()


def test_what_is_driven_whole_is_derived_and_written(tmp_path: Path) -> None:
    done = called(tmp_path, DRIVEN, "run", "-v", code=0)
    assert "The constraints determine all velocities" in done.output
    assert "at any one time are of dimension 0" in done.output
    assert (tmp_path / "out" / "report.tex").exists()


def test_what_is_driven_whole_moves_as_it_is_driven(tmp_path: Path) -> None:
    called(tmp_path, DRIVEN, "simulate", "--time", "3", "--samples", "4", "--format", "csv", code=0)
    last = (tmp_path / "out" / "trajectory.csv").read_text().splitlines()[-1].split(",")
    assert [float(x) for x in last[:3]] == pytest.approx([3.0, 3.0, 6.0], rel=1e-12)  # x = r w t, phi = w t
    assert json.loads((tmp_path / "out" / "simulation.json").read_text())
