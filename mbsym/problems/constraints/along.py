"""Whether something vanishes along every motion of a constrained system.

With  q'' = Y u' + a0  and  Y^T M Y u' = Y^T (f - M a0)  an expression x(q, q', q'', t) is a function of positions on
the constraints and of independent velocities.  It is tried at exact states on the constraints; that it vanishes is
proved in the ring, where the equations without multipliers are short enough and x is linear in q'', by

    det(Y^T M Y) x = 0        u' by Cramer's rule, dependent velocities expressed by the independent ones

which does not use the constraints between positions: what vanishes on these alone is verified numerically.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Polynomial
from mbsym.mechanics.constraints.embedding import basis_vector
from mbsym.mechanics.constraints.ranks import is_certain
from mbsym.mechanics.constraints.states import OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.constraints.checks import accelerated
from mbsym.problems.constraints.motion import Embedded, dependent_velocities
from mbsym.problems.constraints.result import Constraints, Solved

#: At so many states an expression must vanish.
STATES = 4
#: Equations longer than this are not tried for a proof.
MOST_TERMS, MOST_SPEEDS = 600, 4


class AlongMotion:
    """Expressions along the motions of a system over the ring."""

    def __init__(self, scene: Scene, tied: Constraints, solved: Solved, embedded: Embedded) -> None:
        self.scene, self.ring = scene, scene.ring
        self.tied, self.solved, self.embedded = tied, solved, embedded
        self.velocities = dependent_velocities(self.ring, tied, solved)

    def restricted(self, x: Polynomial) -> Polynomial:
        """x on the velocities that the constraints allow."""
        return self.ring.reduce(self.ring.substitute(x, self.velocities))

    def values(self, x: Polynomial, states: Sequence[OnManifold]) -> list[tuple[OnManifold, Any]]:
        """x at those of the states where the equations have a solution, with their accelerations."""
        found = []
        for one in states:
            carry = Carrier(self.ring, one.state.numbers, one.state.values)
            try:
                moved = accelerated(one.state, carry, self.tied, self.embedded)
            except ZeroDivisionError:
                continue
            found.append((one, Carrier(self.ring, moved.numbers, moved.values)(x)))
        return found

    def vanishes_at(self, x: Polynomial, states: Sequence[OnManifold]) -> bool:
        """Whether x is zero, or cannot be told from it, at STATES states; False where there are fewer."""
        found = self.values(x, states)
        return len(found) == STATES and not any(is_certain(value) for _, value in found)

    def along_speeds(self, slopes: Sequence[Polynomial]) -> list[Polynomial]:
        """Y^T slopes: derivatives by q'' (by q') as those by u' (by u)."""
        basis = [basis_vector(self.ring, self.solved.embedding, place) for place in range(len(self.tied.free))]
        return [self.restricted(self.ring.dot(slopes, y)) for y in basis]

    def proves_zero(self, x: Polynomial, slopes: Sequence[Polynomial]) -> bool:
        """Whether x = 0 is an identity; ``slopes`` are dx/dq'', in which x must be linear."""
        ring, k = self.ring, len(self.tied.free)
        if self.embedded.terms > MOST_TERMS or k > MOST_SPEEDS:
            return False
        try:
            mass = [list(row) for row in self.embedded.mass_matrix.polynomials]
            right = [y.polynomial for y in self.embedded.forcing]
            along = self.along_speeds(slopes)
            still = {ring.index("acceleration", name): ring.zero for name in self.tied.coordinates}
            rest = ring.substitute(x, still)
            a0 = [y.polynomial for y in self.solved.acceleration_shift]
            rest = self.restricted(rest + ring.dot(slopes, a0))
            left = ring.times(determinant(ring, mass), rest)
            for j in range(k):  # Cramer's rule: a column replaced by the right-hand sides
                if not ring.vanishes(along[j]):
                    replaced = [[right[i] if c == j else mass[i][c] for c in range(k)] for i in range(k)]
                    left = left + ring.times(along[j], determinant(ring, replaced))
            return ring.is_zero(ring.reduce(left)) is True
        except Failure:
            return False
