"""Problem 3 with constraints: the equations with multipliers, and those without.

    M q'' = f + J^T lambda,    J q'' + gamma = 0           with multipliers, J of the independent rows
    Y^T M Y u' = Y^T (f - M a0),   q' = Y u + y0           embedded (Maggi's equations)

with q'' = Y u' + a0.  M and f are those of the open tree.  In the embedded equations the dependent velocities are
expressed by the independent ones; the dependent coordinates stay, and phi(q, t) = 0 goes with them.  In speeds of their
own it is the same with these for q', and with Kane's equations of the tree.

Sources: G. A. Maggi, Principii di stereodinamica (1901); Neimark & Fufaev, chapter 3.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial
from mbsym.formulas.formula import Column, Matrix, Shown, column
from mbsym.mechanics.constraints.embedding import projected
from mbsym.mechanics.speeds import SpeedForm
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


def embedded_equations(form: SpeedForm, equations: Equations, found: Constraints) -> Embedded:
    """The equations without multipliers, of the equations of the tree.  Raises NoClosedForm beyond the budget."""
    if found.solved is None:
        raise NoClosedForm("the dependent velocities have no closed form within the budget of terms")
    ring, forcing = form.ring, [x.polynomial for x in equations.forcing]
    matrix, right = projected(ring, found.solved.embedding, equations.mass_matrix.polynomials, forcing)
    images = dependent_velocities(form, found.solved)
    right = [ring.reduce(ring.substitute(x, images)) for x in right]
    return Embedded(found.free, Matrix.of(ring, matrix), column(ring, right))


def dependent_velocities(form: SpeedForm, solved: Solved) -> dict[int, Polynomial]:
    """The generators of the dependent speeds or velocities, and what they are: S u + s."""
    ring, found = form.ring, solved.embedding
    free = [ring.context.gen(form.speeds[k].index) for k in found.free]
    return {
        form.speeds[k].index: ring.reduce(sum((ring.times(x, u) for x, u in zip(row, free, strict=True)), shift))
        for k, row, shift in zip(found.dependent, found.matrix, found.shift, strict=True)
    }
