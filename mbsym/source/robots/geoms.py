"""Geoms of MJCF: what they look like and what they weigh.  Masses are exact (those of round bodies hold pi) where the
lengths are: between two given ends they are rounded to a double.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.orientation import Angles, orientation, turns_onto
from mbsym.source.robots.reader import Element, Reader, Texts, number
from mbsym.source.robots.robot import Inertial, Shape, Turns

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_OTHERS = ("plane", "hfield", "mesh", "sdf")
_DENSITY = "1000"

#: Longer numerators and denominators come from lengths that were rounded to doubles.
_EXACT_DIGITS = 20


def is_solid(geom: Element) -> bool:
    """Whether it is a body whose inertia follows from its sizes."""
    return geom.get("type", "sphere") in _SIZES


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
        given = geom.get("size").split()
        return reader.numbers(Element("geom", {"size": " ".join(given[:count])}, geom.span), "size", count)
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
    given = geom.get("mass")
    density = Fraction(reader.number(geom, "density", _DENSITY))
    if given:
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
