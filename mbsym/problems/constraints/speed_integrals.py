"""Problem 7 with constraints, in speeds: what  V^T M V v' = V^T (f - M a0),  u = V v + v0  keep constant.

With D = det(V^T M V) an expression I(s, u, t) is an integral if

    D (dI/dt at u' = 0) + grad_u I . (V adj(V^T M V) V^T (f - M a0) + D a0)  =  0

identically once the dependent speeds are expressed.  Tried are those of the system without constraints
(``speed_integrals``): the energy, the momenta of coordinates, of the whole system and of speeds.  Where multipliers mu
are known with dI/dt = mu . (M u' - f) in the tree, constraint forces add mu . J^T lambda, and

    J mu = 0    in every row on the constraints

is enough, however long the equations are: mu = u - s0 of the energy, the velocities of a displacement of a momentum.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import cached_property

from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import cramer, determinant
from mbsym.algebra.ring import Polynomial
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.problems.constraints.in_speeds import dependent_speeds
from mbsym.problems.constraints.motion import Embedded
from mbsym.problems.constraints.result import Constraints, Solved
from mbsym.problems.energy import Energy
from mbsym.problems.in_speeds.speed_integrals import GEOMETRIC, Field, candidates, is_new
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.integrals import ENERGY, Integral

#: Equations longer than this, or with more speeds, are not tried.
MOST_TERMS, MOST_SPEEDS = 600, 4


class TiedField:
    """The vector field of a constrained system in speeds, times D."""

    def __init__(self, form: SpeedForm, tied: Constraints, solved: Solved, embedded: Embedded) -> None:
        self.form, self.tied, self.solved, self.embedded = form, tied, solved, embedded
        self.images = dependent_speeds(form, tied, solved)

    @cached_property
    def determinant(self) -> Polynomial:
        return determinant(self.form.ring, self.embedded.mass_matrix.polynomials)

    @cached_property
    def scaled(self) -> list[Polynomial]:
        """D u', by Cramer's rule."""
        ring, found = self.form.ring, []
        own = cramer(ring, self.embedded.mass_matrix.polynomials, [x.polynomial for x in self.embedded.forcing])
        for i, shift in enumerate(self.solved.acceleration_shift):
            row = [self.solved.transformation[i, k].polynomial for k in range(len(own))]
            found.append(ring.reduce(ring.dot(row, own) + ring.times(self.determinant, shift.polynomial)))
        return found

    def on_constraints(self, x: Polynomial) -> Polynomial:
        """x with the dependent speeds expressed."""
        return self.form.ring.reduce(self.form.ring.substitute(x, self.images))

    def keeps(self, x: Polynomial) -> bool:
        """Whether dx/dt = 0 is proved for every motion."""
        ring = self.form.ring
        total = ring.times(self.determinant, self.form.drift(x))
        for u, scaled in zip(self.form.speeds, self.scaled, strict=True):
            slope = ring.derivative(x, u.name)
            if not ring.vanishes(slope):
                total = total + ring.times(slope, scaled)
        return self.form.vanishes(self.on_constraints(total)) is True


def integrals(form: SpeedForm, scene: Scene, energy: Energy, equations: SpeedEquations) -> tuple[Integral, ...]:
    """All first integrals of the kinds above, each proved; of long equations those whose multipliers are known."""
    tied, embedded = equations.constraints, equations.embedded
    if tied is None:
        return ()
    field, solved = None, tied.solved
    if solved is not None and embedded is not None and embedded.terms <= MOST_TERMS:
        field = TiedField(form, tied, solved, embedded) if len(embedded.free) <= MOST_SPEEDS else None
    tree = Field(form, equations)
    found: list[Integral] = []
    known: list[Polynomial] = []
    for integral, multipliers in candidates(form, scene, energy, equations):
        x = integral.formula.polynomial
        with suppress(Failure):  # what is too long is not known to be conserved
            on = x if field is None else field.on_constraints(x)
            proved = bool(multipliers) and _without_work(form, tied, multipliers) and tree.combines(x, multipliers)
            kept = proved is True or (field is not None and field.keeps(x))
            if kept and (integral.kind == GEOMETRIC or is_new(form, on, known)):
                found.append(integral)
                if integral.kind not in (ENERGY, GEOMETRIC):
                    known.append(on)
    return tuple(found)


def _without_work(form: SpeedForm, tied: Constraints, multipliers: Sequence[Polynomial]) -> bool:
    """Whether J mu = 0 in every row where the constraints hold: by itself, or because it is J u + j."""
    ring = form.ring
    for i in range(len(tied.names)):
        g = tied.velocity[i].polynomial
        along = ring.dot([x.polynomial for x in tied.jacobian.rows[i]], multipliers)
        if not (form.vanishes(along) is True or form.vanishes(ring.reduce(along - g)) is True):
            return False
    return True
