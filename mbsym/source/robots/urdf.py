"""URDF: links and joints.

``origin`` places the child's axes by xyz and the active rotation Rz(yaw) Ry(pitch) Rx(roll).  Passive and in the order
of turning that is yaw, pitch, roll about the axes 3, 2, 1.  Angles that are a multiple of pi/4 or pi/6 rounded to the
digits that were printed are spelled so, and told, unless they are to stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from fractions import Fraction

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.expressions.safe import quoted
from mbsym.source.robots.geoms import of_quaternion
from mbsym.source.robots.reader import (
    NO_TENSOR,
    Element,
    Reader,
    Spelling,
    Texts,
    check_spelling,
    is_nonnegative,
    is_of_a_body,
    number,
    words_of,
)
from mbsym.source.robots.robot import GROUND, Inertial, Joint, Link, Robot, Shape, Turns
from mbsym.source.scope import did_you_mean

#: The attributes of an inertia.
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

_KINDS = {
    "revolute": "turn",
    "continuous": "turn",
    "prismatic": "slide",
    "floating": "free",
    "planar": "planar",
    "fixed": "",
}

#: Joints with several coordinates: nothing drives, brakes, leads or follows one.
_SEVERAL = ("free", "planar")

#: Elements that rigid bodies in a tree have no place for.
_LEFT_OUT = {
    "transmission": "transmission",
    "gazebo": "settings of a simulator (<gazebo>)",
    "sensor": "sensor",
    "ros2_control": "controller (<ros2_control>)",
    "loop_joint": "joint that closes a loop (<loop_joint>)",
}


#: What URDF and its common extensions have; another element or attribute is most likely a slip of the pen.
_SPELLING = Spelling(
    words_of(
        {
            "robot": "name version",
            "link": "name type",
            "joint": "name type",
            "origin": "xyz rpy quat_xyzw",
            "mass": "value",
            "inertia": " ".join(MOMENTS),
            "parent": "link",
            "child": "link",
            "axis": "xyz",
            "dynamics": "damping friction",
            "limit": "lower upper effort velocity acceleration deceleration jerk",
            "mimic": "joint multiplier offset",
            "box": "size",
            "sphere": "radius",
            "cylinder": "radius length",
            "capsule": "radius length",
        }
    ),
    words_of(
        {
            "robot": f"link joint material group {' '.join(_LEFT_OUT)}",
            "link": f"inertial visual collision self_collision_checking contact origin {' '.join(_LEFT_OUT)}",
            "joint": "origin parent child axis calibration dynamics limit mimic safety_controller",
            "inertial": "origin mass inertia",
            "visual": "origin geometry material",
            "group": "",
        }
    ),
    words_of(
        {
            "link": "inertial",
            "joint": "origin parent child axis dynamics limit mimic",
            "inertial": "origin mass inertia",
            "visual": "origin geometry",
        }
    ),
)


def _read(root: Element) -> Iterator[tuple[str, Element]]:
    """The elements that say how a robot moves and looks, but for what is in those that are left out."""
    yield "", root
    yield from (("", group) for group in root.all("group"))
    for body in (*root.all("link"), *root.all("joint")):
        yield "", body
        for part in body.children:
            if part.tag not in (*_LEFT_OUT, "collision"):
                yield from (("", element) for element in part.walk())


def read_urdf(root: Element, complaints: Complaints, exact: bool = False) -> Robot | None:
    """The robot of a URDF, or None with complaints; ``exact``: angles stay as they are printed."""
    reader = Reader(complaints, exact)
    template = next((element for element in root.walk() if element.tag.startswith("xacro:")), None)
    if template is not None:
        reader.error("unsupported", "this is a template, no URDF yet", template, "expand it with xacro first")
        return None
    check_spelling(_read(root), _SPELLING, reader)
    reader.names(iter(root.all("joint")), "joint")
    links = _links(root, reader)
    joints = _joints(root, links, reader)
    for element in root.walk():
        if element.tag in _LEFT_OUT:
            reader.leave_out(_LEFT_OUT[element.tag])
        elif element.tag == "collision":
            reader.leave_out("contact (<collision>)")
    roots = [name for name in links if name not in joints]
    if len(roots) != 1 and links and not complaints.errors:
        reason = (
            "no link stands on the ground: the joints run in a circle" if not roots else f"links apart: {_few(roots)}"
        )
        reader.error("no-tree", reason, root, "every link but one hangs on exactly one joint")
    if not links:
        reader.error("missing-key", "there is no <link>", root)
    if complaints.errors:
        return None
    ordered = _ordered(roots[0], joints)
    if len(ordered) != len(links):
        lost = next(name for name in links if name not in ordered)
        reader.error("no-tree", f"link {ascii_safe(lost)} hangs on itself", links[lost])
        return None
    named = {joint.get("name"): joint for joint in reversed(joints.values())}
    made = tuple(_link(name, links[name], joints.get(name), named, reader) for name in ordered)
    name = root.get("name") or "robot"
    return None if complaints.errors else Robot(name, made, left_out=reader.left_out(), snapped=reader.snapped())


def _few(names: list[str]) -> str:
    return ", ".join(ascii_safe(name) for name in names[:5]) + (", ..." if len(names) > 5 else "")


def _links(root: Element, reader: Reader) -> dict[str, Element]:
    links: dict[str, Element] = {}
    for element in root.all("link"):
        name = reader.name(element)
        if name in links:
            reader.error("repeated-name", f"a second link called {ascii_safe(name)}", element)
        links[name] = element
    return links


def _joints(root: Element, links: dict[str, Element], reader: Reader) -> dict[str, Element]:
    """Child -> the joint that leads to it."""
    joints: dict[str, Element] = {}
    for element in root.all("joint"):
        reader.name(element)
        child = _end(element, "child", links, reader)
        _end(element, "parent", links, reader)
        if child in joints:
            message = f"link {ascii_safe(child)} hangs on two joints: a closed loop"
            reader.error("unsupported", message, element, "open trees only: take one of the joints out")
        joints[child] = element
        kind = element.get("type")
        if kind not in _KINDS:
            hint = f"one of {', '.join(_KINDS)}"
            reader.error("unsupported", f"a joint of the type {ascii_safe(kind)}", element, hint)
    return joints


def _end(joint: Element, end: str, links: dict[str, Element], reader: Reader) -> str:
    element = joint.first(end)
    if element is None:
        reader.error("missing-key", f"this joint has no <{end}>", joint)
        return ""
    name = reader.name(element, "link")
    if name and name not in links:
        reader.error("unknown-name", f"there is no link {ascii_safe(name)}", element, did_you_mean(name, links))
    return name


def _ordered(first: str, joints: dict[str, Element]) -> list[str]:
    """Links from the root, each after its parent, branches in alphabetical order."""
    children: dict[str, list[str]] = {}
    for child, joint in joints.items():
        parent = joint.first("parent")
        assert parent is not None
        children.setdefault(parent.get("link"), []).append(child)
    ordered, waiting = [], [first]
    while waiting:
        link = waiting.pop()
        ordered.append(link)
        waiting += sorted(children.get(link, ()), reverse=True)
    return ordered


def _link(name: str, element: Element, joint: Element | None, named: Mapping[str, Element], reader: Reader) -> Link:
    inertial = element.first("inertial")
    if element.first("origin") is not None:  # some robots that are sold have one; URDF readers pass over it
        reader.leave_out("place of a link (<origin> in <link>)")
    matter = () if inertial is None else (_inertial(inertial, reader, name),)
    shapes = tuple(shape for visual in element.all("visual") if (shape := _shape(visual, reader)) is not None)
    if joint is None:
        return Link(name, GROUND, inertials=matter, shapes=shapes, span=element.span)
    parent = joint.first("parent")
    assert parent is not None
    place, turned = _origin(joint, reader)
    moved = _joint(joint, named, reader)
    return Link(name, parent.get("link"), place, turned, moved, matter, shapes, element.span)


def _joint(element: Element, named: Mapping[str, Element], reader: Reader) -> tuple[Joint, ...]:
    kind = _KINDS[element.get("type")]
    if not kind:
        return ()
    axis = ("1", "0", "0") if kind == "free" else reader.three(element.first("axis"), "xyz", "1 0 0")  # it has none
    if all(float(part) == 0 for part in axis):
        reader.error("bad-axis", "an axis of length zero", element)
        axis = ("1", "0", "0")
    if element.first("safety_controller") is not None:
        reader.leave_out("safety controller")
    dynamics, limit = element.first("dynamics"), element.first("limit")
    damping = "0" if dynamics is None else reader.number(dynamics, "damping")
    several = f"{element.get('type')} joint" if kind in _SEVERAL else ""
    if several and float(damping):
        reader.leave_out(f"damping of a {several}")
        damping = "0"
    if dynamics is not None and float(reader.number(dynamics, "friction")):
        reader.leave_out("dry friction of a joint")
    limits = None
    if limit is not None and element.get("type") in ("revolute", "prismatic"):
        limits = (reader.number(limit, "lower"), reader.number(limit, "upper"))
        if float(limits[0]) >= float(limits[1]):
            if any(map(float, limits)):
                reader.leave_out("limits of a joint that exclude every position, or all but one")
            limits = None
    if several and element.first("mimic") is not None:
        reader.leave_out(f"mimicry of a {several}")
    led = None if several else _led(element, named, reader)
    if led is not None and limits is not None:
        reader.leave_out("limits of a joint that mimics another")
    effort = "0" if limit is None else reader.number(limit, "effort")
    moves = element.get("type") in ("revolute", "prismatic", "continuous")
    if limit is not None and moves and limit.get("velocity", "0").strip() not in ("", "0", "0.0"):  # not read at all
        reader.leave_out("limit of the velocity of a joint")
    if limit is not None and any(limit.get(key) for key in ("acceleration", "deceleration", "jerk")):
        reader.leave_out("limits of the acceleration or jerk of a joint")
    return (
        Joint(
            element.get("name"),
            kind,
            axis,
            limits=limits,
            damping=damping,
            driven=not several,
            effort=effort if float(effort) > 0 else "",
            led=led,
        ),
    )


def _led(element: Element, named: Mapping[str, Element], reader: Reader) -> tuple[str, str, str] | None:
    """(leader, multiplier, offset) of a joint that mimics another, which mimics none itself: those between are put in.

    One that mimics a fixed joint stands at its offset.
    """
    multiplier, offset, seen = Fraction(1), Fraction(0), [element.get("name")]
    while (mimic := element.first("mimic")) is not None:
        leader = reader.name(mimic, "joint")
        offset += multiplier * Fraction(reader.number(mimic, "offset"))
        multiplier *= Fraction(reader.number(mimic, "multiplier", "1"))
        leader_element = named.get(leader)
        if leader_element is None or leader in seen:
            what = (
                "joints that mimic each other"
                if leader_element is not None
                else f"there is no joint {ascii_safe(leader)}"
            )
            reader.error("no-tree" if leader_element is not None else "unknown-name", what, mimic)
            return None
        kind = leader_element.get("type")
        if _KINDS.get(kind, "") in ("", *_SEVERAL):
            if _KINDS.get(kind):
                reader.error("unsupported", f"a {kind} joint cannot be mimicked", mimic)
            return leader, "0", _decimal(offset)
        seen.append(leader)
        element = leader_element
    return (seen[-1], _decimal(multiplier), _decimal(offset)) if len(seen) > 1 else None


def _decimal(value: Fraction) -> str:
    """As descriptions write it; products and sums of decimals end."""
    return number(str(Decimal(value.numerator) / Decimal(value.denominator)))


def _inertial(element: Element, reader: Reader, link: str) -> Inertial:
    """Tensors with which a kinetic energy could be negative (some are -5e-20) are taken for zero."""
    mass, tensor = element.first("mass"), element.first("inertia")
    centre, turned = _origin(element, reader)
    if tensor is None:
        reader.leave_out(NO_TENSOR)
    xx, xy, xz, yy, yz, zz = ("0",) * 6 if tensor is None else (reader.number(tensor, part) for part in MOMENTS)
    if not is_nonnegative(*map(Fraction, (xx, xy, xz, yy, yz, zz))):
        reader.leave_out(f"tensor of inertia of link {quoted(link)} with which a kinetic energy could be negative")
        xx = xy = xz = yy = yz = zz = "0"
    elif not is_of_a_body(*map(Fraction, (xx, xy, xz, yy, yz, zz))):
        reader.leave_out("the triangle inequality of a tensor of inertia (no body has it; it is taken as it stands)")
    if mass is None:
        reader.error("missing-key", "this <inertial> has no <mass>", element)
    amount = "0" if mass is None else reader.number(mass, "value", None)
    if float(amount) < 0:
        reader.error("impossible-mass", "a mass is not negative", element)
    return Inertial(amount, centre, turned, (xx, xy, xz, yy, yz, zz))


def _shape(visual: Element, reader: Reader) -> Shape | None:
    place, turned = _origin(visual, reader)
    geometry = visual.first("geometry")
    for element in geometry.children if geometry is not None else ():
        match element.tag:
            case "box":
                return Shape("box", reader.three(element, "size", "0 0 0"), place, turned)
            case "sphere":
                return Shape("sphere", (reader.number(element, "radius", None),), place, turned)
            case "cylinder" | "capsule":
                sizes = (reader.number(element, "radius", None), reader.number(element, "length", None))
                return Shape(element.tag, sizes, place, turned)
            case "mesh":
                reader.leave_out("mesh")
    return None


def _origin(element: Element, reader: Reader) -> tuple[Texts, Turns]:
    """(place, turns)."""
    origin = element.first("origin")
    place = reader.three(origin, "xyz")
    if origin is not None and origin.get("quat_xyzw"):
        if origin.get("rpy"):
            reader.error("conflicting-keys", "<origin> is turned in two ways: rpy and quat_xyzw", origin)
        x, y, z, w = reader.numbers(origin, "quat_xyzw", 4)
        return place, of_quaternion((w, x, y, z), origin, reader)
    return place, fixed_turns(reader.three(origin, "rpy", raw=True), reader)


def fixed_turns(rpy: Texts, reader: Reader) -> Turns:
    """Roll, pitch, yaw (active, about fixed axes) as passive turns in the order yaw, pitch, roll."""
    roll, pitch, yaw = map(reader.angle, rpy)
    return tuple((axis, words) for axis, words in ((3, yaw), (2, pitch), (1, roll)) if words != "0")
