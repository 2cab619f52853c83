"""A robot's file as a description in YAML: one body a link, massless frames where one does not suffice.

* Links without inertia are massless bodies: frames that formulas and reports can name.  A joint that moves no inertia
  is held still at zero, as no equation determines it.
* A tensor in axes of its own, or a second inertia, is a body fixed to the link.
* Tensors that no body has (rounded, or made up) are accepted as they stand.
* A driven joint has an input, the torque or force in it.
* The inertia of a rotor turns by the joint's coordinate in the inertial frame: T has armature q'^2/2 more.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction

from mbsym.expressions.place import Complaints
from mbsym.expressions.rates import is_rate
from mbsym.source.bodies import is_body_name
from mbsym.source.robots.mjcf import read_mjcf
from mbsym.source.robots.reader import NOWHERE, Texts, include, is_of_a_body, opposite, parsed
from mbsym.source.robots.robot import (
    GROUND,
    Inertial,
    Joint,
    JointTie,
    Link,
    Moving,
    PointTie,
    Robot,
    Shape,
    Step,
    steps,
)
from mbsym.source.robots.urdf import read_urdf
from mbsym.source.scope import MAX_NAME, why_no_name
from mbsym.source.yaml_writer import scalar_text

_NUMBER = re.compile(r"[0-9.eE+-]+\Z")
#: What the names of a joint's coordinates end in, where it has several.
_SEVERAL = {
    "free": ("x", "y", "z", "yaw", "pitch", "roll"),
    "ball": ("yaw", "pitch", "roll"),
    "planar": ("x", "y", "yaw"),
}
#: Names that are made here: of coordinates, inputs, parameters.
_OWN = re.compile(r"[qpcmJbk]\d+[a-z]*|g|x|y|z|yaw|pitch|roll|tau_.*")
#: The link that is the ground itself, as ROS has it.
_WORLD = "world"


@dataclass(frozen=True)
class Described:
    """``yaml`` is the description; ``joints`` the file's joints, in the order of the coordinates after a free base's.

    ``frames`` counts the massless frames, ``still`` the joints that move no inertia.
    """

    yaml: str
    joints: tuple[str, ...]
    frames: int
    still: tuple[str, ...]


def describe(
    robot: Robot,
    floating: bool = False,
    symbols: bool = False,
    damping: bool = True,
    inputs: bool = True,
    joint_names: bool = False,
) -> Described:
    """The description of a robot.

    ``floating`` frees its first link, which otherwise stands on the ground; with ``symbols`` masses, lengths and
    moments are named parameters with the printed values; ``damping``: dampers and springs of joints are loads;
    ``inputs``: driven joints have one, their torque or force; with ``joint_names`` coordinates are called as the joints
    where descriptions may have such a name.
    """
    return _Writer(robot, floating, symbols, damping, inputs, joint_names).described()


@dataclass
class _Writer:
    robot: Robot
    floating: bool
    symbols: bool
    damping: bool
    driven: bool
    named: bool
    bodies: list[str] = field(default_factory=list)
    parameters: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)
    limits: list[str] = field(default_factory=list)
    inputs: list[str] = field(default_factory=list)
    initial: dict[str, str] = field(default_factory=dict)  # of all coordinates
    constraints: list[str] = field(default_factory=list)
    joints: list[str] = field(default_factory=list)
    still: list[str] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)  # of the file's links
    taken: set[str] = field(default_factory=set)
    stems: set[str] = field(default_factory=set)  # coordinates that are called as their joints
    leading: dict[str, str] = field(default_factory=dict)  # the coordinates of joints that others may follow
    refs: dict[str, str] = field(default_factory=dict)
    frames: int = 0

    def described(self) -> Described:
        links = self._numbered(self._carrying())
        if any(part != "0" for part in self.robot.gravity):
            self._load(f"uniform gravity: {{{self._gravity()}}}")
        for link, stems in links:
            if self._is_ground(link):
                self.names[link.name] = GROUND
            else:
                self._link(link, stems)
        for tie in self.robot.ties:
            self._tie(tie)
        head = [f"# From the robot '{self._comment(self.robot.name)}'."]
        if self.robot.left_out:
            head.append(f"# Left out: {self._comment('; '.join(self.robot.left_out))}.")
        if self.robot.snapped:
            head.append(f"# Printed angles read as parts of pi: {self._comment('; '.join(self.robot.snapped))}.")
        if self.still:
            head.append(f"# Held still, because they move no inertia: {self._comment(', '.join(self.still))}.")
        lines = [*head, "mbsym: 1", f"name: {scalar_text(self.robot.name)}"]
        if self.robot.left_out or self.still:
            lines.append(f"description: {scalar_text(self._told())}")
        lines += ["parameters:", *self.parameters] if self.parameters else []
        lines += ["inputs:", *self.inputs] if self.inputs else []
        lines += ["bodies:", *self.bodies]
        lines += ["loads:", *self.loads] if self.loads else []
        lines += ["constraints:", *self.constraints] if self.constraints else []
        lines += ["limits:", *self.limits] if self.limits else []
        if any(at != "0" for at in self.initial.values()):
            lines += ["initial:", *(f"  {name}: {at}" for name, at in self.initial.items())]
        return Described("\n".join(lines) + "\n", tuple(self.joints), self.frames, tuple(self.still))

    def _told(self) -> str:
        """What reports have to say besides: what of the file is no part of the model."""
        sentences = []
        if self.robot.left_out:
            sentences.append(f"Of the robot's file is left out: {'; '.join(self.robot.left_out)}.")
        if self.still:
            sentences.append(f"Held still, because they move no inertia, are the joints {', '.join(self.still)}.")
        return self._comment(" ".join(sentences))

    def _numbered(self, carrying: set[str]) -> list[tuple[Link, list[str]]]:
        """The links with the joints that move, and what the coordinates of these begin with, "" where one is led."""
        driving = {
            joint.led[0] for link in self.robot.links if link.name in carrying for joint in link.joints if joint.led
        }
        links, count = [], 0
        for link in self.robot.links:
            moves = link.name in carrying
            joints = tuple(
                joint
                for joint in link.joints
                if moves or joint.led or joint.name in driving or joint.armature != "0"  # the rotor moves by itself
            )
            self.still += [joint.name for joint in link.joints if joint not in joints]
            stems = []
            for joint in joints:
                count += joint.led is None
                stems.append(self._stem(joint, count) if joint.led is None else "")
            self.refs |= {joint.name: joint.ref for joint in joints}
            self.leading |= dict(zip((joint.name for joint in joints), stems, strict=True))
            links.append((replace(link, joints=joints), stems))
        return links

    def _stem(self, joint: Joint, count: int) -> str:
        """What a joint's coordinate is called: by its number, or as the joint where nothing else can be called so."""
        name = "_".join(re.findall("[A-Za-z0-9]+", joint.name))
        several = joint.kind in _SEVERAL
        if not self.named or several or why_no_name(name) or _OWN.fullmatch(name) or name in self.stems:
            return f"q{count}"
        self.stems.add(name)
        return name

    def _is_ground(self, link: Link) -> bool:
        """Whether a link is but a name of the ground: that of a URDF which is called ``world``."""
        alone = (
            link.parent == GROUND
            and link.name == _WORLD
            and link.name == self.robot.links[0].name
            and not self.floating
        )
        others = any(other.parent == GROUND for other in self.robot.links[1:])
        return alone and not (others or link.joints or link.inertials or link.shapes)

    @staticmethod
    def _comment(text: str) -> str:
        return "".join(character if character.isprintable() else " " for character in text)

    def _carrying(self) -> set[str]:
        """Links that have inertia, or bear something that has: no equation determines how the others move."""
        carrying = {link.name for link in self.robot.links if _weighs(link)}
        for link in reversed(self.robot.links):
            if link.name in carrying:
                carrying.add(link.parent)
        return carrying or {link.name for link in self.robot.links[:1]}

    # --- loads ---

    def _load(self, text: str) -> None:
        self.loads.append(f"  - {text}")

    def _gravity(self) -> str:
        known = [part for part in self.robot.gravity if part != "0"]
        if len(known) > 1:
            return f"vector: {_list(self.robot.gravity)}"
        size = self._named("g", known[0].lstrip("-"), "acceleration of gravity")
        direction = ["0" if part == "0" else "-1" if part.startswith("-") else "1" for part in self.robot.gravity]
        return f"acceleration: {size}, direction: {_list(direction)}"

    # --- ties ---

    def _tie(self, tie: JointTie | PointTie) -> None:
        if isinstance(tie, PointTie):
            bodies = [self.names.get(link, GROUND) for link in (tie.first, tie.second)]
            bodies = [name if name == GROUND else scalar_text(name) for name in bodies]

            def ends(key: str, pair: tuple[Texts, Texts]) -> str:
                return ", ".join(f"{{body: {x}, {key}: {_list(y)}}}" for x, y in zip(bodies, pair, strict=True))

            self.constraints.append(f"  - coincide: [{ends('point', (tie.first_point, tie.second_point))}]")
            if tie.axes is not None and tie.apart is not None:
                self.constraints.append(f"  - parallel: [{ends('axis', tie.axes)}]")
                between = f"between: [{ends('point', tie.apart)}]"
                self.constraints.append(f"  - distance: {{{between}, length: sqrt(2)}}")
            return
        left, right = self._deviation(tie.first), self._deviation(tie.second)
        powers = ["", f"*({right})", *(f"*({right})**{k}" for k in range(2, len(tie.coefficients)))]
        terms = [f"({x}){power}" for x, power in zip(tie.coefficients, powers, strict=False) if x != "0"]
        self.constraints.append(f"  - relation: {left} = {' + '.join(terms) or '0'}")

    def _deviation(self, joint: str) -> str:
        """A joint's coordinate less what it is at zero; "0" of one that is held still."""
        name = self.leading.get(joint, "")
        return _linear("1", name, opposite(self.refs[joint])) if name else "0"

    # --- bodies ---

    def _link(self, link: Link, stems: list[str]) -> None:
        moving = [self._moving(joint, stem) for joint, stem in zip(link.joints, stems, strict=True)]
        place, turned = link.place, link.turned
        if (
            self.floating
            and link.name == self.robot.links[0].name
            and not any(joint.kind == "free" for joint in link.joints)
        ):
            moving.insert(0, Moving(Joint("", "free"), _SEVERAL["free"]))
            self.initial |= dict.fromkeys(_SEVERAL["free"], "0")
        if any(motion.joint.kind == "free" and motion.joint.start for motion in moving):
            # Its coordinates say where it is, from the ground, whatever frame it stands in.
            place, turned, link = NOWHERE, (), replace(link, parent=GROUND)
        number = len(self.names) + 1
        *before, last = steps(
            self._lengths(place, f"p{number}", f"origin of {link.name} on its carrier"), turned, tuple(moving)
        )
        parent = self.names.get(link.parent, GROUND)
        for index, step in enumerate(before, 1):
            frame = self._free_name(f"{link.name} frame {index}")
            self._body(frame, parent, step, ["mass: 0"])
            self.frames += 1
            parent = frame
        own = self.names[link.name] = self._free_name(link.name)
        first, *others = link.inertials or (Inertial("0"),)
        matter, apart = (["mass: 0"], [first]) if first.turned else (self._matter(first, number, link.name), [])
        self._body(own, parent, last, matter, link)
        for inertial in [*apart, *others]:
            if not _is_nothing(inertial):
                name = self._free_name(f"{link.name} inertial")
                there = Step(
                    self._lengths(inertial.centre, f"c{number}", f"mass centre of {link.name}"), inertial.turned
                )
                self._body(name, own, there, self._matter(inertial, number, link.name, apart=True))
        for motion in moving:
            if motion.joint.armature != "0":
                self._rotor(motion)

    def _rotor(self, moving: Moving) -> None:
        """A body without mass whose angular velocity is q': T has armature |q'|^2/2, and nothing else feels it."""
        joint = moving.joint
        size = self._named(f"Ja{moving.names[0][1:]}", joint.armature, f"inertia of the rotor of joint {joint.name}")
        turns = ((3, moving.value),) if moving.value else tuple(zip((3, 2, 1), moving.names[-3:], strict=True))
        tensor = ["0", "0", size] if moving.value else [size] * 3
        accept = f"{{tensor: {_list(tensor)}, accept: true}}" if moving.value else _list(tensor)
        matter = ["mass: 0", "inertia about: mass centre", f"inertia: {accept}"]
        self._body(self._free_name(f"rotor of {joint.name}"), GROUND, Step(turns=turns), matter)

    def _free_name(self, preferred: str) -> str:
        """A name that a body may have and no other has."""
        name = re.sub(r"[^\w ./-]", "-", preferred, flags=re.ASCII)[:60]
        name = name if is_body_name(name) else f"link {name}"
        free_name, index = name, 2
        while free_name in self.taken:
            free_name, index = f"{name} {index}", index + 1
        self.taken.add(free_name)
        return free_name

    def _moving(self, joint: Joint, stem: str) -> Moving:
        if joint.led is not None:
            leader, multiplier, offset = joint.led
            first = self.leading.get(leader, "")
            if not first:  # it is fixed, or held still, at zero
                multiplier = "0"
            if (
                self.damping and joint.damping != "0" and multiplier != "0"
            ):  # R = b q'^2/2 at q' = multiplier * that of the leading joint
                factor = "" if multiplier in ("1", "-1") else f"*({multiplier})**2"
                self._load(f"damper: {{coordinate: {first}, coefficient: {joint.damping}{factor}}}")
            return Moving(joint, (), _linear(multiplier, first, offset))
        names = self._coordinates(joint, stem)
        self.initial |= dict(zip(names, joint.start or ("0",) * len(names), strict=True))
        if joint.kind == "planar":
            return Moving(joint, names, names[2])
        return Moving(joint, names, _linear("1", names[0], opposite(joint.ref)) if len(names) == 1 else "")

    def _coordinates(self, joint: Joint, stem: str) -> tuple[str, ...]:
        self.joints.append(joint.name)
        number = len(self.joints)
        if joint.kind in _SEVERAL:
            names = tuple(f"{stem}{part}" for part in _SEVERAL[joint.kind])
            if self.damping and joint.damping != "0":  # R = b (v^2 + omega^2)/2
                value = self._named(f"b{number}", joint.damping, f"damping of joint {joint.name}")
                squares = " + ".join(f"{name}_dot**2" for name in names)
                yaw, pitch, roll = names[-3:]
                self._load(f"rayleigh: {value}*({squares} - 2*{yaw}_dot*{roll}_dot*sin({pitch}))/2")
            return names
        if joint.limits is not None:
            self.limits.append(f"  {stem}: {_list(joint.limits)}{self._note(joint.name)}")
        if self.damping and joint.damping != "0":
            value = self._named(f"b{number}", joint.damping, f"damping of joint {joint.name}")
            self._load(f"damper: {{coordinate: {stem}, coefficient: {value}}}")
        if self.damping and joint.stiffness != "0":
            value = self._named(f"k{number}", joint.stiffness, f"stiffness of joint {joint.name}")
            rest = "" if joint.rest == "0" else f", rest: {joint.rest}"
            self._load(f"spring: {{coordinate: {stem}, stiffness: {value}{rest}}}")
        if self.driven and joint.driven:
            self._input(joint, stem)
        return (stem,)

    def _input(self, joint: Joint, stem: str) -> None:
        """The joint's torque or force: tau in  M q'' + ... = tau."""
        what, unit = ("torque", "N*m") if joint.kind == "turn" else ("force", "N")
        most = f", at most {joint.effort} {unit}" if joint.effort else ""
        name = self._input_name(joint.name)
        self.inputs.append(
            f"  {name}: {{meaning: {scalar_text(self._comment(f'{what} in joint {joint.name}{most}'))}}}"
        )
        self._load(f"generalized force: {{{stem}: {name}}}")

    def _input_name(self, joint: str) -> str:
        """``tau_`` and the joint's name, as descriptions take it: letters, digits and single underscores."""
        name = "_".join(["tau", *re.findall("[A-Za-z0-9]+", joint)])[: MAX_NAME - 10].rstrip("_")
        name = f"{name}_joint" if is_rate(name) else name
        free_name, index = name, 2
        while any(line.startswith(f"  {free_name}:") for line in self.inputs):
            free_name, index = f"{name}_{index}", index + 1
        return free_name

    def _note(self, name: str) -> str:
        return f" # {self._comment(name)}" if name else ""

    def _body(self, name: str, parent: str, step: Step, matter: list[str], link: Link | None = None) -> None:
        lines = [f"name: {scalar_text(name)}", f"attached to: {parent if parent == GROUND else scalar_text(parent)}"]
        if step.place != NOWHERE:
            lines.append(f"connection point: {_list(step.place)}")
        if step.turns:
            axes, angles = _list([str(axis) for axis, _ in step.turns]), _list([words for _, words in step.turns])
            lines.append(f"rotation: {{axes: {axes}, angles: {angles}}}")
        if step.coordinates:
            note = (
                self._note(", ".join(joint.name for joint in link.joints if joint.led is None))
                if link is not None
                else ""
            )
            lines.append(f"coordinates: {_list(list(dict.fromkeys(step.coordinates)))}{note}")
        lines += matter
        if link is not None and link.shapes:
            lines += ["shapes:", *(f"  - {_shape(shape)}" for shape in link.shapes)]
        self.bodies += [f"  {'-' if k == 0 else ' '} {line}" for k, line in enumerate(lines)]

    def _matter(self, inertial: Inertial, number: int, link: str, apart: bool = False) -> list[str]:
        lines = []
        if not apart and inertial.centre != NOWHERE:
            centre = self._lengths(inertial.centre, f"c{number}", f"mass centre of {link}")
            lines.append(f"mass centre: {_list(centre)}")
        lines.append(f"mass: {self._named(f'm{number}', inertial.mass, f'mass of {link}')}")
        xx, xy, xz, yy, yz, zz = inertial.tensor
        if any(value != "0" for value in inertial.tensor):
            real = not all(map(_NUMBER.match, inertial.tensor)) or is_of_a_body(*map(Fraction, inertial.tensor))
            parts = zip(("xx", "xy", "xz", "yy", "yz", "zz"), (xx, xy, xz, yy, yz, zz), strict=True)
            named = {part: self._named(f"J{number}{part}", value, f"inertia of {link}") for part, value in parts}
            keys = [["xx", "xy", "xz"], ["xy", "yy", "yz"], ["xz", "yz", "zz"]]
            rows = [[named[key] for key in row] for row in keys]
            diagonal = (xy, xz, yz) == NOWHERE
            tensor = _list([rows[k][k] for k in range(3)]) if diagonal else _list([_list(row) for row in rows])
            lines.append("inertia about: mass centre")
            lines.append(f"inertia: {tensor if real else f'{{tensor: {tensor}, accept: true}}'}")
        return lines

    # --- symbols ---

    def _lengths(self, values: Texts, stem: str, meaning: str) -> Texts:
        named = [
            self._named(f"{stem}{axis}", value, f"{meaning} along {axis}")
            for axis, value in zip("xyz", values, strict=True)
        ]
        return named[0], named[1], named[2]

    def _named(self, name: str, value: str, meaning: str) -> str:
        """The number, or, with symbols, the name of a parameter that has it as its value."""
        if not self.symbols or value == "0" or not _NUMBER.match(value):
            return value
        size = opposite(value) if value.startswith("-") and not name.startswith("J") else value
        while any(line.startswith(f"  {name}:") for line in self.parameters):
            name += "b"
        sign = "nonzero" if size.startswith("-") else "positive"
        note = scalar_text(self._comment(meaning))
        self.parameters.append(f"  {name}: {{sign: {sign}, value: {size}, meaning: {note}}}")
        return name if size == value else f"-{name}"


def _weighs(link: Link) -> bool:
    return any(not _is_nothing(inertial) for inertial in link.inertials)


def _is_nothing(inertial: Inertial) -> bool:
    return all(value == "0" for value in (inertial.mass, *inertial.tensor))


def _linear(multiplier: str, name: str, offset: str) -> str:
    """``multiplier*name + offset``."""
    first = {"1": name, "-1": f"-{name}", "0": ""}.get(multiplier, f"{multiplier}*{name}")
    if offset == "0" or not first:
        return first or offset
    return f"{first} - {offset[1:]}" if offset.startswith("-") else f"{first} + {offset}"


def _shape(shape: Shape) -> str:
    size = shape.size[0] if len(shape.size) == 1 else _list(shape.size)
    at = "" if shape.place == NOWHERE else f", at: {_list(shape.place)}"
    axes = _list([str(axis) for axis, _ in shape.turned])
    turns = (
        f", rotation: {{axes: {axes}, angles: {_list([words for _, words in shape.turned])}}}" if shape.turned else ""
    )
    return f"{{{shape.kind}: {size}{at}{turns}}}"


def _list(items: list[str] | tuple[str, ...]) -> str:
    return "[" + ", ".join(items) + "]"


# The text of a robot's file to a description; which of the two formats it is, its first element says.


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
