"""Exact arrangements of algebraic curves in a box of the plane, and of points on a line."""

from mbsym.algebra.plane.arrangement import Arc, Arrangement, Corner, CornerKind, Region
from mbsym.algebra.plane.decomposition import decompose
from mbsym.algebra.plane.drawing import areas, polyline
from mbsym.algebra.plane.line import Interval, Line, Zero, decompose_line
from mbsym.algebra.plane.numbers import AlgebraicNumber
from mbsym.algebra.plane.points import Point
from mbsym.algebra.plane.projection import Box, Budget
from mbsym.algebra.plane.space import Slice, critical_levels, decompose_space

__all__ = [
    "AlgebraicNumber",
    "Arc",
    "Arrangement",
    "Box",
    "Budget",
    "Corner",
    "CornerKind",
    "Interval",
    "Line",
    "Point",
    "Region",
    "Slice",
    "Zero",
    "areas",
    "critical_levels",
    "decompose",
    "decompose_line",
    "decompose_space",
    "polyline",
]
