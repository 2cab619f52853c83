"""What both formats describe: links, each placed on its parent and moved by joints, ties, inertia, shapes.

Numbers are texts as they are printed.  Turns are passive and in the order of turning, as in descriptions.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.source.robots.reader import NOWHERE, Element, Reader, Texts, angle, number, opposite

#: (axis, angle) of the turns that lead from one set of axes to another.
Turns = tuple[tuple[int, str], ...]

#: xx, xy, xz, yy, yz, zz.
Moments = tuple[str, str, str, str, str, str]

#: The link on which the first one stands.
GROUND = "0"


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, mass centre in axes of the link, turns to its own axes, and the tensor there (xx, xy, xz, yy, yz, zz)."""

    mass: str
    centre: Texts = NOWHERE
    turned: Turns = ()
    tensor: Moments = ("0",) * 6


@dataclass(frozen=True, slots=True)
class Joint:
    """A movement of a link: ``kind`` is turn, slide, ball, planar or free; ``axis``, ``anchor`` are in its axes.

    ``limits`` are the least and greatest value; ``damping`` and ``stiffness`` act on the joint's coordinate, the
    latter about ``rest``.  ``armature`` is the inertia of a rotor, which adds armature q'^2/2 to the kinetic energy.
    A joint is ``driven`` where something can exert a torque or a force in it, of ``effort`` at most ("": not said).
    Its coordinate is ``ref`` where it is at zero.  One that is ``led`` has no coordinate: it stands at
    multiplier * q + offset, with q that of the joint of this name.  ``start`` is what its coordinates are where the
    file has it stand; those of a free joint are then measured from the ground, and else from where the link is placed.
    """

    name: str
    kind: str
    axis: Texts = ("0", "0", "1")
    anchor: Texts = NOWHERE
    limits: tuple[str, str] | None = None
    damping: str = "0"
    stiffness: str = "0"
    rest: str = "0"
    armature: str = "0"
    driven: bool = False
    effort: str = ""
    led: tuple[str, str, str] | None = None
    ref: str = "0"
    start: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Shape:
    """What a link looks like: ``kind`` box, sphere, cylinder, capsule or ellipsoid, its sizes, place and turns.

    Sizes: the three edges of a box; a radius; radius and length along the third axis; three half axes.
    """

    kind: str
    size: tuple[str, ...]
    place: Texts = NOWHERE
    turned: Turns = ()


@dataclass(frozen=True, slots=True)
class Link:
    """``place`` and ``turned`` lead from the axes of ``parent`` to this link's where all its joints are at zero."""

    name: str
    parent: str
    place: Texts = NOWHERE
    turned: Turns = ()
    joints: tuple[Joint, ...] = ()
    inertials: tuple[Inertial, ...] = ()
    shapes: tuple[Shape, ...] = ()
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class JointTie:
    """y - y_ref = sum of coefficients[k] (x - x_ref)^k between two joints; of one alone where second is ""."""

    first: str
    second: str
    coefficients: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PointTie:
    """A point of one link is a point of another; both in the axes of their links.

    Where they are welded, unit vectors of both stay parallel (``axes``), and points that are a unit vector away, in two
    directions at right angles, at the distance sqrt(2) (``apart``): six conditions, none of which follows from others.
    """

    first: str
    first_point: Texts
    second: str
    second_point: Texts
    axes: tuple[Texts, Texts] | None = None
    apart: tuple[Texts, Texts] | None = None


@dataclass(frozen=True, slots=True)
class Robot:
    """Links, each after its parent, and ``ties`` between them; ``left_out`` says in words what is no part of it.

    ``snapped`` are the printed angles that were read as parts of pi: ``1.5708 as pi/2``.
    """

    name: str
    links: tuple[Link, ...]
    gravity: Texts = ("0", "0", "-9.81")
    left_out: tuple[str, ...] = ()
    snapped: tuple[str, ...] = ()
    ties: tuple[JointTie | PointTie, ...] = ()


# What ``<equality>`` of MJCF demands, as ties between joints and points.
#
# MuJoCo pulls towards these with springs of its own; here they hold exactly.


#: Coordinates of a point that is found by turning are rounded to so many decimals.
_DECIMALS = 15

_UNITS: tuple[Texts, Texts, Texts] = (("1", "0", "0"), ("0", "1", "0"), ("0", "0", "1"))

#: Of the pose of a weld, as far as it is not given: that where all joints are at zero.
_AT_ZERO = "0 1 0 0 0 0 0"

#: Of a relation between joints, as far as it is not given: y = x.
_COEFFICIENTS = ("0", "1", "0", "0", "0")


def ties(
    elements: Iterable[Element], links: Mapping[str, Link], sites: Mapping[str, str], reader: Reader
) -> Iterator[JointTie | PointTie]:
    """Those that are active of the elements of <equality>; ``sites`` are the links that stand for sites."""
    joints = {joint.name for link in links.values() for joint in link.joints if joint.kind in ("turn", "slide")}
    for element in elements:
        if element.get("active") == "false":
            reader.leave_out(f"inactive constraint (<{element.tag}>)")
            continue
        tie: JointTie | PointTie | None = None
        if element.tag == "joint":
            tie = _of_joints(element, joints, reader)
        elif element.tag in ("connect", "weld"):
            tie = _of_points(element, links, sites, reader)
        else:
            reader.leave_out(f"constraint (<{element.tag}> in <equality>)")
            continue
        if tie is not None:
            reader.leave_out("softness of constraints (they hold exactly)")
            yield tie


def _of_joints(element: Element, joints: set[str], reader: Reader) -> JointTie | None:
    first, second = reader.name(element, "joint1"), element.get("joint2")
    unknown = [name for name in (first, second) if name and name not in joints]
    if unknown:
        reader.error("unknown-name", f"there is no hinge or slide {ascii_safe(unknown[0])}", element)
    coefficients = list(_COEFFICIENTS)
    count = len(element.get("polycoef").split()) or len(coefficients)
    if count > len(coefficients):
        reader.error("wrong-shape", "'polycoef' has at most five numbers", element)
    else:
        coefficients[:count] = reader.numbers(element, "polycoef", count, " ".join(coefficients[:count]))
    return (
        None if unknown or not first else JointTie(first, second, tuple(coefficients if second else coefficients[:1]))
    )


def _of_points(
    element: Element, links: Mapping[str, Link], sites: Mapping[str, str], reader: Reader
) -> PointTie | None:
    # A weld that does not weigh angles holds points alone.
    welded = element.tag == "weld" and float(reader.number(element, "torquescale", "1")) != 0
    if element.get("site1"):
        ends = [element.get("site1"), reader.name(element, "site2")]
        for name in dict.fromkeys(ends):
            if name and name not in sites:
                reader.error("unknown-name", f"there is no site {ascii_safe(name)}", element)
        if not all(name in sites for name in ends):
            return None
        tie = PointTie(sites[ends[0]], NOWHERE, sites[ends[1]], NOWHERE)
        return replace(tie, axes=(_UNITS[2], _UNITS[2]), apart=_UNITS[:2]) if welded else tie
    first, second = reader.name(element, "body1"), element.get("body2") or GROUND
    first, second = (GROUND if name == "world" else name for name in (first, second))
    anchor, pose = reader.three(element, "anchor"), _AT_ZERO.split()
    if element.tag == "weld":
        pose = [*reader.numbers(element, "relpose", 7, _AT_ZERO)]
    known = {GROUND, *links}
    for name in dict.fromkeys((first, second)):
        if name and name not in known:
            reader.error("unknown-name", f"there is no body {ascii_safe(name)}", element)
    if not known.issuperset((first, second)):
        return None
    if element.tag == "connect":
        return PointTie(first, anchor, second, _texts(_seen_from(first, second, anchor, links)))
    # The anchor of a weld is a point of the second body, which stands in the first as it is said, or as at zero.
    place, quaternion = pose[:3], list(map(float, pose[3:]))
    if not any(quaternion):
        origin, there, tip, side = (
            _seen_from(second, first, x, links) for x in (NOWHERE, anchor, _UNITS[2], _UNITS[0])
        )
        axis, across = ([a - b for a, b in zip(x, origin, strict=True)] for x in (tip, side))
    else:
        axis, across = (_by(quaternion, list(map(float, x))) for x in (_UNITS[2], _UNITS[0]))
        there = list(map(float, place))  # as MuJoCo has it: where the anchor is, not the origin of the body
    first_point = [a + b for a, b in zip(there, across, strict=True)]
    second_point = [float(a) + float(b) for a, b in zip(anchor, _UNITS[1], strict=True)]
    tie = PointTie(first, _texts(there), second, anchor)
    if not welded:
        return tie
    return replace(tie, axes=(_texts(axis), _UNITS[2]), apart=(_texts(first_point), _texts(second_point)))


def _by(quaternion: list[float], v: list[float]) -> list[float]:
    """v turned by a quaternion of any length: (w^2 - u.u) v + 2 (u.v) u + 2 w u x v, over its square."""
    w, x, y, z = quaternion
    u = (x, y, z)
    dot = sum(a * b for a, b in zip(u, v, strict=True))
    cross = (y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0])
    square = w * w + x * x + y * y + z * z
    return [((2 * w * w - square) * v[k] + 2 * dot * u[k] + 2 * w * cross[k]) / square for k in range(3)]


def _seen_from(first: str, second: str, point: Texts, links: Mapping[str, Link]) -> list[float]:
    """The point in the axes of another link where all joints are at zero."""
    seen = [float(x) for x in point]
    for link in _path(first, links):
        for axis, turn in reversed(link.turned):
            seen = _turned(seen, axis, _value(turn))
        seen = [float(x) + y for x, y in zip(link.place, seen, strict=True)]
    for link in reversed(list(_path(second, links))):
        seen = [y - float(x) for x, y in zip(link.place, seen, strict=True)]
        for axis, turn in link.turned:
            seen = _turned(seen, axis, -_value(turn))
    return seen


def at_zero(name: str, links: Mapping[str, Link]) -> tuple[Texts, tuple[list[float], ...]]:
    """Where a link is where all joints are at zero, and its axes, seen from the ground."""
    origin, *tips = (_seen_from(name, GROUND, point, links) for point in (NOWHERE, *_UNITS))
    return _texts(origin), tuple([a - b for a, b in zip(tip, origin, strict=True)] for tip in tips)


def _texts(values: Iterable[float]) -> Texts:
    x, y, z = (number(repr(round(value, _DECIMALS) + 0.0)) for value in values)
    return x, y, z


def _path(name: str, links: Mapping[str, Link]) -> Iterator[Link]:
    """A link and those that carry it, to the ground."""
    while name != GROUND:
        yield links[name]
        name = links[name].parent


def _turned(v: list[float], axis: int, angle: float) -> list[float]:
    """Rotated about a coordinate axis, actively."""
    i, j = axis % 3, (axis + 1) % 3
    c, s = math.cos(angle), math.sin(angle)
    rotated = list(v)
    rotated[i], rotated[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
    return rotated


def _value(words: str) -> float:
    """``-3*pi/4``, ``0.2``."""
    top, _, bottom = words.partition("/")
    product = -1.0 if top.startswith("-") else 1.0
    for factor in top.removeprefix("-").split("*"):
        product *= math.pi if factor == "pi" else float(factor)
    return product / float(bottom or 1)


# From a link's pose and joints to bodies: displacements and turns in a row, as few bodies as they fit in.
#
# A body of a description is placed by one displacement in the axes of its carrier, followed by up to three turns.


#: What a body can turn about.
MOST_TURNS = 3


@dataclass(frozen=True, slots=True)
class Step:
    """A displacement and the turns after it; ``coordinates`` are those that it introduces."""

    place: Texts = NOWHERE
    turns: Turns = ()
    coordinates: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Moving:
    """A joint with the coordinates that it introduces; one that turns or slides does so by ``value``."""

    joint: Joint
    names: tuple[str, ...]
    value: str = ""


def steps(place: Texts, turned: Turns, joints: tuple[Moving, ...]) -> tuple[Step, ...]:
    """The steps that lead over a link's pose and its joints to its axes."""
    moves = [Step(place), *(Step(turns=(turn,)) for turn in turned)]
    for moving in joints:
        moves += _moves(moving)
    return tuple(_joined(moves))


def _moves(moving: Moving) -> list[Step]:
    """A joint as elementary steps; a turn about a point elsewhere goes there and comes back."""
    joint, names, value = moving.joint, moving.names, moving.value
    match joint.kind:
        case "slide":
            return [Step(along(joint.axis, value), (), names)]
        case "turn" | "planar":
            about = turns_about(joint.axis, value)
            turns = [Step(turns=(turn,), coordinates=names[-1:] if value in turn[1] else ()) for turn in about]
            if joint.kind == "planar":  # where the axis is a coordinate axis, along the two others
                middle = len(about) // 2
                across = ["0", "0", "0"]
                across[about[middle][0] % 3], across[(about[middle][0] + 1) % 3] = names[:2]
                turns.insert(middle, Step((across[0], across[1], across[2]), (), names[:2]))
        case _:
            angles = names[-3:]
            turns = [
                Step(turns=((axis, name),), coordinates=(name,)) for axis, name in zip((3, 2, 1), angles, strict=True)
            ]
    if joint.kind == "free":
        return [Step((names[0], names[1], names[2]), (), names[:3]), *turns]
    there, back = joint.anchor, tuple(map(opposite, joint.anchor))
    return turns if there == NOWHERE else [Step(there), *turns, Step((back[0], back[1], back[2]))]


def _joined(moves: list[Step]) -> Iterator[Step]:
    """Steps put together as far as a body can hold them."""
    now = Step()
    for move in moves:
        names = (*now.coordinates, *move.coordinates)
        if move.place != NOWHERE:
            if now.turns:
                yield now
                now = move
            else:
                now = Step(_sum(now.place, move.place), move.turns, names)
        elif len(now.turns) + len(move.turns) > MOST_TURNS:
            yield now
            now = move
        else:
            now = Step(now.place, now.turns + move.turns, names)
    yield now


def _sum(texts: Texts, other: Texts) -> Texts:
    added = [
        b if a == "0" else a if b == "0" else f"{a} - {b[1:]}" if b.startswith("-") else f"{a} + {b}"
        for a, b in zip(texts, other, strict=True)
    ]
    return added[0], added[1], added[2]


def turns_about(axis: Texts, name: str) -> Turns:
    """The turn by a name or formula about an axis: e_3 = Ry(b) Rz(a) turned onto it, where it is no coordinate axis."""
    x, y, z = map(float, axis)
    on = [k for k, value in enumerate((x, y, z), start=1) if value != 0]
    if len(on) == 1:
        positive = (x, y, z)[on[0] - 1] > 0
        return ((on[0], name if positive else _negative(name)),)
    azimuth, slope = angle(repr(math.atan2(y, x))), angle(repr(math.atan2(math.hypot(x, y), z)))
    return tuple(
        turn
        for turn in ((3, azimuth), (2, slope), (3, name), (2, opposite(slope)), (3, opposite(azimuth)))
        if turn[1] != "0"
    )


def _negative(name: str) -> str:
    return f"-{name}" if name.isidentifier() else f"-({name})"


def along(axis: Texts, name: str) -> Texts:
    """``name`` (or a formula) times the unit vector of an axis."""
    name = name if name.isidentifier() else f"({name})"
    components = list(map(float, axis))
    length = math.hypot(*components)
    moved = []
    for component in components:
        size = number(repr(abs(component) / length))
        step = "0" if size == "0" else name if size == "1" else f"{size}*{name}"
        moved.append(f"-{step}" if component < 0 and step != "0" else step)
    return moved[0], moved[1], moved[2]
