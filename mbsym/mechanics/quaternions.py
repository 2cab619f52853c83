"""Rotations as unit quaternions (Euler's parameters, those of Rodrigues and Hamilton), over any scalar.

    e = (e0, e1, e2, e3) = (cos(phi/2), n sin(phi/2)),      |e| = 1,

scalar first: the axes of the body are those of the frame j turned by phi about n.  A vector with the components v_k in
the axes of the body has in those of the frame  v_j = e o v_k o e*,  and e and -e are one orientation.

Source: Lurie, Analytical Mechanics, ch. 3; Kane, Likins & Levinson, Spacecraft Dynamics (1983), sections 1.3 and 1.13.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.matrices import dot


def cosines(algebra: Algebra, e: Sequence[Scalar]) -> list[list[Scalar]]:
    """R^jk (3 x 3), v_k = R v_j:  R = (e0^2 - v.v) 1 + 2 v v^T - 2 e0 [v x],  v = (e1, e2, e3).

    The form of second degree: at a norm that is not 1 it is |e|^2 times a rotation.
    """
    two = algebra.number(2)
    scalar, vector = e[0], e[1:]
    square = scalar * scalar - dot(vector, vector)
    found: list[list[Any]] = [[two * (vector[i] * vector[j]) for j in range(3)] for i in range(3)]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[i][i] = found[i][i] + square
        found[i][j] = found[i][j] + two * (scalar * vector[k])
        found[j][i] = found[j][i] - two * (scalar * vector[k])
    return found


def rates(algebra: Algebra, e: Sequence[Scalar], spin: Sequence[Scalar]) -> list[Scalar]:
    """e' = 1/2 e o w, w the angular velocity of the body against the frame, in the axes of the body.

    (|e|^2)' = 0 whatever e and w are.
    """
    half = algebra.number(Fraction(1, 2))
    scalar, vector = e[0], e[1:]
    found: list[Any] = [-(half * dot(vector, spin))]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found.append(half * (scalar * spin[i] + vector[j] * spin[k] - vector[k] * spin[j]))
    return found


def of_turns(algebra: Algebra, halves: Iterable[tuple[int, Scalar, Scalar]]) -> list[Scalar]:
    """e of turns one after the other, each about an axis (1, 2, 3) with the sine and cosine of half its angle."""
    found: list[Any] = [algebra.one, algebra.zero, algebra.zero, algebra.zero]
    for axis, sine, cosine in halves:
        turn = [cosine, *(sine if axis == k else algebra.zero for k in (1, 2, 3))]
        found = product(found, turn)
    return found


def product(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """a o b: what b turns first is turned by a, seen from the frame."""
    found: list[Any] = [a[0] * b[0] - dot(a[1:], b[1:])]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        x, y = a[1:], b[1:]
        found.append(a[0] * y[i] + x[i] * b[0] + x[j] * y[k] - x[k] * y[j])
    return found
