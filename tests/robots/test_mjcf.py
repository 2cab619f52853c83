"""MJCF against Pinocchio's own reading of the same file: kinetic energy and gravity at random states."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.expressions.place import Complaints
from mbsym.report.code.python_module import render
from mbsym.source import read
from mbsym.source.robots import convert

pinocchio = pytest.importorskip("pinocchio", reason="needs the extra 'robots'")

FILES = Path(__file__).parent / "mjcf"
CLOSE = 1e-12

#: The gravity of the files' options, which Pinocchio does not read.
GRAVITY = {"arm": (0.0, 0.0, -9.81), "free": (0.0, -1.5, -9.0), "ball": (0.0, 0.0, -9.81)}


def axis_rotation(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array(
        {
            1: [[1, 0, 0], [0, c, -s], [0, s, c]],
            2: [[c, 0, s], [0, 1, 0], [-s, 0, c]],
            3: [[c, -s, 0], [s, c, 0], [0, 0, 1]],
        }[axis]
    )


def turned(angles: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rz(yaw) Ry(pitch) Rx(roll) and the angular velocity in the turned axes, by hand."""
    yaw, pitch, roll = (axis_rotation(axis, angle) for axis, angle in zip((3, 2, 1), angles, strict=True))
    along = (roll.T @ pitch.T @ [0, 0, 1], roll.T @ [0, 1, 0], np.array([1.0, 0, 0]))
    return yaw @ pitch @ roll, sum(rate * axis for rate, axis in zip(rates, along, strict=True))


def state(model: object, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pinocchio's configuration and velocity at our coordinates and their rates, joint after joint."""
    there, speed = [], []
    k = 0
    for joint in list(model.joints)[1:]:  # type: ignore[attr-defined]
        if joint.shortname() == "JointModelFreeFlyer":
            rotation, omega = turned(q[k + 3 : k + 6], v[k + 3 : k + 6])
            there += [*q[k : k + 3], *pinocchio.Quaternion(rotation).coeffs()]
            speed += [*(rotation.T @ v[k : k + 3]), *omega]
            k += 6
        elif joint.nv == 3 and joint.nq == 4:
            rotation, omega = turned(q[k : k + 3], v[k : k + 3])
            there += [*pinocchio.Quaternion(rotation).coeffs()]
            speed += [*omega]
            k += 3
        else:
            there += [*q[k : k + joint.nv]]
            speed += [*v[k : k + joint.nv]]
            k += joint.nv
    assert k == len(q)
    return np.array(there), np.array(speed)


def differences(name: str, yaml: str) -> float:
    """The largest relative difference of T, and of the potential energy against that at another state."""
    model = pinocchio.buildModelFromMJCF(str(FILES / f"{name}.xml"))
    model.gravity.linear = np.array(GRAVITY[name])
    data = model.createData()
    analysis = mbsym.loads(yaml, problems=())
    module: dict[str, Any] = {}
    exec(render(analysis, ()), module)  # our own generated module
    numbers = module["DEFAULTS"]
    source = random.Random(3)
    worst, first = 0.0, None
    for _ in range(12):
        q, v = (np.array([source.uniform(-1, 1) for _ in analysis.system.coordinates]) for _ in range(2))
        kinetic = v @ np.array(module["mass_matrix"](q, numbers)) @ v / 2
        own = (kinetic, module["energy"](q, 0 * v, numbers))
        there, speed = state(model, q, v)
        theirs = (
            pinocchio.computeKineticEnergy(model, data, there, speed),
            pinocchio.computePotentialEnergy(model, data, there),
        )
        worst = max(worst, abs(own[0] - theirs[0]) / abs(theirs[0]))
        offset = own[1] - theirs[1]  # a potential energy is known up to a constant
        first = offset if first is None else first
        worst = max(worst, abs(offset - first) / abs(theirs[1]))
    return worst


@pytest.mark.parametrize("name", sorted(GRAVITY))
def test_mjcf_gives_pinocchio_s_energies(name: str) -> None:
    complaints = Complaints()
    made = convert((FILES / f"{name}.xml").read_text(encoding="utf-8"), complaints, damping=False)
    assert made is not None, [one.message for one in complaints]
    assert differences(name, made.yaml) < CLOSE


@pytest.mark.parametrize(
    ("right", "wrong"), [("pi/6", "-pi/6"), ("connection point: [0.1, 0, 0]", "connection point: [-0.1, 0, 0]")]
)
def test_a_wrong_turn_is_seen(right: str, wrong: str) -> None:
    made = convert((FILES / "arm.xml").read_text(encoding="utf-8"), Complaints(), damping=False)
    assert made is not None
    assert right in made.yaml
    assert differences("arm", made.yaml.replace(right, wrong, 1)) > 1e-6


def test_shapes_limits_and_what_is_left_out_are_kept() -> None:
    made = convert((FILES / "arm.xml").read_text(encoding="utf-8"), Complaints())
    assert made is not None
    system, _ = read(made.yaml, "arm.yaml")
    assert system is not None
    assert [one.kind for body in system.bodies for one in body.shapes] == [
        "capsule", "box", "sphere", "cylinder", "ellipsoid",
    ]  # fmt: skip
    assert [one.coordinate for one in system.limits] == ["q1", "q3"]
    assert {one.split(" (")[0] for one in made.left_out} == {"sensor", "contact"}
    assert system.input_names == ("tau_pan",)
    assert made.joints == ("pan", "lift", "slide", "yaw", "pitch")


def test_what_an_actuator_cannot_do_is_told() -> None:
    """A wrong gear and a joint that is not there are complaints, limits of torques are left out in words."""
    text = (
        '<mujoco><worldbody><body><joint name="j" axis="0 1 0"/><geom size="0.1" pos="0 0 -1"/></body></worldbody>'
        "<actuator><motor {}/></actuator></mujoco>"
    )
    gear, joint = ('joint="j" gear="two"', "'two' in 'gear' is no number"), ('joint="k"', "there is no joint 'k'")
    for wrong, told in (gear, joint):
        complaints = Complaints()
        assert convert(text.format(wrong), complaints) is None
        assert [str(one.message) for one in complaints] == [told]
    for limit in ('ctrlrange="-1 1"', 'forcerange="-2 2"'):
        made = convert(text.format(f'joint="j" gear="1 0 0 0 0 0" {limit}'), Complaints())
        assert made is not None
        assert "limits of an actuator" in made.left_out
        assert not any("gear" in one for one in made.left_out)
