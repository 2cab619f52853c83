"""What ``<equality>`` of MJCF demands, as ties between joints and points.

MuJoCo pulls towards these with springs of its own; here they hold exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.elements import Element
from mbsym.source.robots.numbers import NOWHERE, Texts, number
from mbsym.source.robots.reader import Reader
from mbsym.source.robots.robot import GROUND, JointTie, Link, PointTie

#: Coordinates of a point that is found by turning are rounded to so many decimals.
_DECIMALS = 15

#: Of a relation between joints, as far as it is not given: y = x.
_COEFFICIENTS = ("0", "1", "0", "0", "0")


def ties(
    root: Element, links: Mapping[str, Link], sites: Mapping[str, str], reader: Reader
) -> Iterator[JointTie | PointTie]:
    """Those that are active; ``sites`` are the links that stand for sites."""
    joints = {joint.name for link in links.values() for joint in link.joints if joint.kind in ("turn", "slide")}
    for element in (child for section in root.all("equality") for child in section.children):
        if element.get("active") == "false":
            reader.leave_out(f"inactive constraint (<{element.tag}>)")
            continue
        found: JointTie | PointTie | None = None
        if element.tag == "joint":
            found = _of_joints(element, joints, reader)
        elif element.tag == "connect":
            found = _of_points(element, links, sites, reader)
        else:
            reader.leave_out(f"constraint (<{element.tag}> in <equality>)")
            continue
        if found is not None:
            reader.leave_out("softness of constraints (they hold exactly)")
            yield found


def _of_joints(element: Element, joints: set[str], reader: Reader) -> JointTie | None:
    first, second = reader.name(element, "joint1"), element.get("joint2")
    unknown = [name for name in (first, second) if name and name not in joints]
    if unknown:
        reader.error("unknown-name", f"there is no hinge or slide {ascii_safe(unknown[0])}", element)
    given = list(_COEFFICIENTS)
    count = len(element.get("polycoef").split()) or len(given)
    if count > len(given):
        reader.error("wrong-shape", "'polycoef' has at most five numbers", element)
    else:
        given[:count] = reader.numbers(element, "polycoef", count, " ".join(given[:count]))
    return None if unknown or not first else JointTie(first, second, tuple(given if second else given[:1]))


def _of_points(
    element: Element, links: Mapping[str, Link], sites: Mapping[str, str], reader: Reader
) -> PointTie | None:
    if element.get("site1"):
        ends = [element.get("site1"), reader.name(element, "site2")]
        unknown = [name for name in ends if name not in sites]
        if unknown:
            reader.error("unknown-name", f"there is no site {ascii_safe(unknown[0])}", element)
            return None
        return PointTie(sites[ends[0]], NOWHERE, sites[ends[1]], NOWHERE)
    first, second = reader.name(element, "body1"), element.get("body2") or GROUND
    second = GROUND if second == "world" else second
    unknown = [name for name in (first, second) if name != GROUND and name not in links]
    if unknown:
        reader.error("unknown-name", f"there is no body {ascii_safe(unknown[0])}", element)
        return None
    anchor = reader.three(element, "anchor")
    return PointTie(first, anchor, second, _seen_from(first, second, anchor, links))


def _seen_from(first: str, second: str, point: Texts, links: Mapping[str, Link]) -> Texts:
    """The point in the axes of another link where all joints are at zero."""
    seen = [float(x) for x in point]
    for link in _path(first, links):
        for axis, angle in reversed(link.turned):
            seen = _turned(seen, axis, _value(angle))
        seen = [float(x) + y for x, y in zip(link.place, seen, strict=True)]
    for link in reversed(list(_path(second, links))):
        seen = [y - float(x) for x, y in zip(link.place, seen, strict=True)]
        for axis, angle in link.turned:
            seen = _turned(seen, axis, -_value(angle))
    x, y, z = (number(repr(round(value, _DECIMALS))) for value in seen)
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
    found = list(v)
    found[i], found[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
    return found


def _value(words: str) -> float:
    """``-3*pi/4``, ``0.2``."""
    top, _, bottom = words.partition("/")
    product = -1.0 if top.startswith("-") else 1.0
    for factor in top.removeprefix("-").split("*"):
        product *= math.pi if factor == "pi" else float(factor)
    return product / float(bottom or 1)
