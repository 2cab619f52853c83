"""The ways in which MJCF turns axes, as passive turns in the order of turning."""

from __future__ import annotations

import math
from dataclasses import dataclass

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.reader import Element, Reader, angle, degrees, number
from mbsym.source.robots.robot import Turns

Row = tuple[float, float, float]

#: Columns are the new axes in the old ones.
Matrix = tuple[Row, Row, Row]

#: The attributes that turn something.
TURNING = ("quat", "axisangle", "xyaxes", "zaxis", "euler")

#: Below this the yaw and the roll of a turn cannot be told apart.
_LEVEL = 1e-12


@dataclass(frozen=True)
class Angles:
    """How a file means its angles: in degrees, and in which sequence (lower case: about the turned axes)."""

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
        parts = tuple(map(float, reader.numbers(element, "quat", 4)))
        if not any(parts):
            reader.error("bad-axis", "a quaternion of length zero", element)
            return ()
        return _of_quaternion(*parts)
    if element.get("xyaxes"):
        six = [float(part) for part in reader.numbers(element, "xyaxes", 6)]
        return _of_axes(_unit(six[0], six[1], six[2]), (six[3], six[4], six[5]))
    if element.get("zaxis"):
        first, second, third = reader.three(element, "zaxis")
        return turns_onto(float(first), float(second), float(third))
    return ()


def _euler(element: Element, angles: Angles, reader: Reader) -> Turns:
    sequence = angles.sequence
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz") or not (sequence.islower() or sequence.isupper()):
        reader.error("unsupported", f"the sequence {ascii_safe(sequence)} of Euler angles", element)
        return ()
    parts = reader.three(element, "euler", raw=True)
    axes = ["xyz".index(letter) + 1 for letter in sequence.lower()]
    turns = [(axis, angles.text(part, reader)) for axis, part in zip(axes, parts, strict=True)]
    ordered = turns if sequence.islower() else turns[::-1]  # about fixed axes: the last turn comes first
    return tuple(turn for turn in ordered if turn[1] != "0")


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


def _of_quaternion(w: float, x: float, y: float, z: float) -> Turns:
    n = w * w + x * x + y * y + z * z
    s = 2 / n
    return _of_matrix(
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
    return _of_matrix(((x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])))


def _of_matrix(matrix: Matrix) -> Turns:
    """R = Rz(yaw) Ry(pitch) Rx(roll), which as passive turns are about the axes 3, 2, 1 in that order."""
    (a, b, _), (d, e, _), (g, h, i) = matrix
    flat = math.hypot(a, d)
    pitch = math.atan2(-g, flat)
    if flat > _LEVEL:
        yaw, roll = math.atan2(d, a), math.atan2(h, i)
    else:
        yaw, roll = math.atan2(-b, e), 0.0
    turns = ((3, yaw), (2, pitch), (1, roll))
    return tuple((axis, words) for axis, value in turns if (words := _spelled(value)) != "0")


def _spelled(value: float) -> str:
    """The angle as a part of pi where it is one up to rounding, zero where it is nothing but rounding."""
    return "0" if abs(value) < 1e-15 else angle(repr(value)) if abs(value) > _LEVEL else number(repr(value))


def _opposite(words: str) -> str:
    return words[1:] if words.startswith("-") else f"-{words}"
