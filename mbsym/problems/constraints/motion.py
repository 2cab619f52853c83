"""Problem 3 with constraints: the equations with multipliers, and those without.

    M q'' = f + J^T lambda,    J q'' + gamma = 0           with multipliers, J of the independent rows
    Y^T M Y u' = Y^T (f - M a0),   q' = Y u + y0           embedded (Maggi's equations)

with q'' = Y u' + a0.  M and f are those of the open tree.  In the embedded equations the dependent velocities are
expressed by the independent ones; the dependent coordinates stay, and phi(q, t) = 0 goes with them.

Sources: G. A. Maggi, Principii di stereodinamica (1901); Neimark & Fufaev, chapter 3.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.formula import Column, Matrix, column
from mbsym.formulas.notebook import Shown
from mbsym.mechanics.constraints.embedding import projected
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.constraints.result import Constraints, Solved
from mbsym.problems.equations import Equations


@dataclass(frozen=True, repr=False)
class Embedded(Shown):
    """Y^T M Y (symmetric) and Y^T (f - M a0) in the independent velocities, which are those of ``free``."""

    free: tuple[str, ...]
    mass_matrix: Matrix
    forcing: Column

    @property
    def terms(self) -> int:
        """Terms of both."""
        return self.mass_matrix.terms + sum(x.terms for x in self.forcing)


def embedded_equations(scene: Scene, equations: Equations, found: Constraints) -> Embedded:
    """The equations without multipliers (scene over the ring).

    Raises NoClosedForm where they outgrow the budget.
    """
    if found.solved is None:
        raise NoClosedForm("the dependent velocities have no closed form within the budget of terms")
    ring, n = scene.ring, len(found.coordinates)
    mass = [[equations.mass_matrix[i, j].polynomial for j in range(n)] for i in range(n)]
    forcing = [x.polynomial for x in equations.forcing]
    matrix, right = projected(ring, found.solved.embedding, mass, forcing)
    speeds = dependent_velocities(ring, found, found.solved)
    right = [ring.substitute(x, speeds) for x in right]
    return Embedded(found.free, Matrix.of(ring, matrix), column(ring, [ring.reduce(x) for x in right]))


def dependent_velocities(ring: Ring, found: Constraints, solved: Solved) -> dict[int, Polynomial]:
    """The generators of the dependent velocities, and what they are: S u + s."""
    free = [ring.generator("velocity", name) for name in found.free]
    parts = zip(found.dependent, solved.embedding.matrix, solved.embedding.shift, strict=True)
    return {
        ring.index("velocity", name): ring.reduce(
            sum((ring.times(x, u) for x, u in zip(row, free, strict=True)), shift)
        )
        for name, row, shift in parts
    }
