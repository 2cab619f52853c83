"""MJCF against MuJoCo itself: mass matrix, bias forces, frames and constraints at random states.

Needs MuJoCo 3 (the extra ``robots``); without it these tests are skipped.
"""

from __future__ import annotations

import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import mbsym
from mbsym.analysis import Analysis
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import text as written
from mbsym.report.code.python_module import render
from mbsym.source.robots import convert

mujoco = pytest.importorskip("mujoco", reason="needs the extra 'robots'")
if not hasattr(mujoco, "MjModel"):
    pytest.skip("needs MuJoCo 3", allow_module_level=True)

CLOSE = 1e-11
ARM = (Path(__file__).parent / "mjcf" / "arm.xml").read_text(encoding="utf-8")

#: Rotors, joints that are not at zero where they are straight, frames in frames, a mass that is set, a default class.
EVERYTHING = """<mujoco model="everything">
<compiler angle="degree" settotalmass="7.5"/><option gravity="0.3 0 -9.81"/>
<default><joint armature="0.05"/><geom density="700"/></default>
<worldbody><frame pos="0.1 0.2 0.3" euler="0 40 0">
 <body name="a" pos="0 0 0.5" euler="10 20 30"><joint name="j1" axis="0 1 0" ref="35" armature="0.4"/>
  <geom type="box" size="0.05 0.06 0.3" pos="0 0 0.3"/>
  <frame name="shelf" pos="0 0 0.6" axisangle="1 0 0 60"><geom type="sphere" size="0.1" pos="0.1 0 0"/>
   <site name="tip" pos="0.2 0 0.1"/>
   <body name="b" pos="0 0.1 0"><joint name="j2" type="slide" axis="1 2 0.5" ref="0.2" damping="1"/>
    <joint name="j3" axis="1 1 0" pos="0.02 0.01 0"/>
    <geom type="capsule" size="0.04 0.2"/></body>
  </frame></body>
 </frame>
 <body name="c" pos="1 0 1"><joint name="ball" type="ball" armature="0.7"/>
  <geom type="ellipsoid" size="0.1 0.2 0.3"/></body>
</worldbody></mujoco>"""

#: Euler angles about turned and fixed axes in turn; geoms that weigh nothing leave an <inertial> as it is.
SETTINGS = """<mujoco><compiler eulerseq="xZy" inertiafromgeom="true" inertiagrouprange="0 2"/><worldbody>
<body name="a" euler="20 40 -70"><joint name="j1" axis="0 1 0"/><inertial pos="0 0 -1" mass="1" diaginertia="1 1 1"/>
 <frame euler="-10 30 50"><geom size="0.1" pos="0.2 0 0"/></frame>
 <body name="b" pos="0 0 -1" euler="70 -20 35"><joint name="j2" axis="1 0 2"/>
  <inertial pos="0.1 0 -1" mass="2" diaginertia="0.3 0.4 0.5" euler="15 25 60"/>
  <geom size="0.2" mass="0"/><geom size="0.2" group="3"/></body></body></worldbody></mujoco>"""

#: Two pendulums that are tied at a point and by a relation of their joints.
TIED = """<mujoco><compiler angle="radian"/><worldbody>
<body name="a"><joint name="y" axis="0 1 0" ref="0.3"/>
 <inertial mass="1" pos="0 0 -1" diaginertia="0.1 0.1 0.1"/><site name="p" pos="0.1 0 -0.8"/></body>
<body name="b" pos="0.5 0 0" euler="0 0.4 0"><joint name="x" axis="0 1 0"/>
 <inertial mass="2" pos="0 0 -0.7" diaginertia="0.1 0.1 0.1"/>
 <body name="d" pos="0 0 -1"><joint name="z" type="slide" axis="1 0 0"/><inertial mass="1" pos="0 0 0"
  diaginertia="0.1 0.1 0.1"/><site name="s" pos="0.05 0 0.1"/></body></body>
</worldbody><equality>{}</equality></mujoco>"""


def ours(text: str) -> tuple[Analysis, Any, tuple[str, ...]]:
    complaints = Complaints()
    made = convert(text, complaints, damping=False)
    assert made is not None, [one.message for one in complaints]
    analysis = mbsym.loads(made.yaml, problems=())
    module = ModuleType("model")
    exec(render(analysis, ()), module.__dict__)  # our own generated module
    return analysis, module, made.joints


def whole(model: Any, data: Any) -> np.ndarray:
    """M, column by column."""
    found = np.zeros((model.nv, model.nv))
    for column, unit in zip(found, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return found.T


@pytest.mark.parametrize("text", [ARM, EVERYTHING, SETTINGS])
def test_masses_forces_and_frames_are_mujoco_s(text: str) -> None:
    """M(q), c + g; of the ball only M about its own axes at zero angles, where angular velocity and rates agree."""
    _, own, joints = ours(text)
    model = mujoco.MjModel.from_xml_string(text)
    model.dof_damping[:] = 0
    data, source = mujoco.MjData(model), np.random.default_rng(2)
    turning = [name for name in joints if model.joint(name).type[0] != mujoco.mjtJoint.mjJNT_BALL]
    n = len(turning)
    for _ in range(3):
        q, v = source.normal(size=(2, len(own.COORDINATES)))
        q[n:], v[n:] = 0, 0  # a ball joint comes last here
        for name, value, rate in zip(turning, q, v, strict=False):
            data.joint(name).qpos[0], data.joint(name).qvel[0] = value, rate
        mujoco.mj_forward(model, data)
        order = [model.joint(name).dofadr[0] for name in turning]
        mass = own.mass_matrix(q, own.DEFAULTS)
        theirs = whole(model, data)
        assert np.abs(mass[:n, :n] - theirs[np.ix_(order, order)]).max() < CLOSE * np.abs(theirs).max()
        bias = own.coriolis(q, v, own.DEFAULTS) + own.gravity(q, own.DEFAULTS)
        assert np.abs(bias[:n] - data.qfrc_bias[order]).max() < CLOSE * np.abs(data.qfrc_bias).max()
        if len(q) > n:
            last = model.joint(joints[-1]).dofadr[0] + np.array([2, 1, 0])  # yaw, pitch, roll
            assert np.abs(mass[n:, n:] - theirs[np.ix_(last, last)]).max() < CLOSE * np.abs(theirs).max()
        for k in range(model.nsite):
            site = own.frame_pose(model.site(k).name, q, own.DEFAULTS)
            assert np.abs(site[:3, 3] - data.site_xpos[k]).max() < CLOSE


#: Free and able to turn, each slowed; they begin turned.
SEVERAL = """<mujoco><compiler angle="radian"/><worldbody><frame pos="0.1 0.2 0.3" euler="0.3 0 0.4">
<body name="a" pos="0.4 0 1" quat="0.8 0.1 0.4 -0.35"><joint name="f" type="free" damping="0.7"/>
 <inertial pos="0.1 0 0.2" mass="2" diaginertia="0.3 0.4 0.5"/>
 <body name="b" pos="0 0 1"><joint name="s" type="ball" damping="0.2" armature="0.1"/>
  <inertial pos="0 0.3 0" mass="1" diaginertia="0.2 0.1 0.2"/></body></body></frame></worldbody></mujoco>"""


def test_free_and_ball_joints_begin_and_are_slowed_as_mujoco_s_are() -> None:
    """omega = E(pitch, roll) (yaw', pitch', roll') in the turned axes; v = G q': M' = G^T M G and so on."""
    made = convert(SEVERAL, Complaints())
    assert made is not None
    analysis = mbsym.loads(made.yaml, problems=())
    own = ModuleType("model")
    exec(render(analysis, ()), own.__dict__)  # our own generated module
    model = mujoco.MjModel.from_xml_string(SEVERAL)
    data = mujoco.MjData(model)
    assert {one.coordinate for one in analysis.system.initial} == {*own.COORDINATES}
    begun = {one.coordinate: float(written(one.position)) for one in analysis.system.initial if one.position}
    begin = np.array([begun.get(name, 0.0) for name in own.COORDINATES])
    mujoco.mj_forward(model, data)
    assert np.abs(own.frame_pose("b", begin, own.DEFAULTS)[:3, 3] - data.xpos[2]).max() < CLOSE
    assert np.abs(own.frame_pose("b", begin, own.DEFAULTS)[:3, :3] - data.xmat[2].reshape(3, 3)).max() < CLOSE
    held, _ = ours(SEVERAL.replace("</mujoco>", '<equality><weld body1="a"/></equality></mujoco>'))[1:]
    assert np.abs(held.constraints(begin, held.DEFAULTS)).max() < CLOSE
    source = np.random.default_rng(7)
    for _ in range(3):
        q, v = source.normal(size=(2, 9))
        slopes, step = np.zeros((9, 9)), 1e-20
        slopes[:3, :3] = np.eye(3)
        further = np.zeros((9, 9))
        for at in (3, 6):
            moved = q[at : at + 3] + 1j * step * v[at : at + 3]
            (_, p, r), block = moved, slice(at, at + 3)
            rows = [[-np.sin(p), 0, 1], [np.sin(r) * np.cos(p), np.cos(r), 0], [np.cos(r) * np.cos(p), -np.sin(r), 0]]
            slopes[block, block], further[block, block] = np.real(rows), np.imag(rows) / step
            turned = product_of_turns(*q[block])
            data.qpos[3 if at == 3 else 7 :][:4] = quaternion(turned)
        data.qpos[:3], data.qvel[:] = q[:3], slopes @ v
        mujoco.mj_forward(model, data)
        mass = whole(model, data)
        force = slopes.T @ (data.qfrc_passive - data.qfrc_bias - mass @ further @ v)
        assert np.abs(own.mass_matrix(q, own.DEFAULTS) - slopes.T @ mass @ slopes).max() < CLOSE * np.abs(mass).max()
        assert np.abs(own.forcing(q, v, own.DEFAULTS) - force).max() < CLOSE * np.abs(force).max()


def product_of_turns(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    found = np.eye(3)
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = math.cos(angle)
        turn[j, i], turn[i, j] = math.sin(angle), -math.sin(angle)
        found = found @ turn
    return found


@pytest.mark.parametrize(
    "tie",
    [
        '<joint joint1="y" joint2="z" polycoef="0.1 2 0.3 -0.4"/>',
        '<connect body1="a" body2="d" anchor="0.1 0 -0.8"/>',
        '<connect body1="d" anchor="0.1 0 -0.8"/>',
        '<connect site1="p" site2="s"/>',
    ],
)
def test_ties_are_mujoco_s(tie: str) -> None:
    """What MuJoCo pulls to zero is what the constraints are, up to signs and rows that are always zero."""
    text = TIED.format(tie)
    _, own, joints = ours(text)
    model = mujoco.MjModel.from_xml_string(text)
    data, source = mujoco.MjData(model), np.random.default_rng(4)
    assert joints == ("y", "x", "z")
    for _ in range(3):
        q = source.normal(size=3)
        for name, value in zip(joints, q, strict=True):
            data.joint(name).qpos[0] = value
        mujoco.mj_forward(model, data)
        theirs, found = (np.sort(np.abs(x)) for x in (data.efc_pos[: data.ne], own.constraints(q, own.DEFAULTS)))
        assert len(theirs) >= 1
        assert np.linalg.norm(theirs) == pytest.approx(np.linalg.norm(found), rel=CLOSE)


#: A chain of two hinges and a slide, and a body that it is welded to.
WELDED = """<mujoco><compiler angle="radian"/><worldbody>
<body name="a" pos="0.1 0 0"><joint name="x" axis="0 1 0"/>
 <inertial mass="1" pos="0 0 -1" diaginertia="0.1 0.1 0.1"/>
 <body name="b" pos="0 0.2 -1" euler="0.5 0 0"><joint name="z" type="slide" axis="1 0 0"/><joint name="u" axis="0 0 1"/>
  <inertial mass="1" pos="0 0 0" diaginertia="0.1 0.2 0.1"/><site name="p" pos="0.1 0 0" euler="0 0 1"/></body></body>
<body name="c" pos="0.5 0 0" euler="0 0.4 0"><joint name="e" type="slide" axis="1 0 0"/>
 <joint name="f" type="slide" axis="0 1 0"/><joint name="h" type="slide" axis="0 0 1"/><joint name="v" axis="0 1 0"/>
 <joint name="y" axis="1 0 0"/><joint name="n" axis="0 0 1"/>
 <inertial mass="2" pos="0 0 -0.7" diaginertia="0.1 0.1 0.1"/>
 <site name="s" pos="0 0.1 0" euler="1 0 0"/></body>
</worldbody><equality>{}</equality></mujoco>"""


@pytest.mark.parametrize(
    "weld",
    [
        '<weld body1="b" body2="c"/>',
        '<weld body1="b" body2="c" anchor="0.1 -0.2 0.3"/>',
        '<weld body1="c"/>',
        '<weld body1="b" body2="c" anchor="0.1 -0.2 0.3" relpose="{pose}"/>',
        '<weld site1="p" site2="s"/>',
    ],
)
def test_welds_hold_what_mujoco_s_hold(weld: str) -> None:
    """Where a weld holds ours does, and both leave the same velocities free: rows of their Jacobians span one space."""
    free = mujoco.MjModel.from_xml_string(WELDED.format(""))
    data, source = mujoco.MjData(free), np.random.default_rng(6)
    given = "{pose}" in weld
    if given:
        data.qpos[:] = source.normal(size=free.nq)
    mujoco.mj_kinematics(free, data)
    b, c = data.body("b"), data.body("c")
    anchor = c.xpos + c.xmat.reshape(3, 3) @ [0.1, -0.2, 0.3]
    pose = [*(b.xmat.reshape(3, 3).T @ (anchor - b.xpos)), *quaternion(b.xmat.reshape(3, 3).T @ c.xmat.reshape(3, 3))]
    text = WELDED.format(weld.format(pose=" ".join(map(repr, map(float, pose)))))
    model = mujoco.MjModel.from_xml_string(text)
    _, own, joints = ours(text)
    theirs = mujoco.MjData(model)
    theirs.qpos[:] = data.qpos
    mujoco.mj_forward(model, theirs)
    q = np.array([theirs.joint(name).qpos[0] for name in joints])
    n, found = len(q), np.array(own.constraints(q, own.DEFAULTS))
    if "site1" not in weld:  # those of the sites do not hold anywhere that is known
        assert np.allclose(theirs.efc_pos[: theirs.ne], 0, atol=1e-9)
        assert np.allclose(found, 0, atol=1e-9)
        step = 1e-6
        moved = [own.constraints(q + s * step * unit, own.DEFAULTS) for unit in np.eye(n) for s in (1, -1)]
        slopes = np.array(
            [(np.array(up) - down) / (2 * step) for up, down in zip(moved[::2], moved[1::2], strict=True)]
        ).T
        order = [model.joint(name).dofadr[0] for name in joints]
        rows = theirs.efc_J[: theirs.ne * model.nv].reshape(theirs.ne, model.nv)[:, order]
        for one, other in ((rows, slopes), (slopes, rows)):
            assert np.linalg.matrix_rank(np.vstack([one, other]), tol=1e-6) == np.linalg.matrix_rank(other, tol=1e-6)
    else:
        assert np.linalg.norm(found[:3]) == pytest.approx(np.linalg.norm(theirs.efc_pos[:3]), rel=CLOSE)
        first, second = (data.site(name).xmat.reshape(3, 3) for name in ("p", "s"))
        assert len(found) == 6
        parted = data.site("p").xpos + first[:, 0] - data.site("s").xpos - second[:, 1]
        assert found[5] == pytest.approx((parted @ parted - 2) / 2, rel=CLOSE)


@pytest.mark.parametrize(
    ("tie", "count"),
    [
        ('<weld body1="world" body2="c"/>', 6),
        ('<connect body1="world" body2="c" anchor="0.5 0.1 0"/>', 3),
        ('<weld body1="b" body2="c" torquescale="2"/>', 6),
        ('<weld body1="b" body2="c" torquescale="0"/>', 3),
        ('<weld site1="p" site2="s" torquescale="0"/>', 3),
    ],
)
def test_ties_to_the_world_and_without_weight_of_angles(tie: str, count: int) -> None:
    """As many conditions as the Jacobian has that MuJoCo makes of it."""
    text = WELDED.format(tie)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.linalg.matrix_rank(data.efc_J[: data.ne * model.nv].reshape(data.ne, model.nv)) == count
    _, own, joints = ours(text)
    found = np.array(own.constraints(np.zeros(len(joints)), own.DEFAULTS))
    assert len(found) == count
    if "site" not in tie:
        assert np.allclose(found, 0, atol=1e-9)


def quaternion(matrix: np.ndarray) -> np.ndarray:
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, matrix.flatten())
    return found
