"""First integrals as functions of what is constant on a steady motion, with their first and second derivatives.

Coordinates that neither L nor any force contains are left out (they turn, or may have any value): the others and all
velocities are the variables z of a reduced system, on which every integral that does not contain the coordinates left
out is a function.  Components of a conserved momentum that turn with them come as the sum of their squares.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, enumerated, worded
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import programs
from mbsym.mechanics.symmetry import is_free_about_the_origin
from mbsym.problems import equations as lagrange
from mbsym.problems import integrals as first_integrals
from mbsym.problems.energy import Energy
from mbsym.problems.integrals import ENERGIES, Integral
from mbsym.problems.stability.bundle import Element, NumberField, definite_combination
from mbsym.problems.stability.reasons import Because, Reason
from mbsym.problems.stability.theorems import Fact
from mbsym.problems.stability.verdict import Verdict, concluded, drifting

#: How the name of a sum of squares of components of a momentum begins.
SQUARE = "square of the "
#: Momenta of more terms than this are not squared.
MOST_TERMS = 80
#: Coordinates of systems whose integrals are looked for.
MOST_COORDINATES = 8


@dataclass(frozen=True)
class Conserved:
    """``names`` and ``polynomials`` of proved integrals, functions of ``coordinates`` and of all ``velocities``."""

    ring: Ring
    names: tuple[str, ...]
    polynomials: tuple[Polynomial, ...]
    coordinates: tuple[str, ...]
    velocities: tuple[str, ...]

    def derivatives(self, x: Polynomial) -> list[Polynomial]:
        """dx/dz, coordinates first."""
        ring = self.ring
        of_places = [ring.derivative(x, name) for name in self.coordinates]
        return of_places + [ring.velocity_derivative(x, name) for name in self.velocities]

    @cached_property
    def gradients(self) -> list[list[Polynomial]]:
        """m x N."""
        return [self.derivatives(x) for x in self.polynomials]

    @cached_property
    def hessians(self) -> list[list[list[Polynomial]]]:
        """m times N x N."""
        return [[self.derivatives(x) for x in row] for row in self.gradients]

    def combination(self, value: Callable[[Polynomial], Element | None], field: NumberField) -> tuple[str, ...] | None:
        """The names of integrals of which a combination is definite at a state; None where none was found.

        ``value``: a polynomial at the state, as an element of the field, or None where it has no such value.
        """
        gradients = [[value(x) for x in row] for row in self.gradients]
        if any(x is None for row in gradients for x in row):
            return None
        hessians = [[[value(x) for x in row] for row in rows] for rows in self.hessians]
        if any(x is None for rows in hessians for row in rows for x in row):
            return None
        multipliers = definite_combination(gradients, hessians, field)
        if multipliers is None:
            return None
        kept = [name for name, mu in zip(self.names, multipliers, strict=True) if not mu.contains(0)]
        return tuple(kept) or self.names


def by_integrals(names: Sequence[str], drift: bool) -> Verdict:
    """Stability by the integrals called ``names``; ``drift``: with respect to what is not cyclic."""
    verdict = concluded({Fact.INTEGRALS_DEFINITE}, Reason(Because.INTEGRALS, tuple(map(worded, names))))
    return drifting(verdict) if drift else verdict


def conserved(scene: Scene, energy: Energy, left_out: Sequence[str], steady: Sequence[str]) -> Conserved | None:
    """The integrals of a system, ``left_out`` the coordinates that neither L nor any force contains.

    ``steady``: those that turn at a constant rate.

    None where the energy is not conserved or no momentum is, and where the motion is steady in no such reduced system.
    """
    system = scene.system
    if not {*steady} <= {*left_out} or len(system.coordinates) > MOST_COORDINATES:
        return None
    try:
        known = first_integrals.integrals(
            scene, energy, lagrange.equations(scene, energy), programs(system, scene.ring)
        )
    except NOT_THERE:
        return None
    return of_integrals(scene, known, left_out)


def of_integrals(scene: Scene, known: Sequence[Integral], left_out: Sequence[str]) -> Conserved | None:
    """The same from the integrals of problem 7."""
    ring, system = scene.ring, scene.system
    hidden = [*left_out, *(item.name for item in system.prescribed), "t"]
    free = is_free_about_the_origin(system)
    proved = [item for item in known if item.status is Certainty.PROVED or (free and item.kind == "angular momentum")]
    found = [(item.name, item.formula.polynomial) for item in proved]
    for kind in ("linear momentum", "angular momentum"):
        parts = [item for item in proved if item.kind == kind and ring.dependencies(item.formula.polynomial, hidden)]
        for count in (2, 3):
            for chosen in combinations(parts, count):
                if any(len(item.formula.polynomial) > MOST_TERMS for item in chosen):
                    continue
                axes = enumerated([item.of for item in chosen])
                try:
                    square = sum((ring.times(x, x) for item in chosen if (x := item.formula.polynomial)), ring.zero)
                    found.append(
                        (
                            Message("square of the [[kind]] across ([[axes]])", kind=Message(kind), axes=axes),
                            ring.reduce(square),
                        )
                    )
                except Failure:
                    continue
    seen = [(name, x) for name, x in found if not ring.dependencies(x, hidden)]
    if len(seen) < 2 or not any(item.kind in ENERGIES for item in proved):
        return None
    kept = tuple(name for name in system.coordinates if name not in left_out)
    return Conserved(ring, tuple(name for name, _ in seen), tuple(x for _, x in seen), kept, system.coordinates)
