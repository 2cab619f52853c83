"""Exact points of a line and of the plane: algebraic numbers, the fields that they make, zeros on a line."""

from mbsym.algebra.plane.fields import Point
from mbsym.algebra.plane.line import Interval, Line, Zero, decompose_line
from mbsym.algebra.plane.numbers import AlgebraicNumber
from mbsym.algebra.plane.projection import Box, Budget
