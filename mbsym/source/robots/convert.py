"""The text of a robot's file to a description; which of the two formats it is, its first element says."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from mbsym.expressions.place import Complaints
from mbsym.source.robots.describe import describe
from mbsym.source.robots.mjcf import read_mjcf
from mbsym.source.robots.reader import include, parsed
from mbsym.source.robots.urdf import read_urdf

_BEFORE = re.compile(r"\s*+(?:<\?xml[^>]*\?>)?\s*+")
_ROOT = re.compile(r"<(robot|mujoco)\b")
_LOOK = 20_000


@dataclass(frozen=True)
class Converted:
    """``yaml`` is the description; ``joints`` the file's joints in the order of the coordinates after a free base's.

    ``left_out`` says what of the file the description has no place for; ``still`` which joints move no inertia;
    ``snapped`` which printed angles are read as parts of pi.
    """

    yaml: str
    joints: tuple[str, ...]
    left_out: tuple[str, ...] = ()
    still: tuple[str, ...] = ()
    snapped: tuple[str, ...] = ()


def is_robot(text: str) -> bool:
    """Whether a text is a robot's file, URDF or MJCF."""
    text = text[:_LOOK].removeprefix("\ufeff")
    start = _BEFORE.match(text)
    assert start is not None
    text = text[start.end() :]
    while text.startswith("<!--"):  # one after the other: a comment ends at the first -->
        text = text.partition("-->")[2].lstrip()
    return _ROOT.match(text) is not None


def convert(
    text: str,
    complaints: Complaints,
    floating: bool = False,
    symbols: bool = False,
    damping: bool = True,
    exact_angles: bool = False,
    inputs: bool = True,
    beside: Callable[[str], str | None] | None = None,
    joint_names: bool = False,
) -> Converted | None:
    """The description of a robot, or None with complaints.  The options are those of :func:`describe`.

    Angles in radians that are parts of pi, rounded to the digits that are printed, are read as these, or with
    ``exact_angles`` left as they are.  ``beside`` gives the text of a file that MJCF includes, by the name that it is
    called there.
    """
    root = parsed(text, complaints)
    if root is None:
        return None
    if beside is not None and root.tag == "mujoco":
        include(root, beside, complaints, set())
    robot = (read_mjcf if root.tag == "mujoco" else read_urdf)(root, complaints, exact_angles)
    if robot is None or complaints.errors:
        return None
    made = describe(robot, floating, symbols, damping, inputs, joint_names)
    return Converted(made.yaml, made.joints, robot.left_out, made.still, robot.snapped)
