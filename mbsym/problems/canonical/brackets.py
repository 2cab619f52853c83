"""Poisson brackets of the first integrals of problem 7, in coordinates and momenta.

    {F, G} = sum over i of  dF/dq_i dG/dp_i - dF/dp_i dG/dq_i
    dF/dt  = dF/dt|_(q, p) + sum over i of  dF/dq_i dH/dp_i + dF/dp_i (-dH/dq_i + Q_i)

Integrals whose brackets are all zero are in involution.  Where no generalised forces Q act the bracket of two integrals
is an integral again, or a constant (Poisson's theorem).

Source: Landau & Lifshitz, Mechanics, section 42; Arnold, Mathematical Methods of Classical Mechanics, section 40.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Polynomial
from mbsym.formulas.formula import Column, Matrix, column
from mbsym.formulas.notebook import Shown
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import ring_environment
from mbsym.model.system import System, velocity_name
from mbsym.problems.canonical.canonical import Hamilton
from mbsym.problems.integrals import ENERGY, Integral


@dataclass(frozen=True, repr=False)
class Brackets(Shown):
    """``formulas`` are the integrals of these ``names`` in (q, p, t), ``matrix`` their brackets {F_i, F_j}."""

    names: tuple[str, ...]
    formulas: Column
    matrix: Matrix

    @property
    def in_involution(self) -> bool | None:
        """Whether all brackets vanish; None where one is no zero of the ring, and may be one all the same."""
        ring = self.matrix[0, 0].ring
        found = [ring.is_zero(x) for row in self.matrix.polynomials for x in row]
        return False if False in found else None if None in found else True


def brackets(system: System, canonical: Hamilton, integrals: Sequence[Integral]) -> Brackets | None:
    """The brackets of the ``integrals``, whose formulas are in q and q'; None without integrals."""
    if not integrals:
        return None
    ring = canonical.hamiltonian.ring
    environment = ring_environment(system, ring)
    for name, velocity in zip(system.coordinates, canonical.velocities, strict=True):
        environment[velocity_name(name)] = velocity.polynomial
    carry = Carrier(integrals[0].formula.ring, ring, environment)
    own: dict[tuple[str, str], Polynomial] = {(ENERGY, "time"): canonical.hamiltonian.polynomial}
    for q, p in zip(system.coordinates, canonical.momenta, strict=True):
        own["cyclic momentum", q] = ring.generator("prescribed", p)
    formulas = []
    for one in integrals:
        known = own.get((one.kind, one.of))
        formulas.append(ring.reduce(carry(one.formula.polynomial)) if known is None else known)
    rows = [[poisson_bracket(system, canonical, a, b) for b in formulas] for a in formulas]
    return Brackets(tuple(one.name for one in integrals), column(ring, formulas), Matrix.of(ring, rows))


def poisson_bracket(system: System, canonical: Hamilton, f: Polynomial, g: Polynomial) -> Polynomial:
    """{f, g} in the ring of the canonical equations."""
    ring = canonical.hamiltonian.ring
    total = ring.zero
    for q, p in zip(system.coordinates, canonical.momenta, strict=True):
        total = total + ring.times(ring.derivative(f, q), ring.derivative(g, p))
        total = total - ring.times(ring.derivative(f, p), ring.derivative(g, q))
    return ring.reduce(total)


def rate_along(canonical: Hamilton, scene: Scene, f: Polynomial) -> Polynomial:
    """df/dt by the canonical equations; ``scene`` is the system over their ring."""
    ring, system = canonical.hamiltonian.ring, scene.system
    total = ring.derivative(f, "t")
    for item in system.prescribed:
        total = total + ring.times(scene.lower(item.rate), ring.derivative(f, item.name))
    moved = zip(system.coordinates, canonical.momenta, canonical.velocities, canonical.rates, strict=True)
    for q, p, velocity, rate in moved:
        total = total + ring.times(ring.derivative(f, q), velocity.polynomial)
        total = total + ring.times(ring.derivative(f, p), rate.polynomial)
    return ring.reduce(total)
