"""Rotations between neighbouring frames, turn by turn, over any scalar.

Passive convention: the components of one vector in old and new axes are related by v_new = C_a(x) v_old with

    C_1 = [1 0 0; 0 c s; 0 -s c],   C_2 = [c 0 -s; 0 1 0; s 0 c],   C_3 = [c s 0; -s c 0; 0 0 1].

A rotation {a1, a2, a3} by {x1, x2, x3} is C_a3(x3) C_a2(x2) C_a1(x1).  No 3x3 matrix is formed to turn a vector.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.vectors import FramesDiffer, Tensor, Vector, axis_vector
from mbsym.expressions.tree import ZERO, Expression


@dataclass(frozen=True, slots=True)
class Turn(Generic[S]):
    """One elementary rotation: axis 1, 2 or 3, the angle, its sine and cosine, its rate and second rate.

    It leads from the axes of ``source`` to those of ``frame``; a vector along its axis is the same in both.
    Axis 0 is a rotation that is given by its direction cosines, the matrix R of v_new = R v_old, and by no angle.
    """

    axis: int
    angle: Expression
    sine: S
    cosine: S
    rate: S
    second_rate: S
    source: str
    frame: str
    given: Tensor[S] | None = None

    def out(self, v: Vector[S]) -> Vector[S]:
        """C_a(x) v, from the axes of the source to those after the turn.  Raises FramesDiffer."""
        if v.frame != self.source:
            raise FramesDiffer(self.source, v.frame)
        if self.given is not None:
            return self.given @ v
        return _turned(self.axis, self.sine, self.cosine, v, self.frame)

    def back(self, v: Vector[S]) -> Vector[S]:
        """C_a(x)^T v, from the axes after the turn to those of the source.  Raises FramesDiffer."""
        if v.frame != self.frame:
            raise FramesDiffer(self.frame, v.frame)
        if self.given is not None:
            return self.given.T @ v
        return _turned(self.axis, -self.sine, self.cosine, v, self.source)


def given_rotation(cosines: Tensor[S]) -> Turn[S]:
    """The turn that a matrix of direction cosines stands for."""
    algebra = cosines.algebra
    zero, one = algebra.zero, algebra.one
    return Turn(0, ZERO, zero, one, zero, zero, cosines.source, cosines.frame, cosines)


def _turned(axis: int, s: S, c: S, v: Vector[S], frame: str) -> Vector[S]:
    i, j = axis % 3, (axis + 1) % 3
    dot, x, y = v.algebra.dot, v.components[i], v.components[j]
    turned = list(v.components)
    turned[i] = dot((c, s), (x, y))
    turned[j] = dot((c, -s), (y, x))
    return Vector(v.algebra, (turned[0], turned[1], turned[2]), frame)


def forward(turns: Sequence[Turn[S]], v: Vector[S], frame: str) -> Vector[S]:
    """R v: from the old axes to the new, those of ``frame``."""
    for turn in turns:
        v = turn.out(v)
    return v if turns else v.in_parallel(frame)


def back(turns: Sequence[Turn[S]], v: Vector[S], frame: str) -> Vector[S]:
    """R^T v: from the new axes to the old, those of ``frame``."""
    for turn in reversed(turns):
        v = turn.back(v)
    return v if turns else v.in_parallel(frame)


def direction_cosines(algebra: Algebra[S], turns: Sequence[Turn[S]], source: str, frame: str) -> Tensor[S]:
    """The matrix R of v_new = R v_old; its rows are the new axes in old components."""
    columns = [forward(turns, axis_vector(algebra, axis, algebra.one, source), frame) for axis in (1, 2, 3)]
    a, b, c = (column.components for column in columns)
    return Tensor(algebra, (a, b, c), source, frame).T
