"""The matrices of a system that is given by these, over any algebra:

    M x'' + C x' + S x = B u,    C = D + G,    S = K + N

M is the unit matrix where it was left out, everything else zero.  Of  x' = A x + B u:  M = 0, C = 1, S = -A.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from mbsym.algebra.base import S
from mbsym.algebra.failures import GivenByMatrices
from mbsym.algebra.matrices import ScalarMatrix
from mbsym.expressions.message import Message
from mbsym.mechanics.kinematics import Scene
from mbsym.model.linear import LinearModel
from mbsym.model.system import System


class GivenMatrices(NamedTuple, Generic[S]):
    """M, C = D + G, S = K + N (n x n) and B (n x m)."""

    mass: ScalarMatrix[S]
    rates: ScalarMatrix[S]
    places: ScalarMatrix[S]
    inputs: ScalarMatrix[S]


def given_matrices(scene: Scene[S], linear: LinearModel) -> GivenMatrices[S]:
    """M, C, S, B as ``scene`` lowers formulas."""
    size, matrix = len(linear.coordinates), linear.matrix("B")
    inputs = 0 if matrix is None else len(matrix.rows[0])

    def lowered(key: str, columns: int) -> ScalarMatrix[S]:
        given_matrix, algebra = linear.matrix(key), scene.algebra
        if given_matrix is not None:
            return ScalarMatrix(algebra, [[scene.lower(x) for x in row] for row in given_matrix.rows])
        unit = key == "M"
        return ScalarMatrix.by_entry(
            algebra, size, columns, lambda i, j: algebra.one if unit and i == j else algebra.zero
        )

    def total(keys: Sequence[str]) -> ScalarMatrix[S]:
        first, *others = (lowered(key, size) for key in keys)
        for other in others:
            first = first + other
        return first

    if linear.of_first_order:
        nothing = lowered("D", size)
        return GivenMatrices(nothing, lowered("M", size), -lowered("A", size), lowered("B", inputs))
    return GivenMatrices(lowered("M", size), total(("D", "G", "C")), total(("K", "N", "S")), lowered("B", inputs))


WITHOUT_BODIES = Message("the system is given by its matrices, and has no bodies")


def refuse_matrices(system: System, what: str) -> None:
    """Raises GivenByMatrices if the system has matrices in place of bodies."""
    if system.linear is not None:
        raise GivenByMatrices("[[what]]: [[why]]", what=what, why=WITHOUT_BODIES, remedy=HINT)


HINT = "the linear equations themselves are in problem 5"
