"""Given points of a map, each with the cell it lies in, or beside which slice, and what is said there."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import fmpq

from mbsym.algebra.plane import Point
from mbsym.algebra.plane.line import Line
from mbsym.algebra.plane.numbers import compare, sign
from mbsym.expressions.message import Message
from mbsym.maps.mapping import Judge
from mbsym.maps.result import Cell, Lack, Map, Of, Shape
from mbsym.maps.slices import Layer, Stack, at_level
from mbsym.maps.soft_borders import Onset
from mbsym.maps.subdivision import Subdivision
from mbsym.report.maps.words import cell_words
from mbsym.report.runs.trajectory_csv import text_table

#: Rows beyond this number are refused.
MOST_POINTS = 1_000_000
#: A number may be written in so many characters.
LONGEST = 200
#: Of the last so many different values of the third axis the section is kept.
_KEPT = 256

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
        return None, [Wrong(1, Message("it cannot be read: [[why]]", why=str(error)))]
    if not lines:
        return None, [Wrong(1, "it is empty: a header with the names of the axes is needed")]
    header = [name.strip() for name in lines[0]]
    wrong = [Wrong(1, Message("there is no column '[[name]]'", name=name)) for name in axes if name not in header]
    wrong += [
        Wrong(1, Message("there are two columns '[[name]]'", name=name)) for name in axes if header.count(name) > 1
    ]
    wrong += [
        Wrong(1, Message("the column '[[name]]' would be written a second time", name=name))
        for name in (WHERE, VERDICT, BORDER)
        if name in header
    ]
    if len(lines) - 1 > MOST_POINTS:
        wrong.append(Wrong(1, Message("more than [[most]] rows", most=MOST_POINTS)))
    if wrong:
        return None, wrong
    places = [header.index(name) for name in axes]
    rows, values = [], []
    for number, line in enumerate(lines[1:], start=2):
        if not line:
            continue
        if len(line) != len(header):
            wrong.append(
                Wrong(
                    number, Message("[[count]] entries under [[columns]] columns", count=len(line), columns=len(header))
                )
            )
            continue
        entries = [_number(line[k]) for k in places]
        wrong += [
            Wrong(number, Message("[[name]]: a rational or decimal number is wanted", name=name))
            for name, value in zip(axes, entries, strict=True)
            if value is None
        ]
        known = tuple(value for value in entries if value is not None)
        if len(known) == len(entries):
            rows.append(tuple(line))
            values.append(known)
    return (None, wrong) if wrong else (Points(tuple(header), tuple(rows), tuple(values)), [])


def _number(text: str) -> Fraction | None:
    match = _NUMBER.match(text) if len(text) <= LONGEST else None
    if match is None or (match[2] is not None and not int(match[2])):
        return None
    return Fraction(match[1]) / Fraction(match[2] or 1)


def located_csv(points: Points, chart: Map) -> str:
    """The same rows with the columns ``where``, ``verdict`` and, of exact maps of a line or a plane, ``border``.

    The last one: soft, hard or open at a point where a pair of roots is imaginary and none to the right.
    """
    locate = Locating(chart)
    borders = len(chart.axes) < 3 and chart.of is not Of.EQUILIBRIA and not isinstance(chart.ground, Subdivision)
    rows = (
        (*row, *locate(*values), *([locate.border(*values)] if borders else []))
        for row, values in zip(points.rows, points.values, strict=True)
    )
    return text_table((*points.header, WHERE, VERDICT, *([BORDER] if borders else [])), rows)


class Locating:
    """Finds where points of a map lie, and judges each exactly at its own place."""

    def __init__(self, found: Map) -> None:
        self.map = found
        self._judge_at = lru_cache(_KEPT)(self._new_judge)

    def __call__(self, *values: Fraction) -> tuple[str, str]:
        """(``region 3``, verdict or why there is none) of a point; ("outside of the box", "") where it lies there.

        Over three axes (``slice 4, region 3``, ...); beside a slice the region is the one that its signs single out.
        """
        if isinstance(self.map, Stack):
            return self._in_stack(self.map, values)
        cell = self.judged(*values)
        if cell is None:
            return f"outside of the {'interval' if isinstance(self.map.ground, Line) else 'box'}", ""
        white = "white " if cell.lack is Lack.UNPROVED else ""
        return f"{white}{cell.shape}{'' if white else f' {cell.number}'}", place_text(self.map, cell)

    def judged(self, *values: Fraction) -> Cell | None:
        """The cell of a rational point; an arc's verdict is found at the point itself.  None outside."""
        cell, there = self.map.at(*values), self.map.section
        if cell is not None and there is not None and cell.shape is Shape.ARC and cell.lack is None:
            return Judge(there, self.map.admissibility)(Shape.ARC, cell.number, _place(values))
        return cell

    def border(self, *values: Fraction) -> str:
        """``soft``, ``hard``, ``open`` or ``neither`` at a point with an imaginary pair and no root to the right."""
        cell = self.judged(*values)
        if cell is None or self.map.onsets is None or not cell.imaginary:
            return ""
        if cell.shape is not Shape.ARC:
            return "" if cell.soft is None else cell.soft.onset.value
        whole = self.map.arcs[cell.number].soft
        if whole is not None and whole.onset is Onset.NEITHER:
            return whole.onset.value
        return self.map.onsets.at(_place(values)).onset.value

    # --- over three axes ---

    def _in_stack(self, stack: Stack, values: Sequence[Fraction]) -> tuple[str, str]:
        if any(not axis.low <= value <= axis.high for axis, value in zip(stack.axes, values, strict=True)):
            return "outside of the box", ""
        x, y, z = (fmpq(value.numerator, value.denominator) for value in values)
        layer = _layer(stack, z)
        if layer.z == z and layer.plane is not None:
            cell = layer.plane.at(*values[:2])
            assert cell is not None
            return f"slice {layer.number}, {cell.shape} {cell.number}", place_text(stack, cell)
        beside = f"slice {layer.number}" if layer.z == z else f"beside slice {layer.number}"
        judge, broken = self._judge_at(z)
        cell = Cell(Shape.REGION, 0, lack=Lack.OUTSIDE) if broken else judge(Shape.REGION, 0, Point(x, y))
        return beside + _region(stack, layer, (x, y, z)), place_text(stack, cell)

    def _new_judge(self, z: Any) -> tuple[Judge, bool]:
        assert self.map.section is not None
        cut, admissibility = at_level(self.map.section, self.map.admissibility, z)
        return Judge(cut, admissibility), bool(admissibility.broken)


def place_text(chart: Map, cell: Cell) -> str:
    """The word of the verdict, numbers of equilibria, or why there is nothing."""
    if cell.lack is not None:
        return cell.lack.value
    return cell_words(chart, cell) if cell.word is None else cell.word.value


def _place(values: Sequence[Fraction]) -> Point:
    return Point(*(fmpq(x.numerator, x.denominator) for x in values))


def _layer(stack: Stack, z: Any) -> Layer:
    """The slice at a value, or the one between the same critical values."""
    for layer in stack.layers:
        if layer.critical and compare(layer.z, z) == 0:
            return layer
    there: Any = stack.line.locate(z)
    return next(candidate for candidate in stack.layers if not candidate.critical and candidate.z == there.sample)


def _region(stack: Stack, layer: Layer, point: Sequence[Any]) -> str:
    """``, region 3`` where one region alone has the signs of the point."""
    if layer.plane is None or layer.z == point[2]:
        return ""
    signs = tuple(sign(p(*point)) for p in stack.boundaries.factors)
    if 0 in signs:
        return ", on a curve"
    fitting = [region for region in layer.plane.regions if layer.plane.place(region).signs[: len(signs)] == signs]
    return f", region {fitting[0].number}" if len(fitting) == 1 else ""
