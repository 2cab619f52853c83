"""A robot's URDF as an mbsym description, by hand for the tests: one body a link, every number as it is printed.

    python tests/robots/urdf.py robot.urdf [--floating] > robot.yaml

A URDF joint puts the child's axes at ``origin`` (xyz, and the active rotation Rz(yaw) Ry(pitch) Rx(roll)) and then
turns them about, or moves them along, an axis of the child.  mbsym's rotations are passive and listed in the order of
turning, so that origin is ``{axes: [3, 2, 1], angles: [yaw, pitch, roll]}``, followed by the joint's own turn.  What
takes more than three turns gets massless frames in between; so does an axis that is no coordinate axis: turned onto the
third axis, the joint's turn, and turned back.

* ``fixed`` joints are bodies without coordinates; frames that carry no mass, nor anything that does, are left out.
* ``continuous`` and ``revolute`` joints are turns, ``prismatic`` ones displacements; limits, friction and damping are
  no part of the rigid model.  A joint that moves no inertia is held still at zero: no equation determines it.
* ``mimic`` is a constraint and is not imposed: such a joint is a coordinate of its own.
* A floating base has three displacements along the inertial axes and yaw, pitch, roll.
* Inertia tensors are about the mass centre.  Where they are given in turned axes, a body fixed to the link has them.
  Those that no body has (rounded, or made up) are accepted as they stand, but for those with which the kinetic energy
  could be negative (some are -5e-20): no description may have them, and they are taken for zero.

Angles that are a multiple of pi/4 or pi/6 rounded to the digits that were printed are spelled so.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

GRAVITY = "9.81"
#: Angles printed with fewer digits are not taken for a rounded part of pi: 0.5 is no pi/6.
FEWEST_DIGITS = 4

Texts = tuple[str, str, str]
NOWHERE: Texts = ("0", "0", "0")
#: The attributes of an inertia.
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


class UnsupportedError(ValueError):
    """A URDF with a joint that is no part of an open tree of turns and displacements."""


@dataclass(frozen=True)
class Inertial:
    """Mass, mass centre, turn (roll, pitch, yaw) of its axes, and tensor (xx, xy, xz, yy, yz, zz), as printed."""

    mass: str
    centre: Texts
    turned: Texts
    tensor: tuple[str, ...]


@dataclass(frozen=True)
class Joint:
    """One joint: ``origin``, ``turned`` (roll, pitch, yaw) in axes of ``parent``, ``axis`` in axes of ``child``."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Texts
    turned: Texts
    axis: Texts


@dataclass(frozen=True)
class Robot:
    """The tree of a URDF: links in order from the root; ``joints[link]`` leads to it."""

    name: str
    links: tuple[str, ...]
    joints: dict[str, Joint]
    inertials: dict[str, Inertial]


@dataclass(frozen=True)
class Converted:
    """``yaml`` is the description; ``joints[k]`` is the URDF's name of the k-th coordinate after those of the base."""

    yaml: str
    joints: tuple[str, ...]
    floating: bool

    @property
    def coordinates(self) -> int:
        return len(self.joints) + (6 if self.floating else 0)


# --- reading ---


def read(text: str) -> Robot:
    """The tree of links and joints.  Raises UnsupportedError for planar and floating joints, and for loops."""
    root = ElementTree.fromstring(text)
    joints: dict[str, Joint] = {}
    children: dict[str, list[str]] = {}
    for element in root.findall("joint"):
        joint = _joint(element)
        if joint.child in joints:
            raise UnsupportedError(f"link '{joint.child}' hangs on two joints")
        joints[joint.child] = joint
        children.setdefault(joint.parent, []).append(joint.child)
    links = [element.attrib["name"] for element in root.findall("link")]
    inertials = {
        element.attrib["name"]: _inertial(found)
        for element in root.findall("link")
        if (found := element.find("inertial")) is not None
    }
    (first,) = [name for name in links if name not in joints]
    ordered, waiting = [], [first]
    while waiting:
        link = waiting.pop()
        ordered.append(link)
        waiting += sorted(children.get(link, ()), reverse=True)
    return Robot(root.attrib.get("name", "robot"), tuple(ordered), joints, inertials)


def _joint(element: ElementTree.Element) -> Joint:
    name, kind = element.attrib["name"], element.attrib["type"]
    if kind not in ("fixed", "revolute", "continuous", "prismatic"):
        raise UnsupportedError(f"joint '{name}' is {kind}")
    parent, child, axis = element.find("parent"), element.find("child"), element.find("axis")
    assert parent is not None
    assert child is not None
    place, turned = _origin(element)
    along = _three("1 0 0" if axis is None else axis.attrib["xyz"])
    return Joint(name, kind, parent.attrib["link"], child.attrib["link"], place, turned, along)


def _inertial(element: ElementTree.Element) -> Inertial:
    mass, tensor = element.find("mass"), element.find("inertia")
    centre, turned = _origin(element)
    moments = ("0",) * 6 if tensor is None else tuple(tensor.attrib[part].strip() for part in MOMENTS)
    if not is_nonnegative(*map(Fraction, moments)):
        moments = ("0",) * 6
    return Inertial("0" if mass is None else mass.attrib["value"].strip(), centre, turned, moments)


def _origin(element: ElementTree.Element) -> tuple[Texts, Texts]:
    """(xyz, rpy) as printed."""
    found = element.find("origin")
    if found is None:
        return NOWHERE, NOWHERE
    return _three(found.attrib.get("xyz", "0 0 0")), _three(found.attrib.get("rpy", "0 0 0"))


def _three(text: str) -> Texts:
    first, second, third = text.split()
    return first, second, third


# --- numbers as text ---


def number(text: str) -> str:
    """The number as it is printed, in a form that descriptions accept; zero is 0."""
    value = Decimal(text)
    return "0" if value == 0 else f"{value.normalize():f}" if abs(value.adjusted()) < 6 else str(value.normalize())


def angle(text: str) -> str:
    """A multiple of pi/4 or pi/6, if ``text`` is one rounded to the digits that are printed; else the number."""
    value = Decimal(text)
    _, digits, exponent = value.as_tuple()
    assert isinstance(exponent, int)
    if len(digits) >= FEWEST_DIGITS:
        for part in (4, 6):
            turns = Fraction(round(float(value) / math.pi * part), part)
            if turns and abs(float(value) - float(turns) * math.pi) <= max(0.5 * 10.0**exponent, 1e-15):
                return multiple_of_pi(turns)
    return number(text)


def multiple_of_pi(turns: Fraction) -> str:
    """``-3*pi/4``."""
    up = {1: "pi", -1: "-pi"}.get(turns.numerator, f"{turns.numerator}*pi")
    return up if turns.denominator == 1 else f"{up}/{turns.denominator}"


def opposite(text: str) -> str:
    return text[1:] if text.startswith("-") else text if text == "0" else "-" + text


def is_zero(values: Texts) -> bool:
    return all(Decimal(value) == 0 for value in values)


# --- writing ---


def convert(text: str, floating: bool = False) -> Converted:
    """The description of a robot; ``floating`` frees its root link, which is otherwise fixed to the inertial frame."""
    return _Writer(read(text), floating).converted()


#: (axis, angle) of the turns that lead from a parent's axes to a child's.
Turns = list[tuple[int, str]]


class _Writer:
    """Writes body after body; coordinates are numbered q1, q2, ... in the order of the tree."""

    def __init__(self, robot: Robot, floating: bool) -> None:
        self.robot = robot
        self.floating = floating
        self.lines: list[str] = []
        self.joints: list[str] = []
        self.heavy = {link for link in robot.links if link in robot.inertials and not _empty(robot.inertials[link])}
        self.carrying = set(self.heavy)  # links that have inertia, or bear something that has
        for link in reversed(robot.links):
            if link in self.carrying and link in robot.joints:
                self.carrying.add(robot.joints[link].parent)

    def converted(self) -> Converted:
        for link in self.robot.links:
            if link in self.carrying:
                self._link(link)
        head = ["mbsym: 1", f"name: {json.dumps(self.robot.name)}", "bodies:"]
        loads = ["loads:", f"  - uniform gravity: {{acceleration: {GRAVITY}, direction: [0, 0, -1]}}"]
        return Converted("\n".join([*head, *self.lines, *loads]) + "\n", tuple(self.joints), self.floating)

    def _link(self, link: str) -> None:
        joint = self.robot.joints.get(link)
        if joint is None:
            turns: Turns = [(3, "yaw"), (2, "pitch"), (1, "roll")] if self.floating else []
            place = ("x", "y", "z") if self.floating else NOWHERE
            coordinates = ["x", "y", "z", "yaw", "pitch", "roll"] if self.floating else []
            self._body(link, "0", place, turns, coordinates, self._matter(link))
        else:
            self._moved(link, joint)
        inertial = self.robot.inertials.get(link)
        if inertial is not None and link in self.heavy and not is_zero(inertial.turned):
            turns = fixed_turns(inertial.turned)
            place = _numbers(inertial.centre)
            self._body(f"{link} inertial", link, place, turns, [], _matter(inertial, NOWHERE))

    def _matter(self, link: str) -> list[str]:
        """Mass, mass centre and inertia of a link, unless a frame of its own has them."""
        if link not in self.heavy or not is_zero(self.robot.inertials[link].turned):
            return ["mass: 0"]
        return _matter(self.robot.inertials[link], self.robot.inertials[link].centre)

    def _moved(self, link: str, joint: Joint) -> None:
        """The bodies that lead to a link over its joint."""
        turns, place, parent = fixed_turns(joint.turned), _numbers(joint.origin), joint.parent
        coordinates: list[str] = []
        if joint.kind != "fixed" and self._carries(link):
            self.joints.append(joint.name)
            name = f"q{len(self.joints)}"
            coordinates = [name]
            if joint.kind == "prismatic":
                if turns:
                    self._body(f"{link} origin", parent, place, turns, [], ["mass: 0"])
                    parent, place, turns = f"{link} origin", NOWHERE, []
                place = _displaced(place, joint.axis, name)
            else:
                turns = turns + turns_about(joint.axis, name)
        while len(turns) > 3:
            frame = f"{link} frame {len(turns)}"
            now, turns = turns[:3], turns[3:]
            here = [name for name in coordinates if any(name == words.removeprefix("-") for _, words in now)]
            self._body(frame, parent, place, now, here, ["mass: 0"])
            parent, place = frame, NOWHERE
            coordinates = [name for name in coordinates if name not in here]
        self._body(link, parent, place, turns, coordinates, self._matter(link), joint.name)

    def _carries(self, link: str) -> bool:
        return link in self.carrying

    def _body(
        self,
        name: str,
        parent: str,
        place: Texts,
        turns: Turns,
        coordinates: list[str],
        matter: list[str],
        joint: str = "",
    ) -> None:
        lines = [f"name: {_quoted(name)}", f"attached to: {parent if parent == '0' else _quoted(parent)}"]
        if place != NOWHERE:
            lines.append(f"connection point: {_list(place)}")
        if turns:
            axes, angles = _list([str(axis) for axis, _ in turns]), _list([words for _, words in turns])
            lines.append(f"rotation: {{axes: {axes}, angles: {angles}}}")
        if coordinates:
            comment = f"  # {joint}" if joint and joint.isprintable() else ""
            lines.append(f"coordinates: {_list(coordinates)}{comment}")
        self.lines += [f"  {'-' if k == 0 else ' '} {line}" for k, line in enumerate([*lines, *matter])]


def fixed_turns(rpy: Texts) -> Turns:
    """Roll, pitch, yaw (active, about fixed axes) as passive turns in the order yaw, pitch, roll."""
    roll, pitch, yaw = map(angle, rpy)
    return [(axis, words) for axis, words in ((3, yaw), (2, pitch), (1, roll)) if words != "0"]


def turns_about(axis: Texts, name: str) -> Turns:
    """The turn by ``name`` about an axis: e_3 = Ry(b) Rz(a) turned onto it, where it is no coordinate axis."""
    x, y, z = map(float, axis)
    along = [k for k, value in enumerate((x, y, z), start=1) if value != 0]
    if len(along) == 1:
        positive = (x, y, z)[along[0] - 1] > 0
        return [(along[0], name if positive else f"-{name}")]
    azimuth, slope = number(repr(math.atan2(y, x))), number(repr(math.atan2(math.hypot(x, y), z)))
    return [
        turn
        for turn in ((3, azimuth), (2, slope), (3, name), (2, opposite(slope)), (3, opposite(azimuth)))
        if turn[1] != "0"
    ]


def _displaced(place: Texts, axis: Texts, name: str) -> Texts:
    """place + axis*name; the axis has length one."""
    components = list(map(float, axis))
    length = math.hypot(*components)
    moved = []
    for value, component in zip(place, components, strict=True):
        if component == 0:
            moved.append(value)
            continue
        size = number(repr(abs(component) / length))
        step = name if size == "1" else f"{size}*{name}"
        sign = "-" if component < 0 else "+"
        moved.append((sign.strip("+") + step) if value == "0" else f"{value} {sign} {step}")
    return moved[0], moved[1], moved[2]


def _empty(found: Inertial) -> bool:
    return all(Decimal(value) == 0 for value in (found.mass, *found.tensor))


def _matter(found: Inertial, centre: Texts) -> list[str]:
    xx, xy, xz, yy, yz, zz = map(number, found.tensor)
    lines = [] if is_zero(centre) else [f"mass centre: {_list(_numbers(centre))}"]
    lines.append(f"mass: {number(found.mass)}")
    if any(value != "0" for value in (xx, xy, xz, yy, yz, zz)):
        rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        tensor = _list([xx, yy, zz]) if (xy, xz, yz) == NOWHERE else _list([_list(row) for row in rows])
        real = is_of_a_body(*map(Fraction, (xx, xy, xz, yy, yz, zz)))
        lines.append("inertia about: mass centre")
        lines.append(f"inertia: {tensor if real else f'{{tensor: {tensor}, accept: true}}'}")
    return lines


def is_of_a_body(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether the second moments tr(J)/2 1 - J are positive semidefinite."""
    half = (xx + yy + zz) / 2
    return is_nonnegative(half - xx, -xy, -xz, half - yy, -yz, half - zz)


def is_nonnegative(xx: Fraction, xy: Fraction, xz: Fraction, yy: Fraction, yz: Fraction, zz: Fraction) -> bool:
    """Whether a symmetric matrix is positive semidefinite: all its principal minors are nonnegative."""
    pairs = (xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz)
    whole = xx * yy * zz + 2 * xy * xz * yz - xx * yz * yz - yy * xz * xz - zz * xy * xy
    return all(minor >= 0 for minor in (xx, yy, zz, *pairs, whole))


def _numbers(values: Texts) -> Texts:
    first, second, third = map(number, values)
    return first, second, third


def _list(items: list[str] | Texts) -> str:
    return "[" + ", ".join(items) + "]"


def _quoted(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z_][\w -]*", name) else json.dumps(name)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--floating", action="store_true", help="free the root link")
    given = parser.parse_args()
    sys.stdout.write(convert(given.file.read_text(encoding="utf-8"), given.floating).yaml)


if __name__ == "__main__":
    main()
