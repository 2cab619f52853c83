"""How far a generated ``model.py`` is from Pinocchio's recursions for the same URDF, at random states.

As a program, for the benchmark (each prints a record):

    python tests/robots/agreement.py write UR5 FOLDER      # FOLDER/robot.yaml
    python tests/robots/agreement.py peer UR5              # Pinocchio's parse, CRBA and RNEA
    python tests/robots/agreement.py compare UR5 FOLDER    # FOLDER/reports/model.py beside it
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import math
import random
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pinocchio
from robots import ROBOTS

from mbsym.expressions.place import Complaints
from mbsym.source.robots import convert as robot_description
from mbsym.source.robots.reader import angle, is_nonnegative
from mbsym.source.robots.urdf import MOMENTS

GRAVITY = "9.81"


@dataclass(frozen=True)
class Converted:
    """A description, the URDF's joints in the order of its coordinates, and whether six of a base come before them."""

    yaml: str
    joints: tuple[str, ...]
    floating: bool

    @property
    def coordinates(self) -> int:
        return len(self.joints) + (6 if self.floating else 0)


def convert(text: str, floating: bool = False) -> Converted:
    """The description that ``mbsym convert`` writes, without the damping that Pinocchio's recursions leave out."""
    complaints = Complaints()
    made = robot_description(text, complaints, floating, damping=False)
    assert made is not None, [one.message for one in complaints]
    return Converted(made.yaml, made.joints, floating)


def urdf_files() -> dict[str, Path]:
    """The URDF files of the package ``example-robot-data`` by folders and name: ur_description/urdf/ur5_robot.

    Raises importlib.metadata.PackageNotFoundError where it is not installed.
    """
    listed = importlib.metadata.files("example-robot-data") or []
    return {
        "/".join((*file.parts[-3:-1], file.stem)): Path(str(file.locate())) for file in listed if file.suffix == ".urdf"
    }


def has_urdf_files() -> bool:
    """Whether that package is installed."""
    try:
        return bool(urdf_files())
    except importlib.metadata.PackageNotFoundError:
        return False


def peer(text: str, floating: bool) -> Any:
    """Pinocchio's model; a floating base has three displacements and yaw, pitch, roll, as the description has.

    Angles that are rounded multiples of pi are made exact here, too, and tensors that are negative are taken for zero:
    the question is the mechanics, not the rounding.
    """
    root = ElementTree.fromstring(text)
    for origin in root.iter("origin"):
        if "rpy" in origin.attrib:
            origin.set("rpy", " ".join(map(_radians, origin.attrib["rpy"].split())))
    for inertia in root.iter("inertia"):
        if not is_nonnegative(*(Fraction(inertia.attrib[part].strip()) for part in MOMENTS)):
            inertia.attrib.update(dict.fromkeys(MOMENTS, "0"))
    exact = ElementTree.tostring(root, encoding="unicode")
    if floating:
        base = pinocchio.JointModelComposite(pinocchio.JointModelTranslation())
        base.addJoint(pinocchio.JointModelSphericalZYX())
        model = pinocchio.buildModelFromXML(exact, base)
    else:
        model = pinocchio.buildModelFromXML(exact)
    model.gravity.linear = np.array([0.0, 0.0, -float(GRAVITY)])
    return model


def _radians(text: str) -> str:
    words = angle(text)
    if "pi" not in words:
        return text
    value, _, divisor = words.partition("/")
    factor = {"pi": "1", "-pi": "-1"}.get(value, value.partition("*")[0])
    return repr(math.pi * int(factor) / int(divisor or 1))


def loaded(path: Path) -> ModuleType:
    """A generated module."""
    spec = importlib.util.spec_from_file_location(f"generated_{path.parent.name.replace('-', '_')}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules.pop(spec.name, None)
    return module


def worst_difference(text: str, converted: Converted, module: ModuleType, states: int = 3, seed: int = 20) -> float:
    """The largest relative difference of M, of M a + h at random accelerations, of h, and of the gravity terms.

    h = C q' + g; each of the four is measured against its own largest entry, over all states.  To Pinocchio joints that
    mimic others are coordinates of their own: with v = G q' its matrix is reduced to G^T M G, its forces to G^T f.
    """
    model = peer(text, converted.floating)
    followers = mimics(text)
    data = model.createData()
    source = random.Random(seed)
    base = ["root_joint"] if converted.floating else []
    columns = [k for name in [*base, *converted.joints] for k in _velocities(model, name)]
    spread = np.zeros((model.nv, len(columns)))
    spread[columns, range(len(columns))] = 1
    for name, (leader, multiplier, _) in followers.items():
        if leader in converted.joints:
            spread[_velocities(model, name)] = multiplier * spread[_velocities(model, leader)]
    worst = 0.0
    for _ in range(states):
        q = _random(source, converted.coordinates, math.pi)
        v, a = _random(source, len(q), 1.0), _random(source, len(q), 1.0)
        there = pinocchio.neutral(model)
        speed, rate = spread @ v, spread @ a
        _place(model, there, base, q[: 6 * len(base)])
        for name, value in zip(converted.joints, q[6 * len(base) :], strict=True):
            _place(model, there, [name], [value])
        known = dict(zip(converted.joints, q[6 * len(base) :], strict=True))
        for name, (leader, multiplier, offset) in followers.items():
            _place(model, there, [name], [multiplier * known.get(leader, 0.0) + offset])
        mass = np.array(pinocchio.crba(model, data, there))
        mass = np.triu(mass) + np.triu(mass, 1).T
        theirs = (
            spread.T @ mass @ spread,
            spread.T @ pinocchio.rnea(model, data, there, speed, rate),
            spread.T @ pinocchio.rnea(model, data, there, speed, np.zeros(model.nv)),
            spread.T @ pinocchio.computeGeneralizedGravity(model, data, there),
        )
        own = np.array(module.mass_matrix(q, module.DEFAULTS))
        bias, rest = (
            -np.array(module.forcing(q, v, module.DEFAULTS)),
            -np.array(module.forcing(q, 0 * v, module.DEFAULTS)),
        )
        for first, second in zip((own, own @ a + bias, bias, rest), theirs, strict=True):
            worst = max(worst, float(np.abs(first - second).max() / (np.abs(second).max() or 1.0)))
    return worst


def regressor_rank(text: str, converted: Converted, states: int = 40) -> int:
    """The rank of Pinocchio's regressor of all standard parameters, stacked at random states; columns of length one."""
    model = peer(text, converted.floating)
    data, source = model.createData(), np.random.default_rng(5)
    rows = []
    for _ in range(states):
        there = pinocchio.neutral(model)
        for name, value in zip(converted.joints, source.normal(size=len(converted.joints)), strict=True):
            _place(model, there, [name], [value])
        v, a = source.normal(size=(2, model.nv))
        own = [k for name in converted.joints for k in _velocities(model, name)]
        still = np.setdiff1d(range(model.nv), own)
        v[still] = a[still] = 0
        rows.append(pinocchio.computeJointTorqueRegressor(model, data, there, v, a)[own])
    stacked = np.vstack(rows)
    lengths = np.linalg.norm(stacked, axis=0)
    return int(np.linalg.matrix_rank(stacked[:, lengths > 1e-9] / lengths[lengths > 1e-9], rtol=1e-9))


def worst_frame(text: str, converted: Converted, module: ModuleType) -> tuple[float, int]:
    """The largest difference of poses and Jacobians at a random state, and of how many frames."""
    model = peer(text, converted.floating)
    data, q = model.createData(), np.random.default_rng(6).normal(size=len(converted.joints))
    there = pinocchio.neutral(model)
    for name, value in zip(converted.joints, q, strict=True):
        _place(model, there, [name], [value])
    columns = [k for name in converted.joints for k in _velocities(model, name)]
    pinocchio.computeJointJacobians(model, data, there)
    pinocchio.framesForwardKinematics(model, data, there)
    worst, known = 0.0, [name for name in module.FRAMES if model.existFrame(name)]
    for name in known:
        number = model.getFrameId(name)
        pose = module.frame_pose(name, q, module.DEFAULTS) - data.oMf[number].homogeneous
        theirs = pinocchio.getFrameJacobian(model, data, number, pinocchio.LOCAL_WORLD_ALIGNED)[:, columns]
        slopes = module.frame_jacobian(name, q, module.DEFAULTS) - theirs
        worst = max(worst, float(np.abs(pose).max()), float(np.abs(slopes).max()))
    return worst, len(known)


def mimics(text: str) -> dict[str, tuple[str, float, float]]:
    """Joint: leader, multiplier and offset, chains of them followed to their first joint."""
    root = ElementTree.fromstring(text)
    told = {
        joint.attrib["name"]: (one.attrib["joint"], float(one.get("multiplier", 1)), float(one.get("offset", 0)))
        for joint in root.iter("joint")
        for one in joint.iter("mimic")
        if joint.get("type") != "fixed"
    }
    found = {}
    for name, (leader, multiplier, offset) in told.items():
        while leader in told:
            leader, factor, further = told[leader]
            offset += multiplier * further
            multiplier *= factor
        found[name] = leader, multiplier, offset
    return found


def _random(source: random.Random, count: int, bound: float) -> Any:
    return np.array([source.uniform(-bound, bound) for _ in range(count)])


def _velocities(model: Any, name: str) -> range:
    joint = model.joints[model.getJointId(name)]
    return range(joint.idx_v, joint.idx_v + joint.nv)


def _place(model: Any, there: Any, names: Sequence[str], values: Sequence[float]) -> None:
    """Writes coordinates into Pinocchio's configuration; a continuous joint has the cosine and the sine there."""
    for name in names:
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2 and joint.nv == 1:
            there[joint.idx_q : joint.idx_q + 2] = math.cos(values[0]), math.sin(values[0])
        else:
            there[joint.idx_q : joint.idx_q + joint.nq] = values


def main() -> None:
    what, name, *rest = sys.argv[1:]
    file, floating = ROBOTS[name]
    text = urdf_files()[file].read_text(encoding="utf-8")
    record: dict[str, Any] = {}
    if what == "write":
        converted = convert(text, floating)
        (Path(rest[0]) / "robot.yaml").write_text(converted.yaml, encoding="utf-8")
        record = {"coordinates": converted.coordinates}
    elif what == "peer":
        started = time.perf_counter()
        model = peer(text, floating)
        data, at_rest, zero = model.createData(), pinocchio.neutral(model), np.zeros(model.nv)
        pinocchio.crba(model, data, at_rest)
        pinocchio.rnea(model, data, at_rest, zero, zero)
        record = {"inside": time.perf_counter() - started}
    elif what == "compare":
        module = loaded(Path(rest[0]) / "reports" / "model.py")
        record = {"difference": worst_difference(text, convert(text, floating), module)}
    print(json.dumps(record))


if __name__ == "__main__":
    main()
