"""Problem 3: nonlinear Lagrange equations of the second kind.

    d/dt (dT/dq'_i) - dT/dq_i = dU/dq_i + Q_i,      that is      M(q) q'' = f(q, q', t)

    f_i = dT/dq_i + dU/dq_i + Q_i - sum_j q'_j d(dT/dq'_i)/dq_j - sum_x rate_x d(dT/dq'_i)/dx - d(dT/dq'_i)/dt

where x runs over the prescribed quantities and Q_i are the generalised forces of loads without a force function.  With
constraints (``mbsym.problems.constraints``) these are the equations of the open tree, and constraint forces join them:
M q'' = f + J^T lambda,  J q'' + gamma = 0;  without multipliers  Y^T M Y u' = Y^T (f - M a0).

Other forms (``mbsym run --form routh,hamilton``; ``canonical``):

    Routh:     R = L - beta.c' of the coordinates s, the momenta beta of the cyclic coordinates c being constants where
               no other force acts on c;  M_R s'' = f_R;  R = 1/2 s'.M_R s' + b.s' - W with the reduced potential W
    Hamilton:  p = dL/dq',  H = p.q' - L,  q' = dH/dp,  p' = -dH/dq + Q;  Poisson brackets {F_i, F_j} of the integrals
               of problem 7

Forces Q without a force function stay in both.  Under constraints both are told in the velocities that these leave, on
their manifold (Routh's where they are integrable), Hamilton's in the speeds of a system that has its own.

Source: Banshchikov & Vetrov, Problem 3.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.equations.forcing
    (Formula(-b*theta_dot - m*l*g*sin(theta)),)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from mbsym.algebra.matrices import united
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.variables import rate_of
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.energy import Energy


@dataclass(frozen=True, repr=False)
class Embedded(Shown):
    """Y^T M Y (symmetric) and Y^T (f - M a0) in the independent velocities, which are those of ``free``.

    Without constraints M and f.
    """

    counted = ("mass_matrix", "forcing")

    free: tuple[str, ...]
    mass_matrix: Matrix
    forcing: Column


@dataclass(frozen=True, repr=False)
class Equations(Shown):
    """M (n x n), f (n) and the part Q (n) of f that comes from loads without a force function.

    With ``constraints`` M q'' = f + J^T lambda; ``embedded`` are the equations without multipliers, which are the same
    where there are no constraints; None where they outgrow the budget.
    """

    counted = ("mass_matrix", "forcing")

    mass_matrix: Matrix
    forcing: Column
    generalized_force: Column
    constraints: Constraints = field(kw_only=True)
    embedded: Embedded | None = field(kw_only=True)

    @property
    def in_speeds(self) -> bool:
        """Whether they are in speeds of their own (``in_speeds``), not in generalised velocities."""
        return False

    @property
    def products(self) -> Sequence[tuple[tuple[str, tuple[str, ...]], tuple[str, tuple[str, ...]]]]:
        """Pairs of unit vectors or quaternions, each with its components, whose product is known."""
        return ()

    def equality(self, i: int, names: Sequence[str]) -> Formula:
        """(M q'' - f)_i, which vanishes along every motion of the open tree; ``names`` are those of the coordinates."""
        ring = self.forcing[i].ring
        rates = [ring.generator("acceleration", name) for name in names]
        inertia = ring.dot(self.mass_matrix.polynomials[i], rates)
        return Formula(ring, ring.reduce(inertia - self.forcing[i].polynomial))

    def equalities(self, names: Sequence[str]) -> Column:
        """The same of all rows."""
        return tuple(self.equality(i, names) for i, _ in enumerate(self.forcing))


def equations(scene: Scene, energy: Energy) -> Equations:
    """Lagrange's equations of the open tree as M q'' = f (scene over the ring)."""
    ring, names = scene.ring, scene.system.coordinates
    lagrangian = energy.kinetic_energy.polynomial + energy.force_function.polynomial
    applied = generalized_forces(scene)
    forcing = []
    for name in names:
        momentum = ring.velocity_derivative(energy.kinetic_energy.polynomial, name)
        slope = ring.derivative(lagrangian, name)
        forcing.append(ring.reduce(slope + applied[name] - convective_rate(scene, ring, momentum)))
    right = column(ring, forcing)
    return Equations(
        mass_matrix=energy.A2,
        forcing=right,
        generalized_force=column(ring, [applied[name] for name in names]),
        constraints=Constraints.none(ring, names),
        embedded=Embedded(names, energy.A2, right),
    )


def convective_rate(scene: Scene, ring: Ring, x: Polynomial) -> Polynomial:
    """dx/dt at q'' = 0: sum_j q'_j dx/dq_j + sum over prescribed of rate dx/d(prescribed) + dx/dt."""
    velocities = ((name, ring.generator("velocity", name)) for name in scene.system.coordinates)
    return rate_of(ring, scene.lower, scene.system, x, velocities)


def separate(scene: Scene, equations: Equations) -> list[list[str]]:
    """The coordinates in sets, as many as there are, whose equations of motion know no others."""
    ring, names = scene.ring, scene.system.coordinates
    every = (*names, *scene.system.velocities)
    owner = dict(zip(every, (*names, *names), strict=True))
    parts = united(
        {
            name,
            *(owner[x] for p in (*row, force.polynomial) for x in ring.dependencies(p, every)),
            *(other for other, entry in zip(names, row, strict=True) if not entry.is_zero()),
        }
        for name, row, force in zip(names, equations.mass_matrix.polynomials, equations.forcing, strict=True)
    )
    ordered = [[name for name in names if name in part] for part in parts]
    return sorted(ordered, key=lambda part: names.index(part[0]))
