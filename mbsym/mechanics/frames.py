"""Rotations between neighbouring frames, turn by turn, over any scalar.

Passive convention: the components of one vector in old and new axes are related by v_new = C_a(x) v_old with

    C_1 = [1 0 0; 0 c s; 0 -s c],   C_2 = [c 0 -s; 0 1 0; s 0 c],   C_3 = [c s 0; -s c 0; 0 0 1].

A rotation {a1, a2, a3} by {x1, x2, x3} is C_a3(x3) C_a2(x2) C_a1(x1).  No 3x3 matrix is formed to turn a vector.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.base import Algebra, Scalar, Vector
from mbsym.expressions.tree import Expression


@dataclass(frozen=True, slots=True)
class Turn:
    """One elementary rotation: axis 1, 2 or 3, the angle, its sine and cosine, its rate and second rate."""

    axis: int
    angle: Expression
    sine: Scalar
    cosine: Scalar
    rate: Scalar
    second_rate: Scalar


def turn_forward(algebra: Algebra, turn: Turn, v: Vector) -> Vector:
    """C_a(x) v."""
    return _turn(algebra, turn.axis, turn.sine, turn.cosine, v)


def turn_back(algebra: Algebra, turn: Turn, v: Vector) -> Vector:
    """C_a(x)^T v."""
    return _turn(algebra, turn.axis, -turn.sine, turn.cosine, v)


def _turn(algebra: Algebra, axis: int, s: Scalar, c: Scalar, v: Vector) -> Vector:
    i, j = axis % 3, (axis + 1) % 3
    turned = list(v)
    turned[i] = algebra.dot((c, s), (v[i], v[j]))
    turned[j] = algebra.dot((c, -s), (v[j], v[i]))
    return (turned[0], turned[1], turned[2])


def forward(algebra: Algebra, turns: Sequence[Turn], v: Vector) -> Vector:
    """R v: from the old axes to the new."""
    for turn in turns:
        v = turn_forward(algebra, turn, v)
    return v


def back(algebra: Algebra, turns: Sequence[Turn], v: Vector) -> Vector:
    """R^T v: from the new axes to the old."""
    for turn in reversed(turns):
        v = turn_back(algebra, turn, v)
    return v


def axis_vector(algebra: Algebra, axis: int, length: Scalar) -> Vector:
    """length * e_axis."""
    components = [algebra.zero] * 3
    components[axis - 1] = length
    return (components[0], components[1], components[2])


def direction_cosines(algebra: Algebra, turns: Sequence[Turn]) -> tuple[Vector, Vector, Vector]:
    """The matrix R of v_new = R v_old; its rows are the new axes in old components."""
    columns = [forward(algebra, turns, axis_vector(algebra, axis, algebra.one)) for axis in (1, 2, 3)]
    rows = [(columns[0][i], columns[1][i], columns[2][i]) for i in range(3)]
    return (rows[0], rows[1], rows[2])
