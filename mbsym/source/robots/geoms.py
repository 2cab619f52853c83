"""Elements of MJCF: how they are turned, as passive turns in the order of turning; geoms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.reader import Element, Reader, Texts, angle, degrees, number
from mbsym.source.robots.robot import Inertial, Shape, Turns

Row = tuple[float, float, float]

#: Columns are the new axes in the old ones.
Matrix = tuple[Row, Row, Row]

#: The attributes that turn something.
TURNING = ("quat", "axisangle", "xyaxes", "zaxis", "euler")

#: Below this the yaw and the roll of a turn cannot be told apart.
_LEVEL = 1e-12


@dataclass(frozen=True)
class Angles:
    """How a file means its angles: in degrees, and in which sequence.

    A lower letter turns about the turned axis, a capital about the fixed one.
    """

    in_degrees: bool
    sequence: str

    def text(self, printed: str, reader: Reader) -> str:
        return degrees(printed) if self.in_degrees else reader.angle(printed)


def orientation(element: Element, angles: Angles, reader: Reader) -> Turns:
    """The turns that an element asks for, in whichever way."""
    if len(given := [key for key in TURNING if element.get(key)]) > 1:
        reader.error("conflicting-keys", f"<{element.tag}> is turned in two ways: {' and '.join(given)}", element)
    if element.get("euler"):
        return _euler(element, angles, reader)
    if element.get("axisangle"):
        x, y, z, turn = reader.numbers(element, "axisangle", 4, raw=True)
        on = [k for k, part in enumerate((x, y, z), start=1) if float(part)]
        if len(on) == 1:
            words = angles.text(turn, reader)
            positive = float((x, y, z)[on[0] - 1]) > 0
            return ((on[0], words if positive else _opposite(words)),) if words != "0" else ()
        size = math.radians(float(turn)) if angles.in_degrees else float(turn)
        half, length = size / 2, math.hypot(float(x), float(y), float(z))
        if not length:
            reader.error("bad-axis", "an axis of length zero", element)
            return ()
        return _of_quaternion(math.cos(half), *(math.sin(half) * float(part) / length for part in (x, y, z)))
    if element.get("quat"):
        return of_quaternion(reader.numbers(element, "quat", 4), element, reader)
    if element.get("xyaxes"):
        six = [float(part) for part in reader.numbers(element, "xyaxes", 6)]
        return _of_axes(_unit(six[0], six[1], six[2]), (six[3], six[4], six[5]))
    if element.get("zaxis"):
        first, second, third = reader.three(element, "zaxis")
        return turns_onto(float(first), float(second), float(third))
    return ()


def _euler(element: Element, angles: Angles, reader: Reader) -> Turns:
    sequence = angles.sequence
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
        reader.error("unsupported", f"the sequence {ascii_safe(sequence)} of Euler angles", element)
        return ()
    parts = reader.three(element, "euler", raw=True)
    turns: list[tuple[int, str]] = []
    for letter, part in zip(sequence, parts, strict=True):
        first = letter.isupper()  # about a fixed axis: before all turns so far
        turns.insert(0 if first else len(turns), ("xyz".index(letter.lower()) + 1, angles.text(part, reader)))
    return tuple(turn for turn in turns if turn[1] != "0")


def turns_onto(x: float, y: float, z: float) -> Turns:
    """The least turn that takes the third axis onto a direction."""
    length = math.hypot(x, y, z)
    if not length or (x == 0 and y == 0 and z > 0):
        return ()
    if x == 0 and y == 0:
        return ((1, "pi"),)
    half = math.acos(max(-1.0, min(1.0, z / length))) / 2
    level = math.hypot(x, y)
    return _of_quaternion(math.cos(half), -math.sin(half) * y / level, math.sin(half) * x / level, 0.0)


def of_quaternion(parts: tuple[str, ...], element: Element, reader: Reader) -> Turns:
    """The turn by a printed quaternion (w, x, y, z) of any length but zero."""
    w, x, y, z = map(float, parts)
    if not any((w, x, y, z)):
        reader.error("bad-axis", "a quaternion of length zero", element)
        return ()
    return _of_quaternion(w, x, y, z)


def _of_quaternion(w: float, x: float, y: float, z: float) -> Turns:
    n = w * w + x * x + y * y + z * z
    s = 2 / n
    return of_matrix(
        (
            (1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
            (s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)),
            (s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)),
        )
    )


def _unit(x: float, y: float, z: float) -> Row:
    length = math.hypot(x, y, z) or 1.0
    return x / length, y / length, z / length


def _of_axes(x: Row, near: Row) -> Turns:
    """The first axis, and a second one that is made normal to it."""
    along = sum(a * b for a, b in zip(x, near, strict=True))
    y = _unit(*(b - along * a for a, b in zip(x, near, strict=True)))
    z = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return of_matrix(((x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])))


def of_matrix(matrix: Matrix) -> Turns:
    """R = Rz(yaw) Ry(pitch) Rx(roll), which as passive turns are about the axes 3, 2, 1 in that order."""
    (a, b, c), (d, e, f), (g, _, _) = matrix
    flat = math.hypot(a, d)
    yaw = math.atan2(d, a) if flat > _LEVEL else math.atan2(-b, e)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(-g, flat)
    # The second row of Rz(-yaw) R is (0, cos(roll), -sin(roll)): near pitch = pi/2, where neither yaw nor roll is
    # known well, it keeps what they make together.
    roll = math.atan2(sine * c - cosine * f, cosine * e - sine * b) if flat > _LEVEL else 0.0
    turns = ((3, yaw), (2, pitch), (1, roll))
    return tuple((axis, words) for axis, value in turns if (words := _spelled(value)) != "0")


def _spelled(value: float) -> str:
    """The angle as a part of pi where it is one up to rounding, zero where it is nothing but rounding."""
    return "0" if abs(value) < 1e-15 else angle(repr(value)) if abs(value) > _LEVEL else number(repr(value))


def _opposite(words: str) -> str:
    return words[1:] if words.startswith("-") else f"-{words}"


# Geoms of MJCF: what they look like and what they weigh.  Masses are exact (those of round bodies hold pi) where the
# lengths are: between two given ends they are rounded to a double.


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_OTHERS = ("plane", "hfield", "mesh", "sdf")
_DENSITY = "1000"

#: Longer numerators and denominators come from lengths that were rounded to doubles.
_EXACT_DIGITS = 20


def is_solid(geom: Element) -> bool:
    """Whether it is a body whose inertia follows from its sizes, which are not fitted to a mesh."""
    return geom.get("type", "sphere") in _SIZES and not geom.get("mesh")


def checked(geom: Element, reader: Reader) -> bool:
    """Whether a geom has a known type, sizes and a mass that are not negative; complains where not."""
    kind = geom.get("type", "sphere")
    if kind not in (*_SIZES, *_OTHERS):
        reader.error("unsupported", f"a geom of the type {ascii_safe(kind)}", geom, f"one of {', '.join(_SIZES)}")
        return False
    before = reader.complaints.error_count
    if kind in _SIZES and any(float(size) <= 0 for size in _sizes(geom, reader)) and not _errors(reader, before):
        reader.error("bad-size", "a size of a geom is not positive", geom)
    if any(float(reader.number(geom, key)) < 0 for key in ("mass", "density")):
        reader.error("impossible-mass", "a mass is not negative", geom)
    return not _errors(reader, before)


def _errors(reader: Reader, before: int) -> bool:
    return reader.complaints.error_count > before


def weighs(geom: Element, reader: Reader) -> bool:
    """Whether a geom of any type has a mass."""
    key = "mass" if geom.get("mass") else "density"
    return float(reader.number(geom, key, _DENSITY)) > 0


def _sizes(geom: Element, reader: Reader) -> tuple[str, ...]:
    """The sizes of a geom: half edges, half axes, a radius, a radius and half a length."""
    kind = geom.get("type", "sphere")
    count = _SIZES[kind]
    ends = _ends(geom, reader)
    if ends is None:
        sizes = geom.get("size").split()
        return reader.numbers(Element("geom", {"size": " ".join(sizes[:count])}, geom.span), "size", count)
    half = _shown(math.dist(*ends) / 2)
    radius = reader.numbers(Element("geom", {"size": (geom.get("size").split() or ["0"])[0]}, geom.span), "size", 1)[0]
    return (radius, half) if count == 2 else (radius, radius, half)


def _ends(geom: Element, reader: Reader) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    if not geom.get("fromto") or geom.get("type", "sphere") == "sphere":
        return None
    six = [float(part) for part in reader.numbers(geom, "fromto", 6)]
    return tuple(six[:3]), tuple(six[3:])


def _pose(geom: Element, angles: Angles, reader: Reader) -> tuple[Texts, Turns]:
    ends = _ends(geom, reader)
    if ends is None:
        return reader.three(geom, "pos"), orientation(geom, angles, reader)
    first, second = ends
    middle = [_shown((a + b) / 2) for a, b in zip(first, second, strict=True)]
    towards = [a - b for a, b in zip(first, second, strict=True)]
    return (middle[0], middle[1], middle[2]), turns_onto(*towards)


def _shown(value: float) -> str:
    return number(repr(value))


def shape_of(geom: Element, angles: Angles, reader: Reader) -> Shape:
    """What a geom looks like: full edges of a box, the whole length of a cylinder."""
    kind, sizes = geom.get("type", "sphere"), _sizes(geom, reader)
    place, turned = _pose(geom, angles, reader)
    if kind == "box":
        sizes = tuple(_twice(size) for size in sizes)
    elif kind in ("cylinder", "capsule"):
        sizes = (sizes[0], _twice(sizes[1]))
    return Shape(kind, sizes, place, turned)


def _twice(size: str) -> str:
    return number(str(2 * Decimal(size)))


def matter_of(geom: Element, angles: Angles, reader: Reader) -> Inertial | None:
    """Mass, mass centre and principal moments of a geom about its own axes; None where it weighs nothing."""
    kind = geom.get("type", "sphere")
    sizes = [Fraction(size) for size in _sizes(geom, reader)]
    place, turned = _pose(geom, angles, reader)
    mass_text = geom.get("mass")
    density = Fraction(reader.number(geom, "density", _DENSITY))
    if mass_text:
        mass = Fraction(reader.number(geom, "mass"))
        parts = _parts(kind, sizes)
        whole = sum(volume for volume, _ in parts)
        weights = [(mass * volume / whole if whole else Fraction(0), moments) for volume, moments in parts]
        factor = ""
    else:
        weights = [(density * volume, moments) for volume, moments in _parts(kind, sizes)]
        factor = "" if kind == "box" else "pi*"
    total = sum((weight for weight, _ in weights), Fraction(0))
    if not total:
        return None
    moments = [sum((weight * own[k] for weight, own in weights), Fraction(0)) for k in range(3)]
    xx, yy, zz = (_product(factor, moment) for moment in moments)
    if kind == "sphere":
        turned = ()
    return Inertial(_product(factor, total), place, turned, (xx, "0", "0", yy, "0", zz))


def _product(factor: str, value: Fraction) -> str:
    """``pi*0.0096``, ``pi*(1/3)``; what comes from a rounded length is a rounded number itself."""
    if value == 0:
        return "0"
    if max(len(str(value.numerator)), len(str(value.denominator))) > _EXACT_DIGITS:
        return _shown(float(value) * (math.pi if factor else 1))
    decimal = Decimal(value.numerator) / Decimal(value.denominator)
    return f"{factor}{number(str(decimal))}" if Fraction(decimal) == value else f"{factor}({value})"


def _parts(kind: str, sizes: list[Fraction]) -> list[tuple[Fraction, tuple[Fraction, Fraction, Fraction]]]:
    """Volumes (over pi, but for a box) with the principal moments of a unit mass about the middle.

    A capsule is a cylinder and a sphere cut in two: each half has its mass centre at 3r/8 from the cut.
    """
    if kind == "box":
        a, b, c = sizes
        return [(8 * a * b * c, ((b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3))]
    if kind == "ellipsoid":
        a, b, c = sizes
        return [(Fraction(4, 3) * a * b * c, ((b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5))]
    r = sizes[0]
    ball = Fraction(2, 5) * r * r
    if kind == "sphere":
        return [(Fraction(4, 3) * r**3, (ball, ball, ball))]
    h = sizes[1]
    across = (3 * r * r + 4 * h * h) / 12
    rod = (2 * r * r * h, (across, across, r * r / 2))
    if kind == "cylinder":
        return [rod]
    ends = ball + h * h + Fraction(3, 4) * h * r
    return [rod, (Fraction(4, 3) * r**3, (ends, ends, ball))]
