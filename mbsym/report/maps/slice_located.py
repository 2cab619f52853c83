"""Given points of three axes: the slice each lies in or beside, and the verdict at the point itself."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import fmpq

from mbsym.algebra.plane import Point
from mbsym.algebra.plane.numbers import compare, sign
from mbsym.maps.mapping import Judge
from mbsym.maps.result import Shape, Standing, Stratum
from mbsym.maps.slices import Layer, Stack, at_level
from mbsym.report.maps.located import VERDICT, WHERE, Points, stratum_at

#: Of the last so many different values of the third axis the section is kept.
_KEPT = 256


def located_slices(points: Points, found: Stack) -> str:
    """The same rows with the columns ``where`` and ``verdict``."""
    locate = Locating(found)
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow((*points.header, WHERE, VERDICT))
    for row, values in zip(points.rows, points.values, strict=True):
        writer.writerow((*row, *locate(*values)))
    return out.getvalue()


class Locating:
    """Finds where points lie, and judges each exactly at its own place."""

    def __init__(self, found: Stack) -> None:
        self.found = found
        self._judge = lru_cache(_KEPT)(self._new_judge)

    def __call__(self, *values: Fraction) -> tuple[str, str]:
        """(``slice 4, region 3``, verdict or why there is none); ("outside of the box", "") where it lies there.

        Beside a slice the region is the one that its signs single out; the verdict is found at the point.
        """
        x, y, z = (fmpq(value.numerator, value.denominator) for value in values)
        found = self.found
        if not found.line.low <= z <= found.line.high or any(
            not axis.low <= value <= axis.high for axis, value in zip(found.section.axes, values, strict=True)
        ):
            return "outside of the box", ""
        layer = self.layer(z)
        if layer.z == z and layer.plane is not None:
            stratum = stratum_at(layer.plane, *values[:2])
            assert stratum is not None
            return f"slice {layer.number}, {stratum.shape} {stratum.number}", _told(stratum)
        beside = f"slice {layer.number}" if layer.z == z else f"beside slice {layer.number}"
        return beside + self._region(layer, (x, y, z)), _told(self.judged(x, y, z))

    def layer(self, z: Any) -> Layer:
        """The slice at a value, or the one between the same critical values."""
        for layer in self.found.layers:
            if layer.critical and compare(layer.z, z) == 0:
                return layer
        interval = next(one for one in self.found.line.intervals if _holds(self.found, one.ends, z))
        return next(one for one in self.found.layers if not one.critical and one.z == interval.sample)

    def judged(self, x: Any, y: Any, z: Any) -> Stratum:
        """What is proved at a point, which is no matter of slices."""
        judge, broken = self._judge(z)
        return Stratum(Shape.REGION, 0, Standing.OUTSIDE) if broken else judge(Shape.REGION, 0, Point(x, y))

    def _new_judge(self, z: Any) -> tuple[Judge, bool]:
        cut, kept = at_level(self.found.section, self.found.admissibility, z)
        return Judge(cut, kept), bool(kept.broken)

    def _region(self, layer: Layer, point: Sequence[Any]) -> str:
        """``, region 3`` where one region alone has the signs of the point."""
        if layer.plane is None or layer.z == point[2]:
            return ""
        signs = tuple(sign(p(*point)) for p in self.found.boundaries.factors)
        if 0 in signs:
            return ", on a curve"
        fitting = [one.id for one in layer.plane.arrangement.regions if one.signs[: len(signs)] == signs]
        return f", region {fitting[0]}" if len(fitting) == 1 else ""


def _holds(found: Stack, ends: tuple[int | None, int | None], z: Any) -> bool:
    low, high = ends
    above = low is None or compare(found.line.zeros[low].number, z) < 0
    return above and (high is None or compare(found.line.zeros[high].number, z) > 0)


def _told(stratum: Stratum) -> str:
    return stratum.standing.value if stratum.word is None else stratum.word.value
