"""Robots from packaged URDF files: every report within a minute, and the numbers of Pinocchio.

Needs the extra ``robots`` (``make robots`` installs it); without it these tests are skipped.
"""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import warm
from robots import ROBOTS

import mbsym
from mbsym.problems.regressor import regressor
from mbsym.report.code.python_module import render
from mbsym.report.regressor_files import regressor_module
from mbsym.source.robots.reader import angle, is_of_a_body, multiple_of_pi, number

pytest.importorskip("pinocchio", reason="needs the extra 'robots'")
agreement = pytest.importorskip("agreement", reason="needs the extra 'robots'")
convert = agreement.convert
if not agreement.has_urdf_files():
    pytest.skip("needs the extra 'robots'", allow_module_level=True)

#: Relative, of the largest entry, at random states; Pinocchio works in double precision, as model.py does.
CLOSE = 1e-12
#: Seconds of ``mbsym run`` on two cores.
MINUTE = 60
REPORTS = {
    "report.tex": 2_000_000,
    "report.wl": 8_000_000,
    "results.json": 8_000_000,
    "model.py": None,
    "model.c": None,
}


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot(name: str, tmp_path: Path) -> None:
    file, floating = ROBOTS[name]
    text = agreement.urdf_files()[file].read_text(encoding="utf-8")
    converted = convert(text, floating)
    (tmp_path / "robot.yaml").write_text(converted.yaml, encoding="utf-8")
    done = warm.run(
        ["run", "robot.yaml", "--out", "reports", "--quiet"], cwd=tmp_path, timeout=10 * MINUTE, processor=MINUTE
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for report, most in REPORTS.items():
        size = (tmp_path / "reports" / report).stat().st_size
        assert size > 1_000
        assert most is None or size < most, report
    checks = json.loads((tmp_path / "reports" / "results.json").read_text(encoding="utf-8"))["checks"]
    outcomes = {check["name"]: check["outcome"] for check in checks}
    assert set(outcomes.values()) <= {"exact", "verified numerically"}
    assert outcomes["straight-line program"] in ("exact", "verified numerically")
    module = agreement.loaded(tmp_path / "reports" / "model.py")
    assert agreement.worst_difference(text, converted, module) < CLOSE


def test_a_wrong_number_is_seen(tmp_path: Path) -> None:
    """The comparison is no formality: a mass centre moved by a micrometre, a joint turned the other way."""
    file, floating = ROBOTS["UR5"]
    text = agreement.urdf_files()[file].read_text(encoding="utf-8")
    yaml = convert(text, floating).yaml
    for right, wrong in (("[0, 0, 0.28]", "[0, 0, 0.280001]"), ("angles: [q3]", "angles: [-q3]")):
        assert right in yaml
        folder = tmp_path / wrong.strip("[]").replace(" ", "")
        folder.mkdir()
        (folder / "robot.yaml").write_text(yaml.replace(right, wrong), encoding="utf-8")
        done = warm.run(["run", "robot.yaml", "-f", "python", "-o", ".", "-q"], cwd=folder, timeout=MINUTE)
        assert done.returncode == 0, done.stderr
        difference = agreement.worst_difference(text, convert(text), agreement.loaded(folder / "model.py"))
        assert difference > 1e-8


@pytest.mark.parametrize(
    ("name", "number"),
    [("UR5", 36), ("Kinova", 36), ("xArm 7", 43), ("Allegro hand", 94), ("Z1", 43), ("Tiago without hand", 58)],
)
def test_base_parameters_are_as_many_as_pinocchio_s_regressor_has_rank(name: str, number: int) -> None:
    """Its regressor of all standard parameters at random states; Y beta is Newton and Euler's forces to 1e-13.

    Six turning joints with the first one upright: Mayeda's 7 N - 4 - 2 = 36; seven: 43.
    """
    file, floating = ROBOTS[name]
    text = agreement.urdf_files()[file].read_text(encoding="utf-8")
    converted = convert(text, floating)
    analysis = mbsym.loads(converted.yaml, problems=())
    found = regressor(analysis.scene)
    assert len(found.base) == number
    assert agreement.regressor_rank(text, converted) == number
    own, model = ModuleType("regressor"), ModuleType("model")
    exec(regressor_module(found), own.__dict__)  # our own generated modules
    exec(render(analysis, ()), model.__dict__)
    for state in np.random.default_rng(3).normal(size=(3, 3, len(analysis.system.coordinates))):
        wanted = model.inverse_dynamics(*state, model.DEFAULTS)
        tau = own.regressor(*state, own.DEFAULTS) @ own.base_parameters(own.DEFAULTS)
        assert np.abs(tau - wanted).max() <= 1e-13 * np.abs(wanted).max()


@pytest.mark.parametrize("name", ["UR5", "Talos arm", "Allegro hand"])
def test_frames_are_where_pinocchio_has_them(name: str) -> None:
    """Poses and Jacobians of every frame that both know by name, in inertial axes."""
    file, floating = ROBOTS[name]
    text = agreement.urdf_files()[file].read_text(encoding="utf-8")
    converted = convert(text, floating)
    model = ModuleType("model")
    exec(render(mbsym.loads(converted.yaml, problems=()), ()), model.__dict__)
    worst, number = agreement.worst_frame(text, converted, model)
    assert number >= 8
    assert worst < CLOSE


def test_numbers_are_spelled_as_they_are_printed() -> None:
    assert [number(x) for x in ("0.10", "-0.0", "1e-05", "3", "-5.42101e-20")] == [
        "0.1", "0", "0.00001", "3", "-5.42101E-20",
    ]  # fmt: skip
    assert [angle(x) for x in ("1.5708", "-1.57079632679", "3.1415926535897931", "0.5236", "0.5", "1.571", "1.6")] == [
        "pi/2", "-pi/2", "pi", "pi/6", "0.5", "pi/2", "1.6",
    ]  # fmt: skip
    assert multiple_of_pi(-3) == "-3*pi"
    # What lies below the last digit of a description is rounded there: the converted file has to be read again.
    assert number("5.77686E-66") == "0"
    assert number("-1.23456789E-55") == "-1.23457E-55"


def test_which_tensors_are_of_a_body() -> None:
    assert is_of_a_body(1, 0, 0, 1, 0, 2)
    assert not is_of_a_body(1, 0, 0, 1, 0, 3)
    assert not is_of_a_body(1, 1, 1, 1, 1, 1)
