"""Accelerations of closed loops against Pinocchio's constraint models and MuJoCo's Jacobians, at random states.

Pinocchio solves its own equations (proximal, to 1e-13).  MuJoCo's constraints are soft: M, the bias forces and J are
its own, J' q' follows from J at neighbouring states, and the accelerations from all rows by singular values.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="needs the extra 'robots'")
pinocchio = pytest.importorskip("pinocchio", reason="needs the extra 'robots'")
if not hasattr(mujoco, "MjModel") or not hasattr(pinocchio, "RigidConstraintModel"):
    pytest.skip("needs MuJoCo 3 and Pinocchio 3", allow_module_level=True)

from test_mujoco import ours, whole  # noqa: E402

CLOSE = 1e-10


def link(name: str, place: str, joint: str, inner: str = "") -> str:
    return f"""<body name="{name}" pos="{place}"><joint name="q_{name}" {joint}/>
     <inertial mass="1.3" pos="0.1 -0.2 -0.4" fullinertia="0.2 0.25 0.3 0.02 -0.03 0.01"/>{inner}</body>"""


def chain(name: str, base: str, joints: list[str], step: str = "0.1 0.2 -0.9") -> str:
    """Links one behind the other; every joint but the first stands where the link before ends."""
    inner = ""
    for k, joint in reversed(list(enumerate(joints))):
        inner = link(f"{name}{k}", step if k else base, joint, inner)
    return inner


X, Y, Z = 'axis="1 0 0"', 'axis="0 1 0"', 'axis="0 0 1"'
SLIDE, SKEW = 'type="slide" axis="1 0.5 0"', 'axis="1 2 -1"'


def document(bodies: str, *ties: str) -> str:
    """All in one body that does not move: Pinocchio reads the first one only."""
    return f"""<mujoco><compiler angle="radian"/><option gravity="0.4 -0.2 -9.81"/>
    <worldbody><body name="base">{bodies}</body></worldbody><equality>{"".join(ties)}</equality></mujoco>"""


#: What is tied: (kind, first body, second body, the place in the first one).
Tie = tuple[str, str, str, tuple[float, float, float]]


def tied(bodies: str, *ties: Tie) -> tuple[str, tuple[Tie, ...]]:
    rows = [
        f'<{kind} body1="{first}" body2="{second}" anchor="{" ".join(map(str, place))}"/>'
        for kind, first, second, place in ties
    ]
    return document(bodies, *rows), ties


#: Name: the loops, how many velocities they leave.  A planar loop in space has three rows of rank two.
LOOPS = {
    "four-bar": (
        tied(chain("a", "0 0 0", [Y, Y]) + chain("b", "0.8 0 0", [Y]), ("connect", "a1", "b0", (0.1, 0, -1))),
        1,
    ),
    "seven hinges": (
        tied(
            chain("a", "0 0 0", [X, Y, Z, SKEW]) + chain("b", "0.5 0.3 0", [Y, X, SKEW]),
            ("weld", "a3", "b2", (0, 0, 0)),
        ),
        1,
    ),
    "platform": (
        tied(
            chain("a", "0 0 0", [X, Y, Z]) + chain("b", "1 0 0", [Y, X, SLIDE]) + chain("c", "0 1 0", [X, Y, SKEW]),
            ("connect", "a2", "b2", (0.3, 0.1, -0.2)),
            ("connect", "a2", "c2", (-0.2, 0.4, 0.1)),
        ),
        3,
    ),
    "parallelogram with a third crank": (
        tied(
            chain("a", "0 0 0", [Y, Y], "0 0 -1") + chain("b", "0.7 0 0", [Y]) + chain("c", "1.9 0 0", [Y]),
            ("connect", "a1", "b0", (0.7, 0, 0)),
            ("connect", "a1", "c0", (1.9, 0, 0)),
        ),
        1,
    ),
}


def peer_of(text: str, ties: tuple[Tie, ...], model: Any, path: Path) -> tuple[Any, list[Any]]:
    """Pinocchio's model of the same file, and a constraint model for each tie, with places from MuJoCo's start."""
    path.write_text(text.split("<equality>")[0] + "</mujoco>", encoding="utf-8")
    robot = pinocchio.buildModelFromMJCF(str(path))
    robot.gravity.linear = np.array(model.opt.gravity)
    data = robot.createData()
    pinocchio.forwardKinematics(robot, data, np.zeros(robot.nq))
    made = []
    for kind, first, second, place in ties:
        one, other = (robot.getJointId(f"q_{name}") for name in (first, second))
        here = pinocchio.SE3(np.eye(3), np.array(place))
        there = data.oMi[other].inverse() * data.oMi[one] * here
        contact = pinocchio.ContactType.CONTACT_6D if kind == "weld" else pinocchio.ContactType.CONTACT_3D
        made.append(pinocchio.RigidConstraintModel(contact, robot, one, here, other, there))
    return robot, made


@pytest.mark.parametrize("name", LOOPS)
def test_accelerations_on_loops(name: str, tmp_path: Path) -> None:
    (text, ties), free = LOOPS[name]
    _, own, joints = ours(text)
    model = mujoco.MjModel.from_xml_string(text)
    robot, ties_there = peer_of(text, ties, model, tmp_path / "robot.xml")
    data, n = mujoco.MjData(model), len(joints)
    order = [model.joint(joint).dofadr[0] for joint in joints]
    places = [robot.joints[robot.getJointId(joint)].idx_v for joint in joints]

    def jacobian(q: np.ndarray) -> np.ndarray:
        data.qpos[order] = q
        mujoco.mj_forward(model, data)
        return data.efc_J[: data.ne * model.nv].reshape(data.ne, model.nv)[:, order].copy()

    source = np.random.default_rng(3)
    for _ in range(3):
        wanted = np.concatenate([source.normal(scale=0.15, size=n), source.normal(size=n)])
        state = own.consistent(wanted, own.DEFAULTS)
        q, v, torque = state[:n], state[n:], source.normal(size=n)
        found = own.forward_dynamics(q, v, torque, own.DEFAULTS)

        # MuJoCo
        h = 2e-3  # differences of order 4
        rate = (8 * (jacobian(q + h * v) - jacobian(q - h * v)) - jacobian(q + 2 * h * v) + jacobian(q - 2 * h * v)) / (
            12 * h
        )
        rows = jacobian(q)
        assert np.linalg.matrix_rank(rows, tol=1e-9) == n - free
        data.qvel[order] = v
        mujoco.mj_forward(model, data)
        mass, forces = whole(model, data)[np.ix_(order, order)], torque - data.qfrc_bias[order]
        assert np.abs(rows @ v).max() < CLOSE
        inverse = np.linalg.inv(mass)
        multipliers = np.linalg.pinv(rows @ inverse @ rows.T, rcond=1e-10) @ (-rate @ v - rows @ inverse @ forces)
        theirs = inverse @ (forces + rows.T @ multipliers)
        assert np.abs(found - theirs).max() < CLOSE * np.abs(theirs).max()

        # Pinocchio
        there, moving, pushed = (np.zeros(robot.nv) for _ in range(3))
        there[places], moving[places], pushed[places] = q, v, torque
        settings, own_data = pinocchio.ProximalSettings(1e-13, 1e-13, 1e-10, 100), robot.createData()
        ties_data = [tie.createData() for tie in ties_there]
        from_4 = [ties_data] if pinocchio.__version__ >= "4" else []  # an argument more
        pinocchio.initConstraintDynamics(robot, own_data, ties_there, *from_4)
        result = pinocchio.constraintDynamics(robot, own_data, there, moving, pushed, ties_there, ties_data, settings)
        assert np.abs(found - result[places]).max() < CLOSE * np.abs(theirs).max()


def test_a_wrong_number_is_seen() -> None:
    """The comparison is no formality: a link that is a micrometre longer."""
    (text, _), _ = LOOPS["four-bar"]
    _, own, _ = ours(text)
    _, other, _ = ours(text.replace('pos="0.1 0.2 -0.9"', 'pos="0.1 0.2 -0.900001"'))
    state = own.consistent([0.1, -0.1, 0.05, 0.3, 0.2, 0.1], own.DEFAULTS)
    first, second = (
        module.forward_dynamics(state[:3], state[3:], np.zeros(3), module.DEFAULTS) for module in (own, other)
    )
    assert np.abs(first - second).max() > 100 * CLOSE * np.abs(first).max()
