"""Given points of a map's plane, each with the region, arc or corner it lies in and the verdict there."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpq

from mbsym.algebra.arrangements import Arc, Corner
from mbsym.algebra.plane import Point
from mbsym.algebra.plane.line import Zero
from mbsym.maps.mapping import Judge
from mbsym.maps.result import LineMap, PlaneMap, Shape, Standing, Stratum
from mbsym.maps.soft_borders import Onset

#: Rows beyond this number are refused.
MOST_POINTS = 1_000_000
#: A number may be written in so many characters.
LONGEST = 200

_NUMBER = re.compile(r"\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,3})?)(?:/(\d+))?\s*\Z", re.ASCII)

WHERE, VERDICT, BORDER = "where", "verdict", "border"


@dataclass(frozen=True)
class Points:
    """``rows`` as they were read, with the ``header``; ``values`` are the coordinates in the order of the axes."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    values: tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Wrong:
    """What is wrong in a line of the file (1 is the header)."""

    line: int
    message: str


def read_points(text: str, axes: Sequence[str]) -> tuple[Points | None, list[Wrong]]:
    """The points of a CSV file that has a column for each axis, by name; every mistake at once."""
    try:
        lines = list(csv.reader(io.StringIO(text, newline="")))
    except csv.Error as error:
        return None, [Wrong(1, f"it cannot be read: {error}")]
    if not lines:
        return None, [Wrong(1, "it is empty: a header with the names of the axes is needed")]
    header = [name.strip() for name in lines[0]]
    wrong = [Wrong(1, f"there is no column '{name}'") for name in axes if name not in header]
    wrong += [Wrong(1, f"there are two columns '{name}'") for name in axes if header.count(name) > 1]
    wrong += [
        Wrong(1, f"the column '{name}' would be written a second time")
        for name in (WHERE, VERDICT, BORDER)
        if name in header
    ]
    if len(lines) - 1 > MOST_POINTS:
        wrong.append(Wrong(1, f"more than {MOST_POINTS} rows"))
    if wrong:
        return None, wrong
    places = [header.index(name) for name in axes]
    rows, values = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not line:
            continue
        if len(line) != len(header):
            wrong.append(Wrong(number, f"{len(line)} entries under {len(header)} columns"))
            continue
        found = [_number(line[k]) for k in places]
        wrong += [
            Wrong(number, f"{name}: a rational or decimal number is wanted")
            for name, value in zip(axes, found, strict=True)
            if value is None
        ]
        known = tuple(value for value in found if value is not None)
        if len(known) == len(found):
            rows.append(tuple(line))
            values.append(known)
    return (None, wrong) if wrong else (Points(tuple(header), tuple(rows), tuple(values)), [])


def _number(text: str) -> Fraction | None:
    match = _NUMBER.match(text) if len(text) <= LONGEST else None
    if match is None or (match[2] is not None and not int(match[2])):
        return None
    return Fraction(match[1]) / Fraction(match[2] or 1)


def located_csv(points: Points, found: PlaneMap | LineMap) -> str:
    """The same rows with the columns ``where``, ``verdict`` and ``border``.

    The last one: soft, hard or open at a point where a pair of roots is imaginary and none to the right.
    """
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow((*points.header, WHERE, VERDICT, BORDER))
    for row, values in zip(points.rows, points.values, strict=True):
        stratum = judged_at(found, *values)
        writer.writerow((*row, *_told(found, stratum), "" if stratum is None else _border(found, stratum, values)))
    return out.getvalue()


def located(found: PlaneMap | LineMap, *values: Fraction) -> tuple[str, str]:
    """(``region 3``, verdict or why there is none) of a point; ("outside of the box", "") where it lies there.

    On an arc the verdict is that of the point itself.
    """
    return _told(found, judged_at(found, *values))


def judged_at(found: PlaneMap | LineMap, *values: Fraction) -> Stratum | None:
    """The region, arc or corner of a rational point; an arc's verdict is found at the point itself.  None outside."""
    stratum = stratum_at(found, *values)
    if stratum is not None and stratum.shape is Shape.ARC and stratum.standing is Standing.JUDGED:
        # an arc's verdict is that of its own exact point: here it is found at the point that is asked about
        return Judge(found.section, found.admissibility)(Shape.ARC, stratum.number, _place(values))
    return stratum


def _place(values: Sequence[Fraction]) -> Point:
    return Point(*(fmpq(x.numerator, x.denominator) for x in values))


def _told(found: PlaneMap | LineMap, stratum: Stratum | None) -> tuple[str, str]:
    if stratum is None:
        return "outside of the interval" if isinstance(found, LineMap) else "outside of the box", ""
    word = stratum.word
    return f"{stratum.shape} {stratum.number}", stratum.standing.value if word is None else word.value


def _border(found: PlaneMap | LineMap, stratum: Stratum, values: Sequence[Fraction]) -> str:
    """``soft``, ``hard``, ``open`` or ``neither`` at a point with an imaginary pair and no root to the right."""
    if found.borders is None or not stratum.imaginary:
        return ""
    if stratum.shape is not Shape.ARC:
        return "" if stratum.soft is None else stratum.soft.onset.value
    whole = found.arcs[stratum.number].soft
    if whole is not None and whole.onset is Onset.NEITHER:
        return whole.onset.value
    return found.borders.at(_place(values)).onset.value


def stratum_at(found: PlaneMap | LineMap, *values: Fraction) -> Stratum | None:
    """The region, arc or corner of a rational point, exactly (interval or zero of a line); None outside."""
    at = tuple(fmpq(x.numerator, x.denominator) for x in values)
    if isinstance(found, LineMap):
        if not found.line.low <= at[0] <= found.line.high:
            return None
        there = found.line.locate(at[0])
        return found.corners[there.id] if isinstance(there, Zero) else found.regions[there.id]
    x, y = at
    if (x, y) not in found.arrangement.box:
        return None
    place = found.arrangement.locate(x, y)
    if isinstance(place, Arc):
        return found.arcs[place.id]
    if isinstance(place, Corner):
        return found.corners[place.id]
    return found.regions[place.id]
