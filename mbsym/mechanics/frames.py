"""Rotations between neighbouring frames, turn by turn, over any scalar.

Passive convention: the components of one vector in old and new axes are related by v_new = C_a(x) v_old with

    C_1 = [1 0 0; 0 c s; 0 -s c],   C_2 = [c 0 -s; 0 1 0; s 0 c],   C_3 = [c s 0; -s c 0; 0 0 1].

A rotation {a1, a2, a3} by {x1, x2, x3} is C_a3(x3) C_a2(x2) C_a1(x1).  No 3x3 matrix is formed to turn a vector.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Generic

from mbsym.algebra.base import Algebra, S, Scalar
from mbsym.algebra.matrices import dot
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
    matrix: Tensor[S] | None = None

    def out(self, v: Vector[S]) -> Vector[S]:
        """C_a(x) v, from the axes of the source to those after the turn.  Raises FramesDiffer."""
        if v.frame != self.source:
            raise FramesDiffer(self.source, v.frame)
        if self.matrix is not None:
            return self.matrix @ v
        return _turned(self.axis, self.sine, self.cosine, v, self.frame)

    def back(self, v: Vector[S]) -> Vector[S]:
        """C_a(x)^T v, from the axes after the turn to those of the source.  Raises FramesDiffer."""
        if v.frame != self.frame:
            raise FramesDiffer(self.frame, v.frame)
        if self.matrix is not None:
            return self.matrix.T @ v
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


# Rotations as unit quaternions (Euler's parameters, those of Rodrigues and Hamilton), over any scalar.
#
#     e = (e0, e1, e2, e3) = (cos(phi/2), n sin(phi/2)),      |e| = 1,
#
# scalar first: the axes of the body are those of the frame j turned by phi about n.  A vector with the components v_k
# in the axes of the body has in those of the frame  v_j = e o v_k o e*,  and e and -e are one orientation.
#
# Source: Lurie, Analytical Mechanics, ch. 3; Kane, Likins & Levinson, Spacecraft Dynamics (1983), sections 1.3 and
# 1.13.


def cosines(algebra: Algebra, e: Sequence[Scalar]) -> list[list[Scalar]]:
    """R^jk (3 x 3), v_k = R v_j:  R = (e0^2 - v.v) 1 + 2 v v^T - 2 e0 [v x],  v = (e1, e2, e3).

    The form of second degree: at a norm that is not 1 it is |e|^2 times a rotation.
    """
    two = algebra.number(2)
    scalar, vector = e[0], e[1:]
    square = scalar * scalar - dot(vector, vector)
    rows: list[list[Any]] = [[two * (vector[i] * vector[j]) for j in range(3)] for i in range(3)]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[i][i] = rows[i][i] + square
        rows[i][j] = rows[i][j] + two * (scalar * vector[k])
        rows[j][i] = rows[j][i] - two * (scalar * vector[k])
    return rows


def rates(algebra: Algebra, e: Sequence[Scalar], spin: Sequence[Scalar]) -> list[Scalar]:
    """e' = 1/2 e o w, w the angular velocity of the body against the frame, in the axes of the body.

    (|e|^2)' = 0 whatever e and w are.
    """
    half = algebra.number(Fraction(1, 2))
    scalar, vector = e[0], e[1:]
    scalars: list[Any] = [-(half * dot(vector, spin))]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        scalars.append(half * (scalar * spin[i] + vector[j] * spin[k] - vector[k] * spin[j]))
    return scalars


def of_turns(algebra: Algebra, halves: Iterable[tuple[int, Scalar, Scalar]]) -> list[Scalar]:
    """e of turns one after the other, each about an axis (1, 2, 3) with the sine and cosine of half its angle."""
    scalars: list[Any] = [algebra.one, algebra.zero, algebra.zero, algebra.zero]
    for axis, sine, cosine in halves:
        turn = [cosine, *(sine if axis == k else algebra.zero for k in (1, 2, 3))]
        scalars = product(scalars, turn)
    return scalars


def product(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """a o b: what b turns first is turned by a, seen from the frame."""
    scalars: list[Any] = [a[0] * b[0] - dot(a[1:], b[1:])]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        x, y = a[1:], b[1:]
        scalars.append(a[0] * y[i] + x[i] * b[0] + x[j] * y[k] - x[k] * y[j])
    return scalars
