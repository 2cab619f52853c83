"""MJCF (MuJoCo): bodies within bodies, joints inside them, inertia given or made of their geoms.

Orientations by ``euler`` are exact; by ``quat``, ``axisangle``, ``xyaxes``, ``zaxis`` and ``fromto`` they become yaw,
pitch, roll, exact where these are multiples of pi/4 or pi/6 and else rounded to the digits of a double.
"""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.source.robots.defaults import Defaults
from mbsym.source.robots.elements import Element
from mbsym.source.robots.geoms import is_solid, matter_of, shape_of
from mbsym.source.robots.numbers import NOWHERE, Texts, degrees, number
from mbsym.source.robots.orientation import Angles, orientation
from mbsym.source.robots.reader import Reader
from mbsym.source.robots.robot import GROUND, Inertial, Joint, Link, Robot, Turns

_KINDS = {"hinge": "turn", "slide": "slide", "ball": "ball", "free": "free"}

#: Sections, and elements of bodies, that rigid bodies in a tree have no place for.
_SECTIONS = {
    "equality": "constraint (<equality>)",
    "tendon": "tendon",
    "actuator": "actuator",
    "sensor": "sensor",
    "contact": "contact pair",
    "deformable": "deformable body",
    "extension": "plugin",
}
_INSIDE = {"composite": "composite body", "flexcomp": "flexible body", "frame": "", "replicate": ""}


def read_mjcf(root: Element, complaints: Complaints) -> Robot | None:
    """The robot of an MJCF file, or None with complaints."""
    reader = Reader(complaints)
    for element in root.walk():
        if element.tag in ("include", "attach", "frame", "replicate"):
            reader.error("unsupported", f"<{element.tag}> is not read", element, "let MuJoCo save the compiled model")
    for section in root.children:
        for _ in section.children if section.tag in _SECTIONS else ():
            reader.leave_out(_SECTIONS[section.tag])
    world = root.first("worldbody")
    if world is None:
        reader.error("missing-key", "there is no <worldbody>", root)
        return None
    option = root.first("option")
    gravity = ("0", "0", "-9.81") if option is None else reader.three(option, "gravity", "0 0 -9.81")
    bodies = _Bodies(root, reader)
    links = tuple(bodies.links(world, GROUND, ""))
    if not links:
        reader.error("missing-key", "there is no <body>", world)
    name = root.get("model") or "robot"
    return None if complaints.errors else Robot(name, links, gravity, reader.left_out())


class _Bodies:
    """Reads bodies with the settings of the compiler and the defaults of classes."""

    def __init__(self, root: Element, reader: Reader) -> None:
        self.reader = reader
        self.defaults = Defaults(root)
        compiler = {key: value for element in root.all("compiler") for key, value in element.attributes.items()}
        self.angles = Angles(compiler.get("angle", "degree") != "radian", compiler.get("eulerseq", "xyz"))
        self.autolimits = compiler.get("autolimits", "true") != "false"
        self.from_geoms = compiler.get("inertiafromgeom", "auto")
        self.names: set[str] = set()
        for key in ("settotalmass", "balanceinertia", "boundmass", "boundinertia"):
            if compiler.get(key, "0") not in ("0", "false", "-1"):
                reader.leave_out(f"setting of the compiler ({key})")
        if compiler.get("coordinate", "local") != "local":
            reader.error("unsupported", "global coordinates are not read", root.all("compiler")[0])

    def links(self, above: Element, parent: str, childclass: str) -> Iterator[Link]:
        """The bodies inside an element, each followed by those inside it."""
        for element in above.all("body"):
            name = element.get("name") or f"body {len(self.names) + 1}"
            if name in self.names:
                self.reader.error("repeated-name", f"a second body called {ascii_safe(name)}", element)
            self.names.add(name)
            inside = element.get("childclass") or childclass
            yield self.link(name, element, parent, inside)
            yield from self.links(element, name, inside)

    def link(self, name: str, element: Element, parent: str, childclass: str) -> Link:
        reader = self.reader
        place, turned = self.pose(element)
        joints = tuple(self.joints(name, element, childclass))
        if any(joint.kind == "free" for joint in joints) and (parent != GROUND or len(joints) > 1):
            reader.error("unsupported", "a free joint moves a body of the world, alone", element)
        for child in element.children:
            if child.tag in _INSIDE:
                reader.leave_out(_INSIDE[child.tag])
        geoms = [self.defaults.of(geom, childclass) for geom in element.all("geom")]
        for geom in geoms:
            if not is_solid(geom):
                reader.leave_out(f"geom of the type {geom.get('type', 'sphere')}")
            elif geom.get("contype", "1") != "0" or geom.get("conaffinity", "1") != "0":
                reader.leave_out("contact (<geom>)")
        solid = [geom for geom in geoms if is_solid(geom)]
        shapes = tuple(shape_of(geom, self.angles, reader) for geom in solid)
        given = element.first("inertial")
        if self.from_geoms == "true" or (given is None and self.from_geoms != "false"):
            matter = tuple(found for geom in solid if (found := matter_of(geom, self.angles, reader)) is not None)
        else:
            matter = () if given is None else (self.inertial(given),)
        return Link(name, parent, place, turned, joints, matter, shapes, element.span)

    def pose(self, element: Element) -> tuple[Texts, Turns]:
        return self.reader.three(element, "pos"), orientation(element, self.angles, self.reader)

    def joints(self, body: str, element: Element, childclass: str) -> Iterator[Joint]:
        for child in element.children:
            if child.tag == "freejoint":
                yield Joint(child.get("name") or body, "free")
            elif child.tag == "joint":
                yield self.joint(body, self.defaults.of(child, childclass))

    def joint(self, body: str, element: Element) -> Joint:
        reader = self.reader
        word = element.get("type") or "hinge"
        kind = _KINDS.get(word)
        if kind is None:
            message = f"a joint of the type {ascii_safe(word)}"
            reader.error("unsupported", message, element, f"one of {', '.join(_KINDS)}")
            kind = "turn"
        axis = reader.three(element, "axis", "0 0 1")
        if all(float(part) == 0 for part in axis):
            reader.error("bad-axis", "an axis of length zero", element)
            axis = ("0", "0", "1")
        for attribute, told in (("armature", "inertia of a rotor (armature)"), ("frictionloss", "dry friction")):
            if float(reader.number(element, attribute)):
                reader.leave_out(told)
        if kind in ("ball", "free") and (
            float(reader.number(element, "damping")) or float(reader.number(element, "stiffness"))
        ):
            reader.leave_out("damping and stiffness of ball and free joints")
        if float(reader.number(element, "ref")):
            reader.error(
                "unsupported", "a joint with 'ref' is not read", element, "let MuJoCo save the model without it"
            )
        turns = kind == "turn"
        limited = element.get("limited", "auto")
        limits = None
        if (
            element.get("range")
            and (limited == "true" or (limited == "auto" and self.autolimits))
            and kind in ("turn", "slide")
        ):
            low, high = reader.numbers(element, "range", 2)
            limits = (self.angle(low), self.angle(high)) if turns else (low, high)
        rest = reader.number(element, "springref")
        return Joint(
            element.get("name") or body,
            kind,
            axis,
            reader.three(element, "pos") if kind in ("turn", "ball") else NOWHERE,
            limits,
            reader.number(element, "damping"),
            reader.number(element, "stiffness"),
            self.angle(rest) if turns else rest,
        )

    def angle(self, text: str) -> str:
        return degrees(text) if self.angles.in_degrees else number(text)

    def inertial(self, element: Element) -> Inertial:
        reader = self.reader
        place, turned = self.pose(element)
        mass = reader.number(element, "mass", None)
        if float(mass) < 0:
            reader.error("impossible-mass", "a mass is not negative", element)
        if element.get("fullinertia"):
            xx, yy, zz, xy, xz, yz = reader.numbers(element, "fullinertia", 6)
            return Inertial(mass, place, turned, (xx, xy, xz, yy, yz, zz))
        if element.get("diaginertia"):
            xx, yy, zz = reader.three(element, "diaginertia")
            return Inertial(mass, place, turned, (xx, "0", "0", yy, "0", zz))
        return Inertial(mass, place, turned)
